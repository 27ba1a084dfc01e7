"use strict";
// How the ranking of methods changes from group to group: a line per method, a panel per combination
// of the other labels. Of a single group, methods are dots on one line.
nodegraph.define("compare/line_chart", ["page", "compare/chart", "compare/scale"], (page, chart, scales) => {
  const { svg } = page;
  const { strong, hint, text, line } = chart;
  const HEIGHT = 500;
  const ROW = 15.5;
  const TOP = 46;
  const TIMES = 2; // of a scale, from end to end: methods nearer than that look near

  const describe = (view, method, groups) => groups
    .map((group) => {
      const { values, first } = view.numbers(group);
      const times = first.length ? ` (${view.toBest(values[method], values[first[0]])})` : "";
      return `${view.groupText(group)}: ${view.text(values[method])}${times}`;
    });

  const labelWidth = (view, shown) =>
    Math.min(chart.widest(shown.map((method) => view.overview.methods[method])), 150);

  // The heads of the groups that have room, by their places: with axis and units where all have it.
  const headsOf = (view, groups, x, left) => {
    const last = groups.length - 1;
    const short = groups.map((group) => group.texts.at(-1) ?? "");
    const whole = short.map((label, at) => (at === 0 && last > 0 ? view.groupText(groups[0]) : label));
    const fits = last === 0 || whole.every((label) => chart.textWidth(label) + 8 < x(1) - x(0));
    const label = (at) => (fits ? whole[at] : at === last ? short[at] : short[at].split("\u00a0")[0]);
    const heads = new Map();
    const taken = [];
    for (const at of [groups.indexOf(view.group), last, ...groups.keys()]) {
      if (at < 0 || heads.has(at)) continue;
      const half = chart.textWidth(label(at)) / 2 + 4;
      const middle = Math.max(x(at), left + half);
      if (taken.some(([from, to]) => middle - half < to && middle + half > from)) continue;
      taken.push([middle - half, middle + half]);
      heads.set(at, [middle, TOP - 14, label(at)]);
    }
    return heads;
  };

  // One panel between two edges of the picture; `many` panels name only methods that matter.
  const panelOf = (view, panel, shown, axis, { left, right, bottom, before, after, wide }) => {
    const groups = panel.groups.filter((group) => view.shown([group]).length);
    if (!groups.length) return text((left + right) / 2, TOP + 40, `No ${view.overview.json.blocks_name} left`, { "text-anchor": "middle" });
    const [start, end] = [left + before, right - after];
    const x = (at) => (groups.length > 1 ? start + ((end - start) * at) / (groups.length - 1) : end);
    const all = svg("g", {});
    for (const { value, text: label } of axis.ticks(60)) {
      all.append(line(start, axis.place(value), end, axis.place(value), "grid"));
      all.append(text(start - (wide ? 0 : 6), axis.place(value) - (wide ? 3 : -4), label, { class: "tick", "text-anchor": wide ? "start" : "end", dx: wide ? 5 : 0 }));
    }
    const heads = headsOf(view, groups, x, left);
    groups.forEach((group, at) => {
      const here = group === view.group ? " here" : "";
      all.append(line(x(at), TOP - 6, x(at), bottom, `axis${here}`));
      if (heads.has(at)) all.append(text(...heads.get(at), { class: `head${here}`, "text-anchor": "middle" }));
    });
    const [first, last] = [groups[0], groups.at(-1)];
    const weight = (method) => view.weight(method, groups);
    const side = (group) => shown.filter((method) => Number.isFinite(view.numbers(group).values[method]))
      .sort((a, b) => view.numbers(group).values[b] - view.numbers(group).values[a]);
    const labels = (group) => {
      const methods = side(group);
      const most = Math.floor((bottom - TOP) / ROW);
      const named = scales.thin([...methods].sort((a, b) => weight(b) - weight(a)), most, (method) => weight(method) > 0);
      const kept = methods.filter((method) => named.has(method));
      const places = scales.spread(kept.map((method) => axis.place(view.numbers(group).values[method])), ROW, TOP, bottom);
      return new Map(kept.map((method, at) => [method, places[at]]));
    };
    const atEnd = labels(last);
    const atStart = wide && groups.length > 1 ? labels(first) : new Map();
    const order = [...shown].sort((a, b) => view.numbers(last).values[b] - view.numbers(last).values[a]);
    for (const method of [...shown].sort((a, b) => weight(a) - weight(b))) {
      const name = view.overview.methods[method];
      const points = groups.map((group, at) => [x(at), axis.place(view.numbers(group).values[method]), group])
        .filter(([, y]) => Number.isFinite(y));
      if (!points.length) continue;
      const lines = describe(view, method, groups);
      const mark = svg("g", {
        ...chart.methodMark(view, method, order.indexOf(method), `${name}: ${lines.join(", ")}`),
        class: `method ${view.roles(method, groups)}`,
        onpointermove: (event) => chart.showNote(event, name, ...lines),
      });
      // a method without a number in a group leaves a gap in its line
      const path = groups.map((group, at) => {
        const y = axis.place(view.numbers(group).values[method]);
        if (!Number.isFinite(y)) return "";
        const joined = at > 0 && Number.isFinite(view.numbers(groups[at - 1]).values[method]);
        return `${joined ? "L" : "M"}${x(at).toFixed(1)},${y.toFixed(1)}`;
      }).join("");
      mark.append(svg("path", { class: "line", d: path }), svg("path", { class: "reach", d: path }));
      for (const [px, y, group] of points) {
        const [from, to] = ["low", "high"].map((end) => scales.between(axis.place(view.numbers(group)[end][method]), TOP - 6, bottom));
        if (to < from) mark.append(line(px, from, px, to, "interval"));
        mark.append(svg("circle", { cx: px, cy: y, ...view.dot(method, group, 2.4) }));
      }
      // what can be seen of the name belongs to no button, which says more
      const label = svg("g", {
        class: mark.getAttribute("class"), "data-method": name, "aria-hidden": "true",
        onpointermove: (event) => chart.showNote(event, name, ...lines),
      });
      const endY = atEnd.get(method);
      if (endY !== undefined) {
        const value = view.numbers(last).values[method];
        label.append(svg("path", { class: "lead", d: `M${end + 6},${axis.place(value)}L${end + 20},${endY}` }));
        label.append(svg("rect", { class: "reach", x: end + 21, y: endY - ROW / 2, width: after - 21, height: ROW }));
        label.append(text(end + 24, endY + 4, name));
        label.lastChild.append(svg("tspan", { dx: 6, class: "value" }, page.number(value)));
      }
      const startY = atStart.get(method);
      if (startY !== undefined) {
        label.append(svg("path", { class: "lead", d: `M${start - 6},${axis.place(view.numbers(first).values[method])}L${start - 20},${startY}` }));
        label.append(text(start - 24, startY + 4, name, { "text-anchor": "end" }));
      }
      all.append(mark, label);
    }
    return all;
  };

  const drawLines = (view, plot, width) => {
    const panels = view.overview.panels;
    const columns = scales.between(Math.floor(width / 330), 1, panels.length);
    const rows = Math.ceil(panels.length / columns);
    const shown = view.shown();
    const height = rows > 1 ? 380 : HEIGHT;
    const { groups } = view.overview;
    const numbers = groups.flatMap((group) => shown.map((method) => view.numbers(group).values[method]));
    const names = labelWidth(view, shown);
    const each = width / columns;
    const wide = each >= 480;
    const after = names + 24 + 44;
    const before = wide ? names + 26 : 34;
    const picture = chart.picture(width, rows * height, `${view.what} by ${view.overview.within.at(-1).name}`);
    const bottom = height - 14;
    const axis = scales.fitting(numbers, bottom, TOP, { linear: view.statistic === "rank", times: TIMES });
    panels.forEach((panel, at) => {
      const [row, column] = [Math.floor(at / columns), at % columns];
      const body = panelOf(view, panel, shown, axis, {
        left: column * each, right: (column + 1) * each - (columns > 1 ? 12 : 0), bottom, before, after, wide,
      });
      const whole = svg("g", { transform: `translate(0 ${row * height})` }, body);
      if (panel.title) whole.append(text(column * each + before, 11, panel.title, { class: "title" }));
      picture.append(whole);
    });
    plot.replaceChildren(picture);
    return {
      finding: finding(view),
      caption: [
        strong(`${view.what}${view.unit ? `, ${view.unit}` : ""}${axis.name && `, ${axis.name}`}. `),
        ...view.overview.within.map(({ times }) => times && `${times} `), "A line per method. ", ...(groups.some((group) => view.numbers(group).best.length) ? [`Blue: the ${view.end} in some group, with its 95 % intervals; a large dot where it is. `] : []),
        ...(groups.some((group) => view.numbers(group).tied.length) ? ["Ringed: may be the best there. "] : []),
        ...(view.reference === null ? [] : ["Dashed: the reference. "]),
        axis.log ? "Equal slopes are equal ratios. " : "", hint("Click a line or a name to follow it through the page."),
      ],
    };
  };

  // Places in words: who climbs and who falls between the first group and the last.
  const finding = (view) => {
    const groups = view.panel.groups.filter((group) => view.shown([group]).length > 1);
    if (view.better === "none" || !groups.length || view.overview.json.is_sequence) return [];
    const firsts = groups.map((group) => view.numbers(group).first);
    const parts = [];
    const [first, last] = [groups[0], groups.at(-1)];
    const panel = view.overview.panels.length > 1 ? [`${view.panel.title}: `] : [];
    const same = firsts.every((methods) => methods.length === 1 && methods[0] === firsts[0][0]);
    if (same && groups.length > 1) parts.push(view.overview.methods[firsts[0][0]], ` has the ${view.end} number throughout. `);
    else if (groups.length > 1) {
      const after = new Map(view.ranked(last).map((method, at) => [method, at + 1]));
      const moves = view.ranked(first).map((method, at) => ({ method, from: at + 1, to: after.get(method) })).filter(({ to }) => to)
        .sort((a, b) => a.to - a.from - (b.to - b.from));
      const [up, down] = [moves[0], moves.at(-1)];
      const word = (move) => [view.overview.methods[move.method], ` ${move.to < move.from ? "climbs" : "falls"} from place ${move.from} to ${move.to}`];
      if (up?.to < up?.from) {
        parts.push(`${panel.length ? "from" : "From"} ${view.groupText(first)} to ${last.texts.at(-1)}, `, ...word(up));
        parts.push(...(down.to > down.from ? [", ", ...word(down)] : []), ". ");
      }
    }
    const factors = groups.map((group) => {
      const ranked = view.ranked(group);
      const { values } = view.numbers(group);
      const [low, high] = [values[ranked[0]], values[ranked.at(-1)]].sort((a, b) => a - b);
      return low > 0 && view.statistic !== "rank" ? high / low : NaN;
    });
    if (factors.every(Number.isFinite) && factors.length <= 6) {
      parts.push(`${panel.length && !parts.length ? "from" : "From"} the lowest to the highest is a factor of ${factors.map((factor) => (factor < 10 ? factor.toFixed(1) : factor.toFixed(0))).join(", ")}.`);
    }
    return parts.length ? [...panel, ...parts] : [];
  };

  // A single group: dots on one axis, with the names that fit above them.
  const drawStrip = (view, plot, width) => {
    const shown = view.shown();
    const { values, tied } = view.numbers();
    const ranked = view.ranked();
    const axis = scales.fitting(shown.map((method) => values[method]), 16, width - 16, { linear: view.statistic === "rank", times: TIMES });
    const levels = [];
    const names = scales.thin([...ranked].sort((a, b) => view.weight(b) - view.weight(a)), 40, (method) => view.weight(method) > 0);
    // each name stands on the lowest level where it has room
    const labels = [...ranked].filter((method) => names.has(method)).map((method) => {
      const half = chart.textWidth(view.overview.methods[method]) / 2 + 5;
      const middle = scales.between(axis.place(values[method]), half, width - half);
      let level = levels.findIndex((right) => right < middle - half);
      if (level < 0) level = levels.length;
      levels[level] = middle + half;
      return { method, middle, level };
    });
    const base = 26 + levels.length * 17;
    const height = base + 40;
    const picture = chart.picture(width, height, `${view.what} of ${shown.length} methods`);
    for (const { value, text: label } of axis.ticks(70)) {
      picture.append(line(axis.place(value), base, axis.place(value), base + 6, "axis"), text(axis.place(value), base + 20, label, { class: "tick", "text-anchor": "middle" }));
    }
    picture.append(line(8, base, width - 8, base, "axis"));
    for (const method of [...shown].sort((a, b) => view.weight(a) - view.weight(b))) {
      const name = view.overview.methods[method];
      const px = axis.place(values[method]);
      const mark = svg("g", {
        ...chart.methodMark(view, method, ranked.indexOf(method), `${name}: ${view.text(values[method])}`),
        class: `method ${view.roles(method)}`,
        onpointermove: (event) => chart.showNote(event, name, ...describe(view, method, [view.group])),
      }, svg("circle", { cx: px, cy: base, ...view.dot(method, view.group, 4.5) }), svg("circle", { cx: px, cy: base, r: 12, class: "reach" }));
      const label = labels.find((label) => label.method === method);
      if (label) {
        const y = base - 14 - label.level * 17;
        mark.append(svg("path", { class: "lead", d: `M${px},${base - 7}L${label.middle},${y + 3}` }), text(label.middle, y, name, { "text-anchor": "middle" }));
      }
      picture.append(mark);
    }
    plot.replaceChildren(picture);
    return {
      caption: [
        strong(`${view.what}${view.unit ? `, ${view.unit}` : ""}${axis.name && `, ${axis.name}`}. `),
        "A dot per method. ", view.numbers().best.length ? `Blue: the ${view.end}. ` : "", tied.length ? "Ringed: may be the best. " : "", hint("Click a dot or a name to follow it through the page."),
      ],
    };
  };

  const draw = (host, view) => chart.mount(host, view, {
    className: "line-chart",
    draw: (plot, width) => {
      if (!view.shown().length) {
        plot.replaceChildren(page.element("p", {}, `No ${view.overview.json.blocks_name} are left by the filter.`));
        return {};
      }
      return view.overview.groups.length > 1 ? drawLines(view, plot, width) : drawStrip(view, plot, width);
    },
  });

  return { draw };
});
