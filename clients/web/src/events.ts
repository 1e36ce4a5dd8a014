/** What a `SimEvent` tells. */

import { cases, struct, text, u64, u8, type Value } from "./codec";

/** What happened. May grow at its end: skip an event whose decoding fails with `unknown-case`. */
export const EventKind = cases({
  /** State set back to the scene's start. */
  Reset: struct({}),
  /** Loop paused. */
  Paused: struct({}),
  /** Loop resumed. */
  Resumed: struct({}),
  /** A tool sends poses. */
  ToolJoined: struct({
    tool: text,
  }),
  /** A tool's poses went stale or its token vanished. */
  ToolLost: struct({
    tool: text,
  }),
  /** A pose was refused. */
  PoseRefused: struct({
    tool: text,
    reason: text,
  }),
  /** A tick met a fault. */
  Fault: struct({
    reason: text,
  }),
  /** A recording began. */
  RecordStarted: struct({
    path: text,
  }),
  /** A recording ended. */
  RecordStopped: struct({
    path: text,
  }),
  /** The daemon is going down. */
  Stopping: struct({}),
  /** Ticks took longer than their period, or were woken too late. */
  Overrun: struct({
    /** Stage that took most of their time: latch, render, deform, hash, emit; wake: the system came late. */
    stage: text,
    /** How many since the last such event. */
    count: u64,
    /** The longest of them, ns. */
    worst_ns: u64,
  }),
  /** The loop does less, or again more, to keep its rate. */
  QualityChanged: struct({
    level: u8,
    reason: text,
  }),
  /** A device said what it can do. */
  DeviceTold: struct({
    tool: text,
    name: text,
  }),
  /** A recording could not go on; the loop does, and what was flushed stays readable. */
  RecordFailed: struct({
    path: text,
    reason: text,
  }),
  /** Another scene runs from this tick on: bodies were merged or moved. Ask for the scene anew. */
  SceneChanged: struct({
    /** What became of which bodies. */
    what: text,
  }),
});
export type EventKind = Value<typeof EventKind>;
