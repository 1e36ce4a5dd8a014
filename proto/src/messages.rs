//! The messages of the bus. SI units; `f64`; quaternions are x y z w; times are nanoseconds.
//!
//! postcard has no field names and cannot evolve: a published struct is never edited. A change
//! makes a new type with a new version in its [`Message::NAME`]. Only [`EventKind`] may grow, at
//! its end: the number of a case stays, and who does not know a new one drops that event.

use serde::{Deserialize, Serialize};

pub use crate::device::DeviceInfo;

/// A type that travels on the bus, with the versioned name its encoding carries.
pub trait Message: Serialize + for<'de> Deserialize<'de> {
    /// Versioned type name, for example `palpate.ToolPose.v1`.
    const NAME: &'static str;
    /// Most bytes that one has: more are refused before they are read.
    const MAX_BYTES: usize = crate::codec::MAX_BYTES;
}

macro_rules! message {
    ($type:ty, $name:literal) => {
        impl Message for $type {
            const NAME: &'static str = $name;
        }
    };
}

/// Pose and velocity of a tool, sent by whoever holds it. World frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub struct ToolPose {
    /// Counts the poses of this client from 1; must grow.
    pub seq: u64,
    /// Sender's clock, ns; echoed in [`ToolForce`] so that the sender can measure its round trip.
    pub t_client_ns: u64,
    /// Reference point of the tool, m.
    pub position: [f64; 3],
    /// Unit quaternion x y z w.
    pub orientation: [f64; 4],
    /// m/s.
    pub linear_velocity: [f64; 3],
    /// rad/s.
    pub angular_velocity: [f64; 3],
    /// Bit 0: grab. While it is set, the tool holds on to what it touches.
    pub buttons: u32,
    /// Reserved, 0.
    pub flags: u32,
}

impl Message for ToolPose {
    const NAME: &'static str = "palpate.ToolPose.v1";
    // Two u64 and two u32 of at most 10 and 5 bytes, thirteen f64.
    const MAX_BYTES: usize = 2 * 10 + 13 * 8 + 2 * 5;
}

/// Bits of [`ToolForce::flags`].
pub mod force_flags {
    /// The newest pose is older than the stale limit; the force ramps to zero.
    pub const STALE: u32 = 1;
    /// The force was limited to what the device can bear.
    pub const SATURATED: u32 = 1 << 1;
    /// The simulation is paused.
    pub const PAUSED: u32 = 1 << 2;
    /// The last pose was refused (a jump, or not finite).
    pub const REFUSED: u32 = 1 << 3;
    /// The force is being ramped up or down.
    pub const RAMPING: u32 = 1 << 4;
    /// The tick met a fault; the force is safe, not right.
    pub const FAULT: u32 = 1 << 5;
    /// The tool holds on to what it grabbed.
    pub const GRABBING: u32 = 1 << 6;
    /// A damper was added to keep the loop from making energy.
    pub const DAMPED: u32 = 1 << 7;
}

/// The force a hand should feel: wrench on the tool, world axes, at the tool's reference point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub struct ToolForce {
    /// Tick that made it.
    pub tick: u64,
    /// `seq` of the pose that took effect (0: none yet).
    pub pose_seq: u64,
    /// `t_client_ns` of that pose.
    pub t_client_ns: u64,
    /// Server's clock when published, ns.
    pub t_server_ns: u64,
    /// N.
    pub force: [f64; 3],
    /// N·m.
    pub torque: [f64; 3],
    /// Where the surface holds the tool back, m.
    pub proxy_position: [f64; 3],
    /// x y z w.
    pub proxy_orientation: [f64; 4],
    /// Penetration of the device's tool into the surface, m; 0 without contact.
    pub depth: f64,
    /// Contact regions.
    pub contact_count: u16,
    /// [`force_flags`].
    pub flags: u32,
}
message!(ToolForce, "palpate.ToolForce.v1");

/// What all contacts do to a tool, before anything is limited for the device: what a sensor between
/// tool and body would read. World axes, at the tool's reference point. Sent while somebody
/// subscribes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub struct ToolContact {
    /// Tick that made it.
    pub tick: u64,
    /// `seq` of the pose that took effect (0: none yet).
    pub pose_seq: u64,
    /// `t_client_ns` of that pose.
    pub t_client_ns: u64,
    /// N.
    pub force: [f64; 3],
    /// N·m.
    pub torque: [f64; 3],
    /// Net work done by the device on the loop since the start, J; what is below zero, the loop has
    /// made.
    pub energy_j: f64,
    /// Part of it that the passivity controller took away, J.
    pub dissipated_j: f64,
    /// Greatest force that the loop gives this tool's device, N.
    pub force_limit: f64,
}
message!(ToolContact, "palpate.ToolContact.v1");

