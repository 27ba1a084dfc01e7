// The strip of a recording: a row per marker that has gaps or impulses, red where samples are missing.
nodegraph.define("mocap/player/faults", ["page", "mocap/player/rows"], ({ element }, { Rows }) => {
  const HEIGHT = 14; // px
  const FAINTEST = 0.35; // opacity of a stretch of which little is missing

  const faultsFor = (player, panel, pick) => {
    const { stretches, missing, impulses: [markers, seconds], left_out } = panel.faults;
    const share = panel.frames / panel.rate / player.study.seconds;
    const impulses = panel.markers.map(() => []);
    markers.forEach((marker, place) => impulses[marker].push(seconds[place]));
    const has = (marker) => impulses[marker].length || missing.subarray(marker * stretches, (marker + 1) * stretches).some(Boolean);
    const faulty = panel.markers.map((_, marker) => marker).filter(has);
    const name = panel.label || "the recording";
    const clean = panel.markers.length - faulty.length;
    if (!faulty.length) return { element: element("p", { class: "quiet" }, `No marker of ${name} has a gap or a likely impulse.`), tell: () => {} };
    const without = clean ? `; ${clean} of ${panel.markers.length} markers have neither` : "";
    const more = left_out ? `; ${left_out} smaller impulses are not marked` : "";
    return new Rows(player, {
      title: `Gaps (red) and likely impulses (violet) of ${name}${without}${more}`,
      names: faulty.map((marker) => panel.markers[marker]),
      height: HEIGHT,
      pick,
      paint: (pen, row, { top, height, width }, ink) => {
        const first = faulty[row] * stretches;
        const step = (width * share) / stretches;
        pen.fillStyle = ink.missing;
        for (let at = 0; at < stretches; at += 1) {
          const part = missing[first + at] / 255;
          if (!part) continue;
          pen.globalAlpha = FAINTEST + (1 - FAINTEST) * part;
          pen.fillRect(at * step, top + 3, Math.max(1, step + 0.3), height - 6);
        }
        pen.globalAlpha = 1;
        pen.fillStyle = ink.impulse;
        for (const second of impulses[faulty[row]]) pen.fillRect((width * second) / player.study.seconds - 0.75, top + 1, 1.5, height - 2.5);
      },
    });
  };

  return { faultsFor };
});
