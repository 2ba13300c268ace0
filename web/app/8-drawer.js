// The design that was clicked, in a drawer beside the pictures, which stay where they are: its numbers, gaps and peaks, and
// what can be done with it.
const drawer = document.body.appendChild(element("aside", { id: "drawer", tabindex: "-1", hidden: true, "aria-labelledby": "drawer-title" }));
const plainButton = (text, act, more = {}) => element("button", { class: "plain", type: "button", onclick: act, ...more }, text);
// What imtet serve adds: a promise of the design in detail, and what follows the peaks.
const drawerMore = { detail: () => null, rest: () => {} };

// A change of widths moves everything; what is looked at stays at its height.
function keepInPlace(act) {
  const seen = [...document.querySelectorAll("main figure, main summary, main table, main h2")].find((e) => e.getBoundingClientRect().bottom > 0.3 * window.innerHeight);
  const before = seen?.getBoundingClientRect().top;
  act();
  if (seen) window.scrollBy({ top: seen.getBoundingClientRect().top - before, behavior: "instant" });
}

function showDrawer(isOpen) {
  if (isOpen === !drawer.hidden) return;
  keepInPlace(() => {
    drawer.hidden = !isOpen;
    root.classList.toggle("beside", isOpen);
    layoutChanged();
    drawAll();
  });
}

let opener, openerTable; // had the focus before; a table's row may have been made anew meanwhile
function closeDrawer() {
  showDrawer(false);
  const again = opener?.isConnected ? [opener] : [openerTable, "main"].flatMap((place) => [...document.querySelectorAll(`${place} tr[data-id="${drawer.dataset.wanted}"] button`)]);
  again.find((e) => e.getClientRects().length)?.focus({ preventScroll: true });
}

document.addEventListener("keydown", (event) => event.key === "Escape" && axisMenu.hidden && !drawer.hidden && closeDrawer());

// sense 0: neither is better.
function difference(value, before, sense) {
  const exact = (100 * (value - before)) / Math.abs(before), pct = +exact.toFixed(Math.abs(exact) < 10 ? 1 : 0);
  return element("small", { class: `difference ${VERDICT[-Math.sign(sense * pct) || 0][0]}` }, finite(pct) ? `${pct < 0 ? "\u2212" : "+"}${Math.abs(pct).toFixed(Math.abs(pct) < 10 ? 1 : 0)} %` : "");
}

function numbersOf(row, d) {
  const knee = rowOf.get(run.knee), other = row === knee || knee === undefined ? undefined : knee;
  return table("numbers", ["", "value", ...(other === undefined ? [] : ["from the knee"])], [
    ...[...results, ...variables.filter((c) => !d?.with_core || c.family.length === 1 || c.words)].map((c) => line([element("span", { title: c.what }, c.title), [known(c, row), element("small", ` ${c.unit}${atBound(c, c.value[row]) ? ", at a bound" : ""}`)],
      ...(other === undefined ? [] : [c.words ? (c.value[row] === c.value[other] ? "" : known(c, other)) : difference(c.value[row], c.value[other], c.sense)])]))]);
}

// Of several runs as one: the one that has the design, and its id there.
function commandsOf(id) {
  const k = run.id_step && Math.floor(id / run.id_step), folder = run.id_step ? run.folder.split(" + ")[k] : run.folder;
  return ["evaluate", ...(run.tower ? ["simplify"] : []), "report"].map((command) => `imtet ${command} ${folder} --design ${id - k * run.id_step}`).join("\n");
}

// What was noted of a design, in notes.json beside the run; imtet serve takes it down.
const noteOf = (id) => {
  const text = run.notes[id] ?? "";
  return drawerMore.takeNote ? element("label", { class: "note" }, "Note ", element("textarea", { name: "note", rows: 2, onchange: (event) => drawerMore.takeNote(id, event.target) }, text))
    : text ? note(`Note: ${text}`) : "";
};

function fillDrawer(row, d) {
  const id = ids[row];
  refill(drawer, (host) => {
    host.append(div("bar", element("h2", { id: "drawer-title" }, designName(row)), plainButton("\u00d7", closeDrawer, { "aria-label": "Close (Escape)", id: "close-drawer" })),
      div("bar", ...(startWhatIf ? [plainButton("What if\u2026", () => startWhatIf(row)), compareButton(designOf(row))] : []), plainButton("Export", () => saveFile(`${run.name}-${id}.csv`, csvOf((i) => i === row)), { title: "its row of front.csv" })), noteOf(id), numbersOf(row, d));
    if (d?.reason) host.append(warn(`Not simulated: ${d.reason}`));
    if (d?.waits) host.append(element("p", { class: "note", role: "status" }, "Simulating it for its peaks\u2026"));
    if (d?.with_core) gapFigure(host, d), peakPart(host, d, 240);
    host.append(element("details", element("summary", "Evaluate, simplify, report: the commands"), element("pre", { tabindex: "0" }, commandsOf(id))));
    if (d?.with_core) drawerMore.rest(host, d);
  });
  drawer.dataset.id = d?.waits ? "" : id;
}

async function openDrawer(row) {
  const id = ids[row];
  if (!drawer.contains(document.activeElement)) [opener, openerTable] = [document.activeElement, `#${document.activeElement.closest("table")?.id || "main"}`];
  const answer = drawerMore.detail(row);
  drawer.dataset.wanted = id;
  fillDrawer(row, answer ? { waits: true } : id === run.chosen ? run.detail : null);
  showDrawer(true);
  drawer.scrollTop = 0;
  drawer.focus({ preventScroll: true });
  if (!answer) return;
  const d = await answer.catch((error) => ({ reason: error.message }));
  if (drawer.dataset.wanted === String(id) && !drawer.hidden) fillDrawer(row, d);
}
