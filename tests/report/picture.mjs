// A picture of a report, JPEG or PNG by its name:
//   picture.mjs REPORT.html OUT [SELECTOR [HEIGHT [LABEL=VALUE ...]]]
// What the selector finds, unfolded, at most HEIGHT high; first the fields of these labels are filled in (J1 displacement [m] to=0.7).
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { openBrowser, picture } from "./browser.mjs";
const [report, out, selector = "body", height = "100000", ...fields] = process.argv.slice(2);
const browser = await openBrowser();
try {
  const page = await browser.openPage();
  await page.call("Page.navigate", { url: pathToFileURL(resolve(report)).href });
  await page.until("document.documentElement?.dataset.ready === 'yes'");
  for (const field of fields) {
    const [label, value] = field.split("=");
    await page.evaluate(`(() => { const e = document.querySelector('input[aria-label="${label}"]'); e.value = "${value}"; e.dispatchEvent(new Event("change")); })()`);
  }
  await page.evaluate(`(() => { const e = document.querySelector(${JSON.stringify(selector)}); if (e.localName === "details") e.open = true; })()`);
  await picture(page, out, selector, +height);
} finally {
  await browser.close();
}
