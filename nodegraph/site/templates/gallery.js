// The cards that fit what the reader has asked for, in the order asked for. The address keeps it, so
// that a link shows the same. Runs that failed or were replaced are shown on request.
nodegraph.define("gallery", [], () => {
  const form = document.getElementById("filter");
  const runs = document.getElementById("runs");
  const count = document.getElementById("count");
  const lower = (element) => element?.textContent.toLowerCase() ?? "";
  const cards = [...runs.children].map((card) => ({
    card,
    title: card.querySelector("h2").textContent,
    front: lower(card.querySelector(".front")),
    text: lower(card),
    date: card.querySelector("time")?.textContent.slice(0, 10) ?? "",
    methods: new Set([...card.querySelectorAll(".methods li")].map(({ textContent }) => textContent)),
    details: card.querySelector("details"),
  }));
  const asked = () => Object.fromEntries([...new FormData(form)].filter(([, value]) => value));
  const orders = {
    earliest: () => cards.toReversed(),
    title: () => cards.toSorted((a, b) => a.title.localeCompare(b.title)),
  };
  const show = () => {
    const { words = "", method, from = "", to, sort, ...too } = asked();
    const parts = words.toLowerCase().split(/\s+/).filter(Boolean);
    const within = (text) => parts.every((part) => text.includes(part));
    const hidden = { failed: 0, replaced: 0 };
    let shown = 0;
    for (const { card, front, text, date, methods, details } of cards) {
      const fits = within(text) && (!method || methods.has(method))
        && (!from || date >= from) && (!to || (date && date <= to));
      const reason = Object.keys(hidden).find((name) => name in card.dataset && !too[name]);
      card.hidden = !fits || Boolean(reason);
      if (fits && reason) hidden[reason] += 1;
      shown += !card.hidden;
      if (details && parts.length) details.open = !within(front);
    }
    runs.append(...(orders[sort]?.() ?? cards).map(({ card }) => card));
    const rest = Object.entries(hidden).filter(([, number]) => number).map(([name, number]) => `${number} ${name}`);
    count.textContent = `${shown} of ${cards.length} ${cards.length === 1 ? "run" : "runs"}${rest.length ? `; not shown: ${rest.join(", ")}` : ""}`;
  };
  const from_address = () => {
    const words = new URLSearchParams(location.hash.slice(1));
    form.reset();
    for (const [name, value] of words) {
      const field = form.elements.namedItem(name);
      if (field?.type === "checkbox") field.checked = true;
      else if (field) field.value = value;
      if (field?.value === "" && field.options) field.selectedIndex = 0; // an address that somebody has changed
    }
    show();
  };
  const changed = () => {
    const words = new URLSearchParams(asked()).toString();
    history.replaceState(null, "", words ? `#${words}` : location.pathname);
    show();
  };
  form.addEventListener("input", changed);
  document.getElementById("clear").addEventListener("click", () => {
    form.reset();
    changed();
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  addEventListener("hashchange", from_address);
  for (const name of ["failed", "replaced"]) {
    if (!runs.querySelector(`[data-${name}]`)) form.elements.namedItem(name).parentElement.remove();
  }
  form.hidden = false;
  from_address();
});
