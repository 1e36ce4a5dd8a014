//! Whether a body that lies on others stays where it is, though its contacts tremble.

use palpate_geometry::math::{Point3, Vector3};

/// Steps in a row without motion after which a body sleeps.
pub(crate) const STILL_STEPS: u32 = 100;

/// No node may be faster, in speeds below which a body that nothing touches sleeps: what is, is seen.
const TREMBLE: f64 = 1e5;

/// A body stays where it is if it is nowhere, on average, farther away after a hundred steps than this
/// many times that speed would carry it.
const DRIFT: f64 = 300.0;

/// Of the weight of a body that lies on others: how far its contact forces may be from bearing it.
pub(crate) const BORNE: f64 = 5e-3;

/// Still steps after which a body sleeps with the forces it has.
const LONG: u32 = 10 * STILL_STEPS;

/// How to see where the nodes of a body are on average, and how they are turned and stretched.
#[derive(Debug)]
pub(super) struct Outline {
    centre: Point3,
    /// One over (their number × their mean distance from the centre), 1/m.
    share: f64,
}

/// Centre, and what becomes of the axes of the rest state, with the length of the mean distance from
/// the centre, m.
pub(crate) type Moments = [Vector3; 4];

impl Outline {
    /// The outline of nodes at rest.
    pub fn new(rest: &[Point3]) -> Self {
        let count = rest.len().max(1) as f64;
        let sum: Vector3 = rest.iter().map(|x| x.coords).sum();
        let centre = Point3::from(sum / count);
        let squares: f64 = rest.iter().map(|x| (x - centre).norm_squared()).sum();
        Self {
            centre,
            share: 1.0 / (count * squares).sqrt().max(f64::MIN_POSITIVE),
        }
    }

    pub(super) fn moments(&self, rest: &[Point3], positions: &[Point3]) -> Moments {
        debug_assert_eq!(rest.len(), positions.len(), "a place a coordinate");
        let mut moments = [Vector3::zeros(); 4];
        for (r, x) in rest.iter().zip(positions) {
            let from = r - self.centre;
            moments[0] += x.coords;
            for (moment, share) in moments[1..].iter_mut().zip(from.iter()) {
                *moment += x.coords * *share;
            }
        }
        moments[0] /= rest.len().max(1) as f64;
        for moment in &mut moments[1..] {
            *moment *= self.share;
        }
        moments
    }
}

/// Since when a body stays where it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stillness {
    /// Where it was at the first of these steps: centre and axes, m.
    pub from: Moments,
    /// Body steps in a row, or [`LONG`] once a hundred of them have ended with forces in balance.
    pub steps: u32,
}

impl Stillness {
    /// It has stayed for long enough to sleep.
    pub fn is_long(&self) -> bool {
        self.steps >= LONG
    }

    /// Counts a step at whose end the body is `here`. `sleep_m_s` is the speed below which one sleeps that
    /// nothing touches; `fastest` is the speed of its fastest point, m/s; `balanced`: what bears the body
    /// bears its weight in this step, so that it may be left alone with these forces.
    pub(crate) fn count(
        &mut self,
        here: impl FnOnce() -> Moments,
        fastest: f64,
        balanced: bool,
        sleep_m_s: f64,
        dt_s: f64,
    ) {
        if !(sleep_m_s > 0.0 && fastest <= TREMBLE * sleep_m_s) {
            self.steps = 0;
            return;
        }
        let here = here();
        let most = DRIFT * sleep_m_s * f64::from(STILL_STEPS) * dt_s;
        let stays = |(a, b): (&Vector3, &Vector3)| (a - b).norm() <= most;
        if self.steps > 0 && self.from.iter().zip(&here).all(stays) {
            self.steps = match balanced && self.steps + 1 >= STILL_STEPS {
                true => LONG,
                false => (self.steps + 1).min(LONG),
            };
        } else {
            (self.from, self.steps) = (here, 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, Unit};
    use palpate_geometry::math::Random;

    fn cloud() -> Vec<Point3> {
        let mut random = Random(7);
        (0..200)
            .map(|_| Point3::from(random.vector() * 0.01))
            .collect()
    }

    /// Steps counted over a second of a motion, at sleep 1e-7 m/s and 1 ms.
    fn counted(motion: impl Fn(f64, &Point3, usize) -> Point3, fastest: f64) -> u32 {
        counted_in(1_000, true, motion, fastest)
    }

    fn counted_in(
        steps: u32,
        balanced: bool,
        motion: impl Fn(f64, &Point3, usize) -> Point3,
        fastest: f64,
    ) -> u32 {
        let rest = cloud();
        let outline = Outline::new(&rest);
        let mut stillness = Stillness::default();
        for k in 0..steps {
            let t = f64::from(k) * 1e-3;
            let now: Vec<_> = (0..rest.len()).map(|i| motion(t, &rest[i], i)).collect();
            stillness.count(
                || outline.moments(&rest, &now),
                fastest,
                balanced,
                1e-7,
                1e-3,
            );
        }
        stillness.steps
    }

    #[test]
    fn what_drifts_turns_or_stretches_is_not_calm_and_what_trembles_is() {
        let axis = Unit::new_normalize(Vector3::new(1.0, 2.0, -1.0));
        // 50 um/s, or 0.2 mm/s 10 mm from the axis.
        let drifts = |t: f64, x: &Point3, _: usize| x + axis.scale(5e-5 * t);
        let turns = |t: f64, x: &Point3, _: usize| Rotation3::from_axis_angle(&axis, 0.02 * t) * x;
        let stretches = |t: f64, x: &Point3, _: usize| x * (1.0 + 0.02 * t);
        assert!(counted(drifts, 5e-5) < STILL_STEPS);
        assert!(counted(turns, 2e-4) < STILL_STEPS);
        assert!(counted(stretches, 2e-4) < STILL_STEPS);
        // Single nodes by 3 um at 3 mm/s, in no common direction.
        let trembles = |t: f64, x: &Point3, i: usize| {
            let phase = (i * i) as f64 + t * 1e3;
            x + Vector3::new(phase.sin(), (2.0 * phase).cos(), (3.0 * phase).sin()) * 3e-6
        };
        assert_eq!(counted(trembles, 3e-3), LONG);
        // Forces out of balance are given more time, but not for ever.
        assert_eq!(counted_in(99, true, trembles, 3e-3), 99);
        assert_eq!(counted_in(100, true, trembles, 3e-3), LONG);
        assert_eq!(counted_in(999, false, trembles, 3e-3), 999);
        assert_eq!(counted_in(1_200, false, trembles, 3e-3), LONG);
        assert_eq!(counted(trembles, 0.1), 0);
        assert_eq!(counted(|_, x, _| *x, f64::NAN), 0);
    }
}
