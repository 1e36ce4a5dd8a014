//! Segments of a session: each from the first keyframe of a chunk up to and including the first
//! keyframe of another, whose state it must reach. Together they are as strong as one replay from
//! end to end, and each may run on a thread of its own.
//!
//! A segment has a stretch for each keyframe in it: ticks without a gap, from the keyframe on.

use super::super::channel::{Happening, Keyframe, NetRecord};
use super::super::reader::{Follower, Place, Session};
use super::super::rerun::Rerun;
use super::compare::{Difference, compare, compare_net};
use super::divergence::{Divergence, WINDOW};
use super::error::ReplayError;
use palpate_geometry::math::Point3;
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::TickRecord;
use std::collections::VecDeque;
use std::sync::Arc;

/// What one thread replays at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Segment {
    /// Its first keyframe.
    pub start: Place,
    /// It ends with the first keyframe of this chunk, or with the recording.
    pub end: Option<usize>,
}

/// What the replay of a segment found.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Findings {
    /// Nets equal by bits.
    pub nets: u64,
    /// Ticks that no keyframe leads to.
    pub unreached: u64,
    /// Ticks that are missing.
    pub gaps: u64,
    /// Keyframes that ticks followed.
    pub stretches: u64,
    /// Where it parts, with the ticks around.
    pub divergence: Option<Divergence>,
}

/// Ticks that were equal by bits: number, and hash of the state.
pub(super) type Equal = Vec<(u64, u64)>;

/// Replays segments one after the other, with buffers made once.
pub(super) struct Runner<'a> {
    session: &'a Session,
    rerun: Rerun,
    /// Last tick to replay.
    until: u64,
    net: Vec<Point3>,
    /// Not handed out yet.
    equal: Equal,
    /// The last replayed ticks of the stretch.
    recent: VecDeque<TickRecord>,
}

/// Where a segment is.
#[derive(Default)]
struct At {
    /// The first keyframe was met.
    begun: bool,
    /// The state is that after this tick; `None` after a gap.
    state: Option<u64>,
    /// Newest tick that was met.
    last: Option<u64>,
    /// A keyframe whose state was not taken yet.
    keyframe: Option<Keyframe>,
    /// A keyframe's state was taken, and no tick followed yet.
    fresh: bool,
    /// The keyframe that ends the segment was met.
    closing: bool,
}

impl<'a> Runner<'a> {
    pub fn new(session: &'a Session, scene: &Arc<Scene>, until: u64) -> Self {
        Self {
            session,
            rerun: Rerun::new(scene),
            until,
            net: Vec::new(),
            equal: Vec::new(),
            recent: VecDeque::with_capacity(WINDOW + 1),
        }
    }

    /// `None` when `abandon` says that the result is not wanted any more. `equal` gets the ticks
    /// that were equal, some at a time.
    pub fn run(
        &mut self,
        segment: &Segment,
        abandon: impl Fn() -> bool,
        equal: impl Fn(Equal),
    ) -> Result<Option<Findings>, ReplayError> {
        const AT_A_TIME: usize = 100;
        let mut follower = Follower::at(self.session, segment.start);
        let (mut at, mut found) = (At::default(), Findings::default());
        self.equal.clear();
        loop {
            let place = follower.place();
            let Some(happening) = follower.next() else {
                break;
            };
            let happening = happening?;
            if !at.begun && !matches!(happening, Happening::Keyframe(_)) {
                // It belongs to the segment before.
                continue;
            }
            let parted = match happening {
                Happening::Tick(record) => {
                    if at.closing || record.output.tick > self.until {
                        break;
                    }
                    let parted = self.seated(&mut at)?;
                    if parted.is_some() {
                        follower.go(place);
                        parted
                    } else {
                        self.recorded_tick(&record, &mut at, &mut found)
                    }
                }
                Happening::Keyframe(keyframe) => {
                    if keyframe.tick > self.until {
                        break;
                    }
                    // A chunk that a damaged one hides ends it as well.
                    at.closing |= segment
                        .end
                        .is_some_and(|end| follower.place().chunk() >= end);
                    self.reached(keyframe, &mut at, &mut found)
                }
                Happening::Command(after_tick, command) => {
                    let parted = self.seated(&mut at)?;
                    if at.state.is_some_and(|state| after_tick <= state) && parted.is_none() {
                        self.rerun.command(command);
                    }
                    parted
                }
                Happening::Net(net) if at.state == Some(net.tick) && at.keyframe.is_none() => {
                    self.recorded_net(&net, &mut found)
                }
                Happening::Net(_)
                | Happening::Event(_)
                | Happening::Inputs(_)
                | Happening::Other(_) => None,
            };
            if let Some(difference) = parted {
                found.divergence = Some(self.part(difference, follower.place())?);
                break;
            }
            if self.equal.len() == AT_A_TIME {
                equal(std::mem::take(&mut self.equal));
                if abandon() {
                    return Ok(None);
                }
            }
        }
        equal(std::mem::take(&mut self.equal));
        Ok(Some(found))
    }

