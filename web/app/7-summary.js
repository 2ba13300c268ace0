// What was run, what stands out, how the front grew, what the run was made of.

function bestRow(c) {
  let best = 0;
  for (let i = 1; i < n; i++) if (c.sense * c.raw[i] < c.sense * c.raw[best]) best = i;
  return best;
}

function change(value, before, words) {
  if (!(before > 0)) return "";
  const pct = Math.round((100 * (value - before)) / before);
  if (pct === 0) return "";
  if (value > 2 * before) return `${show(value / before)} \u00d7 ${words}`;
  return `${pct > 0 ? "+" : "\u2212"}${Math.abs(pct)} % vs ${words}`;
}

// raw: natural values of the objectives; one that failed has none. baselines: [{words, objectives}].
function cards(raw, baselines) {
  const known = (baselines ?? []).filter((b) => b.objectives);
  const compared = (c, k, b) => (c.unit === "%" ? `${b.words}: ${show(b.objectives[k])} %` : change(raw[k], b.objectives[k], b.words));
  return element("div", { class: "cards" }, ...objectives.map((c, k) => element("div", { class: "card" },
    element("div", { class: "what" }, c.what),
    element("div", { class: "value" }, raw[k] === null ? "failed" : digits(raw[k] * c.factor), " ", element("small", {}, c.unit)),
    ...known.filter((b, i) => b.objectives[k] !== null && (i === 0 || c.unit !== "%")).map((b) => element("div", { class: "change" }, compared(c, k, b))))));
}

// In which objectives impacts win and lose; equal within a thousandth: neither.
function comparison(raw, baselines) {
  const against = (b) => {
    const of = (sign) => objectives.filter((c, k) => b.objectives[k] !== null && sign * c.sense * (b.objectives[k] - raw[k]) > 1e-3 * Math.abs(b.objectives[k])).map((c) => c.title);
    const part = (verb, names) => (names.length ? `${verb} in ${names.join(", ")}` : `${verb} in none`);
    return element("li", {}, `against ${b.words}${b.device ? ` (${b.device})` : ""}: ${part("win", of(1))}; ${part("lose", of(-1))}`);
  };
  const known = (baselines ?? []).filter((b) => b.objectives);
  return known.length ? element("div", { class: "comparison" }, "Impacts", element("ul", {}, ...known.map(against))) : "";
}

// What the design has to bear, beside its baselines.
function loadTable(loads) {
  return element("div", { class: "scroll" }, element("table", { id: "loads" },
    element("thead", {}, element("tr", {}, element("th", { scope: "col" }, "has to bear"),
      ...loads.columns.map((c) => element("th", { scope: "col" }, c.title, element("small", {}, ` ${c.unit}`))))),
    element("tbody", {}, ...loads.rows.map((r) => element("tr", {}, element("td", {}, r.words),
      ...r.values.map((v) => element("td", {}, v === null ? "" : digits(v))))))));
}

function standoutTable(baselines) {
  const rows = objectives.map((c) => [`best ${c.title}`, bestRow(c), c]);
  const knee = rowOf.get(run.knee);
  const line = (label, id, values, best, kind) => element("tr", { class: kind }, element("td", {}, label), element("td", {}, id),
    ...values.map((v, k) => element("td", { class: objectives[k] === best ? "best" : false }, digits(v))));
  return element("div", { class: "scroll" }, element("table", { id: "standouts" },
    element("thead", {}, element("tr", {}, element("th", { scope: "col" }, "stands out by"), element("th", { scope: "col" }, "design"),
      ...objectives.map((c) => element("th", { scope: "col", title: c.what }, ...heading(c))))),
    element("tbody", {},
      line("knee", String(run.knee), objectives.map((c) => c.value[knee]), null, "knee"),
      ...rows.map(([label, i, best]) => line(label, String(ids[i]), objectives.map((c) => c.value[i]), best, "")),
      ...(baselines ?? []).filter((b) => b.objectives).map((b) => line(b.words, "", objectives.map((c, k) => (b.objectives[k] === null ? NaN : b.objectives[k] * c.factor)), null, "")))));
}

// As in the program's own output: the peak, and what the record was multiplied by.
const peakText = (d) => `peak ${show(d.pga_g)} g` +
  (d.scale === 1 && d.stretch === 1 ? ", as recorded" : ` (${show(d.pga_g / d.scale)} g \u00d7 ${show(d.scale)}, time \u00d7 ${show(d.stretch)})`);

