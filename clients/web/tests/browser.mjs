// The page in a real browser: against a mock daemon, and with PALPATE=path/of/palpate against the real one.
//
//   npm run test:browser                      # all of the mock's
//   PALPATE=target/debug/palpate npm run test:browser
//   node tests/browser.mjs NAN 320            # those whose name holds one of these
//
// CHROMIUM: the browser, default /usr/bin/chromium. SHOTS: a directory for pictures.

import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";
import WebSocket from "ws";
import * as bus from "../dist/palpate.js";
import { frame, openFrame } from "../dist/page.js";
import { withoutScene } from "./builds.mjs";
import { Mock } from "./mock.mjs";
import { bodyOf, forceOf, sheetOf, snapshotOf, statusOf, toolOf } from "./scenes.mjs";

const repository = fileURLToPath(new URL("../../../", import.meta.url));
const golden = (name) => readFileSync(join(repository, "recordings/golden", name));
const GL = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
/** What a busy computer may spoil is tried so often. */
const TRIES = 6;
/** How long anything is waited for: pictures are drawn by the processor, which other tests use as well. */
const PATIENCE_MS = 120_000;
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const wanted = process.argv.slice(2);
const tests = [];
const test = (name, run, options = {}) => tests.push({ name, run, options });

/** Waits until a question to the page has a true answer. */
async function until(page, question, what, ms = PATIENCE_MS) {
  const start = Date.now();
  for (;;) {
    const answer = await page.evaluate(question).catch(() => null);
    if (answer) return answer;
    if (Date.now() - start > ms) throw new Error(`not within ${ms} ms: ${what}\n${JSON.stringify(await page.evaluate(() => window.palpate?.report()).catch(() => null))?.slice(0, 900)}`);
    await sleep(30);
  }
}

const report = (page) => page.evaluate(() => window.palpate.report());

/** Where a tool is on the screen. */
async function place(page, k = 0) {
  return page.evaluate((index) => {
    const { screen } = window.palpate.report().tools[index];
    const box = document.getElementById("view").getBoundingClientRect();
    return { x: screen.x + box.left, y: screen.y + box.top };
  }, k);
}

async function drag(page, by, steps = 12, k = 0) {
  const from = await place(page, k);
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (let s = 1; s <= steps; s++) {
    await page.mouse.move(from.x + (by[0] * s) / steps, from.y + (by[1] * s) / steps);
    await sleep(16);
  }
}

/** Waits until the mock has been sent a key so many times: what a page sends is on its way for a while. */
async function untilSaid(mock, wanted, times = 1) {
  for (const start = Date.now(); mock.said.filter(([key]) => key === wanted).length < times; await sleep(30)) {
    if (Date.now() - start > PATIENCE_MS) throw new Error(`not within ${PATIENCE_MS} ms: ${wanted}, ${times} times`);
  }
}

/** Pixels to drag a tool by so many metres. */
const pixelsOf = async (page, metres, k = 0) => metres / (await report(page)).tools[k].screen.metresPerPixel;

/** Pixels of the picture, small. */
const pixels = (page) => page.evaluate(() => {
  const { stage } = window.palpate;
  stage.renderer.render(stage.scene, stage.camera);
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [160, 100];
  const pen = copy.getContext("2d");
  pen.drawImage(stage.canvas, 0, 0, 160, 100);
  return [...pen.getImageData(0, 0, 160, 100).data];
});

function changed(a, b) {
  let count = 0;
  for (let k = 0; k < a.length; k += 4) if (Math.abs(a[k] - b[k]) + Math.abs(a[k + 1] - b[k + 1]) + Math.abs(a[k + 2] - b[k + 2]) > 24) count += 1;
  return count;
}

/** Waits until so many pixels are others than before. */
async function untilChanged(page, before, least, what) {
  let most = 0;
  for (let k = 0; k < 60; k++) {
    most = Math.max(most, changed(before, await pixels(page)));
    if (most > least) return;
    await sleep(100);
  }
  throw new Error(`${what}: ${most} pixels changed, not ${least}`);
}

/** A scene is there, drawn and told of. */
const ready = (page) => until(page, () => window.palpate?.report().bodies.length > 0 && window.palpate.report().costMs > 0
  && document.querySelectorAll("#tools button").length > 0, "a scene");
const text = (page, selector) => page.locator(selector).innerText();

async function shot(page, name) {
  if (process.env.SHOTS === undefined) return;
  mkdirSync(process.env.SHOTS, { recursive: true });
  await page.screenshot({ path: join(process.env.SHOTS, `${name}.png`) });
}

// ---- Live, against the mock.

test("first picture: the body is drawn, nothing is said on the console", async ({ open }) => {
  const page = await open();
  await ready(page);
  const painted = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime);
  const { firstPictureMs } = await report(page);
  console.log(`    first paint ${painted?.toFixed(0)} ms, first picture of the scene ${firstPictureMs.toFixed(0)} ms`);
  const seen = await pixels(page);
  let opaque = 0;
  for (let k = 3; k < seen.length; k += 4) if (seen[k] > 200) opaque += 1;
  assert.ok(opaque > 400, `${opaque} pixels of 16,000 are drawn`);
  await shot(page, "first");
});

test("a drag presses the body: force, dent, chart and number follow", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  await sleep(400);
  const before = await pixels(page);
  await drag(page, [-190, 0], 20);
  await until(page, () => Math.hypot(...window.palpate.report().tools[0].force) > 1, "a force");
  await untilChanged(page, before, 60, "the dent");
  await until(page, () => Number(document.querySelector("[data-value=force]").textContent) > 1, "the number");
  assert.ok((await page.locator("#labels .force").first().innerText()).endsWith(" N"));
  const { extents, tools } = await report(page);
  assert.ok(extents[0][0][1] > 1e-3, "no displacement is shown");
  assert.ok(tools[0].rows > 5, "the chart has no rows");
  assert.match(tools[0].holder, /^mouse/);
  await shot(page, "press");
  await page.mouse.up();
  await until(page, () => window.palpate.report().hand === "free", "the tool given back");
  await untilSaid(mock, "tool/ball/release");
  await until(page, () => window.palpate.report().tools[0].holder === null, "nobody holds it");
});

test("from the drag to the arrow are at most two pictures", async ({ open }) => {
  const page = await open();
  await ready(page);
  await drag(page, [-150, 0], 10);
  await until(page, () => window.palpate.report().tools[0].holder, "the tool");
  // In the page: a pose goes out at once when the pointer moves, its force comes back, the next picture shows it.
  const frames = await page.evaluate(async () => {
    const counts = [];
    for (let k = 0; k < 12; k++) {
      await new Promise((resolve) => setTimeout(resolve, 60));
      const before = window.palpate.report().tools[0].force.join();
      window.palpate.hand.move([k % 2 === 0 ? -0.002 : 0.002, 0, 0]);
      let count = 0;
      while (window.palpate.report().tools[0].force.join() === before && count < 30) {
        await new Promise((resolve) => requestAnimationFrame(resolve));
        count += 1;
      }
      counts.push(count);
    }
    return counts.sort((a, b) => a - b);
  });
  console.log(`    pictures until the force: median ${frames[6]}, most ${frames.at(-1)}`);
  assert.ok(frames[6] <= 2, `${frames}`);
  await page.mouse.up();
});

test("the wheel pushes along the view while a tool is held, and zooms otherwise", async ({ open }) => {
  const page = await open();
  await ready(page);
  await drag(page, [-20, 0], 4);
  await until(page, () => window.palpate.report().tools[0].hand !== null, "the hand");
  const before = (await report(page)).tools[0].hand;
  await page.mouse.wheel(0, -400);
  await until(page, `Math.hypot(...window.palpate.report().tools[0].hand.map((x, c) => x - ${JSON.stringify(before)}[c])) > 0.005`, "the push");
  await page.mouse.up();
});

