// The chosen design: gaps, peaks, modes, energies, the displacement of a floor, other earthquakes.
// ---- heights
// Gaps at a bound of the search and gaps that never close are marked; bounds by a dashed line.
// A gap as wide as this stands for no stop at all (src/study/simplify.h).
const NO_STOP_M = 10;

function gapFigure(host, d) {
  const gaps = variables.filter((c) => /^gap_/.test(c.name)), [low, high] = gaps[0]?.bounds ?? [NaN, NaN];
  const sides = d.gap_side_m ? [["right", 1, d.gap_side_m[0]], ["left", -1, d.gap_side_m[1]]] : [["", 1, d.gap_m]];
  const rows = sides.flatMap(([side, sign, list]) => list.flatMap((g, j) => {
    const closes = d.with_core.closings?.[j] !== 0, bound = gaps.length && atBound(gaps[0], 1e3 * g), bumper = d.bumper_n_m[j];
    const title = `floor ${j + 1}${side && `, ${side}`}: ${show(1e3 * g)} mm${bound ? ", at a bound" : ""}${closes ? "" : ", never closes"}${bumper > 0 ? `, bumper ${show(bumper / 1e6)} MN/m` : ""}`;
    return g === null || g >= NO_STOP_M ? [] : [{ place: j + 1, v: sign * 1e3 * g, bound, title, colour: closes ? BLUE : "#c5d6e2" }];
  }));
  const isBoth = !d.gap_side_m, bounds = [low, high].flatMap((b) => sides.map(([, sign]) => sign * b));
  const soft = Math.min(...d.bumper_n_m), hard = Math.max(...d.bumper_n_m);
  const stiffness = soft === hard ? `${show(soft / 1e6)} MN/m` : `${show(soft / 1e6)} to ${show(hard / 1e6)} MN/m`;
  const bumpers = `${hard > 0 ? ` Bumpers of ${stiffness}.` : ""}${rows.length < sides.length * d.gap_m.length ? " Where no bar is there is no stop." : ""}`;
  figure(host, "Gaps over the height", `${isBoth ? "Clearance between floor and core on either side." : "How far a floor may go to the left (drawn to the left of 0) and to the right before it meets the core."}${bumpers}`, (width) => barChart(width, 380, rows, d.gap_m.length, isBoth ? "gap [mm]" : "gap to the left and to the right [mm]", {}, [
    charts.ruleX(bounds.filter(finite), { stroke: VERMILLION, strokeDasharray: "5 4" }),
    charts.dot(rows.filter((r) => r.bound), { x: "v", y: "place", symbol: "diamond2", fill: VERMILLION, stroke: PAPER, r: 5, title: "title" }),
  ]), legend([["closes", BLUE], ["never closes", "#c5d6e2"], ["at a bound of the search", VERMILLION, "\u25c6"]]));
}

function shapeFigures(host, d, isBeside = false) {
  const shape = gridOf(host, 21), values = d.thickness_m.map((t) => 1e3 * t);
  if (!isBeside) gapFigure(shape, d);
  figure(shape, "Thickness of the core", null, (width) => heightChart(width, 380, "thickness [mm]", [{ name: "thickness", values, colour: BLUE, symbol: "circle", thick: 2.5 }]));
}

// The largest force on every floor by side, and what the storeys of the core bear.
function forceFigures(part, d) {
  const { contact_force_n: sides, core_storey_stress_pa: stress, core_buckling_pa: buckling } = d.with_core;
  if (!sides) return;
  const host = gridOf(part, 2);
  const rows = sides.flatMap((side, s) => side.map((v, j) => ({ v: v / 1e6, from: j + 0.64 + 0.36 * s, to: j + 1 + 0.36 * s, colour: s ? SKY : BLUE, title: `floor ${j + 1}, moving ${s ? "left" : "right"}: ${show(v / 1e6)} MN` })));
  if (d.with_core.contact_force_max_n) figure(host, "Contact forces", "The largest on every floor, by the side that it reaches.", (width) => barChart(width, 340, rows, d.gap_m.length, "largest contact force [MN]"), legend([["floor moves right (u > v)", BLUE], ["floor moves left", SKY]]));
  if (!stress) return;
  const mega = (values) => values.map((v) => v / 1e6), lines = [{ name: "stress", values: mega(stress), colour: BLUE, thick: 2 }];
  if (buckling) lines.push({ name: "stress at which the bare wall buckles", values: mega(buckling), colour: VERMILLION, thick: 2, dash: "5 4" });
  figure(host, "Core stress", "Largest bending stress of every storey.", (width) => heightChart(width, 340, "stress [MPa]", lines, "storey"), legend(lines.map(({ name, colour }) => [name, colour])));
}

