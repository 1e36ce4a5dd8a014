//! A simulated device with a hand on it, for programs that look for hardware.

use palpate_client::device::{Motion, SimulatedDevice};
use palpate_client::proto::messages::ToolPose;

/// A device and what its hand does, one servo period at a time.
pub struct SimulatedHand {
    device: SimulatedDevice,
    motion: Motion,
    dt_s: f64,
}

impl SimulatedHand {
    /// At rest where the motion begins.
    pub fn new(device: SimulatedDevice, motion: Motion) -> Self {
        Self {
            dt_s: 1.0 / device.model().rate_hz,
            device,
            motion,
        }
    }

    /// Servo period, s.
    pub fn dt_s(&self) -> f64 {
        self.dt_s
    }

    /// A period under a force (N, N·m); gives what the device reports after it.
    pub fn step(&mut self, force: [f64; 3], torque: [f64; 3]) -> ToolPose {
        let goal = self.motion.goal(self.device.time_s() + 0.5 * self.dt_s);
        self.device
            .advance_with_torque(goal, force, torque, self.dt_s);
        self.pose()
    }

    /// What the device reports now.
    pub fn pose(&self) -> ToolPose {
        ToolPose {
            buttons: self.motion.buttons(self.device.time_s()),
            ..self.device.pose()
        }
    }

    /// Greatest force of the motors, N.
    pub fn force_max_n(&self) -> f64 {
        self.device.model().force_max_n
    }
}
