/**
 * What happened: the kinds of a `SimEvent`.
 *
 * Generated from proto/src/messages.rs by `cargo run -p palpate-proto --example generate`; do not edit.
 */

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
    /** Tool id. */
    tool: text,
  }),
  /** No pose of a tool came for so long that the last one is stale. */
  ToolLost: struct({
    /** Tool id. */
    tool: text,
  }),
  /** A pose was refused. */
  PoseRefused: struct({
    /** Tool id. */
    tool: text,
    /** Why. */
    reason: text,
  }),
  /** A tick met a fault. */
  Fault: struct({
    /** What and where. */
    reason: text,
  }),
  /** A recording began. */
  RecordStarted: struct({
    /** Path. */
    path: text,
  }),
  /** A recording ended. */
  RecordStopped: struct({
    /** Path. */
    path: text,
  }),
  /** The daemon is going down. */
  Stopping: struct({}),
  /** Ticks took longer than their period, or were woken too late: at most one such event a second for each stage. */
  Overrun: struct({
    /**
     * Stage that took most of their time: `latch`, `render`, `deform`, `hash`, `emit`; `wake`: the system came late.
     */
    stage: text,
    /** How many since the last such event. */
    count: u64,
    /** The longest of them, ns. */
    worst_ns: u64,
  }),
  /** The loop does less, or again more, to keep its rate. */
  QualityChanged: struct({
    /** As `quality_level` of {@link LoopStatus}. */
    level: u8,
    /** Why. */
    reason: text,
  }),
  /** A device said what it can do. */
  DeviceTold: struct({
    /** Tool id. */
    tool: text,
    /** Name of the device. */
    name: text,
  }),
  /** A recording could not go on; the loop does, and what was flushed stays readable. */
  RecordFailed: struct({
    /** Path. */
    path: text,
    /** Words of the system. */
    reason: text,
  }),
  /** Another scene runs from this tick on: bodies were merged or moved. Ask for the scene anew. */
  SceneChanged: struct({
    /** What became of which bodies. */
    what: text,
  }),
  /** A tool was seated inside a body: it gives no force until its contact force has been small once. */
  ForceWithheld: struct({
    /** Tool id. */
    tool: text,
  }),
  /** A tool's force is less accurate than the scene asks for, from now on. */
  ForceDegraded: struct({
    /** Tool id. */
    tool: text,
    /** What is done instead. */
    reason: text,
  }),
  /** A tool's force is as accurate as the scene asks for again. */
  ForceRestored: struct({
    /** Tool id. */
    tool: text,
    /** In how many ticks it was not. */
    ticks: u64,
  }),
});
export type EventKind = Value<typeof EventKind>;
