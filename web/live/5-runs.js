// The runs of the folder that is served, and two of them over each other.

async function runsPart() {
  const runs = await ask("../runs");
  if (runs.length < 2) return;
  const part = livePart("runs", "Runs of this folder", "provenance"), here = +location.pathname.split("/").at(-2), body = element("div");
  const row = (r) => line([element("a", { href: `../${r.at}/` }, r.name), r.state,
    ...(r.state === "unreadable" ? [r.reason, "", ""] : [`${count(r.simulated)} of ${count(r.max_evals)}`, count(r.failed), count(r.front)]),
    r.at === here || r.state === "unreadable" ? "" : plainButton("Compare", () => against(body, r))], { class: r.at === here && "chosen" });
  part.append(table("all-runs", ["run", "state", "simulated", "failed", "front", ""], runs.map(row)), body);
}

async function against(body, other) {
  body.classList.add("stale");
  try {
    const { runs, differences } = await ask(`against/${other.at}`), colours = [BLUE, VERMILLION];
    refill(body, (host) => {
      if (differences.length) host.append(element("p", { class: "warn" }, `Two different problems, so that neither front is the better one: ${differences.join(", ")} differ.`));
      host.append(legend(runs.map((r, i) => [`${r.name}: ${count(r.f.length)} on the front`, colours[i]])));
      const grid = host.appendChild(element("div", { class: "grid2" }));
      const strip = grid.appendChild(element("figure", {}, element("h3", {}, "Both fronts")));
      frontStrip(strip, `Fronts of ${runs.map((r) => r.name).join(" and ")}`, 280)(runs.map((r, i) => ({ ...paleFront(r.f), colour: colours[i], alpha: 0.5 * paleFront(r.f).alpha })));
      const rows = runs.flatMap((r, i) => r.simulated.map((x, k) => ({ x, y: 100 * r.volume[k], colour: colours[i] })));
      figure(grid, "Hypervolume over the number of designs", "In one box for both: from a fifth of their range below the best of both fronts to the worst.", (width) => growthChart(width, 260, rows));
      const points = runs.flatMap((r, i) => r.f.map((f) => ({ x: f[objectives.indexOf(state.x)] * state.x.factor, y: f[objectives.indexOf(state.y)] * state.y.factor, colour: colours[i] })));
      if (objectives.includes(state.x) && objectives.includes(state.y))
        figure(grid, `${state.x.title} and ${state.y.title}`, "The axes are those of the scatter plot of two columns.", (width) => chart({
          width, height: 300, ariaLabel: "Both fronts", x: { label: titleUnit(state.x), grid: true }, y: { label: titleUnit(state.y), grid: true }, color: { type: "identity" },
          marks: [charts.dot(points, { x: "x", y: "y", stroke: "colour", r: 2.5 })] }));
    });
    body.dataset.at = other.at;
  } catch (error) {
    refill(body, (host) => host.append(element("p", { class: "warn" }, error.message)));
  }
  body.classList.remove("stale");
}