test("keys alone: take the tool, press, let go, pause, step, help", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  await page.keyboard.press("t");
  await until(page, () => window.palpate.report().tools[0].holder !== null, "the tool");
  for (let k = 0; k < 26; k++) await page.keyboard.press("ArrowLeft");
  await until(page, () => Math.hypot(...window.palpate.report().tools[0].force) > 0.5, "a force");
  await page.keyboard.press("Escape");
  await until(page, () => window.palpate.report().hand === "free", "the tool given back");
  await page.keyboard.press(" ");
  await until(page, () => document.getElementById("link").textContent === "Paused", "pause");
  const { tick } = mock;
  await page.keyboard.press(".");
  await until(page, () => !document.getElementById("step").disabled, "the step button");
  for (const start = Date.now(); mock.tick === tick; await sleep(30)) assert.ok(Date.now() - start < PATIENCE_MS, "no step was made");
  await page.keyboard.press("?");
  assert.ok(await page.locator("dialog#help").isVisible());
  await page.keyboard.press("Escape");
  await until(page, () => document.querySelector("dialog[open]") === null, "help closed");
  await page.keyboard.press(" ");
  await until(page, () => document.getElementById("link").textContent === "Live", "running");
});

test("two pages drag one tool: the second is refused and told who holds it", async ({ open }) => {
  const [first, second] = [await open(), await open()];
  await ready(first);
  await ready(second);
  // By a key, so that the tool stays where the second page aims.
  await first.keyboard.press("t");
  const holder = await until(first, () => window.palpate.report().tools[0].holder, "the tool");
  await drag(second, [-30, 0], 4);
  await until(second, () => document.getElementById("notices").textContent.includes("held by"), "the refusal");
  assert.ok((await text(second, "#notices")).includes(holder));
  assert.equal((await report(second)).hand, "free");
  await second.mouse.up();
});

test("what the server refuses says why", async ({ open }) => {
  const page = await open();
  await ready(page);
  await page.click("#snapshot");
  await until(page, () => document.getElementById("notices").textContent.includes("nothing is kept in memory"), "the reason");
});

test("recording starts and stops from the deck", async ({ open }) => {
  const page = await open();
  await ready(page);
  await page.click("#record");
  await until(page, () => document.getElementById("record").classList.contains("recording"), "recording");
  await page.click("#record");
  await until(page, () => document.getElementById("notices").textContent.includes("Recorded a.mcap"), "the file");
});

test("view only: nothing can be pressed, and that is said", async ({ open, mock }) => {
  mock.token = null;
  const page = await open();
  await ready(page);
  assert.ok((await text(page, "#deck")).includes("looking only"));
  assert.ok(await page.locator("#pause").isDisabled());
  await drag(page, [-60, 0], 4);
  await page.mouse.up();
  assert.ok(mock.said.every(([key]) => !key.startsWith("tool/")));
});

test("daemon gone and back, the scene the same: goes on by itself, from the same place", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  await sleep(300);
  await page.evaluate(() => window.palpate.stage.orbit(0.5, 0.1));
  await sleep(300);
  const before = await page.evaluate(() => window.palpate.stage.camera.position.toArray());
  const { port } = mock;
  await mock.stop();
  await until(page, () => document.getElementById("notices").textContent.includes("does not answer"), "the loss");
  await sleep(700);
  await mock.start(port);
  await until(page, () => window.palpate.report().link === "live" && !document.getElementById("notices").textContent.includes("does not answer"), "the connection");
  const after = await page.evaluate(() => window.palpate.stage.camera.position.toArray());
  assert.ok(Math.hypot(...after.map((x, c) => x - before[c])) < 1e-3, "the view jumped");
}, { console: /ERR_CONNECTION|WebSocket|Failed to load/ });

test("daemon gone while dragging, another scene when it is back", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  await drag(page, [-40, 0], 4);
  const { port } = mock;
  await mock.stop();
  await until(page, () => window.palpate.report().link === "lost", "the loss");
  mock.scene = snapshotOf([sheetOf("sheet", 8)], [toolOf("pen", [0, 0, 0.03])], "other");
  mock.token = "another";
  await mock.start(port);
  await until(page, () => window.palpate.report().bodies[0]?.id === "sheet" && window.palpate.report().link === "live", "the scene");
  assert.equal((await report(page)).hand, "free");
  await page.mouse.up();
  await page.keyboard.press("t");
  await until(page, () => window.palpate.report().tools[0].holder !== null, "its tool");
}, { console: /ERR_CONNECTION|WebSocket|Failed to load/ });

test("scene swap while dragging: the drag goes on", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  await drag(page, [-40, 0], 6);
  await until(page, () => window.palpate.report().tools[0].holder, "the tool");
  mock.setScene(snapshotOf([bodyOf("drop"), bodyOf("second", "torus", [0, 0.1, 0])]));
  mock.event({ type: "SceneChanged", what: "second was added" });
  await until(page, () => window.palpate.report().bodies.length === 2, "both bodies");
  const before = (await report(page)).tools[0].hand[0];
  const at = await place(page);
  await page.mouse.move(at.x - 60, at.y);
  await page.mouse.move(at.x - 120, at.y);
  await until(page, `window.palpate.report().tools[0].hand[0] !== ${before}`, "the hand goes on");
  assert.equal((await report(page)).hand, "holding");
  await until(page, () => document.getElementById("events").textContent.includes("second was added"), "the event");
  await page.mouse.up();
});

test("a body becomes another under the same name", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  mock.setScene(snapshotOf([sheetOf("drop", 12)]));
  await until(page, () => window.palpate.report().bodies[0].points === 144, "the other body");
  await until(page, () => window.palpate.stage.renderer.info.render.triangles > 100, "its picture");
});

test("NaN in a net: that body is left out and named, the others stay", async ({ open, mock }) => {
  mock.scene = snapshotOf([bodyOf("drop"), bodyOf("second", "torus", [0, 0.1, 0])]);
  const page = await open();
  await ready(page);
  const [body] = mock.scene.bodies;
  const points = body.points.slice();
  points[10] = NaN;
  mock.net(body, points);
  await until(page, () => document.getElementById("notices").textContent.includes("control point 3 of drop"), "the fault");
  assert.equal((await report(page)).bodies[1].fault, null);
  mock.net(body, body.points);
  await until(page, () => !document.getElementById("notices").textContent.includes("Not drawn"), "the body again");
});

test("64 tools", async ({ open, mock }) => {
  mock.scene = snapshotOf([bodyOf("drop")], Array.from({ length: 64 }, (_, k) => toolOf(`tool-${k}`, [0.08 * Math.cos(k / 10), 0.08 * Math.sin(k / 10), 0.01 + 0.0012 * k], 0.003)));
  const page = await open();
  await ready(page);
  assert.equal(await page.locator("#tools button").count(), 64);
  for (let n = 0; n < 20; n++) {
    for (let k = 0; k < 64; k++) mock.toAll(`tool/tool-${k}/force`, bus.encode(bus.ToolForce, forceOf(mock.tick, [k / 10, 0, 0], mock.scene.tools[k].position, 0.001)));
    await sleep(16);
  }
  await until(page, () => window.palpate.report().tools[63].force[0] > 6, "the last force");
  const { y, height } = await page.locator("#panel #charts").boundingBox();
  assert.ok(y < 420 && height > 100, "the charts are pushed away");
  await shot(page, "64-tools");
});

test("50 bodies", async ({ open, mock }) => {
  mock.scene = snapshotOf(Array.from({ length: 50 }, (_, k) => bodyOf(`body-${k}`, "teardrop", [(k % 10) * 0.06, Math.floor(k / 10) * 0.06, 0])));
  const page = await open();
  await ready(page);
  await until(page, () => window.palpate.stage.renderer.info.render.calls >= 50, "all of them");
  for (let n = 0; n < 10; n++) {
    for (const body of mock.scene.bodies) mock.net(body, body.points.map((x) => x * (1 + 0.001 * n)));
    await sleep(30);
  }
  await until(page, () => window.palpate.report().extents[0][49][1] > 1e-5, "their nets");
  await shot(page, "50-bodies");
});

