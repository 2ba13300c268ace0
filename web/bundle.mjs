// web/library.js -> web/charts.js, one classic script that defines `charts`, the licences of all it holds on top; they
// also go to web/LICENSES.txt. bundle.mjs [FOLDER] writes the two elsewhere.
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? here;

const { outputFiles, metafile } = await build({
  absWorkingDir: here,
  entryPoints: ["library.js"],
  bundle: true,
  minify: true,
  format: "iife",
  globalName: "charts",
  target: "es2020",
  charset: "utf8",
  legalComments: "none",
  metafile: true,
  write: false,
});

const packages = new Set();
for (const input of Object.keys(metafile.inputs)) {
  const found = input.match(/^(node_modules\/(?:@[^/]+\/)?[^/]+)\//);
  if (found) packages.add(found[1]);
}
const texts = new Map(); // licence -> the packages under it
for (const folder of [...packages].sort()) {
  const { name, version } = JSON.parse(readFileSync(join(here, folder, "package.json"), "utf8"));
  const file = ["LICENSE", "LICENSE.txt", "LICENSE.md"].map((f) => join(here, folder, f)).find(existsSync);
  if (!file) throw new Error(`${name}: no licence file`);
  const text = readFileSync(file, "utf8").trim();
  texts.set(text, [...(texts.get(text) ?? []), `${name} ${version}`]);
}
const licences = [...texts].map(([text, names]) => `${names.join(", ")}\n\n${text}\n`).join("\n---\n\n");
const code = outputFiles[0].text;
if (/<\/script/i.test(code + licences) || licences.includes("*/")) throw new Error("cannot stand inside a page");
writeFileSync(join(out, "LICENSES.txt"), licences);
writeFileSync(join(out, "charts.js"), `/*!\n${licences}*/\n${code}`);
