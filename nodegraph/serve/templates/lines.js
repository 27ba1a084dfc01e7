// Numbers over the time of a stream: a line for each alternative, named where it ends.
nodegraph.define("lines", ["page"], ({ svg, number }) => {
  const LEFT = 44;
  const TOP = 10;
  const BOTTOM = 24;
  const APART = 17; // px between two names
  const LETTER = 7.6;
  const COLOURS = 6;

  const ticks = (low, high, most) => {
    const rough = (high - low) / most;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 2.5, 5, 10].find((digit) => digit * power >= rough * (1 - 1e-9));
    const first = Math.ceil(low / step - 1e-9);
    return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, at) => Number(((first + at) * step).toPrecision(12)));
  };

  // Places near the wanted ones, in their order, so far apart that names can be read.
  const spread = (wanted, bottom) => {
    const order = wanted.map((_, at) => at).sort((a, b) => wanted[a] - wanted[b]);
    const placed = [...wanted];
    order.forEach((at, rank) => { if (rank) placed[at] = Math.max(placed[at], placed[order[rank - 1]] + APART); });
    order.reverse().forEach((at, rank) => { placed[at] = Math.min(placed[at], rank ? placed[order[rank - 1]] - APART : bottom); });
    return placed;
  };

  // A path that is broken where a number is not known.
  const path = (points) => {
    let open = false;
    return points.map(([x, y]) => {
      const command = y === null ? "" : `${open ? "L" : "M"}${x.toFixed(1)},${y.toFixed(1)}`;
      open = y !== null;
      return command;
    }).join("");
  };

  // lines: { label, values }, a value or null for each second.
  const draw = (seconds, lines, { title, unit, width, height }) => {
    const known = lines.flatMap(({ values }) => values.filter((value) => value !== null));
    const high = Math.max(...known, 0) * 1.08 || 1;
    const from = seconds[Math.max(0, seconds.findIndex((_, at) => lines.some(({ values }) => values[at] !== null)))];
    const last = Math.max(seconds.at(-1), from + 1);
    const ends = lines.map(({ label, values }) => `${label} ${number(values.at(-1))}`);
    const right = width - 16 - LETTER * Math.max(...ends.map((text) => text.length));
    const bottom = height - BOTTOM;
    const x = (second) => LEFT + ((right - LEFT) * (second - from)) / (last - from);
    const y = (value) => bottom - ((bottom - TOP) * value) / high;
    const at = lines.map(({ values }) => y(values.findLast((value) => value !== null) ?? 0));
    const names = spread(at, bottom);
    return svg("svg", {
      class: "lines", width, height, viewBox: `0 0 ${width} ${height}`, role: "img",
      "aria-label": `${title} to second ${number(last)}; now ${ends.join(", ")}${unit ? ` ${unit}` : ""}`,
    },
    ...ticks(0, high, 4).map((value) => [
      svg("line", { class: "grid", x1: LEFT, x2: right, y1: y(value), y2: y(value) }),
      svg("text", { x: LEFT - 7, y: y(value) + 4, "text-anchor": "end" }, String(value)),
    ]),
    ...ticks(from, last, Math.max(2, Math.floor((right - LEFT) / 90))).map((second) =>
      svg("text", { x: x(second), y: height - 5, "text-anchor": "middle" }, `${second}`)),
    svg("text", { x: right + 8, y: height - 5 }, "s"),
    ...lines.map(({ values }, place) => svg("path", {
      class: `line line-${place % COLOURS}`, d: path(values.map((value, moment) => [x(seconds[moment]), value === null ? null : y(value)])),
    })),
    ...ends.map((text, place) => svg("text", { class: `name line-${place % COLOURS}`, x: right + 8, y: names[place] + 4 }, text)));
  };

  return { draw };
});
