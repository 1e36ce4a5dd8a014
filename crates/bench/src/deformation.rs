//! The deformation suite: forces of pressed bodies and what a step costs, for all models, methods,
//! grids and stiffnesses, and for other engines.
//!
//! The box of other engines' comparisons (0.1 m, bottom fixed, a ball of 30 mm pressed 10 mm deep
//! into the middle of its top) and the teardrop (a ball of 10 mm from the side), both at E = 20 kPa
//! against a converged neo-Hookean solid. A block of plasticine under forces and at stiffnesses as
//! in the thesis' figures 5.9 and 5.10. Bodies that move, against the exact step of the same
//! integrator.

mod cuts;
mod hard;
mod indent;
mod motion;
mod passes;
mod peers;
mod plasticine;
mod poking;
mod refit;
mod scaling;
mod scenes;
mod side_by_side;
mod svg;
mod theory;
mod world;

pub use hard::{HardRow, hard_cases, hard_table};
pub use motion::trust::{TrustRow, trust_table};
pub use plasticine::{Sweep, plasticine_picture, plasticine_table};
pub use scaling::scaling;
pub use svg::{latency_picture, pareto, trust_picture};

use super::{Cases, Effort, Row};
use scenes::{BoxCase, TeardropCase};

/// Force of the box's converged reference, N.
const BOX_REFERENCE_N: f64 = 5.25;
/// Forces of the teardrop's, N, at 1, 2, 3 and 4 mm.
const TEARDROP_REFERENCE_N: [f64; 4] = [0.0415, 0.1002, 0.1670, 0.2397];

/// How far forces are from those of the exact step, beside what their ticks say. Each row is handed out as soon as it
/// is measured.
///
/// # Errors
/// A scene that cannot be built.
pub fn trust(
    effort: Effort,
    cases: Cases<'_>,
    out: &mut dyn FnMut(TrustRow),
) -> Result<(), String> {
    motion::trust::rows(effort, &|case| cases.has(case), out)
}

/// From pose to force over Zenoh, beside steps of solvers alone, of the box of which all engines have a
/// reference. Each row is handed out as soon as it is measured.
pub fn whole_loop(effort: Effort, cases: Cases<'_>, out: &mut dyn FnMut(Row)) {
    let rows = [crate::suite::row_of("indent/12/x1", "*")];
    deformation(effort, Cases::Rows(&rows), &mut |row| {
        if cases.has(&row.case) {
            out(row);
        }
    });
}

/// Runs cases of the suite. Each row is handed out as soon as
/// it is measured. Gives what the plasticine did.
pub fn deformation(effort: Effort, cases: Cases<'_>, out: &mut dyn FnMut(Row)) -> Vec<Sweep> {
    let wanted = |case: &str| cases.has(case);
    // Long cases run when there is time, or when they are asked for by name.
    let in_time =
        |long: bool| !long || effort == Effort::Full || matches!(cases, Cases::Containing(_));
    for case in BoxCase::all() {
        let beside = format!("{}/{}/{}", case.group, case.model, case.method);
        if (wanted(&case.name) || wanted(&beside)) && in_time(case.long) {
            out(indent::box_row(&case, effort));
        }
        // Other programs than this one have no daemon in them.
        if case.name == "indent/12/continuum/x1" && cases.are_chosen() && wanted(&case.group) {
            out(indent::loop_row(&case, effort));
        }
    }
    peers::rows(
        effort,
        effort == Effort::Quick && !cases.are_chosen(),
        &wanted,
        out,
    );
    for case in TeardropCase::all() {
        if wanted(&case.name) {
            out(indent::teardrop_row(&case, effort));
        }
    }
    for (case, net) in [
        ("indent/teardrop/free", None),
        ("indent/teardrop/refit", Some([8, 8])),
        ("indent/teardrop/refit/13x13", Some([13, 13])),
    ] {
        if wanted(case) {
            out(indent::refit_row(case, net, effort));
        }
    }
    if wanted("tick/teardrop/default") {
        out(indent::default_tick_row("tick/teardrop/default", effort));
        indent::baseline_tick_row("tick/teardrop/default")
            .into_iter()
            .for_each(&mut *out);
    }
    for model in ["lattice", "continuum", "net"] {
        let case = format!("tick/teardrop/{model}");
        if wanted(&case) {
            out(indent::tick_row(&case, model, effort));
        }
    }
    if effort == Effort::Full || cases.are_chosen() {
        theory::rows(effort, &wanted, out);
    }
    motion::rows(effort, &wanted, out);
    poking::rows(effort, &wanted, out);
    cuts::cuts(effort, &wanted, out);
    passes::rows(effort, &wanted, out);
    plasticine::rows(effort, &wanted, out)
}
