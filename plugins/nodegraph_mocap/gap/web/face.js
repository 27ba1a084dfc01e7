// The face at one frame in space, as the player draws it, and on it the marker as every method has it.
nodegraph.define("mocap/gap/face", [
  "page", "selection", "theme", "mocap/gap/packed", "mocap/gap/curves", "mocap/player/camera", "mocap/player/markers", "mocap/player/gestures",
], ({ element }, selection, theme, packed, { rangeOf }, { frontal, projectionOf, project, within }, { drawMarkers, inksOf }, { dragged, keyedInSpace }) => {
  const FINENESS = 2; // dots for each pixel of the page
  const ROOM = 1.15;
  const NEAR = 10; // px from a dot that point at it
  const TRAIL = 0.5; // seconds
  const LOOK = { study: { truth: null }, choices: { colour: "origin", truth: false, names: false, trails: false, times: 1 } };
  const COLOURS = {
    light: { best: "#1a5fb4", selected: "#b8480a", rest: "#8a939f" },
    dark: { best: "#82b4ff", selected: "#ff9a57", rest: "#8a939f" },
  };

  // The face of a block as the player has recordings: every marker in every frame, from the poses.
  const panelOf = (block) => {
    const { markers, edges } = block.face;
    const { frames, rate } = block;
    const places = new Float32Array(3 * markers.length * frames);
    const origin = new Uint8Array(markers.length * frames);
    for (let at = 0; at < frames; at += 1) {
      packed.faceAt(block, at).forEach((point, marker) => {
        if (!point.every(Number.isFinite)) return;
        origin[marker * frames + at] = 1;
        point.forEach((value, k) => { places[(3 * marker + k) * frames + at] = value; });
      });
    }
    const [x, y] = [0, 1].map((k) => rangeOf([...block.face.points].filter((_, at) => at % 3 === k)));
    const known = Number.isFinite(x[1] - x[0]);
    const [right, up] = block.axesOfView;
    const middle = known ? [(x[0] + x[1]) / 2, (y[0] + y[1]) / 2] : [0, 0];
    return {
      kind: "markers", markers, edges, frames, rate, places, origin, right, up,
      centre: right.map((value, k) => middle[0] * value + middle[1] * up[k]),
      radius: known ? (ROOM * Math.max(1, x[1] - x[0], y[1] - y[0])) / 2 : 1,
    };
  };

  class Face {
    constructor(block) {
      this.block = block;
      this.panel = panelOf(block);
      this.camera = frontal();
      this.at = block.at;
      this.lines = [];
      this.dots = [];
      this.canvas = element("canvas", { role: "img", "aria-label": `The face, with ${block.marker} as every method has it` });
      this.tip = element("span", { class: "tip", hidden: true });
      this.element = element("div", {
        class: "face", tabindex: 0, role: "group", "aria-label": "The face. Shift and arrows turn, plus and minus enlarge, 0 is the front, u turns upside down.",
      }, this.canvas, this.tip);
      dragged(this, this.canvas, 0);
      keyedInSpace(this, this.element);
      new ResizeObserver(() => this.draw()).observe(this.canvas);
      theme.on(() => this.draw());
    }

    // All lines of the marker, those later that are drawn over others.
    show(lines) {
      this.lines = lines;
      this.draw();
    }

    move(at) {
      this.at = at;
      this.draw();
    }

    look(change) {
      this.camera = change(this.camera);
      this.draw();
    }

    draw() {
      const { canvas, panel, block } = this;
      const size = Math.round(canvas.clientWidth * FINENESS);
      if (!size) return;
      if (canvas.width !== size) canvas.width = canvas.height = size;
      const pen = canvas.getContext("2d");
      pen.clearRect(0, 0, size, size);
      const by = projectionOf(panel, this.camera, size, panel.radius);
      const dot = within(4, size / 85, 8) * Math.min(1.6, Math.sqrt(this.camera.zoom));
      const ink = inksOf(theme.dark());
      drawMarkers(pen, panel, by, this.at, { ...LOOK, ink, dot, size, marker: block.marker });
      const colours = { ...COLOURS[theme.dark() ? "dark" : "light"], truth: ink.text, reference: ink.text };
      this.dots = this.lines.map((line) => this.drawLine(pen, by, line, colours[line.role], line.role === "rest" ? 0.7 * dot : dot));
    }

    // The way of a method in the last frames, and where it is; the truth is a ring.
    drawLine(pen, by, { role, positions }, colour, dot) {
      const from = Math.max(0, this.at - Math.round((TRAIL * this.block.rate) / this.block.every));
      const point = [NaN, NaN, NaN];
      pen.strokeStyle = pen.fillStyle = colour;
      pen.lineWidth = role === "rest" ? 1 : 2;
      pen.globalAlpha = role === "rest" ? 0.7 : 1;
      pen.setLineDash(role === "reference" ? [6, 4] : []);
      pen.beginPath();
      for (let at = from; at <= this.at; at += 1) {
        project(by, ...packed.sample(positions, at), point, 0);
        if (at === from) pen.moveTo(point[0], point[1]);
        else pen.lineTo(point[0], point[1]);
      }
      pen.stroke();
      pen.setLineDash([]);
      pen.beginPath();
      pen.arc(point[0], point[1], role === "truth" ? 1.6 * dot : dot, 0, 2 * Math.PI);
      if (role === "truth") pen.stroke();
      else pen.fill();
      pen.globalAlpha = 1;
      return point;
    }

    nearest(event) {
      const fine = this.canvas.width / this.canvas.clientWidth;
      let [found, least] = [-1, NEAR * fine];
      this.dots.forEach(([x, y], line) => {
        const away = Math.hypot(x - event.offsetX * fine, y - event.offsetY * fine);
        if (away <= least) [found, least] = [line, away];
      });
      return found;
    }

    // Names the method under the pointer; null takes the name away.
    point(place, event) {
      const found = event ? this.nearest(event) : -1;
      const line = this.lines[found];
      this.tip.toggleAttribute("hidden", !line);
      selection.hover("method", line && line.role !== "truth" ? line.name : null);
      if (!line) return;
      this.tip.textContent = line.name;
      this.tip.style.left = `${(100 * this.dots[found][0]) / this.canvas.width}%`;
      this.tip.style.top = `${(100 * this.dots[found][1]) / this.canvas.height}%`;
    }

    press(place, event) {
      const line = this.lines[this.nearest(event)];
      if (line && line.role !== "truth") selection.toggle("method", line.name);
    }
  }

  return { Face };
});
