// What a page keeps of a file, in a file beside it: the server writes that, and never the file itself.
nodegraph.define("server", [], () => {
  const KEPT = __KEPT__; // texts by label of the file; null where nothing is kept yet
  const keep = async (label, text) => {
    const answer = await fetch("/kept", {
      method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ label, text, before: KEPT[label] }),
    });
    if (!answer.ok) throw new Error((await answer.json()).message);
    KEPT[label] = text;
  };
  return { keep, keeps: (label) => label in KEPT };
});
