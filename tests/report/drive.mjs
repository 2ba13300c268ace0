// Opens a report as a person would and tries it: drive.mjs REPORT.html        prints what it found, exits 1 on a fault
//                                                drive.mjs --bench REPORT.html   prints times of painting and brushing
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { openBrowser } from "./browser.mjs";

const bench = process.argv[2] === "--bench";
const file = resolve(process.argv[bench ? 3 : 2]);
const downloads = mkdtempSync(join(tmpdir(), "imtet-downloads-"));
const browser = await openBrowser();
const page = await browser.openPage();
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

// ---- what the file says, read without the page's own script

const html = readFileSync(file, "utf8");
const between = (open) => html.slice(html.indexOf(open) + open.length, html.indexOf("</script>", html.indexOf(open)));
const run = JSON.parse(between('<script type="application/json" id="run">'));
const lines = between('<script type="text/plain" id="rows">').trim().split("\n");
const names = ["id", ...run.schema.variables, ...run.schema.objectives.map((o) => o.name)];
const rows = lines.map((line) => line.split(",").map(Number));

// ---- hands

async function open() {
  await page.call("Page.navigate", { url: pathToFileURL(file).href });
  await page.until("document.documentElement?.dataset.ready === 'yes'");
}

const frame = () => page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done))))");
async function settle() {
  await frame();
  await page.until("!document.documentElement.dataset.busy");
  await frame();
}
const mouse = (type, x, y) => page.call("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons: type === "mouseReleased" ? 0 : 1, clickCount: 1 });

async function boxOf(selector, nth = 0) {
  return page.evaluate(`(() => { const e = document.querySelectorAll(${JSON.stringify(selector)})[${nth}];
    e.scrollIntoView({ behavior: "instant", block: "center" });
    const r = e.getBoundingClientRect(); return { x: r.x, y: r.y, width: r.width, height: r.height }; })()`);
}

async function drag(box, from, to, steps = 6) {
  const at = ([x, y]) => [box.x + x * box.width, box.y + y * box.height];
  await mouse("mousePressed", ...at(from));
  for (let k = 1; k <= steps; k++) {
    const s = k / steps;
    await mouse("mouseMoved", ...at([from[0] + s * (to[0] - from[0]), from[1] + s * (to[1] - from[1])]));
  }
  await mouse("mouseReleased", ...at(to));
  await settle();
}

async function click(selector, nth = 0) {
  const box = await boxOf(selector, nth);
  await drag(box, [0.5, 0.5], [0.5, 0.5], 0);
}

async function type(label, text) {
  await page.evaluate(`(() => { const e = document.querySelector('input[aria-label="${label}"]'); e.closest("details").open = true; e.focus(); e.select(); })()`);
  await page.call("Input.insertText", { text });
  for (const kind of ["keyDown", "keyUp"]) await page.call("Input.dispatchKeyEvent", { type: kind, key: "Enter", code: "Enter", windowsVirtualKeyCode: 13, text: kind === "keyDown" ? "\r" : undefined });
  await settle();
}

async function downloaded() {
  await browser.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: downloads });
  for (const old of readdirSync(downloads)) rmSync(join(downloads, old));
  await click("#download");
  for (let k = 0; k < 250; k++) {
    const got = readdirSync(downloads).find((name) => name.endsWith(".csv"));
    if (got && existsSync(join(downloads, got))) return readFileSync(join(downloads, got), "utf8");
    await pause(20);
  }
  throw new Error("nothing was downloaded");
}

const counted = async () => +(await page.evaluate("document.getElementById('count').textContent")).replace(/ of.*/, "").replaceAll(",", "");
const tableIds = () => page.evaluate("Array.from(document.querySelectorAll('#designs tbody tr:not([hidden])'), (tr) => +tr.dataset.id)");
const csvOf = (chosen) => [names.join(","), ...chosen.map((i) => lines[i])].join("\n") + "\n";
const all = rows.map((_, i) => i);

// Faults that the browser saw so far: console, exceptions, policy, network.
function complaints() {
  return page.events.flatMap(({ method, params }) => {
    if (method === "Log.entryAdded") return [`log: ${params.entry.text}`];
    if (method === "Runtime.exceptionThrown") return [`exception: ${params.exceptionDetails.exception?.description ?? params.exceptionDetails.text}`];
    if (method === "Runtime.consoleAPICalled") return [`console: ${JSON.stringify(params.args)}`];
    if (method === "Audits.issueAdded") return [`issue: ${JSON.stringify(params.issue.details).slice(0, 400)}`];
    if (method === "Network.requestWillBeSent" && !/^(data|blob):/.test(params.request.url) && params.request.url !== pathToFileURL(file).href)
      return [`request: ${params.request.url.slice(0, 200)}`];
    return [];
  });
}

// ---- what is tried

