// Forty designs simulated by the engine of a report, with the very code of its page, and by the program:
//   forty.mjs IMTET REPORT.html DESIGNS.csv SETTINGS.ini
// Prints how far they are apart and how long they took; exits 1 where one is beyond its error. tests/serve/drive.mjs does the
// same in a browser.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";

// Designs are predictable where gaps 1 um off change J1 and J3 by less than 1 %: there the two may differ by the error that
// the program states, and where nothing touches by rounding alone. What a study makes of several records (objectives: their names)
// is compared where nothing touches, elsewhere to 1 %. Returns what was found.
export async function compare(imtet, designs, settings, ask, objectives) {
  const rows = readFileSync(designs, "utf8").trim().split("\n").slice(1).map((row) => row.split(",").map(Number));
  const told = JSON.parse(execFileSync(imtet, ["simulate", settings, "--design", designs, "--json"], { encoding: "utf8", stdio: ["ignore", "pipe", "ignore"], maxBuffer: 1 << 28 }));
  let predictable = 0, worst = 0, untouched = 0, ours = 0, theirs = 0;
  for (const [i, n] of told.entries()) {
    if (n.replicates) for (const [k, v] of (await ask({ x: rows[i], whole: 1 })).objectives.entries()) {
      const wanted = n.replicates.mean[objectives[k]], off = Math.abs(v / wanted - 1);
      assert.ok(wanted > 0 && off <= (n.replicates.mean.impacts ? 0.01 : 1e-9), `design ${i + 1}: ${objectives[k]} ${v} of the page, ${wanted} of the program`);
    }
    const began = performance.now(), w = await ask({ x: rows[i] });
    ours += (performance.now() - began) / 1e3;
    theirs += n.seconds;
    if (!["j1_m", "j3_g"].every((key) => n.error.sd_gaps_1_um[key] <= 0.01 * Math.abs(n[key]))) continue;
    predictable++;
    untouched += n.impacts === 0;
    for (const key of ["j1_m", "j2_m", "j3_g", "ed1_pct", "edcs_pct", "mcore_kg", "contact_force_max_n", "core_overturning_nm"]) {
      if (n[key] === null || w[key] === null) continue;
      const allowed = Math.max(1e-9 * Math.abs(n[key]), n.impacts ? n.error.bound[key] : 0), off = Math.abs(w[key] - n[key]);
      assert.ok(off <= allowed, `design ${i + 1}: ${key} ${w[key]} of the page, ${n[key]} of the program, ${off / allowed} times what is allowed`);
      worst = Math.max(worst, off / Math.abs(n[key] || 1));
    }
  }
  assert.ok(predictable >= 0.75 * told.length, `${predictable} of ${told.length} are predictable`);
  return `${told.length} designs, ${predictable} predictable, ${untouched} without a touch: largest difference ${worst.toExponential(1)} of the value; page ${ours.toFixed(2)} s, program ${theirs.toFixed(2)} s`;
}

// The thread of the page, in node.
function engineOf(report) {
  const html = readFileSync(report, "utf8"), part = (id) => html.match(new RegExp(`<script type="[^"]*" id="${id}">([^<]*)</script>`))[1];
  const objectives = JSON.parse(part("run")).schema.objectives.map(({ name }) => name);
  const page = readFileSync(new URL("../../web/app/7-engine.js", import.meta.url), "utf8"), waiting = new Map();
  Function(`${page.match(/^function engineThread\(\) \{[\s\S]*?^\}/m)[0]} return engineThread;`)()();
  globalThis.postMessage = ({ turn, answer, error }) => (error ? waiting.get(turn).fail(new Error(error)) : waiting.get(turn).done(answer));
  onmessage({ data: { module: part("engine").trim(), scene: JSON.parse(part("scene")).scene } });
  return [(question) => new Promise((done, fail) => {
    const turn = waiting.size + 1;
    waiting.set(turn, { done, fail });
    onmessage({ data: { ...question, turn } });
  }), objectives];
}

if (process.argv[1] === new URL(import.meta.url).pathname) {
  const [imtet, report, designs, settings] = process.argv.slice(2);
  console.log(await compare(imtet, designs, settings, ...engineOf(report)));
}
