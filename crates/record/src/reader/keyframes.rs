//! Where the states are that a replay or a player may start from.

use super::super::channel::{Happening, Keyframe, Topic};
use super::error::ReadError;
use super::follower::{Follower, Place};
use super::session::Session;

/// Chunks that have keyframes, in order.
pub(in super::super) fn keyframe_chunks(session: &Session) -> Vec<usize> {
    let chunks = session.chunks().iter().enumerate();
    let with = chunks.filter(|(_, chunk)| chunk.keyframe);
    with.map(|(k, _)| k).collect()
}

impl Place {
    /// Start of a chunk.
    pub(in super::super) fn of_chunk(chunk: usize) -> Self {
        Self { chunk, entry: 0 }
    }

    /// Its chunk, by number.
    pub(in super::super) fn chunk(self) -> usize {
        self.chunk
    }
}

/// The first keyframe of a session.
///
/// # Errors
/// As of [`Follower`].
pub(in super::super) fn first_keyframe(
    session: &Session,
) -> Result<Option<(Place, Keyframe)>, ReadError> {
    first_keyframe_where(session, |_| true)
}

/// The first keyframe in the file that is accepted.
///
/// # Errors
/// As of [`Follower`].
pub(in super::super) fn first_keyframe_where(
    session: &Session,
    accept: impl Fn(&Keyframe) -> bool,
) -> Result<Option<(Place, Keyframe)>, ReadError> {
    for chunk in keyframe_chunks(session) {
        if let Some(found) = keyframes_of(session, chunk, &accept)?.0 {
            return Ok(Some(found));
        }
    }
    Ok(None)
}

/// The last keyframe in the file, at or before a tick, that is accepted.
///
/// # Errors
/// As of [`Follower`].
pub(in super::super) fn last_keyframe_until(
    session: &Session,
    tick: u64,
    accept: impl Fn(&Keyframe) -> bool,
) -> Result<Option<(Place, Keyframe)>, ReadError> {
    let until_ns = tick.saturating_mul(session.dt_ns());
    let accept = |keyframe: &Keyframe| keyframe.tick <= tick && accept(keyframe);
    for (chunk, _) in (session.chunks().iter().enumerate())
        .rev()
        .filter(|(_, chunk)| chunk.keyframe && chunk.from_ns <= until_ns)
    {
        if let Some(found) = keyframes_of(session, chunk, accept)?.1 {
            return Ok(Some(found));
        }
    }
    Ok(None)
}

type PlacedKeyframe = Option<(Place, Keyframe)>;

/// The first and the last keyframe of a chunk that are accepted.
fn keyframes_of(
    session: &Session,
    chunk: usize,
    accept: impl Fn(&Keyframe) -> bool,
) -> Result<(PlacedKeyframe, PlacedKeyframe), ReadError> {
    let place = Place::of_chunk(chunk);
    let mut follower = Follower::at(session, place).only(&[Topic::Keyframe]);
    let (mut first, mut last) = (None, None);
    while let Some(happening) = follower.next_until(chunk) {
        if let Happening::Keyframe(keyframe) = happening?
            && accept(&keyframe)
        {
            let mut place = follower.place();
            place.entry -= 1;
            if first.is_none() {
                first = Some((place, keyframe.clone()));
            }
            last = Some((place, keyframe));
        }
    }
    Ok((first, last))
}

/// The last tick from `from` to `until` that a session has.
///
/// # Errors
/// As of [`Follower`].
pub(in super::super) fn last_tick_between(
    session: &Session,
    from: u64,
    until: u64,
) -> Result<Option<u64>, ReadError> {
    let [from_ns, until_ns] = [from, until].map(|tick| tick.saturating_mul(session.dt_ns()));
    for (chunk, _) in (session.chunks().iter().enumerate())
        .rev()
        .filter(|(_, chunk)| chunk.from_ns <= until_ns && chunk.to_ns >= from_ns)
    {
        let place = Place::of_chunk(chunk);
        let mut follower = Follower::at(session, place).only(&[Topic::Tick]);
        let mut last = None;
        while let Some(happening) = follower.next_until(chunk) {
            let tick = happening?.tick();
            if (from..=until).contains(&tick) {
                last = last.max(Some(tick));
            }
        }
        if last.is_some() {
            return Ok(last);
        }
    }
    Ok(None)
}
