// One clock, in seconds, for all panels of a playback; each shows the frame that began last.

const TRAIL = 0.5; // seconds
const FINENESS = 2; // dots for each pixel of the page
const INKS = {
  light: { text: "#17202c", line: "#9aa4b0", trail: "rgba(42, 134, 200, 0.6)" },
  dark: { text: "#e7ebf0", line: "#68747f", trail: "rgba(86, 164, 226, 0.65)" },
};
const DARK = matchMedia("(prefers-color-scheme: dark)");
const CALM = matchMedia("(prefers-reduced-motion: reduce)");

class Player {
  constructor(figure, study) {
    this.study = study;
    this.camera = frontal();
    this.choices = { speed: 1, colour: "origin", truth: true, trails: false, trail: TRAIL };
    this.seconds = study.start;
    this.playing = false;
    this.printing = false;
    this.drawn = [];
    this.build(figure);
    this.seek(this.tick);
  }

  build(figure) {
    this.panels = this.study.panels.map((panel) => this.built(panel));
    this.controls = controlsFor(this);
    this.legend = legendFor(this.study, this.choices);
    const stage = made("div", {
      class: "stage", tabindex: 0, role: "group",
      "aria-label": "Playback. Space plays, arrows step, Shift and arrows turn, plus and minus enlarge, 0 is the front.",
    }, ...this.panels.map((one) => one.element));
    const help = made("p", { class: "quiet" },
      "Drag to turn, with Shift or two fingers to move; pinch or Ctrl and wheel to enlarge. " +
      "With the pictures in focus, Space plays, arrows step, Shift and arrows turn.");
    figure.classList.toggle("compared", this.study.truth !== null);
    figure.append(this.controls.element, this.legend, stage, help);
    this.controls.clock.dataset.longest = this.toldAt(this.study.ticks - 1).join(" \u00b7 ").replace(/\d/g, "0");
    this.tell();
    keyed(this, stage);
    this.watch();
  }

  built(panel) {
    const canvas = made("canvas", { role: "img", "aria-label": panel.label || "playback" });
    const told = made("span", { class: "told" });
    const element = made("div", { class: `panel ${panel.kind}` }, made("p", { class: "name" }, panel.label), canvas, told);
    dragged(this, canvas);
    return { panel, canvas, told, element, inSight: false };
  }

  // Draw again when a picture comes into sight or changes its size, when colours change, and for
  // paper. What is out of sight is not drawn: on a phone that is most of the pictures.
  watch() {
    const sight = new IntersectionObserver((seen) => {
      for (const { target, isIntersecting } of seen) {
        this.panels.find((one) => one.canvas === target).inSight = isIntersecting;
      }
      this.invalidate();
    }, { rootMargin: "100px" });
    const resized = new ResizeObserver(() => this.invalidate());
    for (const one of this.panels) {
      sight.observe(one.canvas);
      resized.observe(one.canvas);
    }
    DARK.addEventListener("change", () => this.invalidate());
    addEventListener("beforeprint", () => { this.printing = true; this.draw(); });
    addEventListener("afterprint", () => { this.printing = false; this.invalidate(); });
  }

  get tick() {
    return within(0, Math.floor(this.seconds * this.study.rate + 1e-6), this.study.ticks - 1);
  }

  frameOf(panel) {
    return Math.min(panel.frames - 1, Math.floor(this.seconds * panel.rate + 1e-6));
  }

  seek(tick) {
    this.seconds = within(0, tick, this.study.ticks - 1) / this.study.rate;
    this.invalidate();
  }

