// What is inside bodies, files of surfaces, and reports that come in hundreds: without a browser.

import assert from "node:assert/strict";
import { test } from "node:test";
import * as page from "../dist/page.js";
import { bodyOf, snapshotOf, twoCells } from "./scenes.mjs";

function worldOf(bodies) {
  const world = new page.World();
  world.load(snapshotOf(bodies));
  return world;
}

test("cells: edges are each there once, materials are those of the nearest cell", () => {
  const [inside] = page.insidesOf([twoCells("drop")]);
  // Twelve nodes of two cells on each other: 3 squares of 4 edges, 2 times 4 posts.
  assert.equal(page.edgesOf(inside).length / 2, 20);
  const young = page.youngAt(inside, [0, 0, 0.01, 0, 0, 0.11, 0.02, 0.02, 0.09], [0, 0, 0]);
  assert.deepEqual([...young], [3000, 30000, 30000]);
  assert.deepEqual([...page.youngAt(inside, [0, 0, -0.04, 0, 0, 0.06], [0, 0, 0.05])], [3000, 30000]);
  const nodes = page.youngOfNodes(inside);
  assert.deepEqual([nodes[0], nodes[4], nodes[8]], [3000, 16500, 30000]);
});

test("cells that are not whole are left out", () => {
  const whole = twoCells("drop");
  const wrong = [
    null, 3, "cells", {}, { ...whole, id: 7 }, { ...whole, cells: [0, 1] }, { ...whole, cells: whole.cells.map(() => 99) },
    { ...whole, nodes: whole.nodes.map(() => NaN) }, { ...whole, young_pa: [1] }, { ...whole, young_pa: [1, "x"] },
  ];
  assert.equal(page.insidesOf(wrong).length, 0);
  assert.equal(page.insidesOf([...wrong, whole]).length, 1);
  assert.deepEqual(page.insidesOf(null), []);
});

test("numbers of a STEP file have a point and read back to the bit", () => {
  for (const [value, text] of [[0, "0.0"], [-0, "-0.0"], [1, "1.0"], [0.1, "0.1"], [1e-7, "1.E-7"], [-2.5e-5, "-2.5E-5"], [1e16, "1.E16"], [123456789.125, "123456789.125"], [5e-324, "5.E-324"]]) {
    assert.equal(page.real(value), text);
  }
  let word = 12345n;
  const view = new DataView(new ArrayBuffer(8));
  for (let k = 0; k < 20_000; k++) {
    word = (word * 6364136223846793005n + 1442695040888963407n) & 0xffffffffffffffffn;
    view.setBigUint64(0, word);
    const value = view.getFloat64(0);
    if (!Number.isFinite(value)) continue;
    const text = page.real(value);
    assert.match(text, /^-?\d+\.\d*(E-?\d+)?$/);
    assert.equal(Number(text), value);
  }
});

test("a STEP file has a surface for each body, with the points of periodic directions repeated", () => {
  const bodies = [bodyOf("drop"), bodyOf("quo'te")];
  const text = page.stepOf(worldOf(bodies));
  const points = text.match(/=CARTESIAN_POINT/g).length - 1;
  const rows = (body, side) => body.count[side] + (body.periodic[side] ? body.degree[side] : 0);
  assert.equal(points, bodies.reduce((sum, body) => sum + rows(body, 0) * rows(body, 1), 0));
  assert.match(text, /GEOMETRIC_SET\('',\(#22,#23\)\)/);
  assert.match(text, /B_SPLINE_SURFACE_WITH_KNOTS\('quo''te'/);
  // Every instance is there once, and every one that is named is there.
  const given = [...text.matchAll(/^#(\d+)=/gm)].map(([, number]) => Number(number));
  assert.equal(new Set(given).size, given.length);
  for (const [, number] of text.matchAll(/#(\d+)/g)) assert.ok(given.includes(Number(number)), `#${number}`);
});

test("what STEP does not have is said and left out", () => {
  const drop = bodyOf("drop");
  const broken = { ...bodyOf("broken"), points: bodyOf("broken").points.map((x, k) => (k === 5 ? NaN : x)) };
  const world = worldOf([drop, broken]);
  assert.equal(page.stepFault(world.body("drop")), null);
  assert.match(page.stepFault(world.body("broken")), /not a number/);
  assert.ok(!page.stepOf(world).includes("'broken'"));
  assert.equal(page.stepOf(worldOf([broken])), null);
  const parted = { ...drop, id: "parted", degree: [1, 1], periodic: [false, false], count: [4, 2], knots: [Float64Array.of(0, 0, 1, 1, 2, 2), Float64Array.of(0, 0, 1, 1)], points: new Float64Array(24), rest_points: new Float64Array(24) };
  assert.match(page.stepFault(worldOf([parted]).body("parted")), /pieces/);
});

test("a thousand reports of late ticks are one line a cause, and push nothing else out", () => {
  const world = worldOf([bodyOf("drop")]);
  const late = (seq, stage, count, worst) => page.happening({ tick: BigInt(seq * 50), seq: BigInt(seq), t_ns: 0n, kind: { type: "Overrun", stage, count: BigInt(count), worst_ns: BigInt(worst) } });
  const other = (seq) => page.happening({ tick: BigInt(seq * 50), seq: BigInt(seq), t_ns: 0n, kind: { type: "Paused" } });
  world.addEvent(other(0));
  for (let k = 1; k <= 1000; k++) world.addEvent(late(k, k % 2 === 0 ? "wake" : "render", 3, 1000 * k));
  assert.equal(world.events.length, 3);
  const [, render, wake] = world.events;
  assert.match(render.text, /^1500 ticks were late, the worst by 999 µs: contact/);
  assert.match(wake.text, /^1500 ticks were late, the worst by 1\.00 ms: the system/);
  // A daemon tells its last events again to a page that comes back.
  for (let k = 900; k <= 1000; k++) world.addEvent(late(k, k % 2 === 0 ? "wake" : "render", 3, 1000 * k));
  assert.match(world.events[1].text, /^1500 /);
  // What happens in between begins another line.
  world.addEvent(other(1001));
  world.addEvent(late(1002, "wake", 1, 5));
  assert.deepEqual(world.events.map(({ text }) => text.split(" ")[0]), ["Paused", "1500", "1500", "Paused", "1"]);
});

test("a loop that falls behind again and again is one line with its lowest rate, also among late ticks", () => {
  const world = worldOf([bodyOf("drop")]);
  let seq = 0;
  const add = (kind) => world.addEvent(page.happening({ tick: BigInt(++seq), seq: BigInt(seq), t_ns: 0n, kind }));
  const slow = (hz) => add({ type: "Fault", reason: `the loop runs at ${hz} of 1000 Hz: forces fade until it keeps its rate` });
  slow(435);
  assert.match(world.events[0].text, /^Fault: the loop runs at 435 of 1000 Hz/);
  add({ type: "Overrun", stage: "wake", count: 4n, worst_ns: 10n });
  slow(268);
  add({ type: "Overrun", stage: "wake", count: 4n, worst_ns: 20n });
  slow(480);
  assert.equal(world.events.length, 2);
  assert.match(world.events[1].text, /^Fault, 3 times: the loop runs at 268 of 1000 Hz/);
  assert.match(world.events[0].text, /^8 ticks were late/);
  // Another fault is a line of its own.
  add({ type: "Fault", reason: "the contact solver gave no number" });
  assert.equal(world.events.length, 3);
});