test("a net of 20 x 20 that moves with every picture", async ({ open, mock }) => {
  mock.scene = snapshotOf([sheetOf("sheet", 20)], [toolOf("pen", [0, 0, 0.03], 0)]);
  const page = await open();
  await ready(page);
  const [body] = mock.scene.bodies;
  for (let n = 1; n <= 120; n++) {
    mock.net(body, body.points.map((x, k) => (k % 3 === 2 ? 0.01 * Math.sin(n / 6) * Math.exp(-((body.points[k - 2] ** 2 + body.points[k - 1] ** 2) / 4e-4)) : x)));
    await sleep(16);
  }
  const { updateMs, costMs } = await report(page);
  console.log(`    a picture costs the page ${updateMs.toFixed(1)} ms for surfaces and ${costMs.toFixed(1)} ms for drawing`);
  assert.ok((await report(page)).extents[0][0][1] > 1e-4);
});

test("a page that goes to the background gives its tool back", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  await drag(page, [-30, 0], 4);
  await until(page, () => window.palpate.report().tools[0].holder, "the tool");
  await page.evaluate(() => {
    Object.defineProperty(document, "hidden", { configurable: true, get: () => true });
    document.dispatchEvent(new Event("visibilitychange"));
  });
  await until(page, () => window.palpate.report().hand === "free" && window.palpate.report().tools[0].holder === null, "the tool given back");
  await untilSaid(mock, "tool/ball/release");
  await page.mouse.up();
});

test("a net of 200 x 200", async ({ open, mock }) => {
  mock.scene = snapshotOf([sheetOf("sheet", 200)], [toolOf("pen", [0, 0, 0.03], 0)]);
  const page = await open();
  await ready(page);
  const [body] = mock.scene.bodies;
  for (let n = 1; n <= 10; n++) {
    mock.net(body, body.points.map((x, k) => (k % 3 === 2 ? 0.004 * Math.sin(n / 3) * Math.exp(-((body.points[k - 2] ** 2 + body.points[k - 1] ** 2) / 4e-4)) : x)));
    await sleep(33);
  }
  await until(page, () => window.palpate.report().extents[0][0][1] > 1e-4, "the dent");
  await shot(page, "200x200");
});

test("a page that was stopped for long catches up: a burst of an hour's frames leaves it whole", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  for (let n = 0; n < 200; n++) {
    for (let k = 0; k < 100; k++) {
      mock.tick += 16n;
      mock.toAll("tool/ball/force", bus.encode(bus.ToolForce, forceOf(mock.tick, [1, 0, 0])));
    }
    if (n % 20 === 0) await sleep(1);
  }
  const last = Number(mock.tick);
  await until(page, `window.palpate.report().tick >= ${last}`, "the newest tick");
  assert.ok((await report(page)).tools[0].rows <= 5200);
});

test("garbage on the socket changes nothing", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  for (const socket of mock.sockets) {
    socket.send(Buffer.from([200, 1, 2]));
    socket.send(frame("tool/ball/force", new Uint8Array([1, 2])));
    socket.send("text");
  }
  await until(page, () => window.palpate.report().malformed === 2, "both counted");
  assert.equal((await report(page)).link, "live");
});

test("WebGL lost and restored", async ({ open }) => {
  const page = await open();
  await ready(page);
  await sleep(500);
  const before = await pixels(page);
  await page.evaluate(() => {
    window.lost = window.palpate.stage.renderer.getContext().getExtension("WEBGL_lose_context");
    window.lost.loseContext();
  });
  await until(page, () => document.getElementById("notices").textContent.includes("graphics were lost"), "the loss");
  await page.evaluate(() => window.lost.restoreContext());
  await until(page, () => !document.getElementById("notices").textContent.includes("graphics were lost"), "the return");
  await until(page, () => !window.palpate.stage.renderer.getContext().isContextLost(), "the context");
  let differ = Infinity;
  for (let k = 0; k < 60 && differ >= 3000; k++) {
    await sleep(100);
    differ = changed(before, await pixels(page));
  }
  assert.ok(differ < 3000, `${differ} pixels are not as before`);
}, { console: /CONTEXT_LOST|Context Lost|Context Restored|context/i });

test("WebGL missing: says so, charts and controls work", async ({ open, mock }) => {
  const page = await open({ init: () => {
    const get = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      return kind.startsWith("webgl") ? null : get.call(this, kind, ...rest);
    };
  } });
  await until(page, () => window.palpate?.report().bodies.length > 0, "a scene");
  assert.ok((await text(page, "#empty")).includes("no WebGL"));
  // Others come meanwhile: one alone may be shown too shortly to be seen.
  const pressing = setInterval(() => {
    mock.tick += 50n;
    mock.toAll("tool/ball/force", bus.encode(bus.ToolForce, forceOf(mock.tick, [3, 0, 0])));
  }, 50);
  await until(page, () => document.querySelector("[data-value=force]").textContent === "3.00", "the force");
  clearInterval(pressing);
  assert.ok((await page.locator(".chart canvas").count()) >= 4);
  await page.click("#pause");
  await until(page, () => document.getElementById("link").textContent === "Paused", "pause");
  await shot(page, "no-webgl");
}, { console: /WebGL/i });

for (const [width, height] of [[320, 568], [390, 844]]) {
  test(`a window of ${width} px: everything is on it, nothing sticks out`, async ({ open }) => {
    for (const colorScheme of ["light", "dark"]) {
      const page = await open({ viewport: { width, height }, colorScheme });
      await ready(page);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(wide <= width, `${wide} px wide`);
      for (const id of ["pause", "step", "reset", "record", "snapshot", "save-picture", "save-net", "save-step", "look-toggle", "theme", "help-open"]) {
        const box = await page.locator(`#${id}`).boundingBox();
        assert.ok(box !== null && box.x >= 0 && box.x + box.width <= width && box.y + box.height <= height, `${id}: ${JSON.stringify(box)}`);
      }
      const view = await page.locator("#view").boundingBox();
      assert.ok(view.height >= 200, `the picture is ${view.height} px high`);
      await shot(page, `${width}-${colorScheme}`);
      await page.close();
    }
  });
}

test("a recording on 320 and 390 px: its deck is on the window", async ({ open, mock }) => {
  serve(mock, [["tap.mcap", golden("teardrop-tap.mcap")]]);
  for (const [width, height] of [[320, 568], [390, 844]]) {
    const page = await open({ viewport: { width, height }, colorScheme: "light" });
    await played(page);
    await sleep(300);
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= width);
    for (const selector of ["#back", "#pause", "#step", "#loop", "#speed", "#track", "#save-picture", "#save-step"]) {
      const box = await page.locator(selector).boundingBox();
      assert.ok(box !== null && box.x >= 0 && box.x + box.width <= width && box.y + box.height <= height, `${selector}: ${JSON.stringify(box)}`);
    }
    assert.ok((await page.locator("#view").boundingBox()).height >= 200);
    await shot(page, `recording-${width}`);
    await page.close();
  }
});

test("every control has a name and can be reached by keyboard; colours have the contrast of AA", async ({ open }) => {
  for (const colorScheme of ["light", "dark"]) {
    const page = await open({ colorScheme });
    await ready(page);
    const nameless = await page.evaluate(() => [...document.querySelectorAll("button, select, input")].filter((element) => {
      const label = element.getAttribute("aria-label") ?? element.closest("label")?.textContent ?? element.textContent;
      return (label ?? "").trim() === "";
    }).map((element) => element.outerHTML.slice(0, 120)));
    assert.deepEqual(nameless, []);
    const poor = await page.evaluate(() => {
      const style = getComputedStyle(document.documentElement);
      const luminance = (name) => {
        const hex = style.getPropertyValue(`--${name}`).trim();
        const [r, g, b] = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
      };
      const pairs = [["text", "panel"], ["text", "raised"], ["text", "ground"], ["muted", "panel"], ["muted", "raised"], ["muted", "ground"], ["force", "panel"], ["bad", "panel"], ["warn", "panel"], ["accent-text", "accent"], ["x", "panel"], ["y", "panel"], ["z", "panel"], ["second", "panel"]];
      return pairs.map(([a, b]) => {
        const [one, two] = [luminance(a), luminance(b)].sort((p, q) => q - p);
        return [`${a} on ${b}`, (one + 0.05) / (two + 0.05)];
      }).filter(([, ratio]) => ratio < 4.5);
    });
    assert.deepEqual(poor, [], colorScheme);
    const reached = new Set();
    for (let k = 0; k < 60; k++) {
      await page.keyboard.press("Tab");
      reached.add(await page.evaluate(() => document.activeElement?.id ?? ""));
    }
    for (const id of ["look-toggle", "sound", "theme", "help-open", "view", "fit", "colour-by", "take", "event-filter", "pause", "reset", "record", "snapshot", "save-picture", "save-net", "save-step"]) {
      assert.ok(reached.has(id), `${id} is not reached by Tab (${[...reached]})`);
    }
    await page.close();
  }
});

