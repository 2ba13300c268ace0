"use strict";
// The run as the page holds it: columns of numbers, and what each is called and measured in.
const byId = (id) => document.getElementById(id), finite = Number.isFinite, root = document.documentElement;
const run = JSON.parse(byId("run").textContent);
const lines = byId("rows").textContent.trim().split("\n").filter((line) => line);
const n = lines.length, blank = Array.from(document.body.children, (e) => (e.tagName === "SCRIPT" ? "" : e.outerHTML)).join("\n"); // of the page before anything is drawn

// ---- columns: titles and units of objectives come with the run, those of the tower's variables follow from their names
const SINGLE = {
  t_base_m: ["t base", "mm", 1e3, "thickness of the core, first storey"],
  t_top_m: ["t top", "mm", 1e3, "thickness of the core, last storey"],
  side_m: ["side of the core", "m", 1, "outer side of the core's box"],
  tuned_mass_kg: ["tuned mass", "t", 1e-3, "mass of the tuned mass at the roof"],
  tuned_mass_hz: ["tuned to", "Hz", 1, "frequency of the tuned mass"],
  tuned_mass_damping: ["damping of the tuned mass", "%", 100, "damping of the tuned mass, of critical"],
};
const NUMBERED = {
  gap: ["mm", 1e3, "gap"],
  bumper: ["log10 N/m", 1, "stiffness of the bumper, decimal logarithm,"],
  link: [/^link_exponent = 1$/m.test(run.settings) ? "MN s/m" : "MN (s/m)^a", 1e-6, "dashpot between floor and core"],
  friction: ["MN", 1e-6, "force at which floor and core slip"],
  device: ["", 1, "device"],
};

function variableWords(name) {
  const [, stem, side, zone, number, roof] = (run.tower && name.match(/^([a-z]+)(?:_(left|right))?(?:_(zone_)?0*(\d+)|_(roof))?(?:_(?:log10_n_m|n_s_m|n|m))?$/)) || [];
  if (!NUMBERED[stem]) return (run.tower && SINGLE[name]) || [name, "", 1, name];
  const where = number ? `${zone ? "zone" : "floor"} ${number}` : roof ? "the roof" : "every floor", [unit, factor, what] = NUMBERED[stem];
  const title = `${stem}${side ? ` ${side}` : ""}${number ? (zone ? `, zone ${number}` : ` ${number}`) : roof ? ", roof" : ""}`;
  return [title, unit, factor, `${what}${side ? ` ${side}` : ""} at ${where}${side ? `: how far the floor may go to the ${side}` : ""}`];
}

const columnOf = (name, place, sense, [title, unit, factor, what]) => ({ name, title, unit, factor, what, sense, place, raw: new Float64Array(n), value: new Float64Array(n) });
const nVar = run.schema.variables.length;
const variables = run.schema.variables.map((name, j) => ({ ...columnOf(name, 1 + j, 0, variableWords(name)), words: run.schema.words[j] })); // words of a choice
const results = [...run.schema.objectives, ...run.schema.limited].map((o, k) => columnOf(o.name, 1 + nVar + k, o.sense, [o.title, o.unit, o.factor, o.what]));
const objectives = results.slice(0, run.schema.objectives.length); // behind them what search.limits limits beside them
const columns = [...results, ...variables];
const ids = new Float64Array(n);
for (const c of objectives) c.error = new Float64Array(n).fill(NaN);

for (let i = 0; i < n; i++) {
  const cells = lines[i].split(",");
  ids[i] = +cells[0];
  for (const c of columns) {
    c.raw[i] = c.words ? c.words.indexOf(cells[c.place]) : +cells[c.place];
    c.value[i] = c.raw[i] * c.factor;
  }
  // Behind the columns: likely errors, where they are stored with the designs.
  objectives.forEach((c, k) => { if (cells[1 + columns.length + k]) c.error[i] = c.factor * cells[1 + columns.length + k]; });
}
const rowOf = new Map(Array.from(ids, (id, i) => [id, i]));
const beyondLaw = new Set(run.beyond_law);
// Columns that are numbered, as the gaps are, share one scale.
const families = [...charts.group(columns, (c) => c.name.replace(/\d+/g, "#")).values()];
for (const family of families) for (const c of family) c.family = family;
const capital = (text) => text[0].toUpperCase() + text.slice(1);
const stemOf = ([first]) => first.title.replace(/[, ]+(zone )?\d+$/, ""), placeOf = ([first]) => (!run.tower ? "" : /zone/.test(first.title) ? "zone" : "floor");

