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
mod parquet;
mod plan;
mod player;
mod spec;
mod table;

pub use cache::Cache;
pub use error::BatchError;
pub use plan::{Case, Plan};
pub use player::Outcome;
pub use table::{Format, Row, Table};

use player::Player;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
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
    plan: Plan,
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
        let plan = Plan::new(spec::SweepSpec::parse(text, name)?, name, directory)?;
        Ok(Self { plan })
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
            let mut player = Player::new(&self.plan);
            let (mut mine, mut busy) = (Vec::new(), Duration::ZERO);
            while let Some(&run) = numbers.get(next.fetch_add(1, Ordering::Relaxed)) {
                let since = Instant::now();
                let case = self.plan.case(run);
                let (outcome, was_cached) = player.outcome(&case, settings.cache.as_ref());
                cached.fetch_add(usize::from(was_cached), Ordering::Relaxed);
                busy += since.elapsed();
                mine.push(Row { case, outcome });
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
