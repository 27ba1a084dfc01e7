// The strip of a recording: a row per marker of which samples are missing, made or likely impulses.
nodegraph.define("mocap/player/strip", ["page", "mocap/player/rows", "mocap/player/marks"], ({ element }, { Rows }, { spansOf }) => {
  const HEIGHT = 14; // px
  const FAINTEST = 0.35; // opacity of a stretch of which little is so
  const KINDS = ["missing", "filled", "repaired"];

  const stripFor = (player, panel, pick) => {
    const { stretches, kinds, impulses: [markers, seconds], left_out } = panel.strip;
    const share = panel.frames / panel.rate / player.study.seconds;
    const impulses = panel.markers.map(() => []);
    markers.forEach((marker, place) => impulses[marker].push(seconds[place]));
    const spans = panel.markers.map((name) => spansOf(panel, player.study.every, name));
    const rowOf = (kind, marker) => kind.subarray(marker * stretches, (marker + 1) * stretches);
    const shown = panel.markers.map((_, marker) => marker)
      .filter((marker) => impulses[marker].length || spans[marker].length || kinds.some((kind) => rowOf(kind, marker).some(Boolean)));
    const name = panel.label || "the recording";
    if (!shown.length) return { element: element("p", { class: "quiet" }, `No marker of ${name} has a gap or a likely impulse.`), tell: () => {} };
    const present = [...KINDS.filter((_, place) => kinds[place].some(Boolean)), ...(markers.length ? ["impulse"] : []), ...(spans.some((each) => each.length) ? ["marked"] : [])];
    const clean = panel.markers.length - shown.length;
    const rows = new Rows(player, {
      title: `Samples of ${name} that are not as measured${clean ? `; ${clean} of ${panel.markers.length} markers have none` : ""}`,
      names: shown.map((marker) => panel.markers[marker]),
      height: HEIGHT,
      pick,
      paint: (pen, row, { top, height, width }, ink) => {
        const step = (width * share) / stretches;
        kinds.forEach((kind, place) => {
          pen.fillStyle = ink[KINDS[place]];
          rowOf(kind, shown[row]).forEach((part, at) => {
            if (!part) return;
            pen.globalAlpha = FAINTEST + ((1 - FAINTEST) * part) / 255;
            pen.fillRect(at * step, top + 3, Math.max(1, step + 0.3), height - 6);
          });
        });
        pen.globalAlpha = 1;
        pen.fillStyle = ink.impulse;
        pen.strokeStyle = ink.marked;
        for (const [first, stop] of spans[shown[row]]) {
          const [left, right] = [first, stop].map((second) => (width * second) / player.study.seconds);
          pen.strokeRect(left, top + 1.5, Math.max(1.5, right - left), height - 3.5);
        }
        for (const second of impulses[shown[row]]) pen.fillRect((width * second) / player.study.seconds - 0.75, top + 1, 1.5, height - 2.5);
      },
    });
    const words = { marked: "marked by hand", impulse: left_out ? `likely impulse (${left_out} smaller ones are not marked)` : "likely impulse" };
    rows.table.before(element("p", { class: "legend" }, ...present.map((kind) =>
      element("span", {}, element("span", { class: `stretch ${kind}`, "aria-hidden": "true" }), words[kind] ?? kind))));
    return rows;
  };

  return { stripFor };
});
