//! The deformation suite: forces of pressed bodies and what a step costs, for all models, methods, grids and stiffnesses.
//!
//! The box of other engines' comparisons (0.1 m, bottom fixed, a ball of 30 mm pressed 10 mm deep into the middle of its
//! top) and the teardrop (a ball of 10 mm from the side), both at E = 20 kPa against a converged neo-Hookean solid.

mod indent;
mod passes;
mod scenes;

pub use super::contact::picture as pareto;

use super::{Effort, Row};
use scenes::{BoxCase, TeardropCase};

/// Force of the box's converged reference, N.
const BOX_REFERENCE_N: f64 = 5.25;
/// Forces of the teardrop's, N, at 1, 2, 3 and 4 mm.
const TEARDROP_REFERENCE_N: [f64; 4] = [0.0450, 0.1045, 0.1720, 0.2461];

/// Runs the suite; `only` keeps the cases whose names contain it. Each row is handed out as soon as it is measured.
pub fn deformation(effort: Effort, only: Option<&str>, out: &mut dyn FnMut(Row)) {
    let wanted = |case: &str| only.is_none_or(|part| case.contains(part));
    for case in BoxCase::all(effort) {
        if wanted(&case.name) {
            out(indent::box_row(&case));
        }
    }
    for case in TeardropCase::all() {
        if wanted(&case.name) {
            out(indent::teardrop_row(&case));
        }
    }
    for model in ["lattice", "net"] {
        let case = format!("tick/teardrop/{model}");
        if wanted(&case) {
            out(indent::tick_row(&case, model, effort));
        }
    }
    passes::rows(effort, &wanted, out);
}
