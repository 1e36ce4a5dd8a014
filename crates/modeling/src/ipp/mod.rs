//! All roots of polynomial equations on [0, 1] and [0, 1]²: the interval projected polyhedron
//! method.
//!
//! Patrikalakis & Maekawa, *Shape Interrogation for Computer Aided Design and Manufacturing*,
//! chapter 4; Sherbrooke & Patrikalakis 1993. Knows nothing of curves.
//!
//! ```text
//! coefficients with their rounding (Interval, Bernstein, Tensor)
//!     └─▶ box ─ a sign everywhere? ─────────────────────────▶ dropped
//!          ├─ precondition: Y J ≈ 1 at the middle; H' near 1 ─▶ at most one root; Newton, Krawczyk ball ─▶ Root
//!          ├─ nothing but rounding left, or smaller than the tolerance ─▶ pending ─▶ verified again, or Cluster
//!          └─ clip by the hulls' crossings, halve where that takes less than a fifth ─▶ smaller boxes
//! ```
//! A [`Root`] is proved to exist and to be alone in a ball around it. What cannot be proved or
//! excluded is a [`Cluster`], never silence, and a [`Status`] says which of the two the answer
//! rests on. Every loop is bounded by a budget of boxes.

mod bernstein;
mod clip;
mod cluster;
mod grid;
mod interval;
mod local;
mod pair;
mod single;
mod system;
mod tensor;

pub use bernstein::{Bernstein, binomials};
pub use clip::crossing;
pub use cluster::Cluster;
pub use interval::Interval;
pub use pair::{Found, Limits, PairSolver, Root};
pub use single::{SingleRoot, SingleSolution, common_zero, roots};
pub use system::System;
pub use tensor::Tensor;

/// What an answer rests on, from good to bad.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// All roots were found, each proved alone.
    #[default]
    Complete,
    /// Some roots are so close to each other, or so nearly multiple, that rounding does not let
    /// them be distinguished.
    Cluster,
    /// A curve of roots.
    Continuum,
    /// The budget was used up: roots may be missing.
    Budget,
}
