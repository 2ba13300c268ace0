// The variables of the front: a heat map of those that are numbered (gaps by floor), what matters for which objective, and
// a few typical designs.
// ---- heat map: a column of pixels per design, or per few of them
const COLUMNS_MAX = 480;

// The selected designs from the least to the largest value of the colour's column, in at most COLUMNS_MAX groups.
function groupsInOrder() {
  const { value } = state.colour, rows = byShade.filter((i) => state.selected[i]).sort((a, b) => value[a] - value[b]);
  const many = Math.min(rows.length, COLUMNS_MAX);
  return Array.from({ length: many }, (_, k) => rows.slice(Math.floor((k * rows.length) / many), Math.floor(((k + 1) * rows.length) / many)));
}

const meanOf = (c, rows) => charts.mean(rows, (i) => c.value[i]);

function heatFigure(host, family) {
  const [first] = family, { words } = first, stem = stemOf(family), place = placeOf(family);
  let groups = [];
  const f = figure(host, `${capital(stem)}s of the front, by ${place}`, null, (width) => {
    const m = family.length;
    groups = groupsInOrder();
    const values = new Float64Array(groups.length * m);
    family.forEach((c, j) => groups.forEach((rows, k) => (values[j * groups.length + k] = words ? c.value[rows[rows.length >> 1]] : meanOf(c, rows))));
    const marked = groups.findIndex((rows) => rows.includes(state.marked)), ends = [0, 1].map((s) => (finite(first.bounds[s]) ? first.bounds[s] : Math[s ? "max" : "min"](...values)));
    return chart({
      width, height: Math.min(320, 90 + 16 * m), ariaLabel: `${stem} of every design of the front`,
      x: { label: `${count(state.nSelected)} designs, from the least to the largest ${state.colour.title}`, domain: [0, groups.length || 1], ticks: [] },
      y: { ...floorAxis(m), label: place },
      color: words ? { type: "threshold", domain: words.slice(1).map((_, k) => k + 0.5), range: PALETTE.slice(0, words.length) }
        : { scheme: "YlGnBu", domain: ends, label: titleUnit({ ...first, title: stem }), legend: true, tickFormat: show },
      marks: groups.length ? [charts.raster(values, { width: groups.length, height: m, x1: 0, x2: groups.length, y1: 0.5, y2: m + 0.5, imageRendering: "pixelated" }), marked < 0 ? null : charts.ruleX([marked + 0.5], { stroke: INK, strokeWidth: 2.5 })] : [],
    });
  }, ...(words ? [legend(words.map((word, k) => [word, PALETTE[k]]))] : []));

  // A rule over the picture, which is not drawn again for it.
  const rule = f.appendChild(element("div", { class: "cursor", hidden: true }));
  views.hover.push(() => {
    const image = f.querySelector("image")?.getBoundingClientRect(), k = groups.findIndex((rows) => rows.includes(state.hovered)), box = f.getBoundingClientRect();
    rule.hidden = !image || k < 0;
    if (rule.hidden) return;
    rule.style.left = `${image.left - box.left + ((k + 0.5) * image.width) / groups.length}px`;
    rule.style.top = `${image.top - box.top}px`;
    rule.style.height = `${image.height}px`;
  });

  pointed(f, (x, y, event) => {
    const image = f.querySelector("image")?.getBoundingClientRect(), isInside = image && event.clientY >= image.top && event.clientY <= image.bottom;
    const rows = isInside && groups[Math.floor((groups.length * (event.clientX - image.left)) / image.width)];
    return rows ? rows[rows.length >> 1] : undefined;
  });
  follow(f, () => resting === undefined && root.dataset.ready && f.redraw()); // not while a range is dragged
  return f;
}

// ---- importance
const KNOWN_R2 = 0.5; // below it the surrogate explains too little to say what matters

function importanceFigure(host) {
  const m = run.importance;
  if (!m) return;
  const named = objectives.map((c, k) => `${c.title}, R\u00b2 ${Math.max(0, m.explained[k]).toFixed(2)}`);
  const rows = objectives.flatMap((_, k) => variables.map((c, j) => ({ objective: named[k], variable: c.title, what: c.what, total: m.explained[k] >= KNOWN_R2 ? m.total[k][j] : null })))
    .filter((r) => r.total !== null).map((r) => ({ ...r, total: Math.min(1, r.total) })); // what is above is its sampling error
  const largest = Math.max(...rows.map((r) => r.total), 0.1), unknown = named.filter((_, k) => !(m.explained[k] >= KNOWN_R2)), isCrowded = variables.length > 26;
  const names = { variable: variables.map((c) => c.title), objective: named }, middle = variables[variables.length >> 1].title;
  figure(host, "Which variables matter for which objective",
    "Total Sobol index: the share of an objective\u2019s variance over the box of the search in which the variable has a part, alone or with others. Found on a radial basis interpolant of " + count(m.centres) +
    " of the run\u2019s designs; R\u00b2 is how much of the objective it explains when designs are left out.", (width) => {
      const isNarrow = width < 700, [x, y] = isNarrow ? ["objective", "variable"] : ["variable", "objective"], below = 16 + 7 * Math.max(...names[x].map((name) => name.length));
      return chart({
        width, height: (isNarrow ? 18 : 30) * names[y].length + below + 20, marginLeft: Math.min(230, 0.4 * width), marginBottom: below, ariaLabel: "Total Sobol indices of variables for objectives",
        x: { label: null, domain: names[x], tickRotate: -90, tickSize: 0 }, y: { label: null, domain: names[y], tickSize: 0 },
        color: { scheme: "YlGnBu", domain: [0, largest], label: "total Sobol index", legend: true },
        marks: [
          charts.cell(rows, { x, y, fill: "total", inset: 0.5, title: (r) => `${r.what} for ${r.objective}: ${show(r.total)}` }),
          charts.text(unknown.map((objective) => ({ objective, variable: middle })), { x, y, rotate: isNarrow ? -90 : 0, text: () => `needs more designs (R\u00b2 below ${KNOWN_R2})`, fill: INK }),
          isCrowded || isNarrow ? null : charts.text(rows.filter((r) => r.total >= 0.05), { x, y, text: (r) => r.total.toFixed(2), fill: (r) => (r.total > 0.55 * largest ? "#fff" : INK) }),
        ],
      });
    });
}

