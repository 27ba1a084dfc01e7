"use strict";
// How far runs are: counts of steps in the drawing of the graph and in a table, from the events
// that the server sends. When a run has ended, the page shows what there is then.
{
  const GOING = __RUNS__;
  const SVG = "http://www.w3.org/2000/svg";
  const COLUMNS = ["waiting", "running", "done", "stored", "refused", "failed", "skipped"];
  const duration = (seconds) => {
    const whole = Math.round(seconds);
    if (whole < 60) return `${whole} s`;
    return whole < 3600 ? `${Math.floor(whole / 60)} min ${whole % 60} s` : `${Math.floor(whole / 3600)} h ${Math.floor((whole % 3600) / 60)} min`;
  };
  const total = (counts) => Object.values(counts).reduce((sum, count) => sum + count, 0);
  const settled = (counts) => total(counts) - (counts.waiting ?? 0) - (counts.running ?? 0);
  const stateOf = (counts) => {
    if (counts.failed) return "failed";
    if (counts.running) return "running";
    if (settled(counts) === total(counts)) return "done";
    return settled(counts) ? "running" : "waiting";
  };
  const draw = (box, counts) => {
    const frame = box.querySelector("rect.frame");
    if (!frame) return;
    const [width, height] = ["width", "height"].map((name) => Number(frame.getAttribute(name)));
    let text = box.querySelector("text.count");
    let meter = box.querySelector("rect.meter");
    if (!text) {
      text = document.createElementNS(SVG, "text");
      text.setAttribute("class", "count");
      meter = document.createElementNS(SVG, "rect");
      meter.setAttribute("class", "meter");
      box.append(meter, text);
    }
    const all = total(counts);
    box.dataset.state = stateOf(counts);
    text.setAttribute("x", width);
    text.setAttribute("y", -5);
    text.textContent = all ? `${settled(counts)} of ${all}${counts.failed ? `, ${counts.failed} failed` : ""}` : "";
    for (const [name, value] of Object.entries({ x: 0, y: height - 4, height: 4, rx: 2, width: all ? (width * settled(counts)) / all : 0 })) meter.setAttribute(name, value);
  };
  const table = (body, nodes) => {
    const rows = Object.entries(nodes).map(([name, counts]) => {
      const row = document.createElement("tr");
      const head = document.createElement("th");
      head.scope = "row";
      head.textContent = name;
      const cells = COLUMNS.map((column) => {
        const cell = document.createElement("td");
        cell.className = "number";
        cell.textContent = counts[column] ?? "";
        return cell;
      });
      row.append(head, ...cells);
      return row;
    });
    body.replaceChildren(...rows);
  };
  const show = (section, snapshot) => {
    const boxes = new Map([...section.querySelectorAll("[data-box]")].map((box) => [box.dataset.box, box]));
    for (const [name, counts] of Object.entries(snapshot.nodes)) if (boxes.has(name)) draw(boxes.get(name), counts);
    const body = section.querySelector(".served-counts tbody");
    if (body) table(body, snapshot.nodes);
    const failures = section.querySelector(".served-failures");
    if (failures) {
      failures.hidden = !snapshot.failures.length;
      failures.replaceChildren(...snapshot.failures.map((text) => Object.assign(document.createElement("li"), { textContent: text })));
    }
    if (!GOING.includes(section.dataset.run)) return;
    const counts = Object.values(snapshot.nodes);
    const [ended, all] = [settled, total].map((of) => counts.reduce((sum, each) => sum + of(each), 0));
    const rest = snapshot.to_go ? `, about ${duration(snapshot.to_go)} left` : "";
    section.querySelector(".served-state").textContent =
      `${section.dataset.run}: ${snapshot.state}, ${ended} of ${all} steps after ${duration(snapshot.seconds)}${rest}`;
  };
  const sections = [...document.querySelectorAll("[data-run]")];
  for (const section of sections) show(section, JSON.parse(section.dataset.snapshot));
  if (GOING.length) {
    const query = new URLSearchParams(GOING.map((name) => ["run", name]));
    const events = new EventSource(`/progress?${query}`);
    events.onmessage = ({ data }) => {
      const runs = JSON.parse(data);
      for (const section of sections) if (section.dataset.run in runs) show(section, runs[section.dataset.run]);
      if (Object.values(runs).every(({ state }) => state !== "running" && state !== "writing its report")) {
        events.close();
        location.reload();
      }
    };
  }
}
