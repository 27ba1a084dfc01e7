// What the reader has chosen, once for all charts, tables and players of the page. It is kept in the
// address, with the place of the page that it has gone to, so that a link shows the same. The second
// comparison of a page keeps what is its own under names such as 2.group.
nodegraph.define("selection", [], () => {
  const NOTHING = {
    method: null, reference: null, metric: null, statistic: null, group: null, block: null, frame: null,
    marker: null, region: null, suspects: true, methods: null,
  };
  const NUMBERS = new Set(["group", "block", "frame"]);
  const PREFIX = "#select:";
  const bare = (name) => name.replace(/^\d+\./, "");
  const known = (name) => bare(name) in NOTHING;
  const unset = (name) => NOTHING[bare(name)];
  const readers = [];
  const watchers = [];
  const state = { ...NOTHING };
  let at = "";
  const written = () => {
    const words = new URLSearchParams();
    for (const [name, value] of Object.entries(state)) {
      if (value === unset(name)) continue;
      words.set(name, Array.isArray(value) ? JSON.stringify(value) : String(value));
    }
    if (!words.toString()) return at ? `#${at}` : "";
    if (at) words.set("at", at);
    return PREFIX + words.toString();
  };
  const nothing = () => Object.fromEntries(Object.keys(state).map((name) => [name, unset(name)]));
  const read = (text) => {
    const chosen = nothing();
    for (const [name, value] of new URLSearchParams(text)) {
      if (!known(name)) continue;
      if (bare(name) === "suspects") chosen[name] = value !== "false";
      else if (NUMBERS.has(bare(name))) chosen[name] = /^\d+$/.test(value) ? Number(value) : null;
      else if (name === "methods") {
        try {
          const list = JSON.parse(value);
          chosen[name] = Array.isArray(list) ? list.map(String) : null;
        } catch { /* an address that somebody has changed */ }
      } else chosen[name] = value;
    }
    return chosen;
  };
  const apply = (values) => {
    const changed = Object.keys(values).filter(
      (name) => known(name) && JSON.stringify(values[name]) !== JSON.stringify(name in state ? state[name] : unset(name)));
    if (!changed.length) return;
    for (const name of changed) state[name] = values[name];
    for (const reader of readers) reader(state, new Set(changed));
  };
  const set = (values) => {
    apply(values);
    if (location.protocol === "about:") return; // a frame in a notebook has no address of its own
    show();
  };
  const show = () => {
    const place = written() || (location.hash.startsWith(PREFIX) ? "#" : location.hash);
    if (place !== location.hash) history.replaceState(null, "", place || location.pathname);
  };
  // What a page begins with where neither its reader nor its address has chosen; clearing returns to it.
  const begin = (values) => {
    const open = Object.entries(values).filter(([name]) => state[name] === NOTHING[name]);
    Object.assign(NOTHING, values);
    apply(Object.fromEntries(open));
  };
  const toggle = (name, value) => set({ [name]: state[name] === value ? NOTHING[name] : value });
  const hover = (kind, value) => { for (const watcher of watchers) watcher(kind, value); };
  // A link to a place of the page leaves what is chosen.
  const from_address = () => {
    const text = location.hash.startsWith(PREFIX) ? location.hash.slice(PREFIX.length) : null;
    at = (text === null ? location.hash.slice(1) : new URLSearchParams(text).get("at")) ?? "";
    if (text === null) show();
    else apply(read(text));
  };
  addEventListener("hashchange", from_address);
  from_address();
  return {
    state, set, begin, toggle, hover,
    place: () => at,
    clear: () => set(nothing()),
    on: (reader) => { readers.push(reader); },
    on_hover: (watcher) => { watchers.push(watcher); },
  };
});
