// The node in hand as forms, and the dialogs that add nodes and set axes. Every edit goes to the
// server as one action, and what comes back is shown anew.
nodegraph.define("panel", ["page", "editor"], ({ element }, editor) => {
  const holder = document.getElementById("panel");
  const search = document.getElementById("search");
  let shown = ""; // the node and the revision that the panel shows
  let all = []; // the nodes that can be added
  let source = ""; // what feeds the one that will be; none for the node in hand

  const button = (text, onclick, attributes) => element("button", { type: "button", onclick, ...attributes }, text);
  const edit = async (action, values) => {
    const done = await editor.act(action, { arguments: values });
    await draw();
    return done;
  };
  const option = (value, text, attributes) => element("option", { value, ...attributes }, text ?? value);
  const id_of = (...words) => `panel-${words.join("-").replace(/\W+/g, "-")}`;

  // Options, of which those that have a reason against them come last and cannot be chosen.
  const fitting = (items, text, value) => {
    const fits = items.filter(({ reason }) => !reason).map((item) => option(value(item), text(item)));
    const rest = items.filter(({ reason }) => reason);
    if (rest.length) fits.push(element("optgroup", { label: "These do not fit" }, rest.map((item) => option(value(item), `${value(item)}: ${item.reason}`, { disabled: true }))));
    return fits;
  };

  // ---- settings ----

  const setting = (item) => {
    const id = id_of(...item.path);
    const save = ({ target }) => {
      target.defaultValue = target.value;
      edit("set", { path: item.path, value: target.value });
    };
    const known = [...item.words, ...item.variables];
    const attributes = { id, onchange: save, "aria-describedby": `${id}-about`, required: item.is_required && !item.shared };
    const field = item.is_closed
      ? element("select", attributes, option("", item.shared ? `(${item.shared}, as in all alternatives)` : "(default)"), known.map((word) => option(word)),
        item.value && !known.includes(item.value) ? option(item.value) : null)
      : element("input", { ...attributes, list: `${id}-list`, placeholder: item.shared, autocomplete: "off", spellcheck: "false" });
    field.value = field.defaultValue = item.value;
    return element("div", { class: "editor-field" },
      element("label", { for: id }, item.name), field,
      item.is_closed ? null : element("datalist", { id: `${id}-list` }, known.map((word) => option(word))),
      element("small", { id: `${id}-about`, class: "quiet" }, item.about));
  };

  const section = (node, part) => element("fieldset", { "data-alternative": part.alternative },
    element("legend", {}, part.title || part.about[0] || node.name),
    part.about.length ? element("p", { class: "quiet" }, part.title ? part.about.join(": ") : part.about.slice(1).join(" ")) : null,
    part.settings.map(setting),
    part.settings.length ? null : element("p", { class: "quiet" }, part.is_known
      ? "It has no settings."
      : "What it uses is not installed, or cannot be read: its ports and settings stand in the text."));

  // ---- what feeds it ----

  const port = (node, item) => {
    const id = id_of("port", item.name);
    const known = item.sources.some(({ source }) => source === item.feed);
    const field = element("select", {
      id, "aria-describedby": `${id}-about`,
      onchange: ({ target }) => (target.value
        ? edit("connect", { node: node.name, port: item.name, source: target.value })
        : edit("disconnect", { node: node.name, port: item.name })),
    },
    option("", item.is_optional ? "(nothing)" : "(nothing yet)"),
    known || !item.feed ? null : option(item.feed, item.feed, { disabled: true }),
    fitting(item.sources, ({ source, type }) => (type ? `${source}: ${type}` : source), ({ source }) => source));
    field.value = item.feed;
    return element("div", { class: "editor-field" },
      element("label", { for: id }, item.name), field,
      element("small", { id: `${id}-about`, class: "quiet" }, [item.type, item.about].filter(Boolean).join(". ")));
  };

  // ---- methods ----

  const rivals = (node) => {
    const parts = [];
    if (node.rivals.length) {
      const [again, others] = [true, false].map((is_used) => node.rivals.filter((each) => each.is_used === is_used));
      const about = element("small", { id: "panel-rival-about", class: "quiet" });
      const field = element("select", { id: "panel-rival", "aria-describedby": about.id, onchange: () => explain() },
        fitting(others, ({ use }) => use, ({ use }) => use),
        again.length ? element("optgroup", { label: "Once more, with other settings" }, again.map(({ use }) => option(use))) : null);
      const explain = () => { about.textContent = node.rivals.find(({ use }) => use === field.value)?.about ?? ""; };
      const add = async () => {
        if (!field.value || !await edit("add_alternative", { node: node.name, use: field.value })) return;
        const added = [...holder.querySelectorAll("[data-alternative]")].pop();
        added?.scrollIntoView({ block: "nearest" });
        added?.querySelector("input, select")?.focus({ preventScroll: true });
      };
      explain();
      parts.push(element("div", { class: "editor-field editor-method" },
        element("label", { for: "panel-rival" }, "Another method beside it"), field, button("Add a rival", add), about));
    }
    if (node.alternatives.length > 1) {
      const field = element("select", { id: "panel-alternative" }, node.alternatives.map((label) => option(label)));
      parts.push(element("div", { class: "editor-field editor-method" },
        element("label", { for: "panel-alternative" }, "An alternative"), field,
        button("Remove it", () => edit("remove_alternative", { node: node.name, label: field.value }))));
    }
    return parts.length ? element("fieldset", {}, element("legend", {}, "Methods"), parts) : null;
  };

  const heading = (node) => {
    const name = element("input", { id: "panel-name", value: node.name, autocomplete: "off", spellcheck: "false" });
    const rename = async () => {
      const wanted = name.value.trim();
      name.defaultValue = name.value;
      if (wanted && wanted !== node.name && await edit("rename", { old: node.name, new: wanted })) editor.choose(wanted, { scroll: "picture" });
    };
    name.addEventListener("keydown", (event) => { if (event.key === "Enter") rename(); });
    const shows = element("input", { id: "panel-shows", type: "checkbox", onchange: () => edit(shows.checked ? "show" : "hide", { node: node.name }) });
    shows.checked = node.is_shown;
    return element("div", { class: "editor-field editor-name" },
      element("label", { for: "panel-name" }, "Name"), name, button("Rename", rename),
      button("Remove the node", () => edit("remove_node", { name: node.name })),
      element("span", {}, shows, " ", element("label", { for: "panel-shows" }, "In the report")));
  };

  let drawn = Promise.resolve();
  const draw = () => {
    const name = editor.chosen();
    const wanted = `${name} ${editor.known.revision}`;
    if (wanted !== shown) {
      shown = wanted;
      drawn = draw_node(name, wanted);
    }
    return drawn;
  };
  const draw_node = async (name, wanted) => {
    if (!name) {
      holder.replaceChildren(element("p", { class: "quiet" }, "Choose a card to see its settings and what feeds it."));
      return;
    }
    let node;
    try {
      node = await editor.get("/node", { name });
    } catch (error) {
      holder.replaceChildren(element("p", { class: "quiet" }, error.message));
      return;
    }
    if (wanted !== shown) return;
    const focused = document.activeElement;
    const typed = focused?.matches("input:not([type])") ? { value: focused.value, range: [focused.selectionStart, focused.selectionEnd] } : null;
    const place = holder.dataset.node === name ? holder.scrollTop : 0;
    holder.dataset.node = name;
    holder.replaceChildren(
      element("h2", {}, node.name), heading(node),
      ...(node.ports.length ? [element("fieldset", {}, element("legend", {}, "What feeds it"), node.ports.map((each) => port(node, each)))] : []),
      rivals(node) ?? "", ...node.sections.map((part) => section(node, part)),
    );
    holder.scrollTop = place;
    const field = focused?.id && holder.querySelector(`#${CSS.escape(focused.id)}`);
    if (!field) return;
    field.focus();
    if (!typed) return;
    if (typed.value !== focused.defaultValue) field.value = typed.value; // of which the server has not heard
    field.setSelectionRange(...typed.range);
  };

  // ---- add a node ----

  const [words, list, name] = ["#search-words", "#search-list", "#search-name"].map((place) => search.querySelector(place));
  const find = () => {
    const wanted = words.value.toLowerCase().split(/\s+/).filter(Boolean);
    const found = all.filter(({ use, about }) => {
      const text = `${use} ${about.join(" ")}`.toLowerCase();
      return wanted.every((word) => text.includes(word));
    });
    const first = (each) => wanted.every((word) => each.use.includes(word));
    found.sort((a, b) => first(b) - first(a));
    list.replaceChildren(...found.map(({ use, about }) => option(use, `${use}: ${about[0]}`)));
    if (found.length) list.selectedIndex = 0;
    suggest();
  };
  const suggest = () => {
    // The family: a node may have several methods of it. Another node of the family, its method.
    const bases = list.value ? list.value.split(":").pop().split(".").map((word) => word.replace(/\W/g, "_")) : ["node"];
    const is_free = (word) => !Object.hasOwn(editor.known.nodes, word);
    let free = bases.find(is_free);
    for (let number = 2; !free; number += 1) free = [`${bases[0]}_${number}`].find(is_free);
    name.value = free;
    const about = all.find(({ use }) => use === list.value)?.about ?? ["Nothing has these words."];
    search.querySelector("#search-about").replaceChildren(...about.map((text) => element("p", {}, text)));
  };
  const add = async () => {
    if (!list.value) return;
    search.close();
    const wanted = name.value.trim();
    if (await edit("add_node", { name: wanted, use: list.value, after: source || editor.chosen() })) editor.choose(wanted, { scroll: "both" });
    await draw();
    holder.querySelector("input:invalid")?.focus();
  };
  // Search the nodes that can be added, or those that an output can feed.
  const open_search = async (output = "") => {
    source = output;
    all = await editor.get("/nodes", { source });
    search.querySelector("h2").textContent = source ? `Add a node that ${source} feeds` : "Add a node";
    words.value = "";
    find();
    search.showModal();
    words.focus();
  };
  words.addEventListener("input", find);
  list.addEventListener("change", suggest);
  list.addEventListener("dblclick", add);
  search.addEventListener("keydown", (event) => {
    if (event.target === words && ["ArrowDown", "ArrowUp"].includes(event.key)) {
      list.selectedIndex = Math.max(0, Math.min(list.length - 1, list.selectedIndex + (event.key === "ArrowDown" ? 1 : -1)));
      suggest();
    } else if (event.key === "Enter" && event.target.tagName !== "BUTTON") add();
    else return;
    event.preventDefault();
  });
  search.querySelector("#search-add").addEventListener("click", add);
  search.querySelector("#search-cancel").addEventListener("click", () => search.close());
  document.getElementById("add").addEventListener("click", () => open_search());
  document.getElementById("picture").addEventListener("dblclick", (event) => {
    if (!event.target.closest("[data-box]")) open_search();
  });
  document.addEventListener("keydown", (event) => {
    if (event.key !== "/" || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.closest("input, textarea, select, dialog, .cm-editor")) return;
    event.preventDefault();
    open_search();
  });

  // ---- axes ----

  const axes = document.getElementById("axes");
  const rows = axes.querySelector("#axes-rows");
  const axis_row = (axis) => {
    const [title, labels] = [id_of("axis", axis.name || "new"), id_of("labels", axis.name || "new")];
    const known = Boolean(axis.name);
    const heads = element("input", { id: title, value: axis.name, readonly: known, autocomplete: "off", spellcheck: "false" });
    const field = element("input", { id: labels, value: axis.labels, autocomplete: "off", spellcheck: "false" });
    const save = async () => {
      if (await edit("set_axis", { name: heads.value.trim(), labels: field.value })) draw_axes();
      else axes.querySelector("#axes-refused").textContent = document.getElementById("notice").textContent;
    };
    return element("div", { class: "editor-field" },
      element("label", { for: title }, known ? "Axis" : "New axis"), heads,
      element("label", { for: labels }, "Labels"), field, button(known ? "Set" : "Add", save));
  };
  const draw_axes = async () => {
    const known = await editor.get("/axes");
    axes.querySelector("#axes-refused").textContent = "";
    rows.replaceChildren(...known.map(axis_row), axis_row({ name: "", labels: "" }));
  };
  document.getElementById("axes-open").addEventListener("click", async () => {
    try {
      await draw_axes();
    } catch (error) {
      editor.say(error.message);
      return;
    }
    axes.showModal();
  });
  axes.querySelector("#axes-close").addEventListener("click", () => axes.close());

  // ---- a graph of their own ----

  const move = document.getElementById("move");
  const [moved, title, file, refused] = ["nodes", "name", "file", "refused"].map((part) => move.querySelector(`#move-${part}`));
  document.getElementById("move-open").addEventListener("click", () => {
    moved.replaceChildren(...Object.keys(editor.known.nodes).map((each) => option(each, each, { selected: each === editor.chosen() })));
    title.value = "part";
    file.value = "part.yaml";
    refused.textContent = "";
    move.showModal();
  });
  title.addEventListener("input", () => { file.value = `${title.value.trim()}.yaml`; });
  move.querySelector("#move-done").addEventListener("click", async () => {
    const nodes = [...moved.selectedOptions].map(({ value }) => value);
    const wanted = title.value.trim();
    if (!nodes.length) refused.textContent = "Choose the nodes that go.";
    else if (await edit("move_to_graph", { nodes, name: wanted, into: file.value.trim() })) {
      move.close();
      editor.choose(wanted, { scroll: "both" });
    } else refused.textContent = document.getElementById("notice").textContent;
  });
  move.querySelector("#move-cancel").addEventListener("click", () => move.close());

  editor.on(draw);
  draw();
  return { open_search };
});
