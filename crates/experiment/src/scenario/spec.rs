//! `scenario.toml`: runs, measures, bars and what the source says.

use super::error::ScenarioError;
use super::hands::HandSpec;
use super::measure::MeasureSpec;
use palpate_proto::text::located;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A `scenario.toml`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioSpec {
    /// One line.
    pub title: String,
    /// Where it comes from.
    #[serde(default)]
    pub source: String,
    /// `[[run]]`.
    #[serde(rename = "run")]
    pub runs: Vec<RunSpec>,
    /// `[[measure]]`: a column of the table.
    #[serde(rename = "measure")]
    pub measures: Vec<MeasureSpec>,
    /// `[[claim]]`: what must hold between runs.
    #[serde(default, rename = "claim")]
    pub claims: Vec<ClaimSpec>,
    /// `[[says]]`: what the source says, printed beside the table.
    #[serde(default, rename = "says")]
    pub says: Vec<SaysSpec>,
}

/// `[[run]]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunSpec {
    /// Name: a row of the table.
    pub name: String,
    /// Simulated time, s; 0: the scene is not simulated.
    #[serde(default)]
    pub for_s: f64,
    /// Changes of the scene by path, such as `"body.bowl.pose.position" = [0, 0, 0.1]`. Entries of
    /// arrays of tables are named by their `id`, or counted from 0.
    #[serde(default)]
    pub set: BTreeMap<String, toml::Value>,
    /// Bodies that are cut before the simulation, one after the other.
    #[serde(default)]
    pub cut: Vec<CutSpec>,
    /// What moves tools, by tool.
    #[serde(default)]
    pub hands: BTreeMap<String, HandSpec>,
    /// Patches that become one, after the simulation.
    #[serde(default)]
    pub merge: Option<MergeSpec>,
    /// Overlapping bodies that are moved apart.
    #[serde(default)]
    pub isolate: Option<IsolateSpec>,
    /// A spine whose safe radius is asked for.
    #[serde(default)]
    pub pipe: Option<PipeSpec>,
}

/// `cut = [{ body = "gel", point = [0.01, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CutSpec {
    /// Id of a body that deforms: of the scene, or a piece of an earlier cut.
    pub body: String,
    /// A point of the plane, m, in the world.
    pub point: [f64; 3],
    /// Across the plane, any length above 0.
    pub normal: [f64; 3],
    /// Width of what is lost, m; with none, pieces do not touch each other.
    #[serde(default)]
    pub kerf_m: f64,
}

/// `merge = { surface = "bowl.json", body = "handle", continuity = 1, output = "spoon.step" }`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MergeSpec {
    /// The first patch, a file of the scenario.
    pub surface: String,
    /// The second: a body of the scene, as it is after the simulation.
    pub body: String,
    /// c of C^c at the seam.
    pub continuity: usize,
    /// Edges to join, such as `["u1", "u0"]`.
    pub edges: [String; 2],
    /// STEP file, in the folder given by `--out`; written and read back in any case.
    pub output: String,
}

/// `isolate = { method = "global", gap_m = 1e-4 }`: all bodies of the scene.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IsolateSpec {
    /// As `palpate surface isolate --method`.
    pub method: String,
    /// Gap to leave, m.
    pub gap_m: f64,
}

/// `pipe = { spine = "spine.json" }`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PipeSpec {
    /// A `palpate.curve.v1` file of the scenario.
    pub spine: String,
}

/// `[[claim]]`: an order of the runs by a measure.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClaimSpec {
    /// In words.
    pub says: String,
    /// Name of the measure.
    pub measure: String,
    /// Runs in which it grows, one after the other.
    #[serde(default)]
    pub growing: Vec<String>,
    /// Run in which it is least, of those that have it.
    #[serde(default)]
    pub least: Option<String>,
    /// A claim of the source that need not hold here: it is reported, and no bar.
    #[serde(default)]
    pub reported: bool,
}

/// `[[says]]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SaysSpec {
    /// Where.
    pub figure: String,
    /// What.
    pub text: String,
}

impl ScenarioSpec {
    /// Reads a `scenario.toml`.
    ///
    /// # Errors
    /// Not such TOML; a measure or a claim about runs that there are not.
    pub fn parse(text: &str, name: &str) -> Result<Self, ScenarioError> {
        let wrong = |reason: String| ScenarioError::File {
            path: format!("{name}/scenario.toml"),
            reason,
        };
        let spec: Self = toml::from_str(text)
            .map_err(|error| wrong(located(text, error.span(), error.message())))?;
        let is_run = |name: &String| spec.runs.iter().any(|run| run.name == *name);
        let mut named = Vec::new();
        for measure in &spec.measures {
            named.extend(measure.runs.iter().map(|run| (&measure.name, run)));
        }
        for claim in &spec.claims {
            if !spec.measures.iter().any(|m| m.name == claim.measure) {
                return Err(wrong(format!(
                    "claim {:?} is about {:?}, which is no measure",
                    claim.says, claim.measure
                )));
            }
            let runs = claim.growing.iter().chain(&claim.least);
            named.extend(runs.map(|run| (&claim.says, run)));
        }
        match named.into_iter().find(|(_, run)| !is_run(run)) {
            Some((by, run)) => Err(wrong(format!("{by:?} names {run:?}, which is no run"))),
            None => Ok(spec),
        }
    }
}
