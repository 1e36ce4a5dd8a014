/**
 * The messages of the bus. SI units; quaternions are x y z w; world frame; times are nanoseconds. `u64` is a bigint;
 * lists of numbers and of points are flat `Float64Array`s. `docs/wire.md` of the project lists what each key carries.
 *
 * Each name is a value, the table that `decode` and `encode` take, and a type, that of the message.
 *
 * Generated from proto/src/messages.rs by `cargo run -p palpate-proto --example generate`; do not edit.
 */

import {
  array, bool, choice, f64, list, numbers, octets, optional, points, struct, text, u16, u32, u64, u8, type Value,
} from "./codec";
import { EventKind } from "./events";
import { message, type Of } from "./wire";

/** x y z. */
const vector = array(f64, 3);
/** x y z w. */
const quaternion = array(f64, 4);

/** Pose and velocity of a tool, sent by whoever holds it. World frame. */
export const ToolPose = message("palpate.ToolPose.v1", "tool/{tool}/pose", {
  /** Counts the poses of this client from 1; must grow. */
  seq: u64,
  /** Sender's clock, ns; echoed in {@link ToolForce} so that the sender can measure its round trip. */
  t_client_ns: u64,
  /** Reference point of the tool, m. */
  position: vector,
  /** Unit quaternion x y z w. */
  orientation: quaternion,
  /** m/s. */
  linear_velocity: vector,
  /** rad/s. */
  angular_velocity: vector,
  /** Bit 0: grab. While it is set, the tool holds on to what it touches. */
  buttons: u32,
  /** Reserved, 0. */
  flags: u32,
}, 134);
export type ToolPose = Of<typeof ToolPose>;

/** While it is set, the tool holds on to what it touches. */
export const GRAB = 1;

/** Bits of `flags` of {@link ToolForce}. */
export const ForceFlags = {
  /** The newest pose is older than the stale limit; the force ramps to zero. */
  STALE: 1,
  /** The force was limited to what the device can bear. */
  SATURATED: 2,
  /** The simulation is paused. */
  PAUSED: 4,
  /** The last pose was refused (a jump, or not finite). */
  REFUSED: 8,
  /** The force is being ramped up or down. */
  RAMPING: 16,
  /** The tick met a fault; the force is safe, not right. */
  FAULT: 32,
  /** The tool holds on to what it grabbed. */
  GRABBING: 64,
  /** A damper was added to keep the loop from making energy. */
  DAMPED: 128,
  /** No force: the tool was seated inside a body, and its contact force was not small once since then. */
  WITHHELD: 256,
  /**
   * The force is less accurate than the scene asks for: the step of a body that the tool presses fell back to another
   * matrix or was shortened, quality is lowered, or the force may be off by more than 5 % and 0.02 N.
   */
  DEGRADED: 512,
} as const;

/** The force a hand should feel: wrench on the tool, world axes, at the tool's reference point. */
export const ToolForce = message("palpate.ToolForce.v1", "tool/{tool}/force", {
  /** Tick that made it. */
  tick: u64,
  /** `seq` of the pose that took effect (0: none yet). */
  pose_seq: u64,
  /** `t_client_ns` of that pose. */
  t_client_ns: u64,
  /** Server's clock when published, ns. */
  t_server_ns: u64,
  /** N. */
  force: vector,
  /** N·m. */
  torque: vector,
  /** Where the surface holds the tool back, m. */
  proxy_position: vector,
  /** x y z w. */
  proxy_orientation: quaternion,
  /** Penetration of the device's tool into the surface, m; 0 without contact. */
  depth: f64,
  /** Contact regions. */
  contact_count: u16,
  /** {@link ForceFlags}. */
  flags: u32,
});
export type ToolForce = Of<typeof ToolForce>;

