// The runs of the folder that is served, and some of them over each other.
const RUNS_BESIDE = 3; // this one

async function runsPart() {
  const runs = await ask("../runs");
  if (runs.length < 2) return;
  const part = laterPart("runs", "Runs of this folder", "provenance"), here = +location.pathname.split("/").at(-2), body = element("div");
  const box = (r) => element("input", { type: "checkbox", name: `compare ${r.name}`, "aria-label": `compare ${r.name}`, value: r.at, onchange: () => {
    const boxes = [...part.querySelectorAll("input")], chosen = boxes.filter((b) => b.checked).map((b) => b.value);
    for (const b of boxes) b.disabled = !b.checked && chosen.length === RUNS_BESIDE;
    if (chosen.length) against(body, chosen);
    else body.replaceChildren();
  } });
  const row = (r) => line([r.at === here || r.state === "unreadable" ? "" : box(r), element("a", { href: `../${r.at}/` }, r.name), r.state,
    ...(r.state === "unreadable" ? [r.reason, "", ""] : [`${count(r.simulated)} of ${count(r.max_evals)}`, count(r.failed), count(r.front)])], { class: r.at === here && "chosen" });
  part.append(table("all-runs", ["compare", "run", "state", "simulated", "failed", "front"], runs.map(row)), body);
}

async function against(body, others) {
  const wanted = (body.dataset.wanted = String(others));
  body.classList.add("stale");
  try {
    const { runs, differences } = await ask(`against/${others}`), colours = SIDES.map(({ colour }) => colour);
    if (body.dataset.wanted !== wanted) return;
    refill(body, (host) => {
      if (differences.length) host.append(warn(`Different problems, so that no front is the better one: ${differences.join(", ")} differ.`));
      host.append(legend(runs.map((r, i) => [`${r.name}: ${count(r.f.length)} on the front`, colours[i]])));
      const grid = gridOf(host, 2);
      const strip = grid.appendChild(element("figure", element("h3", "The fronts")));
      frontStrip(strip, `Fronts of ${runs.map((r) => r.name).join(" and ")}`, 280)(runs.map((r, i) => ({ ...paleFront(r.f), colour: colours[i], alpha: 0.5 * paleFront(r.f).alpha })));
      const rows = runs.flatMap((r, i) => r.simulated.map((x, k) => ({ x, y: 100 * r.volume[k], colour: colours[i] })));
      figure(grid, "Hypervolume over the number of designs", "In one box for all: from a fifth of their range below the best of all fronts to the worst.", (width) => growthChart(width, 260, rows));
      const points = runs.flatMap((r, i) => r.f.map((f) => ({ x: f[objectives.indexOf(state.x)] * state.x.factor, y: f[objectives.indexOf(state.y)] * state.y.factor, colour: colours[i] })));
      if (objectives.includes(state.x) && objectives.includes(state.y))
        figure(grid, `${state.x.title} and ${state.y.title}`, "The axes are those of the scatter plot of two columns.", (width) => chart({
          width, height: 300, ariaLabel: "The fronts", x: { label: titleUnit(state.x), grid: true }, y: { label: titleUnit(state.y), grid: true },
          marks: [charts.dot(points, { x: "x", y: "y", stroke: "colour", r: 2.5 })] }));
    });
  } catch (error) {
    refill(body, (host) => host.append(warn(error.message)));
  }
  body.classList.remove("stale");
}
