// The runs of the folder that is served, and two of them over each other.

async function runsPart() {
  const runs = await ask("../runs");
  if (runs.length < 2) return;
  const part = livePart("runs", "Runs of this folder", "provenance"), here = +location.pathname.split("/").at(-2), body = element("div");
  const line = (r) => element("tr", { class: r.at === here ? "chosen" : "" }, element("td", {}, element("a", { href: `../${r.at}/` }, r.name)), element("td", {}, r.state),
    ...(r.state === "unreadable" ? [element("td", { colspan: 4 }, r.reason)] : [`${count(r.simulated)} of ${count(r.max_evals)}`, count(r.failed), count(r.front), r.hypervolume === null ? "\u2013" : show(100 * r.hypervolume)].map((text) => element("td", {}, text))),
    element("td", {}, r.at === here || r.state === "unreadable" ? "" : plainButton("Compare", () => against(body, r))));
  part.append(element("div", { class: "scroll" }, element("table", { id: "all-runs" }, element("thead", {}, element("tr", {}, ...["run", "state", "simulated", "failed", "front", "hypervolume %", ""].map((text) => element("th", { scope: "col" }, text)))),
    element("tbody", {}, ...runs.map(line)))), body);
}

async function against(body, other) {
  body.classList.add("stale");
  try {
    const { runs } = await ask(`against/${other.at}`), colours = [BLUE, VERMILLION];
    refill(body, (host) => {
      host.append(legend(runs.map((r, i) => [`${r.name}: ${count(r.f.length)} on the front`, colours[i]])));
      const grid = host.appendChild(element("div", { class: "grid2" }));
      const strip = grid.appendChild(element("figure", {}, element("h3", {}, "Both fronts")));
      frontStrip(strip, `Fronts of ${runs.map((r) => r.name).join(" and ")}`, 280)(runs.map((r, i) => ({ ...paleFront(r.f), colour: colours[i], alpha: 0.5 * paleFront(r.f).alpha })));
      const rows = runs.flatMap((r, i) => r.simulated.map((x, k) => ({ x, y: 100 * r.volume[k], colour: colours[i] })));
      figure(grid, "Hypervolume over the number of designs", "In one box for both: from a fifth of their range below the best of both fronts to the worst.", (width) => chart({
        width, height: 260, ariaLabel: "Hypervolume of both runs", x: { label: "designs simulated", tickFormat: count }, y: { label: "hypervolume [%]", grid: true, zero: true, nice: true },
        color: { type: "identity" }, marks: [charts.lineY(rows, { x: "x", y: "y", z: "colour", stroke: "colour", strokeWidth: 2 })] }));
      const points = runs.flatMap((r, i) => r.f.map((f) => ({ x: f[objectives.indexOf(state.x)] * state.x.factor, y: f[objectives.indexOf(state.y)] * state.y.factor, colour: colours[i] })));
      if (objectives.includes(state.x) && objectives.includes(state.y))
        figure(grid, `${state.x.title} and ${state.y.title}`, "The axes are those of the two columns against each other.", (width) => chart({
          width, height: 300, ariaLabel: "Both fronts", x: { label: titleUnit(state.x), grid: true }, y: { label: titleUnit(state.y), grid: true }, color: { type: "identity" },
          marks: [charts.dot(points, { x: "x", y: "y", stroke: "colour", r: 2.5 })] }));
    });
    body.dataset.at = other.at;
  } catch (error) {
    refill(body, (host) => host.append(element("p", { class: "warn" }, error.message)));
  }
  body.classList.remove("stale");
}