/** {@link ToolForce}, and how far it may be off. Sent while somebody subscribes. */
export const ToolForceV2 = message("palpate.ToolForce.v2", "tool/{tool}/force_v2", {
  /** Tick that made it. */
  tick: u64,
  /** `seq` of the pose that took effect (0: none yet). */
  pose_seq: u64,
  /** `t_client_ns` of that pose. */
  t_client_ns: u64,
  /** Server's clock when published, ns. */
  t_server_ns: u64,
  /** N. */
  force: vector,
  /** N·m. */
  torque: vector,
  /** Where the surface holds the tool back, m. */
  proxy_position: vector,
  /** x y z w. */
  proxy_orientation: quaternion,
  /** Penetration of the device's tool into the surface, m; 0 without contact. */
  depth: f64,
  /** Contact regions. */
  contact_count: u16,
  /** {@link ForceFlags}. */
  flags: u32,
  /**
   * How far the force may be from the one that the exact step of the same length would give from the same state, N: an
   * estimate, 0 on rigid bodies.
   */
  error_n: f64,
  /** Reserved for the force on a jaw, N or N·m; 0. */
  jaw_force: f64,
});
export type ToolForceV2 = Of<typeof ToolForceV2>;

/**
 * What all contacts do to a tool, before anything is limited for the device: what a sensor between tool and body would
 * read. World axes, at the tool's reference point. Sent while somebody subscribes.
 */
export const ToolContact = message("palpate.ToolContact.v1", "tool/{tool}/contact", {
  /** Tick that made it. */
  tick: u64,
  /** `seq` of the pose that took effect (0: none yet). */
  pose_seq: u64,
  /** `t_client_ns` of that pose. */
  t_client_ns: u64,
  /** N. */
  force: vector,
  /** N·m. */
  torque: vector,
  /** Net work done by the device on the loop since the start, J; what is below zero, the loop has made. */
  energy_j: f64,
  /** Part of it that the passivity controller took away, J. */
  dissipated_j: f64,
  /** Greatest force that the loop gives this tool's device, N. */
  force_limit: f64,
});
export type ToolContact = Of<typeof ToolContact>;

/** What the device that holds a tool can do, as its client describes it. Zero where unknown. */
export const DeviceInfo = message("palpate.DeviceInfo.v1", "tool/{tool}/device", {
  /** Its name, at most 64 bytes, without control characters. */
  name: text,
  /** Directions in which it can push, 0 to 3. None, and none to turn: it has no motors, as a mouse. */
  dof_force: u8,
  /** Axes about which it can turn, 0 to 3. */
  dof_torque: u8,
  /** Box in which its tool can go, m. */
  workspace: vector,
  /** Greatest force, N. */
  force_max: f64,
  /** Greatest force that it can hold for long, N; at most `force_max`. */
  force_continuous: f64,
  /** Greatest torque, N·m. */
  torque_max: f64,
  /** Mass that the hand feels at its tool, kg. */
  mass: f64,
  /** Its own viscous damping, N·s/m. */
  damping: f64,
  /** Its own Coulomb friction, N. */
  coulomb_friction: f64,
  /** Step of its position sensor at the tool, m. */
  encoder_resolution: f64,
  /** Rate of its own loop, Hz. */
  rate_hz: f64,
  /** Delay between it and the daemon, one way, s. */
  delay_s: f64,
  /**
   * Relative change of the force below which a hand feels none (Weber fraction), 0 to 0.99; the daemon then leaves such
   * forces out. 0: every force is sent.
   */
  deadband: f64,
}, 180);
export type DeviceInfo = Of<typeof DeviceInfo>;

/** Full control net of a body, u-major. The next one replaces a lost one. */
export const ControlNet = message("palpate.ControlNet.v1", "body/{body}/net", {
  /** Tick it belongs to. */
  tick: u64,
  /** Grows with every change of the net. */
  revision: u64,
  /** Body id. */
  body: text,
  /** Degree in u. */
  degree_u: u8,
  /** Degree in v. */
  degree_v: u8,
  /** Rows (u). */
  count_u: u16,
  /** Columns (v). */
  count_v: u16,
  /** u-major: point (i, j) is number `i * count_v + j`, m. */
  points: points,
  /** Weights of a rational surface, same order. */
  weights: optional(numbers),
});
export type ControlNet = Of<typeof ControlNet>;

