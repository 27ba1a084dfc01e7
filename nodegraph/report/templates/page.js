"use strict";
// Tables sort by a click on a column's name, or by Enter or Space; empty cells stay last.
for (const table of document.querySelectorAll("table.sortable")) {
  if (!table.tHead || table.tHead.rows.length !== 1) continue;
  if (table.querySelector("[colspan], [rowspan]")) continue;
  const heads = [...table.tHead.rows[0].cells];
  const textOf = (row, index) => {
    const cell = row.cells[index];
    return cell ? (cell.dataset.value ?? cell.textContent).trim() : "";
  };
  const numberOf = (text) => {
    const found = text.replace(/\u2212/g, "-").match(/^[<>≤≥≈~\s]*([-+]?(?:\d[\d,]*\.?\d*|\.\d+)(?:e[-+]?\d+)?)/i);
    return found ? Number(found[1].replaceAll(",", "")) : NaN;
  };
  const sort = (index, sign) => {
    const rows = [...table.tBodies[0].rows].map((row) => ({ row, text: textOf(row, index) }));
    const filled = rows.filter((one) => one.text !== "");
    const numeric = filled.every((one) => !Number.isNaN(numberOf(one.text)));
    const compare = numeric
      ? (a, b) => numberOf(a.text) - numberOf(b.text)
      : (a, b) => a.text.localeCompare(b.text, undefined, { numeric: true });
    filled.sort((a, b) => sign * compare(a, b));
    const empty = rows.filter((one) => one.text === "");
    table.tBodies[0].append(...[...filled, ...empty].map((one) => one.row));
  };
  heads.forEach((head, index) => {
    const button = document.createElement("button");
    button.type = "button";
    button.title = "Sort by this column";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const falling = head.getAttribute("aria-sort") === "ascending";
      heads.forEach((one) => one.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", falling ? "descending" : "ascending");
      sort(index, falling ? -1 : 1);
      for (const row of table.querySelectorAll("tr.group")) row.classList.remove("group");
    });
  });
}
// Of a drawing that is wider than the page, its beginning is seen first.
for (const frame of document.querySelectorAll(".drawing")) {
  const first = frame.querySelector(".box");
  if (!first || frame.scrollWidth <= frame.clientWidth) continue;
  const [outer, inner] = [frame.getBoundingClientRect(), first.getBoundingClientRect()];
  frame.scrollLeft += inner.left + inner.width / 2 - outer.left - outer.width / 2;
}
// What is wider than the page scrolls in its own frame, with the arrow keys too. What is folded is
// not measured before it is seen: a browser would have to lay out thousands of rows for that.
const reachable = (part) => {
  for (const frame of part.querySelectorAll("figure, .wide, .rendered")) {
    if (!frame.closest("details:not([open])") && frame.scrollWidth > frame.clientWidth) frame.tabIndex = 0;
  }
};
reachable(document);
document.addEventListener("toggle", (event) => reachable(event.target), true);
// A link into something folded opens it.
const unfold = () => {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  for (let fold = target?.closest("details"); fold; fold = fold.parentElement.closest("details")) fold.open = true;
};
addEventListener("hashchange", unfold);
unfold();
