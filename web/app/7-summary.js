// The first screen: what was studied and found, in a sentence, a picture and warnings; then growth and provenance.
// As in the program's own output: the peak, and what the record was multiplied by.
const peakText = (d) => `peak ${show(d.pga_g)} g` +
  (d.scale === 1 && d.stretch === 1 ? ", as recorded" : ` (${show(d.pga_g / d.scale)} g \u00d7 ${show(d.scale)}, time \u00d7 ${show(d.stretch)})`);

// ---- in a sentence
function change(value, before) {
  const exact = (100 * (value - before)) / before, pct = Math.abs(exact) < 1 ? Math.round(10 * exact) / 10 : Math.round(exact);
  if (pct === 0 || value === before) return "the same";
  return value > 2 * before ? (value > 50 * before ? `${show(before)} with` : `${show(value / before)} times`) : `${pct > 0 ? "+" : "\u2212"}${Math.abs(pct)} %`;
}

// The likely errors of the chosen design.
const chosenError = () => run.chosen_error ?? (run.rule ? null : run.detail?.error);

function sentence(d) {
  const whose = run.chosen === run.knee ? `the knee (design ${run.chosen})` : `design ${run.chosen}`;
  const done = `${run.evaluated ? `${count(run.evaluated)} designs ${d ? "simulated" : "evaluated"}, ${count(run.failed)} failed; ` : ""}${count(run.front)} on the front${run.front > n ? `, ${count(n)} of them on this page` : ""}`;
  if (!d) return `${done}. ${whose[0].toUpperCase()}${whose.slice(1)} is nearest to the best of every objective.`;
  const more = run.rule ? `; every objective is the ${run.rule}` : "";
  return `A building of ${d.gap_m.length} storeys, ${show(charts.sum(d.storey_m))} m (${run.building.replace(/.*\//, "")}) under ${shortName(d.record)}, ${peakText(d)}, core inside, protected by ${d.protection}: ${done}${more}. Shown: ${whose}.`;
}

// ---- cards: the objectives of the chosen design, better or worse than what it is compared with
const VERDICT = { "-1": ["worse", "\u2716"], 0: ["same", "="], 1: ["better", "\u2714"] };

// The value, and behind it in small what is not known of it and the unit.
function shownValue(c, value, error) {
  const v = value * c.factor, isNothing = c.unit === "%" && v < 0 && v > -0.05; // a share of -0.0066 %
  const [known, rest] = value === null ? ["failed"] : figureText(isNothing ? 0 : v, error === null ? NaN : error * c.factor).split(/(?= \u00b1)/);
  return [known, " ", element("small", `${rest ? rest.trim() + " " : ""}${c.unit}`)];
}

// How far the number would be from that of the next suite: not an error of comparisons, which are under the same records.
const bySuite = (c, error) => (error > 0 ? element("div", { class: "change", title: "Standard error of this number over the records, by the bootstrap." },
  `records \u00b1 ${+(error * c.factor).toPrecision(2)} `, element("small", c.unit)) : "");

function cards() {
  const raw = run.chosen_f, error = chosenError();
  const against = (c, k, o) => {
    const [kind, sign] = VERDICT[o.better[k]] ?? [];
    if (!kind) return "";
    return element("div", { class: `change ${kind}`, title: `${kind} than ${o.words}: ${withUnit(c, o.raw[k] * c.factor)}` }, `${sign} ${change(raw[k] * c.factor, o.raw[k] * c.factor)} `, element("small", o.key === "no_core" ? "no core" : "rigid"));
  };
  return div(objectives.length > 8 ? "cards many" : "cards", ...objectives.map((c, k) => element("div", { class: "card", title: c.what },
    div("what", c.title, element("span", { title: c.sense > 0 ? "less is better" : "more is better" }, c.sense > 0 ? " \u2193" : " \u2191")),
    div("value", ...shownValue(c, raw[k], error?.[k])),
    bySuite(c, run.detail?.standard_error?.[k]),
    ...(run.tower && !run.detail ? [skeleton(24)] : overlays.filter((o) => ["no_core", "rigid"].includes(o.key)).map((o) => against(c, k, o))))));
}