test("colours, layers and cut change the picture; the legend has its unit", async ({ open }) => {
  const page = await open();
  await ready(page);
  await drag(page, [-190, 0], 12);
  await sleep(300);
  for (const [what, unit] of [["indentation", "mm"], ["curvature", "1/m"], ["displacement", "mm"]]) {
    await page.selectOption("#colour-by", what);
    await until(page, `document.getElementById("legend").innerText.includes(${JSON.stringify(unit)})`, `${what} in ${unit}`);
  }
  await page.mouse.up();
  await until(page, () => window.palpate.report().hand === "free", "the tool given back");
  let before = await pixels(page);
  await page.check("[data-layer=net]");
  await untilChanged(page, before, 50, "the control net");
  before = await pixels(page);
  await page.selectOption("#clip", "x");
  await untilChanged(page, before, 100, "the cut");
  await shot(page, "cut");
});

test("a picture and a net are saved", async ({ open }) => {
  const page = await open();
  await ready(page);
  const [picture] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("p")]);
  assert.match(picture.suggestedFilename(), /^mock-\d{7}\.png$/);
  const [net] = await Promise.all([page.waitForEvent("download"), page.click("#save-net")]);
  assert.ok(readFileSync(await net.path(), "utf8").includes("\no drop\n"));
  const [exact] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("e")]);
  assert.match(exact.suggestedFilename(), /^mock-\d{7}\.step$/);
  assert.match(readFileSync(await exact.path(), "utf8"), /B_SPLINE_SURFACE_WITH_KNOTS\('drop'/);
});

test("cells inside bodies are shown where they are, and materials are told apart", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  await sleep(400);
  let before = await pixels(page);
  assert.ok(!mock.said.some(([key]) => key === "inside"), "nodes were asked for and nobody looks");
  await page.check("[data-layer=lattice]");
  await until(page, () => window.palpate.report().bodies[0].nodes === 12, "the nodes");
  await untilChanged(page, before, 60, "the cells");
  await shot(page, "cells");
  await page.uncheck("[data-layer=lattice]");
  await untilSaid(mock, "inside", 2);
  assert.deepEqual(mock.said.filter(([key]) => key === "inside").map(([, payload]) => payload[0]), [1, 0]);
  before = await pixels(page);
  await page.selectOption("#colour-by", "stiffness");
  await until(page, () => document.getElementById("legend").innerText.includes("Young's modulus, kPa"), "the legend");
  await untilChanged(page, before, 60, "the materials");
  await until(page, () => window.palpate.report().extents[0][0].join() === "3000,30000", "both materials");
  await shot(page, "stiffness");
});

test("a loop that is open to the network is marked, and the mark says what that means", async ({ open, mock }) => {
  let page = await open();
  await ready(page);
  assert.ok(await page.locator("#open-network").isHidden());
  mock.open = ["tcp/0.0.0.0:7447"];
  for (const width of [1280, 390, 320]) {
    await page.close();
    page = await open({ viewport: { width, height: 700 } });
    await ready(page);
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= width);
    await page.click("#open-network");
    await until(page, () => document.getElementById("notices").textContent.includes("Everybody who reaches tcp/0.0.0.0:7447"), "the words");
    if (width === 390) await shot(page, "open-network");
  }
});

test("sound: a tone by the force, silent without one and when the daemon is gone", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  await page.click("#sound");
  const gain = () => page.evaluate(() => window.palpate.sound.volume.gain.value);
  await sleep(300);
  assert.ok((await gain()) < 0.01, "a tone without a force");
  await drag(page, [-190, 0], 12);
  await until(page, () => window.palpate.sound.volume.gain.value > 0.04 && window.palpate.sound.tone.frequency.value > 130, "a tone");
  await mock.stop();
  await until(page, () => window.palpate.report().link === "lost" && window.palpate.sound.volume.gain.value < 0.01, "silence");
  await page.mouse.up();
}, { console: /WebSocket|ERR_CONNECTION|Failed to load/ });

test("forces that did not reach their device are marked, with their causes, and nothing is where none are missing", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  const item = page.locator("#status [data-item=forces]");
  await until(page, () => document.querySelector("#status [data-item=late]").textContent !== "", "the status");
  assert.ok(!(await item.isVisible()));
  const status = statusOf(mock.tick, ["ball"]);
  mock.status = () => ({ ...status, tools: [{ ...status.tools[0], forces_sent: 6149n, forces_overtaken: 12n, forces_lost: 3n }] });
  await item.waitFor({ state: "visible" });
  assert.equal(await item.innerText(), "15 forces lost");
  assert.ok(await item.evaluate((element) => element.classList.contains("warn")));
  assert.match(await item.getAttribute("title"), /^ball: 12 were not sent.*3 of 6149 sent were lost on the way$/);
  await shot(page, "forces-lost");
});

test("a daemon that stands still is not called live, and is again when it goes on", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  await until(page, () => document.getElementById("link").textContent === "Live", "live");
  clearInterval(mock.statusTimer);
  await until(page, () => document.getElementById("link").textContent === "No answer", "the silence");
  assert.equal((await report(page)).link, "live");
  mock.statusTimer = setInterval(() => mock.toAll("status", bus.encode(bus.LoopStatus, mock.status())), 100);
  await until(page, () => document.getElementById("link").textContent === "Live", "live again");
});

test("late ticks by the hundred are one line of the log", async ({ open, mock }) => {
  const page = await open();
  await ready(page);
  mock.event({ type: "ToolJoined", tool: "ball" });
  for (let k = 0; k < 300; k++) mock.event({ type: "Overrun", stage: "wake", count: 2n, worst_ns: 2_000_000n });
  await until(page, () => document.getElementById("events").innerText.includes("600 ticks were late"), "the sum");
  assert.equal(await page.locator("#events li").count(), 2);
  await page.selectOption("#event-filter", "tool");
  await until(page, () => document.getElementById("events").innerText.includes("ball is being moved") && document.querySelectorAll("#events li").length === 1, "events of tools alone");
});

test("fingers: one on the tool presses, one beside it turns the view", async ({ browser, mock, watch }) => {
  const context = await browser.newContext({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  const page = watch(await context.newPage());
  await page.goto(mock.url);
  await ready(page);
  await sleep(300);
  const { x, y } = await place(page);
  const session = await context.newCDPSession(page);
  const touch = (type, px, py) => session.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x: px, y: py }] });
  await touch("touchStart", x, y);
  for (let k = 1; k <= 14; k++) {
    await touch("touchMove", x - 7 * k, y);
    await sleep(20);
  }
  await until(page, () => Math.hypot(...window.palpate.report().tools[0].force) > 0.5, "a force");
  await touch("touchEnd");
  const before = await page.evaluate(() => window.palpate.stage.camera.position.toArray());
  await touch("touchStart", 60, 150);
  for (let k = 1; k <= 8; k++) {
    await touch("touchMove", 60 + 12 * k, 150);
    await sleep(20);
  }
  await touch("touchEnd");
  await until(page, `Math.hypot(...window.palpate.stage.camera.position.toArray().map((v, c) => v - ${JSON.stringify(before)}[c])) > 0.01`, "the view turns");
  await context.close();
});

// ---- Recordings, against the mock's files.

function serve(mock, files) {
  mock.mode = "view";
  mock.token = null;
  mock.recordings = files.map(([name, bytes, more = {}], k) => {
    mock.files.set(`/recordings/${k}`, bytes);
    return { name, url: `/recordings/${k}`, bytes: bytes.length, ...more };
  });
}

