// What stands around a design that is asked about: slices along a variable, and what a millimetre of its gaps does. now() is the
// question of that design, lower and upper the box of the search.
function aroundPart(host, now, { lower, upper, values }) {
  const part = folded(host, "Slices, and what a millimetre does"), real = charts.range(variables.length).filter((j) => !variables[j].words);
  const select = element("select", { name: "slice", "aria-label": "variable of the slice" }, ...real.map((j) => element("option", { value: j }, variables[j].title)));
  const grid = gridOf(part, 3), board = element("div"), shown = objectives.slice(0, 3), rows = [];
  let slices = 0, perturbed = 0, axis, at; // one that is asked for anew ends the one before of its kind
  const redraws = shown.map((c, k) => drawn(grid, (width) => chart({
    width, height: 220, marginLeft: 72, ariaLabel: `${c.title} along a variable`, x: { label: axis ? titleUnit(axis) : "", ticks: 4 }, y: { label: titleUnit(c), grid: true, nice: true, ticks: 5 },
    marks: [charts.ruleX(axis ? [at] : [], { stroke: TRIAL }), charts.lineY(rows, { x: "x", y: (r) => r.f[k] * c.factor, stroke: INK }), charts.dot(rows, { x: "x", y: (r) => r.f[k] * c.factor, r: 2.5, fill: INK })],
  })));

  // From bound to bound, drawn as it comes; another slice ends this one.
  async function slice() {
    const mine = ++slices, j = +select.value, question = now(), steps = values[j] ?? charts.range(21).map((i) => lower[j] + (i / 20) * (upper[j] - lower[j]));
    [axis, at] = [variables[j], question.x[j] * variables[j].factor];
    rows.length = 0;
    for (const v of steps) {
      const { objectives: f } = await simulated({ ...question, x: question.x.with(j, v) });
      if (mine !== slices) return;
      if (f) rows.push({ x: v * axis.factor, f });
      for (const redraw of redraws) redraw();
    }
  }

  // Sixteen designs whose gaps are all off by so much, one way or the other.
  async function perturb() {
    const mine = ++perturbed, question = now(), gaps = real.filter((j) => /^gap/.test(variables[j].name));
    let seed = 1;
    const sign = () => ((seed = (seed * 48271) % 2147483647) & 1024 ? 1 : -1);
    const before = (await simulated(question)).objectives, found = [line(["as it is", ...besides(before)])];
    for (const mm of [1, 5]) {
      const all = [];
      for (let i = 0; i < 16; i++) {
        const x = [...question.x];
        for (const j of gaps) x[j] = Math.max(0, x[j] + 1e-3 * mm * sign());
        all.push((await simulated({ ...question, x })).objectives);
        if (mine !== perturbed) return;
      }
      const good = all.filter(Boolean);
      found.push(line([`all gaps ± ${mm} mm`, ...objectives.map((c, k) => figureText(c.factor * charts.mean(good, (f) => f[k]), c.factor * charts.deviation(good, (f) => f[k])))]));
      board.replaceChildren(table("millimetre", ["mean and standard deviation of 16", ...objectives], found));
    }
  }

  part.append(div("bar", element("label", "Slice along ", select), plainButton("Simulate the slice", slice, { id: "slice" }), plainButton("What a millimetre does", perturb, { id: "perturb", disabled: !real.some((j) => /^gap/.test(variables[j].name)) })), board);
  part.insertBefore(part.lastElementChild.previousElementSibling, grid);
}
