// What all charts by Observable Plot have in common.
// What is as wide as its place: drawn when the page is, when its part is opened and when the window has another width.
let drawings = []; // { place, draw (width), width: as last drawn }

function addDrawing(place, draw) {
  const drawing = { place, draw, width: 0 };
  drawings.push(drawing);
  return () => drawEach([drawing]);
}

const widthOf = (place) => (place.closest("details:not([open])") ? 0 : Math.floor(place.clientWidth));

// All places are measured first: what is put into one of them makes the next wait for a layout of the page.
function drawEach(list) {
  const widths = list.map(({ place }) => widthOf(place));
  list.forEach((drawing, k) => {
    drawing.width = widths[k];
    if (drawing.width) drawing.draw(drawing.width);
  });
}
const drawAll = () => drawEach(drawings.filter(({ place, width }) => widthOf(place) !== width));

// Drawings of before are dropped.
function refill(part, fill) {
  part.replaceChildren();
  drawings = drawings.filter(({ place }) => place.isConnected);
  fill(part);
  drawAll();
}

function drawn(host, plot) {
  const place = host.appendChild(div("chart"));
  return addDrawing(place, (width) => place.replaceChildren(plot(Math.max(240, width))));
}

function figure(host, title, caption, plot, ...above) {
  const f = host.appendChild(element("figure", element("h3", title), ...above));
  f.redraw = drawn(f, plot);
  if (caption) f.append(element("figcaption", caption));
  return f;
}

// Axis titles in the middle of their axes; the letters' size is in the style sheet.
function chart(options) {
  const titled = (axis) => axis && { labelAnchor: "center", labelArrow: "none", ...axis };
  return charts.plot({ marginLeft: 64, marginBottom: 44, marginTop: 12, color: { type: "identity" }, symbol: { type: "identity" }, ...options, x: titled(options.x), y: titled(options.y) });
}

const legend = (entries) => div("legend", ...entries.map(([label, colour, mark = "\u25a0"]) => element("span", { "data-mark": mark, style: `--key: ${colour}` }, label)));
const sceneLegend = (keys) => legend(keys.map((key) => [SCENES[key].words, SCENES[key].colour, SCENES[key].mark]));
const gridOf = (host, columns) => host.appendChild(div(`grid${columns}`));

// Heads: words or columns; rows: of line().
const table = (id, heads, rows) => div("scroll", element("table", { id },
  element("thead", element("tr", ...heads.map((h) => (typeof h === "string" ? element("th", { scope: "col" }, h) : element("th", { scope: "col", title: h.what }, ...heading(h)))))),
  element("tbody", ...rows)));

// Cells: words, or a list of what is in one.
const line = (cells, attributes = {}) => element("tr", attributes, ...cells.map((inside) => element("td", ...[inside].flat())));

// What holds rows anew, the focus on the button of the same design.
function refillRows(host, ...inside) {
  const id = host.contains(document.activeElement) && document.activeElement.closest("tr")?.dataset.id;
  host.replaceChildren(...inside);
  if (id) host.querySelector(`[data-id="${id}"] button`)?.focus({ preventScroll: true });
}

// A part that is folded until it is wanted; on paper all are open.
function folded(host, title, isOpen = false) {
  const part = host.appendChild(element("details", { class: "part", id: title.toLowerCase().replace(/[^a-z]+/g, "-"), open: isOpen }, element("summary", element("h3", title))));
  part.ontoggle = () => part.open && root.dataset.ready && drawAll();
  return part;
}
// Everything is drawn again in its colours.
function showTheme(name) {
  if (name === root.dataset.theme) return drawAll();
  takeTheme(name);
  layoutChanged();
  drawEach(drawings);
}

const openedForPaper = [];
window.addEventListener("beforeprint", () => {
  openedForPaper.push(...document.querySelectorAll("details.part:not([open])"));
  for (const part of openedForPaper) part.open = true;
  showTheme("light");
});
window.onafterprint = () => {
  for (const part of openedForPaper.splice(0)) part.open = false;
  showTheme(state.theme);
};

// Bars over the height: { place: floor or zone, v, title, colour, from, to: where it is not the middle of its place }; marks: behind and over them.
const barChart = (width, height, rows, places, label, options = {}, marks = []) => chart({
  width, height, ariaLabel: label, ...options,
  x: { label, grid: true, zero: true, nice: true, tickFormat: (v) => show(Math.abs(v)), ...options.x }, y: { ...floorAxis(places), ...options.y },
  marks: [charts.rectX(rows, { x1: 0, x2: "v", y1: (r) => r.from ?? r.place - 0.38, y2: (r) => r.to ?? r.place + 0.38, fill: "colour", title: "title" }), ...marks, charts.ruleX([0])],
});

// Lines over the height: { name, values from the first floor up, colour, symbol: of a dot on every floor, dash, thick }.
// band: [lows, highs] behind the lines.
function heightChart(width, height, label, lines, floor = "floor", band = null) {
  const rows = lines.flatMap(({ values, ...one }) => values.map((v, j) => ({ ...one, v, floor: j + 1 })));
  return chart({
    width, height, ariaLabel: label, x: { label, grid: true, zero: true, nice: true, ticks: clamp(Math.floor((width - 72) / 75), [2, 4]) }, y: { ...floorAxis(lines[0].values.length), label: floor },
    marks: [
      band ? charts.rectX(band[0].map((low, j) => ({ low, high: band[1][j], floor: j + 1 })), { x1: "low", x2: "high", y1: (r) => r.floor - 0.5, y2: (r) => r.floor + 0.5, fill: lines[0].colour, fillOpacity: 0.18, title: (r) => `all records, ${floor} ${r.floor}: ${show(r.low)} to ${show(r.high)}` }) : null,
      ...lines.map(({ name, dash, thick = 1.8 }) => charts.line(rows.filter((r) => r.name === name), { x: "v", y: "floor", stroke: "colour", strokeWidth: thick, strokeDasharray: dash })),
      charts.dot(rows.filter((r) => r.symbol), { x: "v", y: "floor", r: 3, fill: "colour", symbol: "symbol", title: (r) => `${r.name}, ${floor} ${r.floor}: ${show(r.v)}` }),
      charts.ruleX([0]),
    ],
  });
}

// The hypervolume over the number of designs: rows { x, y [%], colour }; e: half of a band.
const growthChart = (width, height, rows) => chart({
  width, height, ariaLabel: "Hypervolume over the number of designs",
  x: { label: "designs simulated", tickFormat: (v) => (Number.isInteger(v) ? count(v) : "") }, y: { label: "hypervolume [%]", grid: true, zero: true, nice: true },
  marks: [
    rows.some((r) => r.e) ? charts.areaY(rows, { x: "x", y1: (r) => r.y - r.e, y2: (r) => r.y + r.e, z: "colour", fill: "colour", fillOpacity: 0.2 }) : null,
    charts.lineY(rows, { x: "x", y: "y", z: "colour", stroke: "colour", strokeWidth: 2 }),
  ],
});

// Floors: every one where they are few.
const floorAxis = (floors) => ({ label: "floor", domain: [0.5, floors + 0.5], tickFormat: "d",
  ticks: charts.range(1, floors + 1).filter((j) => floors <= 12 || j === 1 || j % (floors > 60 ? 20 : floors > 24 ? 10 : 5) === 0) });
