// x, y and z of one marker over time, at one scale, with the names of the lines beside them.
nodegraph.define("mocap/gap/curves", ["page"], (page) => {
  const { svg } = page;
  const LEFT = 38;
  const HEAD = 22;
  const LETTER = 8.2; // px, of bold text of 12 px in a wide font
  const APART = 14; // px between the middles of two labels
  const STRAY = 0.7; // how far, in ranges of what is drawn in full, other methods widen the picture
  let count = 0;

  const steps = (low, high, most) => {
    const rough = (high - low) / most;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find((digit) => digit * power >= rough);
    const first = Math.ceil(low / step);
    return Array.from({ length: Math.floor(high / step) - first + 1 }, (_, at) => (first + at) * step);
  };

  // Places near the wanted ones, in their order, at least APART from each other.
  const spread = (wanted, low, high) => {
    const order = wanted.map((_, at) => at).sort((a, b) => wanted[a] - wanted[b]);
    const placed = [];
    let last = low - APART;
    for (const at of order) { placed[at] = last = Math.max(wanted[at], last + APART); }
    let next = high + APART;
    for (const at of order.reverse()) { placed[at] = next = Math.min(placed[at], next - APART); }
    return placed;
  };

  const short = (name, letters) => (name.length > letters ? `${name.slice(0, letters - 1)}\u2026` : name);

  // A path through (x, y), broken where a value is missing; a sample alone is a dot.
  const pathOf = (points) => {
    let path = "";
    let open = false;
    points.forEach(([x, y], at) => {
      const known = Number.isFinite(y);
      if (known) path += `${open ? "L" : "M"}${x.toFixed(1)},${y.toFixed(1)}`;
      if (known && !open && !Number.isFinite(points[at + 1]?.[1])) path += "h0";
      open = known;
    });
    return path;
  };

  const rangeOf = (values) => {
    let [low, high] = [Infinity, -Infinity];
    for (const value of values) if (Number.isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
    return low <= high ? [low, high] : [0, 0];
  };

  const coordinate = (positions, k) => Array.from({ length: positions.length / 3 }, (_, at) => positions[3 * at + k]);

  // Frames in which the line of a method is drawn: where methods differ, and beside.
  const near = (block) => {
    const frames = new Set();
    for (const [first, last] of block.apart) for (let at = first - 1; at <= last + 1; at += 1) frames.add(at);
    return frames;
  };

  // Returns { element, move(frame), frameAt(x), methodAt(x, y), name(method, x, y) }. `lines` are
  // { name, role, positions }, the thin ones first.
  const draw = (block, lines, width) => {
    const height = width < 420 ? 92 : 112;
    const full = lines.filter(({ role }) => role !== "rest");
    const letters = Math.min(width < 420 ? 11 : 17, Math.max(5, ...full.map(({ name }) => name.length)));
    const right = width - Math.ceil(letters * LETTER) - 26;
    const clip = `curves-${count += 1}`;
    const x = (at) => LEFT + (right - LEFT) * (block.frames > 1 ? at / (block.frames - 1) : 0.5);
    const half = block.frames > 1 ? (right - LEFT) / (block.frames - 1) / 2 : 20;
    const shown = near(block);
    const ranges = [0, 1, 2].map((k) => {
      const clear = rangeOf([block.common, ...full.map((line) => line.positions)].flatMap((positions) => coordinate(positions, k)));
      const every = rangeOf(lines.flatMap((line) => coordinate(line.positions, k)));
      const room = STRAY * Math.max(0.5, clear[1] - clear[0]);
      return full.length ? [Math.max(every[0], clear[0] - room), Math.min(every[1], clear[1] + room)] : every;
    });
    const size = 1.14 * Math.max(1, ...ranges.map(([low, high]) => high - low));
    const bottom = 3 * (height + HEAD) + 20;
    const picture = svg("svg", {
      class: "curves", width, height: bottom, viewBox: `0 0 ${width} ${bottom}`, role: "img",
      "aria-label": `x, y and z of ${block.marker} in ${block.unit}, frames ${block.start} to ${block.frameAt(block.frames - 1)}`,
    });
    picture.append(svg("defs", {}, svg("clipPath", { id: clip }, ...[0, 1, 2].map((k) => svg("rect", {
      x: LEFT - 4, width: right - LEFT + 8, y: HEAD + k * (height + HEAD) - 1, height: height + 2,
    })))));
    const scales = [0, 1, 2].map((k) => {
      const top = HEAD + k * (height + HEAD);
      const [low, high] = ranges[k];
      const middle = (low + high) / 2;
      return { top, low: middle - size / 2, high: middle + size / 2, y: (value) => top + height / 2 - ((value - middle) / size) * height };
    });
    const [ground, curves, marks, words] = ["ground", "lines", "marks", "words"].map((name) => svg("g", { class: name }));
    curves.setAttribute("clip-path", `url(#${clip})`);
    marks.setAttribute("clip-path", `url(#${clip})`);
    scales.forEach(({ top, low, high, y }, k) => {
      const centre = block.centre[k];
      for (const [first, last] of block.judged.runs) {
        ground.append(svg("rect", { class: "judged", x: x(first) - half, width: x(last) - x(first) + 2 * half, y: top, height }));
      }
      for (const value of steps(low + centre, high + centre, 4)) {
        const at = y(value - centre);
        ground.append(svg("line", { class: "grid", x1: LEFT, x2: right, y1: at, y2: at }));
        ground.append(svg("text", { x: LEFT - 6, y: at + 4, "text-anchor": "end" }, String(Number(value.toFixed(6))).replace("-", "\u2212")));
      }
      const title = `${"xyz"[k]}${block.axes[k] ? ` \u00b7 ${block.axes[k]}` : ""}`;
      ground.append(svg("text", { class: "title", x: LEFT, y: top - 7 }, title));
      const points = (positions, at) => [x(at), y(positions[3 * at + k])];
      const all = Array.from({ length: block.frames }, (_, at) => at);
      curves.append(svg("path", { class: "common", d: pathOf(all.map((at) => points(block.common, at))) }));
      for (const { name, role, positions } of lines) {
        const drawn = all.map((at) => (role === "truth" || shown.has(at) ? points(positions, at) : [x(at), NaN]));
        curves.append(svg("path", { class: role, d: pathOf(drawn), "data-line": name }));
      }
      const truth = lines.find(({ role }) => role === "truth");
      const hidden = block.judged.runs.flatMap(([first, last]) => all.slice(first, last + 1));
      if (truth && 2 * half >= 8) {
        for (const at of hidden) {
          const [cx, cy] = points(truth.positions, at);
          if (Number.isFinite(cy)) marks.append(svg("circle", { class: "sample", cx, cy, r: 2.6 }));
        }
      }
      for (const at of truth ? block.suspects : []) {
        const [cx, cy] = points(truth.positions, at);
        marks.append(svg("circle", { class: "suspect", cx, cy, r: 8 }, svg("title", {}, `suspect: an impulse in frame ${block.frameAt(at)}`)));
      }
      const ends = full.map(({ positions }) => y(positions[3 * block.widest + k])).map((at) => (Number.isFinite(at) ? at : top + height / 2));
      const places = spread(ends, top + 6, top + height - 4);
      full.forEach(({ name, role }, at) => {
        words.append(svg("line", { class: role, x1: right + 6, x2: right + 20, y1: places[at], y2: places[at] }));
        words.append(svg("text", { class: role, x: right + 24, y: places[at] + 4 }, short(name, letters), svg("title", {}, name)));
      });
    });
    const room = Math.max(2, Math.floor((right - LEFT) / 46));
    const ticks = block.frames > 1 ? steps(block.start, block.frameAt(block.frames - 1), room).filter(Number.isInteger) : [block.start];
    for (const frame of ticks) {
      ground.append(svg("text", { x: x((frame - block.start) / block.every), y: bottom - 6, "text-anchor": "middle" }, frame));
    }
    ground.append(svg("text", { x: width, y: bottom - 6, "text-anchor": "end" }, "frame"));
    const cursor = svg("path", { class: "cursor" });
    const tip = svg("text", { class: "tip" });
    picture.append(ground, curves, cursor, marks, words, tip);
    const frameAt = (px) => Math.round(Math.min(1, Math.max(0, (px - LEFT) / (right - LEFT))) * (block.frames - 1));
    return {
      element: picture,
      frameAt,
      move: (at) => cursor.setAttribute("d", scales.map(({ top }) => `M${x(at).toFixed(1)},${top}v${height}`).join("")),
      // Writes a name beside the pointer.
      name: (name, px, py) => {
        tip.textContent = name ?? "";
        tip.setAttribute("x", px + (px > width / 2 ? -10 : 10));
        tip.setAttribute("y", py - 8);
        tip.setAttribute("text-anchor", px > width / 2 ? "end" : "start");
      },
      // The method whose line is nearest to a pixel, if any is near.
      methodAt: (px, py) => {
        const k = scales.findIndex(({ top }) => py >= top && py <= top + height);
        const at = frameAt(px);
        if (k < 0 || px < LEFT || px > right || !shown.has(at)) return null;
        const known = lines.filter(({ role }) => role !== "truth")
          .map(({ name, positions }) => [Math.abs(scales[k].y(positions[3 * at + k]) - py), name])
          .filter(([away]) => away < 8).sort((a, b) => a[0] - b[0]);
        return known.length ? known[0][1] : null;
      },
    };
  };

  return { draw, pathOf, rangeOf };
});