// Bounds of the search, in the units of the eye; -1, 0, 1: whether a value lies at one of them.
variables.forEach((c, j) => {
  const b = run.schema.bounds;
  c.bounds = b && !c.words ? [b.lower[j] * c.factor, b.upper[j] * c.factor] : [NaN, NaN];
});
function atBound(c, v) {
  const [low, high] = c.bounds ?? [NaN, NaN], near = 1e-3 * (high - low);
  return v <= low + near ? -1 : v >= high - near ? 1 : 0;
}

// ---- words and numbers
// A tick of a column's axis.
const tickText = (c) => (v) => (c.words ? (c.words[v] ?? "") : show(v));

// Three or four digits, never an exponent where a person would not write one.
function show(v) {
  if (v === null || v === undefined || !finite(v)) return "\u2013";
  const size = Math.abs(v);
  if (v === 0) return "0";
  if (size >= 1e6 || size < 1e-6) return v.toExponential(2).replace(/e\+?/, "\u00b710^");
  return String(+v.toPrecision(size >= 1000 ? 4 : 3));
}

// The same with all its digits, for columns.
const digits = (v) => v === null || !finite(v) || v === 0 || Math.abs(v) >= 1000 || Math.abs(v) < 1e-6 ? show(v) : v.toPrecision(3);
// A value of design i with its likely error, where one is known.
const known = (c, i) => (c.words ? c.words[c.value[i]] : finite(c.error?.[i]) ? figureText(c.value[i], c.error[i]) : digits(c.value[i]));
const withUnit = (c, v) => show(v) + (c.unit ? `\u202f${c.unit}` : "");
const titleUnit = (c) => c.title + (c.unit ? ` [${c.unit}]` : "");
const count = (v) => v.toLocaleString("en-US");

function element(tag, first, ...rest) {
  const [attributes, ...children] = first?.constructor === Object ? [first, ...rest] : [{}, first, ...rest];
  const e = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) e.addEventListener(key.slice(2), value);
    else if (key === "style") e.style.cssText = value; // as an attribute the policy refuses it
    else if (value === true) e.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) e.setAttribute(key, value);
  }
  e.append(...children.filter((c) => c !== null && c !== undefined));
  return e;
}

const div = (name, ...inside) => element("div", { class: name }, ...inside);
const note = (...words) => element("p", { class: "note" }, ...words), warn = (...words) => element("p", { class: "warn" }, ...words);
const heading = (c) => [c.title, ...(c.unit ? [element("small", c.unit)] : [])];

// ---- colours: Okabe and Ito's, and viridis without its palest end
const BLUE = "#0072b2", VERMILLION = "#d55e00", OLIVE = "#8a6d00", ORANGE = "#e69f00", SKY = "#56b4e9", GREEN = "#009e73",
  PURPLE = "#cc79a7", GREY = "#9aa4af", SHADES = 32, PALETTE = [BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, OLIVE, GREY];

// Light or dark, as the system has it or the address says; of the style sheet what canvases draw with.
const ownTheme = !run.paper && matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
let INK, PAPER, PALE, AXIS, RAMP;
const ramp = (t) => charts.interpolateViridis(root.dataset.theme === "dark" ? 0.15 + 0.85 * t : 0.92 * t);
function takeTheme(name) {
  root.dataset.theme = name;
  const style = getComputedStyle(root);
  [INK, PAPER, PALE, AXIS] = ["ink", "paper", "pale", "axis"].map((word) => style.getPropertyValue(`--${word}`).trim());
  RAMP = Array.from({ length: SHADES }, (_, i) => ramp(i / (SHADES - 1)));
}
takeTheme(ownTheme);

