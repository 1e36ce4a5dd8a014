// Compiled, never run: what the types promise to who uses them.

import { MESSAGES, SimEvent, ToolPose, decode, decodeNamed, encode } from "../src/index";

const pose: ToolPose = decode(ToolPose, new Uint8Array());
const seq: bigint = pose.seq;
const place: readonly [number, number, number] = pose.position;
encode(ToolPose, { ...pose, seq: seq + 1n, position: place });
// @ts-expect-error a u64 is a bigint
encode(ToolPose, { ...pose, seq: 1 });
// @ts-expect-error messages do not change
pose.seq = 2n;
// @ts-expect-error three numbers
encode(ToolPose, { ...pose, position: [0, 0] });

const named = decodeNamed(MESSAGES, "palpate.LoopStatus.v4", new Uint8Array());
if (named.type === "palpate.LoopStatus.v4") {
  const state: "Running" | "Paused" | "Stopping" = named.value.state;
  void state;
}

const { kind } = decode(SimEvent, new Uint8Array());
if (kind.type === "Overrun") {
  const worst: bigint = kind.worst_ns;
  void worst;
}
// @ts-expect-error not every kind has it
void kind.worst_ns;
