//! Bodies that move: how far our step of few iterations is from the exact step of the same
//! integrator, and from theory.
//!
//! Everything at steps of 1 ms. Errors are of paths: the root of the mean square of the difference
//! over all ticks, over the amplitude or the peak force.

mod beam;
mod drop;
mod free;
mod frequency;
mod held;
mod jelly;
mod jump;
mod path;
mod poke;
mod press;
mod ring;
mod ringdown;
mod squeeze;
mod touching;
pub(in crate::deformation) mod trust;

use super::world::World;
use super::{Effort, Row};
use crate::Times;

/// Units of errors that are errors of a motion.
pub(super) const UNITS: [&str; 3] = ["of the amplitude", "of the peak force", "of the height"];

/// A number of iterations, and their matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Setting {
    iterations: usize,
    matrix: &'static str,
}

impl Setting {
    const fn auto(iterations: usize) -> Self {
        Self {
            iterations,
            matrix: "auto",
        }
    }

    fn method(&self) -> String {
        match self.matrix {
            "auto" => format!("palpate {} it", self.iterations),
            matrix => format!("palpate {} it, {matrix}", self.iterations),
        }
    }

    /// `integrator = { … }` of a body that does not sleep.
    fn text(&self) -> String {
        let Self { iterations, matrix } = self;
        format!(
            "integrator = {{ sleep_m_s = 0.0, iterations = {iterations}, matrix = \"{matrix}\" }}"
        )
    }
}

const SETTINGS: [Setting; 4] = [
    Setting::auto(1),
    Setting::auto(2),
    Setting::auto(3),
    Setting {
        iterations: 1,
        matrix: "bounding",
    },
];
/// Where our step has converged.
const CONVERGED: usize = 40;

/// All rows of bodies that move.
pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    ringdown::rows(effort, wanted, out);
    ring::rows(effort, wanted, out);
    press::rows(effort, wanted, out);
    squeeze::rows(effort, wanted, out);
    poke::rows(effort, wanted, out);
    jump::rows(effort, wanted, out);
    free::rows(effort, wanted, out);
    jelly::rows(wanted, out);
    frequency::rows(effort, wanted, out);
}

/// A row with an error of a motion.
fn row(
    case: &str,
    method: &str,
    ticks_s: Vec<f64>,
    (error, unit): (impl Into<Option<f64>>, &'static str),
    note: String,
) -> Row {
    let row = Row::new("deformation", case, method).timed(Times::of(ticks_s));
    row.off_by(error, unit).saying(note)
}

/// A row that says why there is none.
fn failed(case: &str, method: &str, why: &str) -> Row {
    Row::new("deformation", case, method).saying(why)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(only: &str) -> Vec<Row> {
        let mut found = Vec::new();
        rows(Effort::Quick, &|case| case == only, &mut |row| {
            found.push(row)
        });
        found
    }

    #[test]
    fn a_stiff_beam_of_one_iteration_swings_within_two_per_cent_of_the_exact_step() {
        let rows = measured("motion/ringdown/lattice/2e6");
        assert_eq!(rows.len(), SETTINGS.len(), "{rows:?}");
        let error = |method: &str| {
            rows.iter()
                .find(|row| row.method == method)
                .and_then(Row::error_size)
        };
        assert!(
            error("palpate 1 it").is_some_and(|error| error < 0.02),
            "{rows:?}"
        );
        assert!(
            error("palpate 3 it").is_some_and(|error| error < 1e-3),
            "{rows:?}"
        );
        // A scalar matrix above every tangent moves soft modes too little.
        let bounding = error("palpate 1 it, bounding");
        assert!(bounding.is_some_and(|error| error > 0.2), "{rows:?}");
        assert!(rows[0].note.contains("after 5 swings"), "{}", rows[0].note);
    }

    #[test]
    fn the_exact_step_of_a_bar_swings_with_backward_euler_s_frequency() {
        let rows = measured("motion/frequency/bar/continuum");
        assert_eq!(rows.len(), 3 * SETTINGS.len());
        let third = rows.iter().find(|row| row.case.ends_with("/3"));
        // Mode 3 with three iterations: half a per cent is the dispersion of twenty cells.
        let converged = rows.iter().filter(|row| row.method == "palpate 3 it");
        assert!(
            converged.clone().all(|row| row.error_size() < Some(0.015)),
            "{third:?}"
        );
    }

    // Bounces, jelly and presses run for a minute: `palpate-bench bars` runs them.
    #[test]
    fn a_spin_gives_a_row_for_each_setting_without_a_refusal() {
        let rows = measured("motion/spin/lattice");
        assert_eq!(rows.len(), SETTINGS.len(), "{rows:?}");
        assert!(rows.iter().all(|row| row.times.is_some()), "{rows:?}");
    }
}
