// Spans of a marker that a person marks as bad, undone one by one, and saved as a table of their own:
// what is marked is left out by the node recording.drop_marked, and the take stays as it is.
nodegraph.define("mocap/player/marks", ["page"], ({ element, announce }) => {
  const counted = (count, what) => `${count} ${what}${count === 1 ? "" : "s"}`;

  const cellOf = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

  class Marks {
    constructor(player, panel) {
      Object.assign(this, { player, panel, spans: [], first: null, saved: true });
      const button = (text, act) => element("button", { type: "button", onclick: act }, text);
      this.state = element("span", { class: "quiet", role: "status" });
      this.undo = button("Undo", () => this.change(() => this.spans.pop()));
      this.save = button("Save marks", () => this.download());
      this.element = element("div", { class: "marks", role: "group", "aria-label": "Samples marked by hand" },
        button("Bad from here", () => this.begin()), button("Bad to here", () => this.end()), this.undo, this.save, this.state);
      addEventListener("beforeunload", (event) => { if (!this.saved) event.preventDefault(); });
      this.tell();
    }

    // The frame of the file, of which only some may be shown.
    get frame() {
      return this.player.frameOf(this.panel) * this.player.study.every;
    }

    begin() {
      this.first = { marker: this.player.marker, frame: this.frame };
      this.tell();
    }

    // Without a beginning, or with that of another marker, the frame that is shown.
    end() {
      const { marker } = this.player;
      const other = this.first?.marker === marker ? this.first.frame : this.frame;
      const start = Math.min(other, this.frame);
      this.change(() => this.spans.push({ marker, start, frames: Math.abs(other - this.frame) + this.player.study.every }));
    }

    change(act) {
      act();
      this.first = null;
      this.saved = !this.spans.length;
      this.tell();
      this.player.hand.draw();
    }

    get samples() {
      return new Set(this.spans.flatMap(({ marker, start, frames }) => Array.from({ length: frames }, (_, at) => `${start + at} ${marker}`))).size;
    }

    tell() {
      this.undo.disabled = this.save.disabled = !this.spans.length;
      const begun = this.first ? `from frame ${this.first.frame} of ${this.first.marker} on` : "";
      const marked = this.spans.length ? `${counted(this.samples, "sample")} marked in ${counted(this.spans.length, "span")}${this.saved ? ", saved" : ""}` : "";
      this.state.textContent = [marked, begun].filter(Boolean).join("; ") || "no sample is marked";
    }

    get text() {
      return ["marker,start,frames", ...this.spans.map(({ marker, start, frames }) => `${cellOf(marker)},${start},${frames}`), ""].join("\n");
    }

    download() {
      const address = URL.createObjectURL(new Blob([this.text], { type: "text/csv" }));
      const name = `${(this.panel.label || "take").replace(/^.*[/\\:]/, "")}.marks.csv`;
      element("a", { href: address, download: name }).click();
      setTimeout(() => URL.revokeObjectURL(address), 1000);
      this.saved = true;
      this.tell();
      announce(`Saved as ${name}`);
    }

    // The spans of the marker in hand, in seconds.
    spansOf(marker) {
      const rate = this.panel.rate * this.player.study.every;
      return this.spans.filter((span) => span.marker === marker).map(({ start, frames }) => [start / rate, (start + frames) / rate]);
    }
  }

  return { Marks };
});