const PEAKS = [["peak_displacement_m", "Displacement", "peak displacement [m]"], ["peak_drift_m", "Interstorey drift", "peak interstorey drift [m]"], ["peak_acceleration_g", "Acceleration", "peak absolute acceleration [g]"]];

// scenes: [[key, result]]
function peakFigure(host, scenes, key, title, label, height, band) {
  const lines = scenes.map(([scene, r]) => ({ name: SCENES[scene].words, colour: SCENES[scene].colour, symbol: SCENES[scene].symbol, values: r[key] }));
  figure(host, title, null, (width) => heightChart(width, height, label, lines, "floor", band?.[key]));
}

const scenesOf = (d) => Object.keys(SCENES).map((key) => [key, d[key]]).filter(([, s]) => s?.objectives);

function peakPart(host, d, height) {
  const scenes = scenesOf(d);
  if (!scenes.length) return;
  host.append(sceneLegend(scenes.map(([key]) => key)));
  const grid = gridOf(host, 3);
  for (const [key, title, label] of PEAKS) peakFigure(grid, scenes, key, title, label, height, d.band);
}

// ---- where the energy goes
// A dot per mode and scene, logarithmic: the first mode has a hundred times the share of the tenth.
function modeFigure(host, scenes, title, caption) {
  const modes = Math.min(10, scenes[0][1].mode_share_pct.length);
  const rows = scenes.flatMap(([scene, r]) => r.mode_share_pct.slice(0, modes).map((v, i) => ({ ...SCENES[scene], v: Math.max(v, 0.01), mode: i + 1 })));
  figure(host, title, caption, (width) => chart({
    width, height: 300, ariaLabel: title,
    x: { label: "mode of the building", domain: [0.5, modes + 0.5], ticks: charts.range(1, modes + 1), tickFormat: "d", tickSize: 0 },
    y: { label: "share of the input energy [%]", grid: true, type: "log", domain: [0.01, 100], ticks: [0.01, 0.1, 1, 10, 100], tickFormat: show },
    marks: [
      charts.line(rows, { x: "mode", y: "v", z: "words", stroke: "colour", strokeWidth: 1.2, strokeOpacity: 0.6 }),
      charts.dot(rows, { x: "mode", y: "v", r: 4, fill: "colour", symbol: "symbol", title: (r) => `mode ${r.mode}, ${r.words}: ${show(r.v)} %` }),
    ],
  }));
}

const contactShare = (r) => (r.input_energy_j > 0 ? (100 * r.contact_loss_j) / r.input_energy_j : 0);

// Parts of the input energy up to 100 %, a bar per scene.
function shareFigure(host, scenes) {
  const parts = (r) => {
    const sum = (from, to) => charts.sum(r.mode_share_pct.slice(from - 1, to)), core = r.edcs_pct ?? 0;
    const named = [["mode 1", BLUE, sum(1, 1)], ["modes 2\u20134", SKY, sum(2, 4)], ["modes 5\u201310", GREEN, sum(5, 10)], ["higher modes", PURPLE, sum(11)], ["core", OLIVE, core], ["impacts", ORANGE, contactShare(r)], ["links and tuned mass", "#7a4a9e", r.ed_devices_pct ?? 0], ...(r.plastic_drift_m ? [["storeys that yield", VERMILLION, r.ed_hysteresis_pct]] : [])];
    return [...named, ["other", "#d3d9df", Math.max(0, 100 - charts.sum(named, ([, , v]) => v))]];
  };
  const rows = scenes.flatMap(([scene, r]) => parts(r).map(([part, colour, v]) => ({ scene: SCENES[scene].words, part, colour, v })));
  figure(host, "Where the input energy goes", "Other: what is still kinetic, strain or stored energy at the end.", (width) => chart({
    width, height: 300, marginLeft: 130, ariaLabel: "Where the input energy goes",
    x: { label: "share of the input energy [%]", grid: true }, y: { label: null, domain: scenes.map(([scene]) => SCENES[scene].words) },
    marks: [charts.barX(rows, { x: "v", y: "scene", fill: "colour", title: (r) => `${r.scene}, ${r.part}: ${show(r.v)} %` }), charts.ruleX([0])],
  }), legend(parts(scenes[0][1]).map(([part, colour]) => [part, colour])));
}

