"use strict";
// What all charts of a comparison show: metric, statistic, group, reference, region, suspects and
// methods, in a bar that stays in sight.
nodegraph.define("compare/control_bar", ["page", "compare/view"], (page, { STATISTICS }) => {
  const { element } = page;
  const FEW = 7;

  const option = (value, label, chosen) => element("option", { value, selected: value === chosen }, label);
  const select = (label, key, options, chosen, choose) => element("label", {}, label,
    element("select", { "data-key": key, onchange: (event) => choose(event.target.value) }, options.map(([value, name]) => option(value, name, chosen))));

  // A group of buttons of which one is chosen; of many labels, a list.
  const segments = (label, key, labels, chosen, choose) => {
    if (labels.length > FEW) {
      return select(label, key, labels.map((name, at) => [String(at), String(name)]), String(chosen), (value) => choose(Number(value)));
    }
    const move = (event) => {
      const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
      if (!step) return;
      event.preventDefault();
      choose((chosen + step + labels.length) % labels.length);
    };
    return element("div", { class: "segments", role: "radiogroup", "aria-label": label, onkeydown: move },
      element("span", { "aria-hidden": "true" }, label),
      ...labels.map((name, at) => element("button", {
        type: "button", role: "radio", "aria-checked": String(at === chosen), tabindex: at === chosen ? 0 : -1,
        "data-key": at === chosen ? key : null, onclick: () => choose(at),
      }, String(name))));
  };

  // The group whose labels differ from those of the present one in one axis; the nearest there is.
  const groupWith = (view, axis, label) => {
    const { labels } = view.group;
    const matches = view.overview.groups.filter((group) => group.labels[axis] === label);
    const agree = (group) => group.labels.filter((other, at) => other === labels[at]).length;
    return matches.sort((a, b) => agree(b) - agree(a))[0]?.index ?? view.group.index;
  };

  // The tabs of the verdicts, which work without scripts too, choose the same group.
  const joinTabs = (view, id) => {
    view.overview.within.forEach(({ name, labels }, axis) => {
      const tabs = [...document.getElementsByName(`${id}-${name}`)];
      if (tabs.length !== labels.length) return;
      const show = () => { tabs[labels.indexOf(view.group.labels[axis])].checked = true; };
      tabs.forEach((tab, at) => tab.addEventListener("change", () => {
        view.set({ group: groupWith(view, axis, labels[at]), block: null });
      }));
      view.on(show);
      show();
    });
  };

  const methodMenu = (view) => {
    const { methods } = view.overview;
    const chosen = new Set(view.state.methods ?? methods);
    const apply = (labels) => view.set({ methods: labels.length === methods.length || !labels.length ? null : labels });
    const box = (label) => element("label", {}, element("input", {
      type: "checkbox", checked: chosen.has(label), "data-key": `method ${label}`,
      onchange: (event) => apply(methods.filter((other) => (other === label ? event.target.checked : chosen.has(other)))),
    }), label);
    const leading = () => view.overview.groups.flatMap((group) => {
      const { first, tied } = view.numbers(group);
      return tied.length ? tied : first;
    });
    const kept = () => {
      const places = new Set([...leading(), view.method, view.reference]);
      apply(methods.filter((_, at) => places.has(at)));
    };
    return element("details", { class: "methods-menu" },
      element("summary", { "data-key": "methods" }, chosen.size < methods.length ? `${chosen.size} of ${methods.length} methods` : "All methods"),
      element("div", { class: "menu", role: "group", "aria-label": "Methods to show" },
        element("div", {}, element("button", { type: "button", "data-key": "all", onclick: () => apply(methods) }, "All"),
          element("button", { type: "button", "data-key": "leading", onclick: kept }, "Leading and reference")),
        ...methods.map(box)));
  };

  const chips = (view) => {
    const chip = (key, label, clear) => element("button", { type: "button", class: "chip", "data-key": key, "aria-label": `Clear ${label}`, onclick: clear }, label, element("span", { "aria-hidden": "true" }, " \u00d7"));
    return [
      view.method !== null && chip("chip method", view.overview.methods[view.method], () => view.set({ method: null })),
      view.marker !== null && chip("chip marker", view.marker, () => view.set({ marker: null })),
      view.region !== null && chip("chip region", view.region, () => view.set({ region: null })),
      view.state.methods && chip("chip methods", `${view.state.methods.length} methods`, () => view.set({ methods: null })),
    ].filter(Boolean);
  };

  const note = (view) => {
    const name = view.overview.json.blocks_name;
    const sample = view.group.size < view.group.json.all_blocks ? `The page holds ${view.group.size} of ${view.group.json.all_blocks} ${name}. ` : "";
    if (!view.numbers().filtered) return sample;
    return `${sample}Under the filter: ${view.numbers().blocks.length} ${name}; this explores, the answer above stands.`;
  };

  const draw = (host, view) => {
    const { overview } = view;
    const body = element("div", { class: "controls" });
    const status = element("p", { class: "filter-note", role: "status" });
    const more = element("button", {
      type: "button", class: "more-controls", "aria-expanded": "false",
      onclick: () => more.setAttribute("aria-expanded", String(host.classList.toggle("unfolded"))),
    }, "Filters");
    host.classList.add("control-bar");
    host.setAttribute("role", "group");
    host.setAttribute("aria-label", "What the charts show");
    host.replaceChildren(body, status);
    const suspects = overview.groups.reduce((sum, group) => sum + group.json.suspects, 0);
    const redraw = () => {
      const focus = host.contains(document.activeElement) ? document.activeElement.dataset.key : null;
      const unfolded = host.querySelector(".methods-menu")?.open;
      const { group, filter } = view;
      const groups = overview.within.flatMap(({ name, labels, texts }, axis) => (labels.length < 2 ? [] : [
        segments(name, `within ${name}`, texts, labels.indexOf(group.labels[axis]), (at) => view.set({ group: groupWith(view, axis, labels[at]), block: null }))]));
      const filters = [
        overview.metrics.length > 1 && select("Metric", "metric", overview.metrics.map(({ name, unit }) => [name, unit ? `${name}, ${unit}` : name]), view.metric.name, (metric) => view.set({ metric })),
        select("Statistic", "statistic", Object.entries(STATISTICS).map(([value, name]) => [value, name]), view.statistic, (statistic) => view.set({ statistic })),
        overview.methods.length > 1 && select("Reference", "reference", [["", "none"], ...overview.methods.map((label) => [label, label])],
          view.reference === null ? "" : overview.methods[view.reference], (reference) => view.set({ reference })),
        Object.keys(overview.layout?.regions ?? {}).length > 1 && select("Region", "region", [["", "all"], ...Object.keys(overview.layout.regions).map((region) => [region, region])],
          view.region ?? "", (region) => view.set({ region: region || null, marker: null })),
        suspects > 0 && element("button", {
          type: "button", class: "toggle", "data-key": "suspects", "aria-pressed": String(!filter.suspects),
          onclick: () => view.set({ suspects: !filter.suspects }),
        }, `Leave out suspect ${overview.json.blocks_name}`),
        overview.methods.length > 2 && methodMenu(view),
      ].filter(Boolean);
      const active = chips(view);
      if (active.length > 1 || !filter.suspects) active.push(element("button", { type: "button", class: "chip clear", "data-key": "clear", onclick: () => view.clear() }, "Clear"));
      body.replaceChildren(...groups, more, element("div", { class: "filters" }, ...filters), element("div", { class: "chips" }, ...active));
      if (unfolded) host.querySelector(".methods-menu").open = true;
      status.textContent = note(view);
      if (focus) [...host.querySelectorAll("[data-key]")].find((control) => control.dataset.key === focus)?.focus();
    };
    view.on(redraw);
    document.addEventListener("click", (event) => {
      const menu = host.querySelector(".methods-menu[open]");
      if (menu && event.target.isConnected && !menu.contains(event.target)) menu.open = false;
    });
    host.addEventListener("keydown", (event) => {
      const menu = event.key === "Escape" && event.target.closest(".methods-menu[open]");
      if (!menu) return;
      menu.open = false;
      menu.querySelector("summary").focus();
    });
    redraw();
  };

  return { draw, joinTabs };
});
