// How a marker moves: its speed over time, and how much of its movement lies at which frequency.
nodegraph.define("mocap/player/spectrum", [], () => {
  const SPAN = 0.01; // seconds between the two positions whose difference makes a speed
  const LONGEST = 1024; // frames of a segment
  const SHORTEST = 32;

  // Speed in mm/s from the positions on either side, NaN where one of them is missing.
  const speedsOf = ({ places, origin, frames, rate }, marker) => {
    const side = Math.max(1, Math.round((SPAN * rate) / 2));
    return Float64Array.from({ length: frames }, (_, frame) => {
      const [before, after] = [Math.max(0, frame - side), Math.min(frames - 1, frame + side)];
      if (before === after || !origin[marker * frames + before] || !origin[marker * frames + after]) return NaN;
      const moved = [0, 1, 2].map((k) => places[(3 * marker + k) * frames + after] - places[(3 * marker + k) * frames + before]);
      return (Math.hypot(...moved) * rate) / (after - before);
    });
  };

  // Runs of frames in which a marker is there, as [first, after the last].
  const runsOf = ({ origin, frames }, marker) => {
    const runs = [];
    for (let frame = 0; frame < frames; frame += 1) {
      if (!origin[marker * frames + frame]) continue;
      const last = runs.at(-1);
      if (last && last[1] === frame) last[1] = frame + 1;
      else runs.push([frame, frame + 1]);
    }
    return runs;
  };

  // The fast Fourier transform in place; the length is a power of two.
  const transform = (real, imaginary) => {
    const size = real.length;
    for (let i = 1, j = 0; i < size; i += 1) {
      let bit = size >> 1;
      for (; j & bit; bit >>= 1) j ^= bit;
      j ^= bit;
      if (i < j) {
        [real[i], real[j]] = [real[j], real[i]];
        [imaginary[i], imaginary[j]] = [imaginary[j], imaginary[i]];
      }
    }
    for (let length = 2; length <= size; length *= 2) {
      for (let k = 0; k < length / 2; k += 1) {
        const [c, s] = [Math.cos((2 * Math.PI * k) / length), -Math.sin((2 * Math.PI * k) / length)];
        for (let a = k; a < size; a += length) {
          const b = a + length / 2;
          const [x, y] = [c * real[b] - s * imaginary[b], c * imaginary[b] + s * real[b]];
          [real[b], imaginary[b]] = [real[a] - x, imaginary[a] - y];
          [real[a], imaginary[a]] = [real[a] + x, imaginary[a] + y];
        }
      }
    }
  };

  // Welch's estimate: the mean over segments of runs without gaps, each without its mean and tapered
  // by Hann's window, half over the next; all three coordinates together. In mm per root of Hz, null
  // where no run is long enough.
  const spectrumOf = (panel, marker) => {
    const { places, frames, rate } = panel;
    const runs = runsOf(panel, marker);
    const longest = Math.max(0, ...runs.map(([first, stop]) => stop - first));
    if (longest < SHORTEST) return null;
    const size = Math.min(LONGEST, 2 ** Math.floor(Math.log2(longest)));
    const taper = Float64Array.from({ length: size }, (_, i) => 0.5 - 0.5 * Math.cos((2 * Math.PI * i) / size));
    const weight = rate * taper.reduce((sum, value) => sum + value * value, 0);
    const power = new Float64Array(size / 2 + 1);
    let segments = 0;
    for (const [first, stop] of runs) {
      for (let start = first; start + size <= stop; start += size / 2) {
        segments += 1;
        for (let k = 0; k < 3; k += 1) {
          const at = (3 * marker + k) * frames + start;
          const part = Float64Array.from(places.subarray(at, at + size));
          const mean = part.reduce((sum, value) => sum + value, 0) / size;
          const real = part.map((value, i) => (value - mean) * taper[i]);
          const imaginary = new Float64Array(size);
          transform(real, imaginary);
          // every frequency but the highest stands for its negative, too
          for (let i = 0; i < power.length; i += 1) power[i] += ((2 * i < size ? 2 : 1) * (real[i] ** 2 + imaginary[i] ** 2)) / weight;
        }
      }
    }
    const points = Array.from(power.subarray(1), (value, i) => [((i + 1) * rate) / size, Math.sqrt(value / segments)]);
    return { points, size, segments };
  };

  return { speedsOf, spectrumOf, SHORTEST };
});
