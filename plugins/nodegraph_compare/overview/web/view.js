"use strict";
// What the charts of one comparison show: the reader's choice with its defaults, the numbers under
// it, the role of each method, and the words for them. The first comparison of a page has the whole
// selection; others share methods, and have group, block and filters of their own in it.
nodegraph.define("compare/view", ["page", "selection"], (page, selection) => {
  const OWN = ["metric", "statistic", "group", "block", "marker", "region", "suspects"];
  const UNSET = { metric: null, statistic: null, group: null, block: null, marker: null, region: null, suspects: true };
  const STATISTICS = { mean: "Mean", median: "Median", rank: "Mean rank" };

  class View {
    // Of the comparison at a place in the page, from 0.
    constructor(overview, place) {
      this.overview = overview;
      this.prefix = place ? `${place + 1}.` : "";
      this.readers = [];
      this.cache = new Map(); // numbers of groups until something changes
      const mine = new Map([...Object.keys(selection.state).filter((name) => name !== "frame" && !OWN.includes(name)).map((name) => [name, name]),
        ...OWN.map((name) => [this.prefix + name, name])]);
      selection.on((_, changed) => {
        const names = [...changed].filter((name) => mine.has(name)).map((name) => mine.get(name));
        if (names.length) this.notify(new Set(names));
      });
    }

    notify(changed) {
      this.cache.clear();
      for (const reader of this.readers) reader(changed);
    }

    on(reader) {
      this.readers.push(reader);
    }

    get state() {
      const own = OWN.map((name) => [name, selection.state[this.prefix + name] ?? UNSET[name]]);
      return { ...selection.state, ...Object.fromEntries(own) };
    }

    // A frame is one of the block that is open.
    set(values) {
      const other = "block" in values || "group" in values;
      const named = Object.entries({ ...(other && { frame: null }), ...values }).map(([name, value]) => [OWN.includes(name) ? this.prefix + name : name, value]);
      selection.set(Object.fromEntries(named));
    }

    toggle(name, value) {
      this.set({ [name]: this.state[name] === value ? null : value });
    }

    clear() {
      this.set({ ...UNSET, method: null, methods: null });
    }

    get metric() {
      return this.overview.metric(this.state.metric) ?? this.overview.metrics[0];
    }

    get statistic() {
      const { statistic } = this.state;
      return Object.hasOwn(STATISTICS, statistic ?? "") ? statistic : "mean";
    }

    // Which end of the numbers shown is better.
    get better() {
      return this.statistic === "rank" ? "lower" : this.metric.better;
    }

    // The better end in a word.
    get end() {
      return this.better === "higher" ? "highest" : "lowest";
    }

    get unit() {
      return this.statistic === "rank" ? "" : this.metric.unit;
    }

    get group() {
      const { groups } = this.overview;
      return groups[this.state.group] ?? groups[this.overview.json.shown_group];
    }

    get panel() {
      return this.overview.panels.find(({ groups }) => groups.includes(this.group));
    }

    get block() {
      const { block } = this.state;
      return block !== null && block < this.group.size ? block : null;
    }

    get method() {
      return this.place(this.state.method);
    }

    get reference() {
      return this.place(this.state.reference);
    }

    get marker() {
      const { layout } = this.overview;
      return layout?.names.includes(this.state.marker) ? this.state.marker : null;
    }

    get region() {
      return Object.hasOwn(this.overview.layout?.regions ?? {}, this.state.region ?? "") ? this.state.region : null;
    }

    get filter() {
      return { suspects: this.state.suspects !== false, marker: this.marker, region: this.region };
    }

    // Opens a block; a method that has no role yet is followed through the page.
    open(block, method, group = this.group) {
      const known = this.numbers(group).best.includes(method) || method === this.reference;
      this.set({
        block, ...(group === this.group ? {} : { group: group.index }), ...(known ? {} : { method: this.overview.methods[method] }),
      });
    }

    // The block in which a method errs most, of those that the filter leaves; null if there is none.
    worst(method, group = this.group) {
      const sign = this.metric.better === "higher" ? -1 : 1;
      let [worst, most] = [null, -Infinity];
      for (const block of this.numbers(group).blocks) {
        const error = sign * group.error(this.metric.name, block, method);
        if (error > most) [worst, most] = [block, error];
      }
      return worst;
    }

    get blockName() {
      return this.overview.json.blocks_name.replace(/s$/, "");
    }

    place(label) {
      const at = this.overview.methods.indexOf(String(label));
      return at < 0 ? null : at;
    }

    // Places of the methods that a reader wants to see and that have a number in one of the groups.
    shown(groups = this.overview.groups) {
      const { methods } = this.state;
      const chosen = methods && new Set(methods);
      const numbers = groups.map((group) => this.numbers(group).values);
      return this.overview.methods.flatMap((label, at) =>
        (!chosen || chosen.has(label)) && numbers.some((values) => Number.isFinite(values[at])) ? [at] : []);
    }

    numbers(group = this.group) {
      if (!this.cache.has(group)) this.cache.set(group, group.summary(this.metric.name, this.statistic, this.filter));
      return this.cache.get(group);
    }

    get filtered() {
      return this.numbers().filtered;
    }

    // The best of the shown methods first.
    ranked(group = this.group) {
      const { values } = this.numbers(group);
      const sign = this.better === "higher" ? -1 : 1;
      return this.shown([group]).sort((a, b) => sign * (values[a] - values[b]));
    }

    // Classes of a method in a group, or in any of several.
    roles(method, groups = [this.group]) {
      const best = groups.some((group) => this.numbers(group).best.includes(method));
      return [
        best && "best", method === this.reference && "reference", method === this.method && "selected",
      ].filter(Boolean).join(" ");
    }

    // How the method at the better end of a group is called.
    endOf(method, group = this.group) {
      const { best, tied } = this.numbers(group);
      return best.includes(method) && !tied.length ? "best" : this.end;
    }

    // Class and radius of a method's dot in a group.
    dot(method, group, small) {
      const { best, tied } = this.numbers(group);
      const isTied = tied.includes(method);
      return { class: isTied ? "mark tied" : "mark", r: best.includes(method) ? 6 : isTied ? 4.5 : small };
    }

    // The larger, the more a label of the method matters.
    weight(method, groups) {
      const roles = this.roles(method, groups);
      return 4 * roles.includes("selected") + 2 * roles.includes("best") + roles.includes("reference");
    }

    // How a value stands to the best one: a multiple, or a difference where a ratio means nothing.
    toBest(value, best) {
      if (!Number.isFinite(value) || !Number.isFinite(best)) return "";
      if (best > 0 && value > 0 && this.statistic !== "rank") {
        const times = this.better === "higher" ? best / value : value / best;
        return `\u00d7${times < 10 ? times.toFixed(2) : times < 1000 ? times.toFixed(0) : page.number(times)}`;
      }
      const difference = value - best;
      return `${difference < 0 ? "" : "+"}${page.number(difference)}`;
    }

    get what() {
      return this.statistic === "rank" ? `Mean rank by ${this.metric.name}` : `${STATISTICS[this.statistic]} ${this.metric.name}`;
    }

    text(value) {
      return `${page.number(value)}${this.unit && Number.isFinite(value) ? ` ${this.unit}` : ""}`;
    }

    error(value) {
      return `${page.number(value)}${this.metric.unit && Number.isFinite(value) ? ` ${this.metric.unit}` : ""}`;
    }

    // The last label of a group with its axis: "length 45".
    groupText(group) {
      const axis = this.overview.within.at(-1);
      return axis ? `${axis.name} ${group.texts.at(-1)}` : "all";
    }
  }

  const seconds = (value) => {
    const [size, unit] = value >= 1 ? [value, "s"] : value >= 1e-4 ? [value * 1e3, "ms"] : [value * 1e6, "\u00b5s"];
    return `${size < 10 ? +size.toFixed(1) : Math.round(size)} ${unit}`;
  };

  return { View, STATISTICS, seconds };
});
