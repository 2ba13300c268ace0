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

function drawn(host, plot) {
  const place = host.appendChild(element("div", { class: "chart" }));
  return addDrawing(place, (width) => place.replaceChildren(plot(Math.max(240, width))));
}

function figure(host, title, caption, plot, ...above) {
  const f = host.appendChild(element("figure", {}, element("h3", {}, title), ...above));
  f.redraw = drawn(f, plot);
  if (caption) f.append(element("figcaption", {}, caption));
  return f;
}

// Axis titles in the middle of their axes; the letters' size is in the style sheet.
function chart(options) {
  const titled = (axis) => axis && { labelAnchor: "center", labelArrow: "none", ...axis };
  return charts.plot({ marginLeft: 58, marginBottom: 44, marginTop: 12, ...options, x: titled(options.x), y: titled(options.y) });
}

function legend(entries) {
  return element("div", { class: "legend" }, ...entries.map(([label, colour, mark]) => {
    const item = element("span", { "data-mark": mark }, label);
    item.style.setProperty("--key", colour);
    return item;
  }));
}
const sceneLegend = (keys) => legend(keys.map((key) => [SCENES[key].words, SCENES[key].colour, SCENES[key].mark]));

// A part that is folded until it is wanted; on paper all are open.
function folded(host, title, isOpen = false) {
  const part = host.appendChild(element("details", { class: "part", id: title.toLowerCase().replace(/[^a-z]+/g, "-"), open: isOpen }, element("summary", {}, element("h3", {}, title))));
  part.addEventListener("toggle", () => part.open && document.documentElement.dataset.ready && drawAll());
  return part;
}
const openedForPaper = [];
window.addEventListener("beforeprint", () => {
  for (const part of document.querySelectorAll("details.part:not([open])")) openedForPaper.push(part);
  for (const part of openedForPaper) part.open = true;
  drawAll();
});
window.addEventListener("afterprint", () => {
  for (const part of openedForPaper.splice(0)) part.open = false;
});

// Floors: every one where they are few.
const floorAxis = (floors) => ({ label: "floor", domain: [0.5, floors + 0.5], tickFormat: "d",
  ticks: Array.from({ length: floors }, (_, j) => j + 1).filter((j) => floors <= 12 || j === 1 || j % (floors > 60 ? 20 : floors > 24 ? 10 : 5) === 0) });
