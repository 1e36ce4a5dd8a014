// Recordings in the browser: golden files against the figures in them, and files that are not as they should be.

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import * as page from "../dist/page.js";
import { withoutScene } from "./builds.mjs";

const folder = new URL("../../../recordings/golden/", import.meta.url);
const read = (name) => new Uint8Array(readFileSync(new URL(name, folder)));
const none = async () => null;
const open = (name, bytes) => page.Recording.open(name, new page.MemorySource(bytes), none);

const names = readdirSync(folder).filter((name) => name.endsWith(".mcap") && !name.endsWith(".inputs.mcap"));

for (const name of names) {
  test(`${name}: forces, depths and energies are those that the server reports`, async () => {
    const recording = await open(name, read(name));
    const totals = JSON.parse(await recording.attachmentText("totals.json"));
    assert.equal(recording.firstTick, totals.first_tick);
    assert.equal(recording.lastTick, totals.last_tick);
    const overview = new page.Overview(recording);
    await overview.fill();
    assert.equal(recording.file.damaged, 0);
    assert.equal(overview.events.length, totals.events);
    totals.tools.forEach((tool, t) => {
      const rows = overview.tools[t];
      assert.equal(recording.toolIds[t], tool.id);
      assert.ok(Math.abs(Math.max(...rows.size) - tool.peak_force_n) <= 1e-12 * (1 + tool.peak_force_n), tool.id);
      assert.ok(Math.abs(Math.max(...rows.depth) - tool.peak_depth_m) <= 1e-12, tool.id);
      assert.ok(Math.abs(rows.energy.at(-1) - tool.energy_j) <= 1e-12 * (1 + Math.abs(tool.energy_j)), tool.id);
      assert.equal(rows.contact.reduce((sum, on) => sum + on, 0), tool.contact_ticks);
    });
  });
}

test("any tick can be asked for, in any order, and has its own state", async () => {
  const recording = await open("a", read("teardrop-tap.mcap"));
  const last = recording.lastTick;
  for (const tick of [last, 1, 350, 351, 349, last, 123, 250]) {
    const moment = await recording.at(tick);
    assert.equal(moment.tick.tick, tick);
    const net = moment.nets.get("drop");
    // Nets are written on change, 30 times a second; before tick 175 nothing touches the drop.
    assert.ok(net.tick <= tick && (tick < 200 || tick - net.tick <= 60), `${tick}: a net of ${net.tick}`);
    assert.equal(net.points.length, 3 * net.countU * net.countV);
  }
});

test("a recording that was cut off is shown up to its last whole chunk", async () => {
  const bytes = read("teardrop-tap.mcap");
  const whole = await open("a", bytes);
  let shown = 0;
  for (const share of [0.35, 0.6, 0.8, 0.97]) {
    const recording = await open("a.part", bytes.subarray(0, Math.floor(share * bytes.length))).catch(() => null);
    if (recording === null) continue;
    assert.ok(recording.warnings.some((text) => text.includes("cut off")), String(recording.warnings));
    assert.ok(recording.lastTick <= whole.lastTick);
    const { tick } = await recording.at(recording.lastTick);
    // Cut within the first chunk of ticks, there is none to show.
    if (tick === null) continue;
    const same = await whole.at(tick.tick);
    assert.deepEqual(tick, same.tick);
    shown += 1;
  }
  assert.ok(shown >= 2, "no cut file was shown");
});

test("a damaged chunk loses its own ticks and no others", async () => {
  const bytes = read("teardrop-tap.mcap").slice();
  const whole = await open("a", bytes);
  const [, , good, broken] = whole.file.chunks;
  // Chunks end where the recorder's clock said: only their times tell which ticks are in them.
  const tick = Math.round((good.startNs + good.endNs) / 2e6);
  assert.ok(tick * 1e6 < broken.startNs);
  bytes.fill(0x55, broken.offset + 80, broken.offset + broken.length);
  const recording = await open("a", bytes);
  assert.equal((await recording.at(tick)).tick.tick, tick);
  assert.ok((await recording.at(recording.lastTick)).tick !== null);
  const overview = new page.Overview(recording);
  await overview.fill();
  assert.ok(overview.filled.some((on) => on === 0) && overview.filled.some((on) => on === 1));
});

test("what is no recording says so", async () => {
  await assert.rejects(open("a", new Uint8Array(100)), /not an MCAP/);
  await assert.rejects(open("a", new Uint8Array()), /not an MCAP/);
  await assert.rejects(open("a", read("teardrop-tap.mcap").subarray(0, 8)), /no whole chunk/);
});

