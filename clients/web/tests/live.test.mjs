// The live side without a browser: frames into a world, the history of charts, the hand.

import assert from "node:assert/strict";
import { afterEach, test } from "node:test";
import * as bus from "../dist/palpate.js";
import * as page from "../dist/page.js";
import { snapshotOf, forceOf } from "./scenes.mjs";

const session = { mode: "live", token: "t" };
const frame = (key, type, value) => page.frame(key, bus.encode(type, value));

function worldOf(scene = snapshotOf()) {
  const world = new page.World();
  const live = new page.Live(world, session);
  globalThis.fetch = async () => ({ json: async () => [] });
  live.take(frame("scene", bus.SceneSnapshot, scene));
  return { world, live };
}

test("a scene, a force and a net arrive in the world", () => {
  const { world, live } = worldOf();
  assert.deepEqual(world.bodies.map(({ id }) => id), ["drop"]);
  live.take(frame("tool/ball/force", bus.ToolForce, forceOf(1000n, [1, 2, 2])));
  assert.deepEqual([...world.tools[0].force], [1, 2, 2]);
  const [body] = world.bodies;
  const points = body.rest.map((x) => x + 0.001);
  live.take(frame("body/drop/net", bus.ControlNet, { tick: 1000n, revision: 2n, body: "drop", degree_u: 3, degree_v: 3, count_u: body.surface.u.count, count_v: body.surface.v.count, points, weights: null }));
  assert.equal(world.bodies[0].points[5], points[5]);
  assert.equal(live.malformed, 0);
});

test("a net with NaN is kept out of the picture and named", () => {
  const { world, live } = worldOf();
  const [body] = world.bodies;
  const points = body.rest.slice();
  points[7] = NaN;
  const net = { tick: 5n, revision: 2n, body: "drop", degree_u: 3, degree_v: 3, count_u: body.surface.u.count, count_v: body.surface.v.count, points, weights: null };
  live.take(frame("body/drop/net", bus.ControlNet, net));
  assert.match(body.fault, /control point 2 of drop/);
  live.take(frame("body/drop/net", bus.ControlNet, { ...net, points: body.rest }));
  assert.equal(body.fault, null);
});

test("a net of another size is not put on a body", () => {
  const { world, live } = worldOf();
  const before = world.bodies[0].points;
  live.take(frame("body/drop/net", bus.ControlNet, { tick: 5n, revision: 2n, body: "drop", degree_u: 3, degree_v: 3, count_u: 2, count_v: 2, points: new Float64Array(12), weights: null }));
  assert.equal(world.bodies[0].points, before);
});

test("a net or a scene with too few points is not drawn", () => {
  const { world, live } = worldOf();
  const [body] = world.bodies;
  const { u, v } = body.surface;
  live.take(frame("body/drop/net", bus.ControlNet, { tick: 5n, revision: 2n, body: "drop", degree_u: 3, degree_v: 3, count_u: u.count, count_v: v.count, points: new Float64Array(12), weights: null }));
  assert.equal(body.points.length, 3 * u.count * v.count);
  const scene = snapshotOf();
  live.take(frame("scene", bus.SceneSnapshot, { ...scene, bodies: scene.bodies.map((given) => ({ ...given, points: new Float64Array(9), rest_points: new Float64Array(9) })) }));
  assert.match(world.bodies[0].fault, /has not \d+ × \d+ points/);
  live.take(page.frame("holders", page.ofText("{ not json")));
  assert.equal(live.malformed, 1);
});

test("garbage is counted and changes nothing", () => {
  const { world, live } = worldOf();
  const { version } = world;
  live.take(new Uint8Array([3, 0x61]));
  live.take(page.frame("tool/ball/force", new Uint8Array([1, 2, 3])));
  live.take(page.frame("tool/none/nonsense", new Uint8Array(9)));
  assert.equal(live.malformed, 2);
  assert.ok(world.version - version <= 1);
});