/// Full control net of a body, u-major. A lost one is mended by the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub struct ControlNet {
    /// Tick it belongs to.
    pub tick: u64,
    /// Grows with every change of the net.
    pub revision: u64,
    /// Body id.
    pub body: String,
    /// Degree in u.
    pub degree_u: u8,
    /// Degree in v.
    pub degree_v: u8,
    /// Rows (u).
    pub count_u: u16,
    /// Columns (v).
    pub count_v: u16,
    /// `count_u * count_v` points, u-major, m.
    pub points: Vec<[f64; 3]>,
    /// Weights of a rational surface, same order.
    pub weights: Option<Vec<f64>>,
}
message!(ControlNet, "palpate.ControlNet.v1");

/// One contact of a tool with a body, or of two bodies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub struct Contact {
    /// Tool id; between two bodies, the id of the other body (the same one, when a body touches
    /// itself).
    pub tool: String,
    /// Body id.
    pub body: String,
    /// Surface parameter.
    pub u: f64,
    /// Surface parameter.
    pub v: f64,
    /// Point on the body's surface, m.
    pub point: [f64; 3],
    /// Outward unit normal of the body.
    pub normal: [f64; 3],
    /// Penetration depth of the device's tool, m; between bodies, what the contact solve left.
    pub depth: f64,
    /// This contact's share of the force on the tool (or other body), N.
    pub force: [f64; 3],
}

/// Contacts that carry force in a tick, the deepest: at most sixteen, or two for each tool where
/// that is more.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub struct ContactSet {
    /// Tick.
    pub tick: u64,
    /// Deepest first.
    pub contacts: Vec<Contact>,
}
message!(ContactSet, "palpate.ContactSet.v1");

/// Median, 99th percentile and maximum of a duration over the last status period, ns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub struct Quantiles {
    /// Median.
    pub p50_ns: u64,
    /// 99th percentile.
    pub p99_ns: u64,
    /// Maximum.
    pub max_ns: u64,
}

/// What the loop does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub enum LoopState {
    /// Ticking.
    Running,
    /// Paused by rpc.
    Paused,
    /// Ramping forces down before the end.
    Stopping,
}

/// Counters of one tool's link.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub struct ToolLink {
    /// Tool id.
    pub tool: String,
    /// Poses received and accepted by the wire.
    pub received: u64,
    /// Poses that a newer one replaced before a tick could use them.
    pub superseded: u64,
    /// Another type or version in the encoding's schema.
    pub wrong_version: u64,
    /// Not the bytes of a pose: truncated, or with bytes after its end.
    pub malformed: u64,
    /// More bytes than a pose can have.
    pub oversized: u64,
    /// A value that is NaN or infinite.
    pub not_finite: u64,
    /// A quaternion whose length is not 1 within 1e-6.
    pub bad_quaternion: u64,
    /// The number of the newest pose once more.
    pub duplicated: u64,
    /// A number below that of the newest pose.
    pub out_of_order: u64,
    /// Refused by the loop as a jump.
    pub jumps: u64,
    /// Ticks whose newest pose was stale.
    pub stale_ticks: u64,
    /// Net work done by the hand on the tool so far, J.
    pub energy_j: f64,
}

impl ToolLink {
    /// Poses that never reached the loop, by cause.
    pub fn refused(&self) -> [(&'static str, u64); 7] {
        [
            ("wrong_version", self.wrong_version),
            ("malformed", self.malformed),
            ("oversized", self.oversized),
            ("not_finite", self.not_finite),
            ("bad_quaternion", self.bad_quaternion),
            ("duplicated", self.duplicated),
            ("out_of_order", self.out_of_order),
        ]
    }
}

/// What is being recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub enum RecorderState {
    /// Nothing.
    #[default]
    Off,
    /// A file is being written.
    Recording,
    /// The last seconds are kept in memory; no file.
    Ring,
    /// The disk refused; what was flushed stays readable.
    Failed,
}

/// Health of the loop, 10 Hz.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub struct LoopStatus {
    /// Newest tick.
    pub tick: u64,
    /// State.
    pub state: LoopState,
    /// Nominal rate, Hz.
    pub rate_hz: f64,
    /// Ticks that began more than 100 µs after their deadline.
    pub late_ticks: u64,
    /// Deadlines dropped because a tick overran them.
    pub skipped_ticks: u64,
    /// Time between tick starts.
    pub period: Quantiles,
    /// Time in a tick.
    pub step: Quantiles,
    /// One per tool.
    pub tools: Vec<ToolLink>,
    /// What is being recorded.
    pub recorder: RecorderState,
    /// Bytes written by the recorder.
    pub recorder_bytes: u64,
    /// Records lost because the recorder could not keep up.
    pub recorder_drops: u64,
    /// 0 is full quality; 1: bodies iterate once a step; 2: also fewer sweeps over contacts; 3:
    /// also nets ten times rarer.
    pub quality_level: u8,
}
message!(LoopStatus, "palpate.LoopStatus.v2");

