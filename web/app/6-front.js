// The part on the front: what is shown, ranges by hand, both pictures, the table.

function choice(name, text, options, value, take) {
  return element("fieldset", {}, element("legend", {}, text), ...options.map(([key, label]) => element("label", {},
    element("input", { type: "radio", name, value: key, checked: key === value, onchange: () => take(key) }), ` ${label}`)));
}

function colourChoice() {
  const low = element("span"), high = element("span"), ramp = element("canvas", { class: "ramp", width: SHADES, height: 1, "aria-hidden": "true" });
  const pen = ramp.getContext("2d");
  RAMP.forEach((colour, i) => {
    pen.fillStyle = colour;
    pen.fillRect(i, 0, 1, 1);
  });
  const select = element("select", { id: "colour", onchange: () => {
    state.colour = columns[select.selectedIndex];
    findShades();
    draw();
    layoutChanged();
  } }, ...columns.map((c) => element("option", { selected: c === state.colour }, c.title)));
  function draw() {
    low.textContent = `${show(state.colour.min)} `;
    high.textContent = ` ${withUnit(state.colour, state.colour.max)}`;
  }
  draw();
  return [element("label", {}, "Colour ", select), element("span", { class: "ramplegend" }, low, ramp, high)];
}

// A range by two numbers, for those who would rather type than drag.
function rangeInputs() {
  const box = element("div", { class: "ranges" });
  const inputs = columns.map((c) => {
    const unit = c.unit ? ` [${c.unit}]` : "";
    const [low, high] = ["from", "to"].map((word) => element("input", {
      type: "text", name: `${c.name} ${word}`, inputmode: "decimal", "aria-label": `${c.title}${unit} ${word}`, onchange: () => take(c, low, high),
    }));
    low.placeholder = show(c.min);
    high.placeholder = show(c.max);
    return { c, low, high, row: element("div", {}, element("span", { class: "name", title: c.what }, c.title + unit), low, "\u2013", high) };
  });

  function read(input, standard) {
    const value = input.value.trim() === "" ? standard : +input.value;
    input.classList.toggle("bad", Number.isNaN(value));
    return value;
  }

  function take(c, low, high) {
    const range = [read(low, -Infinity), read(high, Infinity)];
    if (range.some(Number.isNaN)) return;
    setRanges([[c, range[0] === -Infinity && range[1] === Infinity ? null : range]]);
  }

  box.append(...inputs.map(({ row }) => row));
  follow(null, () => {
    for (const { c, low, high } of inputs) {
      const range = state.ranges.get(c);
      if (document.activeElement !== low) low.value = range && range[0] > -Infinity ? show(range[0]) : "";
      if (document.activeElement !== high) high.value = range && range[1] < Infinity ? show(range[1]) : "";
    }
  });
  return element("details", { id: "ranges" }, element("summary", {}, "Ranges as numbers"), box);
}

function frontPart() {
  const host = document.getElementById("front");
  const number = element("span", { class: "count", id: "count", role: "status" });
  const clear = element("button", { class: "plain", id: "clear", type: "button", onclick: clearRanges }, "Clear ranges");
  follow(null, () => {
    number.textContent = `${count(state.nSelected)} of ${count(n)} designs selected`;
    clear.disabled = state.ranges.size === 0;
  });
  const axes = [["objectives", "objectives"], ["variables", "variables"], ["all", "both"]];
  const [upper, lower, matrix] = Array.from({ length: 3 }, () => element("figure", { class: "scroll" }));
  const table = element("div");
  host.append(
    element("p", { class: "note" }, "Every line is a nondominated design. Drag along an axis, or over a box of the " +
      "scatter matrix, to keep only the designs within it; drag the range to move it, click beside it to drop it. On an axis of an " +
      "objective better is down. The black line and dot are the design marked in the table."),
    element("div", { class: "bar" }, number, clear,
      element("button", { class: "plain main", id: "download", type: "button", onclick: download }, "Download selection as CSV")), element("div", { class: "bar hide-in-print" },
      choice("axes", "Axes", axes, state.axes, (key) => {
        state.axes = key;
        layoutChanged();
      }), ...colourChoice()),
    upper, lower, rangeInputs(), matrix,
    element("h3", { class: "part" }, "Selected designs"),
    element("p", { class: "note" }, "Click a heading to sort, a number to mark that design in the pictures."),
    table);
  parallelCoordinates(upper, "objectives", objectives);
  parallelCoordinates(lower, "variables", variables);
  if (objectives.length > 1) scatterMatrix(matrix);
  designTable(table);
  findShades();
}
