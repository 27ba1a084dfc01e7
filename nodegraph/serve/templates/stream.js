// The page of a stream: its newest frames, and what is counted of it, as the server sends them.
nodegraph.define("stream", ["page", "lines", ...__MODULES__], ({ element, number, reduced_motion }, lines, ...made) => {
  const GROUPS = __GROUPS__;
  const views = new Map(__MODULES__.map((name, place) => [name, made[place]]));
  const ODD = ["missing", "late", "repeated", "dropped", "undecodable"];
  const STATES = {
    waiting: "Waiting for frames",
    receiving: "Receiving",
    lost: "The connection to the source is lost; it is opened again until it is back",
    ended: "The stream has ended",
  };
  const state = document.querySelector(".stream-state");
  const pause = document.getElementById("pause");
  let events = null;
  let over = false;
  // who wants little motion sees the figures change, and pictures when asked for
  const paused = { pictures: reduced_motion(), figures: false };

  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;

  const say = (name, text) => {
    state.dataset.state = name;
    const status = state.querySelector("[role=status]");
    if (status.textContent !== text) status.textContent = text;
  };

  // One kind of picture: the output that is chosen, with its alternatives.
  class Pictures {
    constructor(groups) {
      this.groups = groups;
      this.group = groups.at(-1); // what is computed last
      this.host = element("div", { class: "stream-host" });
      const select = element("select", { "aria-label": "Output that is shown" }, ...groups.map(({ name }) =>
        element("option", { value: name, selected: name === this.group.name }, name)));
      select.addEventListener("change", () => {
        this.group = groups.find(({ name }) => name === select.value);
        this.forget();
        this.explain();
        listen();
      });
      const head = groups.length > 1 ? select : groups[0].name;
      this.behind = element("span", { class: "quiet" });
      this.element = element("section", {}, element("h2", {}, head, this.behind), this.host);
      this.explain();
    }

    // What looks ahead comes later than the frame that arrives.
    explain() {
      const { behind } = this.group;
      this.behind.textContent = behind ? ` ${behind} frame${behind > 1 ? "s" : ""} behind` : "";
    }

    forget() {
      this.stage?.then((stage) => stage.close());
      this.stage = null;
      this.is_drawn = false;
      this.host.replaceChildren();
    }

    take(event) {
      const { name, module, labels } = this.group;
      if (event.begun[name] !== undefined) {
        this.forget();
        this.stage = views.get(module).show(this.host, event.begun[name], labels);
        this.stage.catch(({ message }) => this.host.replaceChildren(element("p", { class: "quiet" }, `This cannot be shown: ${message}`)));
      }
      const frames = event.frames[name];
      if (!frames || !this.stage || (paused.pictures && this.is_drawn)) return;
      this.is_drawn = true;
      const group = this.group;
      this.stage.then((stage) => { if (group === this.group) stage.draw(frames.map(bytes)); });
    }
  }

  // Numbers that are kept current: one of them over time, and all of them now.
  class Running {
    constructor({ name, units, steps }) {
      Object.assign(this, { name, units, steps });
      const with_unit = (key) => (units[key] ? `${key} (${units[key]})` : key);
      const chosen = Object.keys(units).find((key) => units[key] && units[key] !== "share") ?? Object.keys(units)[0];
      this.select = element("select", { "aria-label": "Number that is drawn" },
        ...Object.keys(units).map((key) => element("option", { value: key, selected: key === chosen }, with_unit(key))));
      this.select.addEventListener("change", () => this.draw());
      this.chart = element("div", { class: "chart" });
      this.body = element("tbody");
      const head = ["", ...Object.keys(units)].map((key) => element("th", { scope: "col", class: key ? "number" : null }, key ? with_unit(key) : name));
      this.element = element("section", { class: "running" },
        element("h2", {}, `${name}, so far: `, this.select), this.chart,
        element("div", { class: "wide", tabindex: "0", role: "group", "aria-label": name }, element("table", {}, element("thead", {}, element("tr", {}, ...head)), this.body)));
      new ResizeObserver(() => this.draw()).observe(this.chart);
    }

    take(history) {
      this.history = history;
      this.draw();
      const now = (step, key) => history.steps[step]?.[key]?.at(-1) ?? null;
      this.body.replaceChildren(...Object.entries(this.steps).map(([label, step]) => row(label,
        Object.entries(this.units).map(([key, unit]) => (unit ? number(now(step, key)) : String(now(step, key) ?? "\u2013"))), { "data-step": step })));
    }

    draw() {
      const width = this.chart.clientWidth;
      if (!this.history?.seconds.length || !width) return;
      const key = this.select.value;
      const drawn = Object.entries(this.steps).map(([label, step]) => ({ label, values: this.history.steps[step]?.[key] ?? [] }));
      this.chart.replaceChildren(lines.draw(this.history.seconds, drawn, { title: `${key} of ${this.name}`, unit: this.units[key], width, height: 200 }));
    }
  }

  const kinds = [...new Set(GROUPS.map(({ view }) => view))];
  const pictures = kinds.map((kind) => new Pictures(GROUPS.filter(({ view }) => view === kind)));
  const running = __RUNNING__.map((quantity) => new Running(quantity));
  document.querySelector(".stream-pictures").append(...[...pictures.reverse(), ...running].map((part) => part.element));

  const figure = (name, value, unit, below, odd = false) => {
    const holder = document.querySelector(`[data-figure="${name}"]`);
    holder.parentElement.classList.toggle("odd", odd);
    holder.replaceChildren(element("b", {}, value), element("span", { class: "unit" }, unit ? ` ${unit}` : ""), element("span", {}, below));
  };
  const milliseconds = (value) => (value === undefined ? "\u2013" : value.toFixed(value < 10 ? 2 : 1));
  const latency = (name, of) => figure(name, milliseconds(of.p50), "ms p50",
    of.p99 === undefined ? "" : `p99 ${milliseconds(of.p99)} \u00b7 max ${milliseconds(of.max)}`);
  const row = (name, cells, attributes = {}) => element("tr", attributes,
    element("th", { scope: "row" }, name), ...cells.map((cell) => element("td", { class: "number" }, String(cell))));
  const table = (name, rows) => {
    const holder = document.querySelector(`[data-table="${name}"]`);
    holder.hidden = !rows.length;
    holder.tBodies[0].replaceChildren(...rows);
  };

  const show = ({ numbers, rates, latency: latencies, sinks, refused, warnings }) => {
    latency("last", latencies.last);
    latency("all", latencies.all);
    figure("in", rates.in.toFixed(1), "per s", `${numbers.received} received`);
    figure("out", rates.out.toFixed(1), "per s", `${numbers.computed} computed`);
    const odd = ODD.filter((name) => numbers[name]);
    figure("odd", String(odd.reduce((sum, name) => sum + numbers[name], 0)), "",
      odd.map((name) => `${numbers[name]} ${name}`).join(" \u00b7 ") || "none missing, late or dropped", odd.length > 0);
    table("counts", Object.entries(numbers).map(([name, count]) => row(name, [count], { "data-count": name })));
    table("latency", [["last 5 s", latencies.last], ["whole stream", latencies.all]].map(([name, of]) =>
      row(name, ["p50", "p99", "p99.9", "max"].map((key) => (key in of ? of[key].toFixed(3) : "\u2013")))));
    table("sinks", Object.entries(sinks).map(([name, { written, unsent, rate }]) => row(name, [written, unsent, rate.toFixed(1)], { "data-sink": name })));
    const notes = [["refused", refused], ["warned", warnings]].flatMap(([what, counted]) =>
      Object.entries(counted).map(([text, count]) => element("li", {}, `${what} ${count} times: ${text}`)));
    const list = document.querySelector(".stream-notes");
    list.hidden = !notes.length;
    list.replaceChildren(...notes);
  };

  const take = (event) => {
    for (const picture of pictures) picture.take(event);
    if (!event.figures) return;
    const { state: name, message, seconds, rates } = event.figures;
    over = name === "ended";
    if (message) say("failed", `The stream has failed: ${message}`);
    else say(name, STATES[name]);
    state.querySelector(".stream-rate").textContent = over ? `after ${seconds} s` : name === "receiving" ? `${rates.in.toFixed(0)} frames per second` : "";
    if (over) pause.hidden = true;
    if (paused.figures && !over) return;
    show(event.figures);
    for (const chart of running) chart.take(event.history);
  };

  // Nothing comes while nobody sees the page; who comes back gets the present state.
  const listen = () => {
    events?.close();
    if (document.hidden) return;
    events = new EventSource(`/stream?${new URLSearchParams(pictures.map(({ group }) => ["show", group.name]))}`);
    events.onmessage = ({ data }) => take(JSON.parse(data));
    events.onerror = () => {
      if (over) events.close();
      else say("lost", "The command that feeds this page does not answer; asking it again");
    };
  };
  const label = () => { pause.textContent = paused.pictures ? "Go on" : "Pause"; };
  pause.addEventListener("click", () => {
    paused.pictures = paused.figures = !paused.pictures;
    label();
  });
  label();
  document.addEventListener("visibilitychange", () => { if (!over) listen(); });
  listen();
});
