// The chosen design: gaps, peaks, modes, energies, the displacement of a floor, other earthquakes.

// Charts that fit their place: drawn now, and again when the window has another width.
const drawings = [];
function drawn(figure, plot) {
  const place = figure.appendChild(element("div", { class: "chart" }));
  const draw = () => place.replaceChildren(plot(Math.max(280, Math.floor(place.clientWidth))));
  drawings.push(draw);
}

function figure(host, title, caption, plot, ...above) {
  const f = host.appendChild(element("figure", {}, element("h3", {}, title), ...above));
  drawn(f, plot);
  if (caption) f.append(element("figcaption", {}, caption));
  return f;
}

function legend(entries) {
  return element("div", { class: "legend" }, ...entries.map(([label, colour, mark]) => {
    const item = element("span", { "data-mark": mark }, label);
    item.style.setProperty("--key", colour);
    return item;
  }));
}

const WITH = "with core", WITHOUT = "without core", RIGID = "rigidly connected", TMD = "tuned mass damper", LINKS = "viscous links";
const SCENE_COLOUR = new Map([[WITH, BLUE], [WITHOUT, VERMILLION], [RIGID, OLIVE], [TMD, GREEN], [LINKS, PURPLE]]);
const SCENE_SYMBOL = new Map([[WITH, "circle"], [WITHOUT, "diamond2"], [RIGID, "triangle"], [TMD, "square"], [LINKS, "cross"]]);
const SCENE_MARK = new Map([[WITH, "\u25cf"], [WITHOUT, "\u25c6"], [RIGID, "\u25b2"], [TMD, "\u25a0"], [LINKS, "+"]]);
const sceneLegend = (scenes, marks) => legend(scenes.map((s) => [s, SCENE_COLOUR.get(s), marks ? SCENE_MARK.get(s) : null]));

const BASELINE_NOTE = {
  rigid: () => "Rigidly connected: floors and core move together without a gap, a linear building.",
  tmd: (device) => `Tuned mass damper: the core\u2019s mass on a spring and a dashpot at the roof (${device}).`,
  links: (device) => `Viscous links: a dashpot between every floor and the core (${device}).`,
};

// ---- heights

const floorAxis = (floors) => ({ label: "floor", domain: [0.5, floors + 0.5], ticks: Array.from({ length: floors }, (_, j) => j + 1)
  .filter((j) => j === 1 || j % (floors > 24 ? 10 : 5) === 0), tickFormat: "d" });

function gapFigure(host, d) {
  const floors = d.gap_m.length;
  const rows = d.gap_m.map((g, j) => ({ floor: j + 1, gap: 1e3 * g, bumper: d.bumper_n_m[j] }));
  const soft = Math.min(...d.bumper_n_m), hard = Math.max(...d.bumper_n_m);
  const stiffness = soft === hard ? `${show(soft / 1e6)} MN/m` : `${show(soft / 1e6)} to ${show(hard / 1e6)} MN/m`;
  const bumpers = hard > 0 ? ` Bumpers of ${stiffness}.` : "";
  figure(host, "Gaps over the height", `Clearance between floor and core on either side.${bumpers}`, (width) => charts.plot({
    width, height: 380, marginLeft: 45, ariaLabel: "Gap of every floor", x: { label: "gap [mm]", grid: true, zero: true, nice: true }, y: floorAxis(floors),
    marks: [charts.rectX(rows, { x1: 0, x2: "gap", y1: (r) => r.floor - 0.38, y2: (r) => r.floor + 0.38, fill: BLUE, title: (r) => `floor ${r.floor}: ${show(r.gap)} mm${r.bumper > 0 ? `, bumper ${show(r.bumper / 1e6)} MN/m` : ""}` }), charts.ruleX([0])],
  }));
}

