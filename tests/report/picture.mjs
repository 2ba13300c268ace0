// A picture of a report: picture.mjs REPORT.html OUT.png [SELECTOR [WIDTH]]      the whole page, or what the selector finds
import { writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { openBrowser } from "./browser.mjs";

const [report, out, selector = "html", width = "1360"] = process.argv.slice(2);
const browser = await openBrowser({ width: +width });
try {
  const page = await browser.openPage();
  await page.call("Page.navigate", { url: pathToFileURL(resolve(report)).href });
  await page.until("document.documentElement?.dataset.ready === 'yes'");
  const clip = await page.evaluate(`(() => { const r = document.querySelector(${JSON.stringify(selector)}).getBoundingClientRect();
    return { x: r.x + scrollX, y: r.y + scrollY, width: r.width, height: r.height, scale: 1 }; })()`);
  const { data } = await page.call("Page.captureScreenshot", { format: "png", clip, captureBeyondViewport: true });
  writeFileSync(out, Buffer.from(data, "base64"));
  for (const { method, params } of page.events)
    if (method === "Log.entryAdded" || method === "Runtime.exceptionThrown" || method === "Runtime.consoleAPICalled") console.log(JSON.stringify(params).slice(0, 600));
} finally {
  await browser.close();
}
