//! Tools given by a function: solid where f(x, y, z) ≤ 0.
//!
//! ```text
//! expression   text ──▶ tape
//! tape         value, gradient, range over a box
//! shape        quadrics, torus, box and expressions; depth of a point along the gradient
//! side         the smooth sides of shapes that are given by sizes, to which distances are known
//! edges        those of functions, where one operand takes over from another
//! outline      triangles around the solid, for pictures
//! solver       contacts with a surface: prune by ranges, sample, climb
//! ```

mod edges;
#[cfg(test)]
mod edges_tests;
mod expression;
mod interval;
mod outline;
mod shape;
mod side;
mod solver;
mod tape;
#[cfg(test)]
mod tests;

pub use expression::ExpressionError;
pub use interval::Interval;
pub use shape::{ImplicitError, ImplicitShape, ImplicitTool};
pub use solver::ImplicitSolver;
pub use tape::{MAX_OPS, Tape};
