// Forces on the page that stopped coming.

import assert from "node:assert/strict";
import { test } from "node:test";
import * as page from "../dist/page.js";
import { forceOf, snapshotOf } from "./scenes.mjs";

function start() {
  const world = new page.World();
  world.load(snapshotOf());
  const [tool] = world.tools;
  const fading = new page.Fading();
  const size = () => Math.hypot(...tool.force);
  const force = { ...forceOf(1n, [1, 2, 2]), torque: [0.5, 0, 0] };
  return { world, tool, fading, size, force };
}

/** Looks every 10 ms. */
function wait(fading, world, from, until, stands = false) {
  for (let now = from; now <= until; now += 10) fading.look(world, stands, now);
}

test("a force that no other follows is shown for 110 ms, and its torque with it", () => {
  const { world, tool, fading, size, force } = start();
  for (let now = 0; now <= 160; now += 16) fading.take(tool, force, now);
  wait(fading, world, 170, 260);
  assert.equal(size(), 3);
  wait(fading, world, 270, 280);
  assert.deepEqual([size(), tool.torque[0]], [0, 0]);
  // The next one is there at once: nobody's hand is on the picture.
  fading.take(tool, force, 5000);
  assert.equal(size(), 3);
});

test("a page that was busy for a second shows the force on which its messages wait", () => {
  const { world, tool, fading, size, force } = start();
  for (let now = 0; now < 10_000; now += 1000) {
    fading.take(tool, force, now);
    fading.look(world, false, now + 999);
    assert.equal(size(), 3);
  }
});

test("a loop that stands keeps what it shows, and a link that is lost nothing", () => {
  const { world, tool, fading, size, force } = start();
  fading.take(tool, force, 0);
  wait(fading, world, 10, 3000, true);
  assert.equal(size(), 3);
  fading.drop(world);
  assert.deepEqual([size(), tool.torque[0]], [0, 0]);
});
