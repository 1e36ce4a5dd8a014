//! The last word on what a hand feels.

use palpate_geometry::math::Vector3;

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

/// Scales a wrench so that its force is at most `limit_n`; the torque is then brought down to
/// `limit_nm` on its own, because a device without motors for it (0 N·m) still pushes. Also gives
/// the factor of the force: the body must be loaded with the same share, or hand and body would not
/// feel equal and opposite forces. What is not finite becomes zero with factor 0.
pub fn limit(
    force_n: Vector3,
    torque_nm: Vector3,
    limit_n: f64,
    limit_nm: f64,
) -> (RenderedForce, f64) {
    let (size, turn) = (force_n.norm(), torque_nm.norm());
    if !(size.is_finite() && turn.is_finite() && limit_n > 0.0 && limit_nm >= 0.0) {
        return (RenderedForce::default(), 0.0);
    }
    let factor = if size <= limit_n { 1.0 } else { limit_n / size };
    let turn_factor = if turn * factor <= limit_nm {
        factor
    } else {
        limit_nm / turn
    };
    (
        RenderedForce {
            newtons: force_n * factor,
            torque_nm: torque_nm * turn_factor,
        },
        factor,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rendered_force_is_finite_and_within_the_limit_whatever_comes_in() {
        let wild = [
            0.0,
            -0.0,
            1.0,
            -3.0,
            1e300,
            f64::MAX,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
            1e-310,
        ];
        for x in wild {
            for y in wild {
                for limit_n in wild {
                    for limit_nm in wild {
                        let (force, factor) = limit(
                            Vector3::new(x, y, 0.5),
                            Vector3::new(y, 0.0, x),
                            limit_n,
                            limit_nm,
                        );
                        let bound = |limit: f64| {
                            if limit > 0.0 {
                                limit * (1.0 + 1e-15)
                            } else {
                                0.0
                            }
                        };
                        let (size, turn) = (force.newtons().norm(), force.torque_nm().norm());
                        assert!(
                            size.is_finite() && size <= bound(limit_n),
                            "({x}, {y}) gives {size} over {limit_n}"
                        );
                        assert!(
                            turn.is_finite() && turn <= bound(limit_nm),
                            "({x}, {y}) gives {turn} over {limit_nm}"
                        );
                        assert!((0.0..=1.0).contains(&factor));
                    }
                }
            }
        }
    }

    #[test]
    fn a_device_without_torque_keeps_its_force() {
        let (rendered, factor) = limit(Vector3::new(0.0, 3.0, 0.0), Vector3::z(), 10.0, 0.0);
        assert_eq!(
            (rendered.newtons().y, rendered.torque_nm(), factor),
            (3.0, Vector3::zeros(), 1.0)
        );
        let (rendered, factor) = limit(Vector3::new(0.0, 20.0, 0.0), Vector3::z(), 10.0, 0.3);
        assert_eq!(
            (rendered.newtons().y, rendered.torque_nm().z, factor),
            (10.0, 0.3, 0.5)
        );
    }
}
