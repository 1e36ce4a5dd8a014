//! What a pose may be, and poses that a program makes up.

use crate::decode_error::PoseError;
use crate::messages::ToolPose;

impl ToolPose {
    /// The pose with its quaternion brought to unit length.
    ///
    /// # Errors
    /// Values that are not finite, or a quaternion whose length is not 1 within 1e-6.
    pub fn validated(mut self) -> Result<Self, PoseError> {
        let seq = self.seq;
        let parts = [
            &self.position[..],
            &self.orientation,
            &self.linear_velocity,
            &self.angular_velocity,
        ];
        if parts.iter().any(|part| part.iter().any(|x| !x.is_finite())) {
            return Err(PoseError::NotFinite { seq });
        }
        let norm = self.orientation.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (norm - 1.0).abs() > 1e-6 {
            return Err(PoseError::Quaternion { seq, norm });
        }
        for x in &mut self.orientation {
            *x /= norm;
        }
        Ok(self)
    }
}

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
