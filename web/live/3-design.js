// Any design at a click on its line, dot or row: simulated by the server, once, for the drawer.
const details = new Map(); // id -> promise
function detailOf(id) {
  if (!details.has(id)) {
    details.set(id, ask(`design/${id}`));
    details.get(id).catch(() => details.delete(id));
  }
  return details.get(id);
}

drawerMore.detail = (row) => detailOf(ids[row]).then(({ detail }) => detail);
drawerMore.rest = (host, d) => detailParts(folded(host, "Forces, energies and more"), d, true);

storeKept = (x) => ask("kept", { x });
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
  overlaysChanged();
}

// Which variables matter is found when its part is opened.
const matters = byId("which-variables-matter");
matters.hidden = false;
matters.addEventListener("toggle", async () => {
  if (!run.importance) run.importance = await ask("importance").catch(() => null);
  if (run.importance) importanceFigure(matters);
  else matters.append(note("Too few designs succeeded to tell."));
  drawAll();
}, { once: true });
