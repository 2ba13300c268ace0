// Headless Chromium over its debugging pipe: file descriptors 3 and 4, one JSON message up to each NUL byte.
import { spawn } from "node:child_process";
import { mkdtempSync, readdirSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
export const pause = (ms) => new Promise((done) => setTimeout(done, ms));
const KEY_CODES = { Tab: 9, Enter: 13, Escape: 27, ArrowLeft: 37, ArrowRight: 39, Delete: 46 };

// Runs { "what is expected": async function }; how many failed.
export async function tryAll(trials) {
  let failed = 0;
  for (const [what, trial] of Object.entries(trials)) {
    const start = Date.now();
    try {
      await trial();
      console.log(`ok      ${what} (${Date.now() - start} ms)`);
    } catch (error) {
      failed++;
      console.log(`FAILED  ${what}\n        ${error.message.replaceAll("\n", "\n        ")}`);
    }
  }
  return failed;
}

// The name of a file that the browser has saved: its size has rested for so long.
export async function saved(place, is, ms = 100) {
  for (let k = 0, size = 0, before = 0; k < 600; k++, before = size, await pause(ms)) {
    const name = readdirSync(place).find(is);
    if ((size = name ? statSync(join(place, name)).size : 0) && size === before) return name;
  }
  throw new Error("nothing was saved");
}

export async function openBrowser({ program = "chromium", width = 1360, height = 900 } = {}) {
  const profile = mkdtempSync(join(tmpdir(), "imtet-chromium-"));
  const child = spawn(program, ["--headless=new", "--remote-debugging-pipe", "--no-sandbox", "--disable-gpu", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-dev-shm-usage", "--hide-scrollbars", "--force-prefers-reduced-motion",
    `--user-data-dir=${profile}`, `--window-size=${width},${height}`, "about:blank"],
  { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
  const waiting = new Map(), listeners = [];
  let next = 1, rest = Buffer.alloc(0);
  const gone = new Promise((resolve) => child.once("exit", resolve));

  child.stdio[4].on("data", (chunk) => {
    rest = Buffer.concat([rest, chunk]);
    for (let end; (end = rest.indexOf(0)) >= 0; rest = rest.subarray(end + 1)) {
      const message = JSON.parse(rest.subarray(0, end).toString());
      const call = waiting.get(message.id);
      if (!call) for (const listen of listeners) listen(message);
      else if (message.error) call.reject(new Error(`${call.method}: ${message.error.message}`));
      else call.resolve(message.result);
      waiting.delete(message.id);
    }
  });
  child.once("exit", () => {
    for (const call of waiting.values()) call.reject(new Error("chromium ended"));
  });

  function send(method, params = {}, sessionId = undefined) {
    const id = next++;
    child.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    return new Promise((resolve, reject) => waiting.set(id, { method, resolve, reject }));
  }

  async function openPage() {
    const { targetId } = await send("Target.createTarget", { url: "about:blank" });
    const { sessionId } = await send("Target.attachToTarget", { targetId, flatten: true });
    const call = (method, params) => send(method, params, sessionId);
    const events = [];
    listeners.push((message) => message.sessionId === sessionId && events.push(message));
    for (const domain of ["Page", "Runtime", "Network", "Log", "Audits"]) await call(`${domain}.enable`);
    await call("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });

    async function evaluate(expression) {
      const { result, exceptionDetails } = await call("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
      if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
      return result.value;
    }

    // While the page changes to another one, nobody is there to answer.
    const isBetweenPages = (error) => /navigated or closed|context was destroyed|Cannot find (default execution )?context/.test(error.message);
    const isTrue = (expression) => evaluate(`(async () => {
      for (const end = Date.now() + 1000; Date.now() < end; await new Promise((done) => setTimeout(done, 20))) if (${expression}) return true;
    })()`).catch((error) => {
      if (!isBetweenPages(error)) throw error;
    });

    // Until the expression is true; it is asked every 20 ms, within the page: asking from here costs more.
    async function until(expression, seconds = 90) {
      const end = Date.now() + 1000 * seconds;
      while (!(await isTrue(expression))) {
        if (Date.now() > end) throw new Error(`never came true: ${expression}`);
        await pause(20);
      }
    }

    const mouse = (type, x, y, buttons = type === "mouseReleased" ? 0 : 1) => call("Input.dispatchMouseEvent",
      { type, x, y, button: buttons || type === "mouseReleased" ? "left" : "none", buttons, clickCount: 1 });

    // Of the nth that the selector finds, in the middle of the window, once it has rested there for ten frames: a page that loads moves.
    const boxOf = (selector, nth = 0) => evaluate(`(async () => { const e = document.querySelectorAll(${JSON.stringify(selector)})[${nth}];
      for (let box = "", rests = 0; rests < 10; rests++, await new Promise(requestAnimationFrame)) {
        e.scrollIntoView({ behavior: "instant", block: "center" });
        if (box !== (box = JSON.stringify(e.getBoundingClientRect()))) rests = 0;
      }
      const { x, y, width, height } = e.getBoundingClientRect(); return { x, y, width, height }; })()`);

    // A page that draws itself anew between the halves of a click takes none: then again. One that went away took it.
    async function click(selector, nth = 0) {
      for (let tries = 0; tries < 5; tries++) {
        const { x, y, width, height } = await boxOf(selector, nth);
        await evaluate(`window.taken = false; document.querySelectorAll(${JSON.stringify(selector)})[${nth}]?.addEventListener("click", () => { window.taken = true; }, true)`);
        for (const type of ["mousePressed", "mouseReleased"]) await mouse(type, x + width / 2, y + height / 2);
        if (await evaluate("window.taken !== false").catch(() => true)) return;
      }
      throw new Error(`${selector} takes no click`);
    }

    async function press(key) {
      const windowsVirtualKeyCode = KEY_CODES[key] ?? key.toUpperCase().charCodeAt(0), text = key.length === 1 ? key : key === "Enter" ? "\r" : undefined;
      await call("Input.dispatchKeyEvent", { type: "keyDown", key, code: key, windowsVirtualKeyCode, text });
      await call("Input.dispatchKeyEvent", { type: "keyUp", key, code: key, windowsVirtualKeyCode });
    }

    // What is focused while the Tab key is pressed so often: id, name or words of each, else its tag and the id it stands in.
    async function focusedByTab(often) {
      await evaluate(`(() => { document.activeElement.blur(); window.focused = new Set(); document.addEventListener("focusin", ({ target: e }) =>
        [e.id, e.name, e.textContent.slice(0, 20), e.tagName + " in " + e.parentElement.id].forEach((word) => window.focused.add(word))); })()`);
      await Promise.all(Array.from({ length: often }, () => press("Tab")));
      return evaluate("Array.from(window.focused)");
    }

    // Faults that the browser saw so far: console, exceptions, policy; requests to what is not its own.
    function complaints(isOwn) {
      return events.flatMap(({ method, params }) => {
        if (method === "Log.entryAdded") return [`log: ${params.entry.text} ${params.entry.url ?? ""}`];
        if (method === "Runtime.exceptionThrown") return [`exception: ${params.exceptionDetails.exception?.description ?? params.exceptionDetails.text}`];
        if (method === "Runtime.consoleAPICalled") return [`console: ${JSON.stringify(params.args)}`];
        if (method === "Audits.issueAdded") return [`issue: ${JSON.stringify(params.issue.details).slice(0, 400)}`];
        if (method === "Network.requestWillBeSent" && !/^(data|blob):/.test(params.request.url) && !isOwn(params.request.url)) return [`request: ${params.request.url.slice(0, 200)}`];
        return [];
      });
    }
    return { call, evaluate, until, events, mouse, boxOf, click, press, focusedByTab, complaints };
  }

  async function close() {
    await send("Browser.close").catch(() => {}); await gone;
    rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
  }
  return { openPage, close, send };
}

// What the selector finds, at most `height` high, or what is in the window, as JPEG or PNG by the name of the file; two dots for one of the page.
export async function picture(page, file, selector, height = 1e5) {
  await pause(1000); // lines come in passes
  const clip = await page.evaluate(`(() => { if (!${!!selector}) return { x: scrollX, y: scrollY, width: innerWidth, height: innerHeight, scale: 2 };
    const bar = document.getElementById("parts"), r = document.querySelector(${JSON.stringify(selector ?? "body")}).getBoundingClientRect();
    if (bar) bar.style.position = "static"; // it would lie over what is long
    return { x: r.x + scrollX, y: r.y + scrollY, width: r.width, height: Math.min(r.height, ${height}), scale: 2 }; })()`);
  const { data } = await page.call("Page.captureScreenshot", { clip, captureBeyondViewport: !!selector,
    ...(file.endsWith(".jpg") ? { format: "jpeg", quality: 70 } : { format: "png" }) });
  writeFileSync(file, Buffer.from(data, "base64"));
}
