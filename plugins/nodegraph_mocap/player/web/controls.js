// The player's controls: plain form elements, so that keyboard and screen reader know them.

const made = (tag, attributes = {}, ...children) => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
};

const buttonFor = (text, label, act) => {
  const button = made("button", { type: "button", "aria-label": label, title: label }, text);
  button.addEventListener("click", act);
  return button;
};

const choiceOf = (text, options, act) => {
  const select = made("select", {}, ...options.map(([value, shown]) => made("option", { value }, shown)));
  select.addEventListener("change", () => act(select.value));
  return made("label", {}, `${text} `, select);
};

const switchFor = (text, on, act) => {
  const box = made("input", { type: "checkbox" });
  box.checked = on;
  box.addEventListener("change", () => act(box.checked));
  return made("label", {}, box, ` ${text}`);
};

const SPEEDS = [["1", "normal"], ["0.5", "half"], ["0.25", "a quarter"], ["0.1", "a tenth"]];

// Everything that can be pressed, in the order of the keyboard's focus.
const controlsFor = (player) => {
  const { study } = player;
  const recordings = study.panels.filter((one) => one.kind === "markers");
  const play = buttonFor("", "Play", () => player.toggle());
  const slider = made("input", { type: "range", min: 0, max: study.ticks - 1, step: 1, "aria-label": "Frame" });
  slider.addEventListener("input", () => player.seek(Number(slider.value)));
  const clock = made("output", { class: "clock", "aria-live": "off" });
  const row = made("div", { class: "time" },
    play,
    buttonFor("\u2039", "One frame back", () => player.step(-1)),
    buttonFor("\u203a", "One frame on", () => player.step(1)),
    slider, clock);
  const choose = (name) => (value) => player.choose({ [name]: value });
  const options = made("div", { class: "options" });
  options.append(choiceOf("Speed", SPEEDS, (value) => player.choose({ speed: Number(value) })));
  if (study.truth) {
    options.append(choiceOf("Colour", [["origin", "where it came from"], ["error", "error"]], choose("colour")));
    options.append(switchFor("Truth", true, choose("truth")));
  }
  if (recordings.length) options.append(switchFor("Trails", false, choose("trails")));
  options.append(made("span", { class: "view", role: "group", "aria-label": "View" },
    buttonFor("\u2212", "Smaller", () => player.look((camera) => zoomed(camera, 1 / 1.25))),
    buttonFor("+", "Larger", () => player.look((camera) => zoomed(camera, 1.25))),
    buttonFor("Front", "From the front", () => player.look(frontal))));
  return { element: made("div", { class: "controls" }, row, options), play, slider, clock };
};

const symbol = (origin) => made("span", { class: `key ${origin}`, "aria-hidden": "true" });

// What colours and signs mean; rebuilt when the colours change their meaning.
const legendFor = (study, choices) => {
  const legend = made("p", { class: "legend" });
  const recordings = study.panels.filter((one) => one.kind === "markers");
  if (!recordings.length) return legend;
  if (choices.colour === "error") {
    const stops = RAMP.map((one) => `rgb(${one.join(", ")})`).join(", ");
    const bar = made("span", { class: "ramp", "aria-hidden": "true" });
    bar.style.background = `linear-gradient(90deg, ${stops})`;
    legend.append(made("span", {}, "error 0 ", bar, ` ${study.errors} mm and more`));
    legend.append(made("span", {}, symbol("unknown"), "no truth to compare with"));
  } else {
    const seen = new Set(recordings.flatMap((one) => [...new Set(one.origin)]));
    for (const origin of [1, RECOVERED, REPAIRED]) {
      if (seen.has(origin)) legend.append(made("span", {}, symbol(ORIGINS[origin]), ORIGINS[origin]));
    }
  }
  if (study.truth && choices.truth) legend.append(made("span", {}, symbol("truth"), "where it should be"));
  return legend;
};
