"use strict";
// All methods in all groups: the value, how it stands to the best of its group, and which may be
// the best. Deeper colour is nearer the best.
nodegraph.define("compare/heat_table", ["page", "compare/chart", "compare/view"], (page, chart, { seconds }) => {
  const { element } = page;
  const { strong, hint } = chart;
  const MOST = 24;
  const FADED = 2.6;

  const columnsOf = (view, width) => {
    const { groups } = view.overview;
    return width < 160 + groups.length * 62 ? view.panel.groups : groups;
  };

  const worstOf = (view, method, groups) => {
    const ratios = groups.map((group) => {
      const { values, first } = view.numbers(group);
      return view.better === "higher" ? values[first[0]] / values[method] : values[method] / values[first[0]];
    }).filter(Number.isFinite);
    return ratios.length ? Math.max(...ratios) : NaN;
  };

  // 1 at the best, 0 where a value is 2.6 times as far, or, of differences, at the worst.
  const nearness = (value, values, best, ratio) => {
    if (!Number.isFinite(value) || best === undefined) return 0;
    if (ratio) return Math.max(0, 1 - Math.abs(Math.log(value / best)) / Math.log(FADED));
    const far = Math.max(...[...values].filter(Number.isFinite).map((other) => Math.abs(other - best)));
    return far ? 1 - Math.abs(value - best) / far : 1;
  };

  // A cell opens the block in which its method errs most.
  const cell = (view, group, method, narrow, order, across) => {
    const { values, first, best, tied } = view.numbers(group);
    const value = values[method];
    if (!Number.isFinite(value)) return element("td", { class: "none" }, "\u2013");
    const least = values[first[0]];
    const ratio = view.statistic !== "rank" && [...values].every((other) => !(other <= 0));
    const tint = best.length ? (nearness(value, values, least, ratio) * 34).toFixed(1) : 0;
    const word = best.includes(method) ? `, ${view.endOf(method, group)}` : tied.includes(method) ? ", may be as good" : "";
    const names = [best.includes(method) && "first", tied.includes(method) && "tied", group === view.group && "here"];
    return element("td", { class: names.filter(Boolean).join(" "), style: `--nearness: ${tint}%` },
      element("button", {
        type: "button", class: "cell", tabindex: -1, "data-kind": "cell", "data-order": order, "data-across": across,
        "data-key": `cell ${group.index} ${method}`, title: `Open the ${view.blockName} in which ${view.overview.methods[method]} errs most`,
        onclick: (event) => {
          event.stopPropagation();
          view.open(view.worst(method, group), method, group);
        },
      }, page.number(value),
      first.length && !narrow ? element("small", {}, view.toBest(value, least)) : null,
      word ? element("span", { class: "hidden" }, word) : null));
  };

  const draw = (host, view) => {
    let sort = { key: "worst", falling: false };
    let whole = false;
    let redraw = () => {};
    const choose = (key) => {
      sort = { key, falling: sort.key === key && !sort.falling };
      redraw();
    };
    const render = (plot, width) => {
      const groups = columnsOf(view, width);
      const shown = view.shown(groups);
      const ratios = view.better !== "none" && view.statistic !== "rank"
        && groups.every((group) => [...view.numbers(group).values].every((value) => !(value <= 0)));
      const timed = shown.some((method) => view.overview.seconds[method] !== null);
      const asides = width < 420 ? [] : [
        ratios && groups.length > 1 && { key: "worst", title: "Worst", text: (method) => worstText(worstOf(view, method, groups)) },
        timed && { key: "time", title: "Time", text: (method) => (view.overview.seconds[method] === null ? "\u2013" : seconds(view.overview.seconds[method])) },
      ].filter(Boolean);
      // its names are larger by a pixel than those of charts
      const names = chart.widest(shown.map((method) => view.overview.methods[method]));
      const nameWidth = Math.round(Math.min(Math.max(names, 44) * (13 / 12) + 8, width * 0.34));
      const narrow = width - nameWidth - 74 * asides.length < 92 * groups.length;
      const axis = view.overview.within.at(-1)?.name ?? "";
      const heads = groups.map((group, at) => (at || narrow || !axis ? group.texts.at(-1) ?? view.what : view.groupText(group)));
      // columns that do not fit keep room for a number and their longest word: the table scrolls
      const words = heads.flatMap((text) => text.split(" ").map(chart.textWidth));
      const least = nameWidth + 74 * asides.length + groups.length * (Math.min(Math.max(54, ...words), 110) + 15);
      const sign = view.better === "higher" ? -1 : 1;
      const keyOf = {
        name: (method) => view.overview.methods[method],
        worst: (method) => (ratios ? worstOf(view, method, groups) : sign * view.numbers().values[method]),
        time: (method) => view.overview.seconds[method],
      };
      const valueOf = keyOf[sort.key] ?? ((method) => sign * view.numbers(view.overview.groups[sort.key]).values[method]);
      const compare = (a, b) => {
        const [value, other] = [valueOf(a), valueOf(b)];
        // methods without a value stay at the end
        const known = [value, other].map((value) => value !== null && !Number.isNaN(value));
        if (!known[0] || !known[1]) return known[1] - known[0];
        return (sort.falling ? -1 : 1) * (typeof value === "string" ? value.localeCompare(other, undefined, { numeric: true }) : value - other);
      };
      const order = [...shown].sort(compare);
      const isShort = !whole && order.length > MOST;
      const rows = isShort ? order.filter((method, at) => at < MOST - 4 || view.weight(method, groups) > 0) : order;
      const head = (key, label, className) => element("th", {
        scope: "col", class: className,
        "aria-sort": String(sort.key) === String(key) ? (sort.falling ? "descending" : "ascending") : null,
      }, element("button", { type: "button", title: "Sort by this column", "data-key": `head ${key}`, onclick: () => choose(key) }, label));
      const above = view.overview.panels.filter((panel) => panel.groups.some((group) => groups.includes(group)));
      const panelRow = above.length > 1 || narrow ? element("tr", {}, element("td", { class: "name" }),
        ...above.map(({ title, groups: members }) => element("th", { scope: "colgroup", colspan: members.length, class: "panel" },
          [title, narrow ? axis : ""].filter(Boolean).join(", "))),
        ...asides.map(() => element("td", { class: "aside" }))) : null;
      const table = element("table", { class: "heat", style: `--name-width: ${nameWidth}px; min-width: ${Math.ceil(least)}px` },
        element("thead", {}, panelRow, element("tr", {},
          head("name", "Method", "name"),
          ...groups.map((group, at) => head(group.index, heads[at], group === view.group ? "here" : "")),
          ...asides.map(({ key, title }) => head(key, title, "aside")))),
        element("tbody", {}, rows.map((method, at) => {
          const label = view.overview.methods[method];
          return element("tr", { class: `method ${view.roles(method, groups)}`, "data-method": label },
            element("th", { scope: "row" }, element("button", { ...chart.methodMark(view, method, at, null), type: "button", role: null, title: label }, label)),
            ...groups.map((group, column) => cell(view, group, method, narrow, at * groups.length + column, groups.length)),
            ...asides.map(({ text }) => element("td", { class: "aside" }, text(method))));
        })));
      const fold = order.length > MOST && element("button", {
        type: "button", class: "more", "data-key": "more", "aria-expanded": String(whole),
        onclick: () => { whole = !whole; redraw(); },
      }, whole ? "Show fewer" : `Show all ${order.length} methods`);
      plot.replaceChildren(element("div", { class: "scroller", tabindex: least > width ? 0 : null, role: "group", "aria-label": "Methods by group" }, table), fold || "");
      const verdict = groups.some((group) => view.numbers(group).tied.length);
      const panel = groups.length < view.overview.groups.length ? `${view.panel.title}. ` : "";
      return {
        caption: [
          strong(`${panel}${view.what}${view.unit ? `, ${view.unit}` : ""}${narrow || view.better === "none" ? "" : ratios ? `, and its multiple of the ${view.end}` : `, and its multiple of the ${view.end}, or the difference`}. `),
          groups.some((group) => view.numbers(group).best.length) ? `Bold: the ${view.end}${groups.length > 1 ? " of its group" : ""}, its name in blue; deeper blue is nearer it. ` : "",
          verdict ? "Outlined: may be the best. " : "",
          asides[0]?.key === "worst" ? "Worst: the largest multiple over the groups. " : "",
          hint(`A click on a head sorts; on a number, it opens the ${view.blockName} in which the method errs most.`),
        ],
      };
    };
    redraw = chart.mount(host, view, { draw: render, className: "heat-table" });
    addEventListener("beforeprint", () => {
      whole = true;
      redraw();
    });
  };

  const worstText = (ratio) => (Number.isFinite(ratio) ? `\u00d7${ratio < 10 ? ratio.toFixed(2) : ratio.toFixed(0)}` : "\u2013");

  return { draw };
});
