//! What is looked at while a body is held squeezed, and after it is let go.

use super::{Row, Setting, World, row};

/// For how long a body is held, in ticks, and in how many of the last of them it should be still.
pub(super) const HOLD: usize = 500;
const STILL: usize = 200;
/// For how long it is left alone afterwards, in ticks.
pub(super) const REST: usize = 1_500;
/// Bars: step of the force over the force, speed of a node, m/s, and what is left after the rest, m.
const MOST_STEP: f64 = 1e-3;
const MOST_M_S: f64 = 1e-3;
const MOST_AWAY_M: f64 = 1e-4;

/// What was seen of a body that is held.
#[derive(Default)]
pub(super) struct Held {
    forces_n: Vec<f64>,
    fastest_m_s: f64,
}

impl Held {
    /// Looks at tick `k` of [`HOLD`].
    pub(super) fn look(&mut self, k: usize, force_n: f64, world: &World) -> Result<(), String> {
        if k + STILL >= HOLD {
            self.forces_n.push(force_n);
            self.fastest_m_s = larger(self.fastest_m_s, fastest_m_s(world)?);
        }
        Ok(())
    }

    /// The force at the end, N.
    fn force_n(&self) -> f64 {
        self.forces_n.last().copied().unwrap_or_default()
    }

    /// Largest change of the force from tick to tick, N.
    fn step_n(&self) -> f64 {
        let pairs = self.forces_n.windows(2);
        pairs
            .map(|pair| (pair[1] - pair[0]).abs())
            .fold(0.0, larger)
    }

    /// A row, of a world that was let go and left alone.
    pub(super) fn row(self, case: &str, setting: Setting, world: &World) -> Result<Row, String> {
        let away_m = world.away_m()?;
        let step = self.step_n() / self.force_n().abs();
        let missed = [
            (step, MOST_STEP),
            (self.fastest_m_s, MOST_M_S),
            (away_m, MOST_AWAY_M),
        ];
        // What is not a number is missed too.
        let missed = missed
            .iter()
            .filter(|(value, most)| value.is_nan() || value > most)
            .count();
        let note = format!(
            "held at {:.3} N, step of the force {:.3} %, fastest node {:.3} mm/s; let go, {:.1} s later {:.4} mm from rest; {} faults",
            self.force_n(),
            step * 100.0,
            self.fastest_m_s * 1e3,
            REST as f64 * 1e-3,
            away_m * 1e3,
            world.faults,
        );
        Ok(Row {
            wrong: Some(missed + usize::from(world.faults > 0)),
            ..row(
                case,
                &setting.method(),
                world.ticks_s.clone(),
                (step, "of the held force, tick to tick"),
                note,
            )
        })
    }
}

/// The larger one; what is not a number stays.
pub(super) fn larger(most: f64, value: f64) -> f64 {
    if value > most || value.is_nan() {
        value
    } else {
        most
    }
}

fn fastest_m_s(world: &World) -> Result<f64, String> {
    let (_, state) = world.body()?;
    Ok(state.velocities.iter().map(|v| v.norm()).fold(0.0, larger))
}

/// Share of a way after a share of its time, without a jolt at either end.
pub(super) fn gently(share: f64) -> f64 {
    let t = share.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_a_number_is_the_largest() {
        assert!([1.0, f64::NAN, 2.0].into_iter().fold(0.0, larger).is_nan());
        assert_eq!([1.0, 3.0, 2.0].into_iter().fold(0.0, larger), 3.0);
    }

    #[test]
    fn steps_of_the_force_are_between_neighbours() {
        let held = Held {
            forces_n: vec![1.0, 1.5, 1.25],
            fastest_m_s: 0.0,
        };
        assert_eq!((held.step_n(), held.force_n()), (0.5, 1.25));
        assert_eq!([0.0, 0.5, 1.0, 2.0].map(gently), [0.0, 0.5, 1.0, 1.0]);
    }
}
