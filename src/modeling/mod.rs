//! Modeling on B-splines: merge, isolate, pipe, branch.
