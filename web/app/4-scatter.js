// Scatter plots: two columns against each other, chosen freely, and a matrix of all objectives with their rank correlations;
// a brushed box is two ranges.
// Panels on one picture; `arrange` (width) gives { height, panels: [{ cx, cy, left, top, w, h, hasX, hasY }] }, `decorate`
// (svg, width, panels) what else is on it, `follows` what of that follows the selection. Dots are put into the pixels.
function scatterPlot(host, label, arrange, decorate, follows = () => {}) {
  const { layers, back, svg, size } = layered(host, label, rowAt);
  let panels = [], width = 0, height = 0, pens, image;

  // Places of every design in every panel, so that a brush only has to put dots down.
  function place(p) {
    p.x = scaleOf(p.cx, p.left, p.left + p.w, 0.05);
    p.y = scaleOf(p.cy, p.top + p.h, p.top, 0.05);
    p.dots = new Float32Array(2 * n);
    for (let i = 0; i < n; i++) {
      p.dots[2 * i] = p.x(p.cx.value[i]);
      p.dots[2 * i + 1] = p.y(p.cy.value[i]);
    }
  }

  // Dots go straight into the pixels: that is what keeps a quarter of a million of them at hand while brushing.
  function putDots(pen, many, rows, colourOf) {
    const { width: w, height: h } = pen.canvas, ratio = w / width;
    if (!image || image.width !== w || image.height !== h) image = pen.createImageData(w, h);
    const pixels = new Uint32Array(image.data.buffer).fill(0);
    const size = (many > 4000 ? 1.5 : many > 800 ? 2.2 : 3.2) * (panels.length === 1 ? 1.5 : 1), s = Math.max(1, Math.round(size * ratio)), half = s / 2;
    for (const i of rows) {
      const colour = colourOf(i);
      for (const { dots } of panels) {
        let at = Math.round(dots[2 * i + 1] * ratio - half) * w + Math.round(dots[2 * i] * ratio - half);
        for (let row = 0; row < s; row++, at += w) for (let k = at; k < at + s; k++) pixels[k] = colour;
      }
    }
    pen.putImageData(image, 0, 0);
  }

  function drawOver() {
    if (!panels.length) return;
    const pen = pens[2];
    pen.clearRect(0, 0, width, height);
    for (const o of shownOverlays())
      for (const p of panels) {
        const at = [p.x(o.value.get(p.cx) ?? NaN), p.y(o.value.get(p.cy) ?? NaN)];
        if (at.every(finite)) drawSymbol(pen, o, ...at, panels.length === 1 ? 110 : 55);
      }
    for (const [row, colour, size] of [[state.marked, INK, 64], [state.hovered, ORANGE, 95]])
      if (row !== undefined) for (const { dots } of panels) drawSymbol(pen, { symbol: "circle", colour }, dots[2 * row], dots[2 * row + 1], size);
  }

  function drawFront() {
    if (!panels.length) return;
    back.hidden = state.ranges.size === 0;
    const colours = shadeColours.map(pixel);
    putDots(pens[1], state.nSelected, byShade.filter((i) => state.selected[i]), (i) => colours[shade[i]]);
    drawOver();
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
      const x = (v) => p.x(clamp(v, p.x.domain())), y = (v) => p.y(clamp(v, p.y.domain()));
      charts.select(this).call(p.brush.move, rx && ry && p.cx !== p.cy ? [[x(rx[0]), y(ry[1])], [x(rx[1]), y(ry[0])]] : null);
    });
  }

  // ---- the pointer
  function rowAt(x, y) {
    const p = panels.find(({ left, top, w, h }) => x >= left && x <= left + w && y >= top && y <= top + h);
    let best, least = 64;
    for (let i = 0; p && i < n; i++) {
      const far = state.selected[i] ? (p.dots[2 * i] - x) ** 2 + (p.dots[2 * i + 1] - y) ** 2 : Infinity;
      if (far < least) [best, least] = [i, far];
    }
    return best;
  }

  // ---- axes
  function drawAxes(group, p) {
    const bottom = p.top + p.h, many = clamp(Math.floor(p.w / 60), [2, 6]);
    put(group, "rect", { class: "cell", x: p.left, y: p.top, width: p.w, height: p.h });
    if (p.hasY)
      put(group, "g", { transform: `translate(${p.left},0)` }).call(charts.axisLeft(p.y).tickValues(ticksOf(p.y, Math.max(2, Math.floor(p.h / 40)))).tickSize(3).tickFormat(tickText(p.cy))).call((g) => g.select(".domain").remove());
    if (!p.hasX) return;
    let end = -Infinity; // of the last number, that the next one does not run into it
    for (const v of ticksOf(p.x, many)) {
      const words = tickText(p.cx)(v), x = p.x(v), half = 3.6 * words.length;
      if (x - half < end + 6) continue;
      end = x + half;
      put(group, "text", { class: "number", x, y: bottom + 15 }).text(words);
    }
  }

  function layout(newWidth) {
    width = newWidth;
    ({ height, panels } = arrange(width));
    panels.forEach(place);
    pens = size(width, height);
    decorate(svg, width, panels);
    svg.selectAll("g.panel").data(panels).join("g").attr("class", "panel").each(function (p) {
      const group = charts.select(this);
      drawAxes(group, p);
      p.brush = charts.brush().extent([[p.left, p.top], [p.left + p.w, p.top + p.h]]).on("brush end", (event) => brushed(event, p));
      put(group, "g", { class: "brush" }).call(p.brush);
    });
    putDots(pens[0], n, byShade, () => pixel(PALE));
  }

  function draw() {
    drawFront();
    showRanges();
    follows();
  }

  views.layout.push(addDrawing(layers, (newWidth) => {
    layout(newWidth);
    draw();
  }));
  views.hover.push(drawOver);
  follow(host, draw);
}