  step(ticks) {
    this.pause();
    this.seek(this.tick + ticks);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  play() {
    if (CALM.matches && this.tick === this.study.ticks - 1) this.seek(0);
    this.playing = true;
    this.last = null;
    this.invalidate();
  }

  pause() {
    this.playing = false;
    this.invalidate();
  }

  choose(choices) {
    Object.assign(this.choices, choices);
    const legend = legendFor(this.study, this.choices);
    this.legend.replaceWith(legend);
    this.legend = legend;
    this.invalidate();
  }

  look(change) {
    this.camera = change(this.camera);
    this.invalidate();
  }

  invalidate() {
    this.waiting ??= requestAnimationFrame((now) => {
      this.waiting = undefined;
      if (this.playing) this.advance(now);
      this.draw((one) => one.inSight);
      if (this.playing) this.invalidate();
    });
  }

  // A tab that was out of sight goes on where it was; who wants little motion sees a take once.
  advance(now) {
    const passed = Math.min(0.1, (now - (this.last ?? now)) / 1000);
    this.last = now;
    this.seconds += this.choices.speed * passed;
    if (this.seconds < this.study.seconds) return;
    if (CALM.matches) {
      this.playing = false;
      this.seek(this.study.ticks - 1);
    } else {
      this.seconds %= this.study.seconds;
    }
  }

  draw(chosen = () => true) {
    const ink = INKS[DARK.matches && !this.printing ? "dark" : "light"];
    this.panels.forEach((one, place) => {
      if (chosen(one)) this.drawn[place] = this.drawPanel(one, ink);
    });
    this.tell();
  }

  drawPanel({ panel, canvas, told }, ink) {
    const size = Math.round(canvas.clientWidth * FINENESS);
    if (canvas.width !== size || canvas.height !== size) canvas.width = canvas.height = size;
    const frame = this.frameOf(panel);
    const ended = this.seconds * panel.rate >= panel.frames + 1e-6;
    if (!size) return { frame, dots: null };
    const pen = canvas.getContext("2d");
    pen.clearRect(0, 0, size, size);
    const by = projectionOf(panel, this.camera, size, this.radiusOf(panel.kind));
    const dot = within(3, size / 110, 7) * Math.min(1.6, Math.sqrt(this.camera.zoom));
    const with_ = { study: this.study, choices: this.choices, ink, dot, size };
    const dots = (panel.kind === "mesh" ? drawMesh : drawMarkers)(pen, panel, by, frame, with_);
    const state = panel.kind === "mesh" ? (dots ? "" : "weights are missing") : toldMarkers(panel, this.study.truth, frame);
    told.textContent = ended ? `ended after ${(panel.frames / panel.rate).toFixed(2)} s` : state;
    return { frame, dots };
  }

  radiusOf(kind) {
    return Math.max(...this.study.panels.filter((one) => one.kind === kind).map((one) => one.radius));
  }

  tell() {
    const { play, slider, clock } = this.controls;
    const label = this.playing ? "Pause" : "Play";
    play.textContent = label;
    play.setAttribute("aria-label", label);
    play.title = label;
    const [place, time] = this.toldAt(this.tick);
    slider.value = this.tick;
    slider.setAttribute("aria-valuetext", `${place}, ${time}`);
    clock.textContent = `${place} \u00b7 ${time}`;
  }

  toldAt(tick) {
    const { every, ticks, rate, seconds } = this.study;
    const place = `frame ${tick * every} of ${(ticks - 1) * every}`;
    return [place, `${(tick / rate).toFixed(2)} s of ${seconds.toFixed(2)} s`];
  }

  // What is seen now, for whoever wants to know it from outside: `figure.playback.state`.
  // The dots are (x, y, depth) of every marker or vertex, in dots of the canvas.
  get state() {
    this.draw();
    return {
      tick: this.tick,
      seconds: this.seconds,
      playing: this.playing,
      panels: this.panels.map(({ panel, canvas }, place) => ({
        label: panel.label, kind: panel.kind, size: canvas.width, ...this.drawn[place],
        dots: this.drawn[place].dots && Array.from(this.drawn[place].dots),
      })),
    };
  }
}

const start = async (figure) => {
  const note = figure.querySelector(".unplayed");
  try {
    if (typeof DecompressionStream === "undefined") throw new Error("this browser is too old for it");
    const study = await playbackOf(figure.querySelector("template").content.textContent);
    figure.playback = new Player(figure, study);
    note.remove();
  } catch (error) {
    note.textContent = `This playback cannot be shown: ${error.message}`;
  }
};

for (const figure of document.querySelectorAll("figure.playback")) start(figure);
