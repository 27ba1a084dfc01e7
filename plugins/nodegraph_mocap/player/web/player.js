// One clock, in seconds, for all panels of a playback; each shows the frame that began last.
nodegraph.define("mocap/player", [
  "page", "selection", "theme", "mocap/player/data", "mocap/player/camera", "mocap/player/markers", "mocap/player/mesh",
  "mocap/player/curves", "mocap/player/strip", "mocap/player/marks", "mocap/player/hand", "mocap/player/controls", "mocap/player/gestures",
], (page, selection, theme, { playbackOf }, camera, markers, { drawMesh }, { curvesFor }, { stripFor }, { Marks, applied }, { Hand }, controls, { dragged, keyed }) => {
  const { element } = page;
  const { frontal, within, projectionOf } = camera;
  const { drawMarkers, textOfMarkers, textOfSample, textOfDistance, tintOf, pointedMarker, namePointed, inksOf } = markers;
  const { controlsFor, chooserFor, legendFor, buttonFor } = controls;
  const MOST = 6; // panels at once
  const FIRST = 4; // of more
  const TRAIL = 0.5; // seconds
  const LARGEST = 1.4; // dots of the first of several recordings in one picture
  const SMALLER = 0.65;
  const FINENESS = 2; // dots for each pixel of the page
  const CALM = matchMedia("(prefers-reduced-motion: reduce)");

  // Panels of fills are labelled "ridge", or "ridge, met" where they differ in more than the method.
  const isOf = (panel, method) => panel.label.split(", ").includes(method);

  // All that fit; of more the truth and those with the least errors, of which the best is last.
  const firstShown = ({ panels, truth }) => {
    const places = panels.map((_, place) => place);
    if (places.length <= MOST) return places;
    const error = (place) => (panels[place] === truth ? -1 : panels[place].error ?? Infinity);
    return places.sort((a, b) => error(a) - error(b) || a - b).slice(0, FIRST).reverse();
  };

  class Player {
    constructor(figure, study) {
      this.study = study;
      this.camera = frontal();
      this.choices = { speed: 1, colour: "origin", truth: true, names: false, over: false, trails: false, trail: TRAIL, times: 1 };
      this.shown = firstShown(study);
      this.marker = null;
      this.large = null;
      this.seconds = study.start;
      this.playing = false;
      this.printing = false;
      this.drawn = [];
      this.build(figure);
      this.seek(this.tick);
    }

    build(figure) {
      const marked = this.study.panels.filter((panel) => panel.can_be_marked);
      this.marks = marked.map((panel) => new Marks(this, panel, marked.length > 1));
      const trouble = this.study.panels.filter((panel) => panel.marks?.length && !panel.can_be_marked).flatMap((panel) => this.applyMarks(panel));
      this.panels = this.study.panels.map((panel, place) => this.built(panel, place));
      this.controls = controlsFor(this);
      this.chooser = this.study.panels.length > MOST ? chooserFor(this, MOST) : null;
      this.legend = legendFor(this.study, this.choices);
      this.stage = element("div", {
        class: "stage", tabindex: 0, role: "group",
        "aria-label": "Playback. Space plays, arrows step, Shift and arrows turn, plus and minus enlarge, 0 is the front, u turns upside down.",
      });
      figure.classList.toggle("compared", this.study.truth !== null);
      this.hand = this.study.with_hand ? new Hand(this) : null;
      this.below = element("div", { class: "below" });
      this.layBelow();
      const pictures = this.panels.length ? [this.legend, this.stage] : [];
      const below = this.strips.length ? this.below : null;
      const help = element("p", { class: "quiet" }, this.help);
      figure.append(...trouble.map((text) => element("p", { role: "alert" }, text)));
      figure.append(...[this.chooser?.element, this.controls.element, ...pictures, below, help].filter(Boolean));
      this.controls.clock.dataset.longest = this.clockTextsAt(this.study.ticks - 1).join(" \u00b7 ").replace(/\d/g, "0");
      this.tell();
      keyed(this, this.stage);
      this.watch();
      this.arrange();
    }

    // Of a recording that others than the file beside it mark; returns why that is not possible.
    applyMarks(panel) {
      try {
        Object.assign(panel, applied(panel, panel.marks, this.study.every).changes);
        return [];
      } catch (error) {
        return [`${panel.label}: ${error.message}`];
      }
    }

    layBelow() {
      const take = (marker) => selection.toggle("marker", marker);
      this.strips = [
        ...this.marks,
        ...(this.hand ? [this.hand] : []),
        ...this.study.panels.filter((panel) => panel.strip).map((panel) => stripFor(this, panel, take)),
        ...this.study.curves.filter((curves) => curves.names.length).map((curves) => curvesFor(this, curves)),
      ];
      this.below.replaceChildren(...this.strips.map((strip) => strip.element));
      for (const { table } of this.strips) if (table) keyed(this, table);
    }

    // A recording has other samples, or other markers.
    remake() {
      this.layBelow();
      this.controls.offer();
      this.follow(selection.state);
      this.hand.show(this.hand.marker);
    }

    get help() {
      const { panels, with_hand } = this.study;
      const marker = "Click a marker for its speed and spectrum, a row to go there, anything else of a picture to enlarge it.";
      return [
        ...(with_hand ? [marker] : panels.length ? ["Click a picture to enlarge it."] : []),
        ...(panels.length ? ["Drag to turn, with Shift or two fingers to move; pinch or Ctrl and wheel to zoom."] : []),
        `With ${panels.length ? "the pictures" : "the rows"} in focus, Space plays, arrows step${panels.length ? ", Shift and arrows turn" : ""}.`,
      ].join(" ");
    }

    built(panel, place) {
      const name = panel.label || "playback";
      const canvas = element("canvas", { role: "img", "aria-label": name });
      const readout = element("span", { class: "readout" });
      const tip = element("span", { class: "tip", hidden: true });
      const button = buttonFor("\u2922", `Enlarge ${name}`, () => this.enlarge(place));
      const box = element("div", { class: `panel ${panel.kind}` },
        element("p", { class: "name" }, element("span", {}, panel.label), button),
        element("div", { class: "picture" }, canvas, tip), readout);
      dragged(this, canvas, place);
      return { panel, canvas, readout, tip, button, element: box, inSight: false };
    }

    // The recordings that are drawn over the first of them, in its picture; itself included.
    get laid_over() {
      const { panels } = this.study;
      const places = panels.map((_, place) => place).filter((place) => this.shown.includes(place) && panels[place].kind === "markers");
      return this.choices.over && places.length > 1 ? places : [];
    }

    // Puts the chosen panels on the stage, in the order of the study.
    arrange() {
      const [, ...hidden] = this.laid_over;
      const seen = (_, place) => this.shown.includes(place) && !hidden.includes(place);
      this.stage.replaceChildren(...this.panels.filter(seen).map((tile) => tile.element));
      this.explain();
      this.chooser?.buttons.forEach((button, place) => button.setAttribute("aria-pressed", this.shown.includes(place)));
      this.invalidate();
    }

    // Shows a panel, or takes it away; one too many takes the place of the one that was there first.
    pick(place) {
      if (!this.shown.includes(place)) this.include(place);
      else if (this.shown.length > 1) this.shown = this.shown.filter((other) => other !== place);
      this.arrange();
    }

    include(place) {
      const spare = this.shown.length < MOST ? null : this.shown.find((other) => this.study.panels[other] !== this.study.truth);
      this.shown = [...this.shown.filter((other) => other !== spare), place];
    }

    // What is selected anywhere on the page is shown here, too, and stands out.
    follow({ method, marker }) {
      const chosen = this.panels.findIndex(({ panel }) => method !== null && isOf(panel, method));
      this.panels.forEach((tile, place) => tile.element.classList.toggle("selected", place === chosen));
      if (chosen >= 0 && !this.shown.includes(chosen)) {
        this.include(chosen);
        this.arrange();
      }
      this.marker = marker;
      this.hand?.show(this.study.panels.some((panel) => panel.markers?.includes(marker)) ? marker : null);
      this.controls.marker.value = marker ?? "";
      this.invalidate();
    }

    // A click into a picture takes the marker there in hand, where there is room for it; otherwise
    // it enlarges the picture.
    press(place, event) {
      const { panel } = this.panels[place];
      const marker = this.hand ? pointedMarker(this.panels[place], event, this.drawn[place]?.dots) : -1;
      if (marker >= 0) selection.toggle("marker", panel.markers[marker]);
      else this.enlarge(place);
    }

    hover(method) {
      for (const { panel, element: box } of this.panels) box.classList.toggle("hovered", method !== null && isOf(panel, method));
    }

    enlarge(place) {
      this.large = this.large === place ? null : place;
      this.panels.forEach(({ panel, element: box, button }, index) => {
        box.classList.toggle("large", index === this.large);
        button.setAttribute("aria-label", `${index === this.large ? "Shrink" : "Enlarge"} ${panel.label || "playback"}`);
      });
      this.panels[place].element.scrollIntoView({ block: "nearest" });
      this.invalidate();
    }

    // Names the marker under the pointer; null takes the name away.
    point(place, event) {
      const { panel, canvas, tip } = this.panels[place];
      const { frame, dots } = this.drawn[place] ?? {};
      namePointed({ panel, canvas, tip }, event, dots, (marker) => textOfSample(panel, this.study.truth, marker, frame));
    }

    visit([first, last, marker]) {
      this.pause();
      if (this.hand) selection.set({ marker });
      else this.marker = marker;
      this.seek(Math.floor(((first + last) / 2) * this.study.rate));
    }

    nextGap() {
      const { gaps, rate } = this.study;
      const later = gaps.find(([first, last]) => Math.floor(((first + last) / 2) * rate) > this.tick);
      this.visit(later ?? gaps[0]);
    }

    // Draw again when a picture comes into sight or changes its size, when colours change, and for
    // paper. What is out of sight is not drawn: on a phone that is most of the pictures.
    watch() {
      const sight = new IntersectionObserver((seen) => {
        for (const { target, isIntersecting } of seen) {
          this.panels.find((tile) => tile.canvas === target).inSight = isIntersecting;
        }
        this.invalidate();
      }, { rootMargin: "100px" });
      const resized = new ResizeObserver(() => this.invalidate());
      for (const tile of this.panels) {
        sight.observe(tile.canvas);
        resized.observe(tile.canvas);
      }
      theme.on(() => {
        this.invalidate();
        for (const strip of this.strips) if (strip.table) strip.draw();
      });
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
      this.arrange();
    }

    explain() {
      const over = this.laid_over.map((place, turn) => ({ label: this.study.panels[place].label, colour: tintOf(turn) }));
      const legend = legendFor(this.study, this.choices, over);
      this.legend.replaceWith(legend);
      this.legend = legend;
    }

    look(change) {
      this.camera = change(this.camera);
      this.invalidate();
    }

    invalidate() {
      this.waiting ??= requestAnimationFrame((now) => {
        this.waiting = undefined;
        if (this.playing) this.advance(now);
        this.draw((tile) => tile.inSight);
        if (this.playing) this.invalidate();
      });
    }

    // A tab that was out of sight continues where it was; who wants little motion sees a take once.
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
      const ink = inksOf(theme.dark() && !this.printing);
      this.panels.forEach((tile, place) => {
        if (this.shown.includes(place) && chosen(tile)) this.drawn[place] = this.drawPanel(tile, ink);
      });
      this.tell();
    }

    drawPanel({ panel, canvas, readout }, ink) {
      const size = Math.round(canvas.clientWidth * FINENESS);
      if (canvas.width !== size || canvas.height !== size) canvas.width = canvas.height = size;
      const frame = this.frameOf(panel);
      const ended = this.seconds * panel.rate >= panel.frames + 1e-6;
      if (!size) return { frame, dots: null };
      const pen = canvas.getContext("2d");
      pen.clearRect(0, 0, size, size);
      const by = projectionOf(panel, this.camera, size, this.radiusOf(panel.kind));
      const dot = within(3, size / 110, 7) * Math.min(1.6, Math.sqrt(this.camera.zoom));
      const look = { study: this.study, choices: this.choices, marker: this.marker, ink, dot, size };
      const over = this.laid_over;
      if (this.study.panels[over[0]] === panel) return this.drawOver(over, { readout, pen, by, look });
      const dots = (panel.kind === "mesh" ? drawMesh : drawMarkers)(pen, panel, by, frame, look);
      const state = panel.kind === "mesh" ? (dots ? "" : "weights are missing") : textOfMarkers(panel, this.study.truth, frame);
      readout.textContent = ended ? `ended after ${(panel.frames / panel.rate).toFixed(2)} s` : state;
      return { frame, dots };
    }

    // All where they are in the coordinates of the first, each in a colour of its own and in smaller
    // dots than the one below it.
    drawOver(places, { readout, pen, by, look }) {
      const drawn = places.map((place, turn) => {
        const panel = this.study.panels[place];
        const frame = this.frameOf(panel);
        return { panel, frame, dots: drawMarkers(pen, panel, by, frame, { ...look, tint: tintOf(turn), dot: look.dot * LARGEST * SMALLER ** turn }) };
      });
      const [first, ...others] = drawn;
      readout.textContent = others.map((other) => textOfDistance(first, other)).join("; ");
      return { frame: first.frame, dots: first.dots };
    }

    radiusOf(kind) {
      return Math.max(...this.study.panels.filter((panel) => panel.kind === kind).map((panel) => panel.radius));
    }

    tell() {
      const { play, slider, clock } = this.controls;
      const label = this.playing ? "Pause" : "Play";
      play.textContent = label;
      play.setAttribute("aria-label", label);
      play.title = label;
      const [place, time] = this.clockTextsAt(this.tick);
      slider.value = this.tick;
      slider.setAttribute("aria-valuetext", `${place}, ${time}`);
      clock.textContent = `${place} \u00b7 ${time}`;
      for (const strip of this.strips) strip.tell(this.seconds, this.marker);
    }

    clockTextsAt(tick) {
      const { every, ticks, rate, seconds } = this.study;
      const place = `frame ${tick * every} (0 to ${(ticks - 1) * every})`;
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
        hand: this.hand?.state ?? null,
        panels: this.panels.flatMap(({ panel, canvas }, place) => (this.shown.includes(place) ? [{
          label: panel.label, kind: panel.kind, size: canvas.width, ...this.drawn[place],
          dots: this.drawn[place].dots && Array.from(this.drawn[place].dots),
        }] : [])),
      };
    }
  }

  const players = [];
  const start = async (figure) => {
    const note = figure.querySelector(".unplayed");
    try {
      if (typeof DecompressionStream === "undefined") throw new Error("this browser is too old for it");
      const study = await playbackOf(figure.querySelector("template").content.textContent);
      figure.playback = new Player(figure, study);
      figure.playback.follow(selection.state);
      players.push(figure.playback);
      note.remove();
    } catch (error) {
      note.textContent = `This playback cannot be shown: ${error.message}`;
    }
  };

  selection.on((state, changed) => {
    if (changed.has("method") || changed.has("marker")) for (const player of players) player.follow(state);
  });
  selection.on_hover((kind, value) => {
    if (kind === "method") for (const player of players) player.hover(value);
  });
  for (const figure of document.querySelectorAll("figure.playback")) start(figure);
});