function modePart(host, d) {
  const scenes = scenesOf(d), first = scenes.slice(0, 3), r = d.with_core;
  if (!first.length) return;
  host.append(sceneLegend(first.map(([key]) => key)));
  const grid = gridOf(host, 2);
  modeFigure(grid, first, "Energy dissipated by each mode",
    r.ed_hysteresis_pct > 0 ? yieldWords(r) : !r.impacts ? null : "Impacts transfer energy from low modes to high ones, which dissipate it faster.");
  shareFigure(grid, scenes);
}

// What storeys that yield keep: plastic drift at the end, and the drift of the state of rest that follows.
function leftPart(host, scenes, d) {
  const height = (key) => scenes.map(([scene, r]) => [scene, { left: r[key].map((v, j) => (100 * Math.abs(v)) / d.storey_m[j]) }]);
  host.append(sceneLegend(scenes.map(([key]) => key)));
  const grid = gridOf(host, 2);
  peakFigure(grid, height("plastic_drift_m"), "left", "Plastic drift", "plastic drift at the end [% of the height]", 300);
  peakFigure(grid, height("residual_drift_m"), "left", "Residual drift", "drift at rest [% of the height]", 300);
}

// ---- over time
const ENERGIES = [["damped_building", "damping of the building", BLUE], ["damped_core", "damping of the core", GREEN],
  ["contacts", "impacts", ORANGE], ["core", "kinetic and strain energy of the core", PURPLE], ["strain", "strain energy of the building", SKY], ["kinetic", "kinetic energy of the building", GREY]];

function energyFigure(host, title, h, top) {
  const rows = h.t.flatMap((t, i) => {
    let high = 0;
    return ENERGIES.map(([key, , colour]) => ({ t, low: high, high: (high += h.energies[key][i] / 1e6), colour }));
  });
  figure(host, title, null, (width) => chart({
    width, height: 300, ariaLabel: title, x: { label: "time [s]" }, y: { label: "energy [MJ]", grid: true, domain: [0, top], nice: true },
    marks: [
      charts.areaY(rows, { x: "t", y1: "low", y2: "high", z: "colour", fill: "colour" }),
      charts.lineY(h.energies.input, { x: h.t, y: (v) => v / 1e6, stroke: INK, strokeWidth: 1.4 }),
      charts.ruleY([0]),
    ],
  }));
}

const historiesOf = (d) => [["with core", d.history_with_core], ["without core", d.history_no_core]].filter(([, h]) => h?.t.length > 1);

function energyPair(part, d) {
  const host = gridOf(part, 2), all = historiesOf(d), top = charts.max(all, ([, h]) => charts.max(h.energies.input)) / 1e6;
  host.before(legend([...ENERGIES.map(([key, label, colour]) => [key === "contacts" && d.with_core.plastic_drift_m ? "impacts, storeys that yield" : label, colour]), ["input energy", INK]]));
  for (const [scene, h] of all) energyFigure(host, `Energies, ${scene}`, h, top);
}

function displacementPlot(h, limit, width) {
  return chart({
    width, height: 140, marginBottom: 8, marginRight: 20, ariaLabel: "Displacement over time", x: { axis: null, domain: [h.t[0], h.t[h.t.length - 1]] },
    y: { label: "displacement [m]", domain: [-limit, limit], grid: true, ticks: 4 },
    marks: [charts.lineY(h.u, { x: h.t, stroke: INK, strokeWidth: 0.9 })],
  });
}

// Amplitude of u, every dt [s] from t = 0, by frequency and time: |2 integral g u exp(-2 pi i f (t' - t)) dt'| / integral g, g Gauss'
// bell of the standard deviation s = 6 / (2 pi f), as far as 4 s: Morlet's wavelet, by which a steady swing of amplitude a shows as a.
// Beside its samples the signal is taken as zero. The bell and the wave are turned from sample to sample.
function wavelet(u, dt, f, t) {
  return f.flatMap((hz) => {
    const w = 2 * Math.PI * hz, s = 6 / w, a = dt / s, decay = Math.exp(-a * a), [c, d] = [Math.cos(w * dt), Math.sin(w * dt)];
    return t.map((at) => {
      const first = Math.max(0, Math.ceil((at - 4 * s) / dt)), last = Math.min(u.length - 1, Math.floor((at + 4 * s) / dt)), since = first * dt - at;
      let g = Math.exp(-0.5 * (since / s) ** 2), ratio = Math.exp(-a * (since / s + a / 2)), [x, y] = [Math.cos(w * since), Math.sin(w * since)], re = 0, im = 0;
      for (let k = first; k <= last; k++, g *= ratio, ratio *= decay) {
        const before = x;
        re += g * u[k] * x;
        im += g * u[k] * y;
        x = x * c - y * d;
        y = before * d + y * c;
      }
      return (2 * a * Math.hypot(re, im)) / Math.sqrt(2 * Math.PI);
    });
  });
}

