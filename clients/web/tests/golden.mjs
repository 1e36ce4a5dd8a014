// The kept bytes of every message, shared by the tests of all clients.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { MESSAGES } from "../dist/palpate.js";

const directory = new URL("../../../proto/golden/", import.meta.url);

export const golden = readdirSync(directory)
  .filter((name) => name.endsWith(".bin"))
  .sort()
  .map((file) => {
    const name = file.slice(0, -".bin".length);
    const { type, schema, value } = JSON.parse(readFileSync(new URL(`${name}.json`, directory), "utf8"));
    return { name, type, schema, value, bytes: new Uint8Array(readFileSync(new URL(file, directory))) };
  });
assert.ok(golden.length > 0, `no golden files in ${directory}`);

/** Table of a golden file's message. */
export function messageOf({ name, type }) {
  const message = MESSAGES.find((candidate) => candidate.type === type);
  assert.ok(message, `${name}: no message is called ${type}`);
  return message;
}
