// Parallel coordinates: a line per design, an axis per column; a brush on an axis is a range of its column. A title is
// dragged: sideways to another place, down to turn the axis over, up to take it away; the same by keys and by a menu.
const SEGMENTS_PER_FRAME = 4000;
const INVERT_PX = 45, HIDE_PX = -32; // of a dragged title
const NEAR_PX = 8; // of a line under the pointer

const axisMenu = document.body.appendChild(element("div", { id: "axis-menu", role: "menu", hidden: true }));

function axisActions(c) {
  const at = state.axes.indexOf(c);
  const move = (by) => {
    state.axes.splice(at, 1);
    state.axes.splice(at + by, 0, c);
  };
  const toggle = (set) => (set.has(c) ? set.delete(c) : set.add(c));
  return [
    ["Move left", at > 0, () => move(-1), "ArrowLeft"], ["Move right", at < state.axes.length - 1, () => move(1), "ArrowRight"],
    ["Turn over", true, () => toggle(state.inverted), "i"],
    [state.log.has(c) ? "Linear" : "Logarithmic", !c.words && extent(c, [])[0] > 0, () => toggle(state.log), "l"],
    [state.percent.has(c) ? "By value" : "Percentiles", !c.words, () => toggle(state.percent), "p"],
    ["Colour by it", true, () => (state.colour = c), "c"],
    ["Hide", state.axes.length > 1, () => state.axes.splice(at, 1), "Delete"],
  ];
}

function actOnAxis(c, act) {
  act();
  axisMenu.hidden = true;
  layoutChanged();
  document.querySelector(`#front .heading[data-name="${CSS.escape(c.name)}"]`)?.focus();
}

function openAxisMenu(c, box) {
  axisMenu.replaceChildren(...axisActions(c).map(([words, can, act, key]) => element("button", { type: "button", role: "menuitem", disabled: !can, onclick: () => actOnAxis(c, act) }, words, element("kbd", key.replace("Arrow", "").replace("Delete", "Del")))));
  axisMenu.hidden = false;
  axisMenu.style.left = `${clamp(box.left, [4, window.innerWidth - axisMenu.offsetWidth - 4])}px`;
  axisMenu.style.top = `${box.bottom + 4}px`;
  axisMenu.querySelector("button:enabled").focus();
  axisMenu.onkeydown = (event) => {
    const items = [...axisMenu.querySelectorAll("button:enabled")], at = items.indexOf(document.activeElement);
    const to = { ArrowDown: at + 1, ArrowUp: at - 1 }[event.key];
    if (to !== undefined) items.at(to % items.length).focus();
    if (event.key === "Escape") actOnAxis(c, () => {});
    if (to !== undefined) event.preventDefault();
  };
}
document.addEventListener("pointerdown", (event) => axisMenu.contains(event.target) || (axisMenu.hidden = true));
window.addEventListener("scroll", () => (axisMenu.hidden = true), { passive: true });

