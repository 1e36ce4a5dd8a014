//! What is said of a tick: forces for the hands, reports for all, and why they are what they are.

pub(crate) mod degraded;
pub(crate) mod error;
pub mod explain;
pub(crate) mod outputs;
