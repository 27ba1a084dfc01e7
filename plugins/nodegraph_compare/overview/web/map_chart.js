"use strict";
// Where it is hard: at each place of the layout a disc of the error there, for the best method, the
// selected or next best one and the reference, on one scale. A place without blocks is hollow.
nodegraph.define("compare/map_chart", ["page", "compare/chart", "compare/scale", "compare/overview"], (page, chart, scales, { medianOf }) => {
  const { element, svg } = page;
  const { named, strong, hint, line } = chart;
  const SIZE = 220;
  const MARGIN = 14;

  // Which methods have a picture, and why.
  const methodsOf = (view) => {
    const ranked = view.ranked();
    const first = view.better === "none" ? view.reference ?? ranked[0] : ranked[0];
    const other = view.method !== null && ranked.includes(view.method) ? view.method : null;
    const next = ranked.find((method) => method !== first && method !== view.reference);
    const pictures = [
      [first, view.better === "none" ? "" : `${view.endOf(first)} here`],
      other === null ? [next, view.better === "none" ? "" : "next"] : [other, "selected"],
      [view.reference, "reference"],
    ];
    return pictures.filter(([method], at) => ranked.includes(method) && pictures.findIndex(([other]) => other === method) === at);
  };

  // The mean or median error of a method at each place.
  const valuesAt = (view, method, blocks, column, labels) => {
    const lists = labels.map(() => []);
    const codes = view.group.column(column);
    const place = new Map(view.overview.columns[column].map((label, code) => [code, labels.indexOf(label)]));
    for (const block of blocks) {
      const value = view.group.error(view.metric.name, block, method);
      const at = place.get(codes[block]);
      if (at >= 0 && Number.isFinite(value)) lists[at].push(value);
    }
    const mean = (list) => list.reduce((sum, value) => sum + value, 0) / list.length;
    return lists.map((list) => ({ value: view.statistic === "median" ? medianOf(list) : mean(list), count: list.length }));
  };

  const quantile = (sorted, share) => sorted[Math.min(sorted.length - 1, Math.floor(sorted.length * share))];

  // Places of the layout in a picture, and the largest disc that leaves neighbours apart.
  const fit = ({ points }) => {
    const [xs, ys] = [0, 1].map((axis) => scales.extent(points.map((point) => point[axis])));
    const inner = SIZE - 2 * MARGIN;
    const zoom = inner / Math.max(xs[1] - xs[0], ys[1] - ys[0], 1e-9);
    const height = (ys[1] - ys[0]) * zoom + 2 * MARGIN;
    const width = (xs[1] - xs[0]) * zoom + 2 * MARGIN;
    const places = points.map(([x, y]) => [MARGIN + (x - xs[0]) * zoom, MARGIN + (ys[1] - y) * zoom]);
    const radius = scales.between(Math.sqrt((width * height) / points.length) * 0.42, 3, 10);
    return { places, width, height, radius };
  };

  const render = (view) => (plot) => {
    const { layout } = view.overview;
    const { suspects } = view.filter;
    const blocks = view.group.blocks(view.metric.name, { suspects, marker: null, region: null });
    const pictures = methodsOf(view).map(([method, why]) => ({ method, why, at: valuesAt(view, method, blocks, layout.column, layout.names) }));
    const known = pictures.flatMap(({ at }) => at.map(({ value }) => value)).filter(Number.isFinite).sort((a, b) => a - b);
    if (!known.length) {
      plot.replaceChildren(element("p", {}, `No ${view.overview.json.blocks_name} are left by the filter.`));
      return { finding: [] };
    }
    const log = known[0] > 0;
    const scale = scales.scale([quantile(known, 0.03), quantile(known, 0.98)], 0, 1, log);
    const share = (value) => scales.between(scale.place(value), 0, 1);
    const { places, width: wide, height, radius } = fit(layout);
    const size = (value) => radius * (0.28 + 0.72 * share(value));
    const hollow = pictures.some(({ at }) => at.some(({ value }) => !Number.isFinite(value)));
    const inRegion = new Set(view.region === null ? [] : view.overview.regionLabels(view.region));
    const order = places.map((_, at) => at).sort((a, b) => places[a][1] - places[b][1] || places[a][0] - places[b][0]);
    const disc = ({ method, at }, place) => {
      const { value, count } = at[place];
      const label = layout.names[place];
      const on = label === view.marker || inRegion.has(label);
      return svg("circle", {
        class: `disc${on ? " on" : ""}`, cx: places[place][0].toFixed(1), cy: places[place][1].toFixed(1), r: size(value).toFixed(2),
        style: `--share: ${(share(value) * 100).toFixed(1)}%`,
        role: "button", tabindex: -1, "data-marker": label, "data-key": `${method} ${label}`, "data-kind": `discs ${method}`,
        "data-order": order.indexOf(place), "aria-pressed": String(label === view.marker), "aria-label": `${label}: ${view.error(value)}, ${count} ${view.overview.json.blocks_name}`,
        onclick: () => view.set({ marker: view.marker === label ? null : label, region: null }),
        onpointermove: (event) => chart.showNote(event, label, `${view.overview.methods[method]}: ${view.error(value)}`, `${count} ${view.overview.json.blocks_name}`),
        onpointerleave: chart.hideNote,
      });
    };
    const faces = pictures.map((picture) => element("div", { class: `map ${view.roles(picture.method)}` },
      element("h4", {}, view.overview.methods[picture.method], element("span", {}, ` ${picture.why}`)),
      svg("svg", { viewBox: `0 0 ${wide.toFixed(1)} ${height.toFixed(1)}`, role: "group", "aria-label": `${view.metric.name} ${layout.title}, ${view.overview.methods[picture.method]}` },
        ...layout.edges.map(([a, b]) => line(...places[a].map(Math.round), ...places[b].map(Math.round), "edge")),
        ...places.filter((_, place) => !Number.isFinite(picture.at[place].value))
          .map(([x, y]) => svg("circle", { class: "place", cx: x.toFixed(1), cy: y.toFixed(1), r: 2.2 })),
        ...places.map((_, place) => place).filter((place) => Number.isFinite(picture.at[place].value))
          .sort((a, b) => picture.at[b].value - picture.at[a].value).map((place) => disc(picture, place)))));
    plot.replaceChildren(element("div", { class: "maps" }, ...faces), here(view, pictures), legend(view, scale, log, size, share));
    return {
      finding: finding(view, pictures[0]),
      caption: [
        strong(`${view.statistic === "median" ? "Median" : "Mean"} ${view.metric.name} at each ${layout.column}, ${log ? "log scale, " : ""}one scale for all. `),
        "Area and colour say the same. ", hollow ? `Hollow: a ${layout.column} without ${view.overview.json.blocks_name}. ` : "", `Median number of ${view.overview.json.blocks_name} behind a disc: ${medianOf(pictures[0].at.map(({ count }) => count).filter(Boolean))}. Trust regions, not single discs. `,
        hint(`Click a disc to show its ${view.overview.json.blocks_name} only, and to open one.`),
      ],
    };
  };

  // At the chosen marker or region, the block in which each of the methods errs most.
  const here = (view, pictures) => {
    const where = view.marker ?? view.region;
    if (where === null) return "";
    const { blocks } = view.numbers();
    return element("div", { class: "here" }, `${blocks.length} ${view.overview.json.blocks_name} at ${where}. `,
      ...pictures.filter(({ method }) => view.worst(method) !== null).map(({ method }) => element("button", {
        type: "button", "data-key": `worst ${method}`, onclick: () => view.open(view.worst(method), method),
      }, `Worst for ${view.overview.methods[method]}`)));
  };

  const legend = (view, scale, log, size, share) => {
    const of = log ? Math.log : (value) => value;
    const back = log ? Math.exp : (value) => value;
    const steps = [0, 0.25, 0.5, 0.75, 1].map((part) => back(of(scale.low) + part * (of(scale.high) - of(scale.low))));
    return element("div", { class: "legend", "aria-hidden": "true" }, ...steps.map((value, at) => element("span", {},
      svg("svg", { viewBox: "-12 -12 24 24", width: 30, height: 30 }, svg("circle", { class: "disc", r: size(value).toFixed(2), style: `--share: ${(share(value) * 100).toFixed(1)}%` })),
      at === steps.length - 1 ? view.error(value) : page.number(value))));
  };

  // The hardest and easiest regions, or places where the layout has no regions.
  const finding = (view, { method, at }) => {
    const { layout } = view.overview;
    const regions = Object.entries(layout.regions ?? {});
    const parts = regions.length > 1 ? regions : layout.names.map((name, place) => [name, [place]]);
    const means = parts.map(([name, places]) => {
      const known = places.map((place) => at[place].value).filter(Number.isFinite);
      return [name, known.reduce((sum, value) => sum + value, 0) / known.length];
    }).filter(([, value]) => Number.isFinite(value)).sort((a, b) => (view.metric.better === "higher" ? a[1] - b[1] : b[1] - a[1]));
    if (means.length < 3 || view.better === "none") return [];
    const where = view.overview.groups.length > 1 ? ` at ${view.group.title}` : "";
    const [first, second, last] = [means[0], means[1], means.at(-1)];
    return [
      "Hardest for ", named(view, method),
      `${where}: ${first[0]} (${view.error(first[1])}) and ${second[0]} (${page.number(second[1])}); easiest ${last[0]} (${page.number(last[1])}).`,
    ];
  };

  const draw = (host, view) => chart.mount(host, view, { className: "map-chart", draw: render(view) });

  return { draw };
});
