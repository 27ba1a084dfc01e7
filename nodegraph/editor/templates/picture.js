// The pane of the picture: cards that can be chosen, by a click or by keys.
nodegraph.define("picture", [], () => {
  const STEPS = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };

  // A reader hears of the name of a card that is chosen.
  const make = (holder, reader) => {
    let chosen = "";
    let scale = 0; // none: as wide as the pane, unless words became too small
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
    const resize = () => {
      const picture = holder.querySelector("svg");
      if (picture && scale) picture.style.minWidth = picture.style.maxWidth = `${scale * picture.getAttribute("width")}px`;
    };
    return {
      // Make the picture larger by a factor, or, by 0, as large as the pane has room for all of it.
      zoom: (factor) => {
        const picture = holder.querySelector("svg");
        if (!picture) return;
        const [width, height] = ["width", "height"].map((name) => Number(picture.getAttribute(name)));
        const now = picture.getBoundingClientRect().width / width;
        const room = Math.min((holder.clientWidth - 30) / width, (holder.clientHeight - 30) / height, 1);
        scale = Math.max(0.1, Math.min(factor ? now * factor : room, 4));
        resize();
      },
      // Show another picture, with the names of nodes that have mistakes; without one, the last stays, and
      // looks as if it were behind.
      draw: (svg, wrong) => {
        holder.classList.toggle("stale", !svg);
        if (!svg) return;
        const focused = document.activeElement?.dataset?.box;
        holder.innerHTML = svg;
        const picture = holder.querySelector("svg");
        picture.setAttribute("role", "group");
        picture.setAttribute("aria-label", "Nodes");
        for (const box of boxes()) {
          box.setAttribute("role", "button"); // its title names it
          if (wrong.some((name) => has(box, name))) box.dataset.wrong = "";
        }
        resize();
        show();
        if (focused) boxes().find((box) => box.dataset.box === focused)?.focus();
      },
      choose: (name, { scroll }) => {
        chosen = name;
        const box = show();
        if (scroll && name && box && has(box, name)) box.scrollIntoView({ block: "nearest", inline: "nearest" });
      },
    };
  };
  return { make };
});