test("a recording of another build without a scene is drawn with uniform knots, and says so", async () => {
  const recording = await open("a", new Uint8Array(withoutScene(read("teardrop-tap.mcap"))));
  assert.ok(recording.warnings.some((text) => text.includes("uniform")), String(recording.warnings));
  const world = new page.World();
  const playback = new page.Playback(recording, world, []);
  await playback.seek(400);
  assert.equal(world.tick, 400);
  assert.ok(world.bodies[0].assumed);
  assert.equal(world.tools[0].id, "ball");
  playback.stop();
});

// ---- Ten hours: 36 million ticks, of which only the index and what is looked at exist.

class Bytes {
  parts = [];
  u8 = (x) => this.raw([x]);
  u16 = (x) => this.raw([x & 255, x >> 8]);
  u32 = (x) => this.raw([0, 8, 16, 24].map((s) => (x >>> s) & 255));
  u64 = (x) => this.raw([...new Uint8Array(new BigUint64Array([BigInt(x)]).buffer)]);
  text = (s) => this.u32(s.length).raw([...Buffer.from(s)]);
  raw(x) {
    for (const byte of x) this.parts.push(byte);
    return this;
  }
  record = (op, body) => this.u8(op).u64(body.parts.length).raw(body.parts);
}

const varint = (n) => {
  const out = [];
  for (; n >= 128; n = Math.floor(n / 128)) out.push((n % 128) | 128);
  return [...out, n];
};

const TICKS_A_CHUNK = 200;
const MAGIC = [0x89, 0x4d, 0x43, 0x41, 0x50, 0x30, 0x0d, 0x0a];

/** A file of so many chunks, each made when it is read. */
function longFile(chunks) {
  const chunkOf = (k) => {
    const records = new Bytes();
    for (let tick = k * TICKS_A_CHUNK + 1; tick <= (k + 1) * TICKS_A_CHUNK; tick++) {
      const data = [0x08, ...varint(tick)];
      records.record(5, new Bytes().u16(1).u32(0).u64(tick * 1e6).u64(0).raw(data));
    }
    const head = new Bytes().u64((k * TICKS_A_CHUNK + 1) * 1e6).u64((k + 1) * TICKS_A_CHUNK * 1e6).u64(records.parts.length).u32(0).text("");
    return Uint8Array.from(new Bytes().record(6, head.u64(records.parts.length).raw(records.parts)).parts);
  };
  // Numbers grow by bytes: give every chunk the room of the last one.
  const room = chunkOf(chunks - 1).length + 64;
  const start = 8;
  const summaryAt = start + room * chunks;
  const summary = new Uint8Array(chunks * 110 + 200);
  let at = 0;
  const put = (bytes) => {
    summary.set(bytes.parts, at);
    at += bytes.parts.length;
  };
  put(new Bytes().record(4, new Bytes().u16(1).u16(1).text("/sim/tick").text("protobuf").u32(0)));
  for (let k = 0; k < chunks; k++) {
    const map = new Bytes().u16(1).u64(0);
    put(new Bytes().record(8, new Bytes().u64((k * TICKS_A_CHUNK + 1) * 1e6).u64((k + 1) * TICKS_A_CHUNK * 1e6)
      .u64(start + room * k).u64(room).u32(map.parts.length).raw(map.parts).u64(0).text("").u64(0).u64(0)));
  }
  const footer = new Bytes().record(2, new Bytes().u64(summaryAt).u64(0).u32(0)).raw(MAGIC).parts;
  const tail = new Uint8Array([...summary.subarray(0, at), ...footer]);
  const reads = { count: 0, bytes: 0 };
  return {
    reads,
    size: summaryAt + tail.length,
    async read(offset, length) {
      reads.count += 1;
      reads.bytes += length;
      const out = new Uint8Array(length);
      for (let k = 0; k < length && offset < 8; k++) out[k] = MAGIC[offset + k] ?? 0;
      if (offset >= summaryAt) return tail.slice(offset - summaryAt, offset - summaryAt + length);
      if (offset >= start) out.set(chunkOf(Math.floor((offset - start) / room)).subarray(0, length));
      return out;
    },
  };
}

test("a recording of ten hours opens by its index and seeks within 0.3 s", async () => {
  const source = longFile(180_000);
  const begin = performance.now();
  const recording = await page.Recording.open("ten hours", source, none);
  const opened = performance.now() - begin;
  assert.equal(recording.lastTick, 36_000_000);
  const before = source.reads.bytes;
  let worst = 0;
  for (const tick of [18_000_000, 5, 36_000_000, 7_654_321]) {
    const start = performance.now();
    assert.equal((await recording.at(tick)).tick.tick, tick);
    worst = Math.max(worst, performance.now() - start);
  }
  console.log(`  ten hours: opened in ${opened.toFixed(0)} ms, slowest seek ${worst.toFixed(0)} ms, ${source.reads.bytes - before} bytes read for four`);
  assert.ok(source.reads.bytes - before < 2e6);
  const overview = new page.Overview(recording);
  assert.ok(overview.rows <= 6000);
});