const pixel = (hex) => (0xff000000 | (parseInt(hex.slice(5, 7), 16) << 16) | (parseInt(hex.slice(3, 5), 16) << 8) | parseInt(hex.slice(1, 3), 16)) >>> 0;

// ---- two columns of one's choice
function columnSelect(id, label, key) {
  const select = element("select", { id, onchange: () => {
    state[key] = columns[select.selectedIndex];
    layoutChanged();
  } }, ...columns.map((c) => element("option", c.title)));
  views.layout.push(() => (select.selectedIndex = columns.indexOf(state[key])));
  return element("label", `${label} `, select);
}

function pairPlot(host) {
  const margin = { top: 8, right: 10, bottom: 46, left: 66 };
  scatterPlot(host, "Scatter plot of two columns", (width) => {
    const w = width - margin.left - margin.right, h = Math.min(320, 0.75 * w);
    return { height: h + margin.top + margin.bottom, panels: [{ cx: state.x, cy: state.y, left: margin.left, top: margin.top, w, h, hasX: true, hasY: true }] };
  }, (svg, width, [p]) => {
    put(svg, "text", { class: "title", x: p.left + p.w / 2, y: p.top + p.h + 36 }).text(titleUnit(p.cx));
    put(svg, "text", { class: "title", transform: `translate(16,${p.top + p.h / 2}) rotate(-90)` }).text(titleUnit(p.cy));
  });
}

// ---- all objectives: titles on the diagonal, dots below it, correlations above
// Spearman's coefficient over the selected designs.
function rankCorrelation(a, b) {
  const rows = byShade.filter((i) => state.selected[i]), [p, q] = [a, b].map((c) => charts.rank(rows, (i) => c.value[i])), mean = (rows.length - 1) / 2;
  const sum = (u, v) => charts.sum(u, (_, k) => (u[k] - mean) * (v[k] - mean));
  return sum(p, q) / Math.sqrt(sum(p, p) * sum(q, q)); // NaN where all are equal
}

function scatterMatrix(host) {
  const margin = { top: 4, right: 4, bottom: 22, left: 52 }, gap = 6, m = objectives.length;
  const size = (width) => {
    const w = (width - margin.left - margin.right - gap * (m - 1)) / m;
    return { w, h: clamp(0.66 * w, [44, 150]) };
  };
  const at = ({ w, h }, row, col) => ({ left: margin.left + col * (w + gap), top: margin.top + row * (h + gap) });
  let cells = [];

  scatterPlot(host, "Scatter matrix of the objectives", (width) => {
    const s = size(width), panels = [];
    for (let row = 1; row < m; row++)
      for (let col = 0; col < row; col++)
        panels.push({ cx: objectives[col], cy: objectives[row], ...at(s, row, col), ...s, hasX: row === m - 1, hasY: col === 0 && s.h > 36 });
    return { height: margin.top + margin.bottom + (s.h + gap) * m - gap, panels };
  }, (svg, width) => {
    const s = size(width);
    objectives.forEach((c, k) => {
      const { left, top } = at(s, k, k), rows = [...wrapped(c.title, Math.max(5, s.w / 7.6), s.h > 70 ? 3 : 2), ...(c.unit ? [`[${c.unit}]`] : [])];
      rows.forEach((row, i) => put(svg, "text", { class: "title", x: left + s.w / 2, y: top + s.h / 2 + 15 * (i - (rows.length - 1) / 2) + 4 }).text(row));
    });
    cells = [];
    for (let row = 0; row < m; row++)
      for (let col = row + 1; col < m; col++) {
        const { left: x, top: y } = at(s, row, col), g = put(svg, "g", { class: "correlation" });
        cells.push({ a: objectives[row], b: objectives[col], box: put(g, "rect", { x, y, width: s.w, height: s.h }), text: put(g, "text", { x: x + s.w / 2, y: y + s.h / 2 + 5 }) });
      }
  }, () => { // strength, and whether better in one is worse in the other
    for (const { a, b, box, text } of cells) {
      const r = rankCorrelation(a, b);
      box.attr("fill", r * a.sense * b.sense < 0 ? VERMILLION : BLUE).attr("fill-opacity", finite(r) ? 0.55 * Math.abs(r) : 0);
      text.text(finite(r) ? `${r < 0 ? "\u2212" : "+"}${Math.abs(r).toFixed(2)}` : "\u2013");
    }
  });  host.firstChild.style.minWidth = `${margin.left + 62 * m}px`; // no number lies on another
}
