// Which designs are looked at: those within every range. One state for all pictures, one frame for every change of it.

const state = {
  axes: "objectives", // objectives, variables, all
  colour: objectives[objectives.length - 1],
  ranges: new Map(), // column -> [low, high] in the units of the eye
  selected: new Uint8Array(n).fill(1),
  nSelected: n,
  marked: rowOf.get(run.chosen),
};

// What is drawn anew when the selection, and when the axes or colours changed. While a range is dragged, only what is in
// sight follows at once; the rest follows REST_MS after the last change, as do lines that take more than a frame.
const views = { selection: [], layout: [] };
const REST_MS = 100;
let resting; // timer; undefined: at rest
const atRest = new Set();

// `host` null: too small to wait.
function follow(host, draw) {
  const view = { draw, inSight: true, isStale: false };
  views.selection.push(view);
  if (!host) return;
  new IntersectionObserver((entries) => {
    view.inSight = entries[entries.length - 1].isIntersecting;
    if (view.inSight && view.isStale) redraw(view);
  }).observe(host);
}

function redraw(view) {
  view.isStale = false;
  view.draw();
}

function redrawAll() {
  for (const view of views.selection) redraw(view);
}

// In the next frame, or at rest; a task that is not wanted any more is dropped.
function later(task) {
  const waits = { task, frame: 0 };
  if (resting === undefined) waits.frame = requestAnimationFrame(task);
  else atRest.add(waits);
  return waits;
}

function drop(waits) {
  if (!waits) return;
  cancelAnimationFrame(waits.frame);
  atRest.delete(waits);
}

function rest() {
  clearTimeout(resting);
  resting = undefined;
  for (const view of views.selection) if (view.isStale) redraw(view);
  for (const waits of atRest) waits.frame = requestAnimationFrame(waits.task);
  atRest.clear();
  delete document.documentElement.dataset.busy;
}
window.addEventListener("beforeprint", rest);

function findSelected() {
  const { selected } = state;
  selected.fill(1);
  for (const [c, [low, high]] of state.ranges) {
    const { value } = c;
    for (let i = 0; i < n; i++) if (!(value[i] >= low && value[i] <= high)) selected[i] = 0;
  }
  let sum = 0;
  for (let i = 0; i < n; i++) sum += selected[i];
  state.nSelected = sum;
}

let waiting = false;
function selectionChanged() {
  if (waiting) return;
  waiting = true;
  document.documentElement.dataset.busy = "yes";
  requestAnimationFrame(() => {
    waiting = false;
    findSelected();
    clearTimeout(resting);
    resting = setTimeout(rest, REST_MS);
    for (const view of views.selection) {
      if (view.inSight) redraw(view);
      else view.isStale = true;
    }
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

function clearRanges() {
  state.ranges.clear();
  selectionChanged();
}

function mark(row) {
  state.marked = row;
  redrawAll();
}

// Shade of every design, 0..SHADES-1, and the designs in the order of their shades, so that few strokes change colour.
let shade = new Uint8Array(n);
let byShade = [];
function findShades() {
  const { value, min, max } = state.colour;
  const scale = max > min ? (SHADES - 1) / (max - min) : 0;
  for (let i = 0; i < n; i++) shade[i] = Math.round((value[i] - min) * scale);
  byShade = Array.from({ length: n }, (_, i) => i).sort((a, b) => shade[a] - shade[b]);
}

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
const within = (v, [a, b]) => Math.max(Math.min(a, b), Math.min(Math.max(a, b), v));

// Faint where they are many, never invisible.
const opacity = (many) => Math.max(0.12, Math.min(0.85, 90 / Math.sqrt(many + 1) / 10));
