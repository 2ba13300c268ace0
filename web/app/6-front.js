// The part on the front: what is shown, ranges by hand, all pictures of it, the table.
function presetChoice() {
  const presets = [["objectives", run.schema.limited.length ? "objectives and limited results" : "objectives", results], ["variables", "variables", variables], ["all", "both", [...results, ...variables]]];
  return element("fieldset", element("legend", "Axes"), ...presets.map(([value, label, axes]) => {
    const input = element("input", { type: "radio", name: "axes", value, onchange: () => {
      state.axes = [...axes];
      layoutChanged();
    } });
    views.layout.push(() => (input.checked = axes.length === state.axes.length && axes.every((c) => state.axes.includes(c))));
    return element("label", input, ` ${label}`);
  }));
}

// The bar of the colour, by the library; of choices and types their words.
function colourBar() {
  const host = div("colourbar");
  views.layout.push(() => {
    const c = state.colour, [low, high] = extent(c, []);
    host.replaceChildren(c.words ? legend((c.named ?? c.words).map((word, k) => [word, PALETTE[k]]))
      : charts.legend({ color: { type: "linear", domain: [low, high > low ? high : low + 1], interpolate: ramp }, label: titleUnit(c), ticks: 4, tickFormat: show, width: 230, style: { fontSize: "12px" } }));
  });
  return host;
}

// One legend for all pictures of the front: what is compared with, each of them to be turned off; the marked design.
function overlayLegend() {
  const marked = element("span", { "data-mark": "\u25cf", style: "--key: var(--ink)" });
  follow(null, () => (marked.textContent = state.marked === undefined ? "no design marked" : designName(state.marked)));
  return element("div", { class: "legend", id: "overlays" }, marked, ...overlays.map((o) => {
    const item = element("span", { "data-mark": o.mark, title: o.device, style: `--key: ${o.colour}` }, o.words);
    return element("label", element("input", { type: "checkbox", checked: o.isShown, name: o.key, onchange: (event) => {
      o.isShown = event.target.checked;
      layoutChanged();
    } }), item);
  }));
}

function overlaysChanged() {
  byId("overlays").replaceWith(overlayLegend());
  layoutChanged();
}

// Axes by a tick and ranges by two numbers, for those who would rather type than drag.
function rangeInputs() {
  const inputs = columns.map((c) => {
    const axis = element("input", { type: "checkbox", "aria-label": `${titleUnit(c)} is an axis`, onchange: () => {
      if (axis.checked) state.axes.push(c);
      else if (state.axes.length > 1) state.axes.splice(state.axes.indexOf(c), 1);
      layoutChanged();
    } });
    const [low, high] = ["from", "to"].map((word) => element("input", {
      type: "text", name: `${c.name} ${word}`, inputmode: "decimal", "aria-label": `${titleUnit(c)} ${word}`, onchange: () => take(c, low, high),
    }));
    return { c, axis, low, high, row: element("div", axis, element("span", { class: "name", title: c.what }, titleUnit(c)), low, "\u2013", high) };
  });

  function read(c, input, standard) {
    const text = input.value.trim(), at = c.words?.indexOf(text);
    const value = text === "" ? standard : c.words ? (at < 0 ? NaN : at) : +text;
    input.classList.toggle("bad", Number.isNaN(value));
    return value;
  }

  function take(c, low, high) {
    const range = [read(c, low, -Infinity), read(c, high, Infinity)];
    if (range.some(Number.isNaN)) return;
    setRanges([[c, range[0] === -Infinity && range[1] === Infinity ? null : range]]);
  }

  views.layout.push(() => {
    for (const { c, axis, low, high } of inputs) {
      axis.checked = state.axes.includes(c);
      [low.placeholder, high.placeholder] = [c.low, c.high].map(tickText(c));
    }
  });
  follow(null, () => {
    for (const { c, low, high } of inputs) {
      const range = state.ranges.get(c);
      if (document.activeElement !== low) low.value = range && range[0] > -Infinity ? tickText(c)(c.words ? Math.ceil(range[0]) : range[0]) : "";
      if (document.activeElement !== high) high.value = range && range[1] < Infinity ? tickText(c)(c.words ? Math.floor(range[1]) : range[1]) : "";
    }
  });
  return element("details", { id: "ranges" }, element("summary", "Axes and ranges as numbers"), div("ranges", ...inputs.map(({ row }) => row)));
}

