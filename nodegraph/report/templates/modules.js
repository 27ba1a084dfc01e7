"use strict";
// A script of the page is a module: nodegraph.define(name, needs, make). Once the page is complete,
// make is called once, with what the modules that it needs have returned.
const nodegraph = (() => {
  const defined = new Map();
  const made = new Map();
  const use = (name, reader) => {
    if (made.has(name)) return made.get(name);
    const module = defined.get(name);
    if (!module) throw new Error(`${reader} needs the module ${name}, which is not on this page`);
    made.set(name, undefined);
    made.set(name, module.make(...module.needs.map((need) => use(need, name))));
    return made.get(name);
  };
  const start = () => {
    for (const name of defined.keys()) {
      try {
        use(name, "the page");
      } catch (error) {
        console.error(`module ${name}:`, error);
      }
    }
  };
  document.addEventListener("DOMContentLoaded", start);
  return { define: (name, needs, make) => defined.set(name, { needs, make }) };
})();