function summaryPart() {
  const d = run.detail, knee = objectives.map((c) => c.raw[rowOf.get(run.knee)]);
  const baselines = d && run.chosen === run.knee ? d.baselines : d?.baselines.slice(0, 1); // the others are those of the chosen design
  document.title = `${run.name} \u2013 imtet report`;
  document.getElementById("title").textContent = `Study ${run.name}`;
  const simulated = run.evaluated ? `${count(run.evaluated)} designs ${d ? "simulated" : "evaluated"}, ${count(run.failed)} failed, ` : "";
  document.getElementById("subtitle").textContent = `${simulated}${count(n)} on the front` +
    (d ? `. Ground motion ${d.record.replace(/.*\//, "")}, ${peakText(d)}, ${show(d.duration_s)} s` : "");
  document.getElementById("summary").append(
    element("p", {}, element("strong", {}, `Design ${run.knee}, the knee`), ": nearest to the best of everything, with every objective scaled over the front."),
    run.robust ? element("p", { class: "note" }, "Objectives are those of several simulations of every design (motion.records, sim.replicates, sim.robust " +
      `among the settings), standard deviations those of ${run.spread === "as built" ? "structures as built" : "predictability (chaos alone)"}; the chosen design is shown as one simulation under ${shortName(d.record)}.`) : "",
    cards(knee, baselines), baselines ? comparison(knee, baselines) : "", d && run.chosen === run.knee ? loadTable(d.loads) : "", standoutTable(baselines));
}

function growthPart() {
  const host = document.getElementById("growth"), c = run.convergence;
  if (c.simulated.length < 2) return host.remove();
  const rows = c.simulated.map((x, i) => ({ x, y: 100 * c.volume[i], e: 200 * c.error[i] }));
  const figure = host.appendChild(element("figure"));
  drawn(figure, (width) => charts.plot({
    width, height: 260, marginLeft: 60, ariaLabel: "Hypervolume over the number of designs",
    x: { label: "designs simulated", tickFormat: count }, y: { label: "hypervolume [%]", grid: true, zero: true, nice: true },
    marks: [
      charts.areaY(rows, { x: "x", y1: (r) => r.y - r.e, y2: (r) => r.y + r.e, fill: BLUE, fillOpacity: 0.2 }),
      charts.lineY(rows, { x: "x", y: "y", stroke: BLUE, strokeWidth: 2 }),
      charts.dot([rows[rows.length - 1]], { x: "x", y: "y", fill: BLUE, r: 4 }),
    ],
  }));
  const last = rows[rows.length - 1];
  figure.append(element("figcaption", {}, "Share of a box that the designs so far dominate, in every objective from the worst of the first sample to a fifth of its range beyond the best " +
    `(imtet status shows the same); at the end ${show(last.y)} \u00b1 ${show(last.e / 2)} % (standard error of the estimate; band: twice that). ` +
    "A curve that still climbs asks for a longer run."));
}

function provenancePart() {
  const host = document.getElementById("provenance");
  const made = run.provenance ? JSON.parse(run.provenance) : {};
  const facts = [["program", `imtet ${made.version ?? "?"} (${made.revision ?? "?"})`], ["started", made.machine?.started],
    ["machine", made.machine && `${made.machine.host}, ${made.machine.system}, ${made.machine.threads} threads`],
    ["seed", made.seed], ["record", made.inputs?.record], ["hash of the record", made.inputs?.record_fnv1a],
    ["folder", run.folder], ["this page", `imtet ${run.version} (${run.revision})`]];
  host.append(element("dl", { class: "facts" }, ...facts.filter(([, v]) => v !== undefined && v !== null)
    .flatMap(([k, v]) => [element("dt", {}, k), element("dd", {}, String(v))])));
  for (const [title, text] of [["Every setting", run.settings], ["provenance.json", run.provenance]])
    if (text) host.append(element("details", {}, element("summary", {}, title), element("pre", { tabindex: "0" }, text)));
}

// Links to the parts that this run has.
function contents() {
  const names = [["summary", "Summary"], ["front", "Front"], ["growth", "Growth"], ["design", `Design ${run.chosen}`], ["provenance", "Provenance"]];
  document.getElementById("parts").append(...names.filter(([id]) => document.getElementById(id))
    .map(([id, text]) => element("a", { href: `#${id}` }, text)));
}
