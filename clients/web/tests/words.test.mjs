// What the page says of a loop: true when it is said, and not a hundred times.

import assert from "node:assert/strict";
import { test } from "node:test";
import * as bus from "../dist/palpate.js";
import * as page from "../dist/page.js";
import { snapshotOf } from "./scenes.mjs";

const { FAULT, REFUSED, STALE, SATURATED, RAMPING, GRABBING, DAMPED, PAUSED } = bus.ForceFlags;

test("a tool's words follow from its flags, and a tool that nobody holds has none", () => {
  // Flags, the words where somebody holds it, the words where nobody does.
  const table = [
    [0, "", ""],
    [RAMPING | SATURATED, "force ramping up", "force ramping up"],
    [SATURATED, "at the force limit", "at the force limit"],
    [GRABBING | DAMPED, "gripping, damped", "gripping, damped"],
    [PAUSED | RAMPING, "paused", "paused"],
    [PAUSED, "paused", "paused"],
    [REFUSED | RAMPING, "the last pose was refused", "the last pose was refused"],
    [STALE | RAMPING, "no fresh pose", ""],
    [STALE, "no fresh pose", ""],
    // As recordings of earlier builds have it.
    [STALE | SATURATED | RAMPING | GRABBING, "no fresh pose", ""],
    [STALE | PAUSED | SATURATED, "no fresh pose, paused", "paused"],
    [FAULT | STALE, "fault: the force is safe, not right, no fresh pose", "fault: the force is safe, not right"],
  ];
  for (const [flags, held, free] of table) {
    assert.equal(page.flagWords(flags).join(", "), held, `${flags}`);
    assert.equal(page.flagWords(flags, true).join(", "), free, `${flags}, free`);
  }
});

function logOf() {
  const world = new page.World();
  world.load(snapshotOf());
  let seq = 0;
  const add = (kind) => world.addEvent(page.happening({ tick: BigInt(++seq), seq: BigInt(seq), t_ns: 0n, kind }));
  return { world, add, lines: () => world.events.map(({ text }) => text) };
}

test("quality that rises is good news at every level, and names no reason of its fall", () => {
  const { world, add } = logOf();
  const lowered = "lowered from level 0: a tenth of the ticks overran, most of their time in deform";
  add({ type: "QualityChanged", level: 1, reason: lowered });
  add({ type: "QualityChanged", level: 1, reason: "raised from level 2: ticks have ended in good time for a while" });
  add({ type: "QualityChanged", level: 0, reason: "raised from level 1: ticks have ended in good time for a while" });
  const [down, up, full] = world.events;
  assert.deepEqual([down.serious, up.serious, full.serious], [true, false, false]);
  assert.equal(down.text, `Quality is at level 1 (bodies iterate once), ${lowered}`);
  assert.match(up.text, /^Quality is at level 1 \(bodies iterate once\), raised from level 2: ticks have ended in good time/);
  assert.match(full.text, /^Full quality again, raised from level 1/);
});

test("a hand that comes and goes a hundred times is two lines with their number", () => {
  const { add, lines } = logOf();
  add({ type: "DeviceTold", tool: "ball", name: "mouse 12ab" });
  for (let k = 0; k < 100; k++) {
    add({ type: "ToolJoined", tool: "ball" });
    add({ type: "ToolJoined", tool: "pen" });
    add({ type: "ToolLost", tool: "ball" });
    add({ type: "ToolLost", tool: "pen" });
  }
  assert.deepEqual(lines(), ["The device of ball is mouse 12ab",
    "ball is being moved (100 times)", "pen is being moved (100 times)", "ball is not moved any more (100 times)", "pen is not moved any more (100 times)"]);
  // Who takes it anew does so on a line of its own.
  add({ type: "DeviceTold", tool: "ball", name: "mouse 12ab" });
  add({ type: "ToolJoined", tool: "ball" });
  assert.equal(lines().at(-1), "ball is being moved");
  for (let k = 0; k < 3; k++) add({ type: "PoseRefused", tool: "ball", reason: "it jumped" });
  assert.equal(lines().at(-1), "3 times a pose of ball was refused: it jumped");
});

test("an event of a recording is told in the words of one that happens now", () => {
  const now = (kind) => page.happening({ tick: 5n, seq: 1n, t_ns: 0n, kind });
  const pairs = [
    ["tool_joined", "ball", { type: "ToolJoined", tool: "ball" }],
    ["tool_lost", "ball", { type: "ToolLost", tool: "ball" }],
    ["pose_refused", "ball: it jumped: far", { type: "PoseRefused", tool: "ball", reason: "it jumped: far" }],
    ["quality_changed", "1: raised from level 2: in good time", { type: "QualityChanged", level: 1, reason: "raised from level 2: in good time" }],
    ["overrun", "render: 3 ticks, worst 1500000 ns", { type: "Overrun", stage: "render", count: 3n, worst_ns: 1_500_000n }],
    ["device_told", "ball: a mouse", { type: "DeviceTold", tool: "ball", name: "a mouse" }],
    ["record_failed", "a.mcap: disk full", { type: "RecordFailed", path: "a.mcap", reason: "disk full" }],
    ["fault", "a state was not finite", { type: "Fault", reason: "a state was not finite" }],
    ["scene_changed", "a and b merged", { type: "SceneChanged", what: "a and b merged" }],
    ["reset", "", { type: "Reset" }], ["paused", "", { type: "Paused" }], ["resumed", "", { type: "Resumed" }], ["stopping", "", { type: "Stopping" }],
  ];
  for (const [kind, detail, live] of pairs) {
    const [told, expected] = [page.recordedHappening(5, kind, detail, 1), now(live)];
    assert.deepEqual([told.text, told.about, told.serious], [expected.text, expected.about, expected.serious], kind);
  }
  assert.equal(page.recordedHappening(5, "snowed", "much", 1).text, "Snowed: much");
});
