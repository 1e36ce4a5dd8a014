//! What goes into a tick and what comes out, as large as the scene has tools.
//!
//! Lists are made once, for a number of tools, and filled again every tick: copies between two of
//! the same scene (`clone_from`) allocate nothing.

pub use super::by_tool::{Absent, ByTool};
use super::stage::StageTimes;
use crate::haptics::{DeviceBounds, DevicePose};
use crate::in_place::clone_in_place;
use crate::solve::rows::Holder;
use palpate_geometry::math::{Point3, Rotation, Vector3};

/// What a tick is given. The default is an input without news, for any scene.
#[derive(Debug, Default, PartialEq)]
pub struct TickInput {
    /// Finite, with unit quaternions; `None`: nothing new since the last tick.
    pub poses: ByTool<Option<DevicePose>>,
    /// Deadlines of a loop in real time that were dropped before this tick. Poses age by them, and forces fade:
    /// no one's force acts longer because a loop cannot keep its rate.
    pub skipped: u32,
}

impl TickInput {
    /// Without news, with room for so many tools.
    pub fn for_tools(tool_count: usize) -> Self {
        Self {
            poses: ByTool::for_tools(tool_count),
            skipped: 0,
        }
    }
}

clone_in_place!(TickInput { poses, skipped });

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
    /// What a device can bear, as reported; infinite where the scene alone decides.
    Device {
        /// Index of its tool.
        tool: u32,
        /// From now on.
        bounds: DeviceBounds,
    },
    /// Ramp forces to zero for good; the driver ends when they are there.
    Stop,
    /// Do less a tick, or again more: a level of [`crate::tick::quality`].
    Quality(u8),
    /// The next tick neither begins nor takes over a step of a body that steps once in several ticks:
    /// whoever does the step is late ([`late_step`](super::late_step)).
    PutOff {
        /// Index of the body.
        body: u32,
    },
    /// A rigid body that can move goes to a place, from rest to rest, and stays there; until a reset
    /// neither its motion nor its tool moves it any more.
    Send {
        /// Index of the body.
        body: u32,
        /// Origin of its frame, m.
        position: Point3,
        /// Of its frame.
        rotation: Rotation,
        /// In so many ticks, or in more where that would be faster than 10 m/s or 100 rad/s.
        ticks: u32,
    },
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

/// Most contacts reported per tick, where there are few tools.
const FEW_REPORTS: usize = 16;
/// Most contacts reported per tick and tool, where there are many tools.
const REPORTS_PER_TOOL: usize = 2;

/// The deepest contacts of a tick, deepest first: 16, or 2 for each tool where that is more.
#[derive(Debug, Default, PartialEq)]
pub struct ContactReports {
    list: Vec<ContactReport>,
}

impl Clone for ContactReports {
    fn clone(&self) -> Self {
        // With its room: a copy is filled as the first one was.
        let mut list = Vec::with_capacity(self.list.capacity());
        list.extend_from_slice(&self.list);
        Self { list }
    }

    fn clone_from(&mut self, from: &Self) {
        self.list.clone_from(&from.list);
    }
}

impl ContactReports {
    fn most(tool_count: usize) -> usize {
        FEW_REPORTS.max(REPORTS_PER_TOOL * tool_count)
    }

    fn for_tools(tool_count: usize) -> Self {
        Self {
            list: Vec::with_capacity(Self::most(tool_count)),
        }
    }

    /// Keeps it in its place; the shallowest leaves a list that is full for a scene of so many
    /// tools.
    pub(crate) fn push(&mut self, report: ContactReport, tool_count: usize) {
        let at = self
            .list
            .partition_point(|held| held.depth_m >= report.depth_m);
        let most = Self::most(tool_count);
        if at == most {
            return;
        }
        self.list.truncate(most - 1);
        self.list.insert(at, report);
    }

    /// Deepest first.
    pub fn list(&self) -> &[ContactReport] {
        &self.list
    }
}

/// What a tool gets out of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolOutput {
    /// `seq` of the pose that this tick answers: the one in effect (0 before the first), or that of a
    /// refused pose in the tick that refuses it ([`flags::REFUSED`](super::flags::REFUSED)).
    pub pose_seq: u64,
    /// Its `t_client_ns`.
    pub t_client_ns: u64,
    /// Age of the pose in effect, ticks.
    pub pose_age_ticks: u32,
    /// Force for the device, N, world axes: what touches the tool, made passive and limited.
    pub force_n: Vector3,
    /// Torque for the device at the tool's reference point, N·m.
    pub torque_nm: Vector3,
    /// How far that force may be from the one that the exact step of the same length would give from the same state,
    /// N: an estimate, 0 on rigid bodies.
    pub error_n: f64,
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
            error_n: 0.0,
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
    /// A body was no body of a material any more, and was set back to rest: [`TickFault::MOST_STRETCHED`] times
    /// as long as at rest, or faster than [`TickFault::MOST_SPEED_M_S`].
    CameApart {
        /// Its index.
        body: u32,
    },
}

