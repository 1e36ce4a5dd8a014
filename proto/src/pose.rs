//! Poses that a program makes up.

use crate::messages::ToolPose;

/// A pose at rest at a place, unrotated. Its `seq` and time are set when it is sent.
pub fn pose_at(position: [f64; 3]) -> ToolPose {
    ToolPose {
        seq: 0,
        t_client_ns: 0,
        position,
        orientation: [0.0, 0.0, 0.0, 1.0],
        linear_velocity: [0.0; 3],
        angular_velocity: [0.0; 3],
        buttons: 0,
        flags: 0,
    }
}
