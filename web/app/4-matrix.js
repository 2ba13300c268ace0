// Scatter matrix of the objectives: below the diagonal a panel for every pair; a brushed box is two ranges.

function scatterMatrix(host) {
  const layers = host.appendChild(element("div", { class: "layers" }));
  const back = layers.appendChild(element("canvas", { "aria-hidden": "true" }));
  const front = layers.appendChild(element("canvas", { role: "img", "aria-label": "Scatter matrix of the objectives" }));
  const svg = charts.select(layers).append("svg");
  const card = layers.appendChild(element("div", { class: "marked" }));
  const margin = { top: 8, right: 8, bottom: 48, left: 64 }, gap = 10;
  const m = objectives.length;
  let panels = [], size = 0, width = 0, height = 0, pens, image, drawnFor;

  function scale(c, from, to) {
    const pad = 0.05 * (c.max - c.min) || 0.5 * Math.abs(c.max) || 0.5;
    return charts.scaleLinear([c.min - pad, c.max + pad], [from, to]);
  }

  function makePanels() {
    panels = [];
    for (let row = 1; row < m; row++)
      for (let col = 0; col < row; col++) {
        const left = margin.left + col * (size.w + gap), top = margin.top + (row - 1) * (size.h + gap);
        panels.push({
          cx: objectives[col], cy: objectives[row], left, top, isLow: row === m - 1, isLeft: col === 0,
          x: scale(objectives[col], left, left + size.w), y: scale(objectives[row], top + size.h, top),
        });
      }
  }

  // Places of every design in every panel, so that a brush only has to put dots down.
  function placeDots() {
    for (const p of panels) {
      p.dots = new Float32Array(2 * n);
      const ax = p.x(1) - p.x(0), bx = p.x(0), ay = p.y(1) - p.y(0), by = p.y(0);
      for (let i = 0; i < n; i++) {
        p.dots[2 * i] = bx + ax * p.cx.value[i];
        p.dots[2 * i + 1] = by + ay * p.cy.value[i];
      }
    }
  }

  const dotSize = (many) => (many > 4000 ? 1.5 : many > 800 ? 2.2 : 3.2);

  // Dots go straight into the pixels: that is what keeps a quarter of a million of them at hand while brushing.
  function putDots(pen, many, rows, colourOf) {
    const { width: w, height: h } = pen.canvas, ratio = w / width;
    if (!image || image.width !== w || image.height !== h) image = pen.createImageData(w, h);
    const pixels = new Uint32Array(image.data.buffer).fill(0);
    const s = Math.max(1, Math.round(dotSize(many) * ratio)), half = s / 2;
    for (const i of rows) {
      const colour = colourOf(i);
      for (const { dots } of panels) {
        let at = Math.round(dots[2 * i + 1] * ratio - half) * w + Math.round(dots[2 * i] * ratio - half);
        for (let row = 0; row < s; row++, at += w) for (let k = at; k < at + s; k++) pixels[k] = colour;
      }
    }
    pen.putImageData(image, 0, 0);
  }

  const pixel = (hex) => 0xff000000 | (parseInt(hex.slice(5, 7), 16) << 16) | (parseInt(hex.slice(3, 5), 16) << 8) | parseInt(hex.slice(1, 3), 16);
  const rampPixels = RAMP.map((colour) => pixel(colour) >>> 0);
  const palePixel = pixel("#d3d9df") >>> 0;

  function drawFront() {
    const pen = pens.front;
    back.hidden = state.ranges.size === 0;
    putDots(pen, state.nSelected, byShade.filter((i) => state.selected[i]), (i) => rampPixels[shade[i]]);
    if (state.marked === undefined) return;
    for (const { dots } of panels) {
      pen.beginPath();
      pen.arc(dots[2 * state.marked], dots[2 * state.marked + 1], 4.5, 0, 7);
      pen.fillStyle = INK;
      pen.fill();
      pen.lineWidth = 2;
      pen.strokeStyle = "#fff";
      pen.stroke();
    }
  }

  function brushed({ sourceEvent, selection }, p) {
    if (!sourceEvent) return;
    if (!selection) return setRanges([[p.cx, null], [p.cy, null]]);
    const [[x0, y0], [x1, y1]] = selection;
    setRanges([[p.cx, [p.x.invert(x0), p.x.invert(x1)]], [p.cy, [p.y.invert(y1), p.y.invert(y0)]]]);
  }

  // The panel of two ranges shows its box; the others show none.
  function showRanges() {
    svg.selectAll("g.brush").each(function (p) {
      const rx = state.ranges.get(p.cx), ry = state.ranges.get(p.cy);
      const x = (v) => p.x(within(v, p.x.domain())), y = (v) => p.y(within(v, p.y.domain()));
      charts.select(this).call(p.brush.move, rx && ry ? [[x(rx[0]), y(ry[1])], [x(rx[1]), y(ry[0])]] : null);
    });
  }

  // Title and unit, or what of it fits.
  function fitting(c, room) {
    const whole = c.title + (c.unit ? ` [${c.unit}]` : "");
    return [whole, c.title, c.title.split(" ")[0]].find((text) => 7.2 * text.length < room) ?? "";
  }

  function drawAxes(group, p) {
    group.append("rect").attr("class", "cell").attr("x", p.left).attr("y", p.top).attr("width", size.w).attr("height", size.h);
    if (p.isLeft) {
      group.append("g").attr("transform", `translate(${p.left},0)`).call(charts.axisLeft(p.y).ticks(4).tickSize(3).tickFormat(show))
        .call((g) => g.select(".domain").remove());
      group.append("text").attr("class", "title").attr("text-anchor", "middle")
        .attr("transform", `translate(${p.left - 46},${p.top + size.h / 2}) rotate(-90)`).text(fitting(p.cy, size.h));
    }
    if (!p.isLow) return;
    for (const v of p.x.ticks(4))
      group.append("text").attr("class", "unit").attr("text-anchor", "middle").attr("x", p.x(v)).attr("y", p.top + size.h + 14).text(show(v));
    group.append("text").attr("class", "title").attr("text-anchor", "middle").attr("x", p.left + size.w / 2)
      .attr("y", p.top + size.h + 32).text(fitting(p.cx, size.w));
  }

  // The free corner shows the marked design: its variables, tower or not.
  function drawCard() {
    card.hidden = m < 4 || width < 800 || state.marked === undefined;
    if (card.hidden) return;
    const i = state.marked, w = 3 * (size.w + gap) - gap, h = 2 * size.h - 40;
    card.style.left = `${margin.left + (m - 4) * (size.w + gap)}px`;
    card.style.top = `${margin.top}px`;
    card.style.width = `${w}px`;
    const shown = run.tower ? variables.filter((c) => c.name.startsWith("gap_")) : variables;
    const rows = shown.map((c, k) => ({ k: k + 1, v: run.tower ? c.value[i] : (c.value[i] - c.min) / (c.max - c.min || 1) }));
    card.replaceChildren(element("h3", {}, `Design ${ids[i]}`), charts.plot({
      width: w, height: h, marginLeft: 45, marginBottom: 34, ariaLabel: `Variables of design ${ids[i]}`,
      x: { label: !run.tower ? "variable" : shown[0].name.startsWith("gap_zone_") ? "zone" : "floor", ticks: rows.map((r) => r.k).filter((k) => k === 1 || k % 5 === 0), tickFormat: "d", tickSize: 3 },
      y: { label: run.tower ? "gap [mm]" : "place in its range over the front", grid: true, zero: true, domain: [0, Math.max(...shown.map((c) => (run.tower ? c.max : 1)))] },
      marks: [charts.rectY(rows, { x1: (r) => r.k - 0.4, x2: (r) => r.k + 0.4, y1: 0, y2: "v", fill: INK }), charts.ruleY([0])],
    }));
  }

  function layout() {
    width = layers.clientWidth;
    const w = (width - margin.left - margin.right - gap * (m - 2)) / (m - 1);
    size = { w, h: Math.min(0.72 * w, 260) };
    height = margin.top + margin.bottom + (size.h + gap) * (m - 1);
    layers.style.height = `${height}px`;
    makePanels();
    placeDots();
    pens = { back: prepare(back, width, height), front: prepare(front, width, height) };
    svg.attr("width", width).attr("height", height).selectAll("*").remove();
    svg.selectAll("g.panel").data(panels).join("g").attr("class", "panel").each(function (p) {
      const group = charts.select(this);
      drawAxes(group, p);
      p.brush = charts.brush().extent([[p.left, p.top], [p.left + size.w, p.top + size.h]])
        .on("brush end", (event) => brushed(event, p));
      group.append("g").attr("class", "brush").call(p.brush);
    });
    putDots(pens.back, n, byShade, () => palePixel);
    drawCard();
  }

  views.layout.push(layout);
  follow(host, () => {
    drawFront();
    showRanges();
    if (drawnFor !== state.marked) drawCard();
    drawnFor = state.marked;
  });
}
