// The block of README.md: its types are checked and it runs, on golden bytes.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import test from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { build } from "esbuild";

const web = join(dirname(fileURLToPath(import.meta.url)), "..");
const golden = join(web, "../../proto/golden/tool_force.bin");

test("the program of the README has the types it needs and runs", async () => {
  const readme = readFileSync(join(web, "README.md"), "utf8");
  const blocks = [...readme.matchAll(/^```ts\n(.*?)^```/gms)].map((match) => match[1]);
  assert.equal(blocks.length, 1);
  // Beside the sources, so that types are found as in a program of the package.
  const directory = mkdtempSync(join(web, "tests/readme-"));
  try {
    const source = join(directory, "readme.ts");
    const code = blocks[0].replace('from "palpate"', 'from "../../src/index"');
    const given = `const other_payload: Uint8Array = Uint8Array.from([${[...readFileSync(golden)]}]);\n`;
    writeFileSync(source, `${code.replace(/(import [^;]*;\n)/, `$1${given}`)}\nexport { payload, force, SimEvent };\n`);
    const tsc = join(web, "node_modules/.bin/tsc");
    try {
      execFileSync(tsc, ["--ignoreConfig", "--noEmit", "--strict", "--target", "es2022", "--module", "es2022", "--moduleResolution", "bundler", "--lib", "es2022,dom", "--skipLibCheck", source], { encoding: "utf8" });
    } catch (error) {
      assert.fail(error.stdout);
    }
    const bundle = join(directory, "readme.mjs");
    await build({ entryPoints: [source], bundle: true, format: "esm", target: "es2022", outfile: bundle, logLevel: "error" });
    const { payload, force } = await import(pathToFileURL(bundle).href);
    assert.ok(payload.length > 50);
    assert.equal(typeof force.tick, "bigint");
  } finally {
    rmSync(directory, { recursive: true, force: true });
  }
});
