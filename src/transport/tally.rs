//! What the loop did, counted: events when something changes, and the status.

use super::counters;
use super::events::Events;
use super::forces::ForceCounts;
use super::states::{cause_name, quality_reason};
use palpate_client::publisher;
use palpate_drive::journal::JournalGauges;
use palpate_drive::overload::CAUSES;
use palpate_drive::ports::{LinkCounters, LoopCounters, PoseInbox};
use palpate_drive::stats::{Histogram, LATE_NS};
use palpate_proto::codec::encode;
use palpate_proto::keys::Keys;
use palpate_proto::messages::{EventKind, LoopState, LoopStatus, RecorderState, ToolLink};
use palpate_sim::scene::Scene;
use palpate_sim::tick::flags;
use palpate_sim::tick::record::{TickFault, TickOutput, TickRecord, ToolOutput};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use zenoh::Wait;
use zenoh::pubsub::Publisher;

/// Overrun events come at most this often.
const OVERRUNS_EVERY: Duration = Duration::from_secs(1);

/// A force that was degraded for a moment more than so long ago is sound again: what comes and goes is one event.
const RESTORED_AFTER: Duration = Duration::from_millis(100);

/// What was counted of a tool, and how it stood in the last record.
#[derive(Clone, Copy, Debug, Default)]
struct ToolTally {
    jumps: u64,
    stale_ticks: u64,
    refused: bool,
    withheld: bool,
    moved: bool,
    degraded: Degraded,
}

/// A stretch of ticks in which a force is degraded, and all of them.
#[derive(Clone, Copy, Debug, Default)]
struct Degraded {
    /// Since the start.
    ticks: u64,
    /// In this stretch; 0 outside.
    of_stretch: u64,
    /// Ticks since the last of them.
    since: u64,
}

/// What becomes of a force in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    Degraded,
    /// After so many ticks.
    Restored(u64),
}

impl Degraded {
    /// Counts a tick; a stretch ends with so many ticks without.
    fn count(&mut self, degraded: bool, ends_after: u64) -> Option<Turn> {
        let begins = degraded && self.of_stretch == 0;
        if degraded {
            (self.ticks, self.of_stretch, self.since) = (self.ticks + 1, self.of_stretch + 1, 0);
            return begins.then_some(Turn::Degraded);
        }
        self.since += u64::from(self.of_stretch > 0);
        let ends = self.of_stretch > 0 && self.since >= ends_after;
        ends.then(|| Turn::Restored(std::mem::take(&mut self.of_stretch)))
    }
}

impl ToolTally {
    /// Whether a hand moves the tool. A reset takes its pose away, but not its hand: that may be gone when no
    /// pose has come for as long as one may be old.
    fn is_moved(&self, out: &ToolOutput, stale_ticks: f64) -> bool {
        (out.pose_seq > 0 || self.moved) && f64::from(out.pose_age_ticks) <= stale_ticks
    }
}

/// What others count, to be read.
pub(super) struct Gauges {
    /// Links of tools.
    pub poses: Vec<Arc<PoseInbox>>,
    /// The loop.
    pub counters: Arc<LoopCounters>,
    /// The recorder, if there is one.
    pub recorder: Option<Arc<JournalGauges>>,
}

/// The status of the loop, and what it is counted from.
pub(super) struct LoopTally {
    publisher: Publisher<'static>,
    records: rtrb::Consumer<Arc<TickRecord>>,
    gauges: Gauges,
    status: LoopStatus,
    /// A recording is played: what happens is reported as it was.
    played: bool,
    tools: Vec<ToolTally>,
    /// The tick before met a fault.
    faulty: bool,
    period: Histogram,
    /// Lateness, shift and dropped deadlines of the tick before.
    before: Option<(u64, i64, u32)>,
    step: Histogram,
    wait: Histogram,
    /// Since the start, by cause.
    overruns: [u64; CAUSES.len()],
    last_overruns: Instant,
    /// The tick then.
    overruns_tick: u64,
    /// A body has come apart since the loop last stood still, and the bus does not know.
    apart: bool,
    apart_news: bool,
}