// ---- warnings
const listed = (words, most = 8) => words.slice(0, most).join(", ") + (words.length > most ? ` and ${words.length - most} more` : "");

function boundWarning(d) {
  const gaps = variables.filter((c) => /^gap_/.test(c.name)), many = charts.range(n).filter((i) => gaps.some((c) => atBound(c, c.value[i]))).length;
  const shut = (d.with_core.closings ?? []).flatMap((hits, j) => (hits || (d.gap_m[j] ?? NO_STOP_M) >= NO_STOP_M ? [] : [j + 1]));
  return [many ? `Gaps at a bound of the search in ${count(many)} of ${count(n)}` + " designs of the front. A wider box may hold better designs, unless such a gap never closes." : "",
    shut.length ? `Gaps that never close${underRecord(d) || " under this motion"}: ${shut.length === 1 ? "floor" : "floors"} ${listed(shut, 12)}.` : ""];
}

const yieldWords = (r) => `Storeys that yield dissipate ${show(r.ed_hysteresis_pct)} %` + " of the input energy: the modes are those of the elastic building, and their shares say little.";
// Behind what was found under one record, where the numbers are of several.
const underRecord = (d) => (run.rule ? ` under ${shortName(d.record)}` : "");

const LADDER = [["j1_m", "J1", "m", 1], ["drift_ratio", "drift ratio", "%", 100], ["j3_g", "J3", "g", 1]];
function warnings(d) {
  const all = [
    d.with_core.reason ? ["worse", `This design could not be simulated: ${d.with_core.reason}`] : null,
    d.with_core.ed_hysteresis_pct > 0 && objectives.some((c) => /^ed\d/.test(c.name)) ? ["note", yieldWords(d.with_core) + " Do not choose by mode shares."] : null,
    d.with_core.beyond_law ? ["worse", "The maximum indentation is more than a tenth of the contact\u2019s radius, beyond the range of the contact law."] : null,
    beyondLaw.size ? ["note", `${count(beyondLaw.size)} of ${count(n)}` + " designs of the front are beyond the contact law (\u26a0 in the table)."] : null,
    ...boundWarning(d).filter(Boolean).map((text) => ["note", text]),
    run.evaluated && run.failed > 0.05 * run.evaluated ? ["note", `${count(run.failed)} of ${count(run.evaluated)} simulations failed (imtet status says why).`] : null,
  ].filter(Boolean);
  return all.length ? element("ul", { class: "warnings", "aria-label": "Warnings" }, ...all.map(([kind, text]) => element("li", { class: kind }, element("span", { "aria-hidden": "true" }, kind === "worse" ? "\u2716 " : "\u26a0 "), text))) : "";
}

// What the design has to bear, beside its baselines; without what this scene has not.
function loadTable(d) {
  const scenes = scenesOf(d), kept = run.borne.filter(({ name }) => scenes.some(([, r]) => r[name]));
  return table("loads", ["demand", ...kept], scenes.map(([key, r]) => line([SCENES[key].words + underRecord(d), ...kept.map(({ name, factor }) => (r[name] === null ? "" : digits(r[name] * factor)))])));
}

function standoutTable() {
  const knee = rowOf.get(run.knee), valuesOf = (i) => objectives.map((c) => known(c, i));
  const best = (c, k) => {
    const row = charts.minIndex(c.raw, (v) => c.sense * v), tr = line([`best ${c.title}`, String(ids[row]), ...valuesOf(row)]);
    tr.children[2 + k].className = "best";
    return tr;
  };
  return table("standouts", ["stands out by", "design", ...objectives], [
    line(["knee", String(run.knee), ...valuesOf(knee)], { class: "knee" }), ...objectives.map(best),
    ...overlays.map((o) => line([o.device ? `${o.words} (${o.device})` : o.words, "", ...objectives.map((c) => digits(o.value.get(c)))]))]);
}

// Where the knee in detail is still to come, its place is kept: nothing moves when it does.
const skeleton = (height) => element("div", { class: "skeleton", "aria-hidden": "true", style: `height: ${height}px` });

