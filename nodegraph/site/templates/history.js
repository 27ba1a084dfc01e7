// All runs of a study, or two of them that the reader chooses; the address keeps which. A number that
// is another than in the run shown before it says by how much, where the two have the same data.
nodegraph.define("history", [], () => {
  const form = document.getElementById("filter");
  const { was, now } = form.elements;
  const changes = [...document.getElementById("changes").children];
  const names = changes.map(({ dataset }) => dataset.run);
  const data = Object.fromEntries(changes.map(({ dataset }) => [dataset.run, dataset.data]));
  const heads = [...document.querySelectorAll("th[data-run]")];
  const rows = [...document.querySelectorAll("tbody tr")].map((row) => [...row.querySelectorAll("td")]);
  const value = (text) => Number(text.replaceAll(",", "").replace("\u2212", "-"));
  const change = (before, after) => {
    const share = (100 * (value(after) - value(before))) / Math.abs(value(before));
    if (!Number.isFinite(share)) return "changed";
    return `${share < 0 ? "\u2212" : "+"}${Math.abs(share).toFixed(Math.abs(share) < 1 ? 1 : 0)} %`;
  };
  const show = () => {
    const ends = [was.value, now.value].map((name) => names.indexOf(name)).sort((a, b) => a - b);
    const all = !was.value;
    const shown = new Set(names.filter((name, at) => all || ends.includes(at)));
    for (const cell of document.querySelectorAll("[data-run]:is(th, td)")) cell.hidden = !shown.has(cell.dataset.run);
    changes.forEach((item, at) => {
      item.hidden = !all && (at < ends[0] || at > ends[1]);
      const list = item.querySelector("ul"); // what changed before the first that is shown is of no interest
      if (list) list.hidden = !all && at === ends[0];
    });
    const others = [...shown].filter((name, at, every) => at && data[name] !== data[every[at - 1]]);
    for (const head of heads) {
      delete head.dataset.change;
      if (others.includes(head.dataset.run)) head.dataset.change = "other data";
    }
    for (const cells of rows) {
      let before = null;
      for (const cell of cells) {
        delete cell.dataset.change;
        const text = cell.textContent;
        if (cell.hidden || text === "\u2013") continue;
        const has_same_data = before && data[before.dataset.run] === data[cell.dataset.run];
        if (has_same_data && before.textContent !== text) cell.dataset.change = change(before.textContent, text);
        before = cell;
      }
    }
    now.parentElement.hidden = all;
  };
  const from_address = () => {
    const words = new URLSearchParams(location.hash.slice(1));
    form.reset();
    for (const field of [was, now]) {
      if (names.includes(words.get(field.name))) field.value = words.get(field.name);
    }
    show();
  };
  form.addEventListener("input", () => {
    const words = was.value ? `#${new URLSearchParams(new FormData(form))}` : location.pathname;
    history.replaceState(null, "", words);
    show();
  });
  addEventListener("hashchange", from_address);
  form.hidden = false;
  from_address();
});
