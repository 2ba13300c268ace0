// On paper: pictures of a run, drawings of a dossier, curves that a command asks for. What draws them is what the page has.
// A panel as the program gives it: { title, x, y: axes, marks: [{ mark: line or dot, x, y, ... }] } by the library's names;
// `around`: the middle of an axis that has the scale of y.
function panelChart(width, height, { x, y, marks, title, ...options }) {
  const half = finite(x.around) && ((width - 78) * (y.domain[1] - y.domain[0])) / (height - 56) / 2, domain = half ? [x.around - half, x.around + half] : x.domain;
  return chart({ width, height, marginRight: 20, ...options, x: { grid: true, ...x, domain }, y: { grid: true, ...y }, marks: marks.map((m) => charts[m.mark](m.y, m)) });
}

// Columns of panels below the names of what is in all of them.
function panels(host, { title = "", names = [], columns, height }) {
  host.append(element("h3", title), legend(names));
  const grid = gridOf(host, columns.length);
  for (const list of columns) {
    const column = grid.appendChild(element("div"));
    for (const panel of list) figure(column, panel.title ?? "", null, (width) => panelChart(width, height / list.length, panel));
  }
}

// ---- what commands draw of their own JSON (--svg)
const curve = (x, y, stroke, strokeWidth, more) => ({ mark: "line", x, y, stroke, strokeWidth, ...more }), DASHED = { strokeDasharray: "6 4" };
const levelsOf = ({ ida: { sa_g: sa, pga_g: pga, ...other } }) => [sa ?? pga ?? Object.values(other)[0], { label: sa ? "spectral acceleration [g]" : pga ? "peak ground acceleration [g]" : Object.keys(other)[0], zero: true, ticks: 5 }];

// The records pale, the fractiles of every case over them.
function idaDrawing(host, d) {
  const [level, y] = levelsOf(d), n = level.length, keys = Object.keys(SCENES).filter((key) => d.ida[key]);
  const runs = charts.range(0, d.records.length, n).map((i) => d.records.slice(i, i + n));
  panels(host, { height: 440, names: keys.map((key) => [`${SCENES[key].words}: median, 16 and 84 %`, SCENES[key].colour, "\u25a0"]),
    columns: d.shown.map(([name, label]) => [{ x: { label, zero: true, ticks: 5 }, y, marks: [
      ...runs.map((list) => curve(list.map((r) => r.with_core[name]), level, "#b8c8d8", 1.2)),
      ...keys.flatMap((key) => [["median", 2.5], ["fractile_16", 1.2, DASHED], ["fractile_84", 1.2, DASHED]].map(([f, ...look]) => curve(d.ida[key][f][name], level, SCENES[key].colour, ...look)))] }]) });
}

// The share of every intensity that exceeded the limit, and the curve through them, where there is one.
function fragilityDrawing(host, d) {
  const [level, x] = levelsOf(d), fine = charts.range(1, 201).map((i) => (i / 200) * 1.05 * level.at(-1));
  const normal = (z) => 1 / (1 + Math.exp(-1.5976 * z - 0.070566 * z ** 3)); // within 2e-4
  const columns = [...charts.group(d.fragility, (c) => [c.of, c.relation, c.bound].join(" "))].map(([title, list]) => [{ title, x, y: { label: "probability", domain: [0, 1] }, marks: list.flatMap(({ scene, median, beta, exceeded, simulations }) => {
    const { colour, symbol } = SCENES[scene] ?? { colour: BLUE };
    return [{ mark: "dot", x: level, y: exceeded.map((n, l) => n / simulations[l]), fill: colour, r: 3, symbol }, curve(fine, fine.map((v) => (median ? normal(Math.log(v / median) / beta) : NaN)), colour, 2.5)];
  }) }]);
  panels(host, { height: 380, columns, names: [...new Set(d.fragility.flatMap((c) => SCENES[c.scene] ?? []))].map(({ words, colour, mark }) => [words, colour, mark]) });
}

// Of a long history the largest sample of each bin.
function thinned(values, bin = Math.ceil(values.length / 16000)) {
  return charts.range(0, values.length, bin).map((i) => i + charts.minIndex(values.slice(i, i + bin), (v) => -Math.abs(v)));
}

// One motion: four histories and two spectra; several: the spectra of all.
function motionDrawing(host, d) {
  const T = d.period_s, inG = (list) => list.map((v) => v / 9.81), x = { label: "period [s]", type: "log", tickFormat: "~g", domain: [0.02, 20] };
  const spectrum = (label, ...marks) => ({ x, y: { label, zero: true }, marks }), PSA = "pseudo-acceleration [g], 5 % damping", target = d.target_psa_m_s2 ? [curve(T, inG(d.target_psa_m_s2), VERMILLION, 2, DASHED)] : [];
  if (d.motions) {
    const all = d.motions.map((m, k) => [m, PALETTE[k % PALETTE.length]]);
    return panels(host, { height: 560, columns: [[spectrum(PSA, ...all.map(([m, colour]) => curve(T, inG(m.psa_m_s2), colour, 1.2)), curve(T, inG(d.mean_psa_m_s2), INK, 3), ...target)]],
      names: [...all.map(([m, colour]) => [shortName(m.motion), colour, "\u25a0"]), ["mean", INK, "\u25a0"], ...target.map(() => ["target", VERMILLION, "\u25a0"])] });
  }
  const kept = thinned(d.accel_m_s2), t = kept.map((i) => i * d.step_s), histories = [["accel_m_s2", "acceleration [g]", 9.81], ["velocity_m_s", "velocity [m/s]", 1], ["displacement_m", "displacement [m]", 1], ["husid", "share of Arias (Husid)", 1]];
  panels(host, { height: 840, columns: [histories.map(([key, label, unit]) => ({ x: { label: "time [s]" }, y: { label, ticks: 5 }, marks: [curve(t, kept.map((i) => d[key][i] / unit), BLUE, 1)] })),
    [spectrum(PSA, curve(T, inG(d.psa_m_s2), BLUE, 2), ...target), spectrum("displacement [m], 5 % damping", curve(T, d.sd_m, BLUE, 2))]],
    title: `${d.motion}${d.channel && `, ${d.channel}`}: ${d.pga_g.toFixed(3)} g, ${d.pgv_m_s.toFixed(3)} m/s, ${d.pgd_m.toFixed(3)} m${d.corrected ? "" : " (uncorrected)"}; Arias ${d.arias_m_s.toFixed(3)} m/s, 5 to 95 % in ${d.d5_95_s.toFixed(1)} s` });
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
  energies: energyPair, displacement: spectrumPair, elsewhere: otherPart, forces: forceFigures, ladder: ladderPart, ida: idaDrawing, fragility: fragilityDrawing, motion: motionDrawing, panels,
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
