"use strict";
// Every block a dot, a row per method, on a canvas. Dots are stamped into pixels row by row, which
// takes a million of them in a fraction of a second; what is pointed at is drawn over that picture.
nodegraph.define("compare/dots_chart", ["page", "selection", "compare/chart", "compare/scale", "compare/overview"], (page, selection, chart, scales, { NONE, medianOf, valuesOfCodes }) => {
  const { element } = page;
  const { strong } = chart;
  const TOP = 26;
  const REACH = 9;
  const CELL = 4;
  const ROW_LABEL = 13;
  const MANY = 50;
  const FAR = 0.5; // of what the other values take
  const FAR_SHARE = 0.002; // of all values

  // A fixed share of the row's height for each block, without pattern: 0 to 1.
  const jitter = (block) => {
    let hash = Math.imul(block + 1, 0x9e3779b1);
    hash = Math.imul(hash ^ (hash >>> 15), 0x85ebca6b);
    return ((hash ^ (hash >>> 13)) >>> 0) / 2 ** 32;
  };

  // Coverage of a disc, or of the rim of a diamond: across, down and share of each pixel.
  const stamp = (radius, rim) => {
    const half = Math.ceil(radius + 0.5);
    const cells = [];
    for (let y = -half; y <= half; y += 1) {
      for (let x = -half; x <= half; x += 1) {
        const far = rim ? Math.abs(x) + Math.abs(y) : Math.hypot(x, y);
        const cover = rim ? scales.between(rim / 2 + 0.5 - Math.abs(far - radius), 0, 1) : scales.between(radius + 0.5 - far, 0, 1);
        if (cover > 0.02) cells.push(x, y, cover);
      }
    }
    return Float32Array.from(cells);
  };

  const colour = (host, name) => {
    const probe = element("i", { style: `color: var(--${name})` });
    host.append(probe);
    const channels = getComputedStyle(probe).color.match(/[\d.]+/g).slice(0, 3).map(Number);
    probe.remove();
    return channels;
  };

  const ROLES = { selected: "selected", best: "best", reference: "ink", rest: "quiet" };

  // The picture of all dots at one width, of one group under one filter.
  class Dots {
    constructor(view, plot, width) {
      this.view = view;
      this.plot = plot;
      this.width = width;
      this.ratio = Math.min(2, devicePixelRatio || 1);
      this.numbers = view.numbers();
      this.blocks = this.numbers.blocks;
      this.rows = view.ranked();
      this.rowOf = new Map(this.rows.map((method, row) => [method, row]));
      this.rowHeight = scales.between(Math.floor(760 / this.rows.length), 5, 24);
      this.height = TOP + this.rows.length * this.rowHeight + 6;
      const names = chart.widest(this.rows.map((method) => view.overview.methods[method]));
      this.left = scales.between(names + 14, 60, width < 500 ? 118 : 180);
      this.right = width - (width < 500 ? 46 : 60);
      this.values = view.group.values(view.metric.name);
      this.codes = view.group.codes(view.metric.name);
      this.count = view.overview.methods.length;
      this.x = scales.fitting(this.range(), this.left + 6, this.right - 8, { room: 0.03 });
      this.cells = new Map();
      this.order = null;
      this.suspects = this.blocks.filter((block) => view.group.isSuspect(block));
      this.others = this.suspects.length ? this.blocks.filter((block) => !view.group.isSuspect(block)) : this.blocks;
      this.inks = Object.fromEntries(["ink", "quiet", "line", "paper", "best", "selected", "suspect"].map((name) => [name, colour(plot, name)]));
      this.font = `12px ${getComputedStyle(plot).fontFamily}`;
      this.rowRoles = new Map();
      this.canvas = document.createElement("canvas");
      this.canvas.width = Math.round(width * this.ratio);
      this.canvas.height = Math.round(this.height * this.ratio);
    }

    // The values of the axis. A few that are far from all others stand at its edges, and are counted.
    range() {
      const { blocks, rows, values, count } = this;
      const sorted = Float64Array.from(blocks.flatMap((block) => rows.map((method) => values[block * count + method])))
        .filter(Number.isFinite).sort();
      const [least, most] = [sorted[0], sorted.at(-1)];
      const typical = medianOf(blocks.map((block) => values[block * count + rows[0]]));
      const low = least > 0 ? Math.max(least, typical / 300) : least;
      const of = least > 0 ? Math.log : (value) => value;
      const usual = sorted[Math.floor((1 - FAR_SHARE) * (sorted.length - 1))];
      const isFar = sorted.length >= MANY && of(most) - of(usual) > FAR * (of(usual) - of(low));
      const high = isFar ? usual : most;
      this.sorted = sorted;
      const above = sorted.find((value) => value > 0) ?? high;
      return least > 0 ? [Math.max(low, high / 1e5), high] : [low, Math.max(above, high / 1e5), high];
    }

    across(value) {
      const x = this.x.place(this.x.log && value < this.x.low ? this.x.low : value);
      return scales.between(x, this.left + 3, this.right - 3);
    }

    // What the axis leaves out, in words.
    get leftOut() {
      const { low, high } = this.x;
      const count = (isThere) => this.sorted.filter(isThere).length;
      const sides = [[count((value) => value < low), "below", low, "left"], [count((value) => value > high), "above", high, "right"]];
      return sides.filter(([many]) => many).map(([many, side, end, edge]) =>
        `${many} ${many === 1 ? "dot" : "dots"} ${side} ${this.view.error(end)} ${many === 1 ? "stands" : "stand"} at the ${edge} edge. `).join("");
    }

    down(row, block) {
      return TOP + (row + 0.5 + (jitter(block) - 0.5) * 0.68) * this.rowHeight;
    }

    at(method, block) {
      return [this.across(this.values[block * this.count + method]), this.down(this.rowOf.get(method), block)];
    }

    role(method) {
      const roles = this.view.roles(method).split(" ");
      return ["selected", "best", "reference"].find((role) => roles.includes(role)) ?? "rest";
    }

    // Paints the rows whose colour is not that of their role yet.
    paint() {
      const crowd = this.blocks.length;
      const radius = (crowd > 20000 ? 0.7 : crowd > 3000 ? 1.1 : 1.75) * scales.between(this.rowHeight / 14, 0.5, 1) * this.ratio;
      const opacity = scales.between(40 / Math.sqrt(crowd), 0.12, 0.62);
      const shapes = [
        [this.others, stamp(radius, 0), opacity],
        [this.suspects, stamp(Math.min(crowd > 3000 ? 2.4 : 3.2, this.rowHeight * 0.3) * this.ratio, 1.1 * this.ratio),
          scales.between(12 / Math.sqrt(this.suspects.length), 0.15, 0.62), this.inks.suspect],
      ];
      this.rows.forEach((method, row) => {
        const role = this.role(method);
        if (this.rowRoles.get(method) === role) return;
        this.rowRoles.set(method, role);
        this.paintRow(method, row, shapes, this.inks[ROLES[role]]);
      });
    }

    // Where each code of the metric, and each block within its row, is in pixels.
    get pixels() {
      this.places ??= {
        x: Int16Array.from(valuesOfCodes(this.view.group.json.scale[this.view.metric.name]), (value) => this.across(value) * this.ratio),
        y: Float32Array.from({ length: this.view.group.size }, (_, block) => (this.down(0, block) - TOP) * this.ratio),
      };
      return this.places;
    }

    paintRow(method, row, shapes, ink) {
      const context = this.canvas.getContext("2d");
      const top = Math.round((TOP + row * this.rowHeight) * this.ratio);
      const tall = Math.round((TOP + (row + 1) * this.rowHeight) * this.ratio) - top;
      const size = this.canvas.width;
      const image = context.createImageData(size, tall);
      const { data } = image;
      const { x, y } = this.pixels;
      for (const [blocks, shape, opacity, [red, green, blue] = ink] of shapes) {
        if (!blocks.length) continue;
        const cover = new Float32Array(size * tall);
        for (const block of blocks) {
          const code = this.codes[block * this.count + method];
          if (code === NONE) continue;
          const across = x[code];
          const down = Math.round(y[block]);
          for (let cell = 0; cell < shape.length; cell += 3) {
            const line = down + shape[cell + 1];
            if (line < 0 || line >= tall) continue;
            const place = line * size + across + shape[cell];
            cover[place] += (1 - cover[place]) * shape[cell + 2] * opacity;
          }
        }
        for (let place = 0; place < cover.length; place += 1) {
          const over = cover[place];
          if (!over) continue;
          const under = (data[4 * place + 3] / 255) * (1 - over);
          const sum = over + under;
          data[4 * place] = (red * over + data[4 * place] * under) / sum;
          data[4 * place + 1] = (green * over + data[4 * place + 1] * under) / sum;
          data[4 * place + 2] = (blue * over + data[4 * place + 2] * under) / sum;
          data[4 * place + 3] = sum * 255;
        }
      }
      context.putImageData(image, 0, top);
    }

    // Blocks of a row by columns of a few pixels, made when the row is first pointed at.
    cellsOf(method) {
      if (!this.cells.has(method)) {
        const cells = new Map();
        for (const block of this.blocks) {
          const [x] = this.at(method, block);
          const cell = Math.floor(x / CELL);
          if (!cells.has(cell)) cells.set(cell, []);
          cells.get(cell).push(block);
        }
        this.cells.set(method, cells);
      }
      return this.cells.get(method);
    }

    // The dot at most a few pixels from a place.
    nearest(x, y) {
      const method = this.rows[Math.floor((y - TOP) / this.rowHeight)];
      if (method === undefined) return null;
      const cells = this.cellsOf(method);
      let [near, least] = [null, REACH];
      for (let cell = Math.floor((x - REACH) / CELL); cell <= (x + REACH) / CELL; cell += 1) {
        for (const block of cells.get(cell) ?? []) {
          const place = this.at(method, block);
          const far = Math.hypot(place[0] - x, place[1] - y);
          if (far < least) [near, least] = [{ block, method }, far];
        }
      }
      return near;
    }

    // Blocks by the error of a method, the smallest first.
    walk(method) {
      if (this.order?.method !== method) {
        const blocks = this.blocks.filter((block) => Number.isFinite(this.values[block * this.count + method]));
        blocks.sort((a, b) => this.values[a * this.count + method] - this.values[b * this.count + method]);
        this.order = { method, blocks };
      }
      return this.order.blocks;
    }
  }

  const draw = (host, view, open) => {
    let dots = null;
    let cursor = null; // the dot that keys or the pointer are at
    let key = "";
    const scene = element("canvas", {
      tabindex: 0, role: "application", "aria-roledescription": "chart of dots",
    });

    const label = ({ block, method }) => {
      const parts = [view.group.nameOf(block), `${view.overview.methods[method]} ${view.error(view.group.error(view.metric.name, block, method))}`];
      if (view.group.isSuspect(block)) parts.push("suspect");
      return parts;
    };

    const compose = (hover = null) => {
      if (!dots) return;
      const { ratio, width, height, rowHeight, rows, x, canvas } = dots;
      scene.width = canvas.width;
      scene.height = canvas.height;
      scene.classList.toggle("dark", dots.inks.ink[0] > dots.inks.paper[0]);
      const context = scene.getContext("2d");
      const ink = (name) => `rgb(${dots.inks[name].join(" ")})`;
      context.scale(ratio, ratio);
      context.font = dots.font;
      context.fillStyle = ink("quiet");
      context.strokeStyle = ink("line");
      context.textAlign = "center";
      for (const { value, text } of x.ticks(width < 500 ? 40 : 64)) {
        const px = Math.round(x.place(value)) + 0.5;
        context.beginPath();
        context.moveTo(px, TOP - 6);
        context.lineTo(px, height);
        context.stroke();
        context.fillText(text, px, 13);
      }
      rows.forEach((method, row) => {
        const top = TOP + row * rowHeight;
        context.globalAlpha = hover === null || hover === method ? 1 : 0.25;
        context.drawImage(canvas, 0, top * ratio, canvas.width, rowHeight * ratio, 0, top, width, rowHeight);
        const mean = dots.numbers.values[method];
        if (view.statistic !== "rank" && Number.isFinite(mean)) {
          const px = dots.across(mean);
          context.fillStyle = ink("paper");
          context.fillRect(px - 2.5, top + 1, 5, rowHeight - 2);
          context.fillStyle = ink("ink");
          context.fillRect(px - 1, top + 1, 2, rowHeight - 2);
        }
      });
      context.globalAlpha = 1;
      if (cursor && rows.includes(cursor.method)) {
        const { block } = cursor;
        const points = rows.filter((method) => Number.isFinite(dots.values[block * dots.count + method])).map((method) => [dots.at(method, block), method]);
        context.strokeStyle = ink("ink");
        context.lineWidth = 1;
        context.globalAlpha = 0.5;
        context.beginPath();
        points.forEach(([[px, py]], at) => (at ? context.lineTo(px, py) : context.moveTo(px, py)));
        context.stroke();
        context.globalAlpha = 1;
        for (const [[px, py], method] of points) {
          const here = method === cursor.method;
          context.beginPath();
          context.arc(px, py, here ? 5 : Math.min(3.2, rowHeight / 3), 0, 2 * Math.PI);
          context.fillStyle = ink(view.group.isSuspect(block) ? "suspect" : here ? "selected" : "ink");
          context.fill();
          context.lineWidth = 1.5;
          context.strokeStyle = ink("paper");
          context.stroke();
        }
      }
    };

    const move = (next, speak) => {
      if (cursor?.block === next?.block && cursor?.method === next?.method) return;
      cursor = next;
      compose();
      selection.hover("block", next?.block ?? null);
      if (!next || !speak) return;
      const order = dots.walk(next.method);
      page.announce(`${order.indexOf(next.block) + 1} of ${order.length}: ${label(next).join(", ")}`);
      const [px, py] = dots.at(next.method, next.block);
      const box = scene.getBoundingClientRect();
      chart.showNote({ clientX: box.left + px, clientY: box.top + py }, ...label(next), "Enter opens it");
    };

    const choose = ({ block, method }) => view.open(block, method);

    const place = (event) => {
      const box = scene.getBoundingClientRect();
      return dots?.nearest((event.clientX - box.left) * (dots.width / box.width), (event.clientY - box.top) * (dots.height / box.height)) ?? null;
    };
    scene.addEventListener("pointermove", (event) => {
      const next = place(event);
      move(next, false);
      scene.style.cursor = next ? "pointer" : "";
      if (next) chart.showNote(event, ...label(next), view.group.reasons[next.block] ?? "", "Click opens it");
      else chart.hideNote();
    });
    scene.addEventListener("pointerleave", () => {
      move(null, false);
      chart.hideNote();
    });
    scene.addEventListener("click", (event) => {
      const dot = place(event);
      if (dot) choose(dot);
    });
    scene.addEventListener("blur", () => {
      move(null, false);
      chart.hideNote();
    });
    scene.addEventListener("keydown", (event) => {
      if (!dots?.blocks.length) return;
      if (event.key === "Enter" || event.key === " ") {
        event.preventDefault();
        if (cursor) choose(cursor);
        return;
      }
      const method = cursor?.method ?? (dots.rowOf.has(view.method) ? view.method : dots.rows[0]);
      const order = dots.walk(method);
      const at = cursor ? order.indexOf(cursor.block) : -1;
      const row = dots.rows.indexOf(method);
      const step = { ArrowRight: 1, ArrowLeft: -1, PageUp: 10, PageDown: -10 }[event.key];
      let next = null;
      if (step !== undefined) next = { method, block: order[at < 0 ? order.length - 1 : scales.between(at + step, 0, order.length - 1)] };
      else if (event.key === "Home") next = { method, block: order[0] };
      else if (event.key === "End") next = { method, block: order.at(-1) };
      else if (event.key === "ArrowDown" || event.key === "ArrowUp") {
        const other = dots.rows[scales.between(row + (event.key === "ArrowDown" ? 1 : -1), 0, dots.rows.length - 1)];
        next = { method: other, block: cursor?.block ?? order.at(-1) };
      }
      if (!next) return;
      event.preventDefault();
      move(next, true);
    });

    const render = (plot, width) => {
      const blocksName = view.overview.json.blocks_name;
      if (!view.ranked().length || !view.numbers().blocks.length) {
        [dots, cursor, key] = [null, null, ""];
        plot.replaceChildren(element("p", {}, `No ${blocksName} are left by the filter.`));
        return { finding: [] };
      }
      // of another selected method or reference only rows change their colour
      const next = JSON.stringify([width, devicePixelRatio, view.group.index, view.metric.name, view.statistic, view.filter, view.state.methods, look()]);
      if (next !== key) [dots, cursor, key] = [new Dots(view, plot, width), null, next];
      scene.style.height = `${dots.height}px`;
      scene.setAttribute("aria-label", `${dots.blocks.length} ${blocksName} as dots, a row per method. Left and right arrows walk by error, up and down change the method, Enter opens.`);
      const most = Math.floor((dots.rows.length * dots.rowHeight) / ROW_LABEL);
      const named = scales.thin(dots.rows, most, (method) => view.weight(method) > 0);
      let free = -Infinity;
      const labels = dots.rows.flatMap((method, row) => {
        const top = TOP + (row + 0.5) * dots.rowHeight;
        if (!named.has(method) || top - free < ROW_LABEL) return [];
        free = top;
        const name = view.overview.methods[method];
        return [element("button", { ...chart.methodMark(view, method, row, null), type: "button", role: null, title: name, class: `row-label method ${view.roles(method)}`, style: `top: ${top}px; width: ${dots.left - 8}px` }, name),
          element("span", { class: `row-value ${view.roles(method)}`, style: `top: ${top}px` }, page.number(dots.numbers.values[method]))];
      });
      // the canvas stays, and with it the focus
      if (!scene.isConnected) plot.replaceChildren(element("div", { class: "dots" }, scene));
      for (const part of [...scene.parentElement.children]) if (part !== scene) part.remove();
      scene.after(...labels);
      dots.paint();
      compose();
      return {
        finding: finding(view, dots),
        caption: [
          strong(`${view.metric.name}${view.metric.unit ? `, ${view.metric.unit}` : ""}${dots.x.name && `, ${dots.x.name}`}. `),
          `Every dot is one of the ${blocksName}, in the row of each method. ${view.statistic === "rank" ? "" : `Bars and numbers are ${view.statistic}s. `}`,
          view.numbers().best.length ? `Blue: the ${view.end}. ` : "",
          dots.blocks.some((block) => view.group.isSuspect(block)) ? `Hollow diamonds: suspect ${blocksName}, whose truth itself is in doubt. ` : "",
          dots.leftOut,
          "Point at a dot to see it in every row, click to open it.",
        ],
      };
    };
    // a canvas does not follow the colours of the page by itself
    const dark = matchMedia("(prefers-color-scheme: dark)");
    const look = () => [dark.matches, document.documentElement.dataset.theme];
    const redraw = chart.mount(host, view, { className: "dots-chart", draw: render });
    selection.on_hover((kind, value) => {
      if (kind === "method" && dots && !cursor) compose(value === null ? null : view.place(value));
    });
    dark.addEventListener("change", redraw);
    new MutationObserver(redraw).observe(document.documentElement, { attributeFilter: ["data-theme"] });
  };

  // Half of the blocks, the worst, and what suspect ones make of it.
  const finding = (view, { blocks, rows, values, count }) => {
    const first = rows[0];
    const errors = blocks.map((block) => values[block * count + first]);
    if (errors.length < 3 || view.better === "none") return [];
    const name = view.overview.json.blocks_name;
    const higher = view.metric.better === "higher";
    const extent = scales.extent(errors);
    const parts = [
      `Half of the ${errors.length} ${name}${view.overview.groups.length > 1 ? ` with ${view.group.title}` : ""} come out ${higher ? "at least at" : "within"} `,
      `${view.error(medianOf(errors))} by `, chart.named(view, first), `, the worst at ${view.error(extent[higher ? 0 : 1])}. `,
    ];
    const suspects = blocks.filter((block) => view.group.isSuspect(block));
    const total = errors.reduce((sum, value) => sum + value, 0);
    if (suspects.length && extent[0] >= 0 && total > 0) {
      const share = suspects.reduce((sum, block) => sum + values[block * count + first], 0) / total;
      const percent = (part) => `${Math.round(100 * part)}\u202f%`;
      parts.push(element("span", { class: "suspect" }, `\u25c7 ${suspects.length} suspect ${name}`), ` (${percent(suspects.length / blocks.length)}) make ${percent(share)} of its error.`);
    }
    return parts;
  };

  return { draw };
});
