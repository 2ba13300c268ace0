"use strict";
// The run as the page holds it: columns of numbers, and what each is called and measured in.

const run = JSON.parse(document.getElementById("run").textContent);
const lines = document.getElementById("rows").textContent.trim().split("\n").filter((line) => line);
const n = lines.length;

// Names of the tower's columns: title, unit, and by what a number is multiplied for the eye. Files keep their own units.
const WORDS = {
  j1_m: ["J1 displacement", "m", 1, "peak floor displacement"],
  j2_m: ["J2 interstorey drift", "m", 1, "peak interstorey drift"],
  j3_g: ["J3 acceleration", "g", 1, "peak absolute floor acceleration"],
  ed1_pct: ["mode 1", "%", 1, "share of the input energy dissipated by mode 1"],
  ed5_10_pct: ["modes 5\u201310", "%", 1, "share of the input energy dissipated by modes 5 to 10"],
  edcs_pct: ["core share", "%", 1, "share of the input energy dissipated by the core"],
  mcore_kg: ["core mass", "t", 1e-3, "mass of the core"],
  t_base_m: ["t base", "mm", 1e3, "thickness of the core, first storey"],
  t_top_m: ["t top", "mm", 1e3, "thickness of the core, last storey"],
  side_m: ["side of the core", "m", 1, "outer side of the core's box"],
};

function words(name, unit, what) {
  const gap = run.tower && name.match(/^gap_0*(\d+)_m$/);
  if (gap) return [`gap ${gap[1]}`, "mm", 1e3, `gap at floor ${gap[1]}`];
  const zone = run.tower && name.match(/^gap(?:_zone_(\d+))?_m$/);
  if (zone) return [zone[1] ? `gap, zone ${zone[1]}` : "gap", "mm", 1e3, zone[1] ? `gap at the floors of zone ${zone[1]}` : "gap at every floor"];
  const bumper = run.tower && name.match(/^bumper(?:_(zone_)?0*(\d+))?_log10_n_m$/);
  if (bumper) {
    const where = bumper[2] ? `${bumper[1] ? "zone" : "floor"} ${bumper[2]}` : "every floor";
    return [bumper[2] ? `bumper, ${where}` : "bumper", "log10 N/m", 1, `stiffness of the bumper at ${where}, decimal logarithm`];
  }
  if (run.tower && WORDS[name]) return WORDS[name];
  return [name, unit === "-" ? "" : unit, 1, what];
}

function columnOf(name, place, sense, givenUnit = "", givenWhat = name) {
  const [title, unit, factor, what] = words(name, givenUnit, givenWhat);
  return { name, title, unit, factor, what, sense, place, raw: new Float64Array(n), value: new Float64Array(n) };
}

const nVar = run.schema.variables.length;
const variables = run.schema.variables.map((name, j) => columnOf(name, 1 + j, 0));
const objectives = run.schema.objectives.map(({ name, sense, unit, what }, k) => columnOf(name, 1 + nVar + k, sense, unit, what));
const columns = [...objectives, ...variables];
const ids = new Float64Array(n);

for (let i = 0; i < n; i++) {
  const cells = lines[i].split(",");
  ids[i] = +cells[0];
  for (const c of columns) {
    c.raw[i] = +cells[c.place];
    c.value[i] = c.raw[i] * c.factor;
  }
}
for (const c of columns) {
  c.min = Infinity;
  c.max = -Infinity;
  for (const v of c.value) {
    if (v < c.min) c.min = v;
    if (v > c.max) c.max = v;
  }
}
// Columns that are numbered, as the gaps are, share one scale.
const groups = new Map();
for (const c of columns) {
  const stem = c.name.replace(/\d+/g, "#");
  const group = groups.get(stem) ?? { low: Infinity, high: -Infinity };
  group.low = Math.min(group.low, c.min);
  group.high = Math.max(group.high, c.max);
  groups.set(stem, (c.group = group));
}
const rowOf = new Map(Array.from(ids, (id, i) => [id, i]));

// ---- words and numbers

// Three or four digits, never an exponent where a person would not write one.
function show(v) {
  if (v === null || v === undefined || !Number.isFinite(v)) return "\u2013";
  const size = Math.abs(v);
  if (v === 0) return "0";
  if (size >= 1e6 || size < 1e-4) return v.toExponential(2).replace("e+", "e");
  return String(+v.toPrecision(size >= 1000 ? 4 : 3));
}

// The same with all its digits, for columns.
function digits(v) {
  return v === null || !Number.isFinite(v) || v === 0 || Math.abs(v) >= 1000 || Math.abs(v) < 1e-4 ? show(v) : v.toPrecision(3);
}

const withUnit = (c, v) => show(v) + (c.unit ? `\u202f${c.unit}` : "");
const count = (v) => v.toLocaleString("en-US");

function element(tag, attributes = {}, ...children) {
  const e = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) e.addEventListener(key.slice(2), value);
    else if (value === true) e.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) e.setAttribute(key, value);
  }
  e.append(...children.filter((c) => c !== null && c !== undefined));
  return e;
}

const heading = (c) => [c.title, ...(c.unit ? [element("small", {}, c.unit)] : [])];

// ---- colours: Okabe and Ito's, and viridis without its palest end

const BLUE = "#0072b2", VERMILLION = "#d55e00", OLIVE = "#8a6d00", ORANGE = "#e69f00", SKY = "#56b4e9", GREEN = "#009e73",
  PURPLE = "#cc79a7", GREY = "#9aa4af", INK = "#1b2430";
const RAMP = Array.from({ length: 32 }, (_, i) => charts.interpolateViridis((0.92 * i) / 31));
const SHADES = RAMP.length;
