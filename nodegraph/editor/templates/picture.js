// The pane of the picture: cards that can be chosen, by a click or by keys, and how large they are.
nodegraph.define("picture", [], () => {
  const STEPS = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };
  const SETTLED = 200; // milliseconds without a change of size
  const [LEAST, MOST] = [0.02, 4];
  const WHEEL = 0.006; // how much a pixel of the wheel changes the logarithm of the size
  const START = 4; // pixels by which a drag differs from a click
  const MANY = 200; // cards, among which dashes of long links take most of the time of a frame

  // A reader hears of the name of a card that is chosen.
  const make = (holder, reader) => {
    let chosen = "";
    let shown = ""; // the picture as it came
    let parts = new Map(); // its cards, arrows and frames, by all that they are but for their places
    let scale = 0; // none: as wide as the pane, unless words became too small
    let drawn = 0; // the scale at which it is drawn while another is shown
    let settling = 0;
    let fixed = null; // a point of the window, and what of the picture is there while that changes its size
    const layer = document.createElement("div"); // of the picture: what is stretched itself is laid out anew
    layer.style.transformOrigin = "0 0";
    const boxes = () => [...holder.querySelectorAll("[data-box]")];
    const has = (box, name) => box.dataset.box === name || box.dataset.box.startsWith(`${name}.`);
    const show = () => {
      const all = boxes();
      const first = all.find((box) => has(box, chosen)) ?? all[0];
      for (const box of all) {
        box.setAttribute("aria-pressed", chosen !== "" && has(box, chosen));
        box.setAttribute("tabindex", box === first ? 0 : -1);
      }
      return first;
    };
    const box_of = (event) => event.target.closest?.("[data-box]");
    holder.addEventListener("click", (event) => {
      const box = box_of(event);
      if (box) reader(box.dataset.box);
    });
    holder.addEventListener("keydown", (event) => {
      const box = box_of(event);
      if (!box || event.ctrlKey || event.metaKey || event.altKey) return;
      const all = boxes();
      const place = all.indexOf(box);
      const next = { Home: 0, End: all.length - 1 }[event.key] ?? (event.key in STEPS ? place + STEPS[event.key] : null);
      if (event.key === "Enter" || event.key === " ") reader(box.dataset.box);
      else if (next !== null) {
        all[place].setAttribute("tabindex", -1);
        const to = all[Math.max(0, Math.min(next, all.length - 1))];
        to.setAttribute("tabindex", 0);
        to.focus();
      } else return;
      event.preventDefault();
    });

    // Put another picture in the place of this one. Parts that are the same stay, and move to their places:
    // a browser takes many times as long to lay out the words of a thousand new cards.
    const set = (part, name, value) => { if (part.getAttribute(name) !== value) part.setAttribute(name, value); };
    const put = (svg) => {
      const sheet = document.createElement("template");
      sheet.innerHTML = svg;
      const next = sheet.content.firstElementChild;
      const wanted = new Map();
      for (const part of next.lastElementChild.children) {
        const place = part.getAttribute("transform");
        part.removeAttribute("transform");
        const source = part.outerHTML;
        const same = parts.get(source) ?? part;
        if (place) set(same, "transform", place);
        wanted.set(source, same);
      }
      parts = wanted;
      const picture = holder.querySelector("svg");
      if (!picture) {
        layer.replaceChildren(next);
        holder.replaceChildren(layer);
        return;
      }
      for (const name of ["width", "height", "viewBox", "style"]) set(picture, name, next.getAttribute(name));
      const around = [...next.children].slice(0, -1);
      const group = picture.children[around.length];
      around.forEach((part, at) => { if (!part.isEqualNode(picture.children[at])) picture.children[at].replaceWith(part); });
      const kept = new Set(parts.values());
      for (const part of [...group.children]) if (!kept.has(part)) part.remove();
      let before = group.firstElementChild;
      for (const part of kept) {
        if (part === before) before = before.nextElementSibling;
        else group.insertBefore(part, before);
      }
    };

    // ---- its size ----

    const width_of = (picture) => Number(picture.getAttribute("width"));
    const settle = () => {
      clearTimeout(settling);
      const picture = holder.querySelector("svg");
      if (!picture || !scale) return;
      const { scrollLeft, scrollTop } = holder;
      layer.style.transform = layer.style.willChange = "";
      picture.style.minWidth = picture.style.maxWidth = `${scale * width_of(picture)}px`;
      if (drawn) keep_point(picture);
      else holder.scrollTo(scrollLeft, scrollTop);
      drawn = 0;
    };
    const keep_point = (picture) => {
      const { left, top } = picture.getBoundingClientRect();
      holder.scrollBy(left + fixed.right * scale - fixed.x, top + fixed.down * scale - fixed.y);
    };
    const scale_now = (picture) => picture.getBoundingClientRect().width / width_of(picture);
    // The layer of a picture that changes its size is stretched; the picture is drawn anew once it keeps
    // that: to lay out all its words at each step would take many frames. A point of it stays where it is in
    // the window, at the latest in the end: a stretched layer may have no room yet to be scrolled.
    const zoom_to = (wanted, x, y) => {
      const picture = holder.querySelector("svg");
      const width = width_of(picture);
      const before = picture.getBoundingClientRect();
      const now = before.width / width;
      if (!drawn || fixed.x !== x || fixed.y !== y) fixed = { x, y, right: (x - before.left) / now, down: (y - before.top) / now };
      drawn ||= now;
      scale = Math.max(LEAST, Math.min(wanted, MOST));
      const style = getComputedStyle(holder);
      const room = holder.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
      const left = (size) => Math.max(0, (room - size * width) / 2); // it stands in the middle
      layer.style.willChange = "transform";
      layer.style.transform = `translateX(${left(scale) - left(drawn) * scale / drawn}px) scale(${scale / drawn})`;
      keep_point(picture);
      clearTimeout(settling);
      settling = setTimeout(settle, SETTLED);
    };
    // Who moves the picture wants it there, and not where its fixed point was.
    const settle_now = () => { if (drawn) settle(); };
    holder.addEventListener("wheel", (event) => {
      const picture = holder.querySelector("svg");
      if (!picture) return;
      if (!event.ctrlKey && !event.metaKey) {
        settle_now();
        return;
      }
      event.preventDefault();
      const pixels = event.deltaY * (event.deltaMode ? 16 : 1);
      zoom_to(scale_now(picture) * Math.exp(-WHEEL * Math.max(-50, Math.min(pixels, 50))), event.clientX, event.clientY);
    }, { passive: false });

    // ---- the part of it that is in view, moved by the mouse between the cards ----

    let grip = null;
    holder.addEventListener("pointerdown", (event) => {
      settle_now();
      const is_bar = event.offsetX > holder.clientWidth || event.offsetY > holder.clientHeight;
      if (event.pointerType !== "mouse" || event.button !== 0 || box_of(event) || (event.target === holder && is_bar)) return;
      grip = { x: event.clientX, y: event.clientY, left: holder.scrollLeft, top: holder.scrollTop, moves: false };
    });
    holder.addEventListener("pointermove", (event) => {
      if (!grip) return;
      const [right, down] = [event.clientX - grip.x, event.clientY - grip.y];
      if (!grip.moves && Math.hypot(right, down) < START) return;
      if (!grip.moves) holder.setPointerCapture(event.pointerId);
      grip.moves = true;
      holder.scrollTo(grip.left - right, grip.top - down);
    });
    for (const end of ["pointerup", "pointercancel"]) holder.addEventListener(end, () => { grip = null; });
    // What is in hand stays in view when other panes take room.
    const keep_in_view = () => {
      const box = chosen ? boxes().find((each) => has(each, chosen)) : null;
      box?.scrollIntoView({ block: "nearest", inline: "nearest" });
    };
    new ResizeObserver(keep_in_view).observe(holder);

    return {
      // Make the picture larger by a factor, or, by 0, as large as the pane has room for all of it.
      zoom: (factor) => {
        const picture = holder.querySelector("svg");
        if (!picture) return;
        const room = Math.min((holder.clientWidth - 30) / width_of(picture), (holder.clientHeight - 30) / picture.getAttribute("height"), 1);
        const { left, top } = holder.getBoundingClientRect();
        zoom_to(factor ? scale_now(picture) * factor : room, left + holder.clientWidth / 2, top + holder.clientHeight / 2);
        if (!factor) settle();
      },
      // Show another picture, with the names of nodes that have mistakes; without one, the last stays, and
      // looks as if it were behind, or the reason stands in its place.
      draw: (svg, wrong, reason) => {
        if (!svg && !shown) holder.replaceChildren(reason);
        holder.classList.toggle("stale", !svg && shown !== "");
        if (svg && svg !== shown) {
          const focused = document.activeElement?.dataset?.box;
          shown = svg;
          put(svg);
          const picture = holder.querySelector("svg");
          picture.setAttribute("role", "group");
          picture.setAttribute("aria-label", "Nodes");
          for (const box of boxes()) box.setAttribute("role", "button"); // its title names it
          holder.classList.toggle("many", boxes().length > MANY);
          settle();
          show();
          if (focused) boxes().find((box) => box.dataset.box === focused)?.focus();
        }
        if (svg) for (const box of boxes()) box.toggleAttribute("data-wrong", wrong.some((name) => has(box, name)));
      },
      choose: (name, { scroll }) => {
        chosen = name;
        show();
        if (scroll) keep_in_view();
      },
    };
  };
  return { make };
});
