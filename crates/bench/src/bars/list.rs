//! All promises.

use super::Field::{
    ApartFrom, Error, ErrorOver, Order, Own, PeersTakeTimesLonger, TimesLonger, Wrong,
};
use super::{Bar, Field, Promise, Suite};

const fn most(suite: Suite, case: &'static str, method: &'static str, field: Field, most: f64) -> Promise {
    Promise {
        suite,
        case,
        method,
        field,
        bar: Bar::AtMost(most),
        quick: true,
    }
}

const fn least(suite: Suite, case: &'static str, method: &'static str, field: Field, least: f64) -> Promise {
    Promise {
        bar: Bar::AtLeast(least),
        ..most(source, case, method, field, 0.0)
    }
}

/// Bars that the rows have themselves.
const fn own(suite: Suite, case: &'static str) -> Promise {
    most(source, case, "*", Own, 0.0)
}

/// Takes long, or depends on the machine.
const fn long(promise: Promise) -> Promise {
    Promise {
        quick: false,
        ..promise
    }
}

const OURS: &str = "palpate";

/// Lengths are of bodies of about 0.1 m.
#[rustfmt::skip]
pub(super) const PROMISES: &[Promise] = &[
    most(Suite::Surface, "closest/cold/8x8", OURS, Wrong, 0.0),
    most(Suite::Contact, "plane/8x8", "exact", Error, 1e-10),
    most(Suite::Modeling, "merge/case1", "constrained C2 planned", ErrorOver("seed C2 planned"), 0.5),
    most(Suite::Deformation, "indent/12/x1000", "continuum implicit", ApartFrom("indent/12/x1"), 0.005),
    own(Suite::Haptics, "render/*"),
];
