"use strict";
{
  const most = 60;
  const query = document.getElementById("query");
  const list = document.getElementById("matches");
  const count = document.getElementById("count");

  /** Return how well an entry fits: a name that begins so, has it, or only the text; 0 if not. */
  function score([name, text, , page], words) {
    const title = name.toLowerCase();
    const rest = `${title} ${text} ${page}`.toLowerCase();
    if (!words.every((word) => rest.includes(word))) return 0;
    if (title === words.join(" ")) return 4;
    if (title.startsWith(words[0])) return 3;
    return words.every((word) => title.includes(word)) ? 2 : 1;
  }

  function item([name, text, address, page]) {
    const entry = document.createElement("li");
    const link = document.createElement("a");
    link.href = address;
    link.textContent = name;
    entry.append(link, page ? ` in ${page}` : "", text ? `: ${text}` : "");
    return entry;
  }

  function show() {
    const words = query.value.toLowerCase().split(/\s+/).filter(Boolean);
    const matches = words.length
      ? ENTRIES.map((entry) => [score(entry, words), entry]).filter(([value]) => value)
      : [];
    matches.sort(([a], [b]) => b - a);
    list.replaceChildren(...matches.slice(0, most).map(([, entry]) => item(entry)));
    count.textContent = words.length ? `${matches.length} found` : "";
    history.replaceState(null, "", words.length ? `#${encodeURIComponent(query.value)}` : "#");
  }

  query.addEventListener("input", show);
  query.value = decodeURIComponent(location.hash.slice(1));
  show();
}
