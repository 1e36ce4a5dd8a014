//! What the loop did, counted: events when something changes, and the status.

use super::bus::BusThread;
use crate::drive::overload::{CAUSES, QUIET};
use crate::drive::ports::LinkCounters;
use crate::drive::stats::LATE_NS;
use crate::wire;
use palpate_proto::codec::encode;
use palpate_proto::messages::EventKind;
use palpate_sim::scene::flags;
use palpate_sim::tick::record::TickRecord;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use zenoh::Wait;

/// Overruns are told at most this often.
const OVERRUNS_EVERY: Duration = Duration::from_secs(1);

/// What was counted of a tool, and how it stood in the last record.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ToolTally {
    pub jumps: u64,
    pub stale_ticks: u64,
    pub touching: bool,
    stale: bool,
    refused: bool,
    joined: bool,
}

impl BusThread {
    /// Counts a tick, and tells what changed.
    pub(super) fn tally(&mut self, record: &TickRecord) {
        self.status.tick = record.output.tick;
        self.status.late_ticks += u64::from(record.late_ns > LATE_NS);
        self.status.skipped_ticks += u64::from(record.skipped);
        let dt_ns = (self.settings.scene.dt_s * 1e9) as u64;
        self.period
            .add(dt_ns * (1 + u64::from(record.skipped)) + record.late_ns);
        self.step.add(record.stage_ns.total());
        for t in 0..self.tools.len() {
            let out = &record.output.tools[t];
            let id = || self.settings.scene.tool_id(t).to_owned();
            let mut events = Vec::new();
            let tally = &mut self.tools[t];
            let stale = out.flags & flags::STALE != 0;
            let refused = out.flags & flags::REFUSED != 0;
            tally.stale_ticks += u64::from(stale);
            tally.jumps += u64::from(refused);
            if !stale && !tally.joined && out.pose_seq > 0 {
                tally.joined = true;
                events.push(EventKind::ToolJoined { tool: id() });
            }
            if stale && !tally.stale {
                events.push(EventKind::ToolLost { tool: id() });
            }
            if refused && !tally.refused {
                events.push(EventKind::PoseRefused {
                    tool: id(),
                    reason: "it jumped farther than the tool can move".into(),
                });
            }
            (tally.stale, tally.refused) = (stale, refused);
            if stale {
                tally.joined = false;
            } else if out.pose_seq > 0 {
                tally.joined = true;
            }
            for kind in events {
                self.event(kind);
            }
        }
        self.tell_quality(record.output.quality);
        if record.output.fault.is_some() {
            self.event(EventKind::Fault {
                reason: "a state was not finite; the body was set back to rest".into(),
            });
        }
    }

    /// The level of quality, when it is another than in the last record.
    fn tell_quality(&mut self, level: u8) {
        if level == self.status.quality_level {
            return;
        }
        let reason = match self.ports.counters.quality_cause.load(Ordering::Relaxed) {
            QUIET => "ticks have ended in good time for a while".to_owned(),
            cause => format!(
                "a tenth of the ticks overran, most of their time in {}",
                cause_name(cause)
            ),
        };
        tracing::warn!(level, reason, "quality changed");
        self.status.quality_level = level;
        self.event(EventKind::QualityChanged { level, reason });
    }

    fn tell_overruns(&mut self) {
        if self.last_overruns.elapsed() < OVERRUNS_EVERY {
            return;
        }
        self.last_overruns = Instant::now();
        let counters = self.ports.counters.clone();
        for (cause, overruns) in counters.overruns.iter().enumerate() {
            let count = overruns.count.swap(0, Ordering::Relaxed);
            let worst_ns = overruns.worst_ns.swap(0, Ordering::Relaxed);
            self.overruns[cause] += count;
            if count > 0 {
                self.event(EventKind::Overrun {
                    stage: cause_name(cause).into(),
                    count,
                    worst_ns,
                });
            }
        }
    }

    pub(super) fn publish_status(&mut self) {
        self.last_status = Instant::now();
        self.look_for_listeners();
        self.tell_overruns();
        self.status.period = wire::quantiles(&self.period);
        self.status.step = wire::quantiles(&self.step);
        self.period.clear();
        self.step.clear();
        self.count_links();
        self.show_recording();
        let _ = self.declared().status.put(encode(&self.status)).wait();
        if let Some(viewer) = &mut self.settings.viewer {
            viewer.status(&self.status);
        }
        if self.settings.viewer.is_some() {
            let figures = self.figures();
            if let Some(viewer) = &mut self.settings.viewer {
                viewer.figures(&figures);
            }
        }
    }

    /// Brings the counters of the status up to date.
    pub(super) fn count_links(&mut self) {
        let scene = self.settings.scene.clone();
        self.status.tools = (0..scene.tool_count())
            .map(|t| {
                let tally = &self.tools[t];
                let counters: &LinkCounters = &self.ports.poses[t].counters;
                wire::tool_link(
                    scene.tool_id(t),
                    counters,
                    tally.jumps,
                    tally.stale_ticks,
                    self.output.tools[t].energy_j,
                )
            })
            .collect();
        if let Some(recorder) = &self.settings.recorder {
            self.status.recorder = wire::recorder_state(recorder.state.load(Ordering::Relaxed));
            self.status.recorder_bytes = recorder.bytes.load(Ordering::Relaxed);
            self.status.recorder_drops = recorder.dropped.load(Ordering::Relaxed);
        }
    }
}

fn cause_name(cause: usize) -> &'static str {
    CAUSES.get(cause).copied().unwrap_or("the system")
}
