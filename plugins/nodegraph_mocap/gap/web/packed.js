// What Python packed for one block (nodegraph_mocap/gap/data.py), as numbers again.
nodegraph.define("mocap/gap/packed", [], () => {
  // Whole steps as millimetres; the least integer is a missing sample.
  const numbers = ({ step, data }, Kind = Int16Array) => {
    const bytes = Uint8Array.from(atob(data), (character) => character.charCodeAt(0));
    const steps = new Kind(bytes.buffer);
    const missing = Kind === Int8Array ? -128 : -32768;
    return Float64Array.from(steps, (value) => (value === missing ? NaN : value * step));
  };

  const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];

  // Positions are (frame, xyz) one after the other, from the centre of the view; so are `points`
  // of the face, (pose, marker, xyz).
  const unpacked = (data) => {
    const common = numbers(data.common);
    const apart = data.apart.flatMap(([first, last]) => Array.from({ length: last - first + 1 }, (_, at) => first + at));
    const methods = data.estimates.map(({ method, ...packed }) => {
      const own = numbers(packed);
      const positions = common.slice();
      apart.forEach((frame, at) => positions.set(own.subarray(3 * at, 3 * at + 3), 3 * frame));
      return { name: method, positions };
    });
    const rest = numbers(data.face.rest);
    const points = numbers(data.face.moved, Int8Array).map((moved, at) => moved + rest[at % rest.length]);
    return {
      ...data, common, methods, truth: data.truth && numbers(data.truth),
      axesOfView: [data.right, data.up, cross(data.right, data.up)],
      face: { ...data.face, points, poses: rest.length ? points.length / rest.length : 0 },
      frameAt: (at) => data.start + at * data.every,
    };
  };

  const sample = (positions, at) => Array.from(positions.subarray(3 * at, 3 * at + 3));

  // Right, up and towards the viewer.
  const seen = (block, point) => block.axesOfView.map((axis) => axis.reduce((sum, part, k) => sum + part * point[k], 0));

  // The face at a frame, evenly between the poses beside it; NaN for a missing marker.
  const faceAt = ({ face }, at) => {
    const { points, every, poses, markers } = face;
    const first = Math.min(Math.floor(at / every), poses - 1);
    const next = Math.min(first + 1, poses - 1);
    const share = at / every - first;
    return markers.map((_, marker) => [0, 1, 2].map((k) => {
      const [before, after] = [first, next].map((pose) => points[3 * (pose * markers.length + marker) + k]);
      if (Number.isNaN(before)) return share >= 0.5 ? after : NaN;
      return Number.isNaN(after) ? before : before + Math.min(share, 1) * (after - before);
    }));
  };

  return { unpacked, sample, seen, faceAt };
});
