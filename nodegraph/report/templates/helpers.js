// Small tools that all scripts of the page share.
nodegraph.define("page", [], () => {
  const SVG = "http://www.w3.org/2000/svg";
  const fill = (node, attributes, children) => {
    for (const [name, value] of Object.entries(attributes ?? {})) {
      if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
      else if (value === true) node.setAttribute(name, "");
      else if (value !== null && value !== undefined && value !== false) node.setAttribute(name, value);
    }
    // text is text, never markup
    node.append(...children.flat().filter((child) => child !== null && child !== undefined));
    return node;
  };
  const element = (tag, attributes, ...children) => fill(document.createElement(tag), attributes, children);
  const svg = (tag, attributes, ...children) => fill(document.createElementNS(SVG, tag), attributes, children);
  // Three digits below 1, two decimals to 10, and as few as that above.
  const number = (value) => {
    if (value === null || value === undefined || !Number.isFinite(value)) return "\u2013";
    const size = Math.abs(value);
    if (size === 0) return "0";
    if (size < 0.001 || size >= 1e6) return value.toExponential(1).replace("-", "\u2212");
    const digits = size < 1 ? 3 : size < 10 ? 2 : size < 100 ? 1 : 0;
    const fixed = { minimumFractionDigits: digits, maximumFractionDigits: digits };
    return value.toLocaleString("en-US", fixed).replace("-", "\u2212");
  };
  const data = (id) => {
    const holder = document.getElementById(id);
    return holder ? JSON.parse(holder.textContent) : null;
  };
  const region = element("p", { class: "hidden", "aria-live": "polite" });
  document.body.append(region);
  const announce = (text) => { region.textContent = text; };
  const copy = async (text) => {
    if (navigator.clipboard) return navigator.clipboard.writeText(text);
    // a browser that gives a local page no clipboard still copies what is selected
    const box = element("textarea");
    box.value = text;
    document.body.append(box);
    box.select();
    const done = document.execCommand("copy");
    box.remove();
    if (!done) throw new Error("refused");
    return undefined;
  };
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  return { element, svg, number, data, announce, copy, reduced_motion: () => still.matches };
});
