// The simulator itself, WebAssembly (src/wasm/engine.c), in a thread of its own. What it simulates with comes with a report
// (#scene) or, on the live page, from the server.
// Runs in the worker: { module, scene } first, then questions { turn, x, record, pga_g, stretch, restitution, whole, kind }.
function engineThread() {
  let engine, page, memory, ground, noCore;
  const unpack = async (text) => new Uint8Array(await new Response(new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer());
  const said = () => {
    const bytes = new Uint8Array(memory.buffer), from = engine.engine_answer();
    return new TextDecoder().decode(bytes.slice(from, bytes.indexOf(0, from)));
  };
  const must = (done) => done || (() => { throw new Error(said()); })();

  // No files, no clock, no output: whatever the C library asks for is not there.
  async function open({ module, scene }) {
    const NOT_THERE = 8, compiled = await WebAssembly.compile(await unpack(module)), bytes = await unpack(scene), imports = {};
    for (const { module: from, name } of WebAssembly.Module.imports(compiled)) (imports[from] ??= {})[name] = () => NOT_THERE;
    engine = (await WebAssembly.instantiate(compiled, imports)).exports;
    memory = engine.memory;
    engine._initialize();
    const room = engine.engine_room(bytes.length);
    new Uint8Array(memory.buffer).set(bytes, room);
    page = must(engine.engine_open(room, bytes.length));
  }

  function simulate(kind, x) {
    new Float64Array(memory.buffer, engine.engine_design(page), x.length).set(x);
    must(engine.engine_run(page, kind));
    return JSON.parse(said());
  }

  function answer({ x, record = 0, pga_g = 0, stretch = 0, restitution = 0, whole, kind = 0 }) {
    const wanted = [record, pga_g, stretch, restitution];
    if (ground !== wanted.join()) {
      ground = undefined;
      must(engine.engine_ground(page, ...wanted));
      noCore = simulate(1, x);
      ground = wanted.join();
    }
    if (!whole) return { ...simulate(kind, x), no_core: noCore };
    new Float64Array(memory.buffer, engine.engine_design(page), x.length).set(x);
    must(engine.engine_whole(page, ...wanted.slice(1)));
    if (record) ground = undefined; // it ended with the first record
    return { ...JSON.parse(said()), no_core: noCore };
  }

  let opened;
  onmessage = async ({ data }) => {
    try {
      if (data.module) return void (opened = open(data), opened.catch(() => {}));
      await opened;
      postMessage({ turn: data.turn, answer: answer(data) });
    } catch (error) {
      postMessage({ turn: data.turn, error: error.message });
    }
  };
}

// Resolves when the whole page has come: the engine stands at its end, behind the first picture.
const loaded = document.readyState === "loading" ? new Promise((done) => addEventListener("DOMContentLoaded", done)) : Promise.resolve();
let engine, turns = 0;

// The numbers between which a design may be changed (report/what_if.h); starts the engine.
let sceneOf = () => loaded.then(() => byId("scene") && JSON.parse(byId("scene").textContent));
async function openEngine() {
  const scene = await sceneOf();
  if (!scene?.scene) throw new Error(scene?.reason ?? "this report holds no engine (it was made with --no-engine)");
  const thread = new Worker(URL.createObjectURL(new Blob([`(${engineThread})()`], { type: "text/javascript" }))), waiting = new Map();
  const end = (why) => [...waiting.values()].forEach(({ fail }) => fail(new Error(why)));
  thread.onerror = (event) => end(event.message || "this browser does not let the page simulate");
  thread.onmessage = ({ data }) => {
    const { done, fail } = waiting.get(data.turn) ?? {};
    waiting.delete(data.turn);
    if (data.error) fail?.(new Error(data.error));
    else done?.(data.answer);
  };
  await loaded;
  thread.postMessage({ module: byId("engine").textContent.trim(), scene: scene.scene });
  return { ...scene, ask: (question) => new Promise((done, fail) => {
    waiting.set(++turns, { done, fail });
    thread.postMessage({ ...question, turn: turns });
  }) };
}

// A question to the engine: objectives, peaks, and what of the front dominates it where both are of the same motion.
const GROUND_KEYS = ["pga_g", "stretch", "restitution"];
async function simulated(question) {
  engine ??= openEngine();
  const it = await engine, a = await it.ask(question), f = a.objectives.length ? a.objectives : null;
  const peaksOf = (r) => ({ displacement_m: r.peak_displacement_m, drift_m: r.peak_drift_m, acceleration_g: r.peak_acceleration_g });
  const known = { ...a, objectives: f, peaks: f && peaksOf(a), no_core: peaksOf(a.no_core) };
  if (!f || (it.simulations > 1 && !question.whole) || question.record || GROUND_KEYS.some((key) => question[key])) return known;
  const better = (one, other) => objectives.every((c, k) => c.sense * one[k] <= c.sense * other[k]) && objectives.some((c, k) => one[k] !== other[k]);
  return { ...known, dominated_by: frontRows.filter((row) => better(row, f)).length, dominates: frontRows.filter((row) => better(f, row)).length };
}

// For whoever asks from the console: imtet.simulate({ x: [...], record: 0, pga_g: 0.4 }).
window.imtet = { simulate: simulated };
