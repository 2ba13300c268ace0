// While the designs and the library are still on their way: a line for every design of the front that is here so far.
(() => {
  const part = document.getElementById("first"), said = part.querySelector("p"), canvas = part.querySelector("canvas"), pen = canvas.getContext("2d");
  function draw() {
    if (!part.isConnected) return clearInterval(again); // the page is drawn
    const text = document.getElementById("rows")?.textContent, run = text && JSON.parse(document.getElementById("run").textContent);
    if (!text) return;
    const { objectives, variables } = run.schema, rows = text.slice(0, text.lastIndexOf("\n")).trim().split("\n").filter(Boolean).map((row) => row.split(",").slice(1 + variables.length)).map((cells) => objectives.map((o, k) => o.sense * cells[k]));
    const ranges = objectives.map((_, k) => rows.reduce(([a, b], f) => [Math.min(a, f[k]), Math.max(b, f[k])], [Infinity, -Infinity])), { width, height } = canvas;
    const at = (k) => 60 + (k * (width - 120)) / Math.max(1, objectives.length - 1), style = getComputedStyle(part);
    pen.clearRect(0, 0, width, height);
    [pen.font, pen.textAlign, pen.fillStyle, pen.strokeStyle, pen.globalAlpha] = ["12px sans-serif", "center", style.color, "#0072b2", 1];
    objectives.forEach((o, k) => pen.fillText(o.title, at(k), 14));
    pen.globalAlpha = 0.25;
    for (const f of rows) {
      pen.beginPath();
      f.forEach((v, k) => pen.lineTo(at(k), height - 10 - ((height - 40) * (v - ranges[k][0])) / (ranges[k][1] - ranges[k][0] || 1)));
      pen.stroke();
    }
    said.textContent = `Loading study ${run.name}: ${rows.length} designs so far; better is down.`;
    part.dataset.rows = rows.length;
  }
  const again = setInterval(draw, 200);
})();
