//! Replay: the recorded inputs through the same step, compared bit for bit.
//!
//! ```text
//! ticks ─ divide ─▶ stretches, each from a keyframe up to and including the next ─▶ threads ─▶ first difference by tick
//! ```
//! Each stretch must reach the state of the next keyframe, so that all of them together are as
//! strong as one replay from end to end, and what is found does not depend on the number of
//! threads. Where ticks are missing it goes on from the next keyframe: a loss is a gap, not a
//! difference.

mod compare;
mod divergence;
mod follow;
mod stretches;

pub use compare::Difference;
pub use divergence::Divergence;
pub use follow::{Follower, recorded_scene};

use super::build_id;
use super::message::SessionHash;
use super::reader::{ReadError, Session};
use palpate_sim::scene::SceneError;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use stretches::{Found, Runner, Stretch};

/// Why a session cannot be replayed at all.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The file.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Its scene.
    #[error("the recorded scene does not parse: {0}")]
    SceneText(String),
    /// Its scene.
    #[error("the recorded scene does not build: {0}")]
    Scene(#[from] SceneError),
    /// No state to start from.
    #[error("no keyframe at or before tick {from}, and one is needed to start from{}", first_keyframe(*.first))]
    NoKeyframe {
        /// Wanted start.
        from: u64,
        /// Tick of the first keyframe that there is.
        first: Option<u64>,
    },
    /// The state is of another scene.
    #[error("keyframe at tick {tick}: {source}")]
    State {
        /// Its tick.
        tick: u64,
        /// Cause.
        source: palpate_geometry::math::StateError,
    },
    /// A range without ticks.
    #[error("no tick from {from} to {until}; the recording has ticks {first} to {last}")]
    NoTicks {
        /// Wanted start.
        from: u64,
        /// Wanted end.
        until: u64,
        /// What there is.
        first: u64,
        /// What there is.
        last: u64,
    },
}

fn first_keyframe(first: Option<u64>) -> String {
    first.map_or_else(
        || "; there is none at all".into(),
        |tick| format!("; the first one is at tick {tick}"),
    )
}

/// What to replay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReplayOptions {
    /// Start at the keyframe at or before this tick; 0: where the recording starts.
    pub from: u64,
    /// Last tick.
    pub until: u64,
    /// Threads; what is found does not depend on it.
    pub jobs: usize,
}

impl Default for ReplayOptions {
    fn default() -> Self {
        let jobs = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        Self {
            from: 0,
            until: u64::MAX,
            jobs,
        }
    }
}

/// What a replay found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReplayReport {
    /// Ticks whose every output and state hash were equal by bits, up to the first difference.
    pub ticks_matched: u64,
    /// Ticks of the recording.
    pub ticks_recorded: u64,
    /// Ticks that no keyframe leads to: after a gap, up to the next one.
    pub ticks_unreached: u64,
    /// Nets that were compared.
    pub nets_matched: u64,
    /// Keyframes from which it started.
    pub stretches: u64,
    /// Ticks missing.
    pub gaps: u64,
    /// The recording was finished and lost nothing.
    pub clean: bool,
    /// Recorded by this very build.
    pub same_build: bool,
    /// Where they part, if they do.
    pub first_difference: Option<Difference>,
    /// What was replayed around it.
    #[serde(skip)]
    pub divergence: Option<Divergence>,
    /// Simulated over wall time.
    pub realtime_factor: f64,
    /// Threads.
    pub jobs: usize,
    /// Hash of all replayed ticks, hexadecimal.
    pub session_hash: String,
}

impl ReplayReport {
    /// Nothing is missing.
    pub fn is_complete(&self) -> bool {
        self.clean && self.gaps == 0 && self.ticks_unreached == 0
    }

    /// Complete, and equal at every tick.
    pub fn passed(&self) -> bool {
        self.first_difference.is_none() && self.is_complete()
    }
}

/// Replays a session from the keyframe at or before tick `from` (0: the start) to its end.
/// `progress` is called now and then with the ticks done and all.
///
/// # Errors
/// A file or scene that cannot be replayed; a difference is no error but part of the report.
pub fn replay(
    session: &Session,
    from: u64,
    progress: impl FnMut(u64, u64),
) -> Result<ReplayReport, ReplayError> {
    replay_with(
        session,
        &ReplayOptions {
            from,
            ..ReplayOptions::default()
        },
        progress,
    )
}

