// ---- live: what only a page with the program behind it has. Addresses are relative to /TOKEN/RUN/.

async function ask(where, body) {
  const answer = await fetch(where, body ? { method: "POST", body: JSON.stringify(body) } : {});
  const said = await answer.json();
  if (!answer.ok) throw Object.assign(new Error(said.error), { code: answer.status });
  return said;
}

// A section of its own before that of the given id, with its link in the same place.
function livePart(id, title, before) {
  const part = element("section", { id, tabindex: "-1" }, element("h2", {}, title)), next = document.getElementById(before) ?? document.getElementById("provenance");
  next.before(part);
  document.querySelector(`#parts a[href="#${next.id}"]`).before(element("a", { href: `#${id}`, onclick: (event) => {
    event.preventDefault();
    goTo(part);
  } }, title));
  return part;
}

function goTo(part) {
  part.focus({ preventScroll: true });
  part.scrollIntoView({ behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "instant" : "smooth" });
}

const plainButton = (text, act, more = {}) => element("button", { class: "plain", type: "button", onclick: act, ...more }, text);

// Difference of `value` from `before`.
function percent(value, before) {
  if (!(Math.abs(before) > 0) || !Number.isFinite(value)) return "";
  const pct = (100 * (value - before)) / Math.abs(before);
  return `${pct < 0 ? "\u2212" : "+"}${Math.abs(pct).toFixed(Math.abs(pct) < 10 ? 1 : 0)} %`;
}

// ---- fronts as parallel coordinates, small and quick enough to follow a slider

// draw([{ rows: [[natural objective, ...]], colour, width, alpha }]), the last on top; better is down.
function frontStrip(host, label, height = 208) {
  const layers = host.appendChild(element("div", { class: "layers strip" }));
  const canvas = layers.appendChild(element("canvas", { role: "img", "aria-label": label }));
  const words = layers.appendChild(element("div", { class: "words", "aria-hidden": "true" }));
  const top = 22, bottom = 58, side = 40;
  let last = [];

  function rangesOf(all) {
    return objectives.map((c, k) => {
      let low = Infinity, high = -Infinity;
      for (const { rows } of all)
        for (const f of rows) {
          if (f[k] < low) low = f[k];
          if (f[k] > high) high = f[k];
        }
      return [low, high > low ? high : low + 1];
    });
  }

  function draw(all) {
    last = all;
    const width = layers.clientWidth;
    if (!width) return;
    layers.style.height = `${height}px`;
    const pen = prepare(canvas, width, height), ranges = rangesOf(all);
    const at = (k) => (objectives.length > 1 ? side + (k * (width - 2 * side)) / (objectives.length - 1) : width / 2);
    const down = height - bottom, span = down - top;
    const y = (k, v) => {
      const t = (v - ranges[k][0]) / (ranges[k][1] - ranges[k][0]);
      return down - span * (objectives[k].sense < 0 ? 1 - t : t);
    };
    pen.strokeStyle = "#7a8694";
    for (let k = 0; k < objectives.length; k++) pen.strokeRect(at(k), top, 0, span);
    for (const { rows, colour, width: line = 1, alpha = 1 } of all) {
      pen.strokeStyle = colour;
      pen.lineWidth = line;
      pen.globalAlpha = alpha;
      for (const f of rows) {
        pen.beginPath();
        f.forEach((v, k) => (k ? pen.lineTo(at(k), y(k, v)) : pen.moveTo(at(k), y(k, v))));
        pen.stroke();
      }
    }
    words.replaceChildren(...objectives.flatMap((c, k) => {
      const [worse, better] = c.sense < 0 ? ranges[k] : [ranges[k][1], ranges[k][0]];
      return [[worse * c.factor, 2], [better * c.factor, down + 1], [null, down + 18]].map(([v, where]) => {
        const word = element("span", { title: c.what }, v === null ? titleUnit(c) : show(v));
        word.style.left = `${at(k)}px`;
        word.style.top = `${where}px`;
        word.style.width = `${(width - 2 * side) / Math.max(1, objectives.length - 1)}px`;
        return word;
      });
    }));
  }

  addDrawing(layers, () => draw(last));
  return draw;
}

const frontRows = (() => {
  let rows;
  return () => (rows ??= Array.from({ length: n }, (_, i) => objectives.map((c) => c.raw[i])));
})();
const PALE = "#c3cad2";
const paleFront = (rows = frontRows()) => ({ rows, colour: PALE, width: 0.7, alpha: Math.max(0.2, Math.min(0.8, 12 / Math.sqrt(rows.length + 1))) });
