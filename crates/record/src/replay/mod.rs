//! Replay: the recorded inputs through the same step, compared bit for bit.
//!
//! ```text
//! chunks with keyframes ─▶ segments, each from a keyframe up to and including another ─▶ threads ─▶ first difference by tick
//! ```
//! Each segment must reach the state of the next keyframe, so that all of them together are as
//! strong as one replay from end to end, and what is found does not depend on the number of
//! threads. Where ticks are missing it goes on from the next keyframe: a loss is a gap, not a
//! difference.

mod compare;
mod divergence;
mod error;
mod scene;
mod stretches;
mod team;

pub use compare::Difference;
pub(super) use compare::compared_words;
pub use divergence::Divergence;
pub use error::ReplayError;
pub use scene::recorded_scene;

use super::build_id;
use super::channel::Topic;
use super::message::SessionHash;
use super::reader::{
    Follower, Place, Session, first_keyframe, keyframe_chunks, last_keyframe_until,
};
use serde::Serialize;
use std::sync::Arc;
use stretches::Segment;
use team::Team;

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
/// A file or scene that cannot be replayed; a difference is not an error but part of the report.
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

/// [`replay`] with more to choose.
///
/// # Errors
/// As there.
pub fn replay_with(
    session: &Session,
    options: &ReplayOptions,
    mut progress: impl FnMut(u64, u64),
) -> Result<ReplayReport, ReplayError> {
    let scene = Arc::new(recorded_scene(session)?);
    let (start, state_tick) = start(session, options)?;
    let last = session.tick_range().map_or(0, |(_, last)| last);
    let span = last.min(options.until).saturating_sub(state_tick);
    let all = span.min(session.tick_count());
    let segments = segments(session, start);
    let started = std::time::Instant::now();
    let mut report = ReplayReport {
        ticks_matched: 0,
        ticks_recorded: session.tick_count(),
        ticks_unreached: 0,
        nets_matched: 0,
        stretches: 0,
        gaps: 0,
        clean: false,
        same_build: session
            .header
            .run
            .get("build")
            .is_some_and(|build| *build == build_id()),
        first_difference: None,
        divergence: None,
        realtime_factor: 0.0,
        jobs: options.jobs.clamp(1, segments.len().max(1)),
        session_hash: String::new(),
    };
    if options.from == 0 {
        // Without the keyframe of the start, ticks before the first that there is.
        report.ticks_unreached = ticks_before(session, start)?;
    }
    let mut session_hash = SessionHash::default();
    let team = Team {
        session,
        scene: &scene,
        segments: &segments,
        until: options.until,
        jobs: report.jobs,
    };
    let mut matched = 0;
    team.run(
        |done| progress(done, all),
        |equal| {
            // Hashes of ticks that were equal are those recorded.
            for (tick, state_hash) in equal {
                session_hash.push(tick, state_hash);
                matched += 1;
            }
        },
        |found| {
            report.ticks_unreached += found.unreached;
            report.nets_matched += found.nets;
            report.stretches += found.stretches;
            report.gaps = report.gaps.saturating_add(found.gaps);
            report.divergence = found.divergence;
        },
    )?;
    report.ticks_matched = matched;
    let difference = report.divergence.as_ref();
    report.first_difference = difference.map(|divergence| divergence.difference.clone());
    // What the index says of ticks that were not replayed, and what was found of those that were.
    let missing = session.gaps().saturating_add(missing_at_start(session)?);
    report.gaps = report.gaps.max(missing);
    report.clean = session.is_whole();
    let elapsed_s = started.elapsed().as_secs_f64();
    report.realtime_factor = report.ticks_matched as f64 * scene.dt_s / elapsed_s.max(1e-9);
    report.session_hash = session_hash.to_string();
    Ok(report)
}

/// The keyframe to start from: its place, and its tick.
fn start(session: &Session, options: &ReplayOptions) -> Result<(Place, u64), ReplayError> {
    let ReplayOptions { from, until, .. } = *options;
    let first = first_keyframe(session)?;
    let first_tick = first.as_ref().map(|(_, keyframe)| keyframe.tick);
    let keyframe = match from {
        0 => first,
        _ => last_keyframe_until(session, from, |_| true)?,
    };
    let none = ReplayError::NoKeyframe {
        from,
        first: first_tick,
    };
    let (place, keyframe) = keyframe.ok_or(none)?;
    let (first, last) = session.tick_range().unwrap_or((0, 0));
    if until < from || from > last || until < first {
        return Err(ReplayError::NoTicks {
            from,
            until,
            first,
            last,
        });
    }
    Ok((place, keyframe.tick))
}

/// From a keyframe on: a segment for each chunk that has any.
fn segments(session: &Session, start: Place) -> Vec<Segment> {
    let mut chunks = keyframe_chunks(session);
    chunks.retain(|chunk| *chunk > start.chunk());
    let mut places = vec![start];
    places.extend(chunks.iter().map(|&chunk| Place::of_chunk(chunk)));
    let ends = chunks.into_iter().map(Some).chain([None]);
    let segments = places.into_iter().zip(ends);
    segments
        .map(|(start, end)| Segment { start, end })
        .collect()
}

/// Ticks before a place.
fn ticks_before(session: &Session, place: Place) -> Result<u64, ReplayError> {
    let mut follower = Follower::new(session).only(&[Topic::Tick]);
    let mut ticks = 0;
    while let Some(happening) = follower.next() {
        happening?;
        if follower.place() > place {
            break;
        }
        ticks += 1;
    }
    Ok(ticks)
}

/// A recording begins with a keyframe, and its first tick is the next: of a part of a longer
/// session as well.
fn missing_at_start(session: &Session) -> Result<u64, ReplayError> {
    let (Some((_, keyframe)), Some((first, _))) = (first_keyframe(session)?, session.tick_range())
    else {
        return Ok(0);
    };
    Ok(first.saturating_sub(keyframe.tick.saturating_add(1)))
}
