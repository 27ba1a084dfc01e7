"use strict";
// Tables are copied as they are shown, rows in their present order; CSV has all digits, and a
// column of its own for each number that is shown within another's cell.
{
  const shownText = (cell) => [...cell.querySelectorAll("button")].at(-1)?.textContent ?? cell.textContent;
  const cellsOf = (row) => [...row.cells].map((cell) => shownText(cell).trim());
  const exactOf = (cell) => [cell.dataset.value ?? shownText(cell).trim(), ...(cell.dataset.within?.split(",") ?? [])];
  // The columns of the file, in its order: which part of which cell holds them.
  const columnsOf = (table) => [...table.tHead.rows[table.tHead.rows.length - 1].cells].flatMap((cell, column) =>
    JSON.parse(cell.dataset.names ?? JSON.stringify([[column, shownText(cell).trim()]]))
      .map(([place, name], part) => ({ place, name, column, part }))).sort((a, b) => a.place - b.place);
  const partsOf = (table) => ({
    heads: [...table.tHead.rows].map(cellsOf),
    rows: [...table.tBodies[0].rows].map(cellsOf),
    numeric: [...table.tHead.rows[table.tHead.rows.length - 1].cells].map((cell) => cell.classList.contains("number")),
    caption: table.caption?.textContent.trim() ?? "",
  });
  // a spreadsheet would compute what begins like this and is no number
  const guarded = (text) => (/^[=+\-@\t\r]/.test(text) && Number.isNaN(Number(text)) ? `'${text}` : text);
  const quoted = (text) => (/[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const csv = (table) => {
    const columns = columnsOf(table);
    const rows = [...table.tBodies[0].rows].map((row) => {
      const cells = [...row.cells].map(exactOf);
      return columns.map(({ column, part }) => cells[column]?.[part] ?? "");
    });
    return [columns.map(({ name }) => name), ...rows].map((row) => row.map(guarded).map(quoted).join(",")).join("\n") + "\n";
  };
  const markdown = (table) => {
    const { heads, rows, numeric } = partsOf(table);
    const line = (cells) => `| ${cells.map((text) => text.replaceAll("|", "\\|")).join(" | ")} |`;
    const rule = `|${numeric.map((one) => (one ? "---:" : "---")).join("|")}|`;
    return [...heads.map(line), rule, ...rows.map(line)].join("\n") + "\n";
  };
  const SPECIAL = {
    "\\": "\\textbackslash{}", "&": "\\&", "%": "\\%", "$": "\\$", "#": "\\#", "_": "\\_", "{": "\\{", "}": "\\}",
    "~": "\\textasciitilde{}", "^": "\\textasciicircum{}", "<": "\\textless{}", ">": "\\textgreater{}",
    // these two would be taken for an option where a row begins
    "[": "{[}", "*": "{*}",
    "\u2020": "\\textdagger{}", "\u00b2": "\\textsuperscript{2}", "\u00b3": "\\textsuperscript{3}",
  };
  const escaped = (text) => text.replace(/[\\&%$#_{}~^<>[*\u2020\u00b2\u00b3]/g, (one) => SPECIAL[one]);
  const latex = (table) => {
    const { heads, rows, numeric, caption } = partsOf(table);
    const line = (cells) => `${cells.map(escaped).join(" & ")} \\\\`;
    return [
      "% needs \\usepackage{booktabs}", "\\begin{table}", `\\caption{${escaped(caption)}}`,
      `\\begin{tabular}{${numeric.map((one) => (one ? "r" : "l")).join("")}}`, "\\toprule",
      ...heads.map(line), "\\midrule", ...rows.map(line), "\\bottomrule", "\\end{tabular}", "\\end{table}", "",
    ].join("\n");
  };
  const copied = async (text) => {
    if (navigator.clipboard) return navigator.clipboard.writeText(text);
    // a browser that gives a local page no clipboard still copies what is selected
    const box = document.createElement("textarea");
    box.value = text;
    document.body.append(box);
    box.select();
    const done = document.execCommand("copy");
    box.remove();
    if (!done) throw new Error("refused");
  };
  for (const table of document.querySelectorAll("figure.table > table")) {
    if (!table.tHead || !table.tBodies.length || table.querySelector("[colspan], [rowspan]")) continue;
    const bar = document.createElement("p");
    bar.className = "copy";
    const state = document.createElement("span");
    state.setAttribute("role", "status");
    for (const [name, form] of [["LaTeX", latex], ["CSV", csv], ["Markdown", markdown]]) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = name;
      button.setAttribute("aria-label", `Copy the table as ${name}`);
      button.addEventListener("click", () =>
        copied(form(table)).then(
          () => { state.textContent = `${name} copied`; },
          () => { state.textContent = "the browser does not allow it; the files beside this page have the table too"; },
        ));
      bar.append(button);
    }
    bar.prepend("Copy as ");
    bar.append(state);
    table.parentElement.after(bar);
  }
}
