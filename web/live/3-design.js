// Any design at a click on its line, dot or row: simulated by the server, once.

const details = new Map(); // id -> promise
function detailOf(id) {
  if (!details.has(id)) {
    const answer = ask(`design/${id}`).then((one) => {
      one.detail.baselines = one.detail.baselines.filter((b) => b.objectives);
      return one;
    });
    details.set(id, answer);
    answer.catch(() => details.delete(id));
  }
  return details.get(id);
}

// Drawings of before are dropped.
function refill(part, fill) {
  part.replaceChildren();
  drawings = drawings.filter(({ place }) => place.isConnected);
  fill(part);
  drawAll();
}

function designOnDemand() {
  const part = livePart("any-design", "Design", "provenance"), heading_ = part.firstChild, body = part.appendChild(element("div"));
  const link = document.querySelector("#parts a[href='#any-design']");
  let wanted;

  async function open(id, go) {
    wanted = id;
    part.dataset.id = "";
    heading_.textContent = link.textContent = designName(rowOf.get(id));
    body.classList.add("stale");
    if (go) goTo(part);
    try {
      const { detail, objectives: raw } = await detailOf(id);
      if (id !== wanted) return;
      refill(body, (host) => {
        host.append(element("div", { class: "bar" }, plainButton("What if\u2026", () => startWhatIf(rowOf.get(id))),
          plainButton("Compare", () => compare({ name: `design ${id}`, raw, gap_m: detail.gap_m, peaks: detail.with_core }))));
        peakPart(host, detail, 290);
        detailParts(host, detail);
      });
      part.dataset.id = id;
    } catch (error) {
      refill(body, (host) => host.append(element("p", { class: "warn" }, `Not simulated: ${error.message}`)));
    }
    body.classList.remove("stale");
  }

  let shown = state.marked;
  follow(null, () => {
    if (state.marked === shown || state.marked === undefined) return;
    shown = state.marked;
    open(ids[shown], true);
  });
  if (shown !== undefined) open(ids[shown], false);
}

// The first screen compares the knee with what it stands beside: both come with the knee in detail.
async function completeSummary() {
  const { detail } = await detailOf(run.knee);
  run.detail = detail;
  overlays.push(...overlaysOf(detail));
  refill(document.getElementById("summary"), (host) => {
    host.append(element("h1", { id: "title" }));
    summaryPart();
  });
  document.getElementById("overlays").replaceWith(overlayLegend());
  layoutChanged();
}

// ---- two to four side by side

const compared = []; // { name, raw, gap_m, peaks }
const SIDE_COLOURS = [BLUE, VERMILLION, GREEN, PURPLE], SIDE_MARKS = ["\u25cf", "\u25c6", "\u25b2", "\u25a0"], SIDE_SYMBOLS = ["circle", "diamond2", "triangle", "square"];
let comparePart;

function compare(one) {
  const same = compared.findIndex(({ name }) => name === one.name);
  if (same >= 0) compared[same] = one;
  else if (compared.length < 4) compared.push(one);
  else compared[3] = one;
  showCompared();
  goTo(comparePart);
}

function compareTable() {
  const row = (one, i) => line([[legend([[one.name, SIDE_COLOURS[i], SIDE_MARKS[i]]]), plainButton("Remove", () => {
    compared.splice(i, 1);
    showCompared();
  }, { "aria-label": `remove ${one.name}` })], ...objectives.map((c, k) => [digits(one.raw[k] * c.factor), i ? difference(one.raw[k], compared[0].raw[k]) : ""])]);
  return table("compared", ["differences from the first", ...objectives], compared.map(row));
}

// A line per design over the height.
function sideFigure(host, title, label, valuesOf) {
  const lines = compared.map((one, i) => ({ name: one.name, values: valuesOf(one), colour: SIDE_COLOURS[i], symbol: SIDE_SYMBOLS[i] }));
  figure(host, title, null, (width) => heightChart(width, 300, label, lines));
}

function showCompared() {
  comparePart ??= livePart("compare", "Side by side", "provenance");
  comparePart.hidden = !compared.length;
  refill(comparePart, (host) => {
    host.append(element("h2", {}, "Side by side"), compareTable());
    const grid = host.appendChild(element("div", { class: "grid4" }));
    sideFigure(grid, "Gaps", "gap [mm]", (one) => one.gap_m.map((g) => 1e3 * g));
    sideFigure(grid, "Displacement", "peak displacement [m]", (one) => one.peaks.displacement_m);
    sideFigure(grid, "Interstorey drift", "peak interstorey drift [m]", (one) => one.peaks.drift_m);
    sideFigure(grid, "Acceleration", "peak absolute acceleration [g]", (one) => one.peaks.acceleration_g);
  });
}
