// Which designs are looked at: those within every range. One state for all pictures, one frame for every change of it.

const state = {
  axes: "objectives", // objectives, variables, all
  colour: objectives[objectives.length - 1],
  ranges: new Map(), // column -> [low, high] in the units of the eye
  selected: new Uint8Array(n).fill(1),
  nSelected: n,
  marked: rowOf.get(run.chosen),
};

// What is drawn anew when the selection, and when the axes or colours changed.
const views = { selection: [], layout: [] };

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
  requestAnimationFrame(() => {
    waiting = false;
    findSelected();
    for (const draw of views.selection) draw();
  });
}

function layoutChanged() {
  for (const draw of views.layout) draw();
  for (const draw of views.selection) draw();
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
  for (const draw of views.selection) draw();
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