const played = (page) => until(page, () => window.palpate?.report().playback?.overview && window.palpate.report().bodies.length > 0, "a recording");

test("a recording: timeline, events, seek, play and stop at the end", async ({ open, mock }) => {
  serve(mock, [["tap.mcap", golden("teardrop-tap.mcap")]]);
  const page = await open();
  await played(page);
  const seeks = [];
  const { last } = (await report(page)).playback;
  for (const tick of [600, 40, 350, last - 1]) {
    await page.evaluate((to) => {
      const slider = document.getElementById("timeline");
      slider.value = to;
      slider.dispatchEvent(new Event("input"));
    }, tick);
    await until(page, `window.palpate.report().tick === ${tick}`, `tick ${tick}`);
    seeks.push((await report(page)).playback.seekMs);
  }
  console.log(`    seeks: ${seeks.map((ms) => ms.toFixed(0)).join(", ")} ms, bar 300 ms`);
  await page.evaluate(() => window.palpate.playbackDeck.go(500));
  await page.keyboard.press(" ");
  await until(page, () => window.palpate.report().playback.tick > 520, "playing");
  await until(page, `!window.palpate.report().playback.playing && window.palpate.report().tick === ${last}`, "the end");
  await page.keyboard.press(",");
  await until(page, `window.palpate.report().tick === ${last - 1}`, "a tick back");
  await page.keyboard.press("Home");
  await until(page, () => window.palpate.report().tick === 1, "the beginning");
  assert.ok((await page.locator("#events li").count()) >= 2);
  await shot(page, "recording");
});

test("charts: the pointer shows the values of its time in all of them; several tools are drawn together", async ({ open, mock }) => {
  serve(mock, [["tap.mcap", golden("teardrop-tap.mcap")]]);
  const page = await open();
  await played(page);
  await sleep(300);
  const over = await page.locator("[data-chart=force] .u-over").boundingBox();
  const at = async (share) => {
    await page.mouse.move(over.x + share * over.width, over.y + over.height / 2);
    await sleep(200);
    return Promise.all(["[data-chart=force] [data-line=size]", "[data-chart=depth] [data-line=depth]"].map(async (line) => Number((await text(page, line)).split(" ").at(-1))));
  };
  const [before, pressed] = [await at(0.05), await at(0.4)];
  assert.deepEqual(before, [0, 0]);
  assert.ok(pressed.every((value) => value > 0), `${pressed}`);
  mock.mode = "live";
  mock.token = "secret";
  mock.scene = snapshotOf([bodyOf("drop")], [toolOf("ball"), toolOf("pen", [0.05, 0.02, 0.03]), toolOf("pin", [0.05, -0.02, 0.03])]);
  await page.goto(mock.url);
  await ready(page);
  await page.click("#tools button:nth-of-type(1)");
  await page.click("#tools button:nth-of-type(3)", { modifiers: ["Control"] });
  await until(page, () => [...document.querySelectorAll("[data-chart=force] [data-line]")].map((line) => line.dataset.line).join() === "ball,pin", "both lines");
});

test("a click on a chart goes there", async ({ open, mock }) => {
  serve(mock, [["tap.mcap", golden("teardrop-tap.mcap")]]);
  const page = await open();
  await played(page);
  await until(page, () => document.querySelector("[data-chart=force] .u-over") !== null, "the chart");
  await sleep(300);
  const over = page.locator("[data-chart=force] .u-over");
  const box = await over.boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  const { last } = (await report(page)).playback;
  await until(page, `Math.abs(window.palpate.report().tick - ${last / 2}) < 12`, "the middle");
});

test("a recording that was cut off is shown, and it is said", async ({ open, mock }) => {
  const bytes = golden("teardrop-tap.mcap");
  serve(mock, [["cut.mcap.part", bytes.subarray(0, 250_000)]]);
  const page = await open();
  await played(page);
  assert.ok((await text(page, "#notices")).includes("cut off"));
  assert.ok((await report(page)).playback.last >= 200);
});

test("a file that is no recording says so", async ({ open, mock }) => {
  serve(mock, [["a.mcap", Buffer.from("this is no recording at all")]]);
  const page = await open();
  await until(page, () => document.getElementById("empty").textContent.includes("not an MCAP"), "the reason");
});

test("two recordings side by side: one timeline, differences in colour, other builds named", async ({ open, mock }) => {
  const [one, other] = [golden("teardrop-tap.mcap"), Buffer.from(golden("teardrop-tap.mcap"))];
  const at = other.indexOf("palpate 0.1.0 source");
  other.write("palpate 0.0.9", at);
  serve(mock, [["original", one], ["replay", other, { against: true }]]);
  const page = await open();
  await until(page, () => document.getElementById("notices").textContent.includes("different builds"), "the builds");
  await played(page);
  await page.evaluate(() => window.palpate.playbackDeck.go(300));
  await until(page, () => window.palpate.report().tick === 300 && window.palpate.report().playback.second === 300, "both at 300");
  // The same session: no difference at all.
  await until(page, () => {
    const { extents } = window.palpate.report();
    return extents.length === 2 && extents.every(([body]) => body?.[0] === 0 && body[1] === 0);
  }, "no difference");
  assert.ok((await text(page, "#legend")).includes("Difference"));
  assert.ok((await text(page, "#labels")).includes("replay"));
  await shot(page, "side-by-side");
});

test("a directory of recordings: each can be chosen", async ({ open, mock }) => {
  serve(mock, [["tap.mcap", golden("teardrop-tap.mcap")], ["press.mcap", golden("rigid-teardrop-press.mcap")]]);
  const page = await open();
  await played(page);
  const { last } = (await report(page)).playback;
  await page.selectOption("#instances select", { index: 1 });
  await until(page, `![undefined, ${last}].includes(window.palpate.report().playback?.last) && window.palpate.report().bodies.length > 0`, "the other recording");
});

test("a file dropped on the page is opened", async ({ open }) => {
  const page = await open();
  await ready(page);
  const bytes = withoutScene(golden("teardrop-tap.mcap")).toString("base64");
  const transfer = await page.evaluateHandle((base64) => {
    const data = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const transfer = new DataTransfer();
    transfer.items.add(new File([data], "dropped.mcap"));
    return transfer;
  }, bytes);
  await page.dispatchEvent("body", "drop", { dataTransfer: transfer });
  await played(page);
  assert.equal((await report(page)).link, "playing");
  assert.ok((await text(page, "#notices")).includes("uniform"));
});

test("one page from disk: a recording inside it plays without a server", async ({ browser, watch, directory }) => {
  const page = watch(await browser.newPage());
  const read = (name) => readFileSync(join(repository, "src/viewer/page", name), "utf8");
  const recording = golden("teardrop-tap.mcap").toString("base64");
  const html = read("index.html")
    .replace('<link rel="stylesheet" href="app.css">', () => `<style>${read("app.css")}</style>`)
    .replace('<script src="app.js" defer></script>', () => `<script id="palpate-recording" type="application/octet-stream" data-name="tap.mcap">${recording}</script><script>${read("app.js")}</script>`);
  const path = join(directory, "tap.html");
  writeFileSync(path, html);
  await page.goto(`file://${path}`);
  await played(page);
  console.log(`    ${(html.length / 1e6).toFixed(2)} MB with a recording of 0.35 MB`);
  assert.ok(html.length - recording.length < 3e6);
});

// ---- Against the real daemon.

const palpate = process.env.PALPATE;

/** A daemon on ports that the system chooses, with the page of the sources. */
async function daemon(args, directory) {
  const own = args[0] === "serve" ? ["--no-rt", "--listen", "tcp/127.0.0.1:0", "--record-dir", directory] : ["--no-open"];
  const child = spawn(palpate, [...args, ...own, "--http", "127.0.0.1:0"], {
    stdio: ["ignore", "pipe", "pipe"], env: { ...process.env, PALPATE_PAGE_DIR: join(repository, "src/viewer/page") },
  });
  let log = "";
  for (const stream of [child.stdout, child.stderr]) stream.on("data", (data) => (log += data));
  let url;
  for (let k = 0; url === undefined; k++) {
    url = /page: (http:\S+)/.exec(log)?.[1];
    if (url !== undefined && (await fetch(url).then((answer) => answer.ok, () => false))) break;
    url = undefined;
    if (k > 300 || child.exitCode !== null) throw new Error(`the daemon did not start:\n${log}`);
    await sleep(100);
  }
  return { url, child, log: () => log, stop: () => new Promise((resolve) => { child.once("exit", resolve); child.kill("SIGINT"); }) };
}

