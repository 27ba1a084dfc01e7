"use strict";
// Puts the charts of every comparison into their places on the page.
nodegraph.define("compare/charts", [
  "compare/overview", "compare/view", "compare/control_bar", "compare/line_chart", "compare/heat_table",
  "compare/cost_chart", "compare/map_chart", "compare/dots_chart", "compare/block_dialog", "server",
  "selection", "tables",
], (overviews, { View }, controlBar, lineChart, heatTable, costChart, mapChart, dotsChart, { BlockDialog, suggest, joinRows }, server, selection) => {
  const parts = (host, ...classes) => classes.map((name) => {
    const part = document.createElement("div");
    part.className = name;
    host.append(part);
    return part;
  });

  const DRAW = {
    controls: controlBar.draw,
    ranking: (host, view) => {
      host.classList.add("ranking");
      if (view.overview.panels.length > 1 || view.overview.groups.length > 5) host.classList.add("wide");
      const [lines, table] = parts(host, "", "");
      lineChart.draw(lines, view);
      heatTable.draw(table, view);
    },
    cost: costChart.draw,
    layout: mapChart.draw,
    blocks: (host, view) => {
      const [dots, more] = parts(host, "", "worth-a-look");
      dotsChart.draw(dots, view);
      suggest(more, view);
    },
  };

  [...document.querySelectorAll("[data-overview]")].filter((host) => host.querySelector("[data-chart]")).forEach((host, at) => {
    const overview = overviews.load(host.dataset.overview);
    const view = new View(overview, at);
    if (at === 0) selection.begin({ reference: overview.json.baseline });
    controlBar.joinTabs(view, host.dataset.overview);
    for (const place of host.querySelectorAll("[data-chart]")) DRAW[place.dataset.chart](place, view);
    joinRows(host.closest(".result")?.querySelectorAll("figure.table table.sortable") ?? [], view);
    const detail = { module: null, server, run: host.closest("[data-run]")?.dataset.run };
    const name = overview.json.detail?.module;
    // which module shows a block is only known from the data; modules that are defined now come next
    if (name) nodegraph.define(`compare/detail ${at}`, [name], (module) => { detail.module = module; });
    nodegraph.define(`compare/blocks ${at}`, name ? [`compare/detail ${at}`] : [], () => new BlockDialog(view, detail));
  });

  // methods in the verdicts follow the selection
  const named = [...document.querySelectorAll(".lead [data-method]")];
  const mark = (name, value) => {
    for (const each of named) each.classList.toggle(name, each.dataset.method === value);
  };
  for (const each of named) {
    each.addEventListener("click", () => selection.toggle("method", each.dataset.method));
    each.addEventListener("pointerenter", () => selection.hover("method", each.dataset.method));
    each.addEventListener("pointerleave", () => selection.hover("method", null));
  }
  selection.on((state) => mark("selected", state.method));
  selection.on_hover((kind, value) => {
    if (kind === "method") mark("hover", value);
  });
  mark("selected", selection.state.method);
  return {};
});
