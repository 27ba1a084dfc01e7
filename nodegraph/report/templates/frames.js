// What is wider than its frame, or folded, can be reached.
nodegraph.define("frames", ["selection"], (selection) => {
  // Of a drawing that is wider than the page, its beginning is seen first.
  const begin = (frame) => {
    const first = frame.querySelector(".box");
    if (!first || frame.scrollWidth <= frame.clientWidth) return;
    const [outer, inner] = [frame.getBoundingClientRect(), first.getBoundingClientRect()];
    frame.scrollLeft += inner.left + inner.width / 2 - outer.left - outer.width / 2;
  };
  // A frame scrolls with the arrow keys too. What is folded is not measured before it is seen: a
  // browser would have to lay out thousands of rows for that.
  const reachable = (part) => {
    for (const frame of part.querySelectorAll("figure, .scroll, .wide, .rendered, .drawing")) {
      if (frame.closest("details:not([open])")) continue;
      if (frame.matches(".drawing")) begin(frame);
      if (frame.scrollWidth > frame.clientWidth || frame.scrollHeight > frame.clientHeight + 1) frame.tabIndex = 0;
    }
  };
  reachable(document);
  addEventListener("resize", () => reachable(document));
  document.addEventListener("toggle", (event) => reachable(event.target), true);
  // A link into something folded opens it.
  const unfold = () => {
    const target = document.getElementById(decodeURIComponent(selection.place()));
    for (let fold = target?.closest("details"); fold; fold = fold.parentElement.closest("details")) fold.open = true;
    target?.scrollIntoView();
  };
  addEventListener("hashchange", unfold);
  unfold();
});