/** One contact of a tool with a body, or of two bodies. */
export const Contact = struct({
  /** Tool id; between two bodies, the id of the other body (the same one, when a body touches itself). */
  tool: text,
  /** Body id. */
  body: text,
  /** Surface parameter. */
  u: f64,
  /** Surface parameter. */
  v: f64,
  /** Point on the body's surface, m. */
  point: vector,
  /** Outward unit normal of the body. */
  normal: vector,
  /** Penetration depth of the device's tool, m; between bodies, what the contact solve left. */
  depth: f64,
  /** This contact's share of the force on the tool (or other body), N. */
  force: vector,
});
export type Contact = Value<typeof Contact>;

/** Contacts that carry force in a tick, the deepest: 16, or 2 per tool if that is more. */
export const ContactSet = message("palpate.ContactSet.v1", "contact", {
  /** Tick. */
  tick: u64,
  /** Deepest first. */
  contacts: list(Contact),
});
export type ContactSet = Of<typeof ContactSet>;

/** A duration over the last status period. */
export const Quantiles = struct({
  /** Median, ns. */
  p50_ns: u64,
  /** 99th percentile, ns. */
  p99_ns: u64,
  /** Maximum, ns. */
  max_ns: u64,
});
export type Quantiles = Value<typeof Quantiles>;

/** What the loop does. */
export const LoopState = choice(
  /** Ticking. */
  "Running",
  /** Paused by rpc. */
  "Paused",
  /** Ramping forces down before the end. */
  "Stopping",
);
export type LoopState = Value<typeof LoopState>;

/** Counters of one tool's link. */
export const ToolLink = struct({
  /** Tool id. */
  tool: text,
  /** Poses received and accepted by the wire. */
  received: u64,
  /** Poses that a newer one replaced before a tick could use them. */
  superseded: u64,
  /** Another type or version in the encoding's schema. */
  wrong_version: u64,
  /** Not the bytes of a pose: truncated, or with bytes after its end. */
  malformed: u64,
  /** More bytes than a pose can have. */
  oversized: u64,
  /** A value that is NaN or infinite. */
  not_finite: u64,
  /** A quaternion whose length is not 1 within 1e-6. */
  bad_quaternion: u64,
  /** The number of the newest pose once more. */
  duplicated: u64,
  /** A number below that of the newest pose. */
  out_of_order: u64,
  /** Refused by the loop as a jump. */
  jumps: u64,
  /** Ticks whose newest pose was stale. */
  stale_ticks: u64,
  /** Net work done by the hand on the tool so far, J. */
  energy_j: f64,
  /** Forces sent to whoever moves it. */
  forces_sent: u64,
  /** Forces that were not sent while somebody moved it, because a newer one was there: the daemon is short of time. */
  forces_overtaken: u64,
  /** Forces that were sent and did not arrive, as far as its clients say what they receive. */
  forces_lost: u64,
});
export type ToolLink = Value<typeof ToolLink>;

/** What is being recorded. */
export const RecorderState = choice(
  /** Nothing. */
  "Off",
  /** A file is being written. */
  "Recording",
  /** The last seconds are kept in memory; no file. */
  "Ring",
  /** The disk refused; what was flushed stays readable. */
  "Failed",
);
export type RecorderState = Value<typeof RecorderState>;

