// Which designs are looked at and how: one state for all pictures, in the page's address too; one frame for every change.
const state = {
  axes: [...results], // of the parallel coordinates, from left to right
  inverted: new Set(), // columns with their better, or larger, side up
  log: new Set(), percent: new Set(),
  x: objectives[0],
  y: objectives[Math.min(1, objectives.length - 1)],
  colour: objectives[objectives.length - 1],
  ranges: new Map(), // column -> [low, high] in the units of the eye
  steps: [], // [{ keep, ranges }]: what was kept and excluded before
  kept: new Uint8Array(n).fill(1),
  nKept: n,
  selected: new Uint8Array(n).fill(1),
  nSelected: n,
  marked: rowOf.get(run.chosen),
  theme: ownTheme,
  weights: new Map(), // column -> weight of the choice
  reference: new Map(), // column -> value of the reference point, in the units of the eye
  hovered: undefined, // row under the pointer
};

// What is drawn anew when the selection, the axes or colours, and the design under the pointer changed. While a range is
// dragged, what is in sight follows as far as a frame lasts; all of it follows REST_MS after the last change.
const views = { selection: [], layout: [], hover: [] };
const REST_MS = 100;
let resting; // timer; undefined: at rest

// `host` null: too small to wait.
const follow = (host, draw) => views.selection.push({ host, draw });

function isInSight({ host }) {
  const box = host?.getBoundingClientRect();
  return !host || (box.height > 0 && box.bottom > 0 && box.top < window.innerHeight);
}

function redrawAll() {
  for (const { draw } of views.selection) draw();
  saveAddress();
}

function rest() {
  clearTimeout(resting);
  resting = undefined;
  redrawAll();
  delete root.dataset.busy;
}
window.addEventListener("beforeprint", rest);

// Marks 1 in `out` where `from` is 1 and every range holds; returns how many.
function within(ranges, from, out) {
  out.set(from);
  for (const [c, [low, high]] of ranges) {
    const { value } = c;
    for (let i = 0; i < n; i++) if (!(value[i] >= low && value[i] <= high)) out[i] = 0;
  }
  return charts.sum(out);
}

const findSelected = () => (state.nSelected = within(state.ranges, state.kept, state.selected));

function findKept() {
  const { kept } = state, hit = new Uint8Array(n);
  kept.fill(1);
  for (const { keep, ranges } of state.steps) {
    within(ranges, kept, hit);
    for (let i = 0; i < n; i++) kept[i] = keep ? hit[i] : kept[i] & ~hit[i];
  }
  state.nKept = charts.sum(kept);
  for (const c of columns) [c.low, c.high] = charts.extent(c.value, (v, i) => (kept[i] ? v : NaN));
  findSelected();
}

let waiting = false;
function selectionChanged() {
  if (waiting) return;
  waiting = true;
  root.dataset.busy = "yes";
  requestAnimationFrame(() => {
    waiting = false;
    findSelected();
    clearTimeout(resting);
    resting = setTimeout(rest, REST_MS);
    for (const { draw } of views.selection.filter(isInSight)) draw();
  });
}

function layoutChanged() {
  for (const draw of views.layout) draw();
  redrawAll();
}

// Ranges given as null are taken away.
function setRanges(pairs) {
  for (const [c, range] of pairs) {
    if (range) state.ranges.set(c, range);
    else state.ranges.delete(c);
  }
  selectionChanged();
}

// The selected designs alone from now on, or all but them; scales follow. Nothing left: not done.
function takeStep(keep) {
  if (!state.ranges.size || state.nSelected === (keep ? 0 : state.nKept)) return;
  state.steps.push({ keep, ranges: new Map(state.ranges) });
  state.ranges.clear();
  findKept();
  layoutChanged();
}

function dropSteps() {
  state.steps = [];
  findKept();
  layoutChanged();
}

function mark(row) {
  state.marked = row;
  openDrawer(row);
  redrawAll();
}

// at: where the picture is, so that what is said of a design lies below it and not over an axis.
function hover(row, event, at) {
  if (row !== state.hovered) {
    state.hovered = row;
    for (const draw of views.hover) draw();
  }
  showTip(row, event, at);
}

