// How far runs are: the states of their steps in the drawing of the graph and in a table, from the
// events that the server sends. When a run has ended, the page shows what there is then.
nodegraph.define("progress", ["page", "states"], ({ element, svg }, { Card, how_far }) => {
  const GOING = __RUNS__;
  const STATES = ["waiting", "running", "done", "stored", "unneeded", "refused", "failed", "skipped"];
  const BORDERS = {
    failed: "some failed", running: "running", waiting: "some are waiting",
    refused: "some refused", skipped: "some skipped", done: "all have a value",
  };
  const REST = 150; // ms

  // Each card leads to the combinations of its node.
  const linked = (box, address) => {
    const link = svg("a", { href: address });
    box.replaceWith(link);
    link.append(box);
    return new Card(box);
  };

  // Each link says what flows on it, and leads to these values. A pointer that passes asks nothing.
  class Link {
    constructor(arrow, section) {
      this.section = section;
      this.ends = arrow.dataset.arrow;
      this.title = arrow.querySelector("title").textContent;
      const source = this.ends.split(" ")[0];
      const link = svg("a", { href: section.address(source.slice(0, source.lastIndexOf("."))), "aria-label": this.title });
      section.drawing.querySelector(":scope > g").append(link);
      link.append(arrow);
      arrow.prepend(svg("path", { class: "near", d: arrow.querySelector(".wire").getAttribute("d") }));
      for (const event of ["pointerenter", "focus"]) link.addEventListener(event, () => { this.resting = setTimeout(() => this.ask(), REST); });
      for (const event of ["pointerleave", "blur"]) link.addEventListener(event, () => clearTimeout(this.resting));
    }

    async ask() {
      this.section.asked = this;
      const answer = await fetch(`/flow?${new URLSearchParams({ run: this.section.run, link: this.ends })}`);
      const data = await answer.json();
      if (this.section.asked !== this) return; // another has been asked since
      this.section.part.querySelector(".served-flow").replaceChildren(
        element("b", null, this.title), ": ", answer.ok ? data.join(" \u00b7 ") : data.message);
    }
  }

  class Section {
    constructor(part) {
      this.part = part;
      this.run = part.dataset.run;
      this.states = [];
      this.drawing = part.querySelector(".drawing > svg");
      this.drawing?.setAttribute("role", "group"); // of links
      this.cards = [...part.querySelectorAll("[data-box]")].map((box) => linked(box, this.address(box.dataset.box)));
      for (const arrow of part.querySelectorAll("[data-arrow]")) new Link(arrow, this);
    }

    address(node) {
      return `/values?${new URLSearchParams({ run: this.run, node })}`;
    }

    show(snapshot) {
      for (const card of this.cards) if (snapshot.nodes[card.name]) card.show(snapshot.nodes[card.name], snapshot.alternatives);
      this.legend(Object.values(snapshot.nodes).map(({ mark }) => mark));
      this.table(snapshot.nodes);
      const failures = this.part.querySelector(".served-failures");
      failures.hidden = !snapshot.failures.length;
      failures.replaceChildren(...snapshot.failures.map((text) => element("li", null, text)));
      if (GOING.includes(this.run)) this.part.querySelector(".served-state").textContent = `${this.run}: ${how_far(snapshot)}`;
    }

    legend(marks) {
      const list = this.part.querySelector(".served-legend");
      list?.replaceChildren(...Object.keys(BORDERS).filter((mark) => marks.includes(mark)).map((mark) =>
        element("li", null,
          svg("svg", { class: "nodegraph-picture", width: 40, height: 22, "aria-hidden": "true" },
            svg("g", { "data-state": mark }, svg("rect", { class: "frame", x: 3, y: 3, width: 34, height: 16, rx: 5 }))),
          BORDERS[mark])));
    }

    // Columns stand for states that occur; the focus stays on the link where it is.
    table(nodes) {
      const states = STATES.filter((state) => Object.values(nodes).some(({ counts }) => counts[state]));
      const table = this.part.querySelector(".served-counts");
      if (states.join() !== this.states.join() || !table.tBodies[0].rows.length) {
        this.states = states;
        const title = (state) => state[0].toUpperCase() + state.slice(1);
        table.tHead.replaceChildren(element("tr", null, element("th", { scope: "col" }, "Node"),
          states.map((state) => element("th", { scope: "col", class: "number" }, title(state)))));
        table.tBodies[0].replaceChildren(...Object.keys(nodes).map((name) => element("tr", null,
          element("th", { scope: "row" }, element("a", { href: this.address(name) }, name)),
          states.map(() => element("td", { class: "number" })))));
      }
      for (const [row, { counts }] of Object.values(nodes).entries()) {
        for (const [column, state] of states.entries()) table.tBodies[0].rows[row].cells[column + 1].textContent = counts[state] ?? "";
      }
    }
  }

  const sections = [...document.querySelectorAll("[data-run]")].map((part) => new Section(part));
  for (const section of sections) section.show(JSON.parse(section.part.dataset.snapshot));
  if (GOING.length) {
    const query = new URLSearchParams(GOING.map((name) => ["run", name]));
    const events = new EventSource(`/progress?${query}`);
    events.onmessage = ({ data }) => {
      const runs = JSON.parse(data);
      for (const section of sections) if (section.run in runs) section.show(runs[section.run]);
      if (Object.values(runs).every(({ state }) => state !== "running" && state !== "writing its report")) {
        events.close();
        location.reload();
      }
    };
  }
});