if (palpate !== undefined) {
  test("real: a drag presses the teardrop; its recording replays bit for bit and shows the same net", async ({ browser, watch, directory }) => {
    const running = await daemon(["serve", join(repository, "scenes/rigid-teardrop.toml")], directory);
    try {
      const page = watch(await browser.newPage({ viewport: { width: 1280, height: 800 } }));
      await page.goto(running.url);
      await ready(page);
      await page.click("#record");
      await until(page, () => document.getElementById("record").classList.contains("recording"), "recording");
      await drag(page, [-(await pixelsOf(page, 0.04)), 0], 40);
      await until(page, () => Math.hypot(...window.palpate.report().tools[0].force) > 0.3, "a force");
      const { poseAgeMs } = (await report(page)).tools[0];
      console.log(`    pose to force: ${poseAgeMs.toFixed(1)} ms`);
      await shot(page, "real-press");
      await page.mouse.up();
      await until(page, () => window.palpate.report().hand === "free", "the tool given back");
      await page.click("#record");
      await until(page, () => document.getElementById("notices").textContent.includes("Recorded"), "the file");
    } finally {
      await running.stop();
    }
    const [file] = readdirSync(directory).filter((name) => name.endsWith(".mcap"));
    const path = join(directory, file);
    execFileSync(palpate, ["replay", path], { stdio: "pipe" });
    console.log(`    ${file} replays bit for bit`);
  });

  // A laptop without graphics card, a virtual machine, a remote desktop: pictures take as long as a pose lasts.
  test("real: a hand in a browser that is six times slower keeps its force, and the log is quiet", async ({ browser, watch, directory }) => {
    const running = await daemon(["serve", join(repository, "scenes/rigid-teardrop.toml")], directory);
    const heard = { forces: [], events: [], late: 0 };
    const ear = new WebSocket(`${running.url.replace("http", "ws")}live`);
    ear.on("message", (data) => {
      const { key, payload } = openFrame(new Uint8Array(data));
      if (key === "tool/ball/force") heard.forces.push(Math.hypot(...bus.decode(bus.ToolForce, payload).force));
      if (key === "event") heard.events.push(bus.decode(bus.SimEvent, payload).kind.type);
      // How long the daemon itself got no processor.
      if (key === "status") heard.late = Math.max(heard.late, Number(bus.decode(bus.LoopStatus, payload).period.max_ns) * 1e-6);
    });
    try {
      const page = watch(await browser.newPage({ viewport: { width: 1280, height: 800 } }));
      await page.goto(running.url);
      await ready(page);
      await drag(page, [-(await pixelsOf(page, 0.042)), 0], 40);
      await until(page, () => Math.hypot(...window.palpate.report().tools[0].force) > 0.3, "a force");
      await sleep(500);
      // How long the page says nothing.
      await page.evaluate(() => {
        const { live } = window.palpate;
        const send = live.pose.bind(live);
        window.silences = [];
        let last = performance.now();
        live.pose = (tool, pose) => {
          window.silences.push(performance.now() - last);
          last = performance.now();
          send(tool, pose);
        };
      });
      const listen = async (ms, meanwhile) => {
        await page.evaluate(() => (window.silences.length = 0));
        [heard.forces, heard.events, heard.late] = [[], [], 0];
        const end = Date.now() + ms;
        while (Date.now() < end) await meanwhile();
        const { forces, events, late } = heard;
        const silences = await page.evaluate(() => [...window.silences]);
        const longest = silences.length === 0 ? ms : Math.max(...silences);
        const least = Math.min(...forces), most = Math.max(...forces);
        const lost = events.filter((type) => type === "ToolLost").length;
        console.log(`    ${forces.length} forces, ${least.toFixed(3)} to ${most.toFixed(3)} N, ${forces.filter((force) => force < 1e-3).length} of none; lost ${lost} times; `
          + `silent for up to ${longest.toFixed(0)} ms, over 50 ms ${silences.filter((ms) => ms > 50).length} times; daemon late by up to ${late.toFixed(0)} ms`);
        if (forces.length > 20 && lost === 0 && least > 0.3 && most < 1.02 * least) return true;
        // A page that is silent for half a second has lost its hand, and a daemon without a processor repeats nothing:
        // on a computer that others use as well that is no fault.
        assert.ok(longest > 400 || late > 15, `lost ${lost} times, from ${least} to ${most} N`);
        return false;
      };
      const cdp = await page.context().newCDPSession(page);
      await cdp.send("Emulation.setCPUThrottlingRate", { rate: 6 });
      // A hand at rest: the view turns, so that there is always a picture to draw.
      const turning = async () => {
        await page.evaluate(() => window.palpate.stage.orbit(0.02, 0));
        await sleep(20);
      };
      const steady = async (ms, meanwhile) => {
        for (let k = 0; k < TRIES; k++) {
          // A hand that was lost before comes back first.
          for (let k = 0; k < 100 && !(heard.forces.at(-1) > 0.3); k++) await sleep(50);
          if (await listen(ms, meanwhile)) return;
        }
        console.log("    skipped: this computer is too busy");
      };
      await steady(5000, turning);
      await cdp.send("Emulation.setCPUThrottlingRate", { rate: 1 });
      const busy = async () => {
        await page.evaluate(() => { for (const end = performance.now() + 250; performance.now() < end;); });
        await sleep(50);
      };
      await steady(2000, busy);
      await shot(page, "slow");
      await page.mouse.up();
      await until(page, () => window.palpate.report().hand === "free", "the tool given back");
    } finally {
      ear.close();
      await running.stop();
    }
  });

  test("real: a scene at rest is not drawn again, however many messages come", async ({ browser, watch, directory }) => {
    const running = await daemon(["serve", join(repository, "scenes/rigid-teardrop.toml")], directory);
    try {
      const page = watch(await browser.newPage({ viewport: { width: 1280, height: 800 } }));
      await page.goto(running.url);
      await ready(page);
      const drawn = () => page.evaluate(() => [window.palpate.stage.renderer.info.render.frame, window.palpate.world.version]);
      const deadline = Date.now() + PATIENCE_MS;
      for (let before = await drawn(); ; ) {
        await sleep(1500);
        const now = await drawn();
        if (now[0] === before[0] && now[1] >= before[1] + 10) break;
        assert.ok(Date.now() < deadline, `${now[0] - before[0]} pictures for ${now[1] - before[1]} messages`);
        before = now;
      }
      await page.keyboard.press("t");
      const still = (await drawn())[0];
      await until(page, `window.palpate.stage.renderer.info.render.frame > ${still}`, "a picture of the tool that is held");
    } finally {
      await running.stop();
    }
  });

  test("real: of two pages that drag one tool the second is refused, and told who holds it", async ({ browser, watch, directory }) => {
    const running = await daemon(["serve", join(repository, "scenes/rigid-teardrop.toml")], directory);
    try {
      const pages = [];
      for (let k = 0; k < 2; k++) {
        const page = watch(await browser.newPage({ viewport: { width: 1280, height: 800 } }));
        await page.goto(running.url);
        await ready(page);
        pages.push(page);
      }
      const [first, second] = pages;
      await first.keyboard.press("t");
      const holder = await until(first, () => window.palpate.report().tools[0].holder, "the tool");
      await second.keyboard.press("t");
      await until(second, `document.getElementById("notices").textContent.includes(${JSON.stringify(holder)})`, "the refusal");
      assert.equal((await report(second)).hand, "free");
      await first.keyboard.press("Escape");
      await until(first, () => window.palpate.report().hand === "free", "the tool given back");
      await until(second, () => window.palpate.report().tools[0].holder === null, "nobody holds it");
      await second.keyboard.press("t");
      await until(second, () => window.palpate.report().tools[0].holder !== null && window.palpate.report().hand === "holding", "the second has it");
    } finally {
      await running.stop();
    }
  });

  test("real: in lockstep a page's pose drives the loop at the speed that is chosen on it", async ({ browser, watch, directory }) => {
    const running = await daemon(["serve", join(repository, "scenes/rigid-teardrop.toml"), "--clock", "lockstep"], directory);
    try {
      const page = watch(await browser.newPage({ viewport: { width: 1280, height: 800 } }));
      await page.goto(running.url);
      await ready(page);
      await until(page, () => !document.getElementById("speed").hidden, "the choice of a speed");
      await page.keyboard.press("t");
      await until(page, () => window.palpate.report().hand === "holding", "the tool");
      const rates = [];
      for (const speed of ["0.05", "0.25"]) {
        await page.selectOption("#speed", speed);
        await page.evaluate(() => document.activeElement?.blur());
        await sleep(500);
        const [from, begun] = await page.evaluate(() => [window.palpate.report().tick, performance.now()]);
        await sleep(1500);
        const [to, ended] = await page.evaluate(() => [window.palpate.report().tick, performance.now()]);
        rates.push((to - from) / (ended - begun));
      }
      console.log(`    simulated over real time: ${rates.map((rate) => rate.toFixed(3)).join(" for 0.05, ")} for 0.25`);
      assert.ok(rates[0] > 0 && rates[1] > 2 * rates[0], `${rates}`);
    } finally {
      await running.stop();
    }
  });

  test("real: a recording that is played is shown, and its tools cannot be taken", async ({ browser, watch, directory }) => {
    const running = await daemon(["play", join(repository, "recordings/golden/rigid-teardrop-press.mcap"), "--loop", "--listen", "tcp/127.0.0.1:0"], directory);
    try {
      const page = watch(await browser.newPage({ viewport: { width: 1280, height: 800 } }));
      await page.goto(running.url);
      await ready(page);
      await until(page, () => Math.hypot(...window.palpate.report().tools[0].force) > 0.02, "a force of the recording");
      await page.keyboard.press("t");
      await until(page, () => document.getElementById("notices").textContent.includes("move by themselves"), "why not");
      assert.equal((await report(page)).hand, "free");
    } finally {
      await running.stop();
    }
  });

  test("real: the page lists the scenes on the bus, and goes to another", async ({ browser, watch, directory }) => {
    const first = await daemon(["serve", join(repository, "scenes/rigid-teardrop.toml"), "--instance", "one"], directory);
    const endpoint = await until({ evaluate: async () => /listen="?(tcp\/[^\s",]+)/.exec(first.log())?.[1] }, null, "where the first listens").catch(() => null);
    const second = await daemon(["serve", join(repository, "scenes/sheet.toml"), "--instance", "two", "--connect", endpoint ?? "tcp/127.0.0.1:1"], directory);
    let third;
    try {
      assert.ok(endpoint !== null, first.log());
      const page = watch(await browser.newPage({ viewport: { width: 1280, height: 800 } }));
      await page.goto(second.url);
      await ready(page);
      const listed = (names) => until(page, `[...document.querySelectorAll("#instances option:not(:disabled)")].map(({ value }) => value).join() === "${names}" && !document.getElementById("instances").hidden`, names);
      await listed("one,two");
      await page.selectOption("#instances select", "one");
      await page.waitForURL(first.url);
      await until(page, () => window.palpate?.report().scene === "rigid-teardrop", "the other scene");
      // One that comes later is listed without a reload.
      third = await daemon(["serve", join(repository, "scenes/rigid-teardrop.toml"), "--instance", "zwei", "--connect", endpoint], directory);
      await listed("one,two,zwei");
    } finally {
      await third?.stop();
      await second.stop();
      await first.stop();
    }
  });

  test("real: a mouse's own tool presses; cells inside follow; the STEP file has the points of the picture", async ({ browser, watch, directory }) => {
    const running = await daemon(["serve", join(repository, "scenes/teardrop.toml"), "--mouse-tool"], directory);
    try {
      const page = watch(await browser.newPage({ viewport: { width: 1280, height: 800 } }));
      await page.goto(running.url);
      await ready(page);
      const mouse = await page.evaluate(() => window.palpate.report().tools.findIndex(({ id }) => id === "mouse"));
      assert.ok(mouse >= 0, "there is no tool of the mouse");
      await page.check("[data-layer=lattice]");
      await until(page, () => window.palpate.report().bodies[0].nodes > 100, "the nodes");
      await page.selectOption("#colour-by", "stiffness");
      await page.selectOption("#colour-by", "displacement");
      await page.evaluate(() => window.palpate.take("mouse"));
      await until(page, () => window.palpate.report().hand === "holding", "the tool");
      // Beside the drop, down, and into its side: from its tip a ball slides off.
      const [x, y, z] = (await report(page)).tools[mouse].proxy;
      for (const [by, steps] of [[[0.06 - x, -y, 0], 15], [[0, 0, 0.045 - z], 15], [[-0.04, 0, 0], 20]]) {
        for (let k = 0; k < steps; k++) {
          await page.evaluate((step) => window.palpate.hand.move(step), by.map((c) => c / steps));
          await sleep(16);
        }
      }
      await until(page, `Math.hypot(...window.palpate.report().tools[${mouse}].force) > 0.05`, "a force");
      await shot(page, "real-cells");
      // Control points of a lattice are nodes: each is one of those that are drawn inside. Nodes come just before
      // the net of their tick: between the two they are of another.
      const measure = () => page.evaluate(() => {
        const { nodes, points } = window.palpate.inside("drop");
        let worst = 0;
        for (let k = 0; k < points.length; k += 3) {
          let least = Infinity;
          for (let n = 0; n < nodes.length; n += 3) least = Math.min(least, Math.hypot(nodes[n] - points[k], nodes[n + 1] - points[k + 1], nodes[n + 2] - points[k + 2]));
          worst = Math.max(worst, least);
        }
        return worst;
      });
      let apart = await measure();
      for (let k = 0; k < 40 && apart >= 2e-4; k++) {
        await sleep(25);
        apart = await measure();
      }
      console.log(`    control points are within ${(apart * 1e6).toFixed(2)} µm of nodes`);
      assert.ok(apart < 2e-4, `${apart} m`);
      await page.keyboard.press("Escape");
      await until(page, () => window.palpate.report().hand === "free", "the tool given back");
      await page.click("#pause");
      await until(page, () => document.getElementById("link").textContent === "Paused", "pause");
      await sleep(300);
      const [file] = await Promise.all([page.waitForEvent("download"), page.click("#save-step")]);
      const [step, json] = [join(directory, "drop.step"), join(directory, "drop.json")];
      await file.saveAs(step);
      execFileSync(palpate, ["surface", "convert", step, json], { stdio: "pipe" });
      const read = JSON.parse(readFileSync(json, "utf8")).points.flat(2);
      const drawn = await page.evaluate(() => window.palpate.net("drop"));
      assert.equal(read.length, drawn.length);
      assert.ok(read.every((x, k) => x === drawn[k]), "the file has other points than the picture");
      if (process.env.EVENTS) console.log(await page.locator("#events").innerText());
      console.log(`    ${read.length / 3} control points of the STEP file are those of the picture to the last bit`);
    } finally {
      await running.stop();
    }
  });

  test("real: the net at a tick of the timeline is that of `palpate export --net`", async ({ browser, watch, directory }) => {
    const recording = join(directory, "small.mcap");
    const inputs = join(repository, "recordings/golden/small-lattice-press.inputs.mcap");
    execFileSync(palpate, ["replay", inputs, "--record", recording], { stdio: "pipe" });
    const running = await daemon(["view", recording], directory);
    try {
      const page = watch(await browser.newPage({ viewport: { width: 1280, height: 800 } }));
      await page.goto(running.url);
      await played(page);
      const info = await report(page);
      const body = info.bodies[0].id;
      assert.equal(info.bodies[0].assumed, false, "the knots came with the recording");
      let compared = 0;
      for (const share of [0.3, 0.55, 0.9]) {
        const tick = Math.round(share * info.playback.last);
        await page.evaluate((to) => window.palpate.playbackDeck.go(to), tick);
        await until(page, `window.palpate.report().tick === ${tick}`, `tick ${tick}`);
        // Nets are recorded 30 times a second: the one shown is compared at its own tick.
        const { netTick } = (await report(page)).bodies[0];
        const out = join(directory, `net-${netTick}.json`);
        execFileSync(palpate, ["export", recording, "--net", body, "--tick", String(netTick), out], { stdio: "pipe" });
        const exported = JSON.parse(readFileSync(out, "utf8")).points.flat(2);
        const drawn = await page.evaluate((id) => window.palpate.net(id), body);
        assert.equal(drawn.length, exported.length);
        assert.ok(drawn.every((x, k) => x === exported[k]), `tick ${netTick}`);
        compared += 1;
      }
      console.log(`    ${compared} nets are equal to the last bit`);
    } finally {
      await running.stop();
    }
  });

  test("real: one page from `palpate view --html` opens from disk", async ({ browser, watch, directory }) => {
    const out = join(directory, "out.html");
    execFileSync(palpate, ["view", "--html", out, join(repository, "recordings/golden/teardrop-tap.mcap")], {
      stdio: "pipe", env: { ...process.env, PALPATE_PAGE_DIR: join(repository, "src/viewer/page") },
    });
    const page = watch(await browser.newPage({ viewport: { width: 1280, height: 800 } }));
    await page.goto(`file://${out}`);
    await played(page);
    assert.equal((await report(page)).bodies[0].assumed, false);
    await page.evaluate(() => window.palpate.playbackDeck.go(240));
    await until(page, () => window.palpate.report().tick === 240, "tick 240");
    await shot(page, "html");
  });
}