// The designs of a picture by keys, in the order of the colour's column.
function byKeys(layers) {
  layers.addEventListener("keydown", (event) => {
    if (event.target !== layers) return;
    const rows = byShade.filter((i) => state.selected[i]), at = rows.indexOf(state.hovered ?? state.marked), box = layers.getBoundingClientRect();
    const to = { ArrowRight: at + 1, ArrowUp: at + 1, ArrowLeft: at - 1, ArrowDown: at - 1, PageUp: at + 10, PageDown: at - 10, Home: 0, End: n }[event.key];
    if (event.key === "Enter" && state.hovered !== undefined) mark(state.hovered);
    else if (to === undefined || !rows.length) return;
    else hover(rows[clamp(to, [0, rows.length - 1])], { clientX: box.left, clientY: box.bottom }, box);
    event.preventDefault();
  });
  layers.onblur = () => hover(undefined);
}

// The pointer over a picture: rowAt (x, y, event) is the design there.
function pointed(place, rowAt, isBelow = false) {
  const look = (event) => {
    const box = place.getBoundingClientRect();
    if (!event.buttons) hover(rowAt(event.clientX - box.left, event.clientY - box.top, event), event, isBelow && box);
    if (event.type === "click" && state.hovered !== undefined) mark(state.hovered);
  };
  for (const type of ["mousemove", "click"]) place.addEventListener(type, look); // a finger does not move before
  place.onpointerleave = () => hover(undefined);
}

// An element of an SVG.
const put = (parent, name, attributes = {}) => Object.entries(attributes).reduce((g, [key, v]) => g.attr(key, v), parent.append(name));

// Three canvases below an SVG: all designs, those that are selected, and what stands out of them.
function layered(host, label, rowAt, isBelow) {
  const canvases = [0, 1, 2].map(() => element("canvas", { "aria-hidden": "true" })), words = `${label}: arrow keys go from design to design, Enter opens one`;
  const layers = host.appendChild(element("div", { class: "layers", tabindex: 0, role: "application", "aria-label": words }, ...canvases)), svg = charts.select(layers).append("svg");
  pointed(layers, rowAt, isBelow);
  byKeys(layers);
  function size(width, height) {
    layers.style.height = `${height}px`;
    svg.attr("width", width).attr("height", height).selectAll("*").remove();
    return canvases.map((canvas) => prepare(canvas, width, height));
  }
  return { layers, back: canvases[0], svg, size };
}

// ---- the address: #axes=j1_m,-j3_g&log=j3_g&in=j1_m:0.4:0.8&steps=+j1_m:0:1;-j3_g:9:&x=j1_m&y=j2_m&colour=type&mark=17
const byName = (name) => columns.find((c) => c.name === name);
const rangesText = (ranges) => Array.from(ranges, ([c, [a, b]]) => [encodeURIComponent(c.name), ...[a, b].map((v) => (finite(v) ? +v.toPrecision(6) : ""))].join(":")).join(",");
const pairsText = (pairs) => Array.from(pairs, ([c, v]) => `${encodeURIComponent(c.name)}:${v}`).join(",");
const partsFrom = (text = "") => text.split(",").map((part) => part.split(":")).map(([name, ...words]) => [columns.find((c) => [c.name, encodeURIComponent(c.name)].includes(name)), ...words]).filter(([c]) => c);
const endFrom = (word, open) => (word && finite(+word) ? +word : open);
const rangesFrom = (text) => new Map(partsFrom(text).map(([c, a, b]) => [c, [endFrom(a, -Infinity), endFrom(b, Infinity)]]));
const pairsFrom = (text) => new Map(partsFrom(text).filter(([c, v]) => objectives.includes(c) && finite(+v)).map(([c, v]) => [c, +v]));

function addressOf() {
  const names = (list) => list.map((c) => c.name).join(",");
  const all = {
    axes: state.axes.map((c) => (state.inverted.has(c) ? "-" : "") + c.name).join(","), log: names([...state.log]), percent: names([...state.percent]), in: rangesText(state.ranges),
    steps: state.steps.map(({ keep, ranges }) => (keep ? "+" : "-") + rangesText(ranges)).join(";"), x: state.x.name, y: state.y.name,
    colour: state.colour.name, theme: state.theme, weights: pairsText(state.weights), reference: pairsText(state.reference), mark: state.marked === undefined ? "" : String(ids[state.marked]),
  };
  return new URLSearchParams(Object.entries(all).filter(([key, v]) => v !== "" && v !== standard?.[key])).toString();
}
let standard, lastAddress;

