// Runs of the file: what would be computed, start, stop, and the states of the run on the cards.
nodegraph.define("run", ["page", "states", "editor"], ({ element, announce }, { Card, how_far }, editor) => {
  const MOST = 8; // lines of a list
  const many = (count) => count.toLocaleString("en");
  const part = (id) => document.getElementById(id);
  const holder = part("run-state");
  const dialog = part("start");
  let number = 0;
  let snapshot = null;
  let events = null;
  const cards = new WeakMap(); // by their boxes in the picture

  const link = (address, text) => element("a", { href: address, target: "_blank" }, text);
  const combinations = (node) => link(`/values?${new URLSearchParams({ run: snapshot.run, node })}`, "combinations and values");
  const few = (lines) => [...lines.slice(0, MOST), ...(lines.length > MOST ? [`and ${lines.length - MOST} more`] : [])]
    .map((line) => element("li", null, line));

  // ---- before a run ----

  const ask = async () => {
    if (part("run").disabled || document.querySelector("dialog[open]") || !await editor.act("save_to_run")) return;
    part("start-axes").replaceChildren();
    const preview = await look();
    if (!preview) return;
    const axes = preview.axes.filter(([, labels]) => labels.length > 1);
    part("start-only").hidden = !axes.length;
    part("start-only").open = false;
    part("start-axes").replaceChildren(...axes.map(axis));
    dialog.showModal();
    part("start-now").focus();
  };
  const axis = ([name, labels]) => element("div", { class: "editor-field" },
    element("label", { for: `start-${name}` }, name),
    element("select", { id: `start-${name}`, "data-axis": name, multiple: true, size: Math.min(labels.length, 5), onchange: look },
      labels.map((label, place) => element("option", { value: place }, label))));
  // The places of the labels that are chosen, by axis.
  const only = () => {
    const chosen = [...part("start-axes").querySelectorAll("select")].map((each) => [each.dataset.axis, [...each.selectedOptions].map(({ value }) => Number(value))]);
    return Object.fromEntries(chosen.filter(([, places]) => places.length));
  };
  const look = async () => {
    const asked = JSON.stringify(only());
    let preview;
    part("start-now").disabled = true;
    const say = dialog.open ? (text) => { part("start-what").textContent = text; } : editor.say;
    say("Looking at what is stored \u2026");
    try {
      preview = await editor.get("/preview", { only: asked });
    } catch (error) {
      say(error.message);
      return null;
    }
    if (asked !== JSON.stringify(only())) return null; // another choice is looked at
    say("");
    const { nodes, steps, missing, changes, warnings } = preview;
    part("start-now").disabled = false;
    part("start-what").textContent = missing
      ? `${many(missing)} of ${many(steps)} steps are not stored, and are computed as far as something needs them.`
      : `All ${many(steps)} steps are stored.`;
    part("start-nodes").tBodies[0].replaceChildren(...nodes.map(([node, ...counts]) => element("tr", null,
      element("th", { scope: "row" }, node), counts.map((count) => element("td", { class: "number" }, many(count))))));
    part("start-why").hidden = !changes.length;
    part("start-why").querySelector("ul").replaceChildren(...few(changes));
    part("start-warnings").replaceChildren(...few(warnings));
    return preview;
  };

  // ---- a run ----

  const is_going = () => snapshot !== null && !snapshot.is_over;
  const listen = () => {
    events?.close();
    events = new EventSource("/running");
    events.onmessage = ({ data }) => {
      const before = snapshot ?? {};
      snapshot = JSON.parse(data);
      if (snapshot.is_over) {
        events.close();
        part("run-said").open = snapshot.state !== "finished";
      }
      if (snapshot.state !== before.state || snapshot.answer !== before.answer) announce(`Run: ${snapshot.state}. ${snapshot.answer}`);
      show();
    };
    events.onerror = () => events.close();
  };

  const mark = () => {
    const earlier = editor.known.run.is_current ? "" : "before: ";
    for (const box of document.querySelectorAll("#picture [data-box]:has(> rect.frame)")) {
      if (!cards.has(box)) cards.set(box, new Card(box));
      const card = cards.get(box);
      const node = snapshot.nodes[card.name] ?? (is_going() && earlier === "" ? { mark: "waiting", text: "waiting", settled: 0 } : null);
      if (node) card.show({ ...node, text: `${earlier}${node.text}` }, snapshot.alternatives);
    }
  };

  const failed = ([name, { text }]) => {
    const reason = snapshot.failures.find((failure) => failure.startsWith(`${name}(`) || failure.startsWith(`${name}: `));
    const lines = editor.known.nodes[editor.node_of(name)];
    const go = () => editor.choose(editor.node_of(name), { scroll: "both" });
    return element("li", { class: "error" },
      lines ? element("button", { type: "button", onclick: go }, `${part("text").dataset.file}:${lines[0]}`) : null,
      ` ${name}: ${text} `, combinations(name), reason ? element("div", null, reason) : null);
  };

  const in_hand = () => {
    const chosen = editor.chosen();
    const nodes = Object.entries(snapshot.nodes).filter(([name]) => chosen && (name === chosen || name.startsWith(`${chosen}.`)));
    return nodes.map(([name, { text }]) => element("li", null, `${name}: ${text} `, combinations(name)));
  };

  const show = () => {
    part("stop").disabled = !is_going();
    part("run").disabled = is_going();
    holder.hidden = snapshot === null;
    if (snapshot === null) return;
    const { is_over, state, nodes, message, answer, has_report, said, run, only: labels } = snapshot;
    const reached = Object.keys(nodes).length ? how_far(snapshot) : state;
    mark();
    part("run-reached").replaceChildren(
      `Run ${run}${labels ? `, only ${labels}` : ""}: ${reached}${message ? `; ${message}` : ""}. `,
      has_report ? link(`/report?${new URLSearchParams({ run })}`, "Report") : "",
      editor.known.run.is_current ? "" : " The text has been edited since: states are those of the earlier text.",
    );
    part("run-answer").textContent = answer;
    part("run-nodes").replaceChildren(...Object.entries(nodes).filter(([, { counts }]) => counts.failed).map(failed), ...in_hand());
    part("run-said").hidden = !(is_over && said);
    part("run-said").querySelector("pre").textContent = said;
  };

  editor.on(() => {
    const run = editor.known.run;
    if (run && run.number !== number) {
      number = run.number;
      snapshot = null;
      listen();
    }
    show();
  });

  part("run").addEventListener("click", ask);
  part("stop").addEventListener("click", () => editor.act("stop"));
  part("start-cancel").addEventListener("click", () => dialog.close());
  part("start-now").addEventListener("click", () => {
    dialog.close();
    editor.act("run", { arguments: { only: only() } });
  });
  addEventListener("keydown", (event) => { // before the text breaks a line
    if (event.key !== "Enter" || !(event.ctrlKey || event.metaKey) || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    ask();
  }, true);
  return {};
});
