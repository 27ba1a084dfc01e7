// What hands do on the pictures: one finger turns, two move and enlarge; keys do all of it.
nodegraph.define("mocap/player/gestures", ["mocap/player/camera"], ({ frontal, turned, turnedOver, zoomed }) => {
  const TURN = Math.PI; // across a picture's width
  const STILL = 4; // px that a hand may move in a click
  const OF_TIME = {
    " ": (player) => player.toggle(),
    ArrowLeft: (player) => player.step(-1),
    ArrowRight: (player) => player.step(1),
    Home: (player) => player.seek(0),
    End: (player) => player.seek(player.study.ticks - 1),
  };
  const KEYS = {
    "+": (player) => player.look((camera) => zoomed(camera, 1.25)),
    "-": (player) => player.look((camera) => zoomed(camera, 1 / 1.25)),
    0: (player) => player.look(frontal),
    u: (player) => player.look(turnedOver),
  };
  const WITH_SHIFT = {
    ArrowLeft: (player) => player.look((camera) => turned(camera, -TURN / 24, 0)),
    ArrowRight: (player) => player.look((camera) => turned(camera, TURN / 24, 0)),
    ArrowUp: (player) => player.look((camera) => turned(camera, 0, -TURN / 24)),
    ArrowDown: (player) => player.look((camera) => turned(camera, 0, TURN / 24)),
  };

  const middle = (points) => {
    const [a, b = a] = [...points.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) };
  };

  const dragged = (player, canvas, place) => {
    const fingers = new Map();
    let moved = 0;
    canvas.addEventListener("pointerdown", (event) => {
      if (event.button > 0) return;
      moved = 0;
      canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!fingers.has(event.pointerId)) return player.point(place, event);
      player.point(place, null);
      const before = middle(fingers);
      fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
      const now = middle(fingers);
      moved += Math.hypot(now.x - before.x, now.y - before.y);
      const [x, y] = [(now.x - before.x) / canvas.clientWidth, (now.y - before.y) / canvas.clientWidth];
      if (fingers.size === 1 && !event.shiftKey) return player.look((camera) => turned(camera, TURN * x, TURN * y));
      const closer = before.apart ? now.apart / before.apart : 1;
      player.look((camera) => zoomed({ ...camera, x: camera.x + x, y: camera.y + y }, closer));
    });
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
      canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
    }
    canvas.addEventListener("pointerleave", () => player.point(place, null));
    canvas.addEventListener("click", (event) => { if (moved < STILL) player.press(place, event); });
    // a plain wheel scrolls the page, as everywhere; two fingers on a touchpad come with Ctrl
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      player.look((camera) => zoomed(camera, Math.exp(-event.deltaY / 300)));
    }, { passive: false });
  };

  // Keys are ours while the pictures have the focus; controls keep what they mean by themselves.
  const keyed = (player, stage, keys = { ...OF_TIME, ...KEYS }) => stage.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const act = (event.shiftKey && WITH_SHIFT[event.key]) || (!event.shiftKey || event.key === "+" ? keys[event.key] : null);
    if (!act) return;
    event.preventDefault();
    act(player);
  });

  // Of a stream, whose time nobody sets.
  const keyedInSpace = (player, stage) => keyed(player, stage, KEYS);

  return { dragged, keyed, keyedInSpace };
});
