// Keeps the text, the picture and the file on the server the same. The page holds no graph: it shows
// what the server says of a text, and sends edits.
nodegraph.define("editor", ["page", "text", "picture"], ({ element }, text_pane, picture_pane) => {
  const PAUSE = 250; // milliseconds without a key before a text is sent
  const WATCH = 500;
  const LOOK = 800; // and before the files that it names are read
  const part = (id) => document.getElementById(id);
  const known = { revision: 0, text: "", nodes: {}, wrong: [], problems: [] };
  const readers = []; // hear of another view, and of another node in hand
  let queue = Promise.resolve();
  let timer = 0;
  let looking = 0;
  let moving = 0;
  let chosen = "";
  let mine = null; // a text of this page that could not be merged with that of the server

  const get = async (address, query = {}) => {
    const response = await fetch(`${address}?${new URLSearchParams(query)}`);
    const answer = await response.json();
    if (!response.ok) throw new Error(answer.message);
    return answer;
  };

  // What the server says of a place of the text as it stands, which it may not have yet.
  const at_place = async (address, at) => {
    const headers = { "Content-Type": "application/json" };
    const response = await fetch(address, { method: "POST", headers, body: JSON.stringify({ text: pane.text(), at }) });
    const answer = await response.json();
    if (!response.ok) throw new Error(answer.message);
    return answer;
  };

  const say = (message) => {
    part("notice").textContent = message;
    part("notice").hidden = !message;
  };

  // A request that was not answered, or says why not.
  const trouble = (error) => { if (error instanceof TypeError) ended(); else say(error.message); };
  const ended = () => say("The server has ended. What it had is kept beside the file; start nodegraph edit again.");

  // ---- what the server says ----

  const receive = (view) => {
    const before = known.text;
    if (pane.text() === before || pane.text() === view.text) pane.set(view.text);
    else if (view.text !== before && !pane.rebase(before, view.text)) {
      mine = pane.text();
      pane.set(view.text);
    }
    Object.assign(known, view);
    if (pane.text() !== known.text && !view.refused) wait();
    show();
  };

  const show = () => {
    const { is_checked, is_saved, can_undo, can_redo, theirs, notice, svg, reason, problems } = known;
    part("state").textContent = is_saved ? "saved" : "not saved; Ctrl-S saves";
    document.title = `${is_saved ? "" : "* "}${part("text").dataset.file}`;
    part("undo").disabled = !can_undo;
    part("redo").disabled = !can_redo;
    part("save").disabled = is_saved;
    say(notice);
    picture.draw(svg, known.wrong, reason);
    part("reason").textContent = part("picture").textContent === reason ? "" : reason;
    show_problems(problems);
    choose(chosen, { scroll: "" });
    ask(theirs);
    clearTimeout(looking);
    if (!is_checked) looking = setTimeout(() => send(async () => receive(await get("/view"))), LOOK);
    else if (svg && !problems.some(({ is_error }) => is_error)) looking = setTimeout(() => look_at_files().catch(trouble), LOOK);
  };

  const show_problems = (problems) => {
    pane.mistakes(problems);
    part("problems").querySelector("ul").replaceChildren(...problems.map(({ at, place, message, instead, is_error }) => element(
      "li", { class: is_error ? "error" : null },
      at === null ? element("code", {}, place) : element("button", { type: "button", onclick: () => pane.go(at) }, place),
      ` ${message}`, instead ? element("span", { class: "quiet" }, ` ${instead}`) : null,
    )));
  };

  const look_at_files = async () => {
    const { revision, problems } = await get("/files");
    if (revision === known.revision && problems.length) show_problems([...known.problems, ...problems]);
  };

  // ---- what goes to the server ----

  const post = async (body) => {
    let response;
    try {
      response = await fetch("/edit", {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify({ revision: known.revision, ...body }),
      });
    } catch (error) {
      trouble(error);
      return false;
    }
    const answer = await response.json();
    if (!("revision" in answer)) {
      say(answer.message);
      return false;
    }
    if (response.ok && "text" in body) known.text = body.text; // what was typed meanwhile goes on from it
    receive(answer);
    if (response.status === 409 && !("text" in body)) say("The text has changed meanwhile; do it again.");
    if (answer.refused) say(answer.refused);
    return response.ok;
  };
  // Requests go one after the other: each names the revision that the one before has made.
  const send = (make) => {
    const sent = queue.then(make);
    queue = sent.catch(trouble);
    return sent;
  };
  const flush = () => {
    clearTimeout(timer);
    timer = 0;
    return send(() => (pane.text() === known.text ? true : post({ text: pane.text() })));
  };
  const wait = () => {
    clearTimeout(timer);
    timer = setTimeout(flush, PAUSE);
  };
  const act = (action, values) => {
    flush();
    return send(() => post({ action, ...values }));
  };

  // ---- two texts ----

  const dialog = part("conflict");
  const ask = (theirs) => {
    const other = theirs ?? (mine === null ? null : known.text);
    if (other === null) {
      if (dialog.open) dialog.close();
      return;
    }
    const [left, right] = dialog.querySelectorAll("pre");
    left.textContent = other;
    right.textContent = mine ?? known.text;
    dialog.querySelector("p").textContent = theirs === null
      ? "Another page has changed the lines that have changed here."
      : "Another program has changed lines of the file that have changed here. Neither is lost: undo brings the other back.";
    if (!dialog.open) dialog.showModal();
  };
  dialog.addEventListener("cancel", (event) => event.preventDefault());
  dialog.addEventListener("click", (event) => {
    const choice = event.target.value;
    if (choice !== "theirs" && choice !== "mine") return;
    if (mine !== null) {
      const text = mine;
      mine = null;
      if (choice === "mine") pane.set(text);
      flush().then(show);
    } else act(choice === "theirs" ? "take_theirs" : "keep_mine");
  });

  // ---- the node in hand ----

  const node_of = (box) => {
    let name = box;
    while (name && !Object.hasOwn(known.nodes, name)) name = name.slice(0, Math.max(0, name.lastIndexOf(".")));
    return name;
  };
  const choose = (name, { scroll }) => {
    chosen = Object.hasOwn(known.nodes, name) ? name : "";
    picture.choose(chosen, { scroll: scroll === "picture" || scroll === "both" });
    pane.mark(known.nodes[chosen] ?? null, { scroll: scroll === "text" || scroll === "both" });
    for (const reader of readers) reader();
    if (chosen && location.hash !== `#${chosen}`) history.replaceState(null, "", `#${chosen}`);
  };
  const moved = (line) => {
    const name = Object.keys(known.nodes).find((each) => known.nodes[each][0] <= line && line <= known.nodes[each][1]) ?? "";
    if (name && name !== chosen) choose(name, { scroll: "picture" });
    clearTimeout(moving);
    moving = setTimeout(() => explain().catch(trouble), PAUSE);
  };
  const explain = async () => {
    const word = await at_place("/about", pane.cursor());
    part("about").replaceChildren(...(word ? [element("p", {}, element("b", {}, word.word)), ...text_pane.paragraphs(word.about)] : []));
  };
  // Names of nodes need no escapes in an address.
  const from_address = () => choose(location.hash.slice(1), { scroll: "both" });

  const keys = [
    { key: "Mod-z", run: () => { act("undo"); return true; } },
    { key: "Mod-y", run: () => { act("redo"); return true; } },
    { key: "Mod-Shift-z", run: () => { act("redo"); return true; } },
  ];
  const pane = text_pane.make(part("text"), {
    keys,
    edited: wait,
    moved,
    options: (at) => at_place("/options", at).catch((error) => {
      trouble(error);
      return { word: "", options: [] };
    }),
  });
  const picture = picture_pane.make(part("picture"), (box) => choose(node_of(box), { scroll: "text" }));

  for (const [id, factor] of [["smaller", 0.8], ["larger", 1.25], ["fit", 0]]) part(id).addEventListener("click", () => picture.zoom(factor));
  for (const action of ["undo", "redo", "save"]) part(action).addEventListener("click", () => act(action));
  document.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const key = event.key.toLowerCase();
    const is_writing = event.target.closest("input, textarea, select, dialog, .cm-editor");
    if (key === "s") act("save");
    else if (key === "z" && !is_writing) act(event.shiftKey ? "redo" : "undo");
    else return;
    event.preventDefault();
  });
  addEventListener("beforeunload", (event) => {
    if (pane.text() !== known.text) event.preventDefault();
  });
  addEventListener("hashchange", from_address);

  const begin = async () => {
    known.text = pane.text();
    await send(async () => receive(await get("/view")));
    from_address();
    watch();
  };
  // Another page may edit, another program write the file.
  const watch = () => setTimeout(async () => {
    const revision = await get("/revision").catch(trouble);
    if (revision === undefined) return;
    if (revision !== known.revision) await send(async () => receive(await get("/view")));
    watch();
  }, WATCH);
  begin();
  return { act, get, known, choose, say, node_of, chosen: () => chosen, on: (reader) => { readers.push(reader); } };
});
