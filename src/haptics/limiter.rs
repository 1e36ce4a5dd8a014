//! The last word on what a hand feels.

use crate::math::Vector3;

/// A force the hand may feel: finite and within the limit. Only [`limit`] makes one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderedForce {
    newtons: Vector3,
    torque_nm: Vector3,
}

impl RenderedForce {
    /// N, world axes.
    pub fn newtons(&self) -> Vector3 {
        self.newtons
    }

    /// N·m at the tool's reference point, world axes.
    pub fn torque_nm(&self) -> Vector3 {
        self.torque_nm
    }
}

/// Scales a wrench so that its force is at most `limit_n`. Also gives the factor: the body must be loaded with the same
/// share, or hand and body would not feel equal and opposite forces. What is not finite becomes zero with factor 0.
pub fn limit(force_n: Vector3, torque_nm: Vector3, limit_n: f64) -> (RenderedForce, f64) {
    let size = force_n.norm();
    let torque_finite = torque_nm.iter().all(|x| x.is_finite());
    if !(size.is_finite() && torque_finite && limit_n > 0.0) {
        return (RenderedForce::default(), 0.0);
    }
    if size <= limit_n {
        return (RenderedForce { newtons: force_n, torque_nm }, 1.0);
    }
    let factor = limit_n / size;
    (RenderedForce { newtons: force_n * factor, torque_nm: torque_nm * factor }, factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rendered_force_is_finite_and_within_the_limit_whatever_comes_in() {
        let wild = [0.0, -0.0, 1.0, -3.0, 1e300, f64::MAX, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e-310];
        for x in wild {
            for y in wild {
                for limit_n in wild {
                    let (force, factor) = limit(Vector3::new(x, y, 0.5), Vector3::new(y, 0.0, x), limit_n);
                    let size = force.newtons().norm();
                    let bound = if limit_n > 0.0 { limit_n } else { 0.0 };
                    assert!(size.is_finite() && size <= bound * (1.0 + 1e-15), "({x}, {y}) gives {size} over {bound}");
                    assert!((0.0..=1.0).contains(&factor));
                }
            }
        }
    }
}