function selectionBar() {
  const number = element("span", { class: "count", id: "count", role: "status" });
  const keep = plainButton("Keep", () => takeStep(true), { id: "keep", title: "look at the selected designs alone" });
  const exclude = plainButton("Exclude", () => takeStep(false), { id: "exclude", title: "look at all but the selected designs" });
  const clear = plainButton("Clear ranges", () => setRanges(columns.map((c) => [c, null])), { id: "clear" });
  const all = plainButton("All designs again", dropSteps, { id: "restore" }), back = plainButton("Undo", undo, { id: "undo" });
  follow(null, () => {
    number.textContent = `${count(state.nSelected)} of ${count(state.nKept)} designs selected${state.nKept < n ? `, ${count(n - state.nKept)} put aside` : ""}`;
    clear.disabled = state.ranges.size === 0;
    keep.disabled = !state.ranges.size || state.nSelected === 0;
    exclude.disabled = !state.ranges.size || state.nSelected === state.nKept;
    all.disabled = !state.steps.length;
    back.disabled = !past.length && addressOf() === (lastAddress ?? "");
  });
  return div("bar", number, keep, exclude, clear, all, back, plainButton("Download selection as CSV", () => saveFile(`${run.name}-selection.csv`, csvOf((i) => state.selected[i])), { id: "download", class: "plain main" }));
}

function frontPart() {
  const host = byId("front");
  host.append(
    note("Every line is a nondominated design; on an axis of an objective better is down. Drag along an axis, or over a box of dots, to select; " +
      "drag a title sideways to move its axis, down to turn it over, up to hide it; click a line or dot to mark its design." +
      (run.front > n ? ` Here are ${count(n)} of ${count(run.front)}` + " designs of the front: those with the lowest and the highest value of every objective and variable, the knee, the chosen design and polished ones, and the others evenly in the order of their evaluation; imtet export has all." : "")),
    selectionBar(), div("bar hide-in-print", presetChoice(), columnSelect("colour", "Colour", "colour"), colourBar()), overlayLegend());
  parallelCoordinates(host.appendChild(element("figure", { class: "scroll" })));
  host.append(rangeInputs());
  const grid = gridOf(host, 2);
  if (columns.length > 1) {
    const pair = grid.appendChild(element("figure", element("h3", "Scatter plot of two columns"), div("bar", columnSelect("x", "x", "x"), columnSelect("y", "y", "y"))));
    pairPlot(pair);
  }
  const maps = grid.appendChild(element("div"));
  for (const family of families) if (run.tower && !family[0].sense && family.length > 1) heatFigure(maps, family);
  if (objectives.length > 1) {
    weightsPart(folded(host, "Choose by weights or a reference point"));
    const matrix = folded(host, "All pairs of objectives, with their rank correlations");
    matrix.append(note("Above the diagonal Spearman\u2019s rank correlation of the selected designs: orange means that better in one is worse in the other, blue that both improve together."));
    scatterMatrix(matrix.appendChild(element("figure", { class: "scroll" })));
  }
  typesPart(host);
  const matters = folded(host, "Which variables matter");
  matters.hidden = !run.importance; // imtet serve finds it when it is wanted
  if (run.importance) importanceFigure(matters);
  const list = folded(host, "Selected designs as a table", true);
  list.append(note("Click a heading to sort, a number to mark that design in the pictures."));
  designTable(list.appendChild(element("div")));
}