/// The same, with more to choose.
///
/// # Errors
/// As there.
pub fn replay_with(
    session: &Session,
    options: &ReplayOptions,
    mut progress: impl FnMut(u64, u64),
) -> Result<ReplayReport, ReplayError> {
    let scene = recorded_scene(session)?;
    let wanted = wanted(session, options)?;
    let all = wanted.len() as u64;
    // Without the keyframe of the start, ticks before the first that there is.
    let before = if options.from == 0 {
        wanted.start as u64
    } else {
        0
    };
    let (stretches, unreached) = stretches::divide(session, wanted);
    let started = std::time::Instant::now();
    let next = AtomicUsize::new(0);
    // The first stretch that parts: those after it are of no interest.
    let parted = AtomicUsize::new(usize::MAX);
    let mut found: Vec<Option<Result<Found, ReplayError>>> =
        (0..stretches.len()).map(|_| None).collect();
    let jobs = options.jobs.clamp(1, stretches.len().max(1));
    std::thread::scope(|scope| {
        let (tell, told) = mpsc::channel();
        for _ in 0..jobs {
            let (tell, next, parted, stretches, scene) =
                (tell.clone(), &next, &parted, &stretches, &scene);
            scope.spawn(move || {
                let mut runner = Runner::new(session, Follower::new(scene, session));
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    let Some(stretch) = stretches
                        .get(k)
                        .filter(|_| k < parted.load(Ordering::Relaxed))
                    else {
                        break;
                    };
                    let abandon = || parted.load(Ordering::Relaxed) < k;
                    let done = runner.run(stretch, abandon, |ticks| {
                        drop(tell.send(News::Ticks(ticks)))
                    });
                    let Some(done) = done.transpose() else {
                        continue;
                    };
                    if done
                        .as_ref()
                        .map_or(true, |found| found.divergence.is_some())
                    {
                        parted.fetch_min(k, Ordering::Relaxed);
                    }
                    let _ = tell.send(News::Found(k, Box::new(done)));
                }
            });
        }
        drop(tell);
        let mut ticks_done = 0;
        for news in told {
            match news {
                News::Ticks(ticks) => {
                    ticks_done += ticks;
                    progress(ticks_done, all);
                }
                News::Found(k, done) => found[k] = Some(*done),
            }
        }
    });
    let elapsed_s = started.elapsed().as_secs_f64();
    let mut report = ReplayReport {
        ticks_matched: 0,
        ticks_recorded: session.ticks.len() as u64,
        ticks_unreached: before + unreached,
        nets_matched: 0,
        stretches: stretches.len() as u64,
        gaps: session.gaps() + missing_at_start(session),
        clean: session.is_clean() && session.cut_short.is_none(),
        same_build: session
            .header
            .run
            .get("build")
            .is_some_and(|build| *build == build_id()),
        first_difference: None,
        divergence: None,
        realtime_factor: 0.0,
        jobs,
        session_hash: String::new(),
    };
    let mut session_hash = SessionHash::default();
    for (stretch, found) in stretches.iter().zip(found) {
        // In order of ticks: none is missing before the first that parts.
        let Some(found) = found.transpose()? else {
            break;
        };
        take_in(session, stretch, &found, &mut session_hash);
        report.ticks_matched += found.ticks;
        report.nets_matched += found.nets;
        if let Some(divergence) = found.divergence {
            report.first_difference = Some(divergence.difference.clone());
            report.divergence = Some(divergence);
            break;
        }
    }
    report.realtime_factor = report.ticks_matched as f64 * scene.dt_s / elapsed_s.max(1e-9);
    report.session_hash = format!("{:016x}", session_hash.0);
    Ok(report)
}

/// What threads tell.
enum News {
    Ticks(u64),
    Found(usize, Box<Result<Found, ReplayError>>),
}

/// Hashes of ticks that were equal are those recorded.
fn take_in(session: &Session, stretch: &Stretch, found: &Found, hash: &mut SessionHash) {
    for record in session.ticks[stretch.records.clone()]
        .iter()
        .take(found.ticks as usize)
    {
        hash.push(record.output.tick, record.output.state_hash);
    }
}

/// Indices of the ticks to replay: all after the keyframe to start from.
fn wanted(
    session: &Session,
    options: &ReplayOptions,
) -> Result<std::ops::Range<usize>, ReplayError> {
    let ReplayOptions { from, until, .. } = *options;
    let first = session.keyframes.first();
    let none = ReplayError::NoKeyframe {
        from,
        first: first.map(|keyframe| keyframe.tick),
    };
    let keyframe = match from {
        0 => first,
        _ => session
            .keyframes
            .iter()
            .rev()
            .find(|keyframe| keyframe.tick <= from),
    };
    let keyframe = keyframe.ok_or(none)?;
    let start = session
        .ticks
        .partition_point(|record| record.output.tick <= keyframe.tick);
    let end = session
        .ticks
        .partition_point(|record| record.output.tick <= until);
    let edge = |record: Option<&palpate_sim::tick::record::TickRecord>| {
        record.map_or(0, |record| record.output.tick)
    };
    let (first, last) = (edge(session.ticks.first()), edge(session.ticks.last()));
    if until < from || from > last || until < first {
        return Err(ReplayError::NoTicks {
            from,
            until,
            first,
            last,
        });
    }
    Ok(start..end.max(start))
}

/// A recording begins with a keyframe, and its first tick is the next: of a part of a longer
/// session as well.
fn missing_at_start(session: &Session) -> u64 {
    let (Some(keyframe), Some(record)) = (session.keyframes.first(), session.ticks.first()) else {
        return 0;
    };
    record
        .output
        .tick
        .saturating_sub(keyframe.tick.saturating_add(1))
}