test("another scene keeps the tools that stay, with their history", () => {
  const { world, live } = worldOf();
  live.take(frame("tool/ball/force", bus.ToolForce, forceOf(10n, [1, 0, 0])));
  const scene = snapshotOf();
  live.take(frame("scene", bus.SceneSnapshot, { ...scene, bodies: scene.bodies.map((body) => ({ ...body, id: "other" })) }));
  assert.deepEqual(world.bodies.map(({ id }) => id), ["other"]);
  assert.equal(world.tools[0].history.ticks.length, 1);
});

test("an hour of forces stays a few thousand rows", () => {
  const history = new page.History();
  for (let tick = 0; tick < 216_000; tick++) history.push(tick * 17, tick, 0, 0);
  assert.ok(history.ticks.length <= 5200);
  assert.equal(history.columns[0].at(-1), 215_999);
});

test("a message that was overtaken leaves the history alone, a new run begins it anew", () => {
  const history = new page.History();
  history.push(1000, 1);
  history.push(990, 2);
  assert.deepEqual(history.ticks, [1000]);
  history.push(5, 3);
  assert.deepEqual(history.ticks, [5]);
});

// A hand that goes on after a test that failed would keep the program alive.
const hands = [];
afterEach(() => hands.splice(0).forEach((hand) => hand.end(null)));

function handOf() {
  const { world } = worldOf();
  const said = [];
  const daemon = {
    mayWrite: true,
    claim: (tool, info) => said.push({ what: "claim", tool, info }),
    pose: (tool, pose) => said.push({ what: "pose", tool, pose, at: performance.now() }),
    release: (tool) => said.push({ what: "release", tool }),
  };
  const hand = new page.Hand(world, daemon, () => 0.1);
  hands.push(hand);
  return { world, hand, said };
}

const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

test("the hand sends no pose before the tool is its own, then 60 a second or more", async () => {
  const { world, hand, said } = handOf();
  hand.take(world.tools[0]);
  await sleep(60);
  assert.deepEqual(said.map(({ what }) => what), ["claim"]);
  assert.ok(bus.encode(bus.DeviceInfo, said[0].info).length > 0);
  assert.equal(said[0].info.rate_hz, 60);
  // Without motors: the daemon holds it while the page is busy.
  assert.deepEqual([said[0].info.dof_force, said[0].info.dof_torque], [0, 0]);
  world.tools[0].holder = hand.name;
  // As many turns as a timer of 60 a second has beside it on this computer, busy or not.
  let turns = 0;
  const beside = setInterval(() => { turns += 1; }, 1000 / 60);
  await sleep(500);
  clearInterval(beside);
  const poses = said.filter(({ what }) => what === "pose");
  assert.ok(turns > 2 && poses.length >= turns - 2, `${poses.length} poses in ${turns} turns`);
  poses.forEach(({ pose }, k) => assert.equal(pose.seq, BigInt(k + 1)));
});

test("the hand begins where the tool is; one that is withheld inside a body comes out, and goes on from there", async () => {
  const { world, hand, said } = handOf();
  const [tool] = world.tools;
  const start = [...tool.proxy];
  const away = (to) => Math.hypot(...said.at(-1).pose.position.map((x, k) => x - to[k]));
  hand.take(tool);
  hand.move([0.02, 0, 0]);
  tool.holder = hand.name;
  await sleep(200);
  assert.deepEqual(said.find(({ what }) => what === "pose").pose.position, start);
  const goal = [start[0] + 0.02, start[1], start[2]];
  assert.ok(away(goal) < 1e-9);
  // Lost and found again inside: the daemon says where it is out.
  [tool.proxy, tool.flags] = [[start[0], start[1] + 0.01, start[2]], bus.ForceFlags.WITHHELD];
  await sleep(200);
  assert.ok(away(tool.proxy) < 1e-9);
  tool.flags = 0;
  await sleep(200);
  assert.ok(away(goal) < 1e-9);
});

