"use strict";
// One block in a dialog: what it is, why it is suspect, the errors of all methods, how it looks where
// a plugin shows that, and the command that computes it alone.
nodegraph.define("compare/block_dialog", ["page", "selection", "compare/chart"], (page, selection, chart) => {
  const { element } = page;
  const SHOWN = 5; // changes

  const shellWord = (label) => (/^[\w.:/@%+-]+$/.test(label) ? label : `'${String(label).replaceAll("'", "'\\''")}'`);

  // What is known of a block: labels of its group and its own, and when it is.
  const labelsOf = (view, block, member) => {
    const { start, frames } = view.group.json;
    return {
      ...member, ...Object.fromEntries(view.overview.within.map(({ axis }, at) => [axis, view.group.labels[at]])),
      ...Object.fromEntries(view.group.labelsOf(block)),
      ...(Number.isFinite(start?.[block]) ? { start: start[block] } : {}),
      ...(Number.isFinite(frames?.[block]) ? { frames: frames[block] } : {}),
    };
  };

  const commandOf = (view, block, member) => {
    const { text } = view.overview.json.command ?? {};
    const method = view.method ?? view.ranked()[0];
    const labels = { ...labelsOf(view, block, member), [view.overview.json.compare]: view.overview.methods[method] };
    return (text ?? "").replace(/\{([^{}]+)\}/g, (all, name) => (name in labels ? shellWord(labels[name]) : all));
  };

  const errorsOf = (view, block) => {
    const sign = view.metric.better === "higher" ? -1 : 1;
    const methods = view.shown([view.group]).map((method) => ({
      method, label: view.overview.methods[method], value: view.group.error(view.metric.name, block, method),
    }));
    const last = (value) => (Number.isFinite(value) ? sign * value : Infinity);
    return methods.sort((a, b) => last(a.value) - last(b.value) || a.method - b.method);
  };

  const bars = (view, errors) => {
    const most = Math.max(...errors.map(({ value }) => Math.abs(value)).filter(Number.isFinite), 1e-300);
    return element("ol", { class: "bars" }, ...errors.map(({ method, label, value }, at) => element("li", {},
      element("button", {
        ...chart.methodMark(view, method, at, null), role: null, type: "button", class: `method ${view.roles(method)}`,
        style: `--part: ${Number.isFinite(value) ? (100 * Math.abs(value)) / most : 0}%`, tabindex: at ? -1 : 0,
      }, element("span", {}, label), element("span", {}, page.number(value))))));
  };

  class BlockDialog {
    constructor(view, detail) {
      this.view = view;
      this.detail = detail;
      this.place = element("div", { class: "block" });
      this.dialog = element("dialog", { class: "block-dialog", "aria-labelledby": `block-title-${view.overview.json.node}` }, this.place);
      this.member = this.first;
      document.body.append(this.dialog);
      this.dialog.addEventListener("close", () => {
        if (view.block !== null) view.set({ block: null });
        this.key = null;
        this.place.replaceChildren();
      });
      this.dialog.addEventListener("click", (event) => {
        if (event.target === this.dialog) this.dialog.close();
        const mark = event.target.closest("[data-method]");
        if (mark) selection.toggle("method", mark.dataset.method);
      });
      this.dialog.addEventListener("keydown", (event) => {
        const step = { PageUp: -1, PageDown: 1 }[event.key];
        if (step) {
          event.preventDefault();
          this.step(step);
        } else if (event.target.closest(".bars")) chart.walk(this.dialog, event);
      });
      view.on(() => this.update());
      this.update();
    }

    // Blocks in the order of the dots: by the error of the best method, the largest first.
    get order() {
      const { view } = this;
      const first = view.ranked()[0];
      const error = (block) => view.group.error(view.metric.name, block, first);
      return [...view.numbers().blocks].sort((a, b) => error(b) - error(a));
    }

    // Of the axes that a block averages over, the labels that the page holds.
    get first() {
      return Object.fromEntries(this.view.overview.json.members.map(({ name, labels }) => [name, labels[0]]));
    }

    // What of the averaged is shown.
    members(block) {
      const { members } = this.view.overview.json;
      if (!members.length) return null;
      const choose = (name, labels) => (event) => {
        this.member = { ...this.member, [name]: labels[event.target.selectedIndex] };
        this.key = null;
        this.render(block);
        [...this.place.querySelectorAll(".members select")].find((each) => each.name === name).focus();
      };
      return element("p", { class: "members" }, `Mean over ${members.map(({ name }) => name).join(" and ")}; here `,
        ...members.map(({ name, labels }) => element("label", {}, `${name} `, element("select", { name, onchange: choose(name, labels) },
          labels.map((label) => element("option", { selected: label === this.member[name] }, String(label)))))));
    }

    step(by) {
      const { order, view } = this;
      const next = order[order.indexOf(view.block) + by];
      if (next !== undefined) view.set({ block: next });
    }

    update() {
      const { view, dialog } = this;
      const { block } = view;
      if (block === null) {
        if (dialog.open) dialog.close();
        return;
      }
      if (!dialog.open) dialog.showModal(); // which gives focus back to where it was
      this.render(block);
    }

    render(block) {
      const { view } = this;
      const { json } = view.overview;
      const key = `${view.group.index}/${block}`;
      const errors = errorsOf(view, block);
      const list = element("div", { class: "errors" },
        element("h3", {}, `${view.metric.name} here${view.metric.unit ? `, ${view.metric.unit}` : ""}`), bars(view, errors));
      if (key === this.key) {
        // another method or metric: what shows the block follows the selection by itself
        const focus = this.place.contains(document.activeElement) ? document.activeElement.dataset.key : null;
        this.list.replaceWith(list);
        this.list = list;
        if (focus) [...list.querySelectorAll("[data-key]")].find((mark) => mark.dataset.key === focus)?.focus();
        return;
      }
      this.key = key;
      this.list = list;
      const { order } = this;
      const at = order.indexOf(block);
      const reason = view.group.reasons[block];
      const labels = view.group.labelsOf(block).map(([name, label]) => `${name} ${label}`);
      const title = element("h2", { id: `block-title-${json.node}`, tabindex: -1 }, view.group.nameOf(block));
      const stage = element("div", { class: "stage" });
      const command = commandOf(view, block, this.member);
      const copy = element("button", { type: "button", class: "copy-command", onclick: async () => {
        await page.copy(command);
        copy.textContent = "Copied";
        page.announce("The command is copied");
      } }, "Copy");
      this.place.replaceChildren(
        element("div", { class: "head" },
          element("div", {}, title, element("p", {}, [view.group.title, ...labels].filter(Boolean).join(" \u00b7 ")),
            this.members(block), reason !== undefined ? element("p", { class: "suspect" }, `\u25c7 Suspect${reason ? `: ${reason}` : ""}.`) : null),
          element("div", { class: "steps" },
            element("button", { type: "button", disabled: at < 1, onclick: () => this.step(-1), title: "The one with the next larger error (Page Up)" }, "\u2190 larger"),
            element("button", { type: "button", disabled: at < 0 || at === order.length - 1, onclick: () => this.step(1), title: "The one with the next smaller error (Page Down)" }, "smaller \u2192"),
            element("button", { type: "button", onclick: () => this.dialog.close() }, "Close"))),
        element("div", { class: "body" }, stage, list),
        command ? element("div", { class: "command-line" }, element("code", { tabindex: 0 }, command), copy) : null);
      title.focus();
      this.show(stage, key, { errors, command });
    }

    // How the block looks: its data are in the page, come from a server, or need a run.
    async show(stage, key, { errors, command, now = {} }) {
      const { view, detail } = this;
      const { json } = view.overview;
      const say = (text) => stage.replaceChildren(element("p", { class: "quiet" }, text));
      const id = json.detail?.packed[key];
      if (!json.detail || !detail.module) {
        stage.remove();
        return;
      }
      const isFirst = Object.entries(this.first).every(([name, label]) => this.member[name] === label);
      let packed = id && isFirst && page.data(id);
      if (!packed && detail.server) {
        say("Computing this view \u2026");
        try {
          packed = await detail.server.get("detail", {
            node: json.node, compare: json.compare, methods: view.overview.methods, block: labelsOf(view, view.block, this.member),
            ...(detail.run ? { run: detail.run } : {}), ...now,
          });
        } catch (error) {
          if (this.key === key) stage.replaceChildren(...refusal(error, () => this.show(stage, key, { errors, command, now: { now: "1" } })));
          return;
        }
      }
      if (this.key !== key) return;
      if (!packed) {
        say(`This page does not hold how this one looks. Open the run with nodegraph open, or compute it with the command below.`);
        return;
      }
      detail.module.show(stage, packed, {
        overview: json, group: view.group.index, block: Number(key.split("/")[1]), selection, command,
        errors: errors.map(({ label, value }) => ({ method: label, value })),
      });
    }
  }

  // Why a view is not here, and how it can be had all the same.
  const refusal = ({ message, changed = [] }, again) => {
    if (!changed.length) return [element("p", { class: "quiet" }, `It could not be computed: ${message}`)];
    const more = changed.length > SHOWN ? [`and ${changed.length - SHOWN} more changes`] : [];
    return [
      element("p", { class: "quiet" }, message),
      element("ul", {}, [...changed.slice(0, SHOWN), ...more].map((text) => element("li", {}, text))),
      element("button", { type: "button", onclick: again }, "Compute with code and files as they are now"),
    ];
  };

  // Blocks of the group that are worth a look, as buttons.
  const suggest = (host, view) => {
    const { suggested } = view.overview.json;
    if (!suggested?.length) return;
    const entry = ({ group, block, why }) => {
      const from = view.overview.groups[group];
      const method = view.numbers(from).first[0];
      const value = method === undefined ? "" : ` \u00b7 ${view.overview.methods[method]} ${view.error(from.error(view.metric.name, block, method))}`;
      return element("button", {
        type: "button", class: `suggestion${from.isSuspect(block) ? " suspect" : ""}`,
        onclick: () => (method === undefined ? view.set({ block }) : view.open(block, method)),
      }, element("b", {}, `${from.isSuspect(block) ? "\u25c7 " : ""}${why[0].toUpperCase()}${why.slice(1)}`),
      element("span", {}, `${from.nameOf(block)}${value}`));
    };
    const list = element("div", { class: "suggestions" });
    const redraw = () => {
      const here = suggested.filter(({ group }) => group === view.group.index);
      host.hidden = !here.length;
      list.replaceChildren(...here.map(entry));
    };
    host.append(element("h4", {}, "Worth a look"), list);
    view.on((changed) => {
      if (changed.has("group") || changed.has("metric")) redraw();
    });
    redraw();
  };

  // Each row of the tables beside a comparison opens the block in which its method errs most.
  const joinRows = (tables, view) => {
    const groupOf = (heads, cells) => view.overview.groups.find(({ labels }) => labels.every((label, at) => {
      const column = heads.indexOf(view.overview.within[at].axis);
      return column < 0 || cells[column] === String(label);
    }));
    const textOf = (cell) => cell.textContent.trim();
    for (const table of tables) {
      const heads = [...table.tHead.rows[0].cells].map(textOf);
      for (const pick of table.querySelectorAll("tr[data-method] .pick")) {
        const row = pick.closest("tr");
        const method = view.place(row.dataset.method);
        const group = groupOf(heads, [...row.cells].map(textOf));
        if (method === null || !group || view.worst(method, group) === null) continue;
        const name = `Open the ${view.blockName} in which ${row.dataset.method} errs most${group.title ? `, ${group.title}` : ""}`;
        const door = element("button", {
          type: "button", class: "worst", tabindex: -1, title: name, "aria-label": name,
          onclick: () => view.open(view.worst(method, group), method, group),
        });
        pick.after(door);
        // beside the stop for the Tab key
        const walk = (from, key, to) => from.addEventListener("keydown", (event) => { if (event.key === key) to.focus(); });
        walk(pick, "ArrowRight", door);
        walk(door, "ArrowLeft", pick);
      }
    }
  };

  return { BlockDialog, suggest, joinRows };
});
