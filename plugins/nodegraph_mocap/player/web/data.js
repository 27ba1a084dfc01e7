// What Python packed (nodegraph_mocap/player/data.py), as arrays again.
nodegraph.define("mocap/player/data", [], () => {
  // Where all four bytes of a number begin at a multiple of four, arrays need no copy; the blob
  // keeps to that. Its numbers are little-endian, as is every machine that runs a browser today.
  const unpacked = async (text) => {
    const binary = atob(text.trim());
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < bytes.length; i += 1) bytes[i] = binary.charCodeAt(i);
    const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    const buffer = await new Response(plain).arrayBuffer();
    const length = new DataView(buffer).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    return { head, buffer, start: 4 + length };
  };

  // Whole steps of (rows, length), packed as differences along each row, their four bytes apart.
  const stepsOf = ({ buffer, start }, { at, rows, length }, like) => {
    const count = rows * length;
    const planes = new Uint8Array(buffer, start + at, 4 * count);
    const steps = new Int32Array(count);
    for (let i = 0; i < count; i += 1) {
      const sum = planes[i] | (planes[count + i] << 8) | (planes[2 * count + i] << 16) | (planes[3 * count + i] << 24);
      steps[i] = i % length ? sum + steps[i - 1] : sum;
    }
    if (like) for (let i = 0; i < count; i += 1) steps[i] += like[i];
    return steps;
  };

  // A loop: Float32Array.from with a function takes ten times as long.
  const scaledBy = (steps, step) => {
    const scaled = new Float32Array(steps.length);
    for (let i = 0; i < steps.length; i += 1) scaled[i] = steps[i] * step;
    return scaled;
  };

  // How much of each stretch of time is missing, filled, repaired: (marker, stretch), 255 for all of it.
  const stripOf = (blob, { strip, markers }) => strip && {
    ...strip, kinds: strip.kinds.map((at) => new Uint8Array(blob.buffer, blob.start + at, markers.length * strip.stretches)),
  };

  const recordingOf = (blob, packed, panels) => {
    const steps = stepsOf(blob, packed.positions, packed.like === null ? null : panels[packed.like].steps);
    const count = packed.markers.length * packed.frames;
    const origin = new Uint8Array(blob.buffer, blob.start + packed.origin, count);
    const made = origin.some((code) => code > 1);
    return { ...packed, steps, origin, made, strip: stripOf(blob, packed), places: scaledBy(steps, packed.positions.step) };
  };

  const animationOf = (blob, packed) => {
    const weights = scaledBy(stepsOf(blob, packed.weights), packed.weights.step);
    const known = new Uint8Array(blob.buffer, blob.start + packed.known, packed.frames);
    const motion = packed.motion && new Float32Array(blob.buffer, blob.start + packed.motion.at, packed.motion.length);
    return { ...packed, weights, known, motion };
  };

  // Of a morph only what it moves is kept: most morphs of a face leave most of a head alone.
  const morphOf = (offsets) => {
    const moved = [];
    offsets.forEach((offset, place) => { if (offset !== 0) moved.push(place); });
    return { places: Uint32Array.from(moved), offsets: Float32Array.from(moved, (place) => offsets[place]) };
  };

  const headOf = (blob, packed) => {
    const vertices = scaledBy(stepsOf(blob, packed.vertices), packed.vertices.step);
    const all = scaledBy(stepsOf(blob, packed.morphs), packed.morphs.step);
    const size = vertices.length;
    const morphs = Array.from({ length: size ? all.length / size : 0 }, (_, k) => morphOf(all.subarray(k * size, (k + 1) * size)));
    return { vertices, morphs, faces: stepsOf(blob, packed.faces), count: packed.count };
  };

  // Weights over time: (shape, frame), NaN where one is missing.
  const curvesOf = (blob, packed) => {
    const known = new Uint8Array(blob.buffer, blob.start + packed.known, packed.names.length * packed.frames);
    const weights = scaledBy(stepsOf(blob, packed.weights), packed.weights.step);
    known.forEach((is, place) => { if (!is) weights[place] = NaN; });
    return { ...packed, weights };
  };

  // One playback: its panels with their arrays, and what they have in common.
  const playbackOf = async (text) => {
    const blob = await unpacked(text);
    const heads = blob.head.heads.map((packed) => headOf(blob, packed));
    const panels = [];
    for (const packed of blob.head.panels) {
      panels.push(packed.kind === "mesh"
        ? { ...animationOf(blob, packed), head: heads[packed.head] }
        : recordingOf(blob, packed, panels));
    }
    for (const panel of panels) delete panel.steps; // needed only for those that differ little from them
    const truth = blob.head.truth === null ? null : panels[blob.head.truth];
    const curves = blob.head.curves.map((packed) => curvesOf(blob, packed));
    const timed = [...panels, ...curves];
    const rate = Math.max(...timed.map((part) => part.rate));
    const seconds = Math.max(...timed.map((part) => part.frames / part.rate));
    const with_hand = panels.some((panel) => panel.strip);
    return { ...blob.head, panels, curves, truth, with_hand, rate, seconds, ticks: Math.max(1, Math.round(seconds * rate)) };
  };

  return { playbackOf };
});