const tried = {
  async "a drag along an axis selects the designs of that range, in the table and in the file"() {
    const box = await boxOf("g.axis .brush .overlay", 0);
    await drag(box, [0.5, 0.5], [0.5, 1]);
    const text = await downloaded(), chosen = all.filter((i) => text.includes(`\n${lines[i]}\n`));
    assert.equal(await counted(), chosen.length);
    assert.ok(chosen.length > 0 && chosen.length < rows.length, `${chosen.length} of ${rows.length} selected`);
    assert.equal(text, csvOf(chosen));
    const column = 1 + run.schema.variables.length, values = chosen.map((i) => rows[i][column]);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    assert.deepEqual(chosen, all.filter((i) => rows[i][column] >= low && rows[i][column] <= high));
    const ids = new Set(chosen.map((i) => rows[i][0]));
    for (const id of await tableIds()) assert.ok(ids.has(id), `design ${id} is in the table`);
  },
  async "Clear ranges brings every design back"() {
    await click("#clear");
    assert.equal(await counted(), rows.length);
    assert.equal(await downloaded(), csvOf(all));
  },
  async "a range typed on the keyboard selects the same as a search through the file"() {
    const column = 1 + run.schema.variables.length, values = rows.map((r) => r[column]).sort((a, b) => a - b);
    const low = +values[Math.floor(values.length / 4)].toPrecision(4), high = +values[Math.floor(values.length / 2)].toPrecision(4);
    const label = await page.evaluate("document.querySelector('#ranges input').getAttribute('aria-label').replace(/ from$/, '')");
    await type(`${label} from`, String(low));
    await type(`${label} to`, String(high));
    const chosen = all.filter((i) => rows[i][column] >= low && rows[i][column] <= high);
    assert.equal(await counted(), chosen.length);
    assert.equal(await downloaded(), csvOf(chosen));
    await click("#clear");
  },
  async "a box in the scatter matrix is two ranges"() {
    if (run.schema.objectives.length < 2) return;
    const first = await boxOf("g.panel .brush .overlay", 0);
    await drag(first, [0.02, 0.98], [0.75, 0.25]);
    const text = await downloaded(), chosen = all.filter((i) => text.includes(`\n${lines[i]}\n`));
    assert.ok(chosen.length > 0 && chosen.length < rows.length, `${chosen.length} of ${rows.length} selected`);
    for (const column of [1 + run.schema.variables.length, 2 + run.schema.variables.length]) assert.ok(chosen.every((i) => Number.isFinite(rows[i][column])));
    const ranges = await page.evaluate("Array.from(document.querySelectorAll('#ranges input')).filter((e) => e.value !== '').length");
    assert.equal(ranges, 4);
    await click("#clear");
  },
  async "the table sorts by any column, both ways"() {
    await click("#designs th button", 1);
    const column = 2 + run.schema.variables.length, byId = new Map(rows.map((r) => [r[0], r[column]]));
    const shown = (await tableIds()).map((id) => byId.get(id)), sorted = [...shown].sort((a, b) => a - b);
    assert.ok([sorted, sorted.toReversed?.() ?? [...sorted].reverse()].some((s) => s.join() === shown.join()));
    assert.ok(shown.includes(Math.min(...byId.values())) || shown.includes(Math.max(...byId.values())));
  },
  async "axes can be switched to the variables and to both"() {
    for (const [value, count] of [["variables", run.schema.variables.length], ["all", names.length - 1], ["objectives", run.schema.objectives.length]]) {
      await click(`input[name=axes][value=${value}]`);
      assert.equal(await page.evaluate("Array.from(document.querySelectorAll('g.axis')).filter((g) => g.getClientRects().length).length"), count);
    }
  },
  async "everything can be reached by the Tab key"() {
    const seen = new Set();
    await page.evaluate("document.activeElement.blur(), document.querySelectorAll('details').forEach((d) => (d.open = false))");
    for (let k = 0; k < 120; k++) {
      for (const kind of ["keyDown", "keyUp"]) await page.call("Input.dispatchKeyEvent", { type: kind, key: "Tab", code: "Tab", windowsVirtualKeyCode: 9 });
      seen.add(await page.evaluate("(() => { const e = document.activeElement; return e.id || e.tagName + (e.parentElement?.id ? ' in ' + e.parentElement.id : ''); })()"));
    }
    for (const wanted of ["download", "colour", "SUMMARY in ranges"]) assert.ok(seen.has(wanted), `${wanted} is never focused: ${[...seen]}`);
  },
  async "no heading of an axis lies on another, nothing is wider than the window"() {
    for (const value of ["all", "objectives"]) {
      await click(`input[name=axes][value=${value}]`);
      const clash = await page.evaluate(`(() => {
        const seen = Array.from(document.querySelectorAll("g.axis text.title, g.panel text.title")).filter((e) => e.getClientRects().length).map((e) => [e.textContent, e.getBoundingClientRect()]);
        for (let i = 0; i < seen.length; i++) for (let j = 0; j < i; j++) {
          const [a, r] = seen[i], [b, q] = seen[j];
          if (r.left < q.right && q.left < r.right && r.top < q.bottom && q.top < r.bottom) return a + " on " + b;
        }
        return "";
      })()`);
      assert.equal(clash, "");
    }
    for (const width of [420, 1360]) {
      await page.call("Emulation.setDeviceMetricsOverride", { width, height: 900, deviceScaleFactor: 1, mobile: false });
      await page.until(`document.documentElement.scrollWidth <= ${width}`, 5); // it is laid out again
    }
  },
  async "it prints"() {
    const { data } = await page.call("Page.printToPDF", { printBackground: true });
    assert.ok(Buffer.from(data, "base64").subarray(0, 5).toString() === "%PDF-");
    await page.call("Emulation.setEmulatedMedia", { media: "print" });
    const [ids, headings, others] = JSON.parse(await page.evaluate(`JSON.stringify(["#designs tr:not([hidden]) td:first-child", "#designs th:not(.variable)", "button.plain"].map((cells) =>
      Array.from(document.querySelectorAll(cells), (cell) => cell.innerText.trim() && cell.querySelector("button")?.getClientRects().length !== 0 && cell.getClientRects().length)))`));
    await page.call("Emulation.setEmulatedMedia", { media: "" });
    assert.ok(ids.length && headings.length && [...ids, ...headings].every(Boolean), "ids or headings are not on paper");
    assert.ok(!others.some(Boolean), "buttons are on paper");
  },
  async "the parts that this run has are there, and no others"() {
    const parts = await page.evaluate("Array.from(document.querySelectorAll('main > section'), (s) => s.id)");
    assert.equal(parts.includes("design"), run.tower);
    if (!run.tower) return;
    const titles = await page.evaluate("Array.from(document.querySelectorAll('#design h3'), (h) => h.textContent).join('|')");
    for (const title of ["Gaps over the height", "Thickness of the core", "Displacement", "Interstorey drift", "Acceleration", "Energy dissipated by each mode", "Energies, with core", "Energies, without core", "Displacement of floor", "Other earthquakes"])
      assert.ok(titles.includes(title), `no part ${title} in ${titles}`);
    assert.equal(await page.evaluate("Array.from(document.querySelectorAll('#design svg')).filter((s) => /NaN/.test(s.innerHTML.replace(/base64,[^\x22]*/g, ''))).length"), 0);
  },
  async "the browser complains of nothing and asks nobody for anything"() {
    assert.deepEqual(complaints(), []);
  },
  async "the policy lets no other script, style or server in"() {
    const blocked = await page.evaluate(`(async () => {
      const seen = [];
      document.addEventListener("securitypolicyviolation", (e) => seen.push(e.effectiveDirective));
      const script = document.createElement("script"); script.textContent = "window.intruded = true"; document.body.append(script);
      const style = document.createElement("style"); style.textContent = "body { display: none }"; document.body.append(style);
      await fetch("https://imtet.invalid/").catch(() => {});
      const image = new Image(); image.src = "https://imtet.invalid/x.png";
      await new Promise((done) => setTimeout(done, 200));
      return JSON.stringify([window.intruded ?? false, getComputedStyle(document.body).display, seen.map((d) => d.replace(/-elem$/, "")).sort()]);
    })()`);
    assert.deepEqual(JSON.parse(blocked), [false, "block", ["connect-src", "img-src", "script-src", "style-src"]]);
  },
};

