// What the reader has chosen, once for all charts, tables and players of the page. It is kept in the
// address, so that a link shows the same.
nodegraph.define("selection", [], () => {
  const NOTHING = {
    method: null, reference: null, metric: null, statistic: null, group: null, block: null, marker: null,
    region: null, suspects: true, methods: null,
  };
  const NUMBERS = new Set(["group", "block"]);
  const PREFIX = "#select:";
  const readers = [];
  const watchers = [];
  const state = { ...NOTHING };
  const written = () => {
    const words = new URLSearchParams();
    for (const [name, value] of Object.entries(state)) {
      if (value === NOTHING[name]) continue;
      words.set(name, Array.isArray(value) ? JSON.stringify(value) : String(value));
    }
    return words.toString();
  };
  const read = (text) => {
    const chosen = { ...NOTHING };
    for (const [name, value] of new URLSearchParams(text)) {
      if (!(name in NOTHING)) continue;
      if (name === "suspects") chosen[name] = value !== "false";
      else if (NUMBERS.has(name)) chosen[name] = /^\d+$/.test(value) ? Number(value) : null;
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
      (name) => name in NOTHING && JSON.stringify(values[name]) !== JSON.stringify(state[name]));
    if (!changed.length) return;
    for (const name of changed) state[name] = values[name];
    for (const reader of readers) reader(state, new Set(changed));
  };
  const set = (values) => {
    apply(values);
    if (location.protocol === "about:") return; // a frame in a notebook has no address of its own
    const text = written();
    const place = text ? PREFIX + text : location.hash.startsWith(PREFIX) ? "#" : location.hash;
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
  const from_address = () => {
    if (location.hash.startsWith(PREFIX)) apply(read(location.hash.slice(PREFIX.length)));
  };
  addEventListener("hashchange", from_address);
  Object.assign(state, location.hash.startsWith(PREFIX) ? read(location.hash.slice(PREFIX.length)) : {});
  return {
    state, set, begin, toggle, hover,
    clear: () => set({ ...NOTHING }),
    on: (reader) => { readers.push(reader); },
    on_hover: (watcher) => { watchers.push(watcher); },
  };
});