function parallelCoordinates(host) {
  const { layers, back, svg, size } = layered(host, "Parallel coordinates of the front", (x, y, { target }) => (target.closest(".heading, .brush") ? undefined : rowAt(x, y)), true);
  const margin = { top: 58, right: 56, bottom: 14, left: 56 }, height = 400;
  let width = 0, axes = [], places, pens, isBackDrawn;

  const ends = [height - margin.bottom, margin.top]; // the better side is down
  const axisOf = (c) => ({ c, y: scaleOf(c, ...((c.sense < 0) !== state.inverted.has(c) ? [...ends].reverse() : ends), 0.02) });

  // Heights of every design on every axis, so that a brush only has to draw.
  function placeLines() {
    places = new Float32Array(n * axes.length);
    axes.forEach(({ c, y }, k) => {
      for (let i = 0; i < n; i++) places[i * axes.length + k] = y(c.value[i]);
    });
  }

  function stroke(pen, i) {
    pen.beginPath();
    for (let k = 0, at = i * axes.length; k < axes.length; k++, at++) pen.lineTo(axes[k].at, places[at]);
    pen.stroke();
  }

  // Many lines take more than a frame: while a range is dragged, every so many of them.
  function drawLines(pen, rows, colourOf) {
    const step = resting === undefined ? 1 : Math.ceil((rows.length * axes.length) / SEGMENTS_PER_FRAME);
    pen.clearRect(0, 0, width, height);
    pen.lineWidth = rows.length > 2000 ? 0.7 : 1;
    pen.globalAlpha = clamp(9 / Math.sqrt(rows.length + 1), [0.12, 0.85]); // faint where they are many, never invisible
    for (let k = 0; k < rows.length; k += step) {
      pen.strokeStyle = colourOf(rows[k]);
      stroke(pen, rows[k]);
    }
  }

  // In white beneath, so that it stands out of the others.
  function bold(pen, colour, thick, draw) {
    pen.globalAlpha = 1;
    for (const [ink, w] of [[PAPER, thick + 2.6], [colour, thick]]) {
      pen.strokeStyle = ink;
      pen.lineWidth = w;
      draw(pen);
    }
    pen.setLineDash([]);
  }

  // What is compared with: dashed between axes that it has values on, else its symbol alone.
  function drawOverlay(pen, o) {
    const at = axes.map((axis) => axis.y(o.value.get(axis.c) ?? NaN));
    bold(pen, o.colour, 2, () => {
      pen.setLineDash(o.dash);
      pen.beginPath();
      at.forEach((y, k) => {
        if (k && finite(at[k - 1])) pen.lineTo(axes[k].at, y);
        else pen.moveTo(axes[k].at, y);
      });
      pen.stroke();
    });
    pen.fillStyle = pen.strokeStyle = o.colour;
    at.forEach((y, k) => finite(y) && drawSymbol(pen, o, axes[k].at, y, 55));
  }

  function drawOver() {
    const pen = pens[2];
    pen.clearRect(0, 0, width, height);
    for (const o of shownOverlays()) drawOverlay(pen, o);
    if (state.marked !== undefined) bold(pen, INK, 2.4, () => stroke(pen, state.marked));
    if (state.hovered !== undefined) bold(pen, ORANGE, 2.6, () => stroke(pen, state.hovered));
  }

  function drawFront() {
    back.hidden = !state.ranges.size;
    if (!back.hidden && !isBackDrawn) {
      drawLines(pens[0], byShade, () => PALE);
      isBackDrawn = resting === undefined;
    }
    drawLines(pens[1], byShade.filter((i) => state.selected[i]), (i) => shadeColours[shade[i]]);
    drawOver();
  }

  // ---- the pointer
  function rowAt(px, py) {
    const k = axes.findIndex((axis, i) => i + 1 < axes.length && px >= axis.at && px <= axes[i + 1].at);
    if (k < 0) return undefined;
    const s = (px - axes[k].at) / (axes[k + 1].at - axes[k].at), m = axes.length;
    let best, least = NEAR_PX;
    for (let i = 0; i < n; i++) {
      const far = state.selected[i] ? Math.abs(places[i * m + k] * (1 - s) + places[i * m + k + 1] * s - py) : Infinity;
      if (far < least) [best, least] = [i, far];
    }
    return best;
  }

  // ---- axes
  function brushed({ sourceEvent, selection }, axis) {
    if (!sourceEvent) return; // moved by us
    const range = selection ? selection.map(axis.y.invert).sort((a, b) => a - b) : null;
    setRanges([[axis.c, range]]);
  }

  // Brushes follow ranges that were set elsewhere.
  function showRanges() {
    svg.selectAll("g.axis").each(function (axis) {
      const range = state.ranges.get(axis.c);
      const ends = range ? range.map((v) => axis.y(clamp(v, axis.y.domain()))).sort((a, b) => a - b) : null;
      charts.select(this).select("g.brush").call(axis.brush.move, ends);
    });
  }

  function headAxis(group, axis, room) {
    const { c } = axis, wide = Math.min(room, 2 * margin.left), rows = wrapped(c.title, Math.max(4, wide / 7.5), 3); // in as many lines as its place needs
    const g = put(group, "g", { class: "heading", tabindex: 0, role: "button", "aria-haspopup": "menu", "data-name": c.name,
      "aria-label": "Axis " + titleUnit(c) + ": arrow keys move it, i turns it over, l makes it logarithmic, p spreads it by percentiles, c colours by it, Delete hides it, Enter opens its menu" });
    put(g, "rect", { x: -wide / 2 + 2, y: 0, width: wide - 4, height: margin.top - 2 });
    const text = put(g, "text", { class: "title" });
    rows.forEach((row, k) => put(text, "tspan", { x: 0, y: 39 - 14 * (rows.length - 1 - k) }).text(row));
    if (c.unit) put(g, "text", { class: "unit", y: 53 }).text(c.unit);
    g.append("title").text(c.what + ". Drag sideways to move, down to turn over, up to hide; click for more.");
    g.call(dragging(axis));
    g.on("keydown", (event) => {
      const action = axisActions(c).find(([, can, , key]) => can && (key === event.key || key === event.key.toLowerCase()));
      if (event.key === "Enter" || event.key === " ") openAxisMenu(c, event.currentTarget.getBoundingClientRect());
      else if (action) actOnAxis(c, action[2]);
      else return;
      event.preventDefault();
    });
  }

  // The lines follow a dragged axis; the others make room as it passes them.
  function dragging(axis) {
    let x0, y0, dy, isMoved;
    return charts.drag().container(layers).subject(() => ({ x: axis.at, y: 0 })).on("start", (event) => {
      [x0, y0, dy, isMoved] = [event.x, event.y, 0, false];
    }).on("drag", function (event) {
      dy = event.y - y0;
      isMoved ||= Math.hypot(event.x - x0, dy) > 4;
      if (!isMoved) return;
      axis.at = clamp(event.x, [margin.left, width - margin.right]);
      axes.sort((a, b) => a.at - b.at);
      const at = stations(axes.length);
      axes.forEach((a, k) => a !== axis && (a.at = at[k]));
      placeLines();
      svg.selectAll("g.axis").attr("transform", (a) => `translate(${a.at},0)`);
      charts.select(this).attr("data-act", dy > INVERT_PX ? "turn over" : dy < HIDE_PX && axes.length > 1 ? "hide" : null);
      drawFront();
    }).on("end", (event) => {
      const c = axis.c;
      if (!isMoved) return openAxisMenu(c, event.sourceEvent.target.getBoundingClientRect());
      state.axes = axes.map((a) => a.c);
      if (dy > INVERT_PX) state.inverted[state.inverted.has(c) ? "delete" : "add"](c);
      if (dy < HIDE_PX && state.axes.length > 1) state.axes = state.axes.filter((a) => a !== c);
      layoutChanged();
    });
  }

  const stations = (many) => (many > 1 ? Array.from({ length: many }, (_, k) => margin.left + (k * (width - margin.left - margin.right)) / (many - 1)) : [width / 2]);

  function drawAxes() {
    const room = axes.length > 1 ? axes[1].at - axes[0].at : width;
    const g = svg.selectAll("g.axis").data(axes).join("g").attr("class", "axis").attr("transform", (a) => `translate(${a.at},0)`);
    g.each(function (axis, k) {
      const hasNumbers = room > 56 || k === 0 || axes[k - 1].c.family !== axis.c.family;
      const group = charts.select(this);
      axis.brush = charts.brushY().extent([[-10, margin.top - 2], [10, height - margin.bottom + 4]])
        .on("brush end", (event) => brushed(event, axis));
      group.append("g").call(charts.axisLeft(axis.y).tickValues(ticksOf(axis.y, 6)).tickSize(4).tickFormat(hasNumbers ? tickText(axis.c) : () => ""));
      put(group, "g", { class: "brush" }).call(axis.brush);
      headAxis(group, axis, room);
    });
  }

  function layout() {
    const many = state.axes.length;
    layers.style.minWidth = `${Math.max(300, margin.left + margin.right + 52 * (many - 1))}px`;
    width = layers.clientWidth;
    axes = state.axes.map(axisOf);
    stations(many).forEach((at, k) => (axes[k].at = at));
    pens = size(width, height);
    placeLines();
    drawAxes();
    isBackDrawn = false;
  }

  views.layout.push(layout);
  views.hover.push(drawOver);
  follow(host, () => {
    drawFront();
    showRanges();
  });
}

// Words of a title in at most `most` lines of about `room` letters; what is left over ends with an ellipsis.
function wrapped(title, room, most) {
  const rows = [];
  for (const word of title.split(" "))
    if (rows.length && (rows[rows.length - 1] + word).length + 1 <= room) rows[rows.length - 1] += ` ${word}`;
    else rows.push(word);
  const cut = (row) => (row.length > room + 1 ? `${row.slice(0, Math.max(3, room - 1))}\u2026` : row);
  return (rows.length > most ? [...rows.slice(0, most - 1), rows.slice(most - 1).join(" ")] : rows).map(cut);
}

const drawSymbol = (pen, o, x, y, size) => {
  pen.save();
  pen.translate(x, y);
  pen.beginPath();
  charts.symbol(charts[`symbol${capital(o.symbol)}`], size).context(pen)();
  pen.lineWidth = 1.4;
  pen.strokeStyle = PAPER;
  pen.stroke();
  pen.fillStyle = o.colour;
  pen.fill();
  pen.restore();
};
