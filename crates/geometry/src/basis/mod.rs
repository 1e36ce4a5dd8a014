//! B-spline basis: knot vectors, the few basis functions that live at a parameter, and blending
//! matrices.
//!
//! ```text
//! KnotVector ── window(u) ──▶ BasisWindow: first column, degree + 1 values, first and second derivatives
//!     ├──────── insertion(u) ──▶ Insertion: the finer knots, and how control points follow
//!     ├──────── elevation(), restriction(a, b), clamping() ──▶ BasisChange: old control points to new ones
//!     └──────── Blending::new(parameters) ──▶ rows of windows ──▶ BlendingInverse fits with them
//! ```

mod blending;
mod change;
mod insertion;
mod knots;
mod window;

#[cfg(test)]
pub(crate) mod testing;

pub use blending::{Blendable, Blending, BlendingInverse};
pub use change::BasisChange;
pub use insertion::Insertion;
pub use knots::{KnotError, KnotKind, KnotVector, MAX_DEGREE, Side};
pub use window::BasisWindow;
