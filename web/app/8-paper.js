// On paper: pictures of a run, drawings of a dossier, curves that a command asks for. What draws them is what the page has.

// A panel as the program gives it: { title, x, y: axes, marks: [{ mark: line, dot or text, x, y, ... }], ... } by the library's names.
const panelChart = (width, height, { x, y, marks, ...options }) => chart({
  width, height: options.aspectRatio ? undefined : height, marginRight: 20, ...options, x: { grid: true, ...x }, y: { grid: true, ...y }, marks: marks.map((m) => charts[m.mark](m.y, m)) });

// Columns of panels below the names of what is in all of them.
function panels(host, { title, names, columns, height }) {
  host.append(element("h3", {}, title), legend(names));
  const grid = gridOf(host, columns.length);
  for (const list of columns) {
    const column = grid.appendChild(element("div"));
    for (const panel of list) figure(column, panel.title ?? "", null, (width) => panelChart(width, height / list.length, panel));
  }
}

// The pairs of the paper where all are there, else the first ones.
function frontPicture(host) {
  const wanted = [["j1_m", "j3_g"], ["j1_m", "j2_m"], ["ed1_pct", "ed5_10_pct"]].map((pair) => pair.map(byName)), [a, b, c] = objectives;
  host.append(overlayLegend(), colourBar());
  const grid = gridOf(host, 3), axis = (c) => ({ label: titleUnit(c), grid: true, nice: true, zero: run.tower });
  layoutChanged();
  for (const [x, y] of wanted.flat().every(Boolean) ? wanted : c ? [[a, b], [a, c], [b, c]] : [[a, b]])
    drawn(grid, (width) => chart({ width, height: 340, x: axis(x), y: axis(y), marks: [
      charts.dot(byShade, { x: (i) => x.value[i], y: (i) => y.value[i], fill: (i) => shadeColours[shade[i]], r: 2 }),
      charts.dot(overlays, { x: (o) => o.value.get(x), y: (o) => o.value.get(y), fill: "colour", symbol: "symbol", r: 6 }),
      charts.dot([state.marked], { x: (i) => x.value[i], y: (i) => y.value[i], fill: INK, r: 6 })] }));
}

// A frame to scale, beside it the heights of its floors and its mode shapes; u: a px [m].
function buildingDrawing(host, { nodes, elements, heights, modes }) {
  const [[x0, x1], [z0, z1]] = ["x", "y"].map((k) => charts.extent(nodes, (n) => n[k])), u = Math.max((z1 - z0) / 640, (x1 - x0) / 520), ground = z1 - heights.at(-1), middle = (k) => x1 + (127 + 64 * k) * u;
  const texts = (rows, textAnchor) => charts.text(rows, { x: "x", y: "y", text: "text", textAnchor, fill: INK });
  const support = (held, fill, more) => charts.dot(nodes.filter((n) => n.held === held), { x: "x", y: "y", symbol: "triangle", r: 5, fill, stroke: INK, title: "title", ...more });
  const pins = elements.flatMap(({ ends, pins: is }) => [0, 1].filter((k) => is[k]).map((k) => {
    const [a, b] = [ends[k], ends[1 - k]].map((i) => nodes[i]), share = (6 * u) / Math.max(Math.hypot(b.x - a.x, b.y - a.y), 12 * u);
    return { x: a.x + share * (b.x - a.x), y: a.y + share * (b.y - a.y) };
  }));
  drawn(host, (width) => chart({ width, aspectRatio: 1, margin: 0, x: { axis: null, domain: [x0 - 12 * u, middle(modes.length)] }, y: { axis: null, domain: [z0 - 14 * u, z1 + 30 * u] }, marks: [
    charts.line(elements.flatMap(({ ends, title }, z) => ends.map((i) => ({ ...nodes[i], title, z }))), { x: "x", y: "y", z: "z", title: "title", stroke: INK, strokeWidth: 1.2 }),
    charts.dot(pins, { x: "x", y: "y", r: 2.5, fill: PAPER, stroke: INK }), support("all", INK, { dy: 5 }), support("z", PAPER, { dy: 5 }), support("x", PAPER, { dx: -5, rotate: 90 }),
    charts.dot(nodes.filter((n) => n.floor), { x: "x", y: "y", fill: VERMILLION, title: "title" }),
    texts(heights.map((z, j) => ({ x: x1 + 12 * u, y: ground + z, text: `${j}: ${show(z)} m` })).filter((_, j) => j % Math.ceil(heights.length / 26) === 0), "start"),
    ...modes.flatMap(({ shape, period_s: period, mass_pct: mass }, k) => [
      charts.line(heights, { x: (z, j) => middle(k) + (27 * u * (shape[j - 1] ?? 0)) / Math.max(...shape.map(Math.abs)), y: (z) => ground + z, stroke: BLUE }),
      charts.ruleX([middle(k)], { y1: ground, y2: z1, stroke: PALE }), texts([[22, `${show(period)} s`], [8, `${show(mass)} %`]].map(([up, text]) => ({ x: middle(k), y: z1 + up * u, text })))])] }));
}