// From half the first frequency of the building to beyond its tenth, as far as the samples see; rows are equidistant in the logarithm.
function spectrumOf({ t, u }, hz) {
  const dt = t[1] - t[0], low = 0.5 * hz[0], high = Math.min(1.3 * hz.at(-1), 0.45 / dt);
  const f = charts.range(72).map((i) => low * (high / low) ** (i / 71)), times = charts.range(320).map((k) => (t.at(-1) * k) / 319);
  return { f, amplitude: wavelet(u, dt, f, times) };
}

function spectrumPlot({ f, amplitude }, end, top, hz, width) {
  const low = Math.log10(f[0]), high = Math.log10(f.at(-1)), inside = (list) => list.map(Math.log10).filter((v) => v > low && v < high);
  return chart({
    width, height: 270, marginRight: 20, ariaLabel: "Amplitude by frequency and time",
    x: { label: "time [s]", domain: [0, end] },
    y: { label: "frequency [Hz]", domain: [low, high], ticks: inside([0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500]), tickFormat: (v) => show(10 ** v) },
    color: { scheme: "viridis", type: "sqrt", domain: [0, top], legend: true, label: "amplitude [m]", ticks: [0, top / 4, top], tickFormat: show },
    marks: [
      charts.raster(amplitude, { width: amplitude.length / f.length, height: f.length, x1: 0, x2: end, y1: low, y2: high, imageRendering: "auto" }),
      charts.ruleY(inside(hz), { stroke: "white", strokeOpacity: 0.75, strokeDasharray: "4 4" }),
    ],
  });
}

function spectrumPair(part, d) {
  const host = gridOf(part, 2), all = historiesOf(d), limit = charts.max(all, ([, h]) => charts.max(h.u, Math.abs)), hz = d.building_hz.slice(0, 10);
  const spectra = () => (all.spectra ??= all.map(([, h]) => spectrumOf(h, hz))); // when they are looked at
  all.forEach(([scene, h], k) => {
    const f = figure(host, `Displacement of floor ${d.floor}, ${scene}`, null, (width) => displacementPlot(h, limit, width));
    drawn(f, (width) => spectrumPlot(spectra()[k], h.t.at(-1), charts.max(spectra(), ({ amplitude }) => charts.max(amplitude)), hz, width));
  });
}

// ---- other earthquakes
function otherTable(d) {
  const all = [{ record: d.record, pga_g: d.pga_g, scale: d.scale, stretch: d.stretch, with_core: d.with_core, no_core: d.no_core }, ...d.elsewhere];
  const kept = objectives.map((c, k) => [c, k]).filter(([c]) => c.name !== "mcore_kg");
  const row = (label, words, r) => {
    if (r.objectives) return line([label, words, ...kept.map(([c, k]) => digits((r.objectives[k] ?? NaN) * c.factor)), r.impacts ? count(r.impacts) : ""]);
    const tr = line([label, words, `not simulated: ${r.reason}`]);
    tr.lastChild.colSpan = kept.length + 1;
    return tr;
  };
  return table(null, ["earthquake", "", ...kept.map(([c]) => c), "impacts"],
    all.flatMap((e) => [row(`${shortName(e.record)}, ${peakText(e)}`, "with core", e.with_core), row("", "without core", e.no_core)]));
}

