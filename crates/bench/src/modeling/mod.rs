//! The modeling suite: merged, isolated, swept and branched surfaces, each with its time and its
//! error.

mod branch;
mod isolate;
mod merge;
mod pipe;

use super::{Effort, Row};

/// Runs the suite; `only` keeps the cases whose names contain it. Each row is handed out as soon as
/// it is measured.
pub fn modeling(effort: Effort, only: Option<&str>, out: &mut dyn FnMut(Row)) {
    let wanted = |case: &str| only.is_none_or(|part| case.contains(part));
    merge::merge(effort, &wanted, out);
    isolate::isolate(effort, &wanted, out);
    pipe::pipe(effort, &wanted, out);
    branch::branch(effort, &wanted, out);
}
