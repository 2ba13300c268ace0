// The simulator itself, WebAssembly (src/wasm/engine.c), in a thread of its own. What it simulates with comes with a report
// (#scene) or, on the live page, from the server.
// Runs in the worker: { module, scene } first, then questions { turn, x, record, pga_g, stretch, restitution, whole: by all
// simulations of the study, histories: over time }.
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

  function answer({ x, record = 0, pga_g = 0, stretch = 0, restitution = 0, whole = 0, histories }) {
    const wanted = [record, pga_g, stretch, restitution], simulate = (kind, all) => {
      must(engine.engine_run(page, kind, all));
      return JSON.parse(said());
    };
    new Float64Array(memory.buffer, engine.engine_design(page), x.length).set(x);
    if (ground !== wanted.join()) {
      ground = undefined;
      must(engine.engine_ground(page, ...wanted));
      noCore = simulate(1, 0);
      ground = wanted.join();
    }
    if (histories) return must(engine.engine_histories(page)) && JSON.parse(said());
    if (whole) ground = undefined; // it ends with the first record, or fails anywhere
    return { ...simulate(0, whole), no_core: noCore };
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
async function simulated(question) {
  engine ??= openEngine();
  const { x, ...ground } = question, a = await (await engine).ask(question);
  if (question.histories) return a;
  const f = a.objectives.length ? a.objectives : null, known = { ...a, objectives: f };
  if (!f || !isLikeRun(ground)) return known;
  const better = (one, other) => objectives.every((c, k) => c.sense * one[k] <= c.sense * other[k]) && objectives.some((c, k) => one[k] !== other[k]);
  return { ...known, dominated_by: frontRows.filter((row) => better(row, f)).length, dominates: frontRows.filter((row) => better(f, row)).length };
}

// For whoever asks from the console: imtet.simulate({ x: [...], record: 0, pga_g: 0.4 }).
window.imtet = { simulate: simulated };
