//! What goes into a tick and what comes out: fixed size, `Copy`, no allocation.

use super::stage::StageTimes;
use crate::haptics::{DeviceBounds, DevicePose};
use crate::scene::spec::MAX_TOOLS;
use crate::solve::rows::Holder;
use palpate_geometry::math::{Point3, Rotation, Vector3};

/// Newly latched poses, by tool index; `None`: nothing new since the last tick. Poses here are
/// finite with unit quaternions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TickInput {
    /// (tool_count used of MAX_TOOLS).
    pub poses: [Option<DevicePose>; MAX_TOOLS],
}

/// A change between ticks, recorded with the tick before which it took effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// State back to the scene's start; the tick count goes on.
    Reset,
    /// Forces ramp to zero, bodies stand still.
    Pause,
    /// Go on.
    Resume,
    /// While paused: run this many ticks.
    Step(u32),
    /// A device told what it can bear; infinite where the scene alone decides.
    Device {
        /// Index of its tool.
        tool: u32,
        /// From now on.
        bounds: DeviceBounds,
    },
    /// Ramp forces to zero for good; the driver ends when they are there.
    Stop,
    /// Do less a tick, or again more: a level of [`crate::scene::quality`].
    Quality(u8),
}

/// A contact that carries force this tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactReport {
    /// Body index.
    pub body: u32,
    /// Who touches it.
    pub holder: Holder,
    /// Surface parameters.
    pub u: f64,
    /// Surface parameters.
    pub v: f64,
    /// Point on the surface, m.
    pub point: Point3,
    /// Outward unit normal.
    pub normal: Vector3,
    /// Penetration depth of the device's tool, m; between bodies, what the contact solve left.
    pub depth_m: f64,
    /// Force on the holder, N.
    pub force_n: Vector3,
}

/// Most contacts a tick reports.
pub const MAX_REPORTS: usize = 16;

/// The deepest contacts of a tick, deepest first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactReports {
    list: [ContactReport; MAX_REPORTS],
    len: usize,
}

impl Default for ContactReports {
    fn default() -> Self {
        let none = ContactReport {
            body: 0,
            holder: Holder::Tool(0),
            u: 0.0,
            v: 0.0,
            point: Point3::origin(),
            normal: Vector3::zeros(),
            depth_m: 0.0,
            force_n: Vector3::zeros(),
        };
        Self {
            list: [none; MAX_REPORTS],
            len: 0,
        }
    }
}

impl ContactReports {
    /// Keeps it in its place; the shallowest leaves a full list.
    pub(super) fn push(&mut self, report: ContactReport) {
        let at = self.list[..self.len].partition_point(|held| held.depth_m >= report.depth_m);
        if at == MAX_REPORTS {
            return;
        }
        self.len = (self.len + 1).min(MAX_REPORTS);
        self.list.copy_within(at..self.len - 1, at + 1);
        self.list[at] = report;
    }

    /// Deepest first.
    pub fn list(&self) -> &[ContactReport] {
        &self.list[..self.len]
    }
}

/// What a tool gets out of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolOutput {
    /// `seq` of the pose in effect, 0 before the first.
    pub pose_seq: u64,
    /// Its `t_client_ns`.
    pub t_client_ns: u64,
    /// Age of the pose in effect, ticks.
    pub pose_age_ticks: u32,
    /// Force for the device, N, world axes: what touches the tool, made passive and limited.
    pub force_n: Vector3,
    /// Torque for the device at the tool's reference point, N·m.
    pub torque_nm: Vector3,
    /// Force of all contacts on the tool, N: what a sensor between tool and body would read.
    pub contact_force_n: Vector3,
    /// Torque of all contacts about the tool's reference point, N·m.
    pub contact_torque_nm: Vector3,
    /// Proxy position, m.
    pub proxy_position: Point3,
    /// Proxy orientation.
    pub proxy_orientation: Rotation,
    /// Bits of `palpate_proto::messages::force_flags`.
    pub flags: u32,
    /// How far the device moved since the last tick, m; zero when it is newly seated.
    pub device_moved: Vector3,
    /// How far it turned, rad.
    pub device_turned: Vector3,
    /// Contact rows that carried force.
    pub contact_count: u32,
    /// Deepest contact.
    pub contact: Option<ContactReport>,
    /// Net work done by the device on the loop since the start, J; what is below zero, the loop has
    /// made.
    pub energy_j: f64,
    /// Part of it that the passivity controller took away, J.
    pub dissipated_j: f64,
}

impl Default for ToolOutput {
    fn default() -> Self {
        Self {
            pose_seq: 0,
            t_client_ns: 0,
            pose_age_ticks: 0,
            force_n: Vector3::zeros(),
            torque_nm: Vector3::zeros(),
            contact_force_n: Vector3::zeros(),
            contact_torque_nm: Vector3::zeros(),
            proxy_position: Point3::origin(),
            proxy_orientation: Rotation::identity(),
            flags: 0,
            device_moved: Vector3::zeros(),
            device_turned: Vector3::zeros(),
            contact_count: 0,
            contact: None,
            energy_j: 0.0,
            dissipated_j: 0.0,
        }
    }
}

/// What went wrong in a tick; the force was made safe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TickFault {
    /// A force or a state was not finite; the body was set back to rest.
    NotFinite,
}

/// What comes out of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TickOutput {
    /// Number of the tick, from 1.
    pub tick: u64,
    /// By tool index.
    pub tools: [ToolOutput; MAX_TOOLS],
    /// Contacts of all pairs. Recordings keep the deepest of each tool; a replay makes all of them
    /// again.
    pub contacts: ContactReports,
    /// Grows when any net changed.
    pub net_revision: u64,
    /// Hash of all state after the tick.
    pub state_hash: u64,
    /// Bodies moved in this tick (not paused, not stopping).
    pub moving: bool,
    /// Level of quality, 0 is full.
    pub quality: u8,
    /// What went wrong, if anything.
    pub fault: Option<TickFault>,
}

/// One tick for the journal: what was applied, what came out, and how long it took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TickRecord {
    /// What was applied.
    pub input: TickInput,
    /// What came out.
    pub output: TickOutput,
    /// How late it began, ns.
    pub late_ns: u64,
    /// Deadlines dropped before it.
    pub skipped: u32,
    /// Wall time of each stage, ns.
    pub stage_ns: StageTimes,
}