// Only what differs from the page as it opens; a section's name in the address (#design) stays.
function saveAddress() {
  const now = addressOf();
  if (now === (lastAddress ?? "")) return;
  past.push(lastAddress ?? "");
  putAddress(now);
}

function putAddress(now) {
  lastAddress = now;
  history.replaceState(null, "", now ? `#${now}` : location.pathname + location.search);
}

// Every address was a state of the page.
const past = [];
function undo() {
  if (!past.length) return;
  const before = state.marked;
  putAddress(past.pop());
  takeAddress();
  if (state.marked !== before && !drawer.hidden) openDrawer(state.marked);
}

function takeAddress() {
  readAddress();
  showTheme(state.theme);
  layoutChanged();
}
document.addEventListener("keydown", (event) => (event.ctrlKey || event.metaKey) && event.key === "z" && !event.target.closest("input[type=text], input[type=number], textarea") && undo());

function readAddress() {
  const given = Object.fromEntries(new URLSearchParams(location.hash.slice(1)));
  const list = (text) => text.split(",").map(byName).filter(Boolean), all = { ...standard, ...given };
  const named = all.axes.split(",").map((word) => [byName(word.replace(/^-/, "")), word.startsWith("-")]).filter(([c]) => c);
  if (named.length) state.axes = named.map(([c]) => c);
  state.inverted = new Set(named.filter(([, up]) => up).map(([c]) => c));
  for (const key of ["log", "percent"]) state[key] = new Set(list(all[key] ?? ""));
  state.ranges = rangesFrom(all.in);
  state.steps = (all.steps ?? "").split(";").filter(Boolean).map((text) => ({ keep: text[0] === "+", ranges: rangesFrom(text.slice(1)) }));
  for (const key of ["x", "y", "colour"]) state[key] = byName(all[key]) ?? state[key];
  state.marked = rowOf.get(+all.mark) ?? state.marked;
  [state.weights, state.reference] = [all.weights, all.reference].map(pairsFrom);
  findScores();
  state.theme = all.theme === "dark" ? "dark" : "light";
  findKept();
  findShades();
}

// ---- colours and canvases
// Shade of every design, 0..SHADES-1, and the designs in the order of their shades, so that few strokes change colour.
let shade = new Uint8Array(n), byShade = [], shadeColours = RAMP;
function findShades() {
  const { value, words } = state.colour, [low, high] = extent(state.colour, []);
  const scale = high > low ? (SHADES - 1) / (high - low) : 0;
  shadeColours = words ? PALETTE : RAMP;
  for (let i = 0; i < n; i++) shade[i] = words ? value[i] % PALETTE.length : clamp(Math.round((value[i] - low) * scale), [0, SHADES - 1]);
  byShade = charts.range(n).filter((i) => state.kept[i]).sort((a, b) => shade[a] - shade[b]);
}
views.layout.push(findShades);

// A canvas of css size (w, h), sharp on fine screens; coordinates in css pixels.
function prepare(canvas, w, h) {
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  canvas.width = Math.round(w * ratio);
  canvas.height = Math.round(h * ratio);
  canvas.style.width = `${w}px`;
  canvas.style.height = `${h}px`;
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  return pen;
}

// A range may be open; its ends on a picture are not.
const clamp = (v, [a, b]) => Math.max(Math.min(a, b), Math.min(Math.max(a, b), v));
// The design under the pointer, in words, beside it.
const tip = document.body.appendChild(element("div", { id: "tip", hidden: true, role: "status" }));
function showTip(row, event, at) {
  tip.hidden = row === undefined || !event;
  if (tip.hidden) return;
  if (+tip.dataset.row !== row) {
    tip.dataset.row = row;
    tip.replaceChildren(element("strong", designName(row)), element("dl", ...results.flatMap((c) => [element("dt", c.title), element("dd", known(c, row) + (c.unit ? `\u202f${c.unit}` : ""))])));
  }
  tip.style.left = `${Math.min(event.clientX + 16, window.innerWidth - tip.offsetWidth - 8)}px`;
  tip.style.top = `${Math.max(4, Math.min(at ? at.bottom + 4 : event.clientY + 16, window.innerHeight - tip.offsetHeight - 8))}px`;
}

const designName = (row) => `Design ${ids[row]}${ids[row] === run.knee ? ", the knee" : ""}${beyondLaw.has(ids[row]) ? ", beyond the contact law" : ""}`;
