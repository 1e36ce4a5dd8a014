//! All promises.

use super::Field::{
    ApartFrom, Error, ErrorOver, Excess, Order, Own, PeersTakeTimesLonger, Slowest, TimesLonger,
    Wrong,
};
use super::{Bar, Field, Promise, Suite};
use palpate_experiment::scenario::NAMES;

const fn most(
    suite: Suite,
    case: &'static str,
    method: &'static str,
    field: Field,
    most: f64,
) -> Promise {
    Promise {
        suite,
        case,
        method,
        field,
        bar: Bar::AtMost(most),
        quick: true,
    }
}

const fn least(
    suite: Suite,
    case: &'static str,
    method: &'static str,
    field: Field,
    least: f64,
) -> Promise {
    Promise {
        bar: Bar::AtLeast(least),
        ..most(suite, case, method, field, 0.0)
    }
}

/// Bars that the rows have themselves.
const fn own(suite: Suite, case: &'static str) -> Promise {
    most(suite, case, "*", Own, 0.0)
}

/// Takes long, or depends on the machine.
const fn long(promise: Promise) -> Promise {
    Promise {
        quick: false,
        ..promise
    }
}

const OURS: &str = "palpate";
const ONE: &str = "palpate 1 it";
const THREE: &str = "palpate 3 it";
const CONTINUUM: &str = "continuum implicit";
const LATTICE: &str = "lattice implicit";
const RAPIER: &str = "rapier3d, 4 substeps";

/// All that is promised; each scenario is one, with the bars that it has itself.
pub(super) fn promises() -> Vec<Promise> {
    let scenarios = NAMES.iter().map(|name| long(own(Suite::Scenario, name)));
    ROWS.iter().copied().chain(scenarios).collect()
}