function summaryPart() {
  const d = run.detail, waits = run.tower && !d, host = byId("summary");
  document.title = `${run.name} \u2013 imtet`;
  byId("title").textContent = `Study ${run.name}`;
  host.append(element("p", { class: waits ? "lead waits" : "lead", id: "subtitle" }, sentence(d)), ...(d?.verdict?.match(/.+/g) ?? []).map((text) => element("p", { class: "verdict" }, text)), d ? warnings(d) : waits ? skeleton(285) : "", cards());
  if (run.notes_fault) host.append(warn(`Notes: ${run.notes_fault}`));
  if (d && run.rule) host.append(note("The numbers are the " + run.rule + "; the charts below are one simulation of it as designed, under " + `${shortName(d.record)}${d.records > 1 ? `; the band spans all ${d.records} records` : " alone"}.`));
  if (d) peakPart(host, d, 220);
  if (waits) host.append(element("p", { class: "note", role: "status" }, "Simulating this design and what it is compared with\u2026"), skeleton(252));
  const more = folded(host, "The best designs of the front, beside the baselines");
  more.append(note("The knee is nearest to the best of everything, with every objective scaled over the front."), standoutTable());
  if (d && run.robust) more.append(note("Objectives are those of several simulations of every design (motion.records, sim.replicates, sim.robust among the settings), standard deviations those of " +
    `${run.spread === "as built" ? "structures as built" : "predictability (chaos alone)"}; the chosen design is shown as one simulation under ${shortName(d.record)}.`));
}

let drawGrowth = () => {}; // anew, while a run goes on
function growthRows() {
  const c = run.convergence;
  return c.simulated.map((x, i) => ({ x, y: 100 * c.volume[i], e: 200 * (c.error[i] ?? 0), colour: BLUE }));
}
function growthPart() {
  const host = byId("growth"), last = growthRows().at(-1);
  if (run.convergence.simulated.length < 2) return host.remove();
  const figure = host.appendChild(element("figure"));
  drawGrowth = drawn(figure, (width) => growthChart(width, 200, growthRows()));
  figure.append(element("figcaption", "Share of a box that the designs so far dominate, in every objective from the worst of the first sample to a fifth of its range beyond the best " +
    `(imtet status shows the same); at the end ${show(last.y)} \u00b1 ${show(last.e / 2)}` + " % (standard error of the estimate; band: twice that). A curve that still climbs asks for a longer run."));
}

// All that provenance.json holds, flat, but for how the model was chosen.
function provenancePart() {
  const { model, ...made } = JSON.parse(run.provenance || "{}");
  if (model) ladderPart(folded(byId("provenance"), "The model that the study chose"), { ladder: model });
  const facts = (made) => Object.entries(made).flatMap(([key, v]) => (v instanceof Object ? facts(v) : [element("dt", key), element("dd", String(v))]));
  byId("provenance").append(element("dl", ...facts({ folder: run.folder, page: `imtet ${run.version} (${run.revision})`, ...made })),
    element("details", element("summary", "Every setting"), element("pre", { tabindex: "0" }, run.settings)));
}

// Links to the parts that this run has; the address keeps the state of the pictures.
function contents() {
  const names = [["summary", `Study ${run.name}`], ["front", "Front"], ["growth", "Growth"], ["design", `Design ${run.chosen}`], ["provenance", "Provenance"]];
  const skip = linkTo(byId("front"), "Skip to the front"), theme = plainButton("", () => {
    state.theme = state.theme === "dark" ? "light" : "dark";
    showTheme(state.theme);
  }, { id: "theme" });
  skip.className = "skip";
  views.layout.push(() => (theme.textContent = state.theme === "dark" ? "Light" : "Dark"));
  byId("parts").append(skip, ...names.filter(([id]) => byId(id)).map(([id, text]) => linkTo(byId(id), text)), theme);
}

// The focus goes along.
function goTo(part) {
  part.setAttribute("tabindex", "-1");
  part.focus({ preventScroll: true });
  part.scrollIntoView({ behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "instant" : "smooth" });
}

const linkTo = (part, text) => element("a", { href: `#${part.id}`, onclick: (event) => {
  event.preventDefault();
  goTo(part);
} }, text);
