// The selected designs as a table and as a file.

const PAGE = 20;

// A cell that a spreadsheet would run as a formula is given an apostrophe; numbers stay as they are.
function cell(text) {
  const s = /^[=+\-@\t\r]/.test(text) && !Number.isFinite(+text) ? `'${text}` : text;
  return /[",\r\n]/.test(s) ? `"${s.replaceAll('"', '""')}"` : s;
}

// The very rows of front.csv, in its order and units.
function selectedCsv() {
  const head = ["id", ...run.schema.variables, ...run.schema.objectives.map((o) => o.name)].map(cell).join(",");
  return [head, ...lines.filter((_, i) => state.selected[i])].join("\n") + "\n";
}

function download() {
  const url = URL.createObjectURL(new Blob([selectedCsv()], { type: "text/csv" }));
  element("a", { href: url, download: `${run.name}-selection.csv` }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

function designTable(host) {
  const shown = [...objectives, ...variables];
  const sort = { column: objectives[0], down: objectives[0].sense < 0 };
  let page = 0, rows = [];

  const head = element("tr");
  const body = element("tbody");
  const pages = element("div", { class: "pages" });
  host.append(element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Selected designs" },
    element("table", { id: "designs" }, element("thead", {}, head), body)), pages);

  function sortBy(c) {
    sort.down = sort.column === c ? !sort.down : c.sense < 0;
    sort.column = c;
    page = 0;
    draw();
  }

  head.append(element("th", { scope: "col" }, "design"), ...shown.map((c) => element("th", { scope: "col", title: c.what, class: !c.sense && "variable" },
    element("button", { type: "button", onclick: () => sortBy(c) }, c.title), ...heading(c).slice(1))));

  function drawHead() {
    shown.forEach((c, k) => {
      const th = head.children[k + 1];
      if (c === sort.column) th.setAttribute("aria-sort", sort.down ? "descending" : "ascending");
      else th.removeAttribute("aria-sort");
    });
  }

  function rowFor(i) {
    const kind = [i === state.marked && "marked", ids[i] === run.knee && "knee"].filter(Boolean).join(" ");
    return element("tr", { class: kind, "data-id": ids[i] },
      element("td", {}, element("button", { type: "button", title: "show this design in the pictures", onclick: () => mark(i) }, String(ids[i])),
        ids[i] === run.knee ? " knee" : "", ids[i] === run.chosen && run.chosen !== run.knee ? " chosen" : ""),
      ...shown.map((c) => element("td", { class: !c.sense && "variable" }, digits(c.value[i]))));
  }

  function turn(by) {
    page += by;
    drawRows();
  }

  function drawRows() {
    const last = Math.max(0, Math.ceil(rows.length / PAGE) - 1);
    page = Math.max(0, Math.min(page, last));
    body.replaceChildren(...Array.from(rows.slice(page * PAGE, (page + 1) * PAGE), rowFor));
    pages.replaceChildren(
      element("button", { class: "plain", type: "button", disabled: page === 0, onclick: () => turn(-1) }, "Previous"),
      element("span", {}, rows.length ? `${count(page * PAGE + 1)}\u2013${count(Math.min(rows.length, (page + 1) * PAGE))} of ${count(rows.length)}` : "no design within these ranges"),
      element("button", { class: "plain", type: "button", disabled: page >= last, onclick: () => turn(1) }, "Next"));
  }

  function draw() {
    const { value } = sort.column, sign = sort.down ? -1 : 1;
    rows = Uint32Array.from({ length: state.nSelected });
    for (let i = 0, k = 0; i < n; i++) if (state.selected[i]) rows[k++] = i;
    rows.sort((a, b) => sign * (value[a] - value[b]) || a - b);
    drawHead();
    drawRows();
  }

  views.selection.push(draw);
}
