"use strict";
// What all charts share: a figure with a finding above and a caption below, which is drawn again when
// its width or what it shows changes; marks of methods that are pointed at, chosen and walked through
// by keys; and the note beside the pointer.
nodegraph.define("compare/chart", ["page", "selection"], (page, selection) => {
  const { element, svg } = page;

  const note = element("div", { class: "chart-note", "aria-hidden": "true" });
  document.body.append(note);
  const hideNote = () => note.classList.remove("visible");
  const showNote = ({ clientX, clientY }, title, ...lines) => {
    note.replaceChildren(element("b", {}, title), ...lines.filter(Boolean).map((line) => element("div", {}, line)));
    note.classList.add("visible");
    const { width, height } = note.getBoundingClientRect();
    const left = clientX + 14 + width > innerWidth - 8 ? clientX - 14 - width : clientX + 14;
    const top = clientY + 16 + height > innerHeight - 8 ? clientY - 12 - height : clientY + 16;
    note.style.left = `${Math.max(8, left)}px`;
    note.style.top = `${Math.max(8, top)}px`;
  };

  // Focus stays where it was when what had it is drawn again.
  const keepFocus = (host, draw) => {
    const focus = host.contains(document.activeElement) ? document.activeElement : null;
    const key = focus?.dataset.key;
    draw();
    if (!key || focus.isConnected) return;
    const same = [...host.querySelectorAll("[data-key]")].find((mark) => mark.dataset.key === key);
    if (same?.dataset.kind) moveTo(host, same);
    else same?.focus();
  };

  // Of the marks of a chart, one can be reached by Tab, the others by arrow keys.
  const moveTo = (host, mark) => {
    for (const other of host.querySelectorAll("[data-kind][tabindex='0']")) {
      if (other.dataset.kind === mark.dataset.kind) other.setAttribute("tabindex", -1);
    }
    mark.setAttribute("tabindex", 0);
    mark.focus({ preventScroll: false });
  };

  const marksOf = (host, kind) =>
    [...host.querySelectorAll(`[data-kind="${kind}"]`)]
      .sort((a, b) => Number(a.dataset.order) - Number(b.dataset.order));

  const firstReachable = (host) => {
    for (const kind of new Set([...host.querySelectorAll("[data-kind]")].map((mark) => mark.dataset.kind))) {
      const marks = marksOf(host, kind);
      if (!marks.some((mark) => mark.getAttribute("tabindex") === "0")) marks[0].setAttribute("tabindex", 0);
    }
  };

  // up and down by as many marks as stand in a row
  const stepOf = (key, across) => ({ ArrowDown: across, ArrowRight: 1, ArrowUp: -across, ArrowLeft: -1 })[key];
  const walk = (host, event) => {
    const mark = event.target.closest("[data-kind]");
    if (!mark) return;
    if (event.key === "Enter" || event.key === " ") {
      if (mark.tagName === "BUTTON") return;
      event.preventDefault();
      mark.dispatchEvent(new MouseEvent("click", { bubbles: true }));
      return;
    }
    const marks = marksOf(host, mark.dataset.kind);
    const at = marks.indexOf(mark);
    const next = event.key === "Home" ? marks[0] : event.key === "End" ? marks.at(-1) : marks[at + stepOf(event.key, Number(mark.dataset.across ?? 1))];
    if (!next || next === mark) return;
    event.preventDefault();
    moveTo(host, next);
  };

  // Attributes of a mark that stands for a method and can be chosen.
  const methodMark = (view, method, order, name) => {
    const label = view.overview.methods[method];
    return {
      "data-method": label, "data-key": label, "data-kind": "method", "data-order": order, tabindex: -1,
      role: "button", "aria-label": name, "aria-pressed": String(method === view.method),
    };
  };

  // A chart in its host: draw(plot, width) returns { finding, caption }.
  const mount = (host, view, { draw, className = "" }) => {
    // without scripts the page has a sentence of its own, which this one replaces
    const outer = host.previousElementSibling || host.matches("[data-chart]") ? host : host.parentElement;
    const before = outer.previousElementSibling;
    const finding = before?.matches("p.finding") ? before : element("p", { class: "finding" });
    const plot = element("div", { class: "plot" });
    const caption = element("figcaption", {});
    const figure = element("figure", { class: `chart ${className}` }, plot, caption);
    host.append(figure);
    if (finding !== before) figure.before(finding);
    let width = 0;
    const measure = () => Math.floor(plot.getBoundingClientRect().width);
    // a width is measured again only when it changes: that costs a layout of what was drawn before
    const redraw = () => {
      width ||= measure();
      if (!width) return;
      keepFocus(host, () => {
        const texts = draw(plot, width);
        if (texts.finding) finding.replaceChildren(...texts.finding);
        finding.hidden = !finding.textContent;
        caption.replaceChildren(...(texts.caption ?? []));
      });
      firstReachable(plot);
      hideNote();
    };
    new ResizeObserver(() => {
      if (Math.abs(measure() - width) <= 1) return;
      width = measure();
      redraw();
    }).observe(plot);
    view.on((changed) => {
      if ([...changed].some((name) => name !== "block")) redraw();
    });
    plot.addEventListener("pointerover", (event) => {
      selection.hover("method", event.target.closest("[data-method]")?.dataset.method ?? null);
    });
    plot.addEventListener("pointerleave", () => {
      selection.hover("method", null);
      hideNote();
    });
    plot.addEventListener("focusin", (event) => {
      selection.hover("method", event.target.closest("[data-method]")?.dataset.method ?? null);
    });
    plot.addEventListener("focusout", () => selection.hover("method", null));
    plot.addEventListener("click", (event) => {
      const mark = event.target.closest("[data-method]");
      if (mark) selection.toggle("method", mark.dataset.method);
    });
    plot.addEventListener("keydown", (event) => walk(plot, event));
    selection.on_hover((kind, value) => {
      if (kind !== "method") return;
      plot.classList.toggle("dim", value !== null && view.place(value) !== null);
      for (const mark of plot.querySelectorAll(".hover")) mark.classList.remove("hover");
      if (value === null) return;
      for (const mark of plot.querySelectorAll(`[data-method="${CSS.escape(value)}"]`)) mark.classList.add("hover");
    });
    redraw();
    return redraw;
  };

  // Width of a name in a chart, in pixels, as bold as it may become.
  const pen = document.createElement("canvas").getContext("2d");
  const widths = new Map();
  pen.font = `700 12px ${getComputedStyle(note).fontFamily}`;
  const textWidth = (name) => {
    if (!widths.has(name)) widths.set(name, pen.measureText(name).width);
    return widths.get(name);
  };
  const widest = (names) => Math.max(0, ...names.map(textWidth));

  // The name of a method: bold where the verdict on a group finds it best, and nowhere else.
  const named = (view, method, group = view.group) => {
    const name = view.overview.methods[method];
    return view.numbers(group).best.includes(method) ? strong(name) : name;
  };

  const strong = (text) => element("b", {}, String(text));
  // what a reader can do with a chart, but not on paper
  const hint = (text) => element("span", { class: "hint" }, text);
  const picture = (width, height, label, ...children) =>
    svg("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "group", "aria-label": label }, ...children);
  const text = (x, y, content, attributes) => svg("text", { x, y, ...attributes }, content);
  const line = (x1, y1, x2, y2, className) => svg("line", { x1, y1, x2, y2, class: className });

  return { mount, methodMark, walk, showNote, hideNote, named, strong, hint, picture, text, line, textWidth, widest };
});
