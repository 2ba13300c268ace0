// Designs ranked by weights, or by how far they are from a reference point: the costs of imtet choose --weights and --reference.
const RANKED = 8;
const score = Object.assign(columnOf("score", -1, 0, ["score of the choice", "", 1, "weighted sum of the objectives over their ranges, or distance from the reference point: lower is better"]), { sense: 1, bounds: [NaN, NaN] });
score.family = [score];
columns.push(score);

function findScores() {
  const { weights, reference } = state;
  for (let i = 0; i < n; i++) {
    let sum = 0;
    for (const c of objectives) {
      const weight = weights.get(c) ?? 1, span = c.max - c.min || 1;
      if (!reference.size) sum += weight * scaled(c, i);
      else if (reference.has(c)) sum += weight * ((c.value[i] - reference.get(c)) / span) ** 2;
    }
    score.raw[i] = score.value[i] = reference.size ? Math.sqrt(sum) : sum;
  }
}

function weightsPart(host) {
  const list = element("div"), fields = objectives.map((c) => {
    const weight = element("input", { type: "range", min: 0, max: 10, step: 0.5, name: `${c.name} weight`, "aria-label": `weight of ${c.title}` }), told = element("output");
    const point = element("input", { type: "text", inputmode: "decimal", name: `${c.name} reference`, "aria-label": `${titleUnit(c)} of the reference point`, placeholder: `${show(c.min)} to ${show(c.max)}` });
    weight.oninput = () => take(state.weights.set(c, +weight.value));
    point.onchange = () => {
      const v = point.value.trim() === "" ? null : +point.value;
      point.classList.toggle("bad", Number.isNaN(v));
      if (v === null) state.reference.delete(c);
      else if (!Number.isNaN(v)) state.reference.set(c, v);
      take();
    };
    return { c, weight, told, point, row: div("weight", element("span", { title: c.what }, titleUnit(c)), weight, told, point) };
  });

  function take() {
    findScores();
    state.colour = score;
    findKept(); // the ends of its scale
    layoutChanged();
  }

  function rank() {
    for (const { c, weight, told, point } of fields) {
      weight.value = told.textContent = state.weights.get(c) ?? 1;
      if (document.activeElement !== point) point.value = state.reference.get(c) ?? "";
    }
    const best = charts.range(n).filter((i) => state.selected[i]).sort((a, b) => score.value[a] - score.value[b] || a - b).slice(0, RANKED);
    refillRows(list, table("ranked", ["design", "score", ...objectives], best.map((i) => line([element("button", { type: "button", onclick: () => mark(i) }, String(ids[i])), digits(score.value[i]), ...objectives.map((c) => known(c, i))], { "data-id": ids[i] }))));
  }

  host.append(note("Weights of the objectives over their ranges on the front. Enter a target to rank designs by their distance from it. The pictures are coloured by the score (lower is better); the best of the selected designs:"),
    div("weights", ...fields.map(({ row }) => row)),
    div("bar", plainButton("Equal weights, no reference point", () => {
      state.weights.clear();
      state.reference.clear();
      take();
    })), list);
  findScores();
  follow(list, rank);
}
