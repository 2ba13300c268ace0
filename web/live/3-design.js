// Any design at a click on its line, dot or row: simulated by the server, once, for the drawer.
const details = new Map(); // id -> promise
function detailOf(id) {
  if (!details.has(id)) {
    details.set(id, ask(`design/${id}`));
    details.get(id).catch(() => details.delete(id));
  }
  return details.get(id);
}

drawerMore.detail = (row) => detailOf(ids[row]).then(({ detail, objectives: raw }) => ({ ...detail, raw }));
drawerMore.buttons = (row, d) => [
  plainButton("What if\u2026", () => startWhatIf(row)),
  plainButton("Compare", () => compare({ name: `design ${ids[row]}`, raw: d.raw, gap_m: d.gap_m, peaks: d.with_core }), { disabled: !d?.raw })];
drawerMore.rest = (host, d) => detailParts(folded(host, "Forces, energies and more"), d, true);

// What cannot be written stays in its field, with the reason.
drawerMore.takeNote = (id, field) => ask("notes", { id, text: field.value.trim() }).then((notes) => {
  run.notes = notes;
  field.classList.remove("bad");
}).catch((error) => {
  field.classList.add("bad");
  field.title = error.message;
});

// The first screen compares the knee with what it stands beside: both come with the knee in detail.
async function completeSummary() {
  const { detail } = await detailOf(run.knee);
  run.detail = detail;
  overlays.push(...overlaysOf(detail));
  refill(byId("summary"), (host) => {
    host.append(element("h1", { id: "title" }));
    summaryPart();
  });
  byId("overlays").replaceWith(overlayLegend());
  layoutChanged();
}

// Which variables matter is found when its part is opened.
const matters = byId("which-variables-matter");
matters.hidden = false;
matters.addEventListener("toggle", async () => {
  if (!run.importance) run.importance = await ask("importance").catch(() => null);
  if (run.importance) importanceFigure(matters);
  else matters.append(note("Too few designs succeeded to say so."));
  drawAll();
}, { once: true });

// ---- two to four side by side
const compared = []; // { name, raw, gap_m, peaks }
const SIDES = Object.values(SCENES); // their colours and symbols
let comparePart;

function compare(one) {
  const same = compared.findIndex(({ name }) => name === one.name);
  compared[same >= 0 ? same : Math.min(compared.length, 3)] = one;
  showCompared();
  if (compared.length > 1) goTo(comparePart);
}

// Objectives, and how far they are from those of another design.
const besides = (raw, before) => objectives.map((c, k) => (raw ? [digits(raw[k] * c.factor), before ? difference(raw[k], before[k]) : ""] : "\u2013"));

function compareTable() {
  const row = (one, i) => line([[legend([[one.name, SIDES[i].colour, SIDES[i].mark]]), plainButton("Remove", () => {
    compared.splice(i, 1);
    showCompared();
  }, { "aria-label": `remove ${one.name}` })], ...besides(one.raw, i && compared[0].raw)]);
  return table("compared", ["differences from the first", ...objectives], compared.map(row));
}

function showCompared() {
  comparePart ??= livePart("compare", "Side by side", "provenance");
  comparePart.hidden = !compared.length;
  refill(comparePart, (host) => {
    host.append(element("h2", "Side by side"), compareTable());
    const grid = gridOf(host, 3);
    for (const [key, title, label] of [["gap_mm", "Gaps", "gap [mm]"], ...PEAKS]) {
      const lines = compared.map((one, i) => ({ name: one.name, values: one.peaks[key] ?? one.gap_m.map((g) => 1e3 * g), colour: SIDES[i].colour, symbol: SIDES[i].symbol }));
      figure(grid, title, null, (width) => heightChart(width, 300, label, lines));
    }
  });
}
