// The marker that the reader looks at: its speed over time and its spectrum, in every recording.
nodegraph.define("mocap/player/hand", ["page", "mocap/player/spectrum", "mocap/player/marks"], (page, { speedsOf, spectrumOf, SHORTEST }, { spansOf }) => {
  const { element, svg } = page;
  const HEIGHT = 150;
  const LEFT = 46; // px for the numbers of the vertical axis
  const BOTTOM = 20;
  const TOP = 6;
  const LINES = 4; // that differ by colour
  const NEAR = 30; // px between the last number of an axis and the one before it
  const DECADES = 7; // of a spectrum, at most

  // Powers of ten between two numbers; where there are not two of them, twice and five times these, too.
  const powersOf = (low, high) => {
    const first = Math.floor(Math.log10(low));
    const powers = Array.from({ length: Math.floor(Math.log10(high)) - first + 1 }, (_, i) => 10 ** (first + i));
    const between = (values) => values.filter((value) => value >= low && value <= high);
    const whole = between(powers);
    return whole.length > 1 ? whole : between(powers.flatMap((power) => [power, 2 * power, 5 * power]));
  };

  // Round steps, about `count` of them.
  const ticksOf = (high, count) => {
    const rough = high / count;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((digit) => digit * power).find((each) => each >= rough);
    return Array.from({ length: Math.floor(high / step + 1e-9) + 1 }, (_, i) => i * step);
  };

  const shortly = (value) => (value >= 1e4 || (value && value < 1e-3) ? value.toExponential(0) : String(Number(value.toPrecision(3))));

  // A frame with axes; `x` and `y` take values to pixels.
  const chart = (label, width, { x, y, across, up }) => svg("svg", {
    class: "hand-chart", width, height: HEIGHT, viewBox: `0 0 ${width} ${HEIGHT}`, role: "img", "aria-label": label,
  },
  ...up.map((value) => svg("line", { class: "rule", x1: LEFT, x2: width, y1: y(value), y2: y(value) })),
  ...up.map((value) => svg("text", { x: LEFT - 5, y: y(value) + 4, "text-anchor": "end" }, shortly(value))),
  ...across.map((value) => svg("text", { x: x(value), y: HEIGHT - 5, "text-anchor": x(value) > width - 20 ? "end" : x(value) < LEFT + 8 ? "start" : "middle" }, shortly(value))));

  const pathOf = (points) => {
    let text = "";
    let joined = false;
    for (const [x, y] of points) {
      const known = Number.isFinite(x + y);
      if (known) text += `${joined ? "L" : "M"}${x.toFixed(1)},${y.toFixed(1)}`;
      joined = known;
    }
    return text;
  };

  // For each pixel the fastest of its frames, so that no peak is lost.
  const peaksOf = (speeds, pixels) => {
    const count = Math.max(1, Math.min(speeds.length, Math.floor(pixels)));
    return Array.from({ length: count }, (_, at) => {
      const [first, stop] = [Math.floor((at * speeds.length) / count), Math.max(1, Math.floor(((at + 1) * speeds.length) / count))];
      let most = NaN;
      for (let frame = first; frame < stop; frame += 1) if (!(speeds[frame] <= most)) most = Number.isNaN(speeds[frame]) ? most : speeds[frame];
      return [(first + stop - 1) / 2, most];
    });
  };

  class Hand {
    constructor(player) {
      this.player = player;
      this.marker = null;
      this.lines = [];
      this.element = element("div", { class: "hand", hidden: true });
      this.width = 0;
      new ResizeObserver(() => { if (this.marker && this.element.clientWidth !== this.width) this.draw(); }).observe(this.element);
    }

    // The marker in hand, or none.
    show(marker) {
      this.marker = marker;
      this.element.toggleAttribute("hidden", marker === null);
      if (marker !== null) this.draw();
    }

    draw() {
      this.width = this.element.clientWidth;
      if (!this.width) return;
      const panels = this.player.study.panels.filter((panel) => panel.kind === "markers" && panel.markers.includes(this.marker));
      this.lines = panels.map((panel, place) => {
        const column = panel.markers.indexOf(this.marker);
        return { panel, kind: `line line-${place % LINES}`, speeds: speedsOf(panel, column), spectrum: spectrumOf(panel, column) };
      });
      const key = this.lines.length > 1 ? element("p", { class: "legend" }, ...this.lines.map(({ panel, kind }) => element("span", {}, element("span", { class: `swatch ${kind}`, "aria-hidden": "true" }), panel.label))) : null;
      this.element.replaceChildren(...[
        element("p", { class: "name" }, this.marker), key,
        element("p", { class: "quiet" }, "Speed in mm/s over time in s"), this.drawSpeed(),
        element("p", { class: "quiet" }, "Spectrum in mm per \u221aHz over frequency in Hz, all three coordinates"), this.drawSpectrum(),
      ].filter(Boolean));
      this.tell(this.player.seconds);
    }

    // The numbers that are drawn: speeds in mm/s by frame, and (Hz, mm per root of Hz).
    get state() {
      return this.marker === null ? null : { marker: this.marker, lines: this.lines.map(({ panel, speeds, spectrum }) => ({ label: panel.label, speeds: Array.from(speeds), spectrum: spectrum?.points ?? null })) };
    }

    drawSpeed() {
      const { seconds } = this.player.study;
      const inner = this.width - LEFT;
      const x = (value) => LEFT + (value / seconds) * inner;
      const drawn = this.lines.map(({ panel, speeds, kind }) => ({ panel, kind, peaks: peaksOf(speeds, (inner * panel.frames) / panel.rate / seconds) }));
      const most = drawn.reduce((top, { peaks }) => peaks.reduce((high, [, speed]) => (speed > high ? speed : high), top), 0) || 1;
      const y = (value) => HEIGHT - BOTTOM - (value / most) * (HEIGHT - BOTTOM - TOP);
      const plot = chart(`Speed of ${this.marker}`, this.width, { x, y, across: ticksOf(seconds, 6), up: ticksOf(most, 3) });
      plot.append(...this.lines.flatMap(({ panel }) => spansOf(panel, this.player.study.every, this.marker)).map(([first, stop]) =>
        svg("rect", { class: "marked", x: x(first), width: Math.max(1, x(stop) - x(first)), y: TOP, height: HEIGHT - BOTTOM - TOP })));
      plot.append(...drawn.map(({ panel, kind, peaks }) => svg("path", { class: kind, d: pathOf(peaks.map(([frame, speed]) => [x((frame + 0.5) / panel.rate), y(speed)])) })));
      this.now = svg("line", { class: "at", y1: 0, y2: HEIGHT - BOTTOM });
      this.place = x;
      plot.append(this.now);
      plot.addEventListener("pointerdown", (event) => {
        this.player.pause();
        this.player.seek(Math.floor(((event.offsetX - LEFT) / inner) * seconds * this.player.study.rate));
      });
      return plot;
    }

    drawSpectrum() {
      const found = this.lines.filter(({ spectrum }) => spectrum);
      const points = found.flatMap(({ spectrum }) => spectrum.points).filter(([, size]) => size > 0);
      if (!points.length) return element("p", { class: "quiet" }, `None: the marker is never there for ${SHORTEST} frames in a row, or does not move.`);
      const [low, high] = [Math.min(...points.map(([hertz]) => hertz)), Math.max(...points.map(([hertz]) => hertz))];
      const most = Math.max(...points.map(([, size]) => size)) * 1.2;
      const least = Math.max(Math.min(...points.map(([, size]) => size)), most / 10 ** DECADES);
      const x = (hertz) => LEFT + (Math.log(hertz / low) / Math.log(high / low)) * (this.width - LEFT - 4);
      const y = (size) => HEIGHT - BOTTOM - (Math.log(Math.max(size, least) / least) / Math.log(most / least)) * (HEIGHT - BOTTOM - TOP);
      const plot = chart(`Spectrum of ${this.marker}`, this.width, { x, y, across: [...powersOf(low, high).filter((hertz) => x(high) - x(hertz) > NEAR), high], up: powersOf(least, most) });
      plot.append(...found.map(({ kind, spectrum }) => svg("path", { class: kind, d: pathOf(spectrum.points.map(([hertz, size]) => [x(hertz), y(size)])) })));
      return plot;
    }

    tell(seconds) {
      if (this.marker === null || !this.now) return;
      for (const end of ["x1", "x2"]) this.now.setAttribute(end, this.place(seconds));
    }
  }

  return { Hand };
});
