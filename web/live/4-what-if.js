// What if: sliders for every variable, the motion and the restitution; each change is one simulation. One question is
// under way at a time; what was moved meanwhile is the next one, what was passed over is never asked.

const GROUND = [["pga_g", "peak", "g"], ["stretch", "time \u00d7", ""], ["restitution", "restitution", ""]];
let startWhatIf = () => {};

function whatIfPart() {
  const part = livePart("what-if", "What if", "growth");
  const said = element("p", { id: "place", role: "status" }), board = element("div");
  const sliders = element("div", { class: "sliders" }), pictures = element("div", { class: "beside" });
  part.append(element("p", { class: "note" }, "Drag a gap, a thickness, the motion or the restitution: every change is simulated at once, under the first motion of the run."), element("div", { class: "what-if" }, sliders, pictures));
  const trial = { key: "trial", words: "what if", colour: ORANGE, mark: "\u25c6", symbol: "diamond2", path: charts.symbolDiamond2, dash: [], isShown: true, raw: [], value: new Map() };
  const x = new Float64Array(variables.length), ground = {};
  let bounds, start, answer, turn = 0, isAsking = false, since, resting_;

  // ---- sliders

  function slider(key, title, unit, factor, [low, high], value, take) {
    const number = element("output", {}), input = element("input", { type: "range", min: low, max: high, step: "any", name: key, "aria-label": title + (unit ? ` [${unit}]` : "") });
    const set = (v) => {
      input.value = v;
      number.textContent = `${digits(v * factor)}${unit ? ` ${unit}` : ""}`;
      input.setAttribute("aria-valuetext", number.textContent);
    };
    input.addEventListener("input", (event) => {
      take(+input.value);
      set(+input.value);
      moved(event.timeStamp);
    });
    set(value);
    return { key, set, row: element("label", { class: "slider" }, element("span", {}, title), input, number) };
  }

  const moving = { variables: [], ground: [] };
  function makeSliders() {
    moving.variables = variables.map((c, j) => slider(c.name, c.title, c.unit, c.factor, [bounds.lower[j], bounds.upper[j]], x[j], (v) => (x[j] = v)));
    moving.ground = GROUND.map(([key, title, unit]) => slider(key, title, unit, 1, [bounds[key][0], bounds[key][2]], bounds[key][1], (v) => (ground[key] = v)));
    const isGap = (c) => /^gap_/.test(c.name), group = (title, list) => (list.length ? element("fieldset", {}, element("legend", {}, title), ...list.map(({ row }) => row)) : "");
    sliders.replaceChildren(
      group("Motion and contact", moving.ground), group("Core and others", moving.variables.filter((_, j) => !isGap(variables[j]))),
      group("Gaps, from the roof down", moving.variables.filter((_, j) => isGap(variables[j])).reverse()));
  }

  function moved(time) {
    since ??= time;
    if (!isAsking) next();
  }

  // What was moved while a question was under way is asked before the answer is drawn: the server works meanwhile.
  async function next() {
    const began = since, asked = { ...ground }, design = Array.from(x);
    since = undefined;
    isAsking = true;
    part.dataset.busy = "yes";
    const said_ = await ask("what-if", { turn: ++turn, x: design, ...asked }).catch((error) => error);
    isAsking = false;
    if (since !== undefined) next();
    if (said_ instanceof Error) {
      said.textContent = `Not simulated: ${said_.message}`;
    } else {
      answer = { ...said_, x: design, ground: asked };
      showAnswer();
      requestAnimationFrame(() => setTimeout(() => performance.measure("what-if", { start: began, end: performance.now() }))); // painted
    }
    if (!isAsking) delete part.dataset.busy;
  }

  // ---- what came of it

  function place() {
    if (!answer.objectives) return `This design could not be simulated: ${answer.reason}`;
    const law = answer.beyond_law ? " The indentation is beyond what the contact law is meant for." : "";
    if (answer.dominated_by === undefined) return `Under another motion or restitution, or by one simulation of several, it has no place in the front.${law}`;
    if (answer.dominated_by) return `Dominated by ${count(answer.dominated_by)} of ${count(n)} designs of the front.${law}`;
    return `Nondominated${answer.dominates ? `: it dominates ${count(answer.dominates)} ${answer.dominates === 1 ? "design" : "designs"} of the front` : ""}.${law}`;
  }

  const draw = frontStrip(pictures, "The design in the front");
  pictures.prepend(said);
  pictures.append(legend([["what if", ORANGE], ["where it began", INK], ["front", PALE], ["without core", VERMILLION]]), board);
  const peaks = pictures.appendChild(element("div", { class: "grid3" }));
  const places = [["displacement_m", "displacement [m]"], ["drift_m", "drift [m]"], ["acceleration_g", "acceleration [g]"]].map(([key, title]) => [key, title, peaks.appendChild(element("div", { class: "chart" }))]);

  // Within a picture its lines move, as long as they fit its axis: a picture takes ten times as long to make.
  function drawPeaks(isNew) {
    for (const [key, title, host] of places) {
      const lines = [["without core", VERMILLION, answer.no_core], ["where it began", INK, start.peaks], ["what if", ORANGE, answer.peaks]].filter(([, , peaks]) => peaks)
        .map(([name, colour, peaks]) => ({ name, colour, values: peaks[key], thick: colour === ORANGE ? 2.6 : 1.4 }));
      const svg = host.firstChild, paths = host.querySelectorAll("[aria-label=line] path"), most = Math.max(...lines.flatMap(({ values }) => values));
      if (!isNew && lines.length && paths.length === lines.length && most <= svg.scale("x").domain[1] && most > 0.5 * svg.scale("x").domain[1]) {
        const [toX, toY] = ["x", "y"].map((axis) => svg.scale(axis).apply);
        lines.forEach(({ values }, k) => paths[k].setAttribute("d", `M${values.map((v, j) => [toX(v), toY(j + 1)]).join("L")}`));
      } else if (lines.length && host.clientWidth) host.replaceChildren(heightChart(host.clientWidth, 260, `peak ${title}`, lines));
    }
  }

  function drawTable() {
    const row = (label, raw, before) => line([label, ...objectives.map((c, k) => (raw ? [digits(raw[k] * c.factor), before ? difference(raw[k], before[k]) : ""] : "\u2013"))]);
    board.replaceChildren(table("trial", ["", ...objectives], [row(start.name, start.raw), row("what if", answer.objectives, start.raw)]));
  }

  // The pictures of the whole front follow when the sliders rest.
  function showAnswer() {
    start.peaks ??= answer.peaks;
    said.textContent = place();
    part.dataset.turn = answer.turn;
    draw([paleFront(), { rows: [start.raw], colour: INK, thick: 2 }, ...(answer.objectives ? [{ rows: [answer.objectives], colour: ORANGE, thick: 3 }] : [])]);
    drawTable();
    drawPeaks();
    trial.raw = answer.objectives ?? [];
    trial.value = new Map([...objectives.map((c, k) => [c, (trial.raw[k] ?? NaN) * c.factor]), ...variables.map((c, j) => [c, x[j] * c.factor])]);
    if (!overlays.includes(trial)) {
      overlays.push(trial);
      document.getElementById("overlays").replaceWith(overlayLegend());
    }
    clearTimeout(resting_);
    resting_ = setTimeout(layoutChanged, 400);
  }

  // ---- designs that are kept

  const kept = [], list = element("ol", { id: "kept" }), command = element("pre", { tabindex: "0", hidden: true });
  const groundWords = (g) => GROUND.filter(([key]) => g[key] !== undefined).map(([key, title, unit]) => `${title} ${digits(g[key])} ${unit}`.trim()).join(", ");
  const options = { pga_g: "--pga ", stretch: "--set motion.stretch=", restitution: "--set contact.restitution=" };
  const groundOptions = (g) => bounds.options + (g.pga_g === undefined ? "" : bounds.pga_options) + Object.entries(g).map(([key, v]) => ` ${options[key]}${v}`).join("");

  function showKept() {
    list.replaceChildren(...kept.map((one, i) => element("li", {}, `${objectives.slice(0, 3).map((c, k) => `${c.title} ${withUnit(c, one.raw[k] * c.factor)}`).join(", ")}${groundWords(one.ground) ? ` (${groundWords(one.ground)})` : ""} `,
      plainButton("Compare", () => compare(one)), " ", plainButton("Take up again", () => set(one.x, one.ground)), " ", plainButton("Drop", () => {
        kept.splice(i, 1);
        showKept();
      }))));
    command.hidden = save.disabled = !kept.length;
    const grounds = [...new Set(kept.map((one) => groundOptions(one.ground)))], file = `${run.name}-kept.csv`;
    command.textContent = grounds.length === 1 ? `imtet simulate ${run.folder}/settings.ini --design ${file}${grounds[0]}`
      : kept.map((one, i) => `imtet simulate ${run.folder}/settings.ini --design ${file}:${i + 1}${groundOptions(one.ground)}`).join("\n");
  }

  function keep() {
    if (!answer?.objectives || part.dataset.busy) return;
    kept.push({ name: `kept ${kept.length + 1}`, x: answer.x, ground: answer.ground, raw: answer.objectives, gap_m: answer.gap_m, peaks: answer.peaks });
    showKept();
  }

  const csv = () => [run.schema.variables.map(cell).join(","), ...kept.map((one) => one.x.join(","))].join("\n") + "\n";
  const save = plainButton("Download as a design file", () => saveFile(`${run.name}-kept.csv`, csv()), { id: "save-kept", disabled: true });
  pictures.append(element("div", { class: "bar" }, plainButton("Keep", keep, { id: "keep-trial" }), save,
    plainButton("Back to where it began", () => set(start.x, {}), { id: "back" })), list, command);

  // ---- from a design of the front

  function set(values, on) {
    x.set(values);
    for (const [key] of GROUND) delete ground[key];
    Object.assign(ground, on);
    moving.variables.forEach((s, j) => s.set(x[j]));
    moving.ground.forEach((s) => s.set(ground[s.key] ?? bounds[s.key][1]));
    moved(performance.now());
  }

  startWhatIf = async (row, go = true) => {
    bounds ??= await ask("what-if");
    start = { name: `design ${ids[row]}`, x: variables.map((c) => c.raw[row]), raw: objectives.map((c) => c.raw[row]) };
    x.set(start.x);
    if (!moving.variables.length) makeSliders();
    set(start.x, {});
    if (go) goTo(part);
  };
  addDrawing(peaks, () => answer && drawPeaks(true));
}