const DRAWINGS = {
  front: frontPicture, growth: (host) => drawn(host, (width) => growthChart(width, 400, growthRows())), gaps: shapeFigures, peaks: (host, d) => peakPart(host, d, 400), modes: modePart,
  energies: energyPair, displacement: spectrumPair, elsewhere: otherPart, forces: forceFigures, building: buildingDrawing, panels,
};
const drawOnPaper = (host, name) => DRAWINGS[name](host, run.drawings?.[name] ?? run.detail);

// ---- a place of the page as SVG: charts, titles and legends, without the style sheet

function svgOf(host) {
  const box = host.getBoundingClientRect(), svg = charts.select("body").append("svg"), attributes = (g, all) => Object.entries(all).reduce((one, [key, v]) => one.attr(key, v), g);
  attributes(svg, { width: box.width, height: box.height, color: INK, fill: INK, "font-family": "DejaVu Sans, sans-serif" }).append("rect").attr("width", "100%").attr("height", "100%").attr("fill", PAPER);
  for (const part of host.querySelectorAll("div > svg, figure > svg, h3, .legend span")) {
    const { left, top, bottom } = part.getBoundingClientRect(), isChart = part.tagName === "svg";
    const g = attributes(svg.append(isChart ? "g" : "text"), { transform: `translate(${left - box.left},${(isChart ? top : bottom - 5) - box.top})`, "font-size": 13, "text-anchor": part.getAttribute("text-anchor") ?? "start" });
    if (isChart) g.node().append(...[...part.children].filter((e) => e.tagName !== "style"));
    else {
      g.append("tspan").attr("fill", part.style.getPropertyValue("--key")).text(part.dataset.mark ?? "");
      g.append("tspan").text(` ${part.textContent}`);
    }
  }
  return new XMLSerializer().serializeToString(svg.node());
}

// The drawings of a dossier stand in its text; pictures that the program asks for take the place of the page: [[name, width]].
function drawPaper() {
  for (const place of document.querySelectorAll("[data-draw]")) drawOnPaper(place, place.dataset.draw);
  drawAll();
  if (!run.paper.length) return;
  const all = element("body");
  const give = (name, data) => all.append(element("pre", { id: name }, data.replace(/.*,/, "")));
  for (const [name, width] of run.paper) {
    const host = document.body.appendChild(element("div", { style: `width: ${width}px; padding: 14px` }));
    drawOnPaper(host, name);
    for (const e of host.querySelectorAll("p, figcaption, .scroll")) e.remove();
    drawAll();
    const image = new Image(host.offsetWidth * 1.5, host.offsetHeight * 1.5), canvas = prepare(element("canvas"), image.width, image.height);
    image.src = `data:image/svg+xml;base64,${btoa(unescape(encodeURIComponent(svgOf(host))))}`;
    give(`${name}.svg`, image.src);
    image.onload = () => {
      canvas.drawImage(image, 0, 0, image.width, image.height);
      give(`${name}.png`, canvas.canvas.toDataURL());
    };
  }
  root.replaceChildren(all);
}
