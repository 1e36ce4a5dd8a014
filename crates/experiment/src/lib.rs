//! Experiments on the simulation, in lockstep and without a bus: scenarios that measure what a scene does, and batches
//! that sweep its values; and tools that press whatever is nearest, for figures of any scene.
//!
//! ```text
//! scenario ──▶ batch
//! ```

pub mod batch;
pub mod press;
pub mod scenario;
