// A section of its own before that of the given id, with its link in the same place.
function laterPart(id, title, before) {
  const part = element("section", { id }, element("h2", title)), next = byId(before) ?? byId("provenance");
  next.before(part);
  document.querySelector(`#parts a[href="#${next.id}"]`).before(linkTo(part, title));
  return part;
}

// ---- two to four side by side
const compared = []; // { name, x, ground, raw, and of the simulation gap_m and peaks }
const SIDES = Object.values(SCENES); // their colours and symbols
let comparePart;
const designOf = (row) => ({ name: `design ${ids[row]}`, x: variables.map((c) => c.raw[row]), ground: {}, raw: objectives.map((c) => c.raw[row]) });

// Gaps and peaks of what was not simulated yet are; the button says what came of it.
const compareButton = (one) => plainButton("Compare", async ({ target: button }) => {
  button.disabled = true;
  try {
    if (!one.gap_m) one = { ...await simulated({ x: one.x, ...one.ground }), ...one };
    const same = compared.findIndex(({ name }) => name === one.name);
    compared[same >= 0 ? same : Math.min(compared.length, 3)] = one;
    showCompared();
    button.replaceWith(linkTo(comparePart, compared.length > 1 ? `Beside ${compared.length - 1} more` : "Chosen: compare another one with it"));
    if (compared.length > 1) goTo(comparePart);
  } catch (error) {
    button.textContent = `Not simulated: ${error.message}`;
  }
});

// Objectives, and how far they are from those of another design.
const besides = (raw, before) => objectives.map((c, k) => (raw ? [digits(raw[k] * c.factor), before ? difference(raw[k], before[k], c.sense) : ""] : "\u2013"));

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
      const lines = compared.map((one, i) => ({ name: one.name, values: one[key] ?? one.gap_m.map((g) => 1e3 * g), colour: SIDES[i].colour, symbol: SIDES[i].symbol }));
      figure(grid, title, null, (width) => heightChart(width, 300, label, lines));
    }
  });
}
