// Parallel coordinates: a line per design, an axis per column; a brush on an axis is a range of its column. `name` is
// what state.axes calls these columns.

const SEGMENTS_PER_FRAME = 4000;

function parallelCoordinates(host, name, shown) {
  const isShown = () => state.axes === name || state.axes === "all";
  const layers = host.appendChild(element("div", { class: "layers" }));
  const back = layers.appendChild(element("canvas", { "aria-hidden": "true" }));
  const front = layers.appendChild(element("canvas", { role: "img", "aria-label": `Parallel coordinates of the ${name}` }));
  const svg = charts.select(layers).append("svg");
  const margin = { top: 46, right: 40, bottom: 14, left: 46 }, height = shown === objectives ? 400 : 320;
  let width = 0, axes = [], places, x, pens, isBackDrawn;
  const frames = { back: null, front: null };

  // Better is down on every objective's axis.
  function axisOf(c) {
    const { low, high } = c.sense ? { low: c.min, high: c.max } : c.group;
    const pad = high > low ? 0.02 * (high - low) : 0.5 * Math.abs(high) || 0.5;
    const ends = [low - pad, high + pad];
    return {
      c,
      y: charts.scaleLinear(c.sense < 0 ? [ends[1], ends[0]] : ends, [height - margin.bottom, margin.top]),
    };
  }

  // Heights of every design on every axis, so that a brush only has to draw.
  function placeLines() {
    places = new Float32Array(n * axes.length);
    axes.forEach(({ c, y }, k) => {
      const slope = y(1) - y(0), start = y(0);
      for (let i = 0; i < n; i++) places[i * axes.length + k] = start + slope * c.value[i];
    });
  }

  function stroke(pen, i) {
    pen.beginPath();
    for (let k = 0, at = i * axes.length; k < axes.length; k++, at++) {
      if (k) pen.lineTo(axes[k].at, places[at]);
      else pen.moveTo(axes[k].at, places[at]);
    }
    pen.stroke();
  }

  // Many lines take more than a frame: they come in passes over the whole, so that the first one shows what the last
  // one will; a new change drops what is still to come.
  function inPasses(lane, lines, drawLine, after) {
    const passes = Math.ceil((lines.length * axes.length) / SEGMENTS_PER_FRAME) || 1;
    let pass = 0;
    drop(frames[lane]);
    const next = () => {
      for (let k = pass; k < lines.length; k += passes) drawLine(lines[k]);
      after();
      frames[lane] = ++pass < passes ? later(next) : null;
    };
    next();
  }

  function drawBack() {
    const pen = pens.back;
    isBackDrawn = true;
    pen.clearRect(0, 0, width, height);
    pen.strokeStyle = "#c3cad2";
    pen.lineWidth = 0.6;
    pen.globalAlpha = opacity(n);
    inPasses("back", byShade, (i) => stroke(pen, i), () => {});
  }

  function drawMarked() {
    if (state.marked === undefined) return;
    const pen = pens.front;
    pen.save();
    pen.globalAlpha = 1;
    for (const [colour, thick] of [["#ffffff", 5], [INK, 2.4]]) {
      pen.strokeStyle = colour;
      pen.lineWidth = thick;
      stroke(pen, state.marked);
    }
    pen.restore();
  }

  function drawFront() {
    const pen = pens.front;
    const isPartial = state.ranges.size > 0;
    if (isPartial && !isBackDrawn) drawBack();
    back.hidden = !isPartial;
    pen.clearRect(0, 0, width, height);
    pen.lineWidth = state.nSelected > 2000 ? 0.7 : 1;
    pen.globalAlpha = opacity(state.nSelected);
    let last = -1;
    inPasses("front", byShade.filter((i) => state.selected[i]), (i) => {
      if (shade[i] !== last) pen.strokeStyle = RAMP[(last = shade[i])];
      stroke(pen, i);
    }, drawMarked);
  }

  function brushed({ sourceEvent, selection }, axis) {
    if (!sourceEvent) return; // moved by us
    const range = selection ? selection.map(axis.y.invert).sort((a, b) => a - b) : null;
    setRanges([[axis.c, range]]);
  }

  // Brushes follow ranges that were set elsewhere.
  function showRanges() {
    svg.selectAll("g.axis").each(function (axis) {
      const range = state.ranges.get(axis.c);
      const ends = range ? range.map((v) => axis.y(within(v, axis.y.domain()))).sort((a, b) => a - b) : null;
      charts.select(this).select("g.brush").call(axis.brush.move, ends);
    });
  }

  // Long titles on narrow axes stand in two lines.
  function label(g, axis, room) {
    const words = axis.c.title.split(" ");
    const wraps = words.length > 1 && 7 * axis.c.title.length > Math.min(room, 2 * margin.left);
    const text = g.append("text").attr("class", "title").attr("text-anchor", "middle");
    if (wraps) {
      text.append("tspan").attr("x", 0).attr("y", 12).text(words.slice(0, -1).join(" "));
      text.append("tspan").attr("x", 0).attr("y", 25).text(words[words.length - 1]);
    } else text.append("tspan").attr("x", 0).attr("y", 25).text(axis.c.title);
    if (axis.c.unit) g.append("text").attr("class", "unit").attr("text-anchor", "middle").attr("y", 38).text(axis.c.unit);
    g.append("title").text(axis.c.what);
  }

  function drawAxes() {
    const room = axes.length > 1 ? axes[1].at - axes[0].at : width;
    svg.attr("width", width).attr("height", height).selectAll("*").remove();
    const g = svg.selectAll("g.axis").data(axes).join("g").attr("class", "axis").attr("transform", (a) => `translate(${a.at},0)`);
    g.each(function (axis, k) {
      const isLabelled = room > 70 || k === 0 || axes[k - 1].c.group !== axis.c.group;
      const group = charts.select(this);
      axis.brush = charts.brushY().extent([[-10, margin.top - 4], [10, height - margin.bottom + 4]])
        .on("brush end", (event) => brushed(event, axis));
      group.append("g").call(charts.axisLeft(axis.y).ticks(room > 70 ? 6 : 4).tickSize(4)
        .tickFormat(isLabelled ? show : () => ""));
      label(group, axis, room);
      group.append("g").attr("class", "brush").call(axis.brush);
    });
  }

  function layout() {
    host.hidden = !isShown();
    if (host.hidden) return;
    width = layers.clientWidth;
    layers.style.height = `${height}px`;
    axes = shown.map(axisOf);
    x = charts.scalePoint(axes.map((_, k) => k), [margin.left, width - margin.right]);
    axes.forEach((axis, k) => (axis.at = axes.length > 1 ? x(k) : width / 2));
    pens = { back: prepare(back, width, height), front: prepare(front, width, height) };
    placeLines();
    drawAxes();
    isBackDrawn = false;
  }

  views.layout.push(layout);
  follow(host, () => {
    if (host.hidden) return;
    drawFront();
    showRanges();
  });
}
