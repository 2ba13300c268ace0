// A section of its own before that of the given id, with its link in the same place.
function laterPart(id, title, before) {
  const part = element("section", { id }, element("h2", title)), next = byId(before) ?? byId("provenance");
  next.before(part);
  document.querySelector(`#parts a[href="#${next.id}"]`).before(linkTo(part, title));
  return part;
}

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
  comparePart ??= laterPart("compare", "Side by side", "provenance");
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
