//! Branching tubes: a whole tree as one tensor-product surface that is smooth (G1) at its forks.
//!
//! One control net, one knot vector a direction, nothing stitched. u runs round the sections, leaf
//! after leaf, each a loop of two arcs that end at a front joint F and a back joint B: knots of
//! multiplicity p at B ("terminate"), p + 1 after every leaf ("disjoin"). v runs from the branch
//! tops down to the stem's end, disjoined (q + 1) at every fork.
//!
//! ```text
//!   \  left  \      /  right /        free rows
//!    \        \    /        /         q tilted rows
//!     \________\  /________/          open book: outline raised by d1, arch moved aside by delta
//!      |       |  |       |
//!      |_______|__|_______|           inverted T: half an outline (bar), the arch (stroke)
//!      |          .       |           overlap layer: the outline again; v is disjoined between
//!      |   stem   .       |           straight layers, free rows
//! ```
//! ```text
//! Tree ── check (R1 … R4) ── grow ──▶ BranchingSurface: Surface, PatchTable, ties
//!                                     Surface ── PatchTable::recovered ──▶ Measures: gap, angle, Euler number, folds
//! ```
//! A tube under several leaves is drawn once by each: [`PatchTable`] says which rectangles of the
//! domain repeat others. Five rules make the joints exactly G1; a tree that breaks one is refused
//! by its name ([`Rule`]). They do not keep strongly bent branches from crossing or folding:
//! [`Measures`] finds that.
//!
//! The construction follows an extended abstract on bifurcating B-spline surfaces by terminating
//! and disjoining knots; its rules were worked out from "open book", "inverted T" and "overlap
//! layer" there.

mod check;
mod crossing;
mod error;
mod grow;
mod joints;
mod measure;
mod patches;
mod rules;
mod section;
mod tree;
mod weld;

#[cfg(test)]
mod tests;

pub use error::{BranchError, Rule};
pub use grow::{BranchingSurface, grow};
pub use joints::{Joint, JointKind, joints};
pub use measure::{GOAL_ANGLE_DEG, GOAL_EDITED_ANGLE_DEG, GOAL_GAP, Measures};
pub use patches::{Patch, PatchTable};
pub use rules::Broken;
pub use tree::{Branch, End, Fork, Hand, Stem, Tree};
pub use weld::Welded;