impl LoopTally {
    /// Nothing is counted yet.
    pub(super) fn new(
        session: &zenoh::Session,
        keys: &Keys,
        scene: &Scene,
        records: rtrb::Consumer<Arc<TickRecord>>,
        gauges: Gauges,
        played: bool,
    ) -> zenoh::Result<Self> {
        let status = LoopStatus {
            tick: 0,
            state: LoopState::Running,
            rate_hz: 1.0 / scene.dt_s,
            late_ticks: 0,
            skipped_ticks: 0,
            period: Default::default(),
            step: Default::default(),
            tools: Vec::new(),
            recorder: RecorderState::Off,
            recorder_bytes: 0,
            recorder_drops: 0,
            quality_level: 0,
            followed_tool: String::new(),
            shift_s: 0.0,
            wait: Default::default(),
        };
        Ok(Self {
            publisher: publisher::<LoopStatus>(session, keys.status())?,
            records,
            gauges,
            status,
            played,
            faulty: false,
            tools: vec![ToolTally::default(); scene.tool_count()],
            period: Histogram::default(),
            before: None,
            step: Histogram::default(),
            wait: Histogram::default(),
            overruns: [0; CAUSES.len()],
            last_overruns: Instant::now(),
            overruns_tick: 0,
            apart: false,
            apart_news: false,
        })
    }

    /// Counts the ticks that are done, and reports what changed; `see` gets each of them.
    pub(super) fn poll(
        &mut self,
        scene: &Scene,
        events: &mut Events,
        mut see: impl FnMut(&TickRecord),
    ) {
        while let Ok(record) = self.records.pop() {
            self.count(&record, scene, events);
            see(&record);
        }
    }

    fn count(&mut self, record: &TickRecord, scene: &Scene, events: &mut Events) {
        events.reached(record.output.tick);
        self.status.tick = record.output.tick;
        self.status.late_ticks += u64::from(record.late_ns > LATE_NS);
        self.status.skipped_ticks += u64::from(record.input.skipped);
        let dt_ns = (scene.dt_s * 1e9) as u64;
        // From start to start: a tick that drops deadlines moves the next one, and is late by them itself.
        let now = (record.late_ns, record.shift_ns, record.input.skipped);
        if let Some((late_ns, shift_ns, skipped)) = self.before.replace(now) {
            let due_ns = dt_ns * (1 + u64::from(skipped)) + record.late_ns;
            let due_ns = due_ns.saturating_add_signed(record.shift_ns - shift_ns);
            self.period.add(due_ns.saturating_sub(late_ns));
        }
        self.status.shift_s = record.shift_ns as f64 * 1e-9;
        self.step.add(record.stage_ns.total());
        record.wait_ns.into_iter().for_each(|ns| self.wait.add(ns));
        for t in 0..self.tools.len() {
            let out = &record.output.tools[t];
            let id = || scene.tool_id(t).to_owned();
            let tally = &mut self.tools[t];
            let refused = out.flags & flags::REFUSED != 0;
            tally.stale_ticks += u64::from(out.flags & flags::STALE != 0);
            tally.jumps += u64::from(refused);
            let stale_ticks = (scene.spec.tools[t].device.stale_s / scene.dt_s).ceil();
            let moved = tally.is_moved(out, stale_ticks);
            match (std::mem::replace(&mut tally.moved, moved), moved) {
                (false, true) => events.tell(EventKind::ToolJoined { tool: id() }),
                (true, false) => events.tell(EventKind::ToolLost { tool: id() }),
                (false, false) | (true, true) => {}
            }
            if refused && !tally.refused {
                events.tell(EventKind::PoseRefused {
                    tool: id(),
                    reason: "it jumped farther than the tool can move".into(),
                });
            }
            tally.refused = refused;
            let withheld = out.flags & flags::WITHHELD != 0;
            if withheld && !std::mem::replace(&mut tally.withheld, withheld) {
                events.tell(EventKind::ForceWithheld { tool: id() });
            }
            tally.withheld = withheld;
            let ends_after = (RESTORED_AFTER.as_secs_f64() / scene.dt_s).ceil() as u64;
            let degraded = out.flags & flags::DEGRADED != 0;
            match tally.degraded.count(degraded, ends_after) {
                Some(Turn::Degraded) => events.tell(EventKind::ForceDegraded {
                    tool: id(),
                    reason: degraded_reason(record.output.quality).into(),
                }),
                Some(Turn::Restored(ticks)) => {
                    events.tell(EventKind::ForceRestored { tool: id(), ticks });
                }
                None => {}
            }
        }
        self.tell_quality(record.output.quality, events);
        let faulty = record.output.fault.is_some();
        if let Some(fault) = record.output.fault {
            let id = |body: usize| match body < scene.body_count() {
                true => scene.body_id(body).to_owned(),
                false => body.to_string(),
            };
            let mut reason = fault.said(id);
            let apart = matches!(fault, TickFault::CameApart { .. });
            if apart {
                reason += "; the loop is paused, `reset` and `resume` begin anew";
            }
            // Once for each time that it begins, or that the loop is stopped for it.
            let begins = if apart { !self.apart } else { !self.faulty };
            if begins {
                events.tell(EventKind::Fault { reason });
            }
            self.apart_news |= apart && !self.apart;
            self.apart |= apart;
        } else if !record.output.moving {
            self.apart = false;
        }
        self.faulty = faulty;
    }

