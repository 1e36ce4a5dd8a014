//! Velocities of devices that give positions only.

use crate::frame::v3;

/// Filters the differences of positions and orientations by a first-order low-pass, as drivers do.
#[derive(Clone, Debug)]
pub struct Differentiator {
    cutoff_hz: f64,
    last: Option<Sample>,
    velocity: [[f64; 3]; 2],
}

#[derive(Clone, Copy, Debug)]
struct Sample {
    position: [f64; 3],
    orientation: [f64; 4],
    time_ns: u64,
}

/// After a longer gap the velocity starts from zero, s.
const GAP_S: f64 = 0.1;

impl Differentiator {
    /// At rest. `cutoff_hz`: of the low-pass; infinite for plain differences.
    pub fn new(cutoff_hz: f64) -> Self {
        Self {
            cutoff_hz,
            last: None,
            velocity: [[0.0; 3]; 2],
        }
    }

    /// Linear and angular velocity (m/s, rad/s) after a sample. A sample with the time of the one
    /// before, or before it, leaves the velocity.
    pub fn sample(
        &mut self,
        position: [f64; 3],
        orientation: [f64; 4],
        time_ns: u64,
    ) -> [[f64; 3]; 2] {
        let now = Sample {
            position,
            orientation,
            time_ns,
        };
        let Some(last) = self.last.replace(now) else {
            return self.velocity;
        };
        let dt_s = time_ns.saturating_sub(last.time_ns) as f64 * 1e-9;
        if dt_s > GAP_S {
            self.velocity = [[0.0; 3]; 2];
        } else if dt_s > 0.0 {
            let linear = v3::scale(v3::sub(position, last.position), 1.0 / dt_s);
            let turned = v3::turn(orientation, v3::inverse(last.orientation));
            let angular = v3::scale(rotation_vector(turned), 1.0 / dt_s);
            let share = match self.cutoff_hz.is_finite() {
                true => 1.0 - (-std::f64::consts::TAU * self.cutoff_hz * dt_s).exp(),
                false => 1.0,
            };
            for (filtered, new) in self.velocity.iter_mut().zip([linear, angular]) {
                *filtered = v3::add(*filtered, v3::scale(v3::sub(new, *filtered), share));
            }
        }
        self.velocity
    }
}

/// Axis times angle, the shorter way round, rad.
fn rotation_vector(q: [f64; 4]) -> [f64; 3] {
    let q = if q[3] < 0.0 { q.map(|x| -x) } else { q };
    let part = [q[0], q[1], q[2]];
    let sine = v3::norm(part);
    let share = match sine < 1e-8 {
        true => 2.0,
        false => 2.0 * sine.atan2(q[3]) / sine,
    };
    v3::scale(part, share)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    #[test]
    fn a_steady_motion_has_its_velocity_whatever_the_rate() {
        for period_ns in [MS / 4, MS, 2 * MS, 10 * MS] {
            let mut velocity = Differentiator::new(100.0);
            let mut found = [[0.0; 3]; 2];
            for k in 0..=1_000_000_000 / period_ns {
                let t = (k * period_ns) as f64 * 1e-9;
                let turned = [0.0, 0.0, (0.25 * t).sin(), (0.25 * t).cos()];
                found = velocity.sample([0.3 * t, 0.0, 0.0], turned, k * period_ns);
            }
            assert!((found[0][0] - 0.3).abs() < 1e-9, "{found:?}");
            assert!((found[1][2] - 0.5).abs() < 1e-9, "{found:?}");
        }
    }

    #[test]
    fn repeated_times_and_gaps_make_no_spike() {
        let unit = [0.0, 0.0, 0.0, 1.0];
        let mut velocity = Differentiator::new(f64::INFINITY);
        velocity.sample([0.0; 3], unit, 5 * MS);
        assert_eq!(velocity.sample([1.0; 3], unit, 5 * MS), [[0.0; 3]; 2]);
        assert_eq!(velocity.sample([2.0; 3], unit, 4 * MS), [[0.0; 3]; 2]);
        assert_eq!(velocity.sample([3.0; 3], unit, 900 * MS), [[0.0; 3]; 2]);
    }
}
