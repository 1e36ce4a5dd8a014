//! Surfaces and what touches them: B-spline and NURBS geometry, contact queries, CAD exchange.
//!
//! ```text
//! math ──▶ basis ──▶ surface ──▶ part ──┬──▶ skin ──▶ contact    tool shapes, narrow and broad phases
//!                                       ├──▶ cut                 pieces by a plane
//!                                       └──▶ exchange            STEP, IGES, STL, OBJ, glTF
//! ```
//! Pure arithmetic apart from reading the files it is given: no clock, no threads, no sockets, and
//! the same bits for the same input on the same build.

// Tests compare with formulas as they stand; the list of clippy.toml holds for what simulates.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod basis;
pub mod contact;
pub mod cut;
pub mod exchange;
pub mod math;
pub mod part;
pub mod skin;
pub mod surface;
