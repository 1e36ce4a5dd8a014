// The watchdog does the arithmetic of all clients, which is kept beside the golden messages.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { ForceFlags, Watchdog } from "../dist/palpate.js";
import { forceOf } from "./scenes.mjs";

test("forces fade and come back as in all clients", () => {
  const table = readFileSync(new URL("../../../proto/golden/watchdog.csv", import.meta.url), "utf8");
  let dog = new Watchdog();
  let at = "";
  for (const line of table.trim().split("\n").slice(1)) {
    const [run, deadband, time, comes, gain, silence] = line.split(",");
    if (run !== at) dog = new Watchdog(deadband === "1");
    at = run;
    const now = Number(time) * 1e-6;
    if (comes === "1") dog.heard(now);
    assert.ok(Math.abs(dog.gain(now) - Number(gain)) < 1e-9, line);
    const age = dog.silence(now);
    assert.ok(silence === "" ? age === null : Math.abs(age - Number(silence) * 1e-6) < 1e-9, line);
  }
});

test("a force in full is the one that came, and one that is not says so", () => {
  const force = { ...forceOf(3n, [1, 2, 2]), torque: [0.4, 0, 0] };
  const dog = new Watchdog();
  assert.deepEqual([dog.gain(5), dog.silence(5)], [0, null]);
  dog.heard(0);
  assert.equal(dog.felt(force, 50), force);
  const half = dog.felt(force, 55);
  assert.deepEqual([half.force, half.torque, half.flags & ForceFlags.RAMPING], [[0.5, 1, 1], [0.2, 0, 0], ForceFlags.RAMPING]);
  assert.deepEqual(dog.felt(force, 61).force, [0, 0, 0]);
  assert.deepEqual(force.force, [1, 2, 2]);
});