// ---- the chosen design and what it is compared with
const SCENES = {
  with_core: { words: "with core", colour: BLUE, mark: "\u25cf", symbol: "circle", dash: [] },
  no_core: { words: "without core", colour: VERMILLION, mark: "\u25c6", symbol: "diamond2", dash: [8, 4] },
  rigid: { words: "rigidly connected", colour: OLIVE, mark: "\u25b2", symbol: "triangle", dash: [3, 3], note: "Rigidly connected: floors and core move together without a gap" },
  tmd: { words: "tuned mass damper", colour: GREEN, mark: "\u25a0", symbol: "square", dash: [12, 4], note: "Tuned mass damper: the core\u2019s mass on a spring and a dashpot at the roof" },
  links: { words: "viscous links", colour: PURPLE, mark: "\u2605", symbol: "star", dash: [2, 4], note: "Viscous links: a dashpot between every floor and the core" },
};

// Beside the designs in every picture of the front: a value per column, in the units of the eye, NaN where there is none.
// What is pushed here is drawn after the next layoutChanged.
const overlaysOf = (detail) => (detail?.baselines ?? []).filter((b) => b.objectives).map((b) => ({
  ...SCENES[b.key], key: b.key, isShown: true, raw: b.objectives, better: b.better, device: b.device,
  value: new Map(objectives.map((c, k) => [c, b.objectives[k] === null ? NaN : b.objectives[k] * c.factor])),
}));
const TRIAL = "#c2185b", kept = JSON.parse(byId("kept-designs")?.textContent ?? "[]"); // of what-if: { name, id: of one that the run has, x, ground, raw: objectives, and what the simulation said }
const overlayOf = ({ name, x, raw }, mark = "\u25c7") => ({
  key: name, words: name, colour: TRIAL, mark, symbol: "diamond2", dash: mark === "\u25c7" ? [2, 3] : [], isShown: true, raw,
  value: new Map([...objectives.map((c, k) => [c, (raw[k] ?? NaN) * c.factor]), ...variables.map((c, j) => [c, x[j] * c.factor])]),
});
const isLikeRun = ({ whole, ...others }) => !Object.values(others).some(Boolean) && (whole || !run.robust); // comparable with its front
const overlays = [...overlaysOf(run.detail), ...kept.filter(({ ground }) => isLikeRun(ground)).map((one) => overlayOf(one))];
const takeOverlay = (key) => overlays.some((o, k) => o.key === key && overlays.splice(k, 1));
const shownOverlays = () => overlays.filter((o) => o.isShown);

// Ends of a column's scale: of the designs that are kept (c.low, c.high; of all numbered columns alike together), and of what
// is shown beside them.
const extent = (c, beside = shownOverlays()) => charts.extent([...(c.sense ? [c] : c.family).flatMap(({ low, high }) => [low, high]), ...beside.map((o) => o.value.get(c))]);

// Values of a column that as many designs lie between, from one end of its scale to the other.
function percentiles(c, low, high) {
  const sorted = Float64Array.from(c.value).filter(finite).sort(), inner = Array.from({ length: 19 }, (_, k) => sorted[Math.round(((k + 1) * (sorted.length - 1)) / 20)]);
  return [...new Set([low, ...inner.filter((v) => v > low && v < high), high])];
}

function scaleOf(c, from, to, pad) {
  if (c.words) return Object.assign(charts.scaleLinear([-0.3, c.words.length - 0.7], [from, to]), { ticks: () => c.words.map((_, k) => k) });
  const [low, high] = extent(c);
  const spread = state.percent.has(c) ? percentiles(c, low, high) : [];
  if (spread.length > 2) {
    const scale = charts.scaleLinear(spread, spread.map((_, k) => from + ((to - from) * (k + pad)) / (spread.length - 1 + 2 * pad)));
    return Object.assign(scale, { ticks: () => spread.filter((_, k) => k % Math.ceil(spread.length / 10) === 0) });
  }
  if (state.log.has(c) && low > 0) {
    const room = (high / low) ** pad;
    return charts.scaleLog([low / room, high * room], [from, to]);
  }
  const room = high > low ? pad * (high - low) : 0.5 * Math.abs(high) || 0.5;
  return charts.scaleLinear([low - room, high + room], [from, to]);
}

// Of a logarithmic scale those that begin with 1, 2 or 5 where all are too many.
function ticksOf(scale, many) {
  const ticks = scale.ticks(many);
  return ticks.length <= 2 * many ? ticks : ticks.filter((v) => /^[125]/.test(v.toExponential(3)) && /^.\.000/.test(v.toExponential(3)));
}
