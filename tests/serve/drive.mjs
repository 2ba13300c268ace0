// Reports and the page of imtet serve as a person would try them, in one browser; prints what it found, exits 1 on a fault.
//   drive.mjs IMTET FOLDER REPORT.html ...  FOLDER/runs holds the finished runs a, b, c and d
//   drive.mjs IMTET --bench RUN             prints how long a slider's update takes
//   drive.mjs IMTET --pictures FOLDER OUT   of FOLDER/kobe, a finished run
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { cpSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { compare } from "../engine/forty.mjs";
import { pause, picture, saved, tryAll } from "../report/browser.mjs";
const [imtet, folder, given, pictures] = process.argv.slice(2), children = [];
const isBench = folder === "--bench", isPictures = folder === "--pictures", root = resolve(isBench || isPictures ? given ?? "" : join(folder ?? "", "runs"));
if (!(isBench || isPictures ? given : folder) || !existsSync(root)) {
  console.error(`usage: drive.mjs IMTET FOLDER [REPORT.html ...] | --bench RUN | --pictures FOLDER OUT (make serve-bench RUN=results/NAME)${given ? `; ${root} is not there` : ""}`);
  process.exit(64);
}

function start(...words) {
  const child = spawn(imtet, words, { stdio: ["ignore", "pipe", "ignore"] });
  children.push(child);
  child.ended = new Promise((done) => child.once("exit", done));
  return child;
}

async function serve() {
  const child = start("serve", root);
  let said = "";
  for await (const piece of child.stdout) if ((said += piece).includes("Ctrl-C")) break;
  return said.match(/http:\S+/)[0];
}

const { browser, tryReports } = await import("../report/drive.mjs");
let failed = isBench || isPictures ? 0 : await tryReports(process.argv.slice(4));
const page = await browser.openPage();
const url = await serve(), origin = new URL(url).origin;
const runs = async () => (await fetch(`${url}runs`)).json();

// ---- hands
async function open(name) {
  const at = (await runs()).find((r) => r.name === name).at;
  await page.call("Page.navigate", { url: `${url}${at}/` }); await page.until("document.documentElement?.dataset.ready === 'yes'");
}
const { until, press, mouse, boxOf, click } = page, designShown = (id) => until(`document.getElementById("drawer").dataset.id === "${id}"`);

// Drags a slider to and fro; updates that came and how long each took from the movement to the frame with its picture.
async function dragSlider(nth, moves) {
  const { x, y, width, height } = await boxOf(".slider input[type=range]", nth), middle = y + height / 2;
  await page.evaluate("performance.clearMeasures('what-if')"); await mouse("mousePressed", x + width / 2, middle);
  for (let k = 0; k < moves; k++) {
    await mouse("mouseMoved", x + width * (0.5 + 0.4 * Math.sin(k / 4)), middle); await pause(40);
  }
  await mouse("mouseReleased", x + width / 2, middle); await until("!document.getElementById('what-if').dataset.busy"); await pause(100);
  return page.evaluate("performance.getEntriesByName('what-if').map((m) => m.duration)");
}

function tell(what, times) {
  const sorted = [...times].sort((a, b) => a - b), ms = (q) => `${Math.round(sorted[Math.min(sorted.length - 1, Math.floor(q * sorted.length))])} ms`;
  console.log(`${what}: ${times.length} updates, median ${ms(0.5)}, 95 % ${ms(0.95)}, slowest ${ms(1)}`);
}

// Processor time so far, of the server and of the page's main thread [ms]: on a busy machine updates last longer than they cost.
async function spent() {
  const [user, system] = readFileSync(`/proc/${children[0].pid}/stat`, "utf8").split(") ")[1].split(" ").slice(11, 13);
  const { metrics } = await page.call("Performance.getMetrics");
  return [10 * (+user + +system), 1000 * metrics.find((m) => m.name === "TaskDuration").value];
}

async function benchSlider(what, nth, moves) {
  const before = await spent(), times = await dragSlider(nth, moves), after = await spent();
  tell(`${what} dragged`, times);
  console.log(`  processor time of an update: server ${((after[0] - before[0]) / times.length).toFixed(1)} ms, page ${((after[1] - before[1]) / times.length).toFixed(1)} ms`);
}

// The pictures of docs/serve.md.
async function takePictures() {
  await open("kobe"); await until("document.getElementById('what-if').dataset.turn && document.querySelector('#summary .chart svg')");
  await dragSlider(10, 16); await click("#keep-trial");
  await picture(page, join(pictures, "serve-what-if.jpg"), "#what-if"); await click("#kept li button"); await click("#designs tbody td button", 1);
  await until("document.getElementById('drawer').dataset.id && !document.querySelector('#drawer .bar + .bar button:nth-child(2)').disabled && document.querySelectorAll('#drawer svg').length >= 4");
  await picture(page, join(pictures, "serve-design.jpg")); await click("#drawer .bar + .bar button", 1);
  await until("document.querySelectorAll('#compared tbody tr').length === 2"); await picture(page, join(pictures, "serve-compare.jpg"), "#compare", 900);
  const live = start("optimize", "configs/quick.ini", "--threads", "1", "--out", join(root, "quick"));
  live.stdout.resume();
  while (!(await runs()).some((r) => r.name === "quick")) await pause(50);
  await open("quick"); await until("+document.getElementById('live').dataset.generation > 5"); await picture(page, join(pictures, "serve-live.jpg"), "#live");
}

// ---- what is tried
const tried = {
  async "a page shows a generation while its run goes on, later ones in their order, and the last"() {
    const live = start("optimize", join(root, "a", "settings.ini"), "--max-evals", "100", "--out", join(root, "live"));
    live.stdout.resume();
    const log = join(root, "live", "log.jsonl"), seen = () => (existsSync(log) ? readFileSync(log, "utf8").split("\n").filter((l) => l.startsWith("{") && l.endsWith("}")).map((l) => JSON.parse(l)).filter((e) => e.event === "generation").map((e) => e.number) : []);
    const stored = () => { try { return JSON.parse(execFileSync(imtet, ["status", join(root, "live"), "--json"], { encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] })).generations.length; } catch { return 0; } };
    for (; ; live.kill("SIGCONT"), await pause(20)) {
      live.kill("SIGSTOP"); // however long the page takes, the run has not ended
      if (stored()) break;
    }
    const first = stored() - 1, shows = (generation) => until(`+document.getElementById("live").dataset.generation >= ${generation}`);
    await open("live"); await shows(first); assert.equal(await page.evaluate("document.getElementById('live').dataset.state"), "running");
    await page.evaluate(`(() => { const part = document.getElementById("live"); window.seen = [+part.dataset.generation];
      new MutationObserver(() => window.seen.at(-1) === +part.dataset.generation || window.seen.push(+part.dataset.generation)).observe(part, { attributeFilter: ["data-generation"] }); })()`);
    live.kill("SIGCONT");
    await live.ended;
    const last = seen().at(-1);
    assert.ok(last > first, `generation ${last} after ${first}`);
    await shows(last); await until("document.getElementById('live').dataset.state === 'finished'");
    const shown = await page.evaluate("window.seen"); // one that was passed over shows with a later one
    assert.deepEqual(shown, [...new Set(shown)].sort((a, b) => a - b));
    assert.match(await page.evaluate("document.getElementById('progress-words').textContent"), /^Finished: 100 of 100 designs simulated; 0 failed/);
    await until("!document.getElementById('new-front').hidden"); await click("#new-front");
    await until("document.documentElement?.dataset.ready === 'yes' && document.getElementById('new-front')?.hidden");
  },
  async "a click on a row, a line and a dot opens that design"() {
    await open("a");
    await until("document.querySelector('#summary .warnings')"); // the knee in detail
    const id = await page.evaluate("document.querySelectorAll('#designs tbody tr')[1].dataset.id");
    await click("#designs tbody td button", 1); await designShown(id);
    assert.match(await page.evaluate("document.querySelector('#drawer h2').textContent"), new RegExp(`^Design ${id}\\b`));
    assert.ok((await page.evaluate("document.querySelectorAll('#drawer svg').length")) >= 4, "gaps and peaks");
    for (const picture of ["#front .layers", "#front .grid2 .layers"]) {
      const { x, y, width, height } = await boxOf(picture), places = Array.from({ length: 200 }, (_, k) => [x + width * (0.2 + 0.003 * k), y + height * (0.3 + 0.4 * ((k * 0.37) % 1))]);
      let name = "";
      for (const at of places) {
        await mouse("mouseMoved", ...at, 0);
        name = await page.evaluate(`document.getElementById("tip").hidden || (${picture === "#front .layers"} && document.elementFromPoint(${at}).closest(".brush")) ? "" : document.querySelector("#tip strong").textContent`);
        if (!name) continue;
        await mouse("mouseMoved", ...at, 0); // what the tip names is still there
        if (!(await page.evaluate(`document.querySelector("#tip strong").textContent === ${JSON.stringify(name)}`))) continue;
        await mouse("mousePressed", ...at); await mouse("mouseReleased", ...at);
        break;
      }
      await designShown(name.match(/^Design (\d+)/)[1]);
    }
  },
  async "a slider changes peaks and place while it is dragged"() {
    await open("a"); await until("document.getElementById('what-if').dataset.turn");
    const before = await page.evaluate("document.querySelector('#trial tbody').textContent");
    tell("a gap dragged", await dragSlider(10, 8));
    tell("a thickness dragged", await dragSlider(3, 5)); // a gap may be one that never closes
    assert.notEqual(await page.evaluate("document.querySelector('#trial tbody').textContent"), before);
    assert.match(await page.evaluate("document.getElementById('place').textContent"), /ominated/);
    tell("the peak of the motion dragged", await dragSlider(0, 5));
    assert.match(await page.evaluate("document.getElementById('place').textContent"), /motion or restitution differ/);
    await click("#back"); await until("/Nondominated/.test(document.getElementById('place').textContent)");
  },
  async "a slider is moved by the keyboard"() {
    const turn = await page.evaluate("+document.getElementById('what-if').dataset.turn");
    await page.evaluate("document.querySelectorAll('.slider input[type=range]')[6].focus()"); await press("ArrowLeft");
    await press("ArrowRight"); // it may stand at an end
    await until(`+document.getElementById("what-if").dataset.turn > ${turn} && !document.getElementById("what-if").dataset.busy`);
  },
  async "what is kept is a design file that simulate reads to the same numbers"() {
    const downloads = join(folder, "downloads");
    mkdirSync(downloads, { recursive: true });
    await browser.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: downloads }); await click("#keep-trial");
    await page.evaluate("(() => { const s = document.querySelectorAll('.slider input[type=range]')[7]; s.value = +s.min + 0.3 * (s.max - s.min); s.dispatchEvent(new Event('input')); })()");
    await until("!document.getElementById('what-if').dataset.busy"); await click("#keep-trial"); await click("#save-kept");
    const name = await saved(downloads, (f) => f.endsWith("-kept.csv")), file = join(downloads, name), words = (await page.evaluate("document.querySelector('#kept + pre').textContent")).trim().split(" ");
    assert.deepEqual([words[0], words[1], words[4]], ["imtet", "simulate", name]);
    const said = JSON.parse(execFileSync(imtet, ["simulate", words[2], "--design", file, ...words.slice(5), "--json"]));
    const shown = await page.evaluate("Array.from(document.querySelectorAll('#kept li'), (li) => li.textContent)");
    assert.equal(shown.length, 2);
    said.forEach((o, i) => assert.ok(shown[i].startsWith(`J1 displacement ${+o.j1_m.toPrecision(3)}\u202fm, `), `${shown[i]} is not ${o.j1_m}`));
  },
  async "a number beside a slider is typed; one out of its range leaves no number, and says which that is"() {
    const type = (v) => page.evaluate(`(() => { const e = document.querySelector('[name="gap_05_m number"]'); e.value = ${v}; e.dispatchEvent(new Event("change")); })()`);
    await type(9000); assert.match(await page.evaluate("document.getElementById('place').textContent"), /^gap 5 goes from 1 to 50 mm/);
    assert.equal(await page.evaluate("document.querySelectorAll('#trial').length"), 0);
    await type(33); await until("document.getElementById('trial') && !document.getElementById('what-if').dataset.busy");
    assert.equal(await page.evaluate("document.querySelector('.slider input[name=gap_05_m]').value"), "0.033");
  },
  async "what is kept is a design of the run, of a kind of its own, and comes back with the page"() {
    const rows = () => execFileSync(imtet, ["export", join(root, "a"), "--all", "--csv", "-"], { encoding: "utf8" }).trim().split("\n").filter((row) => row.split(",")[2] === "kept");
    const told = "Array.from(document.querySelectorAll('#kept li'), (li) => li.textContent).join('|')", before = rows().length;
    await click("#keep-trial"); await until(`/design \\d+ of the run[^|]*$/.test(${told})`);
    const last = rows().at(-1).split(","), j1 = await page.evaluate(`${told}.split("|").at(-1)`);
    assert.equal(rows().length, before + 1);
    assert.ok(j1.includes(`design ${last[0]} of the run`), j1);
    await page.call("Page.reload"); await until(`document.getElementById("kept") && ${told}.includes("design ${last[0]}")`);
    assert.ok(await page.evaluate(`document.getElementById("overlays").textContent.includes("design ${last[0]}")`));
  },
  async "designs stand side by side with their differences"() {
    await click("#kept li button");
    await click("#designs tbody td button", 1); await until("document.getElementById('drawer').dataset.id"); await until("!document.querySelector('#drawer .bar + .bar button:nth-child(2)').disabled");
    await click("#drawer .bar + .bar button", 1); await until("document.querySelectorAll('#compared tbody tr').length === 2");
    const differences = await page.evaluate("Array.from(document.querySelectorAll('#compared .difference'), (e) => e.textContent)");
    assert.ok(differences.length >= 5 && differences.every((text) => /^[+\u2212][\d.]+ %$/.test(text)), differences.join());
    assert.ok((await page.evaluate("document.querySelectorAll('#compare figure svg').length")) >= 4);
  },
  async "beside the drawer nothing of what-if, of designs side by side and of tables is cut, and no letter is smaller than 12 px"() {
    await page.evaluate("document.querySelectorAll('details.part').forEach((d) => (d.open = true))");
    await until("!document.getElementById('drawer').hidden && document.querySelectorAll('#compare svg').length >= 4");
    const cut = await page.evaluate(`Array.from(document.querySelectorAll("main .scroll")).filter((e) => e.scrollWidth > e.clientWidth && !e.querySelector("#designs")).map((e) => e.outerHTML.slice(0, 80))`);
    assert.deepEqual(cut, []);
    const words = await page.evaluate(`Array.from(document.querySelectorAll("#what-if svg text, #compare svg text"), (e) => [e.textContent, parseFloat(getComputedStyle(e).fontSize) * Math.hypot(e.getScreenCTM().a, e.getScreenCTM().b), e.getBoundingClientRect().right - e.closest("section").getBoundingClientRect().right])`);
    assert.deepEqual(words.filter(([text, size, beyond]) => text && (size < 11.99 || beyond > 0)), []);
    const titles = await page.evaluate(`Array.from(document.querySelectorAll("#what-if .words span")).filter((e) => (e.textContent = e.textContent.replace(/^J2 .*/, "p(drift_ratio>0.01) [%]"), e.scrollWidth > e.clientWidth || e.scrollHeight > e.clientHeight || e.getBoundingClientRect().bottom > e.closest(".layers").getBoundingClientRect().bottom)).map((e) => e.textContent)`);
    assert.deepEqual(titles, []);
  },
  async "whatever the key of what-if names is in its front"() {
    const missing = await page.evaluate(`(() => {
      const canvas = document.querySelector("#what-if .strip canvas[role=img]"), { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      const isThere = (rgb) => { for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 100 && rgb.every((v, k) => Math.abs(data[i + k] - v) < 8)) return true; };
      return Array.from(document.querySelectorAll("#what-if .beside > .legend span"), (e) => [e.textContent, e.style.getPropertyValue("--key").match(/[0-9a-f]{2}/gi)]).filter(([, hex]) => hex?.length === 3 && !isThere(hex.map((h) => parseInt(h, 16)))).map(([text]) => text);
    })()`);
    assert.deepEqual(missing, []);
    assert.equal(await page.evaluate("document.getElementById('parts').lastElementChild.id"), "theme"); // no link behind it
  },
  async "at 50 kB/s a first picture is there within 120 kB, while the rest is loading"() {
    const slow = await browser.openPage(), at = (await runs()).find((r) => r.name === "a").at;
    await slow.call("Network.emulateNetworkConditions", { offline: false, latency: 400, downloadThroughput: 50 * 1024, uploadThroughput: 50 * 1024 });
    await slow.call("Page.addScriptToEvaluateOnNewDocument", { source: `new MutationObserver(() => { // when it is drawn: a busy browser is asked later
      const c = document.querySelector("#first canvas"), isDrawn = () => c.toDataURL() !== Object.assign(document.createElement("canvas"), { width: c.width, height: c.height }).toDataURL();
      if (c?.parentElement.dataset.rows > 0) window.drawn ??= [document.documentElement.outerHTML.length, document.querySelector("#first p").textContent, isDrawn()];
    }).observe(document, { subtree: true, childList: true, attributeFilter: ["data-rows"] })` });
    await slow.call("Page.navigate", { url: `${url}${at}/` }); await slow.until("window.drawn");
    const [came, words, isDrawn] = await slow.evaluate("window.drawn"); // not packed: more than what came
    assert.ok(came <= 120 * 1024, `${came} bytes came before it`); assert.match(words, /^Loading study a: \d+ designs so far/); assert.ok(isDrawn);
    await slow.until("document.documentElement?.dataset.ready === 'yes' && !document.getElementById('first')");
    console.log(`first picture after ${Math.round(came / 1024)} kB`); await page.call("Page.bringToFront");
  },
  async "a page is packed for a browser, and what is not there is a page for a person and JSON for a script"() {
    const get = (where, headers) => fetch(url + where, { headers, redirect: "manual" }), at = (await runs()).find((r) => r.name === "a").at;
    const packed = await get(`${at}/`, { "accept-encoding": "gzip" }), plain = await get(`${at}/`, { "accept-encoding": "identity" });
    assert.deepEqual([packed, plain].map((r) => r.headers.get("content-encoding")), ["gzip", null]);
    assert.ok(+packed.headers.get("content-length") < 0.5 * +plain.headers.get("content-length"));
    assert.equal(await packed.text(), await plain.text());
    for (const [where, code] of [["999/", 404], [`${at}/nothing`, 404], ["../other/", 403]]) {
      const page_ = await get(where, { accept: "text/html,*/*" }), script = await get(where, { accept: "*/*" });
      assert.deepEqual([page_.status, script.status], [code, code]);
      assert.match(await page_.text(), new RegExp(`<h1>${code}: [^<]+</h1>`));
      assert.ok((await script.json()).error);
    }
  },
  async "runs stand first and lie over each other, and are noted of, renamed and deleted when one confirms it"() {
    assert.equal(await page.evaluate("Array.from(document.querySelectorAll('main > section'), (s) => s.id).filter((id) => id !== 'live')[0]"), "runs");
    await page.evaluate("document.querySelector('[name=\"compare b\"]').click()");
    await until("document.querySelectorAll('#runs figure svg').length >= 1 && document.querySelector('#runs .strip canvas')");
    const on = (name, act) => page.evaluate(`((tr) => ${act})(Array.from(document.querySelectorAll("#all-runs tr")).find((tr) => tr.cells[1].textContent === "${name}"))`), has = (name) => existsSync(join(root, name, "run.sqlite"));
    cpSync(join(root, "c"), join(root, "spare"), { recursive: true });
    await open("a"); await until("document.getElementById('all-runs')"); await page.evaluate("[window.prompt, window.confirm] = [() => 'renamed', () => window.sure]");
    await on("spare", "tr.querySelectorAll('button')[1].click()"); // not confirmed
    await on("spare", "tr.querySelectorAll('button')[0].click()"); await until("/renamed/.test(document.getElementById('all-runs').textContent)");
    assert.deepEqual([has("spare"), has("renamed")], [false, true]);
    await on("renamed", "((e) => { e.value = 'a try'; e.dispatchEvent(new Event('change')); })(tr.querySelector('[type=text]'))");
    for (let k = 0; k < 100 && (await runs()).find((r) => r.name === "renamed").note !== "a try"; k++) await pause(50);
    assert.equal((await runs()).find((r) => r.name === "renamed").note, "a try");
    await page.evaluate("window.sure = true"); await on("renamed", "tr.querySelectorAll('button')[1].click()");
    await until("!/renamed/.test(document.getElementById('all-runs').textContent)"); assert.ok(!existsSync(join(root, "renamed")));
  },
  async "everything live is reached by the Tab key"() {
    const found = new Set(await page.focusedByTab(250));
    for (const wanted of ["pga_g", "gap_06_m", "t_top_m", "keep-trial", "save-kept", "Compare"]) assert.ok(found.has(wanted), `${wanted} is never focused: ${[...found]}`);
  },
  async "a note is kept beside the run and shown again"() {
    const path = join(root, "a", "notes.json"), field = "document.querySelector('#drawer textarea')";
    const write = async (text) => {
      await page.evaluate(`${field}.value = ${JSON.stringify(text)}; ${field}.dispatchEvent(new Event("change"))`);
      for (let k = 0; k < 100 && (existsSync(path) ? Object.keys(JSON.parse(readFileSync(path, "utf8"))).length : 0) !== +(text.trim() !== ""); k++) await pause(50);
      return JSON.parse(readFileSync(path, "utf8"));
    };
    await page.evaluate("document.querySelector('#designs tbody button').click()");
    const id = await page.evaluate("document.querySelector('#designs tbody tr').dataset.id");
    assert.deepEqual(await write("for the client"), { [id]: "for the client" });
    await open("a"); await page.evaluate("document.querySelector('#designs tbody button').click()");
    assert.equal(await page.evaluate(`${field}.value`), "for the client");
    assert.match(await page.evaluate("document.querySelector('#designs tbody tr').title"), /for the client/);
    assert.deepEqual(await write(" "), {});
    rmSync(path);
  },
  async "the first screen keeps its place when what is compared with arrives"() {
    await open("b"); await until("document.getElementById('all-runs')");
    const top = "document.getElementById('front').getBoundingClientRect().top + scrollY", before = await page.evaluate(`document.querySelector("#summary .skeleton") ? ${top} : 0`);
    await until("document.querySelector('#summary .warnings')");
    if (before) assert.ok(Math.abs((await page.evaluate(top)) - before) <= 60, `${before} px, then ${await page.evaluate(top)} px`);
  },
  async "the weights rank as imtet choose does"() {
    const weight = (name, v) => page.evaluate(`(() => { const e = document.querySelector('[name="${name} weight"]'); e.closest("details").open = true; e.value = ${v}; e.dispatchEvent(new Event("input")); })()`);
    const names = await page.evaluate("Array.from(document.querySelectorAll('.weight input[type=range]'), (e) => e.name.split(' ')[0])"), given = names.map((_, k) => (k * 3) % 7);
    for (const [k, name] of names.entries()) await weight(name, given[k]);
    const said = JSON.parse(execFileSync(imtet, ["choose", join(root, "b"), "--weights", names.map((name, k) => `${name}=${given[k]}`).join(), "--json"]));
    await until(`document.querySelector("#ranked tbody tr").dataset.id === "${said.designs.find((d) => d.name === "weighted").id}"`);
    for (let k = 0; k < names.length; k++) await click("#undo");
    await until("!/weights/.test(location.hash)");
  },
  async "nothing is wider than a window of 400, 800 or 1360 px, no word of a strip lies on another"() {
    for (const width of [400, 800, 1360]) {
      await page.call("Emulation.setDeviceMetricsOverride", { width, height: 900, deviceScaleFactor: 1, mobile: false });
      await until(`document.documentElement.scrollWidth <= ${width}`);
      const lie = await page.evaluate(`Array.from(document.querySelectorAll("#what-if .words span"), (e) => e.getBoundingClientRect()).flatMap((a, i, all) => all.slice(i + 1).filter((b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1)).length`);
      assert.equal(lie, 0, `${lie} words lie on others at ${width} px`);
    }
  },
  async "which variables matter is found when its part is opened, as in the report"() {
    await open("a"); await page.evaluate("document.getElementById('which-variables-matter').open = true");
    await page.until("document.querySelector('#which-variables-matter figure svg')");
    const html = join(folder, "a.html");
    execFileSync(imtet, ["report", join(root, "a"), "--out", html]);
    const report = JSON.parse(readFileSync(html, "utf8").match(/id="run">([^]*?)<\/script>/)[1]);
    assert.deepEqual(await page.evaluate("fetch('importance').then((answer) => answer.json())"), report.importance);
  },
  async "a run that judges designs by several simulations has its page, and what-if asks for all of them"() {
    await open("d"); await until("document.querySelector('[name=whole]')");
    const said = "document.getElementById('place').textContent";
    await until(`/^Not comparable/.test(${said})`); await page.evaluate("document.querySelector('[name=whole]').click()"); await until(`/ominated/.test(${said})`);
  },
  async "a run of another problem has its front, its progress and no sliders"() {
    if (!(await runs()).some((r) => r.name === "c")) return;
    await open("c"); await until("document.getElementById('live').dataset.state === 'finished'");
    assert.equal(await page.evaluate("document.querySelectorAll('#what-if').length"), 0);
  },
  async "the browser complains of nothing and asks no one else"() {
    assert.deepEqual(page.complaints((asked) => asked.startsWith(origin)), []);
  },
  async "forty designs simulated by the page are those of the program"() {
    await open("a"); await until("document.getElementById('what-if').dataset.turn");
    const scene = await page.evaluate("fetch('scene').then((answer) => answer.json())"), designs = join(folder, "forty.csv");
    const head = await page.evaluate("JSON.parse(document.getElementById('run').textContent).schema.variables");
    const rows = Array.from({ length: 40 }, (_, i) => head.map((name, j) => scene.lower[j] * (scene.upper[j] / scene.lower[j]) ** ((i * 0.618 + j * 0.382) % 1)));
    writeFileSync(designs, [head, ...rows].map((row) => row.join()).join("\n") + "\n");
    tell(await compare(imtet, designs, join(root, "a", "settings.ini"), (question) => page.evaluate(`imtet.simulate(${JSON.stringify(question)})`)), []);
  },
  async "when the server has gone, the page goes on simulating"() {
    await open("a"); await until("document.querySelector('#trial tbody')");
    children[0].kill("SIGINT");
    await children[0].ended;
    const turn = await page.evaluate("+document.getElementById('what-if').dataset.turn");
    await page.evaluate("(() => { const s = document.querySelectorAll('.slider input[type=range]')[9]; s.value = +s.min + 0.4 * (s.max - s.min); s.dispatchEvent(new Event('input')); })()");
    await until(`+document.getElementById('what-if').dataset.turn > ${turn}`);
  },
  async "a report simulates offline, keeps a design in the file that it saves, and one without engine says nothing of it"() {
    const html = (more) => (execFileSync(imtet, ["report", join(root, "a"), "--out", join(folder, "offline.html"), ...more]), pathToFileURL(join(folder, "offline.html")).href), downloads = join(folder, "downloads"), copy = join(downloads, "a-kept.html");
    const keptNow = () => page.evaluate("[document.querySelectorAll('#kept li').length, [...document.querySelectorAll('#kept li')].at(-1)?.textContent, [...document.querySelectorAll('#overlays label')].filter((e) => /^kept/.test(e.textContent)).length].join('|')");
    const save = async () => {
      await click("#save-page");
      return readFileSync(await saved(downloads, (f) => f === "a-kept.html") && copy, "utf8");
    };
    await page.call("Page.navigate", { url: html([]) }); await until("document.getElementById('what-if')?.dataset.turn");
    page.events.length = 0;
    assert.match(await page.evaluate("document.getElementById('place').textContent"), /ominated/);
    await click("#keep-trial");
    const before = await keptNow(), text = await save();
    assert.match(before, /\(kept 1\).*\|1$/);
    await page.call("Page.navigate", { url: pathToFileURL(copy).href });
    await until("document.getElementById('what-if')?.dataset.turn && !document.getElementById('what-if').dataset.busy");
    assert.equal(await keptNow(), before);
    rmSync(copy);
    assert.ok((await save()) === text, "saved again it is another file");
    await page.evaluate("document.getElementById('energies-and-displacement-over-time').open = true");
    await until("document.querySelectorAll('#what-if details svg').length >= 6");
    assert.deepEqual(page.complaints((asked) => /^file:/.test(asked) || asked.startsWith(origin)), []);
    await page.call("Page.navigate", { url: html(["--no-engine"]) }); await until("document.documentElement?.dataset.ready === 'yes'");
    assert.equal(await page.evaluate("document.querySelectorAll('#what-if, #engine, #scene').length"), 0);
  },
};

setTimeout(() => {
  console.log("FAILED  it takes longer than twelve minutes");
  for (const child of children) child.kill("SIGKILL"); process.exit(1);
}, 720000).unref();

try {
  if (isBench) {
    await page.call("Performance.enable", { timeDomain: "threadTicks" }); await page.call("Page.navigate", { url });
    await until("document.getElementById('what-if')?.dataset.turn");
    await until("document.querySelector('#summary .chart svg')"); // the knee in detail is done
    for (const [what, nth, moves] of [["a thickness", 3, 60], ["a gap", 10, 60], ["the peak of the motion", 0, 40], ["its stretch", 1, 40]]) await benchSlider(what, nth, moves);
  } else if (isPictures) await takePictures();
  else failed += await tryAll(tried);
} finally {
  await browser.close();
  for (const child of children) child.kill("SIGINT");
  await Promise.all(children.map((child) => child.ended));
}
process.exit(failed ? 1 : 0);