function thicknessFigure(host, d) {
  const rows = d.thickness_m.map((t, j) => ({ floor: j + 1, t: 1e3 * t }));
  figure(host, "Thickness of the core", `From ${show(rows[0].t)} mm in the first storey to ${show(rows[rows.length - 1].t)} mm in the last.`, (width) => charts.plot({
    width, height: 380, marginLeft: 45, ariaLabel: "Thickness of the core", x: { label: "thickness [mm]", grid: true, zero: true, nice: true }, y: floorAxis(rows.length),
    marks: [charts.line(rows, { x: "t", y: "floor", stroke: BLUE, strokeWidth: 2.5 }), charts.dot(rows, { x: "t", y: "floor", fill: BLUE, r: 3 }), charts.ruleX([0])],
  }));
}

function peakFigure(host, scenes, key, title, label) {
  const rows = scenes.flatMap(([scene, r]) => r[key].map((v, j) => ({ scene, v, floor: j + 1 })));
  const floors = scenes[0][1][key].length;
  figure(host, title, null, (width) => charts.plot({
    width, height: 400, marginLeft: 45, ariaLabel: title, x: { label, grid: true, zero: true, nice: true }, y: floorAxis(floors),
    marks: [
      charts.line(rows, { x: "v", y: "floor", z: "scene", stroke: (r) => SCENE_COLOUR.get(r.scene), strokeWidth: 1.8 }),
      charts.dot(rows, { x: "v", y: "floor", r: 3, fill: (r) => SCENE_COLOUR.get(r.scene), symbol: (r) => SCENE_SYMBOL.get(r.scene) }),
      charts.ruleX([0]),
    ],
    color: { type: "identity" }, symbol: { type: "identity" },
  }), sceneLegend(scenes.map(([scene]) => scene), true));
}

// ---- modes

function modeFigure(host, scenes, title, caption) {
  const modes = Math.min(10, scenes[0][1].modes.length), w = 0.8 / scenes.length;
  const rows = scenes.flatMap(([scene, r], s) => r.modes.slice(0, modes).map((v, i) => ({ scene, v, mode: i + 1, left: i + 0.6 + s * w })));
  figure(host, title, caption, (width) => charts.plot({
    width, height: 300, marginLeft: 45, marginBottom: 40, ariaLabel: title,
    x: { label: "mode of the building", labelAnchor: "center", labelArrow: "none", domain: [0.5, modes + 0.5], ticks: Array.from({ length: modes }, (_, i) => i + 1), tickFormat: "d", tickSize: 0 },
    y: { label: "share of the input energy [%]", grid: true, zero: true, nice: true },
    color: { type: "identity" },
    marks: [
      charts.rectY(rows, { x1: (r) => r.left + 0.06 * w, x2: (r) => r.left + 0.94 * w, y1: 0, y2: "v", fill: (r) => SCENE_COLOUR.get(r.scene), title: (r) => `mode ${r.mode}, ${r.scene}: ${show(r.v)} %` }),
      charts.ruleY([0]),
    ],
  }), sceneLegend(scenes.map(([scene]) => scene)));
}

// ---- over time

const ENERGIES = [["damped_building", "damping of the building", BLUE], ["damped_core", "damping of the core", GREEN],
  ["contacts", "impacts", ORANGE], ["core", "kinetic and strain energy of the core", PURPLE], ["strain", "strain energy of the building", SKY], ["kinetic", "kinetic energy of the building", GREY]];

function energyFigure(host, title, h, top) {
  const rows = [];
  for (let i = 0; i < h.t.length; i++) {
    let sum = 0;
    for (const [key, , colour] of ENERGIES) {
      const low = sum;
      sum += h.energies[key][i] / 1e6;
      rows.push({ t: h.t[i], low, high: sum, colour });
    }
  }
  const input = h.t.map((t, i) => ({ t, v: h.energies.input[i] / 1e6 }));
  figure(host, title, null, (width) => charts.plot({
    width, height: 300, marginLeft: 50, ariaLabel: title, x: { label: "time [s]" }, y: { label: "energy [MJ]", grid: true, domain: [0, top], nice: true },
    color: { type: "identity" },
    marks: [
      charts.areaY(rows, { x: "t", y1: "low", y2: "high", z: "colour", fill: "colour" }),
      charts.lineY(input, { x: "t", y: "v", stroke: INK, strokeWidth: 1.4 }),
      charts.ruleY([0]),
    ],
  }));
}

