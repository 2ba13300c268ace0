// The selected designs as a table and as a file.
const PAGE = 12;

// A cell that a spreadsheet would run as a formula is given an apostrophe; numbers stay as they are.
function cell(text) {
  const s = /^[\s\u2000-\u200f]*[=+\-@\uff1d\uff0b\uff0d\uff20]/.test(text) && !finite(+text) ? `'${text}` : text;
  return /[",\r\n]/.test(s) ? `"${s.replaceAll('"', '""')}"` : s;
}

// The very rows of front.csv, in its order and units.
function csvOf(isWanted) {
  const names = ["id", ...run.schema.variables, ...results.map((c) => c.name), ...objectives.map((c) => `err_${c.name}`)];
  return [names.slice(0, lines[0].split(",").length).map(cell).join(","), ...lines.filter((_, i) => isWanted(i))].join("\n") + "\n";
}

function saveFile(name, text, type = "text/csv") {
  const url = URL.createObjectURL(new Blob([text], { type }));
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 60000);
}

// The page as it came, with what was kept since: it opens as any other.
function savePage() {
  byId("kept-designs").textContent = JSON.stringify(kept).replaceAll("<", "\\u003c");
  saveFile(run.name + "-kept.html", ["<!DOCTYPE html>", '<html lang="en">' + document.head.outerHTML, "<body>" + blank, ...Array.from(document.scripts, (e) => e.outerHTML), "</body>", "</html>"].join("\n"), "text/html");
}

function designTable(host) {
  const shown = [...results, ...variables], sort = {};
  let page = 0, order;

  const head = element("tr"), body = element("tbody");
  const back = plainButton("Previous", () => draw(page - 1)), next = plainButton("Next", () => draw(page + 1)), where = element("span");
  host.append(element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Selected designs" },
    element("table", { id: "designs" }, element("thead", head), body)), div("pages", back, where, next));

  head.append(element("th", { scope: "col" }, "design"), ...shown.map((c) => element("th", { scope: "col", title: c.what, class: !c.sense && "variable" },
    element("button", { type: "button", onclick: () => sortBy(c) }, c.title), ...heading(c).slice(1))));

  function rowOfDesign(i) {
    const id = ids[i], isKnee = id === run.knee, isBeyond = beyondLaw.has(id), note = run.notes[id];
    const name = element("button", { type: "button", title: "show this design in the pictures", onclick: () => mark(i), onfocus: () => hover(i), onblur: () => hover(undefined) }, String(id));
    const words = (isKnee ? " knee" : "") + (id === run.chosen && !isKnee ? " chosen" : "") + (isBeyond ? " \u26a0" : "") + (note ? " \u270e" : "");
    return element("tr", { "data-id": id, class: [i === state.marked && "marked", isKnee && "knee"].filter(Boolean).join(" "), onpointerenter: () => hover(i), onpointerleave: () => hover(undefined),
      title: [isBeyond && "maximum indentation beyond the range of the contact law", note].filter(Boolean).join("; ") },
    element("td", name, words), ...shown.map((c) => element("td", { class: !c.sense && "variable" }, known(c, i))));
  }

  function sortBy(c) {
    sort.down = sort.column === c ? !sort.down : c.sense < 0;
    sort.column = c;
    const { value } = c, sign = sort.down ? -1 : 1;
    order = Uint32Array.from({ length: n }, (_, i) => i).sort((a, b) => sign * (value[a] - value[b]) || a - b);
    shown.forEach((one, k) => head.children[k + 1].setAttribute("aria-sort", one !== c ? "none" : sort.down ? "descending" : "ascending"));
    draw(0);
  }

  function draw(to) {
    const last = Math.max(0, Math.ceil(state.nSelected / PAGE) - 1);
    page = clamp(to, [0, last]);
    const first = page * PAGE, found = [];
    for (let k = 0, passed = 0; k < n && found.length < PAGE; k++)
      if (state.selected[order[k]] && passed++ >= first) found.push(order[k]);
    refillRows(body, ...found.map(rowOfDesign));
    back.disabled = page === 0;
    next.disabled = page >= last;
    where.textContent = found.length ? `${count(first + 1)}\u2013${count(first + found.length)} of ${count(state.nSelected)}` : "no design within these ranges";
  }

  views.hover.push(() => {
    for (const tr of body.rows) tr.classList.toggle("hovered", +tr.dataset.id === ids[state.hovered]);
  });
  sortBy(objectives[0]);
  follow(host, () => draw(page));
}
