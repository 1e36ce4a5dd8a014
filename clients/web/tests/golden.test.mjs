// Every kept message decodes to its value and encodes back to its bytes.

import assert from "node:assert/strict";
import { test } from "node:test";
import * as palpate from "../dist/palpate.js";
import { golden, messageOf } from "./golden.mjs";

const { MESSAGES, ControlNet, DeviceInfo, EncodeError, SimEvent, ToolPose, decode, encode, toJson } = palpate;
const one = (type) => golden.find((file) => file.type === type.type);

test("the bytes have the value, and the value the bytes", () => {
  for (const file of golden) {
    const message = messageOf(file);
    const value = decode(message, file.bytes, file.schema);
    // Strict: -0 is not 0.
    assert.deepStrictEqual(toJson(message, value), file.value, file.name);
    assert.deepStrictEqual(encode(message, value), file.bytes, file.name);
    assert.deepStrictEqual(palpate.decodeNamed(MESSAGES, file.schema, file.bytes), { type: file.type, value });
    assert.equal(palpate.encodingSchema(message), file.schema);
  }
});

test("each message has a golden file, and each kind of event", () => {
  assert.deepStrictEqual([...new Set(golden.map((file) => file.type))].sort(), MESSAGES.map((m) => m.type).sort());
  const events = golden.filter((file) => file.type === SimEvent.type);
  const numbers = events.map((file) => decode(SimEvent, file.bytes)).map(({ kind }) => kind.type);
  assert.equal(new Set(numbers).size, events.length);
  const next = encode(SimEvent, { tick: 0n, seq: 0n, t_ns: 0n, kind: { type: "Reset" } });
  next[next.length - 1] = events.length;
  assert.throws(() => decode(SimEvent, next), { fault: "unknown-case" }, "a kind has no golden file");
});

test("bytes inside a larger buffer are read from their place", () => {
  const { bytes } = one(ToolPose);
  const larger = new Uint8Array(bytes.length + 20).fill(255);
  larger.set(bytes, 7);
  assert.deepStrictEqual(decode(ToolPose, larger.subarray(7, 7 + bytes.length)), decode(ToolPose, bytes));
});

test("numbers at the ends of their types come back", () => {
  const pose = decode(ToolPose, one(ToolPose).bytes);
  for (const seq of [0n, 127n, 128n, 2n ** 53n + 1n, 2n ** 64n - 1n]) {
    const value = { ...pose, seq, buttons: 2 ** 32 - 1, position: [-0, Infinity, 5e-324] };
    assert.deepStrictEqual(decode(ToolPose, encode(ToolPose, value)), value);
  }
  const max = 2n ** 64n - 1n;
  const longest = { ...pose, seq: max, t_client_ns: max, buttons: 2 ** 32 - 1, flags: 2 ** 32 - 1 };
  assert.equal(encode(ToolPose, longest).length, ToolPose.maxBytes);
  assert.equal(toJson(ToolPose, longest).seq, "18446744073709551615");
});

test("a large net comes back", () => {
  const points = Float64Array.from({ length: 3 * 128 * 128 }, (_, k) => k * 0.1 - 3);
  const net = { ...decode(ControlNet, one(ControlNet).bytes), count_u: 128, count_v: 128, points, weights: null };
  assert.deepStrictEqual(decode(ControlNet, encode(ControlNet, net)), net);
});

test("text keeps every sign", () => {
  const device = decode(DeviceInfo, one(DeviceInfo).bytes);
  for (const name of ["", "\ufeffarm", "Gerät 1", "\u{1f590} pen"]) {
    assert.equal(decode(DeviceInfo, encode(DeviceInfo, { ...device, name })).name, name);
  }
});

test("values that a type cannot have are refused by their field", () => {
  const pose = decode(ToolPose, one(ToolPose).bytes);
  const bad = [
    ["seq", -1n],
    ["seq", 2n ** 64n],
    ["seq", 1],
    ["buttons", 2 ** 32],
    ["buttons", 0.5],
    ["position", [0, 0]],
    ["position", [0, 0, "x"]],
    ["position", undefined],
  ];
  for (const [field, value] of bad) {
    assert.throws(
      () => encode(ToolPose, { ...pose, [field]: value }),
      (error) => error instanceof EncodeError && error.message.startsWith(`${field}: `),
      `${field} = ${value}`,
    );
  }
  const device = decode(DeviceInfo, one(DeviceInfo).bytes);
  assert.throws(() => encode(DeviceInfo, { ...device, name: "\ud800" }), EncodeError);
  assert.throws(() => encode(DeviceInfo, { ...device, dof_force: 256 }), EncodeError);
  assert.throws(() => encode(DeviceInfo, { ...device, name: "x".repeat(80) }), /more than any palpate.DeviceInfo.v1/);
  const net = decode(ControlNet, one(ControlNet).bytes);
  assert.throws(() => encode(ControlNet, { ...net, points: new Float64Array(4) }), /points: .* 3 numbers an item/);
  const event = { tick: 0n, seq: 1n, t_ns: 0n };
  for (const kind of [null, {}, { type: "toString" }, { type: "Melted" }]) {
    assert.throws(() => encode(SimEvent, { ...event, kind }), /kind: /);
  }
});
