// What is not on the page comes from the server that shows it; what is not stored is computed.
nodegraph.define("server", ["page"], ({ element, announce }) => {
  const RUNS = __RUNS__;
  const NOT_COMPUTED = 202;
  const listeners = [];
  let current = null;
  document.addEventListener("close", () => current?.abort(), true);
  // a popover stands above the dialog of a block
  const state = element("p", { class: "served-progress", role: "status", popover: "manual" });
  document.body.append(state, element("style", null,
    ".served-progress { inset: auto 1rem 1rem auto; margin: 0; padding: 0.6rem 1rem; border: 0; border-radius: 8px;" +
    " font-size: 0.875rem; background: var(--ink); color: var(--paper); }" +
    ".served-bar { display: flex; flex-wrap: wrap; gap: 0.25rem 1.25rem; font-size: 0.875rem; }"));
  if (!document.querySelector(".served-bar")) {
    const of_run = (name) => element("a", { href: `/values?${new URLSearchParams({ run: name })}` },
      RUNS.length > 1 ? `Graph and results of ${name}` : "Graph and results");
    const bar = element("nav", { class: "served-bar", "aria-label": "Pages" },
      element("a", { href: "/runs" }, "Runs"), RUNS.map(of_run));
    (document.querySelector("body > header") ?? document.body).prepend(bar);
  }
  const report = (line) => {
    state.togglePopover(line !== null);
    if (line !== null) {
      state.textContent = line.waiting ? "Waiting for another computation"
        : `Computing: ${line.ended} of ${line.ended + line.left} steps${line.step ? `, last ${line.step}` : ""}`;
    }
    for (const listener of listeners) listener(line);
  };
  const failed = (data) => Object.assign(new Error(data.message), data);
  // Resolves when everything that the query needs is stored; leaving the page ends it.
  const compute = async (what, query, signal) => {
    const answer = await fetch("/compute", {
      method: "POST", signal, headers: { "Content-Type": "application/json" }, body: JSON.stringify({ for: what, query }),
    });
    if (!answer.ok) throw failed(await answer.json());
    const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
    announce("Computing what is not stored");
    try {
      for (let rest = ""; ;) {
        const { done, value } = await reader.read();
        if (done) break;
        const lines = (rest + value).split("\n");
        rest = lines.pop();
        for (const line of lines.map((text) => JSON.parse(text))) {
          if (line.message) throw failed(line);
          if (!line.finished) report(line);
        }
      }
    } finally {
      report(null);
    }
  };
  // path: "detail"; parameters: {node, compare, methods: [...], block: {...}}. What would be computed
  // with other code or files than the run's is an error with the list `changed`, unless `now` is "1".
  const get = async (path, parameters = {}) => {
    // who asks for another, or closes the dialog, has left this one
    current?.abort();
    current = new AbortController();
    const { signal } = current;
    const query = { run: RUNS[0] };
    for (const [name, value] of Object.entries(parameters)) {
      query[name] = typeof value === "object" ? JSON.stringify(value) : String(value);
    }
    for (let is_computed = false; ; is_computed = true) {
      const answer = await fetch(`/${path}?${new URLSearchParams(query)}`, { signal });
      const data = await answer.json();
      if (!answer.ok) throw failed(data);
      if (answer.status !== NOT_COMPUTED) return data;
      if (is_computed) throw failed({ message: "what was computed is not what the run had" });
      if (data.changed.length && !query.now) {
        throw failed({ message: "This is not stored, and may come out otherwise than in the run, because of what has changed since:", changed: data.changed });
      }
      await compute(path, query, signal);
    }
  };
  return { get, compute, progress: (listener) => { listeners.push(listener); }, runs: RUNS };
});
