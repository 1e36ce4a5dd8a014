//! Experiments on the simulation, in lockstep and without a bus: scenarios that measure what a scene does, and batches
//! that sweep its values.
//!
//! ```text
//! scenario ──▶ batch
//! ```

pub mod batch;
pub mod scenario;