// ---- typical designs
const TYPES_MAX = 4;
const DISTINCT = 0.35; // of the standard deviation over the front: by that much a type differs in an objective

// Objectives over their ranges on the front, minimised.
const scaled = (c, i) => (c.max > c.min ? (c.sense > 0 ? c.value[i] - c.min : c.max - c.value[i]) / (c.max - c.min) : 0);

function nameOfType(rows, taken) {
  const by = objectives.map((c) => ({ c, far: (meanOf(c, rows) - charts.mean(c.value)) / (charts.deviation(c.value) || 1) })).sort((a, b) => Math.abs(b.far) - Math.abs(a.far)).filter(({ far }) => Math.abs(far) > DISTINCT);
  const word = ({ c, far }) => `${far < 0 ? "small" : "large"} ${c.title}`;
  const names = [2, 3, 4].map((k) => by.slice(0, k).map(word).join(", "));
  return by.length ? names.find((name) => !taken.includes(name)) ?? names[2] : "balanced";
}

// Lloyd's algorithm from the points farthest from each other: the same clusters every time. Returns the cluster of every point.
function kMeans(points, k, distance2) {
  const centres = [points[0]];
  const nearest = (p) => charts.minIndex(centres, (c) => distance2(p, c));
  while (centres.length < k) centres.push(charts.greatest(points, (p) => distance2(p, centres[nearest(p)])));
  for (let round = 0; round < 30; round++) {
    const sums = centres.map((c) => ({ many: 0, sum: c.map(() => 0) }));
    for (const p of points) {
      const own = sums[nearest(p)];
      own.many++;
      p.forEach((v, j) => (own.sum[j] += v));
    }
    sums.forEach(({ many, sum }, t) => many && (centres[t] = sum.map((v) => v / many)));
  }
  return points.map(nearest);
}

// Typical is the design nearest to the middle of its cluster.
function findTypes() {
  const points = charts.range(n).map((i) => objectives.map((c) => scaled(c, i)));
  const k = Math.min(TYPES_MAX, Math.floor(n / 8));
  if (k < 2 || objectives.length < 2) return [];
  const distance2 = (p, q) => p.reduce((sum, v, j) => sum + (v - q[j]) ** 2, 0), of = kMeans(points, k, distance2), taken = [];
  return [...charts.group(charts.range(n), (i) => of[i]).values()].sort((a, b) => b.length - a.length).map((rows) => {
    const middle = objectives.map((_, j) => charts.mean(rows, (i) => points[i][j])), name = nameOfType(rows, taken);
    taken.push(name);
    return { rows, name, typical: charts.least(rows, (i) => distance2(points[i], middle)) };
  });
}

for (const c of objectives) [c.min, c.max] = charts.extent(c.value);
const types = findTypes();
if (types.length) {
  const named = types.map((t, k) => `${k + 1} ${t.name}`), c = columnOf("type", -1, 0, ["type of design", "", 1, named.join("; ")]);
  types.forEach((t, k) => t.rows.forEach((i) => (c.raw[i] = c.value[i] = k)));
  columns.push(Object.assign(c, { family: [c], bounds: [NaN, NaN], words: types.map((_, k) => `${k + 1}`), named }));
}

function typesPart(host) {
  if (!types.length) return;
  const part = folded(host, `Typical designs: ${types.length} kinds on this front`, true);
  const rowOfType = (t, k) => {
    const name = element("button", { type: "button", title: "mark its typical design", onclick: () => mark(t.typical) }, t.name);
    const key = element("span", { class: "key", style: `background: ${PALETTE[k]}` }, String(k + 1));
    return line([[key, name], count(t.rows.length), String(ids[t.typical]), ...objectives.map((c) => digits(c.value[t.typical]))]);
  };
  part.append(note("Clusters of the front (k-means, objectives over their ranges), each named by what sets it apart and shown by the design nearest to its middle."),
    table("types", ["type", "designs", "typical", ...objectives], types.map(rowOfType)));
}