/// Lengths are of bodies of about 0.1 m.
#[rustfmt::skip]
const ROWS: &[Promise] = &[
    // The closest point is the closest, from anywhere, while a net moves, and with refreshed bounds.
    most(Suite::Surface, "closest/cold/*", OURS, Wrong, 0.0),
    most(Suite::Surface, "closest/warm/*", OURS, Wrong, 0.0),
    most(Suite::Surface, "refresh-bounds/8x8", "palpate, with a cold query", Wrong, 0.0),
    most(Suite::Surface, "refresh-bounds/8x8", OURS, Error, 1e-13),
    most(Suite::Surface, "grid/82x82/normals", OURS, Error, 1e-10),
    most(Suite::Surface, "blending/50x50/244x244", OURS, Error, 1e-13),
    most(Suite::Surface, "fit/8x8/82x82", OURS, Error, 1e-11),
    long(least(Suite::Surface, "closest/cold/*", OURS, PeersTakeTimesLonger, 1.0)),
    long(least(Suite::Surface, "closest/warm/*", OURS, PeersTakeTimesLonger, 1.0)),
    long(least(Suite::Surface, "grid/82x82/normals", OURS, PeersTakeTimesLonger, 1.0)),
    long(least(Suite::Surface, "refresh-bounds/*", OURS, PeersTakeTimesLonger, 40.0)),

    // Depths of the certified method: rounding; its regions of two surfaces to 1e-6 of the size. That of the
    // spheres falls with the square of the resolution.
    most(Suite::Contact, "point/8x8/cold", "exact", Error, 1e-10),
    most(Suite::Contact, "sphere/8x8/cold", "exact", Error, 1e-10),
    most(Suite::Contact, "sphere/20x20/cold", "exact", Error, 1e-10),
    most(Suite::Contact, "sphere/8x8/warm", "exact", Error, 1e-10),
    most(Suite::Contact, "plane/8x8", "exact", Error, 1e-10),
    most(Suite::Contact, "plane/20x20", "exact", Error, 1e-10),
    most(Suite::Contact, "implicit/8x8", "exact", Error, 1e-10),
    most(Suite::Contact, "mesh/8x8", "exact", Error, 1e-7),
    most(Suite::Contact, "surface/8x8", "exact", Error, 1e-7),
    most(Suite::Contact, "surface/20x20", "exact", Error, 1e-7),
    most(Suite::Contact, "curves/8x8", "exact", Error, 1e-7),
    most(Suite::Contact, "self/sausage", "exact", Error, 1e-7),
    most(Suite::Contact, "self/sausage/followed", "exact", Error, 1e-10),
    most(Suite::Contact, "flat/100", "exact", Error, 1e-10),
    least(Suite::Contact, "sphere/8x8/cold", "spheres 28", Order("spheres 82", 3.0), 1.8),
    least(Suite::Contact, "sphere/8x8/cold", "spheres 82", Order("spheres 244", 3.0), 1.8),
    long(least(Suite::Contact, "sphere/8x8/cold", "exact", PeersTakeTimesLonger, 20.0)),
    long(least(Suite::Contact, "plane/8x8", "exact", PeersTakeTimesLonger, 45.0)),
    long(least(Suite::Contact, "surface/8x8", "exact", PeersTakeTimesLonger, 7.0)),
    long(least(Suite::Contact, "surface/20x20", "exact", PeersTakeTimesLonger, 2.3)),

    // A ball slid over parts has contact as long as it is pressed, and its force no steps that its way does not explain.
    most(Suite::Parts, "slide/*", OURS, Wrong, 0.0),
    most(Suite::Parts, "slide/*", OURS, Error, 3.0),
    long(most(Suite::Parts, "slide/*", OURS, Slowest, 150.0)),

    // Merged patches: at most half of the deviation of the source's method.
    most(Suite::Modeling, "merge/case*", "constrained C2 planned", ErrorOver("seed C2 planned"), 0.5),
    most(Suite::Modeling, "merge/case1", "constrained C0 planned", ErrorOver("seed C0 planned"), 0.5),
    long(most(Suite::Modeling, "merge/case*", "constrained C0 planned", ErrorOver("seed C0 planned"), 0.5)),
    long(most(Suite::Modeling, "merge/random100", "*", Error, 0.5)),
    // No way out is known that is shorter by more than a thousandth.
    most(Suite::Modeling, "isolate/*/global", "*", Excess, 0.001),
    // Bounds of pipes, and no pair of places that is missed or too many.
    most(Suite::Modeling, "pipe/*", "all bounds", Error, 1e-10),
    most(Suite::Modeling, "pipe/*", "stationary pairs", Wrong, 0.0),
    // Joints of branching tubes are closed and G1.
    most(Suite::Modeling, "branch/*", "grow*", Error, 1e-6),
    most(Suite::Modeling, "branch/*", "grow*", Wrong, 0.0),

    // Forces of pressed bodies beside converged solids; a modulus means the same over three decades.
    most(Suite::Deformation, "indent/12/x1", CONTINUUM, Error, 0.05),
    most(Suite::Deformation, "indent/12/x1000", CONTINUUM, ApartFrom("indent/12/x1"), 0.005),
    most(Suite::Deformation, "indent/12/x1000", LATTICE, ApartFrom("indent/12/x1"), 0.005),
    most(Suite::Deformation, "indent/teardrop/continuum", "continuum", Error, 0.10),
    most(Suite::Deformation, "indent/teardrop/net", "net", Error, 0.10),
    most(Suite::Deformation, "indent/teardrop/lattice", "lattice", Error, 0.25),
    // Motion beside the exact step of the same integrator.
    most(Suite::Deformation, "motion/ringdown/lattice/2e6", ONE, Error, 0.02),
    most(Suite::Deformation, "motion/ringdown/lattice/2e6", THREE, Error, 0.002),
    most(Suite::Deformation, "motion/frequency/bar/continuum/1", ONE, Error, 0.02),
    most(Suite::Deformation, "motion/press/lattice/0.25/50mm_s", ONE, Error, 0.05),
    most(Suite::Deformation, "motion/spin/continuum", ONE, Error, 0.01),
    long(most(Suite::Deformation, "motion/ringdown/*", ONE, Error, 0.02)),
    long(most(Suite::Deformation, "motion/frequency/*", ONE, Error, 0.02)),
    long(most(Suite::Deformation, "motion/press/*", ONE, Error, 0.05)),
    long(most(Suite::Deformation, "motion/spin/*", ONE, Error, 0.01)),
    long(most(Suite::Deformation, "motion/bounce", ONE, Error, 0.05)),
    long(most(Suite::Deformation, "stability/poking/*", "*", Wrong, 0.0)),
    long(least(Suite::Deformation, "indent/12/x1", LATTICE, TimesLonger(RAPIER), 23.0)),
    // Nor is a processor without wide instructions too slow.
    long(most(Suite::Deformation, "tick/teardrop/default", "default", TimesLonger("without AVX2 and F16C"), 3.0)),
    long(least(Suite::Deformation, "indent/12/x1", CONTINUUM, TimesLonger(RAPIER), 11.0)),
    // Two bodies that do not touch step side by side, to the same bits.
    most(Suite::Scaling, "scaling/side-by-side", "two threads", Error, 0.0),
    long(least(Suite::Scaling, "scaling/side-by-side", "two threads", TimesLonger("one thread"), 1.8)),
    long(own(Suite::Hard, "hard/*")),

    // Walls, energy, forces and friction have their bars beside them.
    own(Suite::Haptics, "zwidth/ideal"),
    own(Suite::Haptics, "energy/delay/5/on"),
    own(Suite::Haptics, "energy/tool/*"),
    own(Suite::Haptics, "render/*"),
    own(Suite::Haptics, "friction/*"),
    long(own(Suite::Haptics, "*")),
    long(own(Suite::Recording, "*")),
    long(own(Suite::Viewer, "*")),
];
