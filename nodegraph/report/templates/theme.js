// Light or dark: as the system has it, unless the reader chooses. Scripts that draw on a canvas hear
// of it: nodegraph's module "theme" has on(reader).
nodegraph.define("theme", [], () => {
  const NAME = "nodegraph-theme";
  const root = document.documentElement;
  const system = matchMedia("(prefers-color-scheme: dark)");
  const readers = [];
  const stored = () => {
    try {
      return localStorage.getItem(NAME);
    } catch { // a browser may keep a local page from storing
      return null;
    }
  };
  const dark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
  const button = document.getElementById("theme");
  const show = () => {
    if (button) button.textContent = dark() ? "Light" : "Dark";
    for (const reader of readers) reader(dark());
    dispatchEvent(new Event("themechange"));
  };
  const choose = (theme) => {
    if ((theme === "dark") === system.matches) delete root.dataset.theme;
    else root.dataset.theme = theme;
    show();
  };
  system.addEventListener("change", show);
  if (button) {
    button.hidden = false;
    button.addEventListener("click", () => {
      const theme = dark() ? "light" : "dark";
      try {
        localStorage.setItem(NAME, theme);
      } catch { /* it lasts as long as the page */ }
      choose(theme);
    });
    if (stored()) choose(stored());
    else show();
  }
  return { dark, on: (reader) => { readers.push(reader); } };
});
