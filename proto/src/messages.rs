//! The messages of the bus. SI units; `f64`; quaternions are x y z w; times are nanoseconds.
//!
//! This table is the only place where a message is written down. Types, encoding, keys and schema
//! come from it, and `cargo run -p palpate-proto --example generate` writes the modules of clients
//! in Python, TypeScript and C.
//!
//! postcard has no field names and cannot evolve: a published struct is never edited. A change
//! makes a new type with a new version in its [`Message::NAME`]. Only [`EventKind`] may grow, at
//! its end: the number of a case stays, and who does not know a new one drops that event.

pub use crate::layout::Message;
use serde::{Deserialize, Serialize};

/// Longest name of a device, bytes.
pub(crate) const DEVICE_NAME_BYTES: usize = 64;

crate::layout::messages! {
    /// Pose and velocity of a tool, sent by whoever holds it. World frame.
    message ToolPose: Copy = "palpate.ToolPose.v1" on "tool/{tool}/pose" as Motion,
        // Two u64 and two u32 of at most 10 and 5 bytes, thirteen f64.
        at most (2 * 10 + 13 * 8 + 2 * 5)
    {
        /// Counts the poses of this client from 1; must grow.
        seq: u64,
        /// Sender's clock, ns; echoed in [`ToolForce`] so that the sender can measure its round trip.
        t_client_ns: u64,
        /// Reference point of the tool, m.
        position: [f64; 3],
        /// Unit quaternion x y z w.
        orientation: [f64; 4],
        /// m/s.
        linear_velocity: [f64; 3] = left out,
        /// rad/s.
        angular_velocity: [f64; 3] = left out,
        /// Bit 0: grab. While it is set, the tool holds on to what it touches.
        buttons: u32 = left out,
        /// Reserved, 0.
        flags: u32 = left out,
    }

    /// Bits of `buttons` of [`ToolPose`].
    flags Buttons in buttons, bare {
        /// While it is set, the tool holds on to what it touches.
        GRAB = 0,
    }

    /// Bits of `flags` of [`ToolForce`].
    flags ForceFlags in force_flags {
        /// The newest pose is older than the stale limit; the force ramps to zero.
        STALE = 0,
        /// The force was limited to what the device can bear.
        SATURATED = 1,
        /// The simulation is paused.
        PAUSED = 2,
        /// The last pose was refused (a jump, or not finite).
        REFUSED = 3,
        /// The force is being ramped up or down.
        RAMPING = 4,
        /// The tick met a fault; the force is safe, not right.
        FAULT = 5,
        /// The tool holds on to what it grabbed.
        GRABBING = 6,
        /// A damper was added to keep the loop from making energy.
        DAMPED = 7,
        /// No force: the tool was seated inside a body, and its contact force was not small once since then.
        WITHHELD = 8,
        /// The force is less accurate than the scene asks for: the step of a body that the tool presses fell back
        /// to another matrix or was shortened, quality is lowered, or the force may be off by more than 5 % and
        /// 0.02 N.
        DEGRADED = 9,
    }

    /// The force a hand should feel: wrench on the tool, world axes, at the tool's reference point.
    message ToolForce: Copy = "palpate.ToolForce.v1" on "tool/{tool}/force" as Motion {
        /// Tick that made it.
        tick: u64,
        /// `seq` of the pose that took effect (0: none yet).
        pose_seq: u64,
        /// `t_client_ns` of that pose.
        t_client_ns: u64,
        /// Server's clock when published, ns.
        t_server_ns: u64,
        /// N.
        force: [f64; 3],
        /// N·m.
        torque: [f64; 3],
        /// Where the surface holds the tool back, m.
        proxy_position: [f64; 3],
        /// x y z w.
        proxy_orientation: [f64; 4],
        /// Penetration of the device's tool into the surface, m; 0 without contact.
        depth: f64,
        /// Contact regions.
        contact_count: u16,
        /// [`ForceFlags`](force_flags).
        flags: u32,
    }

    /// [`ToolForce`], and how far it may be off. Sent while somebody subscribes.
    message ToolForceV2: Copy = "palpate.ToolForce.v2" on "tool/{tool}/force_v2" as Motion {
        /// Tick that made it.
        tick: u64,
        /// `seq` of the pose that took effect (0: none yet).
        pose_seq: u64,
        /// `t_client_ns` of that pose.
        t_client_ns: u64,
        /// Server's clock when published, ns.
        t_server_ns: u64,
        /// N.
        force: [f64; 3],
        /// N·m.
        torque: [f64; 3],
        /// Where the surface holds the tool back, m.
        proxy_position: [f64; 3],
        /// x y z w.
        proxy_orientation: [f64; 4],
        /// Penetration of the device's tool into the surface, m; 0 without contact.
        depth: f64,
        /// Contact regions.
        contact_count: u16,
        /// [`ForceFlags`](force_flags).
        flags: u32,
        /// How far the force may be from the one that the exact step of the same length would give from the same
        /// state, N: an estimate, 0 on rigid bodies.
        error_n: f64,
        /// Reserved for the force on a jaw, N or N·m; 0.
        jaw_force: f64 = left out,
    }

    /// What all contacts do to a tool, before anything is limited for the device: what a sensor between
    /// tool and body would read. World axes, at the tool's reference point. Sent while somebody
    /// subscribes.
    message ToolContact: Copy = "palpate.ToolContact.v1" on "tool/{tool}/contact" as Motion {
        /// Tick that made it.
        tick: u64,
        /// `seq` of the pose that took effect (0: none yet).
        pose_seq: u64,
        /// `t_client_ns` of that pose.
        t_client_ns: u64,
        /// N.
        force: [f64; 3],
        /// N·m.
        torque: [f64; 3],
        /// Net work done by the device on the loop since the start, J; what is below zero, the loop has
        /// made.
        energy_j: f64,
        /// Part of it that the passivity controller took away, J.
        dissipated_j: f64,
        /// Greatest force that the loop gives this tool's device, N.
        force_limit: f64,
    }

    /// What the device that holds a tool can do, as its client describes it. Zero where unknown.
    message DeviceInfo = "palpate.DeviceInfo.v1" on "tool/{tool}/device" as Announcement,
        // A count of at most 10 bytes, the name, two u8, thirteen f64.
        at most (10 + DEVICE_NAME_BYTES + 2 + 13 * 8)
    {
        /// Its name, at most 64 bytes, without control characters.
        name: String,
        /// Directions in which it can push, 0 to 3. None, and none to turn: it has no motors, as a mouse.
        dof_force: u8 = left out,
        /// Axes about which it can turn, 0 to 3.
        dof_torque: u8 = left out,
        /// Box in which its tool can go, m.
        workspace: [f64; 3] = left out,
        /// Greatest force, N.
        force_max: f64 = left out,
        /// Greatest force that it can hold for long, N; at most `force_max`.
        force_continuous: f64 = left out,
        /// Greatest torque, N·m.
        torque_max: f64 = left out,
        /// Mass that the hand feels at its tool, kg.
        mass: f64 = left out,
        /// Its own viscous damping, N·s/m.
        damping: f64 = left out,
        /// Its own Coulomb friction, N.
        coulomb_friction: f64 = left out,
        /// Step of its position sensor at the tool, m.
        encoder_resolution: f64 = left out,
        /// Rate of its own loop, Hz.
        rate_hz: f64 = left out,
        /// Delay between it and the daemon, one way, s.
        delay_s: f64 = left out,
        /// Relative change of the force below which a hand feels none (Weber fraction), 0 to
        /// 0.99; the daemon then leaves such forces out. 0: every force is sent.
        deadband: f64 = left out,
    }

    /// Full control net of a body, u-major. The next one replaces a lost one.
    message ControlNet = "palpate.ControlNet.v1" on "body/{body}/net" as Net {
        /// Tick it belongs to.
        tick: u64,
        /// Grows with every change of the net.
        revision: u64,
        /// Body id.
        body: String,
        /// Degree in u.
        degree_u: u8,
        /// Degree in v.
        degree_v: u8,
        /// Rows (u).
        count_u: u16,
        /// Columns (v).
        count_v: u16,
        /// u-major: point (i, j) is number `i * count_v + j`, m.
        points: Vec<[f64; 3]>,
        /// Weights of a rational surface, same order.
        weights: Option<Vec<f64>> = left out,
    }

    /// One contact of a tool with a body, or of two bodies.
    struct Contact {
        /// Tool id; between two bodies, the id of the other body (the same one, when a body touches
        /// itself).
        tool: String,
        /// Body id.
        body: String,
        /// Surface parameter.
        u: f64,
        /// Surface parameter.
        v: f64,
        /// Point on the body's surface, m.
        point: [f64; 3],
        /// Outward unit normal of the body.
        normal: [f64; 3],
        /// Penetration depth of the device's tool, m; between bodies, what the contact solve left.
        depth: f64,
        /// This contact's share of the force on the tool (or other body), N.
        force: [f64; 3],
    }

    /// Contacts that carry force in a tick, the deepest: 16, or 2 per tool if that is more.
    message ContactSet = "palpate.ContactSet.v1" on "contact" as Health {
        /// Tick.
        tick: u64,
        /// Deepest first.
        contacts: Vec<Contact>,
    }

    /// A duration over the last status period.
    struct Quantiles: Copy + Default + Eq {
        /// Median, ns.
        p50_ns: u64,
        /// 99th percentile, ns.
        p99_ns: u64,
        /// Maximum, ns.
        max_ns: u64,
    }

    /// What the loop does.
    choice LoopState: Copy + Eq {
        /// Ticking.
        Running,
        /// Paused by rpc.
        Paused,
        /// Ramping forces down before the end.
        Stopping,
    }

    /// Counters of one tool's link.
    struct ToolLink: Default {
        /// Tool id.
        tool: String,
        /// Poses received and accepted by the wire.
        received: u64,
        /// Poses that a newer one replaced before a tick could use them.
        superseded: u64,
        /// Another type or version in the encoding's schema.
        wrong_version: u64,
        /// Not the bytes of a pose: truncated, or with bytes after its end.
        malformed: u64,
        /// More bytes than a pose can have.
        oversized: u64,
        /// A value that is NaN or infinite.
        not_finite: u64,
        /// A quaternion whose length is not 1 within 1e-6.
        bad_quaternion: u64,
        /// The number of the newest pose once more.
        duplicated: u64,
        /// A number below that of the newest pose.
        out_of_order: u64,
        /// Refused by the loop as a jump.
        jumps: u64,
        /// Ticks whose newest pose was stale.
        stale_ticks: u64,
        /// Net work done by the hand on the tool so far, J.
        energy_j: f64,
        /// Forces sent to whoever moves it.
        forces_sent: u64,
        /// Forces that were not sent while somebody moved it, because a newer one was there: the daemon is
        /// short of time.
        forces_overtaken: u64,
        /// Forces that were sent and did not arrive, as far as its clients say what they receive.
        forces_lost: u64,
    }

    /// What is being recorded.
    choice RecorderState: Copy + Eq {
        /// Nothing.
        Off,
        /// A file is being written.
        Recording,
        /// The last seconds are kept in memory; no file.
        Ring,
        /// The disk refused; what was flushed stays readable.
        Failed,
    }

    /// Health of the loop, ten times a second.
    message LoopStatus = "palpate.LoopStatus.v4" on "status" as Health {
        /// Newest tick.
        tick: u64,
        /// What the loop does.
        state: LoopState,
        /// Nominal rate, Hz.
        rate_hz: f64,
        /// Ticks that began more than 100 µs after their deadline.
        late_ticks: u64,
        /// Deadlines dropped because a tick overran them.
        skipped_ticks: u64,
        /// Time between tick starts.
        period: Quantiles,
        /// Time in a tick.
        step: Quantiles,
        /// One per tool.
        tools: Vec<ToolLink>,
        /// What is being recorded.
        recorder: RecorderState,
        /// Bytes written by the recorder.
        recorder_bytes: u64,
        /// Records lost because the recorder could not keep up.
        recorder_drops: u64,
        /// 0 is full quality; 1: bodies iterate once a step; 2: also fewer sweeps over contacts; 3:
        /// also nets ten times rarer.
        quality_level: u8,
        /// Tool whose poses the deadlines of ticks follow; empty: none.
        followed_tool: String,
        /// How far deadlines have moved from the fixed grid of the first tick, s.
        shift_s: f64,
        /// Time from the arrival of a pose to the tick that took it; of each tick the longest.
        wait: Quantiles,
    }

    /// What happened.
    choice EventKind {
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
        /// No pose of a tool came for so long that the last one is stale.
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
            /// Stage that took most of their time: `latch`, `render`, `deform`, `hash`, `emit`; `wake`: the
            /// system came late.
            stage: String,
            /// How many since the last such event.
            count: u64,
            /// The longest of them, ns.
            worst_ns: u64,
        },
        /// The loop does less, or again more, to keep its rate.
        QualityChanged {
            /// As `quality_level` of [`LoopStatus`].
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
        /// A tool was seated inside a body: it gives no force until its contact force has been small once.
        ForceWithheld {
            /// Tool id.
            tool: String,
        },
        /// A tool's force is less accurate than the scene asks for, from now on.
        ForceDegraded {
            /// Tool id.
            tool: String,
            /// What is done instead.
            reason: String,
        },
        /// A tool's force is as accurate as the scene asks for again.
        ForceRestored {
            /// Tool id.
            tool: String,
            /// In how many ticks it was not.
            ticks: u64,
        },
    }

    /// An event, numbered so that a loss is seen.
    message SimEvent = "palpate.SimEvent.v1" on "event" as Event {
        /// Tick.
        tick: u64,
        /// Counts events from 1.
        seq: u64,
        /// Server clock, ns since the Unix epoch.
        t_ns: u64,
        /// What.
        kind: EventKind,
    }

    /// A body as the loop simulates it.
    struct BodySnapshot {
        /// Id.
        id: String,
        /// Model name: `rigid`, `lattice`.
        model: String,
        /// Degree, u then v.
        degree: [u8; 2],
        /// Periodic, u then v.
        periodic: [bool; 2],
        /// Knots in u and in v, in the convention of `palpate.surface.v1`.
        knots: [Vec<f64>; 2],
        /// Net size, u then v.
        count: [u16; 2],
        /// Net now, u-major, m.
        points: Vec<[f64; 3]>,
        /// Net at rest, u-major, m.
        rest_points: Vec<[f64; 3]>,
        /// Weights, if rational.
        weights: Option<Vec<f64>>,
        /// Revision of `points`.
        revision: u64,
    }

    /// A tool of the scene.
    struct ToolSnapshot {
        /// Id.
        id: String,
        /// `point`, `sphere`, `plane`, `implicit`, `mesh` or `surface`.
        shape: String,
        /// Radius of a sphere, else 0, m.
        radius: f64,
        /// Stiffness of the virtual coupling, N/m (infinite: the tool is rigid).
        stiffness: f64,
        /// Damping of the virtual coupling, N·s/m.
        damping: f64,
        /// Greatest force, N.
        force_max: f64,
        /// Proxy position now, m.
        position: [f64; 3],
        /// x y z w.
        orientation: [f64; 4],
    }

    /// Everything a late joiner needs.
    message SceneSnapshot = "palpate.SceneSnapshot.v1" on "scene" as Answer {
        /// Tick.
        tick: u64,
        /// SHA-256 of the scene file.
        scene_hash: [u8; 32],
        /// Scene name.
        scene_name: String,
        /// Length of a tick, ns.
        dt_ns: u64,
        /// True when a tick waits for every tool's next pose.
        lockstep: bool,
        /// Bodies.
        bodies: Vec<BodySnapshot>,
        /// Tools.
        tools: Vec<ToolSnapshot>,
    }
}

// The table that makes the enum takes no attributes on its variants.
#[allow(clippy::derivable_impls)]
impl Default for RecorderState {
    fn default() -> Self {
        Self::Off
    }
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
