// The selected designs as a table and as a file.

const PAGE = 12;

// A cell that a spreadsheet would run as a formula is given an apostrophe; numbers stay as they are.
function cell(text) {
  const s = /^[\s\u2000-\u200f]*[=+\-@\uff1d\uff0b\uff0d\uff20]/.test(text) && !Number.isFinite(+text) ? `'${text}` : text;
  return /[",\r\n]/.test(s) ? `"${s.replaceAll('"', '""')}"` : s;
}

// The very rows of front.csv, in its order and units.
function csvOf(isWanted) {
  const head = ["id", ...run.schema.variables, ...results.map((c) => c.name), ...(hasErrors ? objectives.map((c) => `err_${c.name}`) : [])].map(cell).join(",");
  return [head, ...lines.filter((_, i) => isWanted(i))].join("\n") + "\n";
}

function saveFile(name, text) {
  const url = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 60000);
}

const download = () => saveFile(`${run.name}-selection.csv`, csvOf((i) => state.selected[i]));

function designTable(host) {
  const shown = [...results, ...variables];
  const sort = { column: objectives[0], down: objectives[0].sense < 0 };
  let page = 0, order;

  const head = element("tr"), body = element("tbody");
  const back = plainButton("Previous", () => turn(-1)), next = plainButton("Next", () => turn(1)), where = element("span");
  host.append(element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Selected designs" },
    element("table", { id: "designs" }, element("thead", {}, head), body)), element("div", { class: "pages" }, back, where, next));

  head.append(element("th", { scope: "col" }, "design"), ...shown.map((c) => element("th", { scope: "col", title: c.what, class: !c.sense && "variable" },
    element("button", { type: "button", onclick: () => sortBy(c) }, c.title), ...heading(c).slice(1))));

  // Rows are made once and filled anew: a brush must not wait for a table.
  const rows = Array.from({ length: Math.min(PAGE, n) }, () => {
    const name = element("button", { type: "button", title: "show this design in the pictures" }), note = new Text();
    const cells = shown.map((c) => element("td", { class: !c.sense && "variable" })), row = { name, note, cells, tr: element("tr", {}, element("td", {}, name, note), ...cells) };
    name.addEventListener("click", () => mark(row.design));
    row.tr.addEventListener("pointerenter", () => hover(row.design));
    row.tr.addEventListener("pointerleave", () => hover(undefined));
    name.addEventListener("focus", () => hover(row.design));
    name.addEventListener("blur", () => hover(undefined));
    return row;
  });
  body.append(...rows.map((row) => row.tr));

  function fill(row, i) {
    row.tr.hidden = i === undefined;
    row.design = i;
    if (i === undefined) return;
    row.tr.dataset.id = ids[i];
    row.tr.className = [i === state.marked && "marked", ids[i] === run.knee && "knee"].filter(Boolean).join(" ");
    row.name.textContent = String(ids[i]);
    row.note.data = (ids[i] === run.knee ? " knee" : "") + (ids[i] === run.chosen && run.chosen !== run.knee ? " chosen" : "") + (beyondLaw.has(ids[i]) ? " \u26a0" : "") + (run.notes[ids[i]] ? " \u270e" : "");
    row.tr.title = [beyondLaw.has(ids[i]) && "maximum indentation beyond what the contact law is meant for", run.notes[ids[i]]].filter(Boolean).join("; ");
    shown.forEach((c, k) => (row.cells[k].textContent = known(c, i)));
  }

  function sortBy(c) {
    sort.down = sort.column === c ? !sort.down : c.sense < 0;
    sort.column = c;
    page = 0;
    putInOrder();
    draw();
  }

  function putInOrder() {
    const { value } = sort.column, sign = sort.down ? -1 : 1;
    order = Uint32Array.from({ length: n }, (_, i) => i).sort((a, b) => sign * (value[a] - value[b]) || a - b);
    shown.forEach((c, k) => {
      const th = head.children[k + 1];
      if (c === sort.column) th.setAttribute("aria-sort", sort.down ? "descending" : "ascending");
      else th.removeAttribute("aria-sort");
    });
  }

  function turn(by) {
    page += by;
    draw();
  }

  function draw() {
    const last = Math.max(0, Math.ceil(state.nSelected / PAGE) - 1);
    page = Math.max(0, Math.min(page, last));
    const first = page * PAGE, found = [];
    for (let k = 0, passed = 0; k < n && found.length < PAGE; k++)
      if (state.selected[order[k]] && passed++ >= first) found.push(order[k]);
    rows.forEach((row, k) => fill(row, found[k]));
    back.disabled = page === 0;
    next.disabled = page >= last;
    where.textContent = found.length ? `${count(first + 1)}\u2013${count(first + found.length)} of ${count(state.nSelected)}` : "no design within these ranges";
  }

  views.hover.push(() => {
    for (const row of rows) row.tr.classList.toggle("hovered", row.design !== undefined && row.design === state.hovered);
  });
  putInOrder();
  follow(host, draw);
}
