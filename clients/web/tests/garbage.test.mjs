// Bytes that are no message throw the one typed error, whatever they are.

import assert from "node:assert/strict";
import { test } from "node:test";
import * as palpate from "../dist/palpate.js";
import { golden, messageOf } from "./golden.mjs";

const { MESSAGES, ContactSet, ControlNet, DeviceInfo, SimEvent, ToolPose } = palpate;
const { DecodeError, decode, decodeNamed, encode } = palpate;

function refused(fault, message, bytes, schema = "") {
  try {
    decode(message, bytes, schema);
  } catch (error) {
    assert.ok(error instanceof DecodeError, String(error));
    assert.equal(error.fault, fault, error.message);
    assert.ok(error.message.includes(message.type));
    return error;
  }
  assert.fail(`${message.type}: ${bytes.length} bytes were accepted`);
}

/** Numbers that look random and are the same in every run. */
function draws(seed) {
  let state = BigInt(seed);
  return (below) => {
    state = (state * 6364136223846793005n + 1442695040888963407n) & 0xffffffffffffffffn;
    return Number(state >> 33n) % below;
  };
}

test("a message cut at any length is truncated", () => {
  for (const file of golden) {
    for (let length = 0; length < file.bytes.length; length++) {
      refused("truncated", messageOf(file), file.bytes.subarray(0, length));
    }
  }
});

test("a byte more is told", () => {
  for (const file of golden) {
    const message = messageOf(file);
    const fault = file.bytes.length < message.maxBytes ? "trailing-bytes" : "oversized";
    refused(fault, message, new Uint8Array([...file.bytes, 0]));
  }
});

test("flipped bits throw only the typed error", () => {
  const draw = draws(7);
  let [accepted, thrown] = [0, 0];
  for (const file of golden) {
    const message = messageOf(file);
    for (let round = 0; round < 300; round++) {
      const bytes = file.bytes.slice();
      for (let flips = draw(4); flips >= 0; flips--) bytes[draw(bytes.length)] ^= 1 << draw(8);
      try {
        decode(message, encode(message, decode(message, bytes)));
        accepted++;
      } catch (error) {
        assert.ok(error instanceof DecodeError, `${file.name}: ${error.stack}`);
        thrown++;
      }
    }
  }
  assert.ok(thrown > 100 && accepted > 100, `${thrown} refused, ${accepted} accepted`);
});

test("random bytes throw only the typed error", () => {
  const draw = draws(11);
  for (let round = 0; round < 5000; round++) {
    const bytes = Uint8Array.from({ length: draw(120) }, () => draw(256));
    for (const message of MESSAGES) {
      try {
        decode(message, bytes);
      } catch (error) {
        assert.ok(error instanceof DecodeError, error.stack);
      }
    }
  }
});

test("a hostile count gets no memory", () => {
  const net = { tick: 1n, revision: 1n, body: "b", degree_u: 3, degree_v: 3, count_u: 4, count_v: 4 };
  const bytes = encode(ControlNet, { ...net, points: new Float64Array(0), weights: null });
  const many = [255, 255, 255, 255, 255, 255, 255, 255, 255, 1];
  assert.equal(refused("truncated", ControlNet, new Uint8Array([...bytes.slice(0, -2), ...many, 0])).field, "points");
  refused("truncated", DeviceInfo, new Uint8Array([...many, ...Array(100).fill(0)]));
});

test("another schema is told", () => {
  const { bytes } = golden.find((file) => file.type === ToolPose.type);
  for (const schema of ["postcard;palpate.ToolPose.v2", "palpate.ToolPose.v1", "postcard;palpate.ToolForce.v1"]) {
    refused("wrong-schema", ToolPose, bytes, schema);
  }
  for (const schema of ["palpate.ToolPose.v9", "", "postcard;", "x".repeat(10_000)]) {
    assert.throws(
      () => decodeNamed(MESSAGES, schema, bytes),
      (error) => error instanceof DecodeError && error.fault === "wrong-schema" && error.message.length < 300,
    );
  }
});

test("too many bytes are told unread", () => {
  refused("oversized", ToolPose, new Uint8Array(ToolPose.maxBytes + 1));
  refused("oversized", ContactSet, new Uint8Array((16 << 20) + 1));
});

test("a kind of event that is not known can be told apart", () => {
  const event = encode(SimEvent, { tick: 1n, seq: 2n, t_ns: 3n, kind: { type: "Reset" } });
  event[event.length - 1] = 99;
  assert.equal(refused("unknown-case", SimEvent, event).field, "kind");
});

test("values outside their type are malformed, and the innermost field is told", () => {
  const rest = Array(108).fill(0);
  assert.equal(refused("malformed", ToolPose, new Uint8Array([...Array(9).fill(255), 2, ...rest])).field, "seq");
  refused("malformed", ToolPose, new Uint8Array([...Array(10).fill(128), ...rest]));
  refused("malformed", DeviceInfo, new Uint8Array([1, 255, ...rest.slice(2)]));
  const contacts = encode(ContactSet, {
    tick: 1n,
    contacts: [{ tool: "t", body: "b", u: 0, v: 0, point: [0, 0, 0], normal: [0, 0, 1], depth: 0, force: [0, 0, 0] }],
  });
  assert.equal(refused("truncated", ContactSet, contacts.slice(0, -1)).field, "contacts.force");
});