    /// Ticks whose force was degraded, by tool.
    pub(super) fn degraded(&self) -> Vec<u64> {
        self.tools
            .iter()
            .map(|tally| tally.degraded.ticks)
            .collect()
    }

    /// True once for each time that a body comes apart in a loop that runs.
    pub(super) fn take_apart(&mut self) -> bool {
        std::mem::take(&mut self.apart_news)
    }

    /// The level of quality, when it is another than in the last record.
    fn tell_quality(&mut self, level: u8, events: &mut Events) {
        if level == self.status.quality_level {
            return;
        }
        let cause = self.gauges.counters.quality_cause.load(Ordering::Relaxed);
        let before = self.status.quality_level;
        let reason = quality_reason(before, level, (!self.played).then_some(cause));
        match level > before {
            true => tracing::warn!(
                level,
                reason,
                "quality changed; if it stays so, `palpate doctor SCENE` tells whether this machine holds the scene, \
                 `palpate plan SCENE` what costs"
            ),
            false => tracing::info!(level, reason, "quality changed"),
        }
        self.status.quality_level = level;
        events.tell(EventKind::QualityChanged { level, reason });
    }

    fn tell_overruns(&mut self, scene: &Scene, events: &mut Events) {
        if self.last_overruns.elapsed() < OVERRUNS_EVERY {
            return;
        }
        self.last_overruns = Instant::now();
        let counters = self.gauges.counters.clone();
        for (cause, overruns) in counters.overruns.iter().enumerate() {
            let count = overruns.count.swap(0, Ordering::Relaxed);
            let worst_ns = overruns.worst_ns.swap(0, Ordering::Relaxed);
            self.overruns[cause] += count;
            if count > 0 {
                events.tell(EventKind::Overrun {
                    stage: cause_name(cause).into(),
                    count,
                    worst_ns,
                });
            }
        }
        self.tell_late_steps(scene, events);
    }

    /// Bodies whose steps were put off, since they take longer than the ticks they have.
    fn tell_late_steps(&mut self, scene: &Scene, events: &mut Events) {
        let counters = self.gauges.counters.clone();
        let ticks = self.status.tick.saturating_sub(self.overruns_tick);
        self.overruns_tick = self.status.tick;
        for (body, put_off) in counters.late_steps.take() {
            // The scene may be another by now.
            if body >= scene.body_count() || !scene.steps_apart(body) {
                continue;
            }
            let (id, every) = (scene.body_id(body), scene.steps_every(body));
            let in_time = ticks.saturating_sub(put_off).max(1);
            let now = f64::from(every) * ticks.max(1) as f64 / in_time as f64;
            tracing::warn!(
                body = id,
                "steps every {now:.0} ticks instead of {every}, and is slower than the clock by as much: give it \
                 a larger `every` or fewer nodes; `palpate plan SCENE` shows what fits"
            );
            events.tell(EventKind::Overrun {
                stage: format!("body {id} (steps every {now:.0} ticks instead of {every})"),
                count: put_off,
                worst_ns: (now * scene.dt_s * 1e9) as u64,
            });
        }
    }

    /// Ends a status period: quantiles are of what was counted since the last one.
    pub(super) fn end_period(&mut self, scene: &Scene, events: &mut Events) {
        self.tell_overruns(scene, events);
        self.status.period = counters::quantiles(&self.period);
        self.status.step = counters::quantiles(&self.step);
        self.status.wait = counters::quantiles(&self.wait);
        self.period.clear();
        self.step.clear();
        self.wait.clear();
    }

    /// Publishes the status as it stands.
    pub(super) fn publish(&self) {
        let _ = self.publisher.put(encode(&self.status)).wait();
    }

