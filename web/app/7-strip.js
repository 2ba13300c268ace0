// ---- fronts as parallel coordinates, small and quick enough to follow a slider
// draw([{ rows: [[natural objective, ...]], colour, thick, alpha }]), the last on top; better is down. The first is drawn anew
// only where it, a range or the width has changed.
function frontStrip(host, label, height = 208) {
  const layers = host.appendChild(div("scroll")).appendChild(div("layers strip"));
  layers.style.minWidth = `${92 * objectives.length}px`; // no word lies on another
  const [back, over] = [0, 1].map((k) => layers.appendChild(element("canvas", k ? { role: "img", "aria-label": label } : { "aria-hidden": "true" })));
  const words = layers.appendChild(element("div", { class: "words", "aria-hidden": "true" }));
  const top = 22, bottom = 64, side = 54, down = height - bottom, span = down - top;
  let last = [], width = 0, ranges, drawnBack;
  layers.style.height = `${height}px`;

  function rangesOf(all) {
    const every = all.flatMap(({ rows }) => rows), ends = objectives.map((_, k) => charts.extent(every, (f) => f[k]));
    return ends.map(([low, high]) => [low, high > low ? high : low + 1]);
  }

  const at = (k) => (objectives.length > 1 ? side + (k * (width - 2 * side)) / (objectives.length - 1) : width / 2);
  function drawLines(pen, { rows, colour, thick = 1, alpha = 1 }) {
    pen.strokeStyle = colour;
    pen.lineWidth = thick;
    pen.globalAlpha = alpha;
    for (const f of rows) {
      pen.beginPath();
      f.forEach((v, k) => {
        const t = (v - ranges[k][0]) / (ranges[k][1] - ranges[k][0]);
        pen.lineTo(at(k), down - span * (objectives[k].sense < 0 ? 1 - t : t));
      });
      pen.stroke();
    }
  }

  function drawBack(first) {
    const pen = prepare(back, width, height);
    pen.strokeStyle = AXIS;
    objectives.forEach((_, k) => pen.strokeRect(at(k), top, 0, span));
    drawLines(pen, first);
    prepare(over, width, height);
    const room = Math.min(2 * side, (width - 2 * side) / Math.max(1, objectives.length - 1)); // of a word: the outer ones have no more
    words.replaceChildren(...objectives.flatMap((c, k) => {
      const [worse, better] = c.sense < 0 ? ranges[k] : [ranges[k][1], ranges[k][0]];
      return [[worse * c.factor, 2], [better * c.factor, down + 1], [null, down + 18]].map(([v, where]) =>
        element("span", { title: c.what, style: `left: ${at(k)}px; top: ${where}px; width: ${room}px` }, v === null ? titleUnit(c) : show(v)));
    }));
  }

  function draw(all) {
    last = all;
    width ||= layers.clientWidth;
    if (!width || !all.length) return;
    const now = rangesOf(all);
    if (drawnBack !== all[0].rows || now.join() !== ranges.join()) {
      ranges = now;
      drawnBack = all[0].rows;
      drawBack(all[0]);
    }
    const pen = over.getContext("2d");
    pen.clearRect(0, 0, width, height);
    for (const one of all.slice(1)) drawLines(pen, one);
  }

  addDrawing(layers, (newWidth) => {
    [width, drawnBack] = [newWidth, null];
    draw(last);
  });
  return draw;
}

const frontRows = charts.range(n).map((i) => objectives.map((c) => c.raw[i]));
const paleFront = (rows = frontRows) => ({ rows, colour: PALE, thick: 0.7, alpha: clamp(12 / Math.sqrt(rows.length + 1), [0.2, 0.8]) });
