//! The modeling suite: merged, isolated, swept and branched surfaces, each with its time and its
//! error.

mod branch;
mod isolate;
mod merge;
mod pipe;

use super::{Cases, Effort, Row};

/// Runs cases of the suite. Each row is handed out as soon as
/// it is measured.
pub fn modeling(effort: Effort, cases: Cases<'_>, out: &mut dyn FnMut(Row)) {
    let wanted = |case: &str| cases.has(case);
    merge::merge(effort, &wanted, out);
    isolate::isolate(effort, &wanted, out);
    pipe::pipe(effort, &wanted, out);
    branch::branch(effort, &wanted, out);
}