    /// Brings the status up to date with what others count: `output` is the newest one, `state`
    /// what the loop was asked to do.
    pub(super) fn read_gauges(
        &mut self,
        scene: &Scene,
        output: &TickOutput,
        state: LoopState,
        forces: &[ForceCounts],
    ) {
        self.status.state = state;
        let followed = self.gauges.counters.followed.load(Ordering::Relaxed);
        self.status.followed_tool = match followed.checked_sub(1) {
            Some(tool) if tool < scene.tool_count() => scene.tool_id(tool).to_owned(),
            _ => String::new(),
        };
        let link = |(t, forces): (usize, &ForceCounts)| {
            let tally = &self.tools[t];
            let counters: &LinkCounters = &self.gauges.poses[t].counters;
            let link = counters::tool_link(
                scene.tool_id(t),
                counters,
                tally.jumps,
                tally.stale_ticks,
                output.tools[t].energy_j,
            );
            ToolLink {
                forces_sent: forces.sent,
                forces_overtaken: forces.overtaken,
                forces_lost: forces.lost,
                ..link
            }
        };
        self.status.tools = forces.iter().enumerate().map(link).collect();
        if let Some(recorder) = &self.gauges.recorder {
            self.status.recorder = counters::recorder_state(recorder.state.load(Ordering::Relaxed));
            self.status.recorder_bytes = recorder.bytes.load(Ordering::Relaxed);
            self.status.recorder_drops = recorder.dropped.load(Ordering::Relaxed);
        }
    }

    /// The status as of the last [`LoopTally::read_gauges`].
    pub(super) fn status(&self) -> &LoopStatus {
        &self.status
    }

    /// Overruns since the start, by cause.
    pub(super) fn overruns(&self) -> [u64; CAUSES.len()] {
        self.overruns
    }

    /// The loop was asked to end.
    pub(super) fn is_ending(&self) -> bool {
        let LoopCounters { stop, finished, .. } = &*self.gauges.counters;
        stop.load(Ordering::Relaxed) || finished.load(Ordering::Relaxed)
    }

    /// Records that the bus did not take in time.
    pub(super) fn bus_drops(&self) -> u64 {
        self.gauges.counters.bus_drops.load(Ordering::Relaxed)
    }
}

fn degraded_reason(quality: u8) -> &'static str {
    match quality {
        0 => {
            "the step of a body fell back to another matrix or was shortened, or the force may be off by more than 5 % and 0.02 N; `palpate explain` says which"
        }
        _ => "quality is lowered: the machine does not keep up",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_and_goes_within_a_moment_is_degraded_once_and_restored_once() {
        let mut degraded = Degraded::default();
        let mut turns = Vec::new();
        for tick in 0..1_000u64 {
            // Every third tick for a while, then none, then one.
            let now = (100..400).contains(&tick) && tick % 3 == 0 || tick == 700;
            turns.extend(degraded.count(now, 100).map(|turn| (tick, turn)));
        }
        let expected = [
            (102, Turn::Degraded),
            (499, Turn::Restored(100)),
            (700, Turn::Degraded),
            (800, Turn::Restored(1)),
        ];
        assert_eq!(turns, expected);
        assert_eq!(degraded.ticks, 101);
    }

    #[test]
    fn a_tool_is_moved_while_its_poses_are_fresh_and_a_reset_alone_does_not_take_its_hand_away() {
        // The pose in use, its age, whether the tool is moved.
        let rows = [
            ("nobody has come", 0, 1, false),
            ("for long", 0, 9_000, false),
            ("a pose", 1, 0, true),
            ("no other for as long as may be", 1, 50, true),
            ("too long", 1, 51, false),
            ("for ever", 1, 9_000, false),
            ("a pose again", 2, 0, true),
            ("a reset", 0, 1, true),
            ("the next pose", 3, 0, true),
            ("another reset", 0, 1, true),
            ("no pose after it", 0, 50, true),
            ("nor later", 0, 51, false),
            ("a reset when nobody is there", 0, 1, false),
        ];
        let mut tally = ToolTally::default();
        for (what, pose_seq, pose_age_ticks, moved) in rows {
            let out = ToolOutput {
                pose_seq,
                pose_age_ticks,
                ..ToolOutput::default()
            };
            tally.moved = tally.is_moved(&out, 50.0);
            assert_eq!(tally.moved, moved, "{what}");
        }
    }
}