// ---- times

const listenForMoves = `(() => {
  window.times = [];
  window.addEventListener("mousemove", (e) => requestAnimationFrame(() => setTimeout(() => window.times.push(performance.now() - e.timeStamp))), true);
})()`;

async function measure() {
  const paint = await page.evaluate("performance.getEntriesByName('first-contentful-paint')[0].startTime");
  const [front, whole] = await page.evaluate("['front drawn', 'all drawn'].map((name) => performance.getEntriesByName(name)[0].startTime)");
  const box = await boxOf("g.axis .brush .overlay", 1);
  await page.evaluate(listenForMoves);
  await mouse("mousePressed", box.x + box.width / 2, box.y + 0.1 * box.height);
  for (let k = 1; k <= 40; k++) {
    await mouse("mouseMoved", box.x + box.width / 2, box.y + (0.1 + 0.02 * k) * box.height);
    await frame();
  }
  await mouse("mouseReleased", box.x + box.width / 2, box.y + 0.9 * box.height);
  await settle();
  const times = (await page.evaluate("window.times")).sort((a, b) => a - b);
  const ms = (v) => `${Math.round(v)} ms`;
  console.log(`${rows.length} designs, ${(html.length / 1e6).toFixed(1)} MB: first paint ${ms(paint)}, front drawn ${ms(front)}, all drawn ${ms(whole)}; ` +
    `brush to frame: median ${ms(times[times.length >> 1])}, 90 % ${ms(times[Math.floor(0.9 * times.length)])}, worst ${ms(times[times.length - 1])}`);
  assert.ok(whole < 20000 && times[times.length >> 1] < 2000, "far too slow");
}

let failed = 0;
try {
  await open();
  if (bench) await measure();
  else
    for (const [what, trial] of Object.entries(tried))
      try {
        await trial();
        console.log(`ok      ${what}`);
      } catch (error) {
        failed++;
        console.log(`FAILED  ${what}\n        ${error.message.replaceAll("\n", "\n        ")}`);
      }
} finally {
  await browser.close();
  rmSync(downloads, { recursive: true, force: true });
}
process.exit(failed ? 1 : 0);
