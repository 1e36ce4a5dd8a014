//! Benchmarks: our methods and other libraries on the same inputs in the same run, each with its
//! error.
//!
//! Wall clock on whatever machine this is: between runs only ratios mean anything. Errors are
//! measured, not assumed, against answers that are computed another way.

mod contact;
mod deformation;
mod exact_step;
mod faults;
mod figure;
pub mod haptics;
mod inputs;
mod measure;
mod modeling;
mod oracle;
mod peers;
mod processes;
mod recording;
mod relay;
mod soak;
mod surface;
mod table;
mod viewer;

pub use contact::{contact, picture};
pub use deformation::{
    HardRow, Sweep, deformation, hard_cases, hard_table, pareto, plasticine_picture,
    plasticine_table,
};
pub use faults::{FaultOptions, faults};
pub use figure::{Bar, Figure, figures_table};
pub use modeling::modeling;
pub use peers::LEFT_OUT;
pub use recording::{RecorderOptions, record_until_killed, recording};
pub use relay::{RelayOptions, SubscriberOptions, relay, subscribers};
pub use soak::{SoakOptions, soak};
pub use surface::surface;
pub use table::table;
pub use viewer::viewer;

/// One method on one case.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Row {
    /// Group of cases.
    pub suite: &'static str,
    /// Name of the case.
    pub case: String,
    /// Library or method.
    pub method: String,
    /// True for other libraries.
    pub peer: bool,
    /// Median time of one call, s.
    pub median_s: f64,
    /// 99th percentile, s.
    pub p99_s: f64,
    /// Largest error seen.
    pub error: f64,
    /// Unit of `error`.
    pub error_unit: &'static str,
    /// Calls timed.
    pub n: usize,
    /// Answers that are wrong by more than 1e-9 of the surface's size, or missing; `None` where
    /// none can be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrong: Option<usize>,
    /// Further results: forces, energies, counts.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// How long to measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Some seconds: a quick check.
    Quick,
    /// At least ten thousand queries a case.
    Full,
}
