// The view of one block: a marker as every method has it, over time, on the face and close up.
nodegraph.define("mocap/gap", ["page", "selection", "mocap/gap/packed", "mocap/gap/curves", "mocap/gap/closeup", "mocap/gap/face"], (page, selection, packed, curves, closeup, { Face }) => {
  const { element } = page;
  const PATIENCE = [40, 160]; // ms between frames at least and at most
  const REST = 200; // ms after which the address has the frame that the reader went to
  const WHOLE = 6000; // ms that a block takes to play, if these allow it
  const WORDS = {
    truth: "Solid: the truth.", best: "Blue: first in this comparison.",
    reference: "Dashed: the reference.", selected: "Orange: the method you selected.", rest: "Thin grey: all others.",
  };
  const ORDER = ["rest", "truth", "reference", "best", "selected"];

  // A method is drawn in the role that says most: a selected one that is also the best is orange.
  const roleOf = (name, best, { method, reference }) => {
    if (name === method) return "selected";
    if (best.includes(name)) return "best";
    return name === reference ? "reference" : "rest";
  };

  const bestOf = ({ overview, group }) => {
    const { methods, groups } = overview;
    return (groups[group]?.best ?? []).map((at) => String(methods[at].label));
  };

  const distance = (line, truth, at) => {
    const [a, b] = [packed.sample(line.positions, at), packed.sample(truth.positions, at)];
    return Math.hypot(...a.map((value, k) => value - b[k]));
  };

  class View {
    constructor(place, data, context) {
      this.block = packed.unpacked(data);
      this.best = bestOf(context);
      this.at = this.placeOf(selection.state.frame) ?? this.block.suspects[0] ?? this.block.at;
      this.root = element("div", { class: "gap-view" });
      this.face = new Face(this.block);
      this.build();
      place.replaceChildren(this.root);
      this.draw();
      let width = this.root.clientWidth;
      new ResizeObserver(() => {
        if (this.root.clientWidth === width) return;
        width = this.root.clientWidth;
        this.draw();
      }).observe(this.root);
    }

    build() {
      const { block } = this;
      const shaded = block.judged.name === "hidden" ? "hidden frames" : block.judged.name;
      const judged = block.judged.runs.length ? `; ${shaded} are shaded` : "";
      this.over = element("div", { class: "over-time" });
      this.pictures = element("div", { class: "pictures" });
      this.play = element("button", { type: "button", onclick: () => this.toggle() }, "Play");
      this.slider = element("input", {
        type: "range", min: 0, max: block.frames - 1, step: 1, "aria-label": "Frame",
        oninput: () => this.seek(Number(this.slider.value)),
      });
      this.clock = element("output", { class: "clock", "aria-live": "off" });
      this.errors = element("p", { class: "errors" });
      this.caption = element("p", { class: "quiet" });
      this.root.append(
        element("div", {}, element("h3", {}, `Position, ${block.unit}${judged}`), this.over),
        element("div", {}, element("h3", {}, "The face, and the marker close up"), this.pictures,
          element("div", { class: "controls" }, this.play, this.slider, this.clock), this.errors, this.caption));
    }

    lines() {
      const { methods: wanted } = selection.state;
      const lines = this.block.methods.map((method) => ({ ...method, role: roleOf(method.name, this.best, selection.state) }))
        .filter(({ name, role }) => role !== "rest" || !wanted || wanted.includes(name));
      if (this.block.truth) lines.push({ name: "truth", role: "truth", positions: this.block.truth });
      return lines.sort((a, b) => ORDER.indexOf(a.role) - ORDER.indexOf(b.role));
    }

    // The frame at which what is drawn in full is farthest apart: there the lines get their names.
    widest(lines) {
      const full = lines.filter(({ role }) => role !== "rest");
      let [most, widest] = [-1, this.block.at];
      for (let at = 0; at < this.block.frames; at += 1) {
        const points = full.map(({ positions }) => packed.sample(positions, at)).filter(([x]) => Number.isFinite(x));
        const apart = [0, 1, 2].reduce((sum, k) => {
          const [low, high] = curves.rangeOf(points.map((point) => point[k]));
          return sum + high - low;
        }, 0);
        if (apart > most) [most, widest] = [apart, at];
      }
      return widest;
    }

    draw() {
      const lines = this.lines();
      const block = { ...this.block, widest: this.widest(lines) };
      this.chart = curves.draw(block, lines, Math.max(280, this.over.clientWidth || 560));
      this.over.replaceChildren(this.chart.element);
      const pointed = (event) => {
        const box = this.chart.element.getBoundingClientRect();
        return [event.clientX - box.left, event.clientY - box.top];
      };
      this.chart.element.addEventListener("pointermove", (event) => {
        const [x, y] = pointed(event);
        const method = this.chart.methodAt(x, y);
        selection.hover("method", method);
        this.chart.name(method, x, y);
        if (event.buttons && event.isPrimary) this.seek(this.chart.frameAt(x));
      });
      this.chart.element.addEventListener("pointerleave", () => {
        selection.hover("method", null);
        this.chart.name(null, 0, 0);
      });
      this.chart.element.addEventListener("click", (event) => {
        const [x, y] = pointed(event);
        const method = this.chart.methodAt(x, y);
        if (method) selection.toggle("method", method);
        else this.seek(this.chart.frameAt(x));
      });
      const close = closeup.drawClose(block, lines);
      this.pictures.replaceChildren(this.face.element, close.element);
      this.face.show(lines);
      this.moved = [this.chart, this.face, close];
      this.drawn = lines;
      const roles = ORDER.filter((role) => lines.some((line) => line.role === role)).reverse();
      const reason = this.block.reason ? `These frames, because ${this.block.reason}. ` : "";
      const every = this.block.every > 1 ? `One frame of ${this.block.every} is shown. ` : "";
      const leaving = close.leaving ? `Hollow dots at the edge of the close-up: farther out, as ${close.leaving} of ${lines.length} lines get. ` : "";
      this.caption.textContent = `${reason}${every}${leaving}${roles.map((role) => WORDS[role]).join(" ")} ` +
        "Point at a line or a dot for its name, click to select its method. Drag the face to turn it. Space plays, \u2190 and \u2192 step through frames.";
      this.move(this.at);
    }

    move(at) {
      const { block } = this;
      this.at = Math.min(block.frames - 1, Math.max(0, at));
      for (const picture of this.moved) picture.move(this.at);
      const frame = block.frameAt(this.at);
      const text = `frame ${frame}, ${(frame / block.rate).toFixed(2)} s`;
      this.slider.value = this.at;
      this.slider.setAttribute("aria-valuetext", text);
      this.clock.textContent = text;
      const truth = this.drawn.find(({ role }) => role === "truth");
      const lines = truth ? this.drawn.filter(({ role }) => role !== "rest" && role !== "truth").reverse() : [];
      this.errors.replaceChildren(...lines.map((line) => element("span", { class: line.role },
        `${line.name} ${page.number(distance(line, truth, this.at))} ${block.unit}`)));
      if (lines.length) this.errors.prepend("Off the truth here: ");
    }

    hover(name) {
      this.root.classList.toggle("pointed", name !== null);
      for (const line of this.root.querySelectorAll("[data-line]")) line.classList.toggle("hovered", line.dataset.line === name);
      this.root.style.cursor = name === null ? "" : "pointer";
    }

    toggle() {
      if (this.playing) this.seek(this.at);
      else this.start();
    }

    start() {
      if (this.at === this.block.frames - 1) this.move(0);
      this.playing = true;
      this.play.textContent = "Pause";
      const pause = Math.min(PATIENCE[1], Math.max(PATIENCE[0], WHOLE / this.block.frames));
      let last = performance.now();
      const tick = (now) => {
        if (!this.playing || !this.root.isConnected) return;
        if (now - last >= pause) {
          last = now;
          const ended = this.at === this.block.frames - 1;
          if (ended && page.reduced_motion()) return this.seek(this.at);
          this.move(ended ? 0 : this.at + 1);
        }
        requestAnimationFrame(tick);
      };
      requestAnimationFrame(tick);
    }

    pause() {
      this.playing = false;
      this.play.textContent = "Play";
    }

    // Goes where the reader wants, and keeps that in the address.
    seek(at) {
      this.pause();
      this.move(at);
      clearTimeout(this.kept);
      this.kept = setTimeout(() => {
        if (here() === this) selection.set({ frame: this.block.frameAt(this.at) });
      }, REST);
    }

    // The place of a frame of the take; null if it is not in the view.
    placeOf(frame) {
      if (frame === null) return null;
      const place = Math.round((frame - this.block.start) / this.block.every);
      return place >= 0 && place < this.block.frames ? place : null;
    }
  }

  // One view at a time: selection, pointer and keys are followed by the last that was shown.
  let current = null;
  const here = () => (current?.root.isConnected ? current : null);
  selection.on(({ frame }, changed) => {
    const view = here();
    if (["method", "reference", "methods"].some((name) => changed.has(name))) view?.draw();
    const place = changed.has("frame") && view ? view.placeOf(frame) : null;
    if (place !== null && place !== view.at) view.move(place);
  });
  selection.on_hover((kind, value) => { if (kind === "method") here()?.hover(value); });
  document.addEventListener("keydown", (event) => {
    const view = here();
    const area = view && (view.root.closest("dialog") ?? view.root);
    if (!area?.contains(event.target) || event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.matches("input, select, textarea, summary") || (event.key === " " && event.target.matches("button, a"))) return;
    const act = { " ": () => view.toggle(), ArrowLeft: () => view.seek(view.at - 1), ArrowRight: () => view.seek(view.at + 1) }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });

  const show = (place, data, context) => {
    here()?.pause();
    current = new View(place, data, context);
    return current;
  };
  return { show };
});
