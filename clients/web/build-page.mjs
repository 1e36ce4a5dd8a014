// Makes the page that the daemon embeds: src/viewer/page of the repository. The same sources make the same bytes.
// `--check`: makes nothing, fails if what is there differs.

import { build } from "esbuild";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const out = here("../../src/viewer/page/");
const MOST_GZIPPED = 1_000_000;
const MARK = "Generated from clients/web by `npm run page`; do not edit.";

async function bundle(entry, extra) {
  const result = await build({
    entryPoints: [here(entry)], bundle: true, minify: true, write: false, target: "es2022", charset: "utf8",
    legalComments: "none", logLevel: "warning", absWorkingDir: here("."), ...extra,
  });
  return result.outputFiles[0].text;
}

/** Libraries whose code is in the page, with their licences. */
async function licences() {
  const parts = ["Libraries in the page of Palpate, and their licences.\n"];
  for (const name of ["three", "uplot", "fzstd"]) {
    const about = JSON.parse(await readFile(here(`node_modules/${name}/package.json`), "utf8"));
    const text = await readFile(here(`node_modules/${name}/LICENSE`), "utf8");
    parts.push(`${"-".repeat(72)}\n${name} ${about.version}, ${about.license}\n\n${text.trim()}\n`);
  }
  return parts.join("\n");
}

const js = await bundle("src/page/main.ts", { format: "iife" });
if (js.includes("</script")) throw new Error("app.js holds </script and could not be put into a page");
const files = {
  "index.html": await readFile(here("src/page/index.html"), "utf8"),
  "app.js": `// ${MARK} Licences of the libraries in it: THIRD-PARTY.txt.\n${js}`,
  "app.css": `/* ${MARK} */\n${await bundle("src/page/page.css", {})}`,
  "THIRD-PARTY.txt": await licences(),
};

const served = ["index.html", "app.js", "app.css"];
const size = served.reduce((sum, name) => sum + gzipSync(files[name], { level: 9 }).length, 0);
if (size > MOST_GZIPPED) throw new Error(`the page has ${size} bytes gzipped, more than ${MOST_GZIPPED}`);

if (process.argv.includes("--check")) {
  for (const [name, text] of Object.entries(files)) {
    const there = await readFile(out + name, "utf8").catch(() => "");
    if (there !== text) throw new Error(`src/viewer/page/${name} is not what clients/web makes: run npm run page`);
  }
} else {
  await mkdir(out, { recursive: true });
  for (const [name, text] of Object.entries(files)) await writeFile(out + name, text);
}
console.log(`page: ${served.map((name) => `${name} ${(files[name].length / 1e3).toFixed(0)} kB`).join(", ")}; gzipped ${(size / 1e3).toFixed(0)} kB in all`);
