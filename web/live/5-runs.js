// The runs of the folder that is served, and some of them over each other.
const RUNS_BESIDE = 3; // this one

async function runsPart() {
  const all = await ask("../runs"), here = +location.pathname.split("/").at(-2);
  if (all.length < 2) return;
  const part = laterPart("runs", "Runs of this folder", "summary"), list = part.appendChild(element("div")), body = part.appendChild(element("div"));
  const box = (r) => element("input", { type: "checkbox", name: `compare ${r.name}`, "aria-label": `compare ${r.name}`, value: r.at, onchange: () => {
    const boxes = [...part.querySelectorAll("[type=checkbox]")], chosen = boxes.filter((b) => b.checked).map((b) => b.value);
    for (const b of boxes) b.disabled = !b.checked && chosen.length === RUNS_BESIDE;
    if (chosen.length) against(body, chosen);
    else body.replaceChildren();
  } });
  const tell = (promise) => promise.catch((error) => body.replaceChildren(warn(error.message)));
  // null: it is removed.
  const move = (r, name) => tell(ask(`../${r.at}/move`, { name }).then((now) => {
    if (r.at === here) location.href = `../${now.find((one) => one.name === name)?.at ?? ""}`;
    else show(now);
  }));
  const row = (r) => line([r.at === here || r.state === "unreadable" ? "" : box(r), element("a", { href: `../${r.at}/` }, r.name), r.state,
    ...(r.state === "unreadable" ? [r.reason, "", "", "", ""] : [`${count(r.simulated)} of ${count(r.max_evals)}`, count(r.failed), count(r.front),
      element("input", { type: "text", name: `note ${r.name}`, "aria-label": `note on ${r.name}`, value: r.note ?? "", onchange: ({ target }) => tell(ask(`../${r.at}/notes`, { id: 0, text: target.value.trim() })) }),
      [plainButton("Rename", () => ((name) => name && name !== r.name && move(r, name))(prompt("New name of the run", r.name))), " ",
        plainButton("Delete", () => confirm(`Delete the run ${r.name} with all files in its folder?`) && move(r, null))]])], { class: r.at === here && "chosen" });
  const show = (runs) => list.replaceChildren(table("all-runs", ["compare", "run", "state", "simulated", "failed", "front", "note", ""], runs.map(row)));
  show(all);
}

async function against(body, others) {
  const wanted = (body.dataset.wanted = String(others));
  body.classList.add("stale");
  try {
    const { runs, differences } = await ask(`against/${others}`), colours = SIDES.map(({ colour }) => colour);
    if (body.dataset.wanted !== wanted) return;
    refill(body, (host) => {
      if (differences.length) host.append(warn("Different problems, so that no front is the better one; what differs: " + differences.join(", ")));
      host.append(legend(runs.map((r, i) => [`${r.name}: ${count(r.f.length)} on the front`, colours[i]])));
      const grid = gridOf(host, 2);
      const strip = grid.appendChild(element("figure", element("h3", "The fronts")));
      frontStrip(strip, `Fronts of ${runs.map((r) => r.name).join(" and ")}`, 280)(runs.map((r, i) => ({ ...paleFront(r.f), colour: colours[i], alpha: 0.5 * paleFront(r.f).alpha })));
      const rows = runs.flatMap((r, i) => r.simulated.map((x, k) => ({ x, y: 100 * r.volume[k], colour: colours[i] })));
      figure(grid, "Hypervolume over the number of designs", "One box for all fronts: from a fifth of their range beyond the best to the worst.", (width) => growthChart(width, 260, rows));
    });
  } catch (error) {
    refill(body, (host) => host.append(warn(error.message)));
  }
  body.classList.remove("stale");
}
