// Headless Chromium over its debugging pipe: file descriptors 3 and 4, one JSON message up to each NUL byte.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

export async function openBrowser({ program = "chromium", width = 1360, height = 900 } = {}) {
  const profile = mkdtempSync(join(tmpdir(), "imtet-chromium-"));
  const child = spawn(program, ["--headless=new", "--remote-debugging-pipe", "--no-sandbox", "--disable-gpu", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-dev-shm-usage", "--hide-scrollbars",
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

    // Until the expression is true; it is asked every 20 ms.
    async function until(expression, seconds = 60) {
      const end = Date.now() + 1000 * seconds;
      while (!(await evaluate(expression))) {
        if (Date.now() > end) throw new Error(`never came true: ${expression}`);
        await new Promise((resolve) => setTimeout(resolve, 20));
      }
    }
    return { call, evaluate, until, events };
  }

  async function close() {
    await send("Browser.close").catch(() => {});
    await gone;
    rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
  }
  return { openPage, close, send };
}
