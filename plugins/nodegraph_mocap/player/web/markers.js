// Markers as dots: where each sample came from or how wrong it is, edges, trails, the truth.
nodegraph.define("mocap/player/markers", ["mocap/player/camera"], ({ within, project }) => {
  const MISSING = 0;
  const NEAR = 10; // px from a marker that point at it
  const CLOSE = 0.005; // mm, below which places are the same
  const FILLED = 2;
  const REPAIRED = 3;
  const ORIGINS = ["missing", "measured", "filled", "repaired"];

  // Colours that can be told apart on white and on black, by the colour-blind too; the origins'
  // are those of the report's still figures, a little lighter.
  const COLOURS = ["", "#2a86c8", "#e0453c", "#d98a00"];
  const RAMP = [[42, 134, 200], [129, 112, 190], [196, 88, 148], [222, 84, 84], [232, 134, 20]];

  const INKS = {
    light: { text: "#17202c", line: "#9aa4b0", trail: "rgba(42, 134, 200, 0.6)" },
    dark: { text: "#e7ebf0", line: "#68747f", trail: "rgba(86, 164, 226, 0.65)" },
  };
  const inksOf = (dark) => INKS[dark ? "dark" : "light"];

  // Of recordings that are laid over each other.
  const TINTS = ["#2a86c8", "#d9691e", "#1f9d6b", "#a3539a", "#b08900", "#7a828c"];
  const tintOf = (turn) => TINTS[turn % TINTS.length];

  const errorColour = (error, largest) => {
    const place = within(0, error / largest, 1) * (RAMP.length - 1);
    const low = Math.min(Math.floor(place), RAMP.length - 2);
    const parts = RAMP[low].map((colour, part) => Math.round(colour + (place - low) * (RAMP[low + 1][part] - colour)));
    return `rgb(${parts.join(", ")})`;
  };

  const isPresent = (panel, marker, frame) => panel.origin[marker * panel.frames + frame] !== MISSING;

  const placeOf = ({ places, frames }, marker, frame) => {
    const at = 3 * marker * frames + frame;
    return [places[at], places[at + frames], places[at + 2 * frames]];
  };

  // Errors may be drawn larger than they are: `magnified` is { truth, times } or null. Of a panel
  // with samples that a method has made, these alone move.
  const projectMarker = (panel, by, marker, frame, dots, place, magnified) => {
    const point = placeOf(panel, marker, frame);
    const column = magnified && panel.truth ? panel.truth[marker] : -1;
    const judged = !panel.made || panel.origin[marker * panel.frames + frame] >= FILLED;
    if (column >= 0 && judged && isPresent(magnified.truth, column, frame)) {
      const there = placeOf(magnified.truth, column, frame);
      for (let k = 0; k < 3; k += 1) point[k] = there[k] + magnified.times * (point[k] - there[k]);
    }
    project(by, ...point, dots, place);
  };

  // Where the markers of a frame lie in a picture; NaN for those that are missing.
  const markerDots = (panel, by, frame, magnified) => {
    const dots = new Float64Array(3 * panel.markers.length).fill(NaN);
    panel.markers.forEach((_, marker) => {
      if (isPresent(panel, marker, frame)) projectMarker(panel, by, marker, frame, dots, 3 * marker, magnified);
    });
    return dots;
  };

  // How far each sample of a frame is from the truth, in millimetres; NaN where that is not known.
  const errorsOf = (panel, truth, frame) => panel.markers.map((_, marker) => {
    const column = panel.truth ? panel.truth[marker] : -1;
    if (column < 0 || !isPresent(panel, marker, frame) || !isPresent(truth, column, frame)) return NaN;
    const there = placeOf(truth, column, frame);
    return Math.hypot(...placeOf(panel, marker, frame).map((value, k) => value - there[k]));
  });

  // Where samples that were made, or are missing, should be: (marker, dots of the truth).
  const truthDots = (panel, truth, by, frame) => {
    const found = [];
    panel.markers.forEach((_, marker) => {
      const column = panel.truth[marker];
      const origin = panel.origin[marker * panel.frames + frame];
      if (column < 0 || (origin !== MISSING && origin < FILLED) || !isPresent(truth, column, frame)) return;
      const dots = [0, 0, 0];
      projectMarker(truth, by, column, frame, dots, 0, null);
      found.push({ marker, dots });
    });
    return found;
  };

  const drawEdges = (pen, panel, dots, ink) => {
    pen.beginPath();
    for (const [a, b] of panel.edges) {
      // a line with an end that is NaN is not drawn, but it would end the path in some browsers
      if (Number.isNaN(dots[3 * a] + dots[3 * b])) continue;
      pen.moveTo(dots[3 * a], dots[3 * a + 1]);
      pen.lineTo(dots[3 * b], dots[3 * b + 1]);
    }
    pen.lineWidth = 1.5;
    pen.strokeStyle = ink.line;
    pen.stroke();
  };

  // The way of every marker in the last frames; it is broken where samples are missing.
  const drawTrails = (pen, panel, by, frame, length, ink, magnified) => {
    const dots = [0, 0, 0];
    pen.beginPath();
    for (let marker = 0; marker < panel.markers.length; marker += 1) {
      let joined = false;
      for (let past = Math.max(0, frame - length); past <= frame; past += 1) {
        const there = isPresent(panel, marker, past);
        if (there) {
          projectMarker(panel, by, marker, past, dots, 0, magnified);
          if (joined) pen.lineTo(dots[0], dots[1]);
          else pen.moveTo(dots[0], dots[1]);
        }
        joined = there;
      }
    }
    pen.lineWidth = 1.5;
    pen.strokeStyle = ink.trail;
    pen.stroke();
  };

  const drawTruth = (pen, panel, truth, dots, by, frame, size, ink) => {
    pen.beginPath();
    for (const dot of truthDots(panel, truth, by, frame)) {
      const [x, y] = dot.dots;
      pen.moveTo(x + 1.7 * size, y);
      pen.arc(x, y, 1.7 * size, 0, 2 * Math.PI);
      if (Number.isNaN(dots[3 * dot.marker])) continue;
      pen.moveTo(x, y);
      pen.lineTo(dots[3 * dot.marker], dots[3 * dot.marker + 1]);
    }
    pen.lineWidth = 2;
    pen.strokeStyle = ink.text;
    pen.stroke();
  };

  // What is nearer is drawn later, over what is farther away; what was repaired is a diamond.
  const drawDots = (pen, panel, dots, frame, size, colourOf) => {
    const order = panel.markers.map((_, marker) => marker).filter((marker) => !Number.isNaN(dots[3 * marker]));
    order.sort((a, b) => dots[3 * a + 2] - dots[3 * b + 2]);
    for (const marker of order) {
      const [x, y] = [dots[3 * marker], dots[3 * marker + 1]];
      pen.fillStyle = colourOf(marker);
      pen.beginPath();
      if (panel.origin[marker * panel.frames + frame] === REPAIRED) {
        const half = 1.35 * size;
        pen.moveTo(x - half, y);
        pen.lineTo(x, y - half);
        pen.lineTo(x + half, y);
        pen.lineTo(x, y + half);
      } else {
        pen.arc(x, y, size, 0, 2 * Math.PI);
      }
      pen.fill();
    }
  };

  // Where a marker was seen last; NaN before its first sample.
  const lastDot = (panel, by, marker, frame) => {
    const dot = new Float64Array(3).fill(NaN);
    let last = frame;
    while (last >= 0 && !isPresent(panel, marker, last)) last -= 1;
    if (last >= 0) projectMarker(panel, by, marker, last, dot, 0, null);
    return dot;
  };

  // A ring around the marker that the reader looks at, and its name; dashed where it was seen last.
  const drawMarked = (pen, panel, by, frame, dots, looked, size, ink, width) => {
    const marker = panel.markers.indexOf(looked);
    if (marker < 0) return;
    const is_missing = !isPresent(panel, marker, frame);
    const [x, y] = is_missing ? lastDot(panel, by, marker, frame) : dots.subarray(3 * marker);
    if (Number.isNaN(x)) return;
    const name = is_missing ? `${looked}, missing` : looked;
    pen.beginPath();
    pen.setLineDash(is_missing ? [0.9 * size, 0.9 * size] : []);
    pen.arc(x, y, 2.8 * size, 0, 2 * Math.PI);
    pen.lineWidth = 2.5;
    pen.strokeStyle = pen.fillStyle = ink.text;
    pen.stroke();
    pen.setLineDash([]);
    pen.font = `${3.4 * size}px system-ui, sans-serif`;
    const length = pen.measureText(name).width;
    pen.fillText(name, within(4, x - length / 2, Math.max(4, width - length - 4)), y > 8 * size ? y - 4 * size : y + 6.5 * size);
  };

  const drawNames = (pen, panel, dots, looked, size, ink) => {
    pen.font = `${2.4 * size}px system-ui, sans-serif`;
    pen.fillStyle = ink.text;
    panel.markers.forEach((name, marker) => {
      if (name !== looked && !Number.isNaN(dots[3 * marker])) pen.fillText(name, dots[3 * marker] + 1.5 * size, dots[3 * marker + 1] + 0.8 * size);
    });
  };

  // Draws a frame of a recording; returns where its markers lie.
  const drawMarkers = (pen, panel, by, frame, { study, choices, ink, dot, size, marker: looked, tint }) => {
    const { truth } = study;
    const magnified = truth && choices.times > 1 ? { truth, times: choices.times } : null;
    const dots = markerDots(panel, by, frame, magnified);
    const compared = truth && panel.truth;
    const errors = compared && choices.colour === "error" ? errorsOf(panel, truth, frame) : [];
    const colourOf = (marker) => {
      if (tint) return tint;
      if (choices.colour !== "error") return COLOURS[panel.origin[marker * panel.frames + frame]];
      const error = errors[marker];
      return Number.isFinite(error) ? errorColour(error, study.errors) : ink.line;
    };
    drawEdges(pen, panel, dots, ink);
    if (choices.trails) drawTrails(pen, panel, by, frame, Math.round(choices.trail * panel.rate), ink, magnified);
    if (compared && choices.truth) drawTruth(pen, panel, truth, dots, by, frame, dot, ink);
    drawDots(pen, panel, dots, frame, dot, colourOf);
    if (choices.names) drawNames(pen, panel, dots, looked, dot, ink);
    if (looked !== null) drawMarked(pen, panel, by, frame, dots, looked, dot, ink, size);
    return dots;
  };

  // A frame in words: how many samples came from where, and how wrong those are that were made.
  const textOfMarkers = (panel, truth, frame) => {
    const counts = [0, 0, 0, 0];
    panel.markers.forEach((_, marker) => { counts[panel.origin[marker * panel.frames + frame]] += 1; });
    const shown = [1, FILLED, REPAIRED, MISSING].filter((origin) => counts[origin]);
    const counted = shown.map((origin) => `${counts[origin]} ${ORIGINS[origin]}`).join(", ");
    const made = (_, marker) => panel.origin[marker * panel.frames + frame] >= FILLED;
    const errors = truth && panel.truth ? errorsOf(panel, truth, frame).filter(made).filter(Number.isFinite) : [];
    if (!errors.length) return counted;
    const mean = errors.reduce((sum, error) => sum + error, 0) / errors.length;
    return `${counted}; ${errors.length} compared: mean error ${mean.toFixed(2)} mm, largest ${Math.max(...errors).toFixed(2)} mm`;
  };

  // How far the markers that two recordings share are apart in a frame of each.
  const textOfDistance = (first, other) => {
    const column = new Map(first.panel.markers.map((name, marker) => [name, marker]));
    const distances = other.panel.markers.map((name, marker) => {
      const there = column.get(name);
      if (there === undefined || !isPresent(first.panel, there, first.frame) || !isPresent(other.panel, marker, other.frame)) return NaN;
      const point = placeOf(first.panel, there, first.frame);
      return Math.hypot(...placeOf(other.panel, marker, other.frame).map((value, k) => value - point[k]));
    });
    const known = distances.filter(Number.isFinite);
    if (!known.length) return `${other.panel.label}: no marker of the same name is here`;
    const largest = Math.max(...known);
    if (largest < CLOSE) return `${other.panel.label}: ${known.length} markers compared, all at the same places`;
    const mean = known.reduce((sum, each) => sum + each, 0) / known.length;
    const where = other.panel.markers[distances.indexOf(largest)];
    return `${other.panel.label}: ${known.length} markers compared, ${mean.toFixed(2)} mm apart on average, ${where} most, ${largest.toFixed(2)} mm`;
  };

  // One sample in words.
  const textOfSample = (panel, truth, marker, frame) => {
    const words = `${panel.markers[marker]}: ${ORIGINS[panel.origin[marker * panel.frames + frame]]}`;
    const error = truth && panel.truth ? errorsOf(panel, truth, frame)[marker] : NaN;
    return Number.isFinite(error) ? `${words}, ${error.toFixed(2)} mm off the truth` : words;
  };

  // The marker under the pointer, -1 where there is none.
  const pointedMarker = ({ panel, canvas }, event, dots) => {
    const fine = canvas.width / canvas.clientWidth;
    let [nearest, least] = [-1, NEAR * fine];
    if (event && dots && panel.kind === "markers") {
      for (let marker = 0; marker < panel.markers.length; marker += 1) {
        const away = Math.hypot(dots[3 * marker] - event.offsetX * fine, dots[3 * marker + 1] - event.offsetY * fine);
        if (away < least) [nearest, least] = [marker, away];
      }
    }
    return nearest;
  };

  // Writes what there is to say of the marker under the pointer into a panel's tip, or hides that.
  const namePointed = ({ panel, canvas, tip }, event, dots, textOf) => {
    const nearest = pointedMarker({ panel, canvas }, event, dots);
    tip.toggleAttribute("hidden", nearest < 0);
    if (nearest < 0) return;
    tip.textContent = textOf(nearest);
    tip.style.left = `${(100 * dots[3 * nearest]) / canvas.width}%`;
    tip.style.top = `${(100 * dots[3 * nearest + 1]) / canvas.height}%`;
  };

  return { FILLED, REPAIRED, ORIGINS, RAMP, drawMarkers, textOfMarkers, textOfSample, textOfDistance, tintOf, pointedMarker, namePointed, inksOf };
});
