//! Many runs of a scene at once: scene values × motions × seeds, in lockstep, without clock and bus.
//!
//! ```text
//! SWEEP.toml ─ spec ─▶ plan: run number ─▶ values, motion, seed
//!                        └─▶ player (cache: seen before?) ─▶ Outcome ─▶ table ─▶ CSV, JSON, Parquet
//! ```
//! What a run comes to depends on its number and on the sweep, not on jobs, shards or other runs.

mod asked;
mod cache;
mod error;
mod files;
mod outcome;
mod parquet;
mod plan;
mod player;
mod spec;
mod table;

pub use cache::Cache;
pub use error::BatchError;
pub use files::FileBytes;
pub use outcome::Outcome;
pub use plan::{Case, Plan};
pub use player::{Player, build};
pub use table::{Cells, Format, Row, Table};

use files::Kept;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Which runs, and how many at a time.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Runs at a time.
    pub jobs: usize,
    /// Part `i` of `n`, from 1: runs whose number leaves `i − 1` when divided by `n`.
    pub shard: (usize, usize),
    /// Where outcomes are kept; nowhere when absent.
    pub cache: Option<Cache>,
}

/// What a batch came to.
#[derive(Clone, Debug)]
pub struct Batch {
    /// In the order of their numbers.
    pub rows: Vec<Row>,
    /// Taken from the cache.
    pub cached: usize,
    /// Wall time of all.
    pub took: Duration,
    /// Wall time that jobs spent in runs, together.
    pub busy: Duration,
}

impl Batch {
    /// Runs that failed: the scene did not build, or a tick had a fault.
    pub fn failed(&self) -> usize {
        (self.rows.iter())
            .filter(|row| row.outcome.error.is_some())
            .count()
    }
}

/// A sweep, read and checked.
#[derive(Clone, Debug)]
pub struct Sweep {
    plan: Arc<Plan>,
}

impl Sweep {
    /// Reads a sweep and the files that it names.
    ///
    /// # Errors
    /// A file that cannot be read, a key that is not one of a sweep, a range without values, a scene
    /// that does not read, or a tool that it does not have.
    pub fn load(path: &Path) -> Result<Self, BatchError> {
        let text = std::fs::read_to_string(path).map_err(|error| BatchError::file(path, error))?;
        let directory = path.parent().unwrap_or(Path::new("."));
        Self::parse(&text, &path.display().to_string(), directory)
    }

