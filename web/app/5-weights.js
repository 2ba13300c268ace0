// Designs ranked by weights, or by how far they are from values wished for: the costs of imtet choose --weights and --reference.

const RANKED = 8;
const score = Object.assign(columnOf("score", -1, 0, ["score of the choice", "", 1, "weighted sum of the objectives over their ranges, or distance from the wishes: lower is better"]), { sense: 1, bounds: [NaN, NaN] });
score.family = [score];
columns.push(score);

function findScores() {
  const { weights, wishes } = state;
  for (let i = 0; i < n; i++) {
    let sum = 0;
    for (const c of objectives) {
      const weight = weights.get(c) ?? 1, span = c.max - c.min || 1;
      if (!wishes.size) sum += weight * scaled(c, i);
      else if (wishes.has(c)) sum += weight * ((c.value[i] - wishes.get(c)) / span) ** 2;
    }
    score.raw[i] = score.value[i] = wishes.size ? Math.sqrt(sum) : sum;
  }
}

function weightsPart(host) {
  const list = element("div"), fields = objectives.map((c) => {
    const weight = element("input", { type: "range", min: 0, max: 10, step: 0.5, name: `${c.name} weight`, "aria-label": `weight of ${c.title}` }), told = element("output");
    const wish = element("input", { type: "text", inputmode: "decimal", name: `${c.name} wish`, "aria-label": `${titleUnit(c)} wished for`, placeholder: `${show(c.min)} to ${show(c.max)}` });
    weight.addEventListener("input", () => take(state.weights.set(c, +weight.value)));
    wish.addEventListener("change", () => {
      const v = wish.value.trim() === "" ? null : +wish.value;
      wish.classList.toggle("bad", Number.isNaN(v));
      if (v === null) state.wishes.delete(c);
      else if (!Number.isNaN(v)) state.wishes.set(c, v);
      take();
    });
    return { c, weight, told, wish, row: element("div", { class: "weight" }, element("span", { title: c.what }, titleUnit(c)), weight, told, wish) };
  });

  function take() {
    findScores();
    state.colour = score;
    findKept(); // the ends of its scale
    layoutChanged();
  }

  function rank() {
    for (const { c, weight, told, wish } of fields) {
      weight.value = told.textContent = state.weights.get(c) ?? 1;
      if (document.activeElement !== wish) wish.value = state.wishes.get(c) ?? "";
    }
    const best = Array.from({ length: n }, (_, i) => i).filter((i) => state.selected[i]).sort((a, b) => score.value[a] - score.value[b] || a - b).slice(0, RANKED);
    list.replaceChildren(table("ranked", ["design", "score", ...objectives], best.map((i) => line([element("button", { type: "button", onclick: () => mark(i) }, String(ids[i])), digits(score.value[i]), ...objectives.map((c) => known(c, i))], { "data-id": ids[i] }))));
  }

  host.append(element("p", { class: "note" }, "Weights of the objectives over their ranges on the front; with a value wished for in any objective, the nearest design to the wishes. The pictures are coloured by the score; the best of the selected designs:"),
    element("div", { class: "weights" }, ...fields.map(({ row }) => row)),
    element("div", { class: "bar" }, plainButton("Equal weights, no wishes", () => {
      state.weights.clear();
      state.wishes.clear();
      take();
    })), list);
  findScores();
  follow(list, rank);
}
