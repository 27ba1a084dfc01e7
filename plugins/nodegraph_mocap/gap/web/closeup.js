// A marker close up, with what every method made of it.
nodegraph.define("mocap/gap/closeup", ["page", "mocap/gap/packed", "mocap/gap/curves"], (page, packed, { pathOf, rangeOf }) => {
  const { svg } = page;
  const SIZE = 200;
  const RIM = 7; // what is farther out than the picture reaches is marked as far as this from its edge
  const DEEPER = 1.3; // times as deep as wide is a movement that is seen from the side

  // A round length, at most a third of the picture's width.
  const barOf = (size) => {
    const power = 10 ** Math.floor(Math.log10(size / 3));
    return power * [5, 2, 1].find((digit) => digit * power <= size / 3);
  };

  const drawClose = (block, lines) => {
    const full = lines.filter(({ role }) => role !== "rest");
    const runs = [...block.judged.runs, ...block.apart];
    const [first, last] = runs.find(([low, high]) => low <= block.at && block.at <= high) ?? [0, block.frames - 1];
    const [from, to] = [Math.max(0, first - 1), Math.min(block.frames - 1, last + 1)];
    const frames = Array.from({ length: to - from + 1 }, (_, at) => from + at);
    const pointsOf = ({ positions }) => frames.map((at) => packed.seen(block, packed.sample(positions, at)));
    const clear = (full.length ? full : lines).flatMap(pointsOf);
    const ranges = [0, 1, 2].map((k) => rangeOf(clear.map((point) => point[k])));
    const extent = ranges.map(([low, high]) => high - low);
    const side = extent[2] > DEEPER * extent[0] ? 2 : 0;
    const size = 1.3 * Math.max(0.5, extent[side], extent[1]);
    const middle = [side, 1].map((k) => (ranges[k][0] + ranges[k][1]) / 2);
    const place = (point) => [
      SIZE / 2 + ((point[side] - middle[0]) / size) * SIZE, SIZE / 2 - ((point[1] - middle[1]) / size) * SIZE,
    ];
    const bar = barOf(size);
    const element = svg("svg", { class: "close", viewBox: `0 0 ${SIZE} ${SIZE}`, role: "img", "aria-label": `${block.marker} close up, with all methods` },
      svg("rect", { class: "ground", width: SIZE, height: SIZE, rx: 8 }));
    const paths = svg("g", { class: "lines" });
    for (const line of lines) {
      paths.append(svg("path", { class: line.role, d: pathOf(pointsOf(line).map(place)), "data-line": line.name }));
    }
    const errors = svg("path", { class: "error" });
    const dots = lines.map(({ name, role }) => svg("circle", { class: role, r: role === "rest" ? 2.4 : 4.5, "data-line": name }, svg("title", {}, name)));
    const isInside = (point) => point.every((value) => value >= 0 && value <= SIZE);
    const onRim = (point) => {
      const far = Math.max(...point.map((value) => Math.abs(value - SIZE / 2)));
      return point.map((value) => SIZE / 2 + ((value - SIZE / 2) * (SIZE / 2 - RIM)) / far);
    };
    const isKnown = ([x, y]) => Number.isFinite(x + y);
    const leaving = lines.filter((line) => pointsOf(line).map(place).some((point) => isKnown(point) && !isInside(point))).length;
    const length = (bar / size) * SIZE;
    element.append(paths, errors, ...dots,
      svg("path", { class: "bar", d: `M10,${SIZE - 10}h${length.toFixed(1)}` }),
      svg("text", { x: 10, y: SIZE - 15 }, `${Number(bar.toPrecision(1))} ${block.unit}`),
      svg("text", { x: 10, y: 18 }, side ? "from the side" : "from the front"));
    const move = (at) => {
      const truth = lines.find(({ role }) => role === "truth");
      const origin = truth && place(packed.seen(block, packed.sample(truth.positions, at)));
      let path = "";
      lines.forEach(({ role, positions }, line) => {
        const point = place(packed.seen(block, packed.sample(positions, at)));
        dots[line].toggleAttribute("hidden", !isKnown(point));
        if (!isKnown(point)) return;
        const outside = !isInside(point);
        dots[line].classList.toggle("outside", outside);
        const [x, y] = outside ? onRim(point) : point;
        dots[line].setAttribute("cx", x.toFixed(1));
        dots[line].setAttribute("cy", y.toFixed(1));
        if (origin && role !== "rest" && role !== "truth" && isKnown(origin)) {
          path += `M${origin.map((value) => value.toFixed(1))}L${x.toFixed(1)},${y.toFixed(1)}`;
        }
      });
      errors.setAttribute("d", path);
    };
    return { element, move, leaving };
  };

  return { drawClose };
});
