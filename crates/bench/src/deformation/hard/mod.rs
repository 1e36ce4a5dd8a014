//! Cases on which solvers of deforming bodies are known to fail.
//!
//! Each runs ten thousand ticks and more, must stay finite without a fault, may not hold more energy
//! than was put in, and is checked by forces or places that are known, not only by surviving.

mod matter;
mod row;
mod slab;
#[cfg(test)]
mod tests;
mod touch;
mod upset;

use crate::Cases;
use row::Run;
pub use row::{HardRow, hard_table};

/// Model and time stepping method of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Kind {
    model: &'static str,
    method: &'static str,
}

const fn kind(model: &'static str, method: &'static str) -> Kind {
    Kind { model, method }
}

/// Solids that step implicitly.
const SOLIDS: &[Kind] = &[
    kind("lattice", "implicit"),
    kind("continuum", "implicit"),
    kind("net", "implicit"),
];
/// All solids with the implicit step, and lattice and continuum with the explicit one.
const ALL: &[Kind] = &[
    kind("lattice", "implicit"),
    kind("continuum", "implicit"),
    kind("net", "implicit"),
    kind("lattice", "explicit"),
    kind("continuum", "explicit"),
];
/// As [`ALL`] without the explicit continuum, which gains a fifth of the work done when it is squeezed flat.
const SQUEEZED: &[Kind] = &[
    kind("lattice", "implicit"),
    kind("continuum", "implicit"),
    kind("net", "implicit"),
    kind("lattice", "explicit"),
];
/// Bodies whose ν can be said.
const WITH_POISSON: &[Kind] = &[kind("continuum", "implicit"), kind("net", "implicit")];
/// Springs, the law that flows.
const SPRINGS: &[Kind] = &[kind("lattice", "implicit")];

/// A case: its name, what it is run with, and what it does and checks.
struct Case {
    name: &'static str,
    kinds: &'static [Kind],
    run: fn(Kind) -> Result<Run, String>,
}

const fn case(
    name: &'static str,
    kinds: &'static [Kind],
    run: fn(Kind) -> Result<Run, String>,
) -> Case {
    Case { name, kinds, run }
}

/// All cases, in the order of the table.
const CASES: &[Case] = &[
    case("moduli", SOLIDS, matter::moduli),
    case("plasticine", SPRINGS, matter::plasticine),
    case("ticks", SOLIDS, matter::ticks),
    case("densities", SOLIDS, matter::densities),
    case("coincident", ALL, upset::coincident),
    case("scrambled", WITH_POISSON, upset::scrambled),
    case("squeezed", SQUEEZED, upset::squeezed),
    case("jumps", SOLIDS, upset::jumps),
    case("two-tools", ALL, touch::two_tools),
    case("cone", ALL, touch::cone),
    case("corner", ALL, touch::corner),
    case("incompressible", WITH_POISSON, matter::incompressible),
    case("single-layer", ALL, matter::single_layer),
    case("own-weight", ALL, matter::own_weight),
    case("thousand-newtons", ALL, upset::thousand_newtons),
    case("slide", SOLIDS, touch::slide),
    case("ten-minutes", SOLIDS, touch::ten_minutes),
    case("hundred-bodies", SOLIDS, touch::hundred_bodies),
];

/// Cases that are known to be wrong, and why.
#[cfg(test)]
const KNOWN: &[(&str, &str)] = &[
    (
        "hard/hundred-bodies/net/implicit",
        "slabs that a tool has left creep at more than 0.1 µm/s for seconds, so that nine of a hundred are awake",
    ),
    (
        "hard/own-weight/lattice/implicit",
        "flat cells of springs sag more than twice as far as a free column of the material",
    ),
    (
        "hard/own-weight/lattice/explicit",
        "the same equilibrium as that of the implicit step",
    ),
];

/// Runs the cases whose names, `hard/CASE/MODEL/METHOD`, contain `only`; each row is handed out as
/// soon as it is there.
pub fn hard_cases(cases: Cases<'_>, out: &mut dyn FnMut(HardRow)) {
    for case in CASES {
        for &kind in case.kinds {
            let name = format!("hard/{}/{}/{}", case.name, kind.model, kind.method);
            if cases.has(&name) {
                out(row(name, case, kind));
            }
        }
    }
}

fn row(name: String, case: &Case, kind: Kind) -> HardRow {
    match (case.run)(kind).and_then(Run::done) {
        Ok(row) => HardRow { case: name, ..row },
        Err(why) => HardRow::refused(name, why),
    }
}
