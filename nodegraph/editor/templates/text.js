// The pane of the text: CodeMirror, with completion, documentation and mistakes from the server.
nodegraph.define("text", ["page"], ({ element }) => {
  const {
    Compartment, Decoration, EditorState, EditorView, HighlightStyle, Transaction, autocompletion, bracketMatching,
    completionKeymap, defaultKeymap, drawSelection, highlightActiveLine, highlightActiveLineGutter,
    highlightSpecialChars, indentLess, indentMore, indentOnInput, keymap, lineNumbers, lintGutter, searchKeymap,
    setDiagnostics, syntaxHighlighting, tags, yaml,
  } = CodeMirror;
  const WORD = /[^\s,:{}[\]#]+/y;
  const colours = HighlightStyle.define([
    { tag: [tags.definition(tags.propertyName), tags.propertyName, tags.labelName, tags.typeName], color: "var(--code-key)" },
    { tag: [tags.string, tags.special(tags.string)], color: "var(--code-text)" },
    { tag: [tags.number, tags.bool, tags.null, tags.keyword, tags.atom], color: "var(--code-number)" },
    { tag: [tags.comment, tags.lineComment], color: "var(--quiet)", fontStyle: "italic" },
    { tag: [tags.punctuation, tags.separator, tags.squareBracket, tags.brace, tags.meta], color: "var(--quiet)" },
  ]);

  // The one span in which two texts differ.
  const difference = (before, after) => {
    let from = 0;
    const most = Math.min(before.length, after.length);
    while (from < most && before[from] === after[from]) from += 1;
    let end = 0;
    while (end < most - from && before[before.length - 1 - end] === after[after.length - 1 - end]) end += 1;
    return { from, to: before.length - end, insert: after.slice(from, after.length - end) };
  };

  const paragraphs = (texts) => texts.map((text) => element("p", {}, text));

  // Readers: edited(), moved(line), options(position) and keys, a list of bindings.
  const make = (holder, readers) => {
    const chosen = new Compartment();
    const complete = async (context) => {
      if (!context.explicit && !context.matchBefore(/[\w$.]+$/)) return null;
      const { word, options } = await readers.options(context.pos);
      if (context.aborted) return null;
      return {
        from: context.pos - word.length,
        validFor: /^[\w$.:*-]*$/,
        options: options.map((option) => ({
          label: option.word,
          detail: option.kind,
          info: option.about.length ? () => element("div", {}, paragraphs(option.about)) : undefined,
          apply: (view, _, from, to) => {
            const colon = option.is_key && view.state.sliceDoc(to, to + 1) !== ":" ? ": " : "";
            const insert = option.word + colon;
            view.dispatch({ changes: { from, to, insert }, selection: { anchor: from + insert.length }, userEvent: "input.complete" });
          },
        })),
      };
    };
    const first = holder.textContent;
    holder.replaceChildren();
    const view = new EditorView({
      parent: holder,
      state: EditorState.create({
        doc: first,
        extensions: [
          lineNumbers(), highlightActiveLine(), highlightActiveLineGutter(), highlightSpecialChars(), drawSelection(),
          indentOnInput(), bracketMatching(), lintGutter(), yaml(), syntaxHighlighting(colours), chosen.of([]),
          autocompletion({ override: [complete] }),
          keymap.of([
            ...readers.keys, ...completionKeymap, ...searchKeymap,
            { key: "Mod-]", run: indentMore }, { key: "Mod-[", run: indentLess }, ...defaultKeymap,
          ]),
          EditorView.lineWrapping,
          EditorView.contentAttributes.of({ "aria-label": `Text of ${holder.dataset.file}`, spellcheck: "false", tabindex: "0" }),
          EditorView.updateListener.of((update) => {
            if (update.transactions.some((each) => each.annotation(Transaction.remote))) return;
            if (update.docChanged) readers.edited();
            if (update.selectionSet || update.docChanged) readers.moved(update.state.doc.lineAt(update.state.selection.main.head).number);
          }),
        ],
      }),
    });
    const change = (changes) => view.dispatch({ changes, annotations: Transaction.remote.of(true) });
    const text = () => view.state.sliceDoc();
    return {
      text,
      cursor: () => view.state.selection.main.head,
      set: (wanted) => {
        if (wanted !== text()) change(difference(text(), wanted));
      },
      // Take over what has changed from one text to another, though this has changed as well; false
      // if both have changed the same place.
      rebase: (before, after) => {
        const theirs = difference(before, after);
        const own = difference(before, text());
        const shift = own.insert.length - (own.to - own.from);
        if (theirs.to < own.from) change(theirs);
        else if (theirs.from > own.to) change({ ...theirs, from: theirs.from + shift, to: theirs.to + shift });
        else return false;
        return true;
      },
      mistakes: (problems) => {
        const doc = view.state.sliceDoc();
        const shown = problems.filter(({ at }) => at !== null && at <= doc.length).map(({ at, message, instead, is_error }) => {
          WORD.lastIndex = at;
          const to = WORD.exec(doc) ? WORD.lastIndex : Math.min(at + 1, doc.length);
          const renderMessage = () => element("div", {}, paragraphs([message, instead].filter(Boolean)));
          return { from: at, to, severity: is_error ? "error" : "warning", message: `${message} ${instead}`, renderMessage };
        });
        view.dispatch(setDiagnostics(view.state, shown));
      },
      go: (position) => {
        view.dispatch({ selection: { anchor: Math.min(position, view.state.doc.length) }, effects: EditorView.scrollIntoView(Math.min(position, view.state.doc.length), { y: "center" }) });
        view.focus();
      },
      // Mark the lines of a node, or none; scroll to them if that is asked for.
      mark: (lines, { scroll }) => {
        const { doc } = view.state;
        const ranges = [];
        for (let line = lines?.[0] ?? 1; lines && line <= Math.min(lines[1], doc.lines); line += 1) {
          ranges.push(Decoration.line({ class: "cm-chosen" }).range(doc.line(line).from));
        }
        const effects = [chosen.reconfigure(EditorView.decorations.of(Decoration.set(ranges)))];
        if (scroll && ranges.length) effects.push(EditorView.scrollIntoView(ranges[0].from, { y: "start", yMargin: 40 }));
        view.dispatch({ effects });
      },
    };
  };
  return { make, paragraphs };
});
