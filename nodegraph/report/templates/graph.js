// The drawing of the graph: a click on a node follows what it depends on and what depends on it, and
// shows what the page has of it; the card of what is only shown unfolds.
nodegraph.define("graph", ["page", "server"], ({ element, announce }, server) => {
  const part = document.querySelector("#graph .drawing");
  if (!part) return;
  const about = element("div", { class: "followed-node", "aria-live": "polite" });
  const STYLES = ["fill", "stroke", "stroke-width", "stroke-dasharray", "opacity", "visibility", "font", "text-anchor"];
  const hint = "Click a node, or go to it with the Tab key and press Enter: what it depends on, and what depends on it.";
  const other = part.parentElement.querySelector("template.unfolded");
  const drawings = [part.firstElementChild, ...(other ? [other.content.firstElementChild] : [])];
  const fold = element("button", { type: "button", hidden: !other, onclick: () => show(1 - shown) });
  const namesOf = (drawing) => [...drawing.querySelectorAll("[data-box]")].map((box) => box.dataset.box);
  const cards = other ? namesOf(drawings[0]).filter((name) => !namesOf(drawings[1]).includes(name)) : [];
  part.before(element("p", { class: "graph-tools" }, element("span", { class: "quiet" }, hint), fold));
  part.after(about);
  let shown = 0;
  let chosen = null;

  // Names and ports may have dots: of the nodes that an end of an arrow may mean, the longest name.
  const arrowsOf = (drawing) => {
    const names = namesOf(drawing).sort((a, b) => b.length - a.length);
    const nodeOf = (end) => names.find((name) => end.startsWith(`${name}.`));
    return [...drawing.querySelectorAll("[data-arrow]")].map((arrow) => {
      const [from, to] = arrow.dataset.arrow.split(" ").map(nodeOf);
      return { arrow, from, to };
    });
  };

  // All nodes that one reaches along arrows, or against them; without itself.
  const reached = (arrows, start, from, to) => {
    const found = new Set();
    const todo = [start];
    while (todo.length) {
      const at = todo.pop();
      for (const each of arrows) {
        if (each[from] !== at || found.has(each[to])) continue;
        found.add(each[to]);
        todo.push(each[to]);
      }
    }
    return found;
  };

  // A small picture of what a section shows, if it shows one.
  const thumbnailOf = (section) => {
    section.querySelector("figure.playback")?.playback?.draw();
    const picture = section.querySelector(".rendered :is(svg, canvas, img)");
    if (!picture) return null;
    const image = (src) => element("img", { src, alt: "" });
    if (picture.matches("canvas")) return image(picture.toDataURL());
    if (picture.matches("img")) return image(picture.src);
    // what draws by itself is an image; other charts take the styles of the page with them
    if (picture.querySelector("defs, style")) return image(`data:image/svg+xml,${encodeURIComponent(new XMLSerializer().serializeToString(picture))}`);
    const copy = picture.cloneNode(true);
    const originals = [picture, ...picture.querySelectorAll("*")];
    [copy, ...copy.querySelectorAll("*")].forEach((each, at) => {
      const style = getComputedStyle(originals[at]);
      for (const name of STYLES) each.style.setProperty(name, style.getPropertyValue(name));
      for (const name of ["id", "class", "tabindex", "role"]) each.removeAttribute(name);
    });
    copy.setAttribute("aria-hidden", "true");
    return copy;
  };

  const goTo = (section) => {
    for (let folded = section.closest("details"); folded; folded = folded.parentElement.closest("details")) folded.open = true;
    section.scrollIntoView({ block: "start" });
  };

  // Sections that show a node; of those with one title the first that has a picture.
  const resultsOf = (name) => {
    const found = new Map();
    for (const section of document.querySelectorAll("main [data-node]")) {
      if (section.dataset.node !== name) continue;
      const title = section.dataset.title || name;
      if (!found.get(title)?.picture) found.set(title, { section, title, picture: thumbnailOf(section) });
    }
    return [...found.values()];
  };

  const tell = (name, before, after) => {
    const list = (words, names) => element("p", null, element("b", null, words), names.size ? [...names].join(", ") : "nothing");
    const results = resultsOf(name).map(({ section, title, picture }) =>
      element("button", { type: "button", class: "thumbnail", onclick: () => goTo(section) }, picture, element("span", null, title)));
    const runs = server?.runs ?? [];
    const links = cards.includes(name) ? [] : runs.map((run) => element("a", { href: `/values?${new URLSearchParams({ run, node: name })}` }, runs.length > 1 ? `Values in ${run}` : "All its values"));
    about.replaceChildren(
      element("h4", null, name), list("Depends on: ", before), list("Needed by: ", after),
      ...(results.length ? [element("div", { class: "thumbnails" }, ...results)] : []), ...links);
    announce(`${name}: depends on ${before.size} nodes, ${after.size} depend on it`);
  };

  const follow = (name) => {
    chosen = name;
    const drawing = drawings[shown];
    const arrows = arrowsOf(drawing);
    const before = name === null ? new Set() : reached(arrows, name, "to", "from");
    const after = name === null ? new Set() : reached(arrows, name, "from", "to");
    const isOn = (each) => each === name || before.has(each) || after.has(each);
    drawing.classList.toggle("followed", name !== null);
    for (const box of drawing.querySelectorAll("[data-box]")) {
      box.classList.toggle("chosen", box.dataset.box === name);
      box.classList.toggle("on-path", isOn(box.dataset.box));
      box.setAttribute("aria-pressed", String(box.dataset.box === name));
    }
    for (const { arrow, from, to } of arrows) {
      const leads = (to === name || before.has(to)) && before.has(from);
      const follows = (from === name || after.has(from)) && after.has(to);
      arrow.classList.toggle("on-path", leads || follows);
    }
    if (name === null) about.replaceChildren();
    else tell(name, before, after);
  };

  const press = (name) => {
    if (cards.includes(name)) show(1);
    else follow(name === chosen ? null : name);
  };

  const show = (which) => {
    const kept = chosen;
    follow(null);
    shown = which;
    part.replaceChildren(drawings[shown]);
    fold.textContent = shown ? "Fold what is only shown" : "Show every node";
    follow(namesOf(drawings[shown]).includes(kept) ? kept : null);
  };

  for (const drawing of drawings) {
    drawing.setAttribute("role", "group");
    for (const box of drawing.querySelectorAll("[data-box]")) {
      box.setAttribute("role", "button");
      box.setAttribute("tabindex", "0");
    }
  }
  part.addEventListener("click", (event) => {
    const box = event.target.closest("[data-box]");
    if (box) press(box.dataset.box);
  });
  part.addEventListener("keydown", (event) => {
    const box = event.target.closest("[data-box]");
    if (box && (event.key === "Enter" || event.key === " ")) {
      event.preventDefault();
      press(box.dataset.box);
      part.querySelector(`[data-box="${CSS.escape(box.dataset.box)}"]`)?.focus();
    } else if (event.key === "Escape" && chosen !== null) {
      event.preventDefault();
      follow(null);
    }
  });
  show(0);
});