function energyPair(host, d) {
  const all = [[`Energies, ${WITH}`, d.history_with_core], [`Energies, ${WITHOUT}`, d.history_no_core]].filter(([, h]) => h);
  const top = Math.max(...all.map(([, h]) => h.energies.input.reduce((a, b) => Math.max(a, b), 0))) / 1e6;
  host.before(legend([...ENERGIES.map(([, label, colour]) => [label, colour]), ["input energy", INK]]));
  for (const [title, h] of all) energyFigure(host, title, h, top);
}

function displacementPlot(h, limit, width) {
  const rows = h.t.map((t, i) => ({ t, u: h.u[i] }));
  return charts.plot({
    width, height: 130, marginBottom: 8, marginLeft: 50, marginRight: 20, ariaLabel: "Displacement over time", x: { axis: null, domain: [h.t[0], h.t[h.t.length - 1]] },
    y: { label: "displacement [m]", domain: [-limit, limit], grid: true, ticks: 5 },
    marks: [charts.lineY(rows, { x: "t", y: "u", stroke: INK, strokeWidth: 0.9 })],
  });
}

const FREQUENCY_TICKS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500];

// Rows are equidistant in the logarithm of the frequency.
function spectrumPlot(h, top, hz, width) {
  const f = h.spectrum_f, t = h.spectrum_t;
  const low = Math.log10(f[0]), high = Math.log10(f[f.length - 1]);
  return charts.plot({
    width, height: 260, marginLeft: 50, marginRight: 20, ariaLabel: "Amplitude by frequency and time",
    x: { label: "time [s]", domain: [t[0], t[t.length - 1]] },
    y: { label: "frequency [Hz]", domain: [low, high], ticks: FREQUENCY_TICKS.map(Math.log10).filter((v) => v > low && v < high), tickFormat: (v) => show(10 ** v) },
    color: { scheme: "viridis", type: "sqrt", domain: [0, top] },
    marks: [
      charts.raster(h.spectrum, { width: t.length, height: f.length, x1: t[0], x2: t[t.length - 1], y1: low, y2: high, imageRendering: "auto" }),
      charts.ruleY(hz.map(Math.log10).filter((v) => v > low && v < high), { stroke: "white", strokeOpacity: 0.75, strokeDasharray: "4 4" }),
    ],
  });
}

function spectrumPair(host, d) {
  const all = [[WITH, d.history_with_core], [WITHOUT, d.history_no_core]].filter(([, h]) => h);
  const largest = (list) => list.reduce((a, b) => Math.max(a, Math.abs(b)), 0);
  const limit = Math.max(...all.map(([, h]) => largest(h.u))), top = Math.max(...all.map(([, h]) => largest(h.spectrum)));
  for (const [scene, h] of all) {
    const f = figure(host, `Displacement of floor ${d.floor}, ${scene}`, null, (width) => displacementPlot(h, limit, width));
    drawn(f, (width) => spectrumPlot(h, top, d.building_hz.slice(0, 10), width));
  }
  return top;
}

// ---- other earthquakes

function otherTable(d) {
  const all = [{ record: d.record, pga_g: d.pga_g, scale: d.scale, stretch: d.stretch, with_core: d.with_core, no_core: d.no_core }, ...d.elsewhere];
  const kept = objectives.map((c, k) => [c, k]).filter(([c]) => c.name !== "mcore_kg");
  const line = (label, words, r) => element("tr", {}, element("td", {}, label), element("td", {}, words),
    ...(r.objectives ? [...kept.map(([c, k]) => element("td", {}, digits((r.objectives[k] ?? NaN) * c.factor))), element("td", {}, r.impacts ? count(r.impacts) : "")]
      : [element("td", { colspan: kept.length + 1 }, `not simulated: ${r.reason}`)]));
  return element("div", { class: "scroll" }, element("table", {},
    element("thead", {}, element("tr", {}, element("th", { scope: "col" }, "earthquake"), element("th", {}, ""), ...kept.map(([c]) => element("th", { scope: "col", title: c.what }, ...heading(c))), element("th", { scope: "col" }, "impacts"))),
    element("tbody", {}, ...all.flatMap((e) => [line(`${shortName(e.record)}, ${peakText(e)}`, WITH, e.with_core), line("", WITHOUT, e.no_core)]))));
}

