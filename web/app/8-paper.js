// On paper: pictures of a run, drawings of a dossier, curves that a command asks for. What draws them is what the page has.
// A panel as the program gives it: { title, x, y: axes, marks: [{ mark: line or dot, x, y, ... }] } by the library's names;
// `around`: the middle of an axis that has the scale of y.
function panelChart(width, height, { x, y, marks, title, ...options }) {
  const half = finite(x.around) && ((width - 78) * (y.domain[1] - y.domain[0])) / (height - 56) / 2, domain = half ? [x.around - half, x.around + half] : x.domain;
  return chart({ width, height, marginRight: 20, ...options, x: { grid: true, ...x, domain }, y: { grid: true, ...y }, marks: marks.map((m) => charts[m.mark](m.y, m)) });
}

// Columns of panels below the names of what is in all of them.
function panels(host, { title, names, columns, height }) {
  host.append(element("h3", title), legend(names));
  const grid = gridOf(host, columns.length);
  for (const list of columns) {
    const column = grid.appendChild(element("div"));
    for (const panel of list) figure(column, panel.title, null, (width) => panelChart(width, height / list.length, panel));
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

const DRAWINGS = {
  front: frontPicture, growth: (host) => drawn(host, (width) => growthChart(width, 400, growthRows())), gaps: shapeFigures, peaks: (host, d) => peakPart(host, d, 400), modes: modePart,
  energies: energyPair, displacement: spectrumPair, elsewhere: otherPart, forces: forceFigures, panels,
};
const drawOnPaper = (host, name) => DRAWINGS[name](host, run.drawings?.[name] ?? run.detail);

// ---- a place of the page as SVG: charts, titles and legends, without the style sheet
function svgOf(host) {
  const box = host.getBoundingClientRect(), { width, height } = box, svg = put(charts.select("body"), "svg", { width, height, color: INK, fill: INK, "font-family": "DejaVu Sans, sans-serif" });
  put(svg, "rect", { width, height, fill: PAPER });
  for (const part of host.querySelectorAll("div > svg, figure > svg, h3, .legend span")) {
    const { left, top, bottom } = part.getBoundingClientRect(), isChart = part.tagName === "svg";
    const g = put(svg, isChart ? "g" : "text", { transform: `translate(${left - box.left},${(isChart ? top : bottom - 5) - box.top})`, "font-size": 13, "text-anchor": part.getAttribute("text-anchor") ?? "start" });
    if (isChart) g.node().append(...part.querySelectorAll(":scope > :not(style)"));
    else for (const [more, text] of [[{ fill: part.style.getPropertyValue("--key") }, part.dataset.mark], [{ dx: 6 }, part.textContent]]) put(g, "tspan", more).text(text);
  }
  return new XMLSerializer().serializeToString(svg.node());
}

// The drawings of a dossier stand in its text; pictures that the program asks for take the place of the page: [[name, width]].
function drawPaper() {
  for (const place of document.querySelectorAll("[data-draw]")) drawOnPaper(place, place.dataset.draw);
  drawAll();
  if (!run.paper.length) return;
  const all = element("body"), give = (name, data) => all.append(element("pre", { id: name }, data.replace(/.*,/, "")));
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
