"use strict";
// From numbers to pixels: linear and logarithmic scales, their ticks, and places of labels.
nodegraph.define("compare/scale", [], () => {
  const MANTISSAS = [[1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8], [1, 1.5, 2, 3, 5, 7], [1, 2, 5], [1, 3], [1]];
  const between = (value, low, high) => Math.min(high, Math.max(low, value));

  const extent = (values) => {
    let [low, high] = [Infinity, -Infinity];
    for (const value of values) {
      if (!Number.isFinite(value)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
    return low > high ? null : [low, high];
  };

  // A tick's number with as many decimals as its step needs; without a step, all that it has.
  const tickText = (value, step) => {
    const size = Math.abs(value);
    const digits = step ? between(Math.ceil(Math.log10(Math.max(size, step) / step)) + 1, 1, 15) : 2;
    const short = +value.toPrecision(digits);
    let text = String(short);
    if (size !== 0 && (size < 1e-3 || size >= 1e5)) text = short.toExponential().replace("e+", "e");
    else if (step) text = value.toFixed(between(Math.ceil(-Math.log10(step) - 1e-9), 0, 12));
    return text.replaceAll("-", "\u2212");
  };

  const linearTicks = (low, high, most) => {
    const rough = (high - low) / Math.max(1, most);
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = power * ([1, 2, 5].find((factor) => factor * power >= rough) ?? 10);
    const ticks = [];
    for (let count = Math.ceil(low / step - 1e-9); count * step <= high * (1 + 1e-12); count += 1) {
      const value = count * step;
      ticks.push({ value, text: tickText(value, step) });
    }
    return ticks;
  };

  const powersOf = (low, high, mantissas, every) => {
    const values = [];
    for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power += 1) {
      if (power % every !== 0) continue;
      values.push(...mantissas.map((mantissa) => +`${mantissa}e${power}`));
    }
    return values.filter((value) => value >= low && value <= high);
  };

  const logTicks = (low, high, most, apart) => {
    const fits = (values) =>
      values.length <= most + 1 && values.every((value, at) => !at || apart(values[at - 1], value));
    let values = MANTISSAS.map((mantissas) => powersOf(low, high, mantissas, 1)).find(fits);
    for (let every = 2; !values; every += 1) {
      const thin = powersOf(low, high, [1], every);
      if (fits(thin) || every > 300) values = thin;
    }
    if (values.length < 2) return linearTicks(low, high, most);
    return values.map((value) => ({ value, text: tickText(value) }));
  };

  // Values of 0 among others of many sizes: logarithmic, and linear below the least of these.
  const symmetric = (least) => ({ of: (value) => Math.asinh(value / least), back: (value) => least * Math.sinh(value) });
  const SPAN = 10; // of the sizes of values among which 0 needs that

  // A scale of an extent to pixels. Where it is logarithmic, equal distances are equal ratios; with
  // `least`, down to this.
  const scale = ([low, high], start, end, log, least = 0) => {
    const flat = low === high;
    if (log) [low, high] = flat ? [low / 1.25, high * 1.25] : [low, high];
    else if (flat) [low, high] = low === 0 ? [-1, 1] : [low - Math.abs(low) / 4, high + Math.abs(high) / 4];
    const of = least ? symmetric(least).of : log ? Math.log : (value) => value;
    const [first, last] = [of(low), of(high)];
    const place = (value) => start + ((of(value) - first) / (last - first)) * (end - start);
    const length = Math.abs(end - start);
    const ticks = (room) => {
      const most = Math.max(1, Math.floor(length / room));
      const apart = (a, b) => Math.abs(place(b) - place(a)) >= room * 0.6;
      if (least) return [{ value: 0, text: "0" }, ...logTicks(least, high, most - 1, apart)];
      return log ? logTicks(low, high, most, apart) : linearTicks(low, high, most);
    };
    const name = least ? `log scale above ${tickText(least)}` : log ? "log scale" : "";
    return { place, ticks, log, low, high, name };
  };

  // A scale of all values with room at both ends, logarithmic where none is below 0, and linear
  // below the least of those above it where some are 0. From end to end of a logarithmic one is at
  // least a factor of `times`.
  const fitting = (values, start, end, { linear = false, room = 0.04, times = 1 } = {}) => {
    const range = extent(values) ?? [0, 1];
    const log = !linear && range[0] > 0;
    if (range[0] === range[1]) return scale(range, start, end, log);
    if (log && range[1] < times * range[0]) {
      const [middle, half] = [Math.sqrt(range[0] * range[1]), Math.sqrt(times)];
      return scale([middle / half, middle * half], start, end, log);
    }
    const [above] = extent(values.filter((value) => value > 0)) ?? [0];
    const least = !linear && range[0] === 0 && range[1] > SPAN * above ? above : 0;
    const { of, back } = least ? symmetric(least) : log ? { of: Math.log, back: Math.exp } : { of: Number, back: Number };
    const margin = (of(range[1]) - of(range[0])) * room;
    return scale([back(of(range[0]) - margin), back(of(range[1]) + margin)], start, end, log, least);
  };

  // Places at least `gap` apart, in the same order and as near to the wanted ones as can be (least
  // squares): wanted places less their share of the gaps must rise, and those that fall are pooled.
  const spread = (wanted, gap, low, high) => {
    const order = wanted.map((_, at) => at).sort((a, b) => wanted[a] - wanted[b] || a - b);
    const pools = [];
    order.forEach((at, rank) => {
      pools.push({ sum: wanted[at] - rank * gap, count: 1 });
      while (pools.length > 1) {
        const [before, last] = pools.slice(-2);
        if (before.sum / before.count <= last.sum / last.count) break;
        pools.splice(-2, 2, { sum: before.sum + last.sum, count: before.count + last.count });
      }
    });
    const ceiling = high - (order.length - 1) * gap;
    const shifts = pools.flatMap(({ sum, count }) => Array(count).fill(between(sum / count, low, ceiling)));
    const places = [];
    order.forEach((at, rank) => { places[at] = shifts[rank] + rank * gap; });
    return places;
  };

  // Which of many items get a label: the important ones, and of the rest evenly as many as fit.
  const thin = (items, most, important) => {
    if (items.length <= most) return new Set(items);
    const kept = items.filter(important).slice(0, most);
    const rest = items.filter((item) => !kept.includes(item));
    const every = Math.ceil(rest.length / Math.max(1, most - kept.length));
    const more = most > kept.length ? rest.filter((_, at) => at % every === 0) : [];
    return new Set([...kept, ...more]);
  };

  return { between, extent, fitting, scale, spread, thin };
});
