// The player's controls: plain form elements, so that keyboard and screen reader know them.
nodegraph.define("mocap/player/controls", ["page", "selection", "mocap/player/camera", "mocap/player/markers"], (page, selection, { frontal, turnedOver, zoomed }, { FILLED, REPAIRED, ORIGINS, RAMP }) => {
  const { element } = page;

  const buttonFor = (text, label, act) =>
    element("button", { type: "button", "aria-label": label, title: label, onclick: act }, text);

  const choiceOf = (text, options, act, chosen) => {
    const select = element("select", {}, ...options.map(([value, shown]) => element("option", { value, selected: value === chosen }, shown)));
    select.addEventListener("change", () => act(select.value));
    return element("label", {}, `${text} `, select);
  };

  const switchFor = (text, on, act) => {
    const box = element("input", { type: "checkbox" });
    box.checked = on;
    box.addEventListener("change", () => act(box.checked));
    return element("label", {}, box, ` ${text}`);
  };

  const SPEEDS = [["4", "4 times"], ["2", "twice"], ["1", "normal"], ["0.5", "half"], ["0.25", "a quarter"], ["0.1", "a tenth"]];
  const TIMES = [["1", "as they are"], ["10", "ten times"]];

  // The middles of gaps, under the slider: a click goes there; the keyboard has a button for it.
  const gapsFor = (player) => {
    const strip = element("span", { class: "gaps", "aria-hidden": "true" });
    for (const gap of player.study.gaps) {
      const [first, last, marker] = gap;
      const mark = element("span", { title: `${marker}, ${first.toFixed(2)} to ${last.toFixed(2)} s`, onclick: () => player.visit(gap) });
      mark.style.left = `${(50 * (first + last)) / player.study.seconds}%`;
      strip.append(mark);
    }
    return strip;
  };

  // Everything that can be pressed, in the order of the keyboard's focus.
  const controlsFor = (player) => {
    const { study } = player;
    const recordings = study.panels.filter((panel) => panel.kind === "markers");
    const play = buttonFor("", "Play", () => player.toggle());
    const slider = element("input", { type: "range", min: 0, max: study.ticks - 1, step: 1, "aria-label": "Frame" });
    slider.addEventListener("input", () => player.seek(Number(slider.value)));
    const clock = element("output", { class: "clock", "aria-live": "off" });
    const row = element("div", { class: "time" },
      play,
      buttonFor("\u2039", "One frame back", () => player.step(-1)),
      buttonFor("\u203a", "One frame on", () => player.step(1)),
      element("span", { class: "track" }, slider, gapsFor(player)), clock);
    if (study.gaps.length) row.insertBefore(buttonFor("Next gap", "Next gap", () => player.nextGap()), row.querySelector(".track"));
    const choose = (name) => (value) => player.choose({ [name]: value });
    const options = element("div", { class: "options" });
    options.append(choiceOf("Speed", SPEEDS, (value) => player.choose({ speed: Number(value) }), "1"));
    if (study.truth) {
      options.append(choiceOf("Colour", [["origin", "where it came from"], ["error", "error"]], choose("colour"), "origin"));
      options.append(choiceOf("Errors", TIMES, (value) => player.choose({ times: Number(value) }), "1"));
      options.append(switchFor("Truth", true, choose("truth")));
    }
    if (recordings.length) options.append(switchFor("Trails", false, choose("trails")), switchFor("Names", false, choose("names")));
    const marker = choiceOf("Marker", [], (name) => selection.set({ marker: name || null }), "");
    const select = marker.querySelector("select");
    const offer = () => {
      const names = [...new Set(recordings.flatMap((panel) => panel.markers))];
      select.replaceChildren(...[["", "none"], ...names.map((name) => [name, name])].map(([value, text]) => element("option", { value }, text)));
    };
    offer();
    if (study.with_hand) options.append(marker);
    if (study.with_hand && recordings.length > 1) options.append(switchFor("Over each other", false, choose("over")));
    if (study.panels.length) options.append(element("span", { class: "view", role: "group", "aria-label": "View" },
      buttonFor("\u2212", "Smaller", () => player.look((camera) => zoomed(camera, 1 / 1.25))),
      buttonFor("+", "Larger", () => player.look((camera) => zoomed(camera, 1.25))),
      buttonFor("Front", "From the front", () => player.look(frontal)),
      buttonFor("\u21bb", "Upside down", () => player.look(turnedOver))));
    return { element: element("div", { class: "controls" }, row, options), play, slider, clock, marker: select, offer };
  };

  // Which of many panels are shown: a button each, with the panel's mean error if there is one.
  const chooserFor = (player, most) => {
    const buttons = player.study.panels.map((panel, place) => element("button", { type: "button", onclick: () => player.pick(place) },
      panel.label || "recording", panel.error === null ? null : element("span", { class: "quiet" }, ` ${page.number(panel.error)}`)));
    const unit = player.study.panels.some(({ error }) => error !== null) ? "; with the mean error in mm of what was made" : "";
    const group = element("div", { class: "chooser", role: "group", "aria-label": "Panels" },
      element("span", { class: "quiet" }, `Up to ${most} at once${unit}:`), ...buttons);
    return { element: group, buttons };
  };

  const symbol = (origin) => element("span", { class: `key ${origin}`, "aria-hidden": "true" });

  // What colours and signs mean; rebuilt when the colours change their meaning.
  const legendFor = (study, choices, over = []) => {
    const legend = element("p", { class: "legend" });
    const recordings = study.panels.filter((panel) => panel.kind === "markers");
    if (!recordings.length) return legend;
    if (over.length) {
      legend.append(...over.map(({ label, colour }) => {
        const key = symbol("");
        key.style.background = colour;
        return element("span", {}, key, label);
      }));
      return legend;
    }
    if (choices.colour === "error") {
      const stops = RAMP.map((colour) => `rgb(${colour.join(", ")})`).join(", ");
      const bar = element("span", { class: "ramp", "aria-hidden": "true" });
      bar.style.background = `linear-gradient(90deg, ${stops})`;
      legend.append(element("span", {}, "error 0 ", bar, ` ${study.errors} mm and more`));
      legend.append(element("span", {}, symbol("unknown"), "no truth to compare with"));
    } else {
      const seen = new Set(recordings.flatMap((panel) => [...new Set(panel.origin)]));
      for (const origin of [1, FILLED, REPAIRED]) {
        if (seen.has(origin)) legend.append(element("span", {}, symbol(ORIGINS[origin]), ORIGINS[origin]));
      }
    }
    if (study.truth && choices.truth) legend.append(element("span", {}, symbol("truth"), "where it should be"));
    if (choices.times > 1) legend.append(element("strong", {}, `errors are drawn ${choices.times} times as large as they are`));
    return legend;
  };

  return { controlsFor, chooserFor, legendFor, buttonFor };
});
