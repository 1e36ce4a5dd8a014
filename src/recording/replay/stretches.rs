//! Stretches of a session: each from a keyframe up to and including the next, whose state it must
//! reach. Together they are as strong as one replay from end to end, and each may run on a thread
//! of its own.

use super::super::reader::{Keyframe, Session};
use super::ReplayError;
use super::compare::{Difference, compare, compare_net};
use super::divergence::{Divergence, WINDOW};
use super::follow::Follower;
use palpate_geometry::math::Point3;
use palpate_sim::tick::record::TickRecord;
use std::collections::VecDeque;
use std::ops::Range;

/// A part of a session that a keyframe begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Stretch {
    /// Index of its keyframe.
    pub keyframe: usize,
    /// Its ticks, by index.
    pub records: Range<usize>,
}

/// Divides ticks `records` of a session; gives also how many of them no keyframe leads to.
pub(super) fn divide(session: &Session, records: Range<usize>) -> (Vec<Stretch>, u64) {
    let (mut stretches, mut skipped) = (Vec::<Stretch>::new(), 0);
    // Tick of the record before, while a stretch is open.
    let mut last = None;
    for at in records {
        let tick = session.ticks[at].output.tick;
        let end = session
            .keyframes
            .partition_point(|keyframe| keyframe.tick < tick);
        let before = session.keyframes[..end]
            .last()
            .filter(|keyframe| keyframe.tick + 1 == tick);
        // A tick that is there twice is no gap: its stretch goes on, and the difference is found.
        let goes_on = last.is_some_and(|last: u64| tick <= last.saturating_add(1));
        match (before, stretches.last_mut()) {
            (Some(_), _) if last != Some(tick) => {
                stretches.push(Stretch {
                    keyframe: end - 1,
                    records: at..at + 1,
                });
            }
            (_, Some(open)) if goes_on => open.records.end = at + 1,
            // After a gap only a keyframe knows the state; ticks before the next one are skipped.
            _ => {
                skipped += 1;
                last = None;
                continue;
            }
        }
        last = Some(tick);
    }
    (stretches, skipped)
}

/// What the replay of a stretch found.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Found {
    /// Ticks equal by bits.
    pub ticks: u64,
    /// Nets equal by bits.
    pub nets: u64,
    /// Where it parts, with the ticks around.
    pub divergence: Option<Divergence>,
}

/// Replays stretches one after the other, with buffers made once.
pub(super) struct Runner<'a> {
    session: &'a Session,
    follower: Follower<'a>,
    net: Vec<Point3>,
    /// The last replayed ticks of the stretch.
    recent: VecDeque<TickRecord>,
}

impl<'a> Runner<'a> {
    pub fn new(session: &'a Session, follower: Follower<'a>) -> Self {
        Self {
            session,
            follower,
            net: Vec::new(),
            recent: VecDeque::with_capacity(WINDOW + 1),
        }
    }

    /// `None` when `abandon` says that nobody wants to know any more. `progress` is told of so many
    /// more ticks now and then.
    pub fn run(
        &mut self,
        stretch: &Stretch,
        abandon: impl Fn() -> bool,
        progress: impl Fn(u64),
    ) -> Result<Option<Found>, ReplayError> {
        const TELL_EVERY: u64 = 100;
        let session = self.session;
        let keyframe = &session.keyframes[stretch.keyframe];
        let mut found = Found::default();
        self.recent.clear();
        let hash = self.follower.seat(keyframe)?;
        if hash != keyframe.state_hash {
            let difference = Difference::of_numbers(
                keyframe.tick,
                "keyframe.state_hash",
                keyframe.state_hash,
                hash,
            );
            found.divergence = Some(self.part(difference, stretch.records.start));
            return Ok(Some(found));
        }
        let mut told = 0;
        for at in stretch.records.clone() {
            let record = &session.ticks[at];
            let difference = self.tick(record, &mut found.nets);
            if let Some(difference) = difference {
                found.divergence = Some(self.part(difference, at + 1));
                return Ok(Some(found));
            }
            found.ticks += 1;
            if found.ticks - told == TELL_EVERY {
                told = found.ticks;
                progress(TELL_EVERY);
                if abandon() {
                    return Ok(None);
                }
            }
        }
        progress(found.ticks - told);
        let last = session.ticks[stretch.records.end - 1].output.tick;
        let mut done = 0;
        for keyframe in keyframes_of(session, last) {
            let hash = self.follower.reach(keyframe, &mut done);
            if hash != keyframe.state_hash {
                let difference =
                    Difference::of_numbers(last, "keyframe.state_hash", keyframe.state_hash, hash);
                found.divergence = Some(self.part(difference, stretch.records.end));
                break;
            }
        }
        Ok(Some(found))
    }

    fn tick(&mut self, record: &TickRecord, nets_matched: &mut u64) -> Option<Difference> {
        let tick = record.output.tick;
        let output = self.follower.tick(tick, &record.input);
        let scene = self.follower.scene();
        let difference = compare(&record.output, &output, scene.tool_count());
        self.remember(TickRecord {
            input: record.input.clone(),
            output,
            ..*record
        });
        if difference.is_some() {
            return difference;
        }
        let nets = &self.session.nets;
        let first = nets.partition_point(|net| net.tick < tick);
        for recorded in nets[first..].iter().take_while(|net| net.tick == tick) {
            let Some(body) =
                (0..scene.body_count()).find(|&body| scene.body_id(body) == recorded.body)
            else {
                continue;
            };
            self.net.resize(
                scene.rest_surface(body).net().points().len(),
                Point3::origin(),
            );
            self.follower.state().copy_net(scene, body, &mut self.net);
            if let Some(difference) = compare_net(recorded, &self.net) {
                return Some(difference);
            }
            *nets_matched += 1;
        }
        None
    }

    fn remember(&mut self, replayed: TickRecord) {
        if self.recent.len() > WINDOW {
            self.recent.pop_front();
        }
        self.recent.push_back(replayed);
    }

    /// Goes on for some ticks after a difference, so that one can see where it leads. `next` is the
    /// record to go on with.
    fn part(&mut self, difference: Difference, next: usize) -> Divergence {
        let mut replayed: Vec<TickRecord> = self.recent.drain(..).collect();
        let mut tick = difference.tick;
        for record in self.session.ticks.iter().skip(next).take(WINDOW) {
            if record.output.tick != tick.wrapping_add(1) {
                break;
            }
            tick = record.output.tick;
            replayed.push(TickRecord {
                input: record.input.clone(),
                output: self.follower.tick(tick, &record.input),
                ..*record
            });
        }
        Divergence {
            difference,
            replayed,
        }
    }
}

fn keyframes_of(session: &Session, tick: u64) -> &[Keyframe] {
    let first = session
        .keyframes
        .partition_point(|keyframe| keyframe.tick < tick);
    let end = session
        .keyframes
        .partition_point(|keyframe| keyframe.tick <= tick);
    &session.keyframes[first..end]
}
