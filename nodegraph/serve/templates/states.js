// The states of the steps of a run on the cards of its graph.
nodegraph.define("states", ["page"], ({ svg }) => {
  const GAP = 20; // free on the left of a card

  const duration = (seconds) => {
    const whole = Math.round(seconds);
    if (whole < 60) return `${whole} s`;
    return whole < 3600 ? `${Math.floor(whole / 60)} min ${whole % 60} s` : `${Math.floor(whole / 3600)} h ${Math.floor((whole % 3600) / 60)} min`;
  };
  const total = (counts) => Object.values(counts).reduce((sum, count) => sum + count, 0);
  const settled = (counts) => total(counts) - (counts.waiting ?? 0) - (counts.running ?? 0);

  const how_far = ({ nodes, state, seconds, to_go }) => {
    const counts = Object.values(nodes).map((node) => node.counts);
    const [ended, all] = [settled, total].map((of) => counts.reduce((sum, each) => sum + of(each), 0));
    const rest = to_go ? `, about ${duration(to_go)} left` : "";
    return `${state}, ${ended} of ${all} steps after ${duration(seconds)}${rest}`;
  };

  // An alternative, whose row has room for a few words; the rest is said on hover.
  class Row {
    constructor(row, node) {
      this.row = row;
      this.name = `${node}=${row.dataset.alternative}`;
      this.title = row.querySelector("title");
      this.text = this.title.textContent;
      const frame = row.querySelector("rect");
      const [x, y, width] = ["x", "y", "width"].map((name) => Number(frame.getAttribute(name)));
      this.count = svg("text", { class: "count", x: x + width - 6, y: y + 13.3 });
      row.append(this.count);
    }

    show({ mark, text, counts }) {
      this.row.dataset.state = mark;
      this.title.textContent = text ? `${this.text}: ${text}` : this.text;
      const [state, ...others] = Object.keys(counts);
      const is_said = state === "failed" || !(others.length || state === "waiting");
      this.count.textContent = !text ? "" : is_said ? `${counts[state]} ${state}` : `${settled(counts)} of ${total(counts)}`;
    }
  }

  class Card {
    constructor(box) {
      this.box = box;
      this.name = box.dataset.box;
      const frame = box.querySelector("rect.frame");
      this.width = Number(frame.getAttribute("width"));
      this.title = box.querySelector("title");
      this.count = svg("text", { class: "count", x: this.width, y: -5 });
      this.meter = svg("rect", { class: "meter", y: Number(frame.getAttribute("height")) - 4, height: 4, rx: 2 });
      box.append(this.meter, this.count);
      this.rows = [...box.querySelectorAll("[data-alternative]")].map((row) => new Row(row, this.name));
    }

    show({ mark, text, settled: share }, alternatives) {
      for (const row of this.rows) row.show(alternatives[row.name] ?? { mark, text: "", counts: {} });
      this.box.dataset.state = mark;
      this.title.textContent = `${this.name}: ${text}`;
      this.meter.setAttribute("width", share < 1 ? this.width * share : 0);
      const parts = text.split(", ");
      this.count.textContent = text;
      while (parts.length > 1 && this.count.getComputedTextLength() > this.width + GAP) {
        parts.pop();
        this.count.textContent = `${parts.join(", ")} \u2026`;
      }
    }
  }
  return { Card, how_far };
});
