//! The one interface of all devices: poses in, forces out, stale means zero.

use std::time::Duration;

/// What a device says of itself, in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// m.
    pub position: [f64; 3],
    /// Unit quaternion x y z w.
    pub orientation: [f64; 4],
    /// Linear and angular velocity, m/s and rad/s, when the device measures them.
    pub velocity: Option<[[f64; 3]; 2]>,
    /// Bit k: button k is down.
    pub buttons: u32,
    /// Time of the measurement on the device's clock, ns; of the arrival when the device gives none.
    pub time_ns: u64,
}

/// Whether a device is to render forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Forces are rendered.
    Active,
    /// Nothing is to be rendered, for this reason.
    Resting(Rest),
}

/// Why a device rests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rest {
    /// No pose of the device for too long.
    Stale,
    /// No force of the simulation for too long.
    Silent,
    /// The simulation is paused.
    Paused,
    /// A tick failed.
    Fault,
    /// The connection ends.
    Stopped,
}

/// What a device's motors are to do, in the device's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// N.
    pub force: [f64; 3],
    /// N·m.
    pub torque: [f64; 3],
    /// Resting: both are zero.
    pub state: State,
    /// When the force was computed, ns since 1970.
    pub time_ns: u64,
}

impl Command {
    /// No force, for a reason.
    pub fn rest(why: Rest, time_ns: u64) -> Self {
        Self {
            force: [0.0; 3],
            torque: [0.0; 3],
            state: State::Resting(why),
            time_ns,
        }
    }
}

/// What the simulation says to a tool, in the world's frame: the part of `ToolForce` that devices
/// need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolAnswer {
    /// Tick that computed it.
    pub tick: u64,
    /// N.
    pub force: [f64; 3],
    /// N·m.
    pub torque: [f64; 3],
    /// When it was sent, ns since 1970.
    pub time_ns: u64,
    /// The pose in use is too old.
    pub stale: bool,
    /// The simulation is paused.
    pub paused: bool,
    /// A tick failed.
    pub fault: bool,
    /// Forces have stopped coming, and this one has faded away.
    pub silent: bool,
}

/// A device, whatever it speaks. Each is one file: how readings come, and how commands go.
pub trait DeviceEnd {
    /// Why the connection is of no more use.
    type Error;

    /// The next reading; `None` when there is none within `patience`.
    ///
    /// # Errors
    /// The device is gone.
    fn reading(&mut self, patience: Duration) -> Result<Option<Reading>, Self::Error>;

    /// Passes a command to the motors. A command that rests must leave the device without force,
    /// whatever came before.
    ///
    /// # Errors
    /// The device is gone.
    fn apply(&mut self, command: &Command) -> Result<(), Self::Error>;
}
