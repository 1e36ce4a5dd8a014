//! Modeling on B-splines: merge, isolate, pipe, branch.

pub mod isolate;
pub mod merge;
