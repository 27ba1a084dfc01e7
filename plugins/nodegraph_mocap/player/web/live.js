// Panels of a stream: the newest frame of each, side by side, seen by one camera.
nodegraph.define("mocap/live", [
  "page", "theme", "mocap/player/data", "mocap/player/camera", "mocap/player/markers", "mocap/player/mesh",
  "mocap/player/controls", "mocap/player/gestures",
], ({ element }, theme, { playbackOf }, camera, markers, { drawMesh }, { legendFor, buttonFor }, { dragged, keyedInSpace }) => {
  const { frontal, within, zoomed, projectionOf } = camera;
  const { drawMarkers, textOfMarkers, textOfSample, namePointed, inksOf } = markers;
  const FINENESS = Math.min(2, devicePixelRatio);
  const CHOICES = { colour: "origin", truth: false, trails: false, times: 1 };

  const stages = new Set();
  let seen_from = frontal(); // heads and markers are turned together

  // What the bytes of a frame are: see nodegraph_mocap/player/live.py.
  const take = (panel, buffer) => {
    if (panel.kind === "markers") {
      const count = panel.markers.length;
      panel.places = new Float32Array(buffer, 0, 3 * count);
      panel.origin = new Uint8Array(buffer, 12 * count, count);
    } else {
      const count = panel.head.morphs.length;
      panel.weights = new Float32Array(buffer, 0, count);
      panel.motion = panel.motion && new Float32Array(buffer, 4 * count, 12);
      panel.known = [panel.weights.every(Number.isFinite) && !panel.motion?.some(Number.isNaN)];
    }
  };

  class Stage {
    constructor(host, study) {
      this.study = study;
      this.panels = study.panels.map((panel, place) => this.built(panel, place));
      this.large = null;
      this.origins = new Set();
      this.legend = element("p", { class: "legend" });
      this.stage = element("div", {
        class: "stage", tabindex: 0, role: "group",
        "aria-label": "What is computed. Shift and arrows turn, plus and minus enlarge, 0 is the front, u turns upside down.",
      }, ...this.panels.map((tile) => tile.element));
      const view = element("span", { class: "view", role: "group", "aria-label": "View" },
        buttonFor("\u2212", "Smaller", () => this.look((from) => zoomed(from, 1 / 1.25))),
        buttonFor("+", "Larger", () => this.look((from) => zoomed(from, 1.25))),
        buttonFor("Front", "From the front", () => this.look(frontal)));
      const figure = element("figure", { class: "playback live" },
        element("div", { class: "options" }, this.legend, view), this.stage);
      figure.playback = this;
      keyedInSpace(this, this.stage);
      host.replaceChildren(figure);
      this.sight = new IntersectionObserver((entries) => {
        for (const { target, isIntersecting } of entries) this.panels.find((tile) => tile.canvas === target).inSight = isIntersecting;
        this.redraw();
      }, { rootMargin: "100px" });
      for (const tile of this.panels) this.sight.observe(tile.canvas);
      stages.add(this);
    }

    built(panel, place) {
      const name = panel.label;
      const canvas = element("canvas", { role: "img", "aria-label": name });
      const readout = element("span", { class: "readout" });
      const tip = element("span", { class: "tip", hidden: true });
      const button = buttonFor("\u2922", `Enlarge ${name}`, () => this.enlarge(place));
      const box = element("div", { class: `panel ${panel.kind}` },
        element("p", { class: "name" }, element("span", {}, name), button),
        element("div", { class: "picture" }, canvas, tip), readout);
      dragged(this, canvas, place);
      return { panel, canvas, readout, tip, button, element: box, inSight: true, dots: null };
    }

    enlarge(place) {
      this.large = this.large === place ? null : place;
      this.panels.forEach(({ panel, element: box, button }, index) => {
        box.classList.toggle("large", index === this.large);
        button.setAttribute("aria-label", `${index === this.large ? "Shrink" : "Enlarge"} ${panel.label}`);
      });
      this.redraw();
    }

    press(place) {
      this.enlarge(place);
    }

    point(place, event) {
      const tile = this.panels[place];
      namePointed(tile, event, tile.dots, (marker) => textOfSample(tile.panel, null, marker, 0));
    }

    look(change) {
      seen_from = change(seen_from);
      for (const stage of stages) stage.redraw();
    }

    draw(frames) {
      frames.forEach((buffer, place) => take(this.panels[place].panel, buffer));
      this.explain();
      this.redraw();
    }

    // Colours are explained once there is something of them.
    explain() {
      const origins = new Set(this.panels.flatMap(({ panel }) => [...(panel.origin ?? [])]));
      if ([...origins].every((origin) => this.origins.has(origin))) return;
      for (const origin of origins) this.origins.add(origin);
      const legend = legendFor({ panels: [{ kind: "markers", origin: [...this.origins] }], truth: null }, CHOICES);
      this.legend.replaceWith(legend);
      this.legend = legend;
    }

    // The stream may be computed by the same machine: drawing takes a third of one core at most.
    redraw() {
      this.is_stale = true;
      this.waiting ??= requestAnimationFrame(() => {
        const start = performance.now();
        this.is_stale = false;
        this.draw_now((tile) => tile.inSight);
        setTimeout(() => {
          this.waiting = undefined;
          if (this.is_stale) this.redraw();
        }, 2 * (performance.now() - start));
      });
    }

    draw_now(chosen = () => true) {
      const radius = Math.max(...this.study.panels.map((panel) => panel.radius));
      for (const tile of this.panels.filter(chosen)) this.drawPanel(tile, radius);
    }

    drawPanel(tile, radius) {
      const { panel, canvas, readout } = tile;
      const size = Math.round(canvas.clientWidth * FINENESS);
      if (!size) return;
      if (canvas.width !== size || canvas.height !== size) canvas.width = canvas.height = size;
      const pen = canvas.getContext("2d");
      pen.clearRect(0, 0, size, size);
      const by = projectionOf(panel, seen_from, size, radius);
      const dot = within(2, (size / 110) * Math.min(1.6, Math.sqrt(seen_from.zoom)), 7);
      const look = { study: { truth: null }, choices: CHOICES, marker: null, ink: inksOf(theme.dark()), dot, size };
      const is_mesh = panel.kind === "mesh";
      tile.dots = (is_mesh ? drawMesh : drawMarkers)(pen, panel, by, 0, look);
      readout.textContent = !is_mesh ? textOfMarkers(panel, null, 0) : tile.dots ? "" : "weights are missing";
    }

    // What is seen now, as that of a player: `figure.playback.state`.
    get state() {
      this.draw_now();
      return { panels: this.panels.map(({ panel, canvas, dots }) => ({ label: panel.label, kind: panel.kind, size: canvas.width, dots: dots && Array.from(dots) })) };
    }

    close() {
      this.sight.disconnect();
      stages.delete(this);
    }
  }

  const redraw = () => { for (const stage of stages) stage.redraw(); };
  theme.on(redraw);
  addEventListener("resize", redraw);

  return { show: async (host, begun) => new Stage(host, await playbackOf(begun)) };
});
