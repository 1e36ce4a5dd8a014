//! Benchmarks: our methods and other libraries on the same inputs in the same run, each with its
//! error.
//!
//! Wall clock on whatever machine this is: between runs only ratios mean anything. Errors are
//! measured, not assumed, against answers that are computed another way.

mod bars;
mod contact;
mod deformation;
mod documents;
mod exact_step;
mod faults;
mod figure;
pub mod haptics;
mod inputs;
mod measure;
mod modeling;
mod oracle;
mod parts;
mod peers;
mod processes;
mod recording;
mod relay;
mod soak;
mod suite;
mod surface;
mod table;
mod viewer;

pub use bars::{BarOptions, bars};
pub use contact::{contact, picture};
pub use deformation::{
    HardRow, Sweep, TrustRow, deformation, hard_cases, hard_table, latency_picture, pareto,
    plasticine_picture, plasticine_table, scaling, trust, trust_picture, trust_table, whole_loop,
};
pub use documents::{DocumentOptions, documents};
pub use faults::{FaultOptions, faults};
pub use figure::{Bar, Figure, figures_table};
pub use measure::Times;
pub use modeling::modeling;
pub use parts::{census, parts, parts_picture};
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
    /// What its calls took; `None` if there were none.
    #[serde(flatten)]
    pub times: Option<Times>,
    /// Largest error seen; `None` where there is nothing to compare with.
    #[serde(flatten)]
    pub error: Option<Deviation>,
    /// Answers that are wrong by more than 1e-9 of the surface's size, or missing; `None` where
    /// none can be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrong: Option<usize>,
    /// Further results: forces, energies, counts.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// An error, with its unit.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Deviation {
    /// Its size, with a sign where that means something.
    #[serde(rename = "error")]
    pub value: f64,
    /// What it is counted in.
    #[serde(rename = "error_unit")]
    pub unit: &'static str,
}

impl Row {
    /// Of our own method, with nothing measured yet.
    pub(crate) fn new(
        suite: &'static str,
        case: impl Into<String>,
        method: impl Into<String>,
    ) -> Self {
        Self {
            suite,
            case: case.into(),
            method: method.into(),
            peer: false,
            times: None,
            error: None,
            wrong: None,
            note: String::new(),
        }
    }

    pub(crate) fn timed(self, times: impl Into<Option<Times>>) -> Self {
        Self {
            times: times.into(),
            ..self
        }
    }

    /// With an error; what is not a number is none.
    pub(crate) fn off_by(self, value: impl Into<Option<f64>>, unit: &'static str) -> Self {
        let value = value.into().filter(|value| !value.is_nan());
        Self {
            error: value.map(|value| Deviation { value, unit }),
            ..self
        }
    }

    pub(crate) fn saying(self, note: impl Into<String>) -> Self {
        Self {
            note: note.into(),
            ..self
        }
    }

    /// How large its error is.
    pub fn error_size(&self) -> Option<f64> {
        self.error.map(|error| error.value.abs())
    }
}

/// Which cases of a suite run.
#[derive(Clone, Copy, Debug)]
pub enum Cases<'a> {
    /// Those of a run by default.
    Usual,
    /// Those whose names contain this.
    Containing(&'a str),
    /// Those that a method's row belongs to, by `CASE/METHOD`, spaces as slashes; one `*` stands for
    /// anything.
    Rows(&'a [String]),
}

impl<'a> From<Option<&'a str>> for Cases<'a> {
    fn from(part: Option<&'a str>) -> Self {
        part.map_or(Self::Usual, Self::Containing)
    }
}

impl Cases<'_> {
    /// True for a case, or for a group of cases in which there is one.
    pub(crate) fn has(&self, case: &str) -> bool {
        match self {
            Self::Usual => true,
            Self::Containing(part) => case.contains(part),
            Self::Rows(rows) => rows.iter().any(|row| {
                let known = row.split('*').next().unwrap_or_default();
                let is_in_it = known
                    .strip_prefix(case)
                    .is_some_and(|rest| rest.starts_with('/'));
                is_in_it || suite::matches(row, case)
            }),
        }
    }

    /// True if somebody asked for just these: then long ones run too.
    pub(crate) fn are_chosen(&self) -> bool {
        !matches!(self, Self::Usual)
    }
}

/// How long to measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Some seconds: a quick check.
    Quick,
    /// At least ten thousand queries a case.
    Full,
}

/// The scene of a text at its start, or what is wrong with it.
pub(crate) fn parse(text: &str) -> Result<palpate_sim::World, String> {
    let loaded = palpate_sim::scene::file::parse(text, "bench.toml", std::path::Path::new("."));
    loaded
        .and_then(|loaded| palpate_sim::World::of(&loaded.with(palpate_thesis::METHODS)))
        .map_err(|error| error.to_string())
}

/// A scene of ours at work.
pub(crate) fn world(text: &str) -> palpate_sim::World {
    parse(text).unwrap_or_else(|error| panic!("{text}\n{error}"))
}