const shortName = (record) => record.replace(/^builtin:(.*)/, "$1 (synthetic)").replace(/.*\//, "");

function otherPart(host, d) {
  host.append(note("The same design under other motions, one at a time. Synthetic motions imitate the record of that name; give recorded ones with --record."), otherTable(d));
  const grid = gridOf(host, 2);
  for (const e of d.elsewhere) {
    const scenes = scenesOf(e);
    if (!scenes.length) continue;
    peakFigure(grid, scenes, "peak_drift_m", `Interstorey drift under ${shortName(e.record)}`, "peak interstorey drift [m]", 300);
    modeFigure(grid, scenes, `Modes under ${shortName(e.record)}`);
    const worse = scenes.length < 2 ? [] : e.with_core.peak_drift_m.flatMap((v, j) => (v > e.no_core.peak_drift_m[j] ? [j + 1] : []));
    if (worse.length) grid.append(element("p", { class: "warn wide" }, `Under ${shortName(e.record)} the drift is larger than without core at floors ${listed(worse, 12)}.`));
  }
}

// ---- which effects it needs
const signed = (v) => (v === null ? "failed" : `${v > 0 ? "+" : v < 0 ? "\u2212" : ""}${show(Math.abs(v) < 0.005 ? 0 : Math.abs(v))}`);

function ladderPart(host, d) {
  const l = d.ladder, keys = LADDER;
  if (l.reason) return host.append(warn(`Not found: ${l.reason}`));
  const changes = (o) => keys.map(([key]) => signed(o[`${key}_pct`]));
  const scene = (key) => line([SCENES[key].words, ...keys.map(([name, , , factor]) => digits((l.by_the_set[key][name] ?? NaN) * factor))]);
  host.append(
    note("Simulated with every effect below, then without each in turn. Needed: leaving it out changes J1, drift ratio or J3 by more than ", keys.map(([key]) => show(l.tolerance[`${key}_pct`])).join(", "), " %, which is 2 % or the scatter as built. imtet check --ladder repeats it with the steps and the whole record, and says what each costs.",
      l.with_all.hardening > 0 ? " With all, storeys that yield keep " + show(100 * l.with_all.hardening) + " % of their stiffness, which P-delta may raise." : ""),
    table("ladder", ["without", ...keys.map(([, title]) => `${title} [%]`), "verdict", "most in", "in this run"],
      l.effects.map((e) => line([e.without, ...changes(e), e.verdict, SCENES[e.most_in].words, e.is_set], { class: e.verdict === "needed" && "knee" }))),
    element("p", `These settings are enough (J1 ${changes(l.enough)[0]}, drift ratio ${changes(l.enough)[1]}, J3 ${changes(l.enough)[2]} % off the model with all):`),
    element("pre", { tabindex: "0" }, Object.entries(l.settings).map(([key, value]) => `${key} = ${value}`).join("\n")),
    table("enough", ["with these settings", ...keys.map(([, title, unit]) => `${title} [${unit}]`)], ["with_core", "rigid", "no_core"].map(scene)));
}

// ---- all of it
// Of any design: `d` as report_json.h describes it, into `host`; isBeside: its gaps are shown already.
function detailParts(host, d, isBeside = false) {
  const r = d.with_core, scenes = scenesOf(d);
  const notes = d.baselines.filter((b) => b.objectives && SCENES[b.key].note).map((b) => `${SCENES[b.key].note}${b.device && ` (${b.device})`}.`).join(" ");
  if (r.objectives) host.append(element("p", `Protected by ${d.protection}: ${count(r.impacts)} impacts dissipated ${show(contactShare(r))} % of the input energy of ${show(r.input_energy_j / 1e6)} MJ.`));
  host.append(loadTable(d), note(notes));
  shapeFigures(host, d, isBeside);
  forceFigures(host, d);
  modePart(host, d);
  if (r.plastic_drift_m) leftPart(host, scenes, d);
  if (d.ladder) ladderPart(folded(host, "Which effects it needs", true), d);
  if (historiesOf(d).length) {
    const energies = folded(host, "Energies over time");
    energies.append(note("Stacked: the parts add up to the input energy so far. Shown until the displacement stays below 2 % of its peak." +
      (r.plastic_drift_m ? " Strain is that of storeys which do not yield; what it has too much is taken off the part of those that do." : "")));
    energyPair(energies, d);
    const over = folded(host, "Displacement over time");
    over.append(note("Below each history its Morlet wavelet amplitude by frequency, the same colours on both sides; dashed: natural frequencies of the building."));
    spectrumPair(over, d);
  }
  if (d.elsewhere.length) otherPart(folded(host, "Other earthquakes"), d);
}

// As found, and as `imtet simplify` made it for the site: what is 10 m wide is no stop.
function pairTable(pair) {
  const row = (c, values) => line([titleUnit(c), ...values.map((v) => (c.name.startsWith("gap") && v >= NO_STOP_M ? "no stop" : digits(v * c.factor)))]);
  return table("pair", ["", `as found, design ${pair[0].id}`, `to be built, design ${pair[1].id}`],
    [...objectives.map((c, k) => row(c, pair.map((d) => d.f[k]))), ...variables.map((c, j) => row(c, pair.map((d) => d.x[j])))]);
}

function designPart() {
  const host = byId("design"), d = run.detail;
  if (!d) return host.remove();
  host.querySelector("h2").textContent = `Design ${run.chosen}${run.chosen === run.knee ? ", the knee" : ""}`;
  host.append(note("Simulated again with the run\u2019s settings; its peaks are on the first screen. For another design: imtet report ", run.id_step ? run.folder.replaceAll(" + ", " ") : run.folder, " --design ID"));
  if (run.pair) folded(host, "As found and to be built", true).append(pairTable(run.pair));
  detailParts(host, d);
}
