//! The handle's orientation: an inertia, alike about every axis, on the hand's torsional spring and
//! damper.
//!
//! The spring turns about the axis of the whole rotation between handle and goal; the motion of
//! that rotation vector is taken as linear over a step, which is exact about a fixed axis and right
//! to first order in the angle otherwise.

use super::hand::Goal;
use super::oscillator::Propagator;
use super::v3;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spin {
    pub(super) orientation: [f64; 4],
    pub(super) angular_velocity: [f64; 3],
}

/// What holds the handle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grasp {
    pub(super) inertia_kg_m2: f64,
    pub(super) damping_nm_s: f64,
    pub(super) torsion_nm: f64,
    pub(super) torsion_damping_nm_s: f64,
}

impl Spin {
    /// One period under a constant torque; the goal is where the hand wants the handle in the
    /// middle of it.
    pub(super) fn step(&mut self, grasp: &Grasp, goal: &Goal, torque_nm: [f64; 3], period_s: f64) {
        let inertia = grasp.inertia_kg_m2;
        let alpha = (grasp.damping_nm_s + grasp.torsion_damping_nm_s) / (2.0 * inertia);
        let propagator = Propagator::new(alpha, grasp.torsion_nm / inertia, period_s);
        // The goal at the begin of the period, turning at its rate.
        let back = v3::from_vector(v3::scale(goal.angular_velocity, -0.5 * period_s));
        let start = v3::turn(back, v3::unit(goal.orientation));
        let offset = v3::to_vector(v3::turn(self.orientation, v3::inverse(start)));
        let mut way = [0.0; 3];
        for c in 0..3 {
            let rate = goal.angular_velocity[c];
            let a = (torque_nm[c] - grasp.damping_nm_s * rate) / inertia;
            let (angle, spin) = propagator.step(offset[c], self.angular_velocity[c] - rate, a);
            way[c] = angle - offset[c] + rate * period_s;
            self.angular_velocity[c] = spin + rate;
        }
        self.orientation = v3::unit(v3::turn(v3::from_vector(way), self.orientation));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRASP: Grasp = Grasp {
        inertia_kg_m2: 2e-4,
        damping_nm_s: 1e-3,
        torsion_nm: 0.5,
        torsion_damping_nm_s: 9e-3,
    };

    #[test]
    fn about_one_axis_it_swings_as_the_closed_form_says() {
        let turned = v3::from_vector([0.0, 0.3, 0.0]);
        let mut spin = Spin {
            orientation: turned,
            angular_velocity: [0.0; 3],
        };
        let (decay, kappa): (f64, f64) = (1e-2 / 4e-4, 0.5 / 2e-4);
        let omega = (kappa - decay * decay).sqrt();
        for k in 1..=200 {
            spin.step(&GRASP, &Goal::at([0.0; 3]), [0.0; 3], 1e-3);
            let t = f64::from(k) * 1e-3;
            let exact =
                0.3 * (-decay * t).exp() * ((omega * t).cos() + decay / omega * (omega * t).sin());
            assert!(
                (v3::to_vector(spin.orientation)[1] - exact).abs() < 1e-13,
                "{k}"
            );
        }
    }

    #[test]
    fn a_held_torque_turns_it_by_torque_over_stiffness_from_any_goal() {
        let goal = Goal {
            orientation: v3::from_vector([1.0, -0.5, 2.0]),
            ..Goal::at([0.0; 3])
        };
        let mut spin = Spin {
            orientation: v3::UNTURNED,
            angular_velocity: [0.0; 3],
        };
        let torque = [0.02, 0.01, -0.03];
        for _ in 0..3_000 {
            spin.step(&GRASP, &goal, torque, 1e-3);
        }
        let offset = v3::to_vector(v3::turn(spin.orientation, v3::inverse(goal.orientation)));
        assert!(
            v3::norm(v3::sub(offset, v3::scale(torque, 2.0))) < 1e-12,
            "{offset:?}"
        );
        assert!(v3::norm(spin.angular_velocity) < 1e-11);
    }

    #[test]
    fn a_turning_goal_is_followed_behind_by_what_the_devices_damping_costs() {
        let rate = 2.0;
        let mut spin = Spin {
            orientation: v3::UNTURNED,
            angular_velocity: [0.0; 3],
        };
        let period = 1e-3;
        for k in 0..2_000 {
            let middle = (f64::from(k) + 0.5) * period;
            let orientation = v3::from_vector([0.0, 0.0, rate * middle]);
            let goal = Goal {
                orientation,
                angular_velocity: [0.0, 0.0, rate],
                ..Goal::at([0.0; 3])
            };
            spin.step(&GRASP, &goal, [0.0; 3], period);
        }
        let there = v3::from_vector([0.0, 0.0, rate * 2.0]);
        let behind = v3::to_vector(v3::turn(spin.orientation, v3::inverse(there)))[2];
        assert!((behind + 1e-3 * rate / 0.5).abs() < 1e-12, "{behind}");
        assert!((spin.angular_velocity[2] - rate).abs() < 1e-9);
    }
}
