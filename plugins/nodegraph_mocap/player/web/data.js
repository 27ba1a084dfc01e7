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

  // Whole steps of (rows, length), told as differences along each row, their four bytes apart.
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

  const scaledBy = (steps, step) => Float32Array.from(steps, (one) => one * step);

  const recordingOf = (blob, told, panels) => {
    const steps = stepsOf(blob, told.positions, told.like === null ? null : panels[told.like].steps);
    const count = told.markers.length * told.frames;
    const origin = new Uint8Array(blob.buffer, blob.start + told.origin, count);
    const made = origin.some((one) => one > 1);
    return { ...told, steps, origin, made, places: scaledBy(steps, told.positions.step) };
  };

  const animationOf = (blob, told) => {
    const weights = scaledBy(stepsOf(blob, told.weights), told.weights.step);
    const known = new Uint8Array(blob.buffer, blob.start + told.known, told.frames);
    const motion = told.motion && new Float32Array(blob.buffer, blob.start + told.motion.at, told.motion.length);
    return { ...told, weights, known, motion };
  };

  // Of a morph only what it moves is kept: most morphs of a face leave most of a head alone.
  const morphOf = (offsets) => {
    const moved = [];
    offsets.forEach((one, place) => { if (one !== 0) moved.push(place); });
    return { places: Uint32Array.from(moved), offsets: Float32Array.from(moved, (place) => offsets[place]) };
  };

  const headOf = (blob, told) => {
    const vertices = scaledBy(stepsOf(blob, told.vertices), told.vertices.step);
    const all = scaledBy(stepsOf(blob, told.morphs), told.morphs.step);
    const size = vertices.length;
    const morphs = Array.from({ length: size ? all.length / size : 0 }, (_, k) => morphOf(all.subarray(k * size, (k + 1) * size)));
    return { vertices, morphs, faces: stepsOf(blob, told.faces), count: told.count };
  };

  // One playback: its panels with their arrays, and what they have in common.
  const playbackOf = async (text) => {
    const blob = await unpacked(text);
    const heads = blob.head.heads.map((told) => headOf(blob, told));
    const panels = [];
    for (const told of blob.head.panels) {
      panels.push(told.kind === "mesh"
        ? { ...animationOf(blob, told), head: heads[told.head] }
        : recordingOf(blob, told, panels));
    }
    const truth = blob.head.truth === null ? null : panels[blob.head.truth];
    const rate = Math.max(...panels.map((one) => one.rate));
    const seconds = Math.max(...panels.map((one) => one.frames / one.rate));
    return { ...blob.head, panels, truth, rate, seconds, ticks: Math.max(1, Math.round(seconds * rate)) };
  };

  return { playbackOf };
});
