//! The compiled part of the Python package: the module `palpate._native`.
//!
//! ```text
//! errors, values, watched ─▶ pose ─▶ scene ─▶ output ─▶ ticks ─▶ snapshot ─▶ sim
//!                                                        └────▶ arrays, vary ─▶ batch
//! closest ─▶ surface ─▶ modeling, part;   columns ─▶ recording;   client ─▶ device;   sweep;   command
//! ```
//! Classes hold the crates' own types and convert arguments and results; what they compute is what
//! the daemon computes. Everything that takes longer than some microseconds releases the GIL. Names
//! and types are in `python/palpate/_native.pyi`, which a test compares with this module.

mod arrays;
mod batch;
mod built;
#[cfg(feature = "daemon")]
mod client;
mod closest;
mod columns;
mod command;
#[cfg(feature = "daemon")]
mod device;
mod errors;
mod modeling;
mod output;
mod overrides;
mod part;
mod pose;
mod recording;
mod scene;
mod sim;
mod snapshot;
mod surface;
#[cfg(feature = "daemon")]
mod sweep;
mod ticks;
mod values;
mod vary;
mod watched;

use pyo3::prelude::*;

#[pymodule(name = "_native")]
mod native {
    #[pymodule_export]
    use super::batch::Batch;
    #[cfg(feature = "daemon")]
    #[pymodule_export]
    use super::client::{Link, Seen, Tool, Watch};
    #[pymodule_export]
    use super::command::{build_id, message_json};
    #[cfg(feature = "daemon")]
    #[pymodule_export]
    use super::command::{main, to_html};
    #[cfg(feature = "daemon")]
    #[pymodule_export]
    use super::device::SimulatedDevice;
    #[pymodule_export]
    use super::modeling::{branch, fit, isolate, merge, pipe, toml_text};
    #[pymodule_export]
    use super::output::{ByTool, Output};
    #[pymodule_export]
    use super::part::Part;
    #[pymodule_export]
    use super::pose::Pose;
    #[pymodule_export]
    use super::recording::RecordingFile;
    #[pymodule_export]
    use super::scene::Scene;
    #[pymodule_export]
    use super::sim::Simulation;
    #[pymodule_export]
    use super::snapshot::Snapshot;
    #[pymodule_export]
    use super::surface::Surface;
    #[cfg(feature = "daemon")]
    #[pymodule_export]
    use super::sweep::{Sweep, SweepRows};
}
