// Weights as curves: a row per shape that moves, from 0 at its bottom to 1 at its top.
nodegraph.define("mocap/player/curves", ["mocap/player/rows"], ({ Rows }) => {
  const HEIGHT = 18; // px
  const LEAST = 0.005; // a shape that stays below is told, not drawn

  // For each pixel the weight that is farthest from 0 in the frames that lie there; NaN without any.
  const reduced = (weights, first, frames, width, share) => Array.from({ length: Math.ceil(width * share) }, (_, x) => {
    const start = Math.min(frames - 1, Math.floor((x / (width * share)) * frames));
    const stop = Math.max(start + 1, Math.floor(((x + 1) / (width * share)) * frames));
    let farthest = NaN;
    for (let frame = start; frame < Math.min(stop, frames); frame += 1) {
      const weight = weights[first + frame];
      if (!(Math.abs(weight) <= Math.abs(farthest))) farthest = Number.isNaN(weight) ? farthest : weight;
    }
    return farthest;
  });

  const curvesFor = (player, { label, names, weights, frames, rate }) => {
    const sizes = names.map((_, shape) => {
      let most = 0;
      for (let at = shape * frames; at < (shape + 1) * frames; at += 1) most = Math.max(most, Math.abs(weights[at]) || 0);
      return most;
    });
    const moving = names.map((_, shape) => shape).filter((shape) => sizes[shape] >= LEAST);
    const share = frames / rate / player.study.seconds;
    const still = names.length - moving.length;
    return new Rows(player, {
      title: `Weights of ${label || "the head"}${still ? `; ${still} of ${names.length} shapes stay below ${LEAST}` : ""}`,
      names: moving.map((shape) => names[shape]),
      height: HEIGHT,
      paint: (pen, row, { top, height, width }, ink) => {
        const shape = moving[row];
        const scale = (height - 3) / Math.max(1, sizes[shape]);
        reduced(weights, shape * frames, frames, width, share).forEach((weight, x) => {
          pen.fillStyle = Number.isNaN(weight) ? ink.missing : ink.curve;
          const size = Number.isNaN(weight) ? 2 : Math.max(0.5, Math.abs(weight) * scale);
          pen.fillRect(x, top + height - 1 - size, 1, size);
        });
      },
      valueAt: (row, seconds) => {
        const frame = Math.floor(seconds * rate + 1e-6);
        if (frame >= frames) return "";
        const weight = weights[moving[row] * frames + frame];
        return Number.isNaN(weight) ? "missing" : weight.toFixed(2).replace("-", "\u2212");
      },
    });
  };

  return { curvesFor };
});
