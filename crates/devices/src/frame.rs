//! From a device's frame to the world: `world = translation + rotation (scale · device)`.

/// Three-vectors and quaternions (x y z w), as arrays.
pub(crate) mod v3 {
    pub(crate) fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
    }

    pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    }

    pub(crate) fn scale(a: [f64; 3], s: f64) -> [f64; 3] {
        a.map(|x| x * s)
    }

    pub(crate) fn norm(a: [f64; 3]) -> f64 {
        (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt()
    }

    fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    }

    /// A vector turned by a unit quaternion.
    pub(crate) fn rotate(q: [f64; 4], v: [f64; 3]) -> [f64; 3] {
        let axis = [q[0], q[1], q[2]];
        let twice = scale(cross(axis, v), 2.0);
        add(add(v, scale(twice, q[3])), cross(axis, twice))
    }

    /// First `b`, then `a`.
    pub(crate) fn turn(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        let [ax, ay, az, aw] = a;
        let [bx, by, bz, bw] = b;
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ]
    }

    pub(crate) fn inverse(q: [f64; 4]) -> [f64; 4] {
        [-q[0], -q[1], -q[2], q[3]]
    }

    /// Of length 1; `None` for one that has no direction.
    pub(crate) fn unit(q: [f64; 4]) -> Option<[f64; 4]> {
        let size = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        (size > 0.0 && size.is_finite()).then(|| q.map(|x| x / size))
    }
}

/// A figure of a frame that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// The scale.
    #[error("a scale is between 0.001 and 1000, not {0}")]
    Scale(f64),
    /// The rotation.
    #[error("a rotation is a unit quaternion x y z w; the length of {0:?} is not 1 within 1e-3")]
    Rotation([f64; 4]),
    /// The translation.
    #[error("a translation has three finite numbers in m, not {0:?}")]
    Translation([f64; 3]),
}

/// Where a device's frame lies in the world, and how much its motions grow.
///
/// Forces are turned back and not scaled: what the tool feels, the hand feels. With a scale above 1 the
/// contact is thereby stiffer in the hand by that factor, below 1 softer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    scale: f64,
    rotation: [f64; 4],
    translation: [f64; 3],
}

impl Default for Frame {
    /// The world's own.
    fn default() -> Self {
        Self {
            scale: 1.0,
            rotation: [0.0, 0.0, 0.0, 1.0],
            translation: [0.0; 3],
        }
    }
}

impl Frame {
    /// Checks the figures: scale (1), rotation of the device's axes (unit quaternion x y z w), place
    /// of its origin (m).
    ///
    /// # Errors
    /// A figure that cannot be.
    pub fn new(scale: f64, rotation: [f64; 4], translation: [f64; 3]) -> Result<Self, FrameError> {
        if !(1e-3..=1e3).contains(&scale) {
            return Err(FrameError::Scale(scale));
        }
        let size = rotation.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (size - 1.0).abs().is_nan() || (size - 1.0).abs() > 1e-3 {
            return Err(FrameError::Rotation(rotation));
        }
        if !translation.iter().all(|x| x.is_finite()) {
            return Err(FrameError::Translation(translation));
        }
        // A rotation that is none changes no bit.
        let rotation = match rotation {
            [0.0, 0.0, 0.0, 1.0] => rotation,
            _ => rotation.map(|x| x / size),
        };
        Ok(Self {
            scale,
            rotation,
            translation,
        })
    }

    fn turns(&self) -> bool {
        self.rotation != [0.0, 0.0, 0.0, 1.0]
    }

    fn direction(&self, v: [f64; 3]) -> [f64; 3] {
        if self.turns() {
            v3::rotate(self.rotation, v)
        } else {
            v
        }
    }

    /// A place of the device in the world.
    pub fn position(&self, position: [f64; 3]) -> [f64; 3] {
        let turned = self.direction(v3::scale(position, self.scale));
        match self.translation {
            // Adding zero would lose the sign of a negative zero.
            [0.0, 0.0, 0.0] => turned,
            translation => v3::add(translation, turned),
        }
    }

    /// A linear velocity of the device in the world.
    pub fn linear(&self, velocity: [f64; 3]) -> [f64; 3] {
        self.direction(v3::scale(velocity, self.scale))
    }

    /// An angular velocity of the device in the world: not scaled.
    pub fn angular(&self, velocity: [f64; 3]) -> [f64; 3] {
        self.direction(velocity)
    }

    /// An orientation of the device in the world.
    pub fn orientation(&self, orientation: [f64; 4]) -> [f64; 4] {
        if self.turns() {
            v3::turn(self.rotation, orientation)
        } else {
            orientation
        }
    }

    /// A force or torque of the world in the device's axes.
    pub fn back(&self, force: [f64; 3]) -> [f64; 3] {
        if self.turns() {
            v3::rotate(v3::inverse(self.rotation), force)
        } else {
            force
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worlds_own_frame_changes_no_bit() {
        let frame = Frame::default();
        let odd = [-0.0, 0.1 + 0.2, 1e-300];
        for mapped in [frame.position(odd), frame.linear(odd), frame.back(odd)] {
            assert_eq!(mapped.map(f64::to_bits), odd.map(f64::to_bits));
        }
    }

    #[test]
    fn forces_do_the_same_work_on_both_sides_up_to_the_scale() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let frame = Frame::new(3.0, [half, 0.0, 0.0, half], [0.1, 0.2, 0.3]).unwrap();
        let (velocity, force) = ([0.1, -0.2, 0.3], [1.0, 2.0, -3.0]);
        let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (world, device) = (
            dot(frame.linear(velocity), force),
            dot(velocity, frame.back(force)),
        );
        assert!((world - 3.0 * device).abs() < 1e-14, "{world} {device}");
        // A quarter about x takes y to z.
        let moved = frame.position([0.0, 1.0, 0.0]);
        let expected = [0.1, 0.2, 3.3];
        assert!(v3::norm(v3::sub(moved, expected)) < 1e-14, "{moved:?}");
    }

    #[test]
    fn figures_that_cannot_be_are_refused() {
        let unit = [0.0, 0.0, 0.0, 1.0];
        for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                Frame::new(scale, unit, [0.0; 3]),
                Err(FrameError::Scale(_))
            ));
        }
        for rotation in [[0.0; 4], [1.0; 4], [f64::NAN; 4]] {
            let refused = Frame::new(1.0, rotation, [0.0; 3]);
            assert!(matches!(refused, Err(FrameError::Rotation(_))));
        }
        assert!(Frame::new(1.0, unit, [f64::NAN, 0.0, 0.0]).is_err());
    }
}
