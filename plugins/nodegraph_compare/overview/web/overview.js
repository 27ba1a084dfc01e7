"use strict";
// The numbers of a comparison: unpacks the blocks of each group, and recomputes means, medians and
// mean ranks over the blocks that a filter leaves. Verdicts are never recomputed.
nodegraph.define("compare/overview", ["page"], (page) => {
  const NONE = 65535;

  const codesOf = (text) => {
    const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
    return new Uint16Array(bytes.buffer);
  };

  // The value of each code of a metric; NaN for that which stands for no number.
  const valuesOfCodes = ({ log, low, high }) => {
    const step = (high - low) / (NONE - 1);
    const values = Float64Array.from({ length: NONE + 1 }, (_, code) => (log ? Math.exp(low + step * code) : low + step * code));
    values[NONE] = NaN;
    return values;
  };

  const cached = (make) => {
    const values = new Map();
    return (key) => {
      if (!values.has(key)) values.set(key, make(key));
      return values.get(key);
    };
  };

  const numeric = (values) => Float64Array.from(values ?? [], (value) => value ?? NaN);

  const medianOf = (values) => {
    if (!values.length) return NaN;
    const sorted = Float64Array.from(values).sort();
    const middle = sorted.length >> 1;
    return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
  };

  // Mean over clusters of the mean over each one's blocks, geometric for ratios.
  const clusterMean = (blocks, cluster, most, value, ratio) => {
    const sums = new Float64Array(most);
    const counts = new Uint32Array(most);
    for (const block of blocks) {
      sums[cluster[block]] += value(block);
      counts[cluster[block]] += 1;
    }
    let [total, clusters] = [0, 0];
    for (let at = 0; at < most; at += 1) {
      if (!counts[at]) continue;
      const mean = sums[at] / counts[at];
      total += ratio ? Math.log(mean) : mean;
      clusters += 1;
    }
    return ratio ? Math.exp(total / clusters) : total / clusters;
  };

  // The blocks of one combination of the labels of `within`.
  class Group {
    constructor(json, overview, index) {
      this.index = index;
      this.overview = overview;
      this.json = json;
      this.labels = json.labels;
      this.texts = json.texts;
      this.title = json.title;
      this.reasons = json.suspect ?? {};
      this.codes = cached((metric) => codesOf(json.errors[metric]));
      this.values = cached((metric) => this.unpacked(metric));
      this.complete = cached((metric) => this.completeIn(metric));
      this.column = cached((name) => codesOf(json.rows[name]));
      this.ranks = cached((metric) => this.ranksIn(metric));
      this.summaries = cached((key) => this.summarized(...JSON.parse(key)));
    }

    get size() {
      return this.cluster.length;
    }

    get cluster() {
      this.clusterCodes ??= codesOf(this.json.cluster);
      return this.clusterCodes;
    }

    get clusters() {
      this.clusterCount ??= this.cluster.reduce((most, code) => (code === NONE ? most : Math.max(most, code + 1)), 0);
      return this.clusterCount;
    }

    isSuspect(block) {
      return Object.hasOwn(this.reasons, block);
    }

    // (B x K), row by row; NaN where a method has no number.
    unpacked(metric) {
      const values = valuesOfCodes(this.json.scale[metric]);
      return Float64Array.from(this.codes(metric), (code) => values[code]);
    }

    error(metric, block, method) {
      return this.values(metric)[block * this.overview.methods.length + method];
    }

    // Methods with a number in some block.
    usable(metric) {
      const codes = this.codes(metric);
      const count = this.overview.methods.length;
      return this.overview.methods.map((_, method) => {
        for (let at = method; at < codes.length; at += count) if (codes[at] !== NONE) return true;
        return false;
      });
    }

    // Blocks in which every method has a number, or every method that has any.
    completeIn(metric) {
      const codes = this.codes(metric);
      const count = this.overview.methods.length;
      const usable = this.usable(metric);
      const blocks = [];
      for (let block = 0; block < this.size; block += 1) {
        let known = this.cluster[block] !== NONE;
        for (let method = 0; known && method < count; method += 1) {
          known = !usable[method] || codes[block * count + method] !== NONE;
        }
        if (known) blocks.push(block);
      }
      return blocks;
    }

    // Blocks that a filter leaves: suspects, marker (a label), region (labels).
    blocks(metric, { suspects, marker, region }) {
      const { layout } = this.overview;
      const wanted = marker !== null ? [marker] : region !== null ? this.overview.regionLabels(region) : null;
      if (suspects && !wanted) return this.complete(metric);
      const codes = wanted && this.column(layout.column);
      const known = wanted && new Set(wanted.map((label) => this.overview.columns[layout.column].indexOf(label)));
      return this.complete(metric).filter(
        (block) => (suspects || !this.isSuspect(block)) && (!known || known.has(codes[block])));
    }

    // (B x K) ranks within each block, 1 is best; equal values share the mean of their places.
    ranksIn(metric) {
      const values = this.values(metric);
      const count = this.overview.methods.length;
      const higher = this.overview.metric(metric).better === "higher";
      const ranks = new Float32Array(values.length).fill(NaN);
      for (const block of this.complete(metric)) {
        const row = values.subarray(block * count, (block + 1) * count);
        const sorted = row.filter((value) => !Number.isNaN(value)).sort();
        row.forEach((value, method) => {
          const first = sorted.indexOf(value);
          if (first < 0) return;
          const rank = (first + sorted.lastIndexOf(value)) / 2 + 1;
          ranks[block * count + method] = higher ? sorted.length + 1 - rank : rank;
        });
      }
      return ranks;
    }

    // Numbers of all methods: those of the table where nothing is left out, else computed here.
    summary(metric, statistic, filter) {
      return this.summaries(JSON.stringify([metric, statistic, filter]));
    }

    summarized(metric, statistic, filter) {
      const { overview, json } = this;
      const whole = filter.marker === null && filter.region === null;
      const plain = whole && metric === overview.json.metric;
      const doubtless = filter.suspects || !json.suspects;
      const blocks = this.blocks(metric, filter);
      const better = statistic === "rank" ? "lower" : overview.metric(metric).better;
      if (plain && doubtless) {
        const values = numeric(json[statistic]);
        return { values, blocks, filtered: false, first: firstOf(values, better), ...(statistic === "mean" ? judged(json) : UNMARKED) };
      }
      if (plain && statistic === "mean" && json.without_suspects) {
        const values = numeric(json.without_suspects.mean);
        return { values, blocks, filtered: true, first: firstOf(values, better), ...judged(json.without_suspects) };
      }
      const values = this.compute(metric, statistic, blocks);
      return { values, blocks, filtered: !whole || !doubtless, first: firstOf(values, better), ...UNMARKED };
    }

    compute(metric, statistic, blocks) {
      const count = this.overview.methods.length;
      const numbers = statistic === "rank" ? this.ranks(metric) : this.values(metric);
      const ratio = statistic === "mean" && this.overview.metric(metric).ratio;
      return Float64Array.from({ length: count }, (_, method) => {
        const value = (block) => numbers[block * count + method];
        if (!blocks.length) return NaN;
        if (statistic === "median") return medianOf(blocks.map(value));
        return clusterMean(blocks, this.cluster, this.clusters, value, ratio);
      });
    }

    // What identifies a block: [column, label] pairs, and when it is.
    labelsOf(block) {
      return Object.keys(this.json.rows).map((name) => {
        const code = this.column(name)[block];
        return [name, this.overview.columns[name][code]];
      });
    }

    framesOf(block) {
      const [start, frames] = [this.json.start?.[block], this.json.frames?.[block]];
      if (!Number.isFinite(start)) return "";
      return frames > 1 ? `frames ${start} to ${start + frames - 1}` : `frame ${start}`;
    }

    // A short name: the place in the layout, or else the labels that tell blocks apart; the frames.
    nameOf(block) {
      const labels = this.labelsOf(block).filter(([name]) => this.overview.columns[name].length > 1);
      const place = labels.find(([name]) => name === this.overview.layout?.column);
      const words = place ? [place[1]] : labels.map(([name, label]) => `${name} ${label}`);
      return [...words, this.framesOf(block)].filter(Boolean).join(", ") || "the only one";
    }
  }

  // Only a verdict marks and has intervals: what is described alone has none.
  const UNMARKED = { best: [], tied: [], low: [], high: [] };
  const judged = ({ best, tied, low, high }) => ({ best, tied, low: numeric(low), high: numeric(high) });

  // The methods at the better end, which no verdict need have found best.
  const firstOf = (values, better) => {
    const known = [...values.keys()].filter((method) => Number.isFinite(values[method]));
    if (better === "none" || !known.length) return [];
    const sign = better === "higher" ? -1 : 1;
    const first = Math.min(...known.map((method) => sign * values[method]));
    return known.filter((method) => sign * values[method] === first);
  };

  class Overview {
    constructor(json) {
      this.json = json;
      this.methods = json.methods.map(({ label }) => String(label));
      this.seconds = json.methods.map(({ seconds }) => seconds ?? null);
      this.metrics = json.metrics;
      this.layout = json.layout;
      this.within = json.within;
      this.columns = Object.fromEntries(Object.entries(json.columns).map(([name, { labels }]) => [name, labels]));
      this.groups = json.groups.map((group, index) => new Group(group, this, index));
      this.panels = this.panelsOf();
    }

    metric(name) {
      return this.metrics.find((metric) => metric.name === name);
    }

    regionLabels(region) {
      return (this.layout?.regions[region] ?? []).map((at) => this.layout.names[at]);
    }

    // Groups side by side in one picture share all labels but the last.
    panelsOf() {
      const panels = new Map();
      for (const group of this.groups) {
        const labels = group.labels.slice(0, -1);
        const key = JSON.stringify(labels);
        if (!panels.has(key)) panels.set(key, { groups: [] });
        panels.get(key).groups.push(group);
      }
      return [...panels.values()].map(({ groups }) => ({
        title: groups[0].texts.slice(0, -1).map((text, at) => `${this.within[at].name} ${text}`).join(", "), groups,
      }));
    }
  }

  return { load: (id) => new Overview(page.data(id)), NONE, medianOf, valuesOfCodes };
});
