// Rows over the time of a playback, below its pictures: each has a name, and shows what happens to it.
nodegraph.define("mocap/player/rows", ["page", "theme"], ({ element }, theme) => {
  const FINENESS = 2; // dots for each pixel of the page
  const MOST = 8192; // dots that a canvas is high

  const INKS = {
    light: { line: "#dfe3e8", curve: "#1a5fb4", missing: "#17202c", filled: "#e0453c", repaired: "#d98a00", impulse: "#8a2f7d", marked: "#8a5200" },
    dark: { line: "#2e3640", curve: "#82b4ff", missing: "#e7ebf0", filled: "#e0453c", repaired: "#d98a00", impulse: "#e59adb", marked: "#e8b45c" },
  };

  class Rows {
    // `paint(pen, row, box, ink)` draws a row into a box of { top, height, width } in pixels;
    // `valueAt(row, seconds)` is what stands at its end; a click into a row goes there, and `pick`s it.
    constructor(player, { title, names, height, paint, valueAt = null, pick = null }) {
      Object.assign(this, { player, names, height, paint, valueAt, pick });
      this.canvas = element("canvas", { role: "img", "aria-label": title });
      this.now = element("span", { class: "now" });
      this.values = valueAt ? names.map(() => element("span")) : [];
      this.labels = names.map((name) => element("span", { title: name }, name));
      const column = (kind, spans) => element("span", { class: kind, style: `line-height: ${height}px` }, ...spans);
      const over = element("span", { class: "over" }, this.canvas, this.now);
      this.table = element("div", { class: "rows", tabindex: 0, role: "group", "aria-label": title },
        column("labels", this.labels), over, ...(valueAt ? [column("values", this.values)] : []));
      this.element = element("div", { class: "strip" }, element("p", { class: "name" }, title), this.table);
      this.canvas.style.height = `${height * names.length}px`;
      this.listen();
      new ResizeObserver(() => this.draw()).observe(over);
    }

    listen() {
      const go = (event) => {
        this.player.pause();
        const { seconds, rate } = this.player.study;
        this.player.seek(Math.floor((event.offsetX / this.canvas.clientWidth) * seconds * rate));
      };
      this.canvas.addEventListener("pointerdown", (event) => {
        if (event.button > 0) return;
        this.pick?.(this.names[Math.min(this.names.length - 1, Math.floor(event.offsetY / this.height))]);
        go(event);
      });
      this.canvas.addEventListener("pointermove", (event) => { if (event.buttons && event.isPrimary) go(event); });
    }

    draw() {
      const width = this.canvas.clientWidth;
      if (!width) return;
      const fine = Math.min(FINENESS, MOST / (this.height * this.names.length));
      this.canvas.width = Math.round(width * fine);
      this.canvas.height = Math.round(this.height * this.names.length * fine);
      const pen = this.canvas.getContext("2d");
      pen.scale(this.canvas.width / width, fine);
      const ink = INKS[theme.dark() ? "dark" : "light"];
      this.names.forEach((_, row) => {
        pen.fillStyle = ink.line;
        pen.fillRect(0, (row + 1) * this.height - 0.5, width, 0.5);
        this.paint(pen, row, { top: row * this.height, height: this.height, width }, ink);
      });
    }

    tell(seconds, marked) {
      this.now.style.left = `${(100 * seconds) / this.player.study.seconds}%`;
      this.labels.forEach((label, row) => label.classList.toggle("marked", this.names[row] === marked));
      this.values.forEach((value, row) => {
        const text = this.valueAt(row, seconds);
        if (value.textContent !== text) value.textContent = text;
      });
    }
  }

  return { Rows };
});
