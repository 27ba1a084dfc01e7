// Marks: what a person says of samples, span by span. They are applied to a copy of the take, in
// their order and as the node recording.apply_marks does, and the server keeps them beside the take.
nodegraph.define("mocap/player/marks", ["page", "selection", "server"], ({ element, announce }, selection, server) => {
  const MISSING = 0;

  const counted = (count, what) => `${count} ${what}${count === 1 ? "" : "s"}`;
  const cellOf = (text) => (/[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : String(text));
  const placeOf = ([, start, frames]) => (frames === 1 ? `frame ${start}` : `frames ${start} to ${start + frames - 1}`);
  const textOf = (mark) => `${mark[0]}, ${placeOf(mark)}: ${mark[3]}${mark[4] ? `${mark[3] === "swapped" ? " with" : ""} ${mark[4]}` : ""}`;

  // Of each marker its samples, its row of the strip and its impulses: [array, whether by frame].
  const tracksOf = ({ markers, frames, origin, places, strip }) => markers.map((name, marker) => ({
    name, column: marker,
    origin: origin.slice(marker * frames, (marker + 1) * frames),
    places: [0, 1, 2].map((k) => places.slice((3 * marker + k) * frames, (3 * marker + k + 1) * frames)),
    kinds: strip.kinds.map((kind) => kind.slice(marker * strip.stretches, (marker + 1) * strip.stretches)),
    impulses: strip.impulses[1].filter((_, at) => strip.impulses[0][at] === marker),
  }));

  const joined = (parts, Kind) => {
    const whole = new Kind(parts.reduce((sum, part) => sum + part.length, 0));
    let at = 0;
    for (const part of parts) {
      whole.set(part, at);
      at += part.length;
    }
    return whole;
  };

  // The recording that tracks are, made from the one that they were cut from.
  const recordingOf = (source, tracks) => {
    const place = new Map(tracks.map(({ column }, at) => [column, at]));
    const impulses = tracks.flatMap((track, at) => track.impulses.map((second) => [at, second]));
    return {
      markers: tracks.map(({ name }) => name),
      origin: joined(tracks.map((track) => track.origin), Uint8Array),
      places: joined(tracks.flatMap((track) => track.places), Float32Array),
      edges: source.edges.filter((ends) => ends.every((end) => place.has(end))).map((ends) => ends.map((end) => place.get(end))),
      strip: {
        ...source.strip, impulses: [impulses.map(([at]) => at), impulses.map(([, second]) => second)],
        kinds: source.strip.kinds.map((_, kind) => joined(tracks.map((track) => track.kinds[kind]), Uint8Array)),
      },
    };
  };

  const counting = (origin, [from, to] = [0, origin.length]) => origin.subarray(from, to).reduce((sum, code) => sum + (code !== MISSING), 0);

  const erase = (track, span) => {
    track.origin.fill(MISSING, ...span.frames);
    track.kinds.forEach((kind, at) => kind.fill(at ? 0 : 255, ...span.stretches)); // the first are the missing
    track.impulses = track.impulses.filter((second) => !span.has(second));
  };

  const swapParts = (one, other, [from, to]) => {
    const kept = one.slice(from, to);
    one.set(other.subarray(from, to), from);
    other.set(kept, from);
  };

  const swap = (one, other, span) => {
    swapParts(one.origin, other.origin, span.frames);
    one.places.forEach((part, k) => swapParts(part, other.places[k], span.frames));
    one.kinds.forEach((part, kind) => swapParts(part, other.kinds[kind], span.stretches));
    const [here, there] = [one, other].map((track) => track.impulses.filter(span.has));
    one.impulses = [...one.impulses.filter((second) => !span.has(second)), ...there];
    other.impulses = [...other.impulses.filter((second) => !span.has(second)), ...here];
  };

  const emptyLike = (track, name) => {
    const empty = {
      name, column: -1, origin: track.origin.slice(), places: track.places.map((part) => part.slice()),
      kinds: track.kinds.map((part) => part.slice()), impulses: [],
    };
    erase(empty, { frames: [], stretches: [], has: () => true });
    return empty;
  };

  const give = (track, other, span) => {
    const [from, to] = span.frames;
    for (let frame = from; frame < to; frame += 1) {
      if (track.origin[frame] === MISSING) continue;
      other.origin[frame] = track.origin[frame];
      track.places.forEach((part, k) => { other.places[k][frame] = part[frame]; });
    }
    const [first, last] = span.stretches;
    other.kinds.forEach((part, kind) => part.set(track.kinds[kind].subarray(first, last), first));
    other.impulses.push(...track.impulses.filter(span.has));
    erase(track, span);
  };

  // Applies one mark to tracks; returns the tracks, and of how many samples it speaks.
  const marked = (tracks, mark, source, every) => {
    const [marker, start, frames, kind, other] = mark;
    const refuse = (why) => { throw new Error(`${textOf(mark)}: ${why}`); };
    const track = tracks.find(({ name }) => name === marker) ?? refuse(`there is no marker ${marker}`);
    const second = tracks.find(({ name }) => name === other);
    const stop = start + frames;
    const all = source.frames * every;
    if (start >= all) refuse(`the take has ${all} frames`);
    const hertz = source.rate * every;
    const { stretches } = source.strip;
    const span = {
      frames: [Math.ceil(start / every), Math.ceil(stop / every)],
      stretches: [Math.floor((start / all) * stretches), Math.ceil((stop / all) * stretches)],
      has: (second) => second * hertz > start - 0.5 && second * hertz < stop - 0.5,
    };
    const count = counting(track.origin, span.frames);
    if (kind === "bad") {
      erase(track, span);
      return [tracks, count];
    }
    if (kind === "swapped") {
      if (!second) refuse(`there is no marker ${other}`);
      const both = count + counting(second.origin, span.frames);
      swap(track, second, span);
      return [tracks, both];
    }
    const is_all = count === counting(track.origin);
    if (is_all && !second) {
      track.name = other;
      return [tracks, count];
    }
    const target = second ?? emptyLike(track, other);
    const [from, to] = span.frames;
    let both = 0;
    for (let frame = from; frame < to; frame += 1) both += track.origin[frame] !== MISSING && target.origin[frame] !== MISSING;
    if (both) refuse(`${other} is there in ${both * every} of these frames; swap the two, or mark those as bad first`);
    give(track, target, span);
    const rest = is_all ? tracks.filter((each) => each !== track) : tracks;
    return [second ? rest : [...rest, target], count];
  };

  // What a recording becomes with marks, and how many samples each kind of mark speaks of. An error
  // says which mark does not fit.
  const applied = (source, marks, every) => {
    const samples = {};
    if (!marks.length) return { changes: {}, samples };
    let tracks = tracksOf(source);
    for (const mark of marks) {
      const [next, count] = marked(tracks, mark, source, every);
      tracks = next;
      samples[mark[3]] = (samples[mark[3]] ?? 0) + count * every;
    }
    return { changes: recordingOf(source, tracks), samples };
  };

  // The spans in which marks speak of a marker, in seconds.
  const spansOf = ({ marks, rate }, every, marker) => marks.filter(([name, , , , other]) => name === marker || other === marker)
    .map(([, start, frames]) => [start / rate / every, (start + frames) / rate / every]);

  // The marks of one recording: shows it as it is marked, and lets the reader mark it.
  class Marks {
    constructor(player, panel, is_one_of_several) {
      Object.assign(this, { player, panel, source: { ...panel }, samples: {}, first: null, whole: false, saved: true, saving: Promise.resolve() });
      const button = (text, act) => element("button", { type: "button", onclick: act }, text);
      this.span = element("span", { class: "quiet" });
      this.known = element("datalist", { id: `marks-others-${player.study.panels.indexOf(panel)}` });
      this.other = element("input", { list: this.known.id, "aria-label": "Other marker", placeholder: "other marker", size: 12 });
      this.undo = button("Undo", () => this.takeBack());
      this.save = button("Save marks", () => this.download());
      this.save.hidden = this.keeps; // until that fails
      this.state = element("span", { role: "status" });
      this.list = element("ol", {});
      this.made = element("p", {}, this.undo, this.save, this.state);
      this.fold = element("details", {}, element("summary", {}, "What is marked"), this.list,
        element("p", { class: "quiet" }, `In a graph, recording.apply_marks applies what read.marks reads from ${this.file}.`));
      this.hint = element("p", { class: "quiet" }, "Click a marker, or choose one above, to mark its samples as bad, swap them or name them otherwise.");
      this.acts = element("div", { class: "acts" },
        element("span", {}, button("From here", () => this.begin()), button("Whole take", () => this.begin(true)), this.span),
        element("span", {}, button("Bad", () => this.mark("bad")), this.other, this.known,
          button("Swap", () => this.mark("swapped")), button("Name", () => this.mark("named"))));
      this.name = `Marked by hand${is_one_of_several ? ` in ${this.label}` : ""}`;
      this.title = element("p", { class: "name" });
      this.element = element("div", { class: "marks", role: "group", "aria-label": this.name },
        this.title, this.hint, this.acts, this.made, this.fold);
      addEventListener("beforeunload", (event) => { if (!this.saved) event.preventDefault(); });
      this.trouble = this.show(panel.marks);
      this.explain();
    }

    get label() {
      return this.panel.label || "take";
    }

    get keeps() {
      return Boolean(server?.keeps?.(this.label));
    }

    get file() {
      return `${this.label.replace(/^.*[/\\:]/, "")}.marks.csv`;
    }

    // The frame of the file, of which only some may be shown.
    get frame() {
      return this.player.frameOf(this.panel) * this.player.study.every;
    }

    begin(whole = false) {
      this.whole = whole;
      this.first = whole ? null : { marker: this.player.marker, frame: this.frame };
      this.tell();
    }

    // First frame and number of frames: the frame that is shown, or all from where it was begun.
    get chosen() {
      const { every } = this.player.study;
      if (this.whole) return [0, this.source.frames * every];
      const other = this.first?.marker === this.player.marker ? this.first.frame : this.frame;
      return [Math.min(other, this.frame), Math.abs(other - this.frame) + every];
    }

    mark(kind) {
      const other = kind === "bad" ? "" : this.other.value.trim();
      const { marker } = this.player;
      if (kind !== "bad" && (!other || other === marker)) {
        this.refuse(`Write the name of ${kind === "swapped" ? "the marker to swap with" : "the marker that it is"}`);
        this.other.focus();
        return;
      }
      this.add([marker, ...this.chosen, kind, other]);
    }

    add(mark) {
      const { panel: { marks }, sum } = this;
      const why = this.show([...marks, mark]) || (this.sum === sum ? `${textOf(mark)}: there is no sample to mark` : "");
      if (why) {
        this.show(marks);
        this.refuse(why);
      } else {
        Object.assign(this, { first: null, whole: false });
        this.changed("");
      }
    }

    // The span stays chosen, for another try.
    refuse(why) {
      this.trouble = why;
      this.explain();
    }

    // What was read from the file may not fit the take; it can be taken back, too.
    takeBack() {
      this.changed(this.show(this.panel.marks.slice(0, -1)));
    }

    changed(trouble) {
      Object.assign(this, { saved: false, trouble });
      this.player.remake();
      this.explain();
      this.keep();
    }

    // Shows the take as it is marked; returns why that is not possible.
    show(marks) {
      Object.assign(this.panel, this.source, { marks });
      this.samples = {};
      try {
        const { changes, samples } = applied(this.source, marks, this.player.study.every);
        Object.assign(this.panel, changes);
        this.samples = samples;
        return "";
      } catch (error) {
        return error.message;
      }
    }

    // One after the other, so that the last stays; what cannot be kept can be saved elsewhere.
    keep() {
      const { text } = this;
      if (!this.keeps) return;
      this.saving = this.saving.then(async () => {
        try {
          await server.keep(this.label, text);
          this.saved = text === this.text;
        } catch (error) {
          this.trouble = error.message;
          this.save.hidden = false;
        }
        this.explain();
      });
    }

    get sum() {
      return Object.values(this.samples).reduce((sum, count) => sum + count, 0);
    }

    tell() {
      const { marker } = this.player;
      const has_marker = this.panel.markers.includes(marker);
      const [start, frames] = this.chosen;
      this.span.textContent = `${marker}, ${this.whole ? "whole take" : placeOf([marker, start, frames])}`;
      this.acts.hidden = !has_marker;
      this.hint.hidden = has_marker;
      // of several that wait for a marker, the first says so for all; where another has it, none does
      const is_waiting = !has_marker && this.made.hidden;
      const speaker = this.player.marks.find(({ panel }) => panel.markers.includes(marker)) ?? this.player.marks[0];
      this.element.hidden = is_waiting && this !== speaker;
      this.title.textContent = is_waiting ? "Marked by hand" : this.name;
    }

    explain() {
      const { marks, markers } = this.panel;
      const about = this.player.study.every > 1 ? "about " : "";
      const kinds = Object.entries(this.samples).map(([kind, count]) => `${count} ${kind}`).join(", ");
      const count = marks.length ? `${about}${counted(this.sum, "sample")} in ${counted(marks.length, "span")}: ${kinds}` : "no sample is marked";
      const where = this.keeps && this.saved && marks.length ? `; kept in ${this.file}` : "";
      this.state.textContent = `${count}${where}${this.trouble ? `. ${this.trouble}` : ""}`;
      this.made.hidden = !marks.length && !this.trouble && this.saved;
      this.undo.disabled = !marks.length;
      this.save.disabled = !marks.length;
      this.fold.hidden = !marks.length;
      this.known.replaceChildren(...markers.map((name) => element("option", { value: name })));
      this.list.replaceChildren(...marks.map((mark) => element("li", {},
        element("button", { type: "button", onclick: () => this.visit(mark) }, textOf(mark)))));
    }

    // Takes the marker of a mark in hand, by the name that it has now, where the mark begins.
    visit([marker, start, , , other]) {
      selection.set({ marker: this.panel.markers.includes(marker) ? marker : other });
      this.player.step(Math.round((start / this.player.study.every / this.panel.rate) * this.player.study.rate) - this.player.tick);
    }

    get text() {
      return ["marker,start,frames,mark,other", ...this.panel.marks.map((mark) => mark.map(cellOf).join(",")), ""].join("\n");
    }

    download() {
      const address = URL.createObjectURL(new Blob([this.text], { type: "text/csv" }));
      element("a", { href: address, download: this.file }).click();
      setTimeout(() => URL.revokeObjectURL(address), 1000);
      this.saved = true;
      this.explain();
      announce(`Saved as ${this.file}`);
    }
  }

  return { Marks, applied, spansOf };
});