test("a flick of the mouse becomes a motion that the loop accepts", async () => {
  const { world, hand, said } = handOf();
  hand.take(world.tools[0]);
  world.tools[0].holder = hand.name;
  hand.move([5, 0, 0]);
  await sleep(200);
  const poses = said.filter(({ what }) => what === "pose");
  assert.ok(poses.length > 3);
  for (let k = 1; k < poses.length; k++) {
    const seconds = Math.min((poses[k].at - poses[k - 1].at) / 1e3, 0.1);
    const moved = Math.abs(poses[k].pose.position[0] - poses[k - 1].pose.position[0]);
    assert.ok(moved <= 3 * seconds + 1e-3, `${moved} m in ${seconds} s`);
    assert.ok(Math.abs(poses[k].pose.linear_velocity[0]) <= 4);
  }
});

test("after a pause the hand goes on in strides that the loop accepts, and by the speed it had", async () => {
  const { world, hand, said } = handOf();
  hand.take(world.tools[0]);
  world.tools[0].holder = hand.name;
  await sleep(30);
  const before = said.length;
  hand.move([5, 0, 0]);
  for (const end = performance.now() + 120; performance.now() < end;);
  await sleep(30);
  const poses = said.slice(before - 1).map(({ pose }) => pose);
  assert.ok(poses.length > 2);
  // The loop believes 10 m/s, from the repeated pose before it on, for which a late one waits 25 ms at most.
  for (let k = 1; k < poses.length; k++) assert.ok(Math.abs(poses[k].position[0] - poses[k - 1].position[0]) <= 0.1);
  for (const pose of poses) assert.ok(Math.abs(pose.linear_velocity[0]) <= 3);
});

test("letting go is gentle: the hand follows the proxy, then gives the tool back", async () => {
  const { world, hand, said } = handOf();
  hand.take(world.tools[0]);
  world.tools[0].holder = hand.name;
  hand.move([-0.02, 0, 0]);
  await sleep(150);
  hand.letGo();
  for (const start = Date.now(); hand.state !== "free" && Date.now() - start < 60_000;) await sleep(20);
  assert.equal(hand.state, "free");
  assert.equal(said.at(-1).what, "release");
  const last = said.filter(({ what }) => what === "pose").at(-1).pose;
  assert.ok(Math.abs(last.position[0] - world.tools[0].proxy[0]) < 1e-6);
});

test("a refusal ends the hand with its reason, and the tool is not given back: it was never had", () => {
  const { world, hand, said } = handOf();
  let why = null;
  hand.onEnd = (_, reason) => (why = reason);
  hand.take(world.tools[0]);
  hand.end("held by somebody");
  assert.equal(why, "held by somebody");
  assert.ok(said.every(({ what }) => what !== "release"));
});

test("a scene swap while dragging keeps the tool if it is still there, and lets go if it is not", async () => {
  const { world, hand } = handOf();
  let why = null;
  hand.onEnd = (_, reason) => (why = reason);
  hand.take(world.tools[0]);
  world.tools[0].holder = hand.name;
  await sleep(40);
  world.load(snapshotOf());
  await sleep(40);
  assert.equal(hand.state, "holding");
  world.load({ ...snapshotOf(), tools: [] });
  await sleep(40);
  assert.equal(hand.state, "free");
  assert.match(why, /not in the scene/);
});

test("figures are short and have their unit", () => {
  assert.equal(page.withUnit(0.00123, "m"), "1.23 mm");
  assert.equal(page.withUnit(0.9999e-3, "s"), "1.00 ms");
  assert.equal(page.withUnit(0, "J"), "0 J");
  assert.equal(page.withUnit(NaN, "J"), "– J");
  assert.equal(page.clock(62.345, 3), "1:02.345");
  assert.equal(page.clock(59.999), "0:59.99");
  assert.equal(page.clock(36_000), "10:00:00.00");
  assert.equal(page.niceAbove(0.0031), 0.005);
});

test("a saved net has its triangles and its control points", () => {
  const { world } = worldOf();
  const text = page.objOf(world);
  assert.equal(text.split("\n").filter((line) => line.startsWith("#net p")).length, world.bodies[0].points.length / 3);
  assert.ok(text.includes("\no drop\n") && /\nf \d+\/\/\d+ /.test(text));
});
