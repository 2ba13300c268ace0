// What all charts by Observable Plot have in common.

// Charts that fit their place: drawn when the page is, when their part is opened and when the window has another width.
const drawings = [];
function drawn(host, plot) {
  const place = host.appendChild(element("div", { class: "chart" }));
  const draw = () => place.clientWidth && place.replaceChildren(plot(Math.max(240, Math.floor(place.clientWidth))));
  drawings.push(draw);
  return draw;
}

function drawAll() {
  for (const draw of drawings) draw();
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
  part.addEventListener("toggle", () => part.open && document.documentElement.dataset.ready && (drawAll(), layoutChanged()));
  return part;
}
const openedForPaper = [];
window.addEventListener("beforeprint", () => {
  for (const part of document.querySelectorAll("details.part:not([open])")) openedForPaper.push(part);
  for (const part of openedForPaper) part.open = true;
  drawAll();
  for (const draw of views.layout) draw();
});
window.addEventListener("afterprint", () => {
  for (const part of openedForPaper.splice(0)) part.open = false;
});

// Floors: every one where they are few.
const floorAxis = (floors) => ({ label: "floor", domain: [0.5, floors + 0.5], tickFormat: "d",
  ticks: Array.from({ length: floors }, (_, j) => j + 1).filter((j) => floors <= 12 || j === 1 || j % (floors > 60 ? 20 : floors > 24 ? 10 : 5) === 0) });
