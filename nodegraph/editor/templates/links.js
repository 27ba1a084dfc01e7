// Links that are drawn with the pointer, from an output to a port. The server says which ports fit.
nodegraph.define("links", ["page", "editor", "panel"], ({ svg, announce }, editor, panel) => {
  const START = 4; // pixels by which a drag differs from a click
  const NEAR = 8; // pixels of the picture between a socket and a pointer in its row
  const EDGE = 24; // pixels at the edge of the pane in which a drag moves the picture on
  const holder = document.getElementById("picture");
  let link = null;

  const middle = (socket) => {
    const { left, top, width, height } = socket.getBoundingClientRect();
    return [left + width / 2, top + height / 2];
  };
  // The socket on a side of a card in whose row a point of the window is.
  const socket_at = (box, side, x, y) => {
    const { left, width } = box.querySelector(".frame").getBoundingClientRect();
    const near = NEAR * width / box.querySelector(".frame").getAttribute("width");
    if (side === "output" && x < left + width / 2) return null;
    return [...box.querySelectorAll(`[data-${side}]`)].find((socket) => Math.abs(middle(socket)[1] - y) <= near) ?? null;
  };

  const mark = (names) => {
    for (const each of holder.querySelectorAll("[data-fits]")) delete each.dataset.fits;
    for (const [name, ports] of Object.entries(names)) {
      const fits = Object.keys(ports).filter((port) => !ports[port]);
      const card = holder.querySelector(`[data-box="${name}"]`);
      for (const port of fits) card?.querySelector(`[data-input="${CSS.escape(port)}"]`)?.setAttribute("data-fits", "");
      if (fits.length) holder.querySelector(`[data-frame="${name}"]`)?.setAttribute("data-fits", "");
    }
  };
  const begin = (pointer) => {
    holder.setPointerCapture(pointer);
    holder.classList.add("linking");
    link.line = svg("path", { class: "drawn" });
    holder.querySelector("svg").append(link.line);
    link.targets = editor.get("/targets", { box: link.box.dataset.box, port: link.socket.dataset.output });
    const here = link;
    link.targets.then(({ ports }) => { if (link === here) mark(ports); }, () => {}); // the drop says why not
  };
  const end = () => {
    link?.line?.remove();
    link = null;
    holder.classList.remove("linking");
    mark({});
  };
  const follow = (x, y) => {
    const picture = holder.querySelector("svg");
    const place = picture.getScreenCTM().inverse();
    const [from, to] = [middle(link.socket), [x, y]].map((point) => new DOMPoint(...point).matrixTransform(place));
    const bend = (from.x + to.x) / 2;
    link.line.setAttribute("d", `M${from.x} ${from.y}C${bend} ${from.y} ${bend} ${to.y} ${to.x} ${to.y}`);
    const pane = holder.getBoundingClientRect();
    const beyond = (at, low, high) => (at < low + EDGE ? -EDGE : at > high - EDGE ? EDGE : 0);
    holder.scrollBy(beyond(x, pane.left, pane.right), beyond(y, pane.top, pane.bottom));
  };

  // The port of a node at which a link is dropped, or why there is none.
  const port_at = (name, socket, ports) => {
    if (socket) return { port: socket.dataset.input, reason: ports[socket.dataset.input] };
    const fits = Object.keys(ports).filter((port) => !ports[port]);
    if (fits.length === 1) return { port: fits[0], reason: "" };
    if (fits.length) return { reason: `it fits ${fits.join(", ")}; drop it at one of them` };
    const [reason] = Object.values(ports);
    return { reason: reason ?? "it has no ports that are known" };
  };
  const drop = async ({ box: from, targets }, x, y) => {
    const target = document.elementFromPoint(x, y);
    const box = holder.contains(target) ? target.closest("[data-box], [data-frame]") : null;
    if (!holder.contains(target) || box === from) return;
    const name = box ? editor.node_of(box.dataset.box ?? box.dataset.frame) : "";
    const socket = box?.dataset.box === name ? socket_at(box, "input", x, y) : null;
    const { source, ports } = await targets;
    if (!box) {
      panel.open_search(source);
      return;
    }
    const { port, reason } = port_at(name, socket, ports[name]);
    if (reason) editor.say(`${source} does not feed ${port ? `${name}.${port}` : name}: ${reason}`);
    else if (await editor.act("connect", { arguments: { node: name, port, source } })) {
      announce(`${source} feeds ${name}.${port}`);
      editor.choose(name, { scroll: "text" });
    }
  };

  holder.addEventListener("pointerdown", (event) => {
    const box = event.button === 0 ? event.target.closest("[data-box]") : null;
    const socket = box && socket_at(box, "output", event.clientX, event.clientY);
    link = socket ? { box, socket, x: event.clientX, y: event.clientY } : null;
  });
  holder.addEventListener("pointermove", ({ clientX: x, clientY: y, pointerId }) => {
    if (!link) return;
    if (!link.line && Math.hypot(x - link.x, y - link.y) >= START) begin(pointerId);
    if (link.line?.isConnected) follow(x, y);
    else if (link.line) end(); // the picture has changed meanwhile
  });
  holder.addEventListener("pointerup", ({ clientX: x, clientY: y }) => {
    const done = link;
    end();
    if (done?.line) drop(done, x, y).catch((error) => editor.say(error.message));
  });
  holder.addEventListener("pointercancel", end);
  addEventListener("keydown", ({ key }) => { if (key === "Escape") end(); });
  return {};
});