impl TickFault {
    /// A body this many times longer than at rest has come apart: no material of ours is stretched so far.
    pub const MOST_STRETCHED: f64 = 20.0;
    /// Nor does a body that a hand meets go so fast, m/s: a body that falls freely does after 50 km.
    pub const MOST_SPEED_M_S: f64 = 1_000.0;

    /// What went wrong, for people; `body` is what to call the body of that index.
    pub fn said(self, body: impl FnOnce(usize) -> String) -> String {
        let (stretched, speed) = (Self::MOST_STRETCHED, Self::MOST_SPEED_M_S);
        match self {
            Self::NotFinite => "a state was not finite; the body was set back to rest".to_owned(),
            Self::CameApart { body: index } => format!(
                "body {} has come apart ({stretched} times as long as at rest, or faster than {speed} m/s) and was set back to \
                 rest: its contacts or materials are beyond what the solver holds",
                body(index as usize)
            ),
        }
    }
}

/// What comes out of a tick.
#[derive(Debug, Default, PartialEq)]
pub struct TickOutput {
    /// Number of the tick, from 1.
    pub tick: u64,
    /// What each tool gets.
    pub tools: ByTool<ToolOutput>,
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

impl TickOutput {
    /// Before the first tick, with room for so many tools.
    pub fn for_tools(tool_count: usize) -> Self {
        Self {
            tools: ByTool::for_tools(tool_count),
            contacts: ContactReports::for_tools(tool_count),
            ..Self::default()
        }
    }

    /// Nothing has come out yet. Allocates nothing where there is room for as many tools.
    pub(super) fn clear(&mut self, tool_count: usize) {
        let Self {
            tick,
            tools,
            contacts,
            net_revision,
            state_hash,
            moving,
            quality,
            fault,
        } = self;
        tools.reset(tool_count);
        contacts.list.clear();
        contacts.list.reserve(ContactReports::most(tool_count));
        (*tick, *net_revision, *state_hash) = (0, 0, 0);
        (*moving, *quality, *fault) = (false, 0, None);
    }
}

clone_in_place!(TickOutput {
    tick,
    tools,
    contacts,
    net_revision,
    state_hash,
    moving,
    quality,
    fault,
});

/// One tick for the journal: what was applied, what came out, and how long it took.
#[derive(Debug, Default, PartialEq)]
pub struct TickRecord {
    /// What was applied.
    pub input: TickInput,
    /// What came out.
    pub output: TickOutput,
    /// How late it began, ns.
    pub late_ns: u64,
    /// How much later it was due than on the fixed grid of the first tick, ns: deadlines that follow a device move.
    pub shift_ns: i64,
    /// How long the pose waited that waited longest of those the tick took, ns; none where it took none.
    pub wait_ns: Option<u64>,
    /// Wall time of each stage, ns.
    pub stage_ns: StageTimes,
}

impl TickRecord {
    /// Before the first tick, with room for so many tools.
    pub fn for_tools(tool_count: usize) -> Self {
        Self {
            input: TickInput::for_tools(tool_count),
            output: TickOutput::for_tools(tool_count),
            ..Self::default()
        }
    }
}

clone_in_place!(TickRecord {
    input,
    output,
    late_ns,
    shift_ns,
    wait_ns,
    stage_ns
});

#[cfg(test)]
mod tests {
    use super::*;

    fn report(depth_m: f64) -> ContactReport {
        ContactReport {
            body: 0,
            holder: Holder::Tool(0),
            u: 0.0,
            v: 0.0,
            point: Point3::origin(),
            normal: Vector3::zeros(),
            depth_m,
            force_n: Vector3::zeros(),
        }
    }

    #[test]
    fn the_deepest_contacts_stay_deepest_first() {
        for (tools, most) in [(1, 16), (8, 16), (9, 18), (64, 128)] {
            let mut reports = ContactReports::for_tools(tools);
            let room = reports.list.capacity();
            for k in 0..400 {
                reports.push(report(f64::from(k * 37 % 400)), tools);
            }
            let depths: Vec<f64> = reports.list().iter().map(|held| held.depth_m).collect();
            let expected: Vec<f64> = (0..most).map(|k| 399.0 - f64::from(k)).collect();
            assert_eq!(depths, expected);
            assert_eq!(reports.list.capacity(), room, "the list grew");
        }
    }
}