    /// As [`Self::load`], from text; paths start at `directory`.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn parse(text: &str, name: &str, directory: &Path) -> Result<Self, BatchError> {
        Self::with(text, name, directory, Kept::of_disk())
    }

    /// As [`Self::parse`], with the files that [`Self::files`] gave, and no others.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn with_files(
        text: &str,
        name: &str,
        directory: &Path,
        files: FileBytes,
    ) -> Result<Self, BatchError> {
        Self::with(text, name, directory, Kept::of(files))
    }

    fn with(text: &str, name: &str, directory: &Path, files: Kept) -> Result<Self, BatchError> {
        let plan = Plan::new(spec::SweepSpec::parse(text, name)?, name, directory, files)?;
        Ok(Self {
            plan: Arc::new(plan),
        })
    }

    /// All files that its runs read, with those that cannot be read: with them the same runs are made where there are none.
    pub fn files(&self) -> FileBytes {
        self.plan.files()
    }

    /// Who makes its runs one after the other, in any order.
    pub fn player(&self) -> Player {
        Player::new(self.plan.clone())
    }

    /// What its runs are.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Runs all of a shard. `progress` gets how many are done, and of how many; it may be called
    /// by any job. What goes wrong in a run is in its row and stops no other.
    pub fn run(&self, settings: &Settings, progress: impl Fn(usize, usize) + Sync) -> Batch {
        let (part, parts) = settings.shard;
        let numbers: Vec<usize> = (0..self.plan.count())
            .filter(|run| run % parts == part - 1)
            .collect();
        let begun = Instant::now();
        let (next, done, cached) = (
            AtomicUsize::new(0),
            AtomicUsize::new(0),
            AtomicUsize::new(0),
        );
        let rows = Mutex::new((Vec::with_capacity(numbers.len()), Duration::ZERO));
        let job = || {
            let mut player = self.player();
            let (mut mine, mut busy) = (Vec::new(), Duration::ZERO);
            while let Some(&run) = numbers.get(next.fetch_add(1, Ordering::Relaxed)) {
                let since = Instant::now();
                let (row, was_cached) = player.row(run, settings.cache.as_ref());
                cached.fetch_add(usize::from(was_cached), Ordering::Relaxed);
                busy += since.elapsed();
                mine.push(row);
                progress(done.fetch_add(1, Ordering::Relaxed) + 1, numbers.len());
            }
            let mut rows = (rows.lock()).unwrap_or_else(std::sync::PoisonError::into_inner);
            rows.0.append(&mut mine);
            rows.1 += busy;
        };
        std::thread::scope(|scope| {
            for _ in 1..settings.jobs.min(numbers.len()) {
                scope.spawn(job);
            }
            job();
        });
        let (mut rows, busy) =
            (rows.into_inner()).unwrap_or_else(std::sync::PoisonError::into_inner);
        rows.sort_by_key(|row| row.case.run);
        Batch {
            rows,
            cached: cached.into_inner(),
            took: begun.elapsed(),
            busy,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SWEEP: &str = r#"
        scene = "soft.toml"
        for_s = 0.06
        [vary]
        "body.drop.material.young_pa" = [1e4, 2e4]
        "tool.ball.coupling.stiffness_n_m" = [300.0, 600.0]
        "tool.ball.shape.sphere.radius_m" = [0.01, 0.008]
        "loop.rate_hz" = [1000, 800]
        [[motion]]
        name = "press"
        hands.ball = { motion = "press.toml" }
    "#;
    const SCENE: &str = r#"
        [[body]]
        id = "drop"
        surface = { builtin = "teardrop", net = [8, 8] }
        model = "lattice"
        material = { young_pa = 20e3, density_kg_m3 = 1000.0 }
        lattice = { layers = 2, refine = "none" }
        fixed = [{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }]
        [[tool]]
        id = "ball"
        shape = { sphere = { radius_m = 0.01 } }
        pose = { position = [0.05, 0.003, 0.045] }
    "#;
    const PRESS: &str = r#"
        waypoint = [
            { time_s = 0.0, position = [0.05, 0.003, 0.045] },
            { time_s = 0.05, position = [0.025, 0.003, 0.045] },
        ]
    "#;

    fn files() -> FileBytes {
        let file = |(name, text): (&str, &str)| (name.into(), Ok(text.as_bytes().to_vec()));
        [("soft.toml", SCENE), ("press.toml", PRESS)]
            .map(file)
            .into()
    }

    fn hashes(rows: impl Iterator<Item = Row>) -> Vec<(String, String, Option<String>)> {
        rows.map(|Row { outcome, .. }| (outcome.session_hash, outcome.key, outcome.error))
            .collect()
    }

    #[test]
    fn runs_that_share_bodies_have_the_bits_of_runs_alone() {
        let sweep = Sweep::with_files(SWEEP, "sweep", Path::new(""), files()).unwrap();
        let runs = sweep.plan().count();
        assert_eq!(runs, 16);
        let mut player = sweep.player();
        let one_by_one = hashes((0..runs).map(|run| player.row(run, None).0));
        let alone = hashes((0..runs).map(|run| sweep.player().row(run, None).0));
        assert_eq!(one_by_one, alone);
        let distinct: std::collections::BTreeSet<_> = alone.iter().map(|(hash, ..)| hash).collect();
        assert!(alone.iter().all(|(.., error)| error.is_none()) && distinct.len() == runs);
    }

    #[test]
    fn a_sweep_goes_on_with_the_files_that_it_gave() {
        let with_none = SWEEP.replace(
            "[vary]",
            "[vary]\n\"body.drop.motion.file\" = [\"none.toml\"]",
        );
        let of = |text: &str, files| Sweep::with_files(text, "sweep", Path::new(""), files);
        let sweep = of(SWEEP, files()).unwrap();
        assert_eq!(sweep.files(), files());
        let missing = of(SWEEP, FileBytes::new()).unwrap_err().to_string();
        assert_eq!(missing, "soft.toml: it did not come with the sweep");
        let sweep = of(&with_none, files()).unwrap();
        let known = sweep.files();
        assert!(known[Path::new("none.toml")].is_err());
        let row = of(&with_none, known.clone())
            .unwrap()
            .player()
            .row(0, None)
            .0;
        assert!(row.outcome.error.unwrap().contains("did not come with"));
    }

    #[test]
    fn outcomes_come_back_from_json_with_what_is_not_finite() {
        let figures = outcome::ToolFigures {
            energy_j: f64::NAN,
            peak_force_n: 0.1 + 0.2,
            ..outcome::ToolFigures::default()
        };
        let text = serde_json::to_string(&figures).unwrap();
        let back: outcome::ToolFigures = serde_json::from_str(&text).unwrap();
        assert!(back.energy_j.is_nan() && back.peak_force_n.to_bits() == (0.1_f64 + 0.2).to_bits());
    }
}
