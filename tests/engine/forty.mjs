// Forty designs simulated by the engine of a report, with the very code of its page, and by the program:
//   forty.mjs IMTET REPORT.html DESIGNS.csv SETTINGS.ini [ARGUMENT of imtet simulate ...]
// Prints how far they are apart and how long they took; exits 1 where one is beyond its error.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
const [imtet, report, designs, settings, ...more] = process.argv.slice(2);
const html = readFileSync(report, "utf8"), part = (id) => html.match(new RegExp(`<script type="[^"]*" id="${id}">([^<]*)</script>`))[1];
const page = readFileSync(new URL("../../web/app/7-engine.js", import.meta.url), "utf8");
const engineThread = Function(`${page.match(/^function engineThread\(\) \{[\s\S]*?^\}/m)[0]} return engineThread;`)();

const waiting = new Map();
globalThis.postMessage = ({ turn, answer, error }) => (error ? waiting.get(turn).fail(new Error(error)) : waiting.get(turn).done(answer));
engineThread();
const ask = (turn, question) => new Promise((done, fail) => {
  waiting.set(turn, { done, fail });
  onmessage({ data: { turn, ...question } });
});
onmessage({ data: { module: part("engine").trim(), scene: JSON.parse(part("scene")).scene } });

const [head, ...rows] = readFileSync(designs, "utf8").trim().split("\n").map((row) => row.split(","));
const told = JSON.parse(execFileSync(imtet, ["simulate", settings, "--design", designs, "--json", ...more], { encoding: "utf8", stdio: ["ignore", "pipe", "ignore"], maxBuffer: 1 << 28 }));
const native = told.results ?? told;
let predictable = 0, worst = 0, untouched = 0, time = [0, 0];
for (const [i, n] of native.entries()) {
  const began = performance.now(), w = await ask(i + 1, { x: rows[i].slice(0, head.length).map(Number) });
  time[0] += (performance.now() - began) / 1e3;
  time[1] += n.seconds;
  const is = (key) => n.error.sd_gaps_1_um[key] <= 0.01 * Math.abs(n[key]);
  if (!["j1_m", "j3_g"].every(is)) continue;
  predictable++;
  untouched += n.impacts === 0;
  for (const key of ["j1_m", "j2_m", "j3_g", "ed1_pct", "edcs_pct", "mcore_kg", "contact_force_max_n", "core_overturning_nm"]) {
    if (n[key] === null || w[key] === null) continue;
    const allowed = Math.max(1e-9 * Math.abs(n[key]), n.impacts ? n.error.bound[key] : 0), off = Math.abs(w[key] - n[key]);
    assert.ok(off <= allowed, `design ${i + 1}: ${key} ${w[key]} of the page, ${n[key]} of the program, ${off / allowed} times what is allowed`);
    worst = Math.max(worst, off / Math.abs(n[key] || 1));
  }
}
assert.ok(predictable >= 0.75 * native.length, `${predictable} of ${native.length} are predictable`);
console.log(`${native.length} designs, ${predictable} predictable, ${untouched} without a touch: largest difference ${worst.toExponential(1)} of the value; page ${time[0].toFixed(2)} s, program ${time[1].toFixed(2)} s`);