// ---- The runner.

// Pictures for the README, where they are asked for.
if (process.env.PALPATE_PICTURES !== undefined && palpate !== undefined) {
  const directory = process.env.PALPATE_PICTURES;
  mkdirSync(directory, { recursive: true });
  test("pictures for the README", async ({ browser, watch, directory: recordings }) => {
    const running = await daemon(["serve", join(repository, "scenes/teardrop.toml")], recordings);
    try {
      for (const colorScheme of ["light", "dark"]) {
        const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme });
        const page = watch(await context.newPage());
        await page.goto(running.url);
        await ready(page);
        await page.evaluate(() => (window.palpate.stage.mayBeCoarse = false));
        await sleep(600);
        await drag(page, [-(await pixelsOf(page, 0.04)), 0], 40);
        await until(page, () => Math.hypot(...window.palpate.report().tools[0].force) > 0.3, "a force");
        await page.evaluate(() => window.palpate.look.toggle(false));
        await sleep(900);
        await page.screenshot({ path: join(directory, `live-${colorScheme}.png`) });
        await page.mouse.up();
        await until(page, () => window.palpate.report().hand === "free", "the tool given back");
        await page.keyboard.press("Backspace");
        await sleep(500);
        await context.close();
      }
      const context = await browser.newContext({ viewport: { width: 480, height: 640 }, colorScheme: "dark" });
      const page = watch(await context.newPage());
      await page.goto(running.url);
      await ready(page);
      await page.evaluate(() => {
        window.palpate.look.toggle(false);
        window.palpate.stage.mayBeCoarse = false;
      });
      await sleep(600);
      const from = await place(page);
      const far = await pixelsOf(page, 0.042);
      const clip = { x: 0, y: 0, width: 480, height: 500 };
      await page.mouse.move(from.x, from.y);
      await page.mouse.down();
      for (let k = 0; k < 36; k++) {
        // There, deeper, and back.
        const share = Math.sin((Math.PI * Math.min(k, 33)) / 33);
        await page.mouse.move(from.x - far * share, from.y);
        await sleep(60);
        await page.screenshot({ path: join(directory, `press-${String(k).padStart(3, "0")}.png`), clip });
      }
      await page.mouse.up();
      await context.close();
    } finally {
      await running.stop();
    }
    const viewing = await daemon(["view", join(repository, "recordings/golden/teardrop-tap.mcap")], recordings);
    try {
      const page = watch(await browser.newPage({ viewport: { width: 1280, height: 800 } }));
      await page.goto(viewing.url);
      await played(page);
      await page.evaluate(() => window.palpate.playbackDeck.go(240));
      await until(page, () => window.palpate.report().tick === 240, "tick 240");
      await sleep(600);
      await page.screenshot({ path: join(directory, "view.png") });
      // The same, tick by tick: frames that do not depend on how busy this computer is.
      const small = watch(await browser.newPage({ viewport: { width: 480, height: 640 }, colorScheme: "dark" }));
      await small.goto(viewing.url);
      await played(small);
      await small.evaluate(() => {
        window.palpate.look.toggle(false);
        window.palpate.stage.mayBeCoarse = false;
        window.palpate.playbackDeck.go(330);
      });
      // One scale for all frames: the largest displacement is near the end.
      await until(small, () => window.palpate.report().tick === 330, "tick 330");
      await sleep(400);
      await small.evaluate(() => window.palpate.settings.set((s) => (s.lockRange = true)));
      for (let k = 0; k < 36; k++) {
        const tick = 150 + 5 * k;
        await small.evaluate((to) => window.palpate.playbackDeck.go(to), tick);
        await until(small, `window.palpate.report().tick === ${tick}`, `tick ${tick}`);
        await sleep(80);
        await small.screenshot({ path: join(directory, `tap-${String(k).padStart(3, "0")}.png`), clip: { x: 0, y: 0, width: 480, height: 400 } });
      }
    } finally {
      await viewing.stop();
    }
  }, { ms: 400_000 });
}

