// What if: sliders for every variable, the motion and the restitution; each change is one simulation by the page itself. One question is
// under way at a time; what was moved meanwhile is the next one, what was passed over is never asked.
const GROUND = [["pga_g", "peak", "g"], ["stretch", "time \u00d7", ""], ["restitution", "restitution", ""]];
let startWhatIf, storeKept; // once the page can simulate; of imtet serve

function whatIfPart() {
  const part = laterPart("what-if", "What if", "growth");
  const said = element("p", { id: "place", role: "status" }), board = element("div");
  const sliders = div("sliders"), pictures = div("beside");
  part.append(note("Drag a gap, a thickness, the motion or the restitution: every change is simulated at once."), div("what-if", sliders, pictures));
  const x = new Float64Array(variables.length), ground = {}, trial = overlayOf({ name: "what if", x, raw: [] }, "\u25c6");
  let bounds, start, answer, turn = 0, isAsking = false, since, resting_;

  // ---- sliders
  function choice(key, title, words, value, take) {
    const buttons = words.map((word, i) => plainButton(word, (event) => {
      take(i);
      set(i);
      moved(event.timeStamp);
    }));
    const set = (v) => buttons.forEach((b, i) => b.setAttribute("aria-pressed", i === Math.round(v)));
    set(value);
    return { key, set, row: element("div", { class: "bar", role: "group", "aria-label": title }, element("span", title), ...buttons) };
  }

  // Of values that are sold the slider has their numbers.
  function slider(key, title, unit, factor, [low, high], value, take, values) {
    if (typeof values?.[0] === "string") return choice(key, title, values, value, take);
    const near = (v) => values?.reduce((a, b) => (Math.abs(b - v) < Math.abs(a - v) ? b : a)) ?? v, shown = () => (values ? values[+input.value] : +input.value);
    const label = title + (unit ? ` [${unit}]` : ""), range = `${show(low * factor)} to ${show(high * factor)} ${unit}`, input = element("input", { type: "range", min: values ? 0 : low, max: values ? values.length - 1 : high, step: values ? 1 : "any", name: key, "aria-label": label });
    const number = element("input", { type: "number", min: low * factor, max: high * factor, step: "any", name: `${key} number`, "aria-label": `${label} as a number` });
    const set = (v) => {
      input.value = values ? values.indexOf(near(v)) : v;
      if (document.activeElement !== number) number.value = digits(v * factor);
      number.classList.remove("bad");
      input.setAttribute("aria-valuetext", `${digits(v * factor)} ${unit}`.trim());
    };
    // Five digits, so that the address holds what was simulated.
    const change = (v, event) => {
      const rounded = near(clamp(+v.toPrecision(5), [low, high]));
      take(rounded);
      set(rounded);
      moved(event.timeStamp);
    };
    input.oninput = (event) => change(shown(), event);
    number.onchange = (event) => {
      const v = number.value === "" ? NaN : +number.value / factor, isGood = v >= low - 1e-9 * high && v <= high + 1e-9 * high;
      number.classList.toggle("bad", !isGood);
      if (isGood) change(v, event);
      else showNothing(title + " goes from " + range);
    };
    number.onblur = () => number.classList.contains("bad") || (number.value = digits(shown() * factor));
    set(value);
    return { key, set, row: div("slider", element("span", title, element("small", range)), input, number) };
  }

  const moving = { variables: [], ground: [] };
  function makeSliders() {
    moving.variables = variables.map((c, j) => slider(c.name, c.title, c.unit, c.factor, [bounds.lower[j], bounds.upper[j]], x[j], (v) => (x[j] = v), c.words ?? bounds.values[j]));
    moving.ground = GROUND.map(([key, title, unit]) => slider(key, title, unit, 1, [bounds[key][0], bounds[key][2]], bounds[key][1], (v) => (ground[key] = v)));
    const record = element("select", { name: "record", "aria-label": "record", onchange: (event) => {
      ground.record = +record.value;
      moved(event.timeStamp);
    } }, ...bounds.records.map((name, i) => element("option", { value: i }, name)));
    if (bounds.records.length > 1) moving.ground.push({ key: "record", set: (v) => (record.value = v), row: element("label", "record ", record) });
    // One simulation, or all by which the run judges a design.
    const whole = element("input", { type: "checkbox", name: "whole", onchange: (event) => {
      delete ground.whole;
      if (whole.checked) ground.whole = 1;
      moved(event.timeStamp);
    } });
    if (bounds.simulations > 1) moving.ground.push({ key: "whole", set: (v) => (whole.checked = v), row: element("label", whole, ` all ${bounds.simulations} simulations by which the run judges a design`) });
    const isGap = (c) => /^gap_/.test(c.name), group = (title, list) => (list.length ? element("fieldset", element("legend", title), ...list.map(({ row }) => row)) : "");
    sliders.replaceChildren(
      group("Motion and contact", moving.ground), group("Core and others", moving.variables.filter((_, j) => !isGap(variables[j]))),
      group("Gaps, from the roof down", moving.variables.filter((_, j) => isGap(variables[j])).reverse()));
  }

  function moved(time) {
    since ??= time;
    if (!isAsking) next();
  }

  // What was moved while a question was under way is asked before the answer is drawn: the engine works meanwhile.
  async function next() {
    const began = since, asked = { ...ground }, design = Array.from(x);
    since = undefined;
    isAsking = true;
    part.dataset.busy = "yes";
    const said_ = await simulated({ x: design, ...asked }).catch((error) => error);
    isAsking = false;
    if (since !== undefined) next();
    if (said_ instanceof Error) showNothing("Not simulated: " + said_.message);
    else {
      answer = { ...said_, turn: ++turn, x: design, ground: asked };
      showAnswer();
      requestAnimationFrame(() => setTimeout(() => performance.measure("what-if", { start: began, end: performance.now() }))); // painted
    }
    if (!isAsking) delete part.dataset.busy;
  }

  // ---- what came of it
  function place() {
    if (!answer.objectives) return `This design could not be simulated: ${answer.reason}`;
    const law = answer.beyond_law ? " The indentation is beyond the range of the contact law." : "";
    if (answer.dominated_by === undefined) return "Not comparable with the front: motion or restitution differ from the run\u2019s, or the run judges by several simulations." + law;
    if (answer.dominated_by) return `Dominated by ${count(answer.dominated_by)} of ${count(n)} designs of the front.${law}`;
    return `Nondominated${answer.dominates ? `: it dominates ${count(answer.dominates)} ${answer.dominates === 1 ? "design" : "designs"} of the front` : ""}.${law}`;
  }

  const draw = frontStrip(pictures, "The design in the front");
  pictures.prepend(said);
  pictures.append(legend([["what if", TRIAL], ["where it began", "var(--ink)"], ["front", "var(--pale)"], ...Object.values(SCENES).slice(1).map(({ words, colour }) => [words, colour])]), board);
  const peaks = gridOf(pictures, 3);
  const places = PEAKS.map(([key, , label]) => [key, label, peaks.appendChild(div("chart"))]);

  // Baselines of the run itself: under another motion only the building without core is simulated anew, for its peaks.
  const beside = () => overlays.filter((o) => run.detail?.[o.key] && !GROUND.some(([key]) => key in answer.ground));

  // Within a picture its lines move, as long as they fit its axis: a picture takes ten times as long to make.
  function drawPeaks(isNew) {
    for (const [key, label, host] of places) {
      const lines = [["without core", VERMILLION, answer.no_core], ...beside().filter((o) => o.key !== "no_core").map((o) => [o.words, o.colour, run.detail[o.key]]), ["where it began", INK, start.peaks], ["what if", TRIAL, answer.objectives && answer]].filter(([, , peaks]) => peaks)
        .map(([name, colour, peaks]) => ({ name, colour, values: peaks[key], thick: colour === TRIAL ? 2.6 : 1.4 }));
      const svg = host.firstChild, paths = host.querySelectorAll("[aria-label=line] path"), most = Math.max(...lines.flatMap(({ values }) => values));
      if (!isNew && lines.length && paths.length === lines.length && most <= svg.scale("x").domain[1] && most > 0.5 * svg.scale("x").domain[1]) {
        const [toX, toY] = ["x", "y"].map((axis) => svg.scale(axis).apply);
        lines.forEach(({ values }, k) => paths[k].setAttribute("d", `M${values.map((v, j) => [toX(v), toY(j + 1)]).join("L")}`));
      } else if (lines.length && host.clientWidth) host.replaceChildren(heightChart(host.clientWidth, 260, label, lines));
    }
  }

  const drawTable = () => board.replaceChildren(table("trial", ["", ...objectives], [line([start.name, ...besides(start.raw)]), line(["what if", ...besides(answer.objectives, start.raw)])]));

  // No old number stands beside a slider that has moved.
  function showNothing(why) {
    said.textContent = why;
    answer = undefined;
    draw([paleFront(), { rows: [start.raw], colour: INK, thick: 2 }]);
    board.replaceChildren();
    for (const [, , host] of places) host.replaceChildren();
    takeOverlay("what if");
    overlaysChanged();
  }

  // Drawn anew when what it is compared with has come.
  const drawAnswer = () => drawPeaks(draw([paleFront(), ...beside().map((o) => ({ rows: [o.raw], colour: o.colour, thick: 1.2 })), { rows: [start.raw], colour: INK, thick: 2 }, ...(answer.objectives ? [{ rows: [answer.objectives], colour: TRIAL, thick: 3 }] : [])]));
  views.layout.push(() => answer && drawAnswer());

  // The pictures of the whole front follow when the sliders rest.
  function showAnswer() {
    start.peaks ??= answer;
    [said.textContent, part.dataset.turn] = [place(), answer.turn];
    drawAnswer(drawTable());
    Object.assign(trial, overlayOf({ name: "what if", x, raw: answer.objectives ?? [] }, "\u25c6"), { isShown: trial.isShown });
    clearTimeout(resting_);
    resting_ = setTimeout(() => drawHistories(layoutChanged()), 400);
    if (overlays.includes(trial)) return;
    overlays.push(trial);
    byId("overlays").replaceWith(overlayLegend());
  }

  // ---- designs that are kept
  const list = element("ol", { id: "kept" }), command = element("pre", { tabindex: "0", hidden: true });
  const groundWords = (g) => [g.record ? bounds.records[g.record] : "", ...GROUND.filter(([key]) => key in g).map(([key, title, unit]) => `${title} ${digits(g[key])} ${unit}`.trim())].filter(Boolean).join(", ");
  function showKept() {
    list.replaceChildren(...kept.map((one, i) => element("li", `${objectives.slice(0, 3).map((c, k) => `${c.title} ${withUnit(c, one.raw[k] * c.factor)}`).join(", ")} (${[one.name, groundWords(one.ground), one.why].filter(Boolean).join(", ")}) `,
      compareButton(one), " ", plainButton("Take up again", () => set(one.x, one.ground)), " ", one.id ? "" : plainButton("Drop", () => {
        kept.splice(i, 1);
        takeOverlay(one.name), overlaysChanged(showKept());
      }))));
    save.disabled = saveAll.disabled = !kept.length;
    command.hidden = !kept.length || kept.some(({ ground }) => groundWords(ground)); // it simulates the run's motion
    command.textContent = `imtet simulate ${run.folder}/settings.ini --design ${run.name}-kept.csv${kept.every(({ ground }) => ground.whole) ? "" : bounds.options}`;
  }

  // On the live page the run gets it too, simulated as the run does: not under another motion, which it does not have.
  async function keep() {
    if (!answer?.objectives || part.dataset.busy) return;
    const names = kept.map(({ name }) => name), { no_core: unused, ...all } = answer;
    const one = { ...all, name: `kept ${charts.range(1, kept.length + 2).find((k) => !names.includes(`kept ${k}`))}`, raw: all.objectives };
    kept.push(one);
    if (isLikeRun(one.ground)) overlays.push(overlayOf(one));
    overlaysChanged(showKept());
    if (!storeKept) return;
    try {
      if (!isLikeRun(one.ground)) throw new Error("it has another motion, or fewer simulations than the run");
      one.id = (await storeKept(one.x)).id;
      one.why = `design ${one.id} of the run`;
    } catch (error) {
      one.why = `not in the run: ${error.message}`;
    }
    showKept();
  }
  const csv = () => [run.schema.variables.map(cell).join(","), ...kept.map((one) => one.x.join(","))].join("\n") + "\n";
  const save = plainButton("Download as a design file", () => saveFile(`${run.name}-kept.csv`, csv()), { id: "save-kept", disabled: true });
  const saveAll = plainButton("Save this page with them", savePage, { id: "save-page", disabled: true, hidden: Boolean(storeKept) });
  pictures.append(div("bar", plainButton("Keep", keep, { id: "keep-trial" }), save, saveAll,
    plainButton("Back to where it began", () => set(start.x, {}), { id: "back" })), list, command);

  // The histories of the design, as those of a stored one: while they are looked at, when the sliders rest.
  const histories = folded(pictures, "Energies and displacement over time"), overTime = histories.appendChild(element("div"));
  histories.ontoggle = drawHistories;
  async function drawHistories() {
    if (!histories.open || !answer?.objectives) return;
    const with_core = answer, d = { ...await simulated({ x: with_core.x, ...with_core.ground, histories: 1 }), with_core };
    if (answer === with_core) refill(overTime, (host) => {
      energyPair(host, d);
      spectrumPair(host, d);
    });
  }

  // ---- from a design of the front
  function set(values, on) {
    x.set(values);
    for (const key of Object.keys(ground)) delete ground[key];
    Object.assign(ground, on);
    moving.variables.forEach((s, j) => s.set(x[j]));
    moving.ground.forEach((s) => s.set(ground[s.key] ?? bounds[s.key]?.[1] ?? 0));
    moved(performance.now());
  }

  startWhatIf = async (row, go = true) => {
    try {
      bounds ??= await (engine ??= openEngine());
    } catch (error) {
      return void (said.textContent = `This page cannot simulate: ${error.message}.`);
    }
    start = designOf(row);
    x.set(start.x);
    if (!moving.variables.length) {
      makeSliders();
      aroundPart(pictures, () => ({ x: Array.from(x), ...ground }), bounds);
      showKept();
    }
    set(start.x, {});
    if (go) goTo(part);
  };
  addDrawing(peaks, () => answer && drawPeaks(true));
}