    /// Takes the state of the keyframe that was met last, if that was not done yet.
    fn seated(&mut self, at: &mut At) -> Result<Option<Difference>, ReplayError> {
        let Some(keyframe) = at.keyframe.take() else {
            return Ok(None);
        };
        let tick = keyframe.tick;
        let hash = self
            .rerun
            .seat(&keyframe.saved)
            .map_err(|source| ReplayError::State { tick, source })?;
        self.recent.clear();
        (at.state, at.fresh) = (Some(tick), true);
        Ok((hash != keyframe.state_hash)
            .then(|| keyframe_difference(tick, keyframe.state_hash, hash)))
    }

    /// A keyframe was met: the state of its tick must be its own.
    fn reached(
        &mut self,
        keyframe: Keyframe,
        at: &mut At,
        found: &mut Findings,
    ) -> Option<Difference> {
        let (tick, recorded) = (keyframe.tick, keyframe.state_hash);
        at.begun = true;
        if at.last.is_some_and(|last| tick < last) {
            // Of the past: nothing can be said about it here.
            return None;
        }
        if let Some(last) = at.last {
            found.gaps = found.gaps.saturating_add(tick - last);
        }
        let parted = match (&at.keyframe, at.state) {
            (None, Some(state)) if state == tick => {
                let hash = self.rerun.hash();
                (hash != recorded).then(|| keyframe_difference(tick, recorded, hash))
            }
            (Some(before), _) if before.tick == tick && before.state_hash != recorded => {
                Some(keyframe_difference(tick, recorded, before.state_hash))
            }
            _ => None,
        };
        at.last = Some(tick);
        at.keyframe = Some(keyframe);
        parted
    }

    fn recorded_tick(
        &mut self,
        record: &TickRecord,
        at: &mut At,
        found: &mut Findings,
    ) -> Option<Difference> {
        let tick = record.output.tick;
        if let Some(last) = at.last {
            let missing = tick.saturating_sub(last).saturating_sub(1);
            found.gaps = found.gaps.saturating_add(missing);
        }
        at.last = Some(tick);
        // A tick that is there twice is not a gap: its stretch goes on, and the difference is found.
        // After a gap only a keyframe knows the state; ticks before the next one are skipped.
        if at.state.is_none_or(|state| tick > state.saturating_add(1)) {
            (at.state, at.fresh) = (None, false);
            found.unreached += 1;
            return None;
        }
        found.stretches += u64::from(std::mem::take(&mut at.fresh));
        let output = self.rerun.tick(&record.input);
        at.state = Some(output.tick);
        let tools = self.rerun.scene().tool_count();
        let parted = compare(&record.output, &output, tools);
        if parted.is_none() {
            self.equal.push((tick, output.state_hash));
        }
        self.remember(TickRecord {
            input: record.input.clone(),
            output,
            ..*record
        });
        parted
    }

    fn recorded_net(&mut self, recorded: &NetRecord, found: &mut Findings) -> Option<Difference> {
        let scene = self.rerun.scene();
        let body = (0..scene.body_count()).find(|&body| scene.body_id(body) == recorded.body)?;
        self.rerun.copy_net(body, &mut self.net);
        let parted = compare_net(recorded, &self.net);
        found.nets += u64::from(parted.is_none());
        parted
    }

    fn remember(&mut self, replayed: TickRecord) {
        if self.recent.len() > WINDOW {
            self.recent.pop_front();
        }
        self.recent.push_back(replayed);
    }

    /// Goes on for some ticks after a difference, so that one can see where it leads. `next` is the
    /// place to go on from.
    fn part(&mut self, difference: Difference, next: Place) -> Result<Divergence, ReplayError> {
        let mut replayed: Vec<TickRecord> = self.recent.drain(..).collect();
        let (mut tick, end) = (difference.tick, replayed.len() + WINDOW);
        for happening in Follower::at(self.session, next) {
            match happening? {
                Happening::Tick(record) if Some(record.output.tick) == tick.checked_add(1) => {
                    tick = record.output.tick;
                    replayed.push(TickRecord {
                        output: self.rerun.tick(&record.input),
                        ..*record
                    });
                }
                Happening::Tick(_) => break,
                Happening::Command(after_tick, command) if after_tick <= tick => {
                    self.rerun.command(command);
                }
                _ => {}
            }
            if replayed.len() == end {
                break;
            }
        }
        Ok(Divergence {
            difference,
            replayed,
        })
    }
}

fn keyframe_difference(tick: u64, recorded: u64, replayed: u64) -> Difference {
    Difference::of_numbers(tick, "keyframe.state_hash", recorded, replayed)
}