const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
if (!existsSync(executablePath)) {
  console.log(`skipped: no browser at ${executablePath} (set CHROMIUM)`);
  process.exit(0);
}
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", ...GL] });
let failed = 0;
const chosen = tests.filter(({ name }) => wanted.length === 0 || wanted.some((part) => name.toLowerCase().includes(part.toLowerCase())));
for (const { name, run, options } of chosen) {
  const mock = await new Mock().start();
  const directory = mkdtempSync(join(tmpdir(), "palpate-page-"));
  const complaints = [];
  const pages = [];
  const watch = (page) => {
    pages.push(page);
    // No test is about how busy this computer is.
    page.setDefaultTimeout(PATIENCE_MS);
    page.on("console", (message) => {
      if (["error", "warning"].includes(message.type()) && !(options.console?.test(message.text()) ?? false) && !/GPU stall|GroupMarkerNotSet|software WebGL/.test(message.text())) complaints.push(message.text());
    });
    page.on("pageerror", (error) => complaints.push(error.stack ?? error.message));
    return page;
  };
  const open = async ({ viewport = { width: 1280, height: 800 }, colorScheme = "dark", init = null } = {}) => {
    const context = await browser.newContext({ viewport, colorScheme, acceptDownloads: true });
    const page = watch(await context.newPage());
    if (init !== null) await page.addInitScript(init);
    await page.goto(mock.url);
    return page;
  };
  const start = Date.now();
  let timer;
  try {
    await Promise.race([
      run({ open, mock, browser, watch, directory }),
      new Promise((_, reject) => { timer = setTimeout(() => reject(new Error("took too long")), options.ms ?? 400_000); }),
    ]);
    assert.deepEqual(complaints, [], "the console is not silent");
    console.log(`ok   ${name} (${((Date.now() - start) / 1e3).toFixed(1)} s)`);
  } catch (error) {
    failed += 1;
    console.log(`FAIL ${name}\n     ${String(error.stack ?? error).split("\n").slice(0, 7).join("\n     ")}`);
    if (complaints.length > 0) console.log(`     console: ${complaints.slice(0, 3).join(" | ").slice(0, 600)}`);
  } finally {
    clearTimeout(timer);
    for (const page of pages) await page.close().catch(() => {});
    await mock.stop().catch(() => {});
    rmSync(directory, { recursive: true, force: true });
  }
}
await browser.close();
console.log(`${chosen.length - failed} of ${chosen.length} passed`);
process.exit(failed === 0 ? 0 : 1);