/** Health of the loop, ten times a second. */
export const LoopStatus = message("palpate.LoopStatus.v4", "status", {
  /** Newest tick. */
  tick: u64,
  /** What the loop does. */
  state: LoopState,
  /** Nominal rate, Hz. */
  rate_hz: f64,
  /** Ticks that began more than 100 µs after their deadline. */
  late_ticks: u64,
  /** Deadlines dropped because a tick overran them. */
  skipped_ticks: u64,
  /** Time between tick starts. */
  period: Quantiles,
  /** Time in a tick. */
  step: Quantiles,
  /** One per tool. */
  tools: list(ToolLink),
  /** What is being recorded. */
  recorder: RecorderState,
  /** Bytes written by the recorder. */
  recorder_bytes: u64,
  /** Records lost because the recorder could not keep up. */
  recorder_drops: u64,
  /**
   * 0 is full quality; 1: bodies iterate once a step; 2: also fewer sweeps over contacts; 3: also nets ten times rarer.
   */
  quality_level: u8,
  /** Tool whose poses the deadlines of ticks follow; empty: none. */
  followed_tool: text,
  /** How far deadlines have moved from the fixed grid of the first tick, s. */
  shift_s: f64,
  /** Time from the arrival of a pose to the tick that took it; of each tick the longest. */
  wait: Quantiles,
});
export type LoopStatus = Of<typeof LoopStatus>;

/** An event, numbered so that a loss is seen. */
export const SimEvent = message("palpate.SimEvent.v1", "event", {
  /** Tick. */
  tick: u64,
  /** Counts events from 1. */
  seq: u64,
  /** Server clock, ns since the Unix epoch. */
  t_ns: u64,
  /** What. */
  kind: EventKind,
});
export type SimEvent = Of<typeof SimEvent>;

/** A body as the loop simulates it. */
export const BodySnapshot = struct({
  /** Id. */
  id: text,
  /** Model name: `rigid`, `lattice`. */
  model: text,
  /** Degree, u then v. */
  degree: array(u8, 2),
  /** Periodic, u then v. */
  periodic: array(bool, 2),
  /** Knots in u and in v, in the convention of `palpate.surface.v1`. */
  knots: array(numbers, 2),
  /** Net size, u then v. */
  count: array(u16, 2),
  /** Net now, u-major, m. */
  points: points,
  /** Net at rest, u-major, m. */
  rest_points: points,
  /** Weights, if rational. */
  weights: optional(numbers),
  /** Revision of `points`. */
  revision: u64,
});
export type BodySnapshot = Value<typeof BodySnapshot>;

/** A tool of the scene. */
export const ToolSnapshot = struct({
  /** Id. */
  id: text,
  /** `point`, `sphere`, `plane`, `implicit`, `mesh` or `surface`. */
  shape: text,
  /** Radius of a sphere, else 0, m. */
  radius: f64,
  /** Stiffness of the virtual coupling, N/m (infinite: the tool is rigid). */
  stiffness: f64,
  /** Damping of the virtual coupling, N·s/m. */
  damping: f64,
  /** Greatest force, N. */
  force_max: f64,
  /** Proxy position now, m. */
  position: vector,
  /** x y z w. */
  orientation: quaternion,
});
export type ToolSnapshot = Value<typeof ToolSnapshot>;

/** Everything a late joiner needs. */
export const SceneSnapshot = message("palpate.SceneSnapshot.v1", "scene", {
  /** Tick. */
  tick: u64,
  /** SHA-256 of the scene file. */
  scene_hash: octets(32),
  /** Scene name. */
  scene_name: text,
  /** Length of a tick, ns. */
  dt_ns: u64,
  /** True when a tick waits for every tool's next pose. */
  lockstep: bool,
  /** Bodies. */
  bodies: list(BodySnapshot),
  /** Tools. */
  tools: list(ToolSnapshot),
});
export type SceneSnapshot = Of<typeof SceneSnapshot>;

/** All messages that have a name, for `decodeNamed`. */
export const MESSAGES = [
  ToolPose,
  ToolForce,
  ToolForceV2,
  ToolContact,
  DeviceInfo,
  ControlNet,
  ContactSet,
  LoopStatus,
  SimEvent,
  SceneSnapshot,
] as const;