/// What happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub enum EventKind {
    /// State set back to the scene's start.
    Reset,
    /// Loop paused.
    Paused,
    /// Loop resumed.
    Resumed,
    /// A tool sends poses.
    ToolJoined {
        /// Tool id.
        tool: String,
    },
    /// A tool's poses went stale or its token vanished.
    ToolLost {
        /// Tool id.
        tool: String,
    },
    /// A pose was refused.
    PoseRefused {
        /// Tool id.
        tool: String,
        /// Why.
        reason: String,
    },
    /// A tick met a fault.
    Fault {
        /// What and where.
        reason: String,
    },
    /// A recording began.
    RecordStarted {
        /// Path.
        path: String,
    },
    /// A recording ended.
    RecordStopped {
        /// Path.
        path: String,
    },
    /// The daemon is going down.
    Stopping,
    /// Ticks took longer than their period, or were woken too late: at most one such event a second
    /// for each stage.
    Overrun {
        /// Stage that took most of their time: `latch`, `render`, `deform`, `emit`; `wake`: the
        /// system came late.
        stage: String,
        /// How many since the last such event.
        count: u64,
        /// The longest of them, ns.
        worst_ns: u64,
    },
    /// The loop does less, or again more, to keep its rate.
    QualityChanged {
        /// As in [`LoopStatus::quality_level`].
        level: u8,
        /// Why.
        reason: String,
    },
    /// A device said what it can do.
    DeviceTold {
        /// Tool id.
        tool: String,
        /// Name of the device.
        name: String,
    },
    /// A recording could not go on; the loop does, and what was flushed stays readable.
    RecordFailed {
        /// Path.
        path: String,
        /// Words of the system.
        reason: String,
    },
    /// Another scene runs from this tick on: bodies were merged or moved. Ask for the scene anew.
    SceneChanged {
        /// What became of which bodies.
        what: String,
    },
}

/// An event, numbered so that a loss is seen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub struct SimEvent {
    /// Tick.
    pub tick: u64,
    /// Counts events from 1.
    pub seq: u64,
    /// Server clock, ns since the Unix epoch.
    pub t_ns: u64,
    /// What.
    pub kind: EventKind,
}
message!(SimEvent, "palpate.SimEvent.v1");

/// A body as the loop simulates it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub struct BodySnapshot {
    /// Id.
    pub id: String,
    /// Model name: `rigid`, `lattice`.
    pub model: String,
    /// Degree, u then v.
    pub degree: [u8; 2],
    /// Periodic, u then v.
    pub periodic: [bool; 2],
    /// Knots in u and in v, in the convention of `palpate.surface.v1`.
    pub knots: [Vec<f64>; 2],
    /// Net size, u then v.
    pub count: [u16; 2],
    /// Net now, u-major, m.
    pub points: Vec<[f64; 3]>,
    /// Net at rest, u-major, m.
    pub rest_points: Vec<[f64; 3]>,
    /// Weights, if rational.
    pub weights: Option<Vec<f64>>,
    /// Revision of `points`.
    pub revision: u64,
}

/// A tool of the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub struct ToolSnapshot {
    /// Id.
    pub id: String,
    /// `point`, `sphere`, `plane`, `implicit`, `mesh` or `surface`.
    pub shape: String,
    /// Radius of a sphere, else 0, m.
    pub radius: f64,
    /// Stiffness of the virtual coupling, N/m (infinite: the tool is rigid).
    pub stiffness: f64,
    /// Damping of the virtual coupling, N·s/m.
    pub damping: f64,
    /// Greatest force, N.
    pub force_max: f64,
    /// Proxy position now, m.
    pub position: [f64; 3],
    /// x y z w.
    pub orientation: [f64; 4],
}

/// Everything a late joiner needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(postcard_schema::Schema))]
pub struct SceneSnapshot {
    /// Tick.
    pub tick: u64,
    /// SHA-256 of the scene file.
    pub scene_hash: [u8; 32],
    /// Scene name.
    pub scene_name: String,
    /// Length of a tick, ns.
    pub dt_ns: u64,
    /// True when a tick waits for every tool's next pose.
    pub lockstep: bool,
    /// Bodies.
    pub bodies: Vec<BodySnapshot>,
    /// Tools.
    pub tools: Vec<ToolSnapshot>,
}
message!(SceneSnapshot, "palpate.SceneSnapshot.v1");
