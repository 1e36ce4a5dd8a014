//! Scenarios: scenes with hands that do something, measures of what comes of it, and bars for these.
//!
//! ```text
//! scenes/NAME/ ─ files ─▶ spec (scenario.toml) ─▶ run: change the scene, build, play ─┬▶ measure ─▶ report
//!                                                     └▶ design: merge, isolate, sweep ┘
//! ```
//! A scenario is a folder: `scenario.toml` (runs, measures, bars, what the source says), `scene.toml`,
//! motions, surfaces and a `README.md`. Those of this repository are inside the program as well. A
//! run is headless and in lockstep: the same build gives the same figures, as fast as it can.

pub mod change;
mod design;
mod error;
mod files;
mod hands;
mod measure;
mod play;
mod played;
mod report;
mod scan;
mod spec;
mod surfaces;

pub use error::ScenarioError;
pub use files::{NAMES, SCENES, Source};
pub use played::RunSettings;
pub use report::{Cell, Claimed, Report, Row};
pub use scan::{StiffnessMap, picture};
pub use spec::ScenarioSpec;

use measure::Meter;
use std::path::PathBuf;

/// A scenario, read.
#[derive(Debug)]
pub struct Scenario {
    /// Its name: that of its folder.
    pub name: String,
    /// What it says.
    pub spec: ScenarioSpec,
    source: Source,
}

/// How to run one.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Record to this file; of several runs each to one with the run's number in its name.
    pub record: Option<PathBuf>,
    /// Only runs with one of these names; all when empty.
    pub only: Vec<String>,
    /// Where surfaces and pictures go that a run makes; nowhere when absent.
    pub out: Option<PathBuf>,
    /// No run is longer than this, s: for a quick look; figures are then others.
    pub most_s: Option<f64>,
}

impl Scenario {
    /// A scenario of the program by name, or of a folder.
    ///
    /// # Errors
    /// No such name or folder, or a file in it that is not what it should be.
    pub fn load(name: &str) -> Result<Self, ScenarioError> {
        let source = Source::of(name)?;
        let spec = ScenarioSpec::parse(&source.text("scenario.toml")?, name)?;
        Ok(Self {
            name: source.name().to_owned(),
            spec,
            source,
        })
    }

    /// Runs all of it. `progress` gets the name of each run before it begins.
    ///
    /// # Errors
    /// A scene that does not build, a motion that cannot be gone, a file that cannot be written.
    pub fn run(
        &self,
        settings: &Settings,
        mut progress: impl FnMut(&str),
    ) -> Result<Report, ScenarioError> {
        let mut report = Report::new(&self.name, &self.spec);
        let wanted = |name: &String| settings.only.is_empty() || settings.only.contains(name);
        let mut traces = Vec::new();
        for (number, run) in self.spec.runs.iter().enumerate() {
            if !wanted(&run.name) {
                continue;
            }
            progress(&run.name);
            let mut meters: Vec<Meter> = (self.spec.measures.iter())
                .filter(|measure| measure.is_of(&run.name))
                .map(Meter::new)
                .collect();
            let record = settings.record.as_ref().map(|path| {
                match self
                    .spec
                    .runs
                    .iter()
                    .filter(|run| wanted(&run.name))
                    .count()
                {
                    1 => path.clone(),
                    _ => numbered(path, number),
                }
            });
            let played = play::play(
                run,
                &self.source,
                &RunSettings {
                    record,
                    out: settings.out.clone(),
                    most_s: settings.most_s,
                },
                &mut meters,
            )?;
            report.push(run, &meters, &played, &traces)?;
            traces.push((run.name.clone(), played.trace));
        }
        report.judge(&self.spec);
        Ok(report)
    }
}

/// `a/session.mcap` of run 2: `a/session-2.mcap`.
fn numbered(path: &std::path::Path, number: usize) -> PathBuf {
    let text = |part: Option<&std::ffi::OsStr>| {
        part.map(|part| part.to_string_lossy().into_owned())
            .unwrap_or_default()
    };
    path.with_file_name(format!(
        "{}-{number}.{}",
        text(path.file_stem()),
        text(path.extension())
    ))
}
