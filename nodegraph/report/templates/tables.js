// Tables: a click on a head sorts, words filter, long ones unfold, and all are copied. A row with
// data-method shows what is selected in the charts, and selects it.
nodegraph.define("tables", ["page", "selection"], ({ element, copy, announce }, selection) => {
  const FILTERED_FROM = 12;
  // a record is a line, but for line ends within quotes
  const RECORD = /(?:"(?:[^"]|"")*"|[^"\n])*\n/g;
  const FIELD = /("(?:[^"]|"")*"|[^,"\n]*)(,|\n)/g;
  const fieldsOf = (record) => [...record.matchAll(FIELD)].map(([, text]) =>
    (text.startsWith('"') ? text.slice(1, -1).replaceAll('""', '"') : text));
  const numberOf = (text) => {
    const match = text.replace(/\u2212/g, "-").match(/^[<>≤≥≈~\s]*([-+]?(?:\d[\d,]*\.?\d*|\.\d+)(?:e[-+]?\d+)?)/i);
    return match ? Number(match[1].replaceAll(",", "")) : NaN;
  };
  const button = (text, pressed, attributes) => element("button", { type: "button", onclick: pressed, ...attributes }, text);

  // What a copy holds: the cells as they are shown; CSV has every column with all its digits.
  const textOf = (cell) => cell.textContent.trim();
  const shownCells = (row) => [...row.cells].filter(({ hidden }) => !hidden);
  const shownRow = (row) => shownCells(row).map(textOf);
  const partsOf = ({ table, rows }) => ({
    heads: [...table.tHead.rows].map(shownRow),
    rows: rows().map(shownRow),
    numeric: shownCells(table.tHead.rows[0]).map((cell) => cell.classList.contains("number")),
    caption: [...table.caption?.childNodes ?? []].filter(({ nodeName }) => nodeName !== "B")
      .map(({ textContent }) => textContent).join("").trim(),
  });
  // a spreadsheet would compute what begins like this and is not a number
  const guarded = (text) => (/^[=+\-@\t\r]/.test(text) && Number.isNaN(Number(text)) ? `'${text}` : text);
  const quoted = (text) => (/[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const csv = (shown) => {
    if (shown.whole) return shown.whole;
    if (shown.records) return shown.records[0] + shown.rows().map((row) => shown.records[shown.places.get(row) + 1]).join("");
    const { heads, rows } = partsOf(shown);
    return [...heads, ...rows].map((row) => row.map(guarded).map(quoted).join(",")).join("\n") + "\n";
  };
  const markdown = (shown) => {
    const { heads, rows, numeric } = partsOf(shown);
    const line = (cells) => `| ${cells.map((text) => text.replaceAll("|", "\\|")).join(" | ")} |`;
    const rule = `|${numeric.map((right) => (right ? "---:" : "---")).join("|")}|`;
    return [...heads.map(line), rule, ...rows.map(line)].join("\n") + "\n";
  };
  const SPECIAL = {
    "\\": "\\textbackslash{}", "&": "\\&", "%": "\\%", "$": "\\$", "#": "\\#", "_": "\\_", "{": "\\{", "}": "\\}",
    "~": "\\textasciitilde{}", "^": "\\textasciicircum{}", "<": "\\textless{}", ">": "\\textgreater{}",
    // these two would be taken for an option where a row begins
    "[": "{[}", "*": "{*}",
    "\u2020": "\\textdagger{}", "\u00b2": "\\textsuperscript{2}", "\u00b3": "\\textsuperscript{3}",
  };
  const escaped = (text) => text.replace(/[\\&%$#_{}~^<>[*\u2020\u00b2\u00b3]/g, (sign) => SPECIAL[sign]);
  const latex = (shown) => {
    const { heads, rows, numeric, caption } = partsOf(shown);
    const line = (cells) => `${cells.map(escaped).join(" & ")} \\\\`;
    return [
      "% needs \\usepackage{booktabs}", "\\begin{table}", `\\caption{${escaped(caption)}}`,
      `\\begin{tabular}{${numeric.map((right) => (right ? "r" : "l")).join("")}}`, "\\toprule",
      ...heads.map(line), "\\midrule", ...rows.map(line), "\\bottomrule", "\\end{tabular}", "\\end{table}", "",
    ].join("\n");
  };
  const copies = (shown) => {
    const state = element("span", { class: "quiet" });
    const copied = (name, form) => copy(form(shown)).then(
      () => `${name} copied`,
      () => "the browser does not allow it; the files beside this page have the table too",
    ).then((text) => { state.textContent = text; announce(text); });
    const forms = [["LaTeX", latex], ["CSV", csv], ["Markdown", markdown]];
    return element("span", { class: "copy" }, "Copy as ", ...forms.map(([name, form]) =>
      button(name, () => copied(name, form), { "aria-label": `Copy the table as ${name}` })), state);
  };

  const sorts = (shown) => {
    const heads = [...shown.table.tHead.rows[0].cells];
    const sort = (head, index, sign) => {
      const exact = head.classList.contains("number") && shown.records && head.dataset.column;
      const keyed = shown.rows().map((row) => ({
        row, text: exact ? shown.fields(row)[head.dataset.column] : row.cells[index].dataset.value ?? textOf(row.cells[index]),
      }));
      const filled = keyed.filter(({ text }) => text !== "");
      const numeric = filled.every(({ text }) => !Number.isNaN(numberOf(text)));
      for (const each of filled) each.number = numberOf(each.text);
      filled.sort(numeric
        ? (a, b) => sign * (a.number - b.number)
        : (a, b) => sign * a.text.localeCompare(b.text, undefined, { numeric: true }));
      // what is empty stays last
      shown.body.append(...[...filled, ...keyed.filter(({ text }) => text === "")].map(({ row }) => row));
    };
    heads.forEach((head, index) => {
      const toggle = button("", () => {
        const falling = head.getAttribute("aria-sort") === "ascending";
        for (const other of heads) other.removeAttribute("aria-sort");
        head.setAttribute("aria-sort", falling ? "descending" : "ascending");
        sort(head, index, falling ? -1 : 1);
        shown.figure.classList.add("sorted");
      }, { title: "Sort by this column" });
      toggle.append(...head.childNodes);
      head.append(toggle);
    });
  };

  const filter = (shown) => {
    const texts = new Map(shown.rows().map((row) =>
      [row, [...row.querySelectorAll("th")].map(textOf).join(" ").toLowerCase()]));
    const counted = element("span", { class: "quiet" });
    const apply = (event) => {
      const words = event.target.value.toLowerCase().split(/\s+/).filter(Boolean);
      let count = 0;
      for (const [row, text] of texts) {
        row.hidden = !words.every((word) => text.includes(word));
        count += !row.hidden;
      }
      shown.figure.classList.toggle("filtered", words.length > 0);
      counted.textContent = words.length ? `${count} of ${texts.size} rows` : "";
      announce(counted.textContent);
    };
    const name = shown.table.tHead.rows[0].querySelector(".name")?.textContent.trim() ?? "rows";
    const box = element("input", {
      type: "search", placeholder: `Filter by ${name}`, "aria-label": `Filter the rows by ${name}`, oninput: apply,
    });
    return [box, counted];
  };

  const fold = (shown) => {
    const count = shown.rows().length;
    const text = () => (shown.figure.classList.contains("folded") ? `Show all ${count} rows` : "Show fewer rows");
    const toggle = button(text(), () => {
      const folded = shown.figure.classList.toggle("folded");
      toggle.setAttribute("aria-expanded", String(!folded));
      toggle.textContent = text();
    }, { "aria-expanded": "false" });
    return toggle;
  };

  const link = (shown) => {
    const rows = new Map();
    for (const row of shown.body.querySelectorAll("tr[data-method]")) {
      const { method } = row.dataset;
      rows.set(method, [...rows.get(method) ?? [], row]);
      const cell = row.querySelector("th.name") ?? row.cells[0];
      const pick = button("", () => selection.toggle("method", method), { class: "pick", tabindex: -1, "aria-pressed": "false" });
      pick.append(...cell.childNodes);
      cell.append(pick);
    }
    if (!rows.size) return;
    const mark = (kind, value) => {
      for (const row of shown.body.querySelectorAll(`tr.${kind}`)) row.classList.remove(kind);
      for (const row of rows.get(value) ?? []) row.classList.add(kind);
    };
    const select = () => {
      mark("selected", selection.state.method);
      mark("reference", selection.state.reference);
      for (const [method, of] of rows) {
        for (const row of of) row.querySelector(".pick").setAttribute("aria-pressed", String(method === selection.state.method));
      }
    };
    select();
    selection.on((state, changed) => { if (changed.has("method") || changed.has("reference")) select(); });
    selection.on_hover((kind, value) => { if (kind === "method") mark("hovered", value); });
    const over = (event) => event.target.closest("tr")?.dataset.method ?? null;
    shown.body.addEventListener("mouseover", (event) => selection.hover("method", over(event)));
    shown.body.addEventListener("mouseleave", () => selection.hover("method", null));
    // one stop for the Tab key, arrows within
    const picks = () => [...shown.body.querySelectorAll(".pick")].filter((pick) => pick.checkVisibility());
    const stop = (pick) => {
      for (const other of shown.body.querySelectorAll('.pick[tabindex="0"]')) other.tabIndex = -1;
      pick.tabIndex = 0;
    };
    shown.body.querySelector(".pick").tabIndex = 0;
    shown.body.addEventListener("focusin", (event) => {
      if (!event.target.matches(".pick")) return;
      stop(event.target);
      selection.hover("method", over(event));
    });
    shown.body.addEventListener("keydown", (event) => {
      const all = picks();
      const at = all.indexOf(event.target);
      const to = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: all.length - 1 }[event.key];
      if (at < 0 || to === undefined || !all[to]) return;
      event.preventDefault();
      all[to].focus();
    });
  };

  for (const table of document.querySelectorAll("figure.table table")) {
    if (table.closest(".answer")) continue;
    if (table.tHead?.rows.length !== 1 || !table.tBodies.length || table.querySelector("[colspan], [rowspan]")) continue;
    const [body] = table.tBodies;
    const places = new Map([...body.rows].map((row, place) => [row, place]));
    const figure = table.closest("figure");
    const source = figure.querySelector("template.csv");
    const shown = {
      figure, table, body, places, rows: () => [...body.rows],
      // where a row is several of the file
      whole: source?.matches(".whole") && source.content.textContent,
      get records() {
        return source && !this.whole && (this.known ??= source.content.textContent.match(RECORD));
      },
      fields(row) {
        return fieldsOf(this.records[places.get(row) + 1]);
      },
    };
    const tools = element("div", { class: "tools" });
    if (places.size >= FILTERED_FROM) tools.append(...filter(shown));
    if (figure.classList.contains("folded")) tools.append(fold(shown));
    tools.append(copies(shown));
    figure.prepend(tools);
    if (table.classList.contains("sortable")) sorts(shown);
    link(shown);
  }
});
