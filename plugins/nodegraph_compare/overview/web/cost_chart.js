"use strict";
// What accuracy costs: error against time. The stepped line joins the methods that no other beats in
// both.
nodegraph.define("compare/cost_chart", ["page", "compare/chart", "compare/scale", "compare/view"], (page, chart, scales, { seconds }) => {
  const { svg } = page;
  const { named, strong, hint, text, line } = chart;
  const HEIGHT = 400;
  const LEFT = 46;
  const BOTTOM = 44;

  const pareto = (points, sign) => points
    .filter((point) => !points.some((other) => other !== point
      && other.seconds <= point.seconds && sign * other.value <= sign * point.value
      && (other.seconds < point.seconds || sign * other.value < sign * point.value)))
    .sort((a, b) => a.seconds - b.seconds);

  // Places a name beside its dot where it meets no other dot or name; null if there is no room.
  const placer = (points, width, height) => {
    const boxes = points.map(({ x, y }) => [x - 5, y - 5, x + 5, y + 5]);
    return ({ x, y }, name) => {
      const wide = chart.textWidth(name);
      const offers = [
        [x + 9, y + 4], [x - 9 - wide, y + 4], [x - wide / 2, y - 10], [x - wide / 2, y + 18],
        [x + 8, y - 8], [x + 8, y + 16], [x - 8 - wide, y - 8], [x - 8 - wide, y + 16],
      ];
      for (const [left, base] of offers) {
        const box = [left - 1, base - 10, left + wide + 1, base + 4];
        const inside = box[0] > LEFT && box[2] < width && box[1] > 0 && box[3] < height - BOTTOM;
        const free = boxes.every((other) => box[2] < other[0] || box[0] > other[2] || box[3] < other[1] || box[1] > other[3]);
        if (!inside || !free) continue;
        boxes.push(box);
        return [left, base];
      }
      return null;
    };
  };

  const render = (view) => (plot, width) => {
    const { values, tied } = view.numbers();
    const sign = view.better === "higher" ? -1 : 1;
    const shown = view.ranked().filter((method) => view.overview.seconds[method] > 0);
    if (!shown.length) {
      plot.replaceChildren(page.element("p", {}, "No method with a time is left by the filter."));
      return {};
    }
    const x = scales.fitting(shown.map((method) => view.overview.seconds[method]), LEFT + 8, width - 8, { room: 0.06 });
    const y = scales.fitting(shown.map((method) => values[method]), HEIGHT - BOTTOM, 14, { room: 0.08, linear: view.statistic === "rank" });
    const points = shown.map((method) => ({
      method, seconds: view.overview.seconds[method], value: values[method],
      x: x.place(view.overview.seconds[method]), y: y.place(values[method]),
    }));
    const picture = chart.picture(width, HEIGHT, `${view.what} against time`);
    for (const { value, text: label } of y.ticks(52)) {
      picture.append(line(LEFT, y.place(value), width, y.place(value), "grid"), text(LEFT - 7, y.place(value) + 4, label, { class: "tick", "text-anchor": "end" }));
    }
    for (const { value } of x.ticks(88)) {
      picture.append(line(x.place(value), 14, x.place(value), HEIGHT - BOTTOM, "grid"), text(x.place(value), HEIGHT - BOTTOM + 17, seconds(value), { class: "tick", "text-anchor": "middle" }));
    }
    picture.append(
      text(0, HEIGHT - 6, `\u2191 ${view.what.toLowerCase()}${view.unit ? `, ${view.unit}` : ""}`, { class: "tick" }),
      text(width, HEIGHT - 6, "time of a result \u2192", { class: "tick", "text-anchor": "end" }));
    const front = view.better === "none" ? [] : pareto(points, sign);
    const path = front.map((point, at) => (at ? `H${point.x}V${point.y}` : `M${point.x},${point.y}`)).join("");
    if (front.length) picture.append(svg("path", { class: "pareto", d: path }));
    const place = placer(points, width, HEIGHT);
    const weight = ({ method }) => 2 * view.weight(method) + front.some((point) => point.method === method);
    const marks = [...points].sort((a, b) => weight(b) - weight(a)).map((point) => {
      const name = view.overview.methods[point.method];
      const mark = svg("g", {
        ...chart.methodMark(view, point.method, shown.indexOf(point.method), `${name}: ${view.text(point.value)} in ${seconds(point.seconds)}`),
        class: `method ${view.roles(point.method)}`,
        onpointermove: (event) => chart.showNote(event, name, view.text(point.value), seconds(point.seconds)),
      }, svg("circle", { class: "reach", cx: point.x, cy: point.y, r: 13 }),
      svg("circle", { cx: point.x, cy: point.y, ...view.dot(point.method, view.group, 4.5) }));
      const at = place(point, name);
      if (at) mark.append(text(at[0], at[1], name));
      return mark;
    });
    picture.append(...marks.reverse());
    plot.replaceChildren(picture);
    return {
      finding: finding(view, points, front),
      caption: [
        strong(`${view.what} against time, ${x.log && y.log ? "both on log scales" : ["time on a log scale", y.name && `the error on a ${y.name}`].filter(Boolean).join(", ")}. `),
        "The time of a result is that of the steps behind it that not all methods need: the median, without the longest, which may be a first call. ",
        front.length ? "The stepped line joins methods that none beats in both. " : "",
        view.numbers().best.length ? `Blue: the ${view.end}. ` : "",
        tied.length ? "Ringed: may be the best. " : "",
        hint("Click a dot to follow the method through the page."),
      ],
    };
  };

  const finding = (view, points, front) => {
    if (view.better === "none" || view.statistic === "rank") return [];
    const first = points[0];
    const name = (point) => named(view, point.method);
    const end = view.endOf(first.method);
    const where = view.overview.groups.length > 1 ? [`At ${view.group.title}: `] : [];
    if (!(first.value > 0)) return [];
    const ratio = (point) => (view.better === "higher" ? first.value / point.value : point.value / first.value);
    const near = points.filter((point) => ratio(point) <= 1.1).sort((a, b) => a.seconds - b.seconds)[0];
    const parts = near === first
      ? ["nothing within 10\u202f% of ", name(first), ` is cheaper (${seconds(first.seconds)}). `]
      : [`the cheapest within 10\u202f% of the ${end} is `, name(near), ` (${seconds(near.seconds)}); the ${end}, `, name(first), `, takes ${seconds(first.seconds)}. `];
    const cheapest = front[0];
    const more = cheapest === near ? [] : [name(cheapest), ` takes ${seconds(cheapest.seconds)} at ${view.toBest(cheapest.value, first.value)} the error.`];
    if (!where.length && typeof parts[0] === "string") parts[0] = parts[0][0].toUpperCase() + parts[0].slice(1);
    return [...where, ...parts, ...more];
  };

  const draw = (host, view) => chart.mount(host, view, { className: "cost-chart", draw: render(view) });

  return { draw, applies: (overview) => overview.seconds.some((value) => value > 0) };
});
