nodegraph.define("missing", ["server"], (server) => {
  const button = document.getElementById("compute");
  const state = document.getElementById("state");
  button.addEventListener("click", async () => {
    const query = { ...JSON.parse(button.dataset.query), ...(button.dataset.now ? { now: "1" } : {}) };
    button.disabled = true;
    state.textContent = "Computing";
    try {
      await server.compute("value", query);
      location.replace(`/value?${new URLSearchParams(query)}`);
    } catch (error) {
      state.textContent = error.message;
      button.disabled = false;
    }
  });
});