const shortName = (record) => record.replace(/^builtin:(.*)/, "$1 (synthetic)").replace(/.*\//, "");

function otherPart(host, d) {
  host.append(element("h3", { class: "part" }, "Other earthquakes"), element("p", { class: "note" },
    "The same design under motions that the search did not use. Synthetic motions imitate the record of that name; give recorded ones with --record."), otherTable(d));
  const grid = host.appendChild(element("div", { class: "grid2" }));
  for (const e of d.elsewhere) {
    const scenes = [[WITH, e.with_core], [WITHOUT, e.no_core]].filter(([, r]) => r.objectives);
    if (!scenes.length) continue;
    peakFigure(grid, scenes, "drift_m", `Interstorey drift under ${shortName(e.record)}`, "peak interstorey drift [m]");
    modeFigure(grid, scenes, `Modes under ${shortName(e.record)}`, null);
  }
}

// ---- all of it

function part(host, title, note, columns) {
  host.append(element("h3", { class: "part" }, title), ...(note ? [element("p", { class: "note" }, note)] : []));
  return host.appendChild(element("div", { class: columns }));
}

function designPart() {
  const host = document.getElementById("design"), d = run.detail;
  if (!d) return host.remove();
  const r = d.with_core;
  host.querySelector("h2").textContent = `Design ${run.chosen}${run.chosen === run.knee ? ", the knee" : ""}`;
  const scenes = [[WITH, r], [WITHOUT, d.no_core], [RIGID, d.rigid], [TMD, d.tmd], [LINKS, d.links]].filter(([, s]) => s.objectives);
  if (run.chosen !== run.knee) host.append(cards(run.chosen_f, d.baselines), comparison(run.chosen_f, d.baselines), loadTable(d.loads));
  host.append(element("p", { class: "note" }, `Simulated again with the run\u2019s settings. For another design: imtet report ${run.folder} --design ID`));
  if (!r.objectives) host.append(element("p", { class: "warn" }, `This design could not be simulated: ${r.reason}`));
  else host.append(element("p", {}, `${count(r.impacts)} impacts dissipated ${show(r.contact_pct)} % of the input energy of ${show(r.input_j / 1e6)} MJ.` ));
  if (r.beyond_law) host.append(element("p", { class: "warn" }, "The maximum indentation is more than a tenth of the contact\u2019s radius: beyond what the contact law is meant for."));
  const shape = part(host, "Shape", null, "grid21");
  gapFigure(shape, d);
  thicknessFigure(shape, d);
  if (scenes.length) {
    const peaks = part(host, "Peaks of every floor", d.baselines.filter((b) => b.key !== "no_core").map((b) => BASELINE_NOTE[b.key](b.device)).join(" "), "grid3");
    peakFigure(peaks, scenes, "displacement_m", "Displacement", "peak displacement [m]");
    peakFigure(peaks, scenes, "drift_m", "Interstorey drift", "peak interstorey drift [m]");
    peakFigure(peaks, scenes, "acceleration_g", "Acceleration", "peak absolute acceleration [g]");
    modeFigure(part(host, "Dissipated energy by mode", "Impacts transfer energy from low modes to high ones, which dissipate it faster. The rest to 100 % was dissipated by the core, by modes above the tenth and in impacts.", "grid1"), scenes.slice(0, 3), "Energy dissipated by each mode", null);
  }
  if (d.history_with_core || d.history_no_core) {
    energyPair(part(host, "Energies over time", "Stacked: the parts add up to the input energy so far. Shown until the displacement stays below 2 % of its peak.", "grid2"), d);
    const histories = part(host, "Displacement over time", null, "grid2");
    const top = spectrumPair(histories, d);
    histories.before(element("p", { class: "note" }, `Below each history its Morlet wavelet amplitude by frequency; colour from 0 to ${show(top)} m by its square root, the same on both sides; dashed: natural frequencies of the building.`));
  }
  if (d.elsewhere.length) otherPart(host, d);
}
