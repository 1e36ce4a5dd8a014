//! The recorder thread's side of the rings: everything in the order of the simulation, encoded.
//!
//! Order: the record of tick t, its nets, then commands and keyframes of the state after it in the
//! order in which they came (a keyframe says how many commands it holds), then tick t + 1.

use super::channel::Topic;
use super::head::BodyHead;
use super::message::Message;
use super::port::Applied;
use palpate_drive::journal::JournalGauges;
use palpate_drive::nets::NetFrame;
use palpate_drive::stats::{LATE_NS, StageHistograms};
use palpate_geometry::math::SavedState;
use palpate_proto::recording as pb;
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::{TickFault, TickRecord, ToolOutput};
use palpate_sim::tick::stage::StageTimes;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// A record but for its tools. Contacts of pairs stay behind: a replay makes them again.
#[derive(Clone, Copy)]
pub(super) struct TickHead {
    tick: u64,
    net_revision: u64,
    state_hash: u64,
    late_ns: u64,
    shift_ns: i64,
    wait_ns: Option<u64>,
    skipped: u32,
    stage_ns: StageTimes,
    moving: bool,
    quality: u8,
    fault: Option<TickFault>,
}

impl TickHead {
    pub fn of(record: &TickRecord) -> Self {
        let output = &record.output;
        Self {
            tick: output.tick,
            net_revision: output.net_revision,
            state_hash: output.state_hash,
            late_ns: record.late_ns,
            shift_ns: record.shift_ns,
            wait_ns: record.wait_ns,
            skipped: record.input.skipped,
            stage_ns: record.stage_ns,
            moving: output.moving,
            quality: output.quality,
            fault: output.fault,
        }
    }
}

/// What was applied to a tool, and what came out.
#[derive(Clone, Copy)]
pub(super) struct ToolRow {
    pub pose: Option<DevicePose>,
    pub output: ToolOutput,
}

pub(super) struct KeyframeBuffer {
    pub tick: u64,
    pub hash: u64,
    /// Commands after `tick` that the state holds already.
    pub commands: u32,
    /// What the recorder had asked for when this was made.
    pub generation: u32,
    pub saved: SavedState,
}

/// Place of a message among those of the same tick.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Net,
    /// Commands before it, and whether it is a keyframe.
    After(u32, bool),
}

struct WaitingMessage {
    place: (u64, Rank),
    /// Seen by an earlier drain: whatever comes before it has come.
    settled: bool,
    message: Message,
}

/// Reads the rings.
pub(super) struct TickStream {
    heads: rtrb::Consumer<TickHead>,
    rows: rtrb::Consumer<ToolRow>,
    commands: rtrb::Consumer<Applied>,
    keyframes: rtrb::Consumer<Arc<KeyframeBuffer>>,
    nets: Vec<rtrb::Consumer<Arc<NetFrame>>>,
    gauges: Arc<JournalGauges>,
    pub bodies: Vec<BodyHead>,
    tool_count: usize,
    waiting: Vec<WaitingMessage>,
    /// Tick after which the last commands acted, and how many.
    commanded: (u64, u32),
    record: TickRecord,
    stages: StageHistograms,
    late: u64,
    skipped: u64,
    last_tick: u64,
}

impl TickStream {
    pub fn new(
        scene: &Scene,
        heads: rtrb::Consumer<TickHead>,
        rows: rtrb::Consumer<ToolRow>,
        commands: rtrb::Consumer<Applied>,
        keyframes: rtrb::Consumer<Arc<KeyframeBuffer>>,
        nets: Vec<rtrb::Consumer<Arc<NetFrame>>>,
        gauges: Arc<JournalGauges>,
    ) -> Self {
        let bodies = (0..scene.body_count()).map(|body| {
            let (degree, count) = scene.net_size(body);
            BodyHead {
                id: scene.body_id(body).to_owned(),
                degree,
                count,
            }
        });
        Self {
            heads,
            rows,
            commands,
            keyframes,
            nets,
            gauges,
            bodies: bodies.collect(),
            tool_count: scene.tool_count(),
            waiting: Vec::new(),
            commanded: (0, 0),
            record: TickRecord::for_tools(scene.tool_count()),
            stages: StageHistograms::default(),
            late: 0,
            skipped: 0,
            last_tick: 0,
        }
    }

    /// The loop has gone on with another scene: nothing more comes. What is there still waits for
    /// [`TickStream::drain`].
    pub fn is_abandoned(&self) -> bool {
        self.heads.is_abandoned()
    }

    /// The loop never took this scene, and never will.
    pub fn is_unused(&self) -> bool {
        self.heads.is_abandoned() && self.heads.is_empty() && self.keyframes.is_empty()
    }

    /// Hands over what has come, in order. At the `end` nothing waits for what may still come.
    pub fn drain(&mut self, end: bool, mut take: impl FnMut(Message)) {
        // What a tick left beside its record came before the next record: of what comes meanwhile,
        // records wait.
        let ticks = self.heads.slots();
        self.collect();
        for _ in 0..ticks {
            let Ok(head) = self.heads.pop() else { break };
            self.release((head.tick, Rank::Net), &mut take);
            self.tick(&head, &mut take);
        }
        if end {
            self.waiting
                .iter_mut()
                .for_each(|waiting| waiting.settled = true);
        }
        // Without a next tick, what stood here before comes now.
        let settled = self
            .waiting
            .iter()
            .filter(|waiting| waiting.settled)
            .map(|waiting| waiting.place)
            .max();
        if let Some(place) = settled {
            self.release_at(place, &mut take);
        }
        self.waiting
            .iter_mut()
            .for_each(|waiting| waiting.settled = true);
    }

    /// Takes what waits beside the records.
    fn collect(&mut self) {
        while let Ok((after_tick, command)) = self.commands.pop() {
            let before = if self.commanded.0 == after_tick {
                self.commanded.1
            } else {
                0
            };
            self.commanded = (after_tick, before + 1);
            self.wait(
                (after_tick, Rank::After(before + 1, false)),
                Message::command(after_tick, command),
            );
        }
        while let Ok(buffer) = self.keyframes.pop() {
            let message = Message::keyframe(
                buffer.tick,
                buffer.hash,
                buffer.commands,
                &buffer.saved,
                buffer.generation,
            );
            self.wait((buffer.tick, Rank::After(buffer.commands, true)), message);
        }
        for body in 0..self.nets.len() {
            while let Ok(frame) = self.nets[body].pop() {
                let head = &self.bodies[body];
                let message = Message::net(frame.tick, frame.revision, body, head, &frame.points);
                self.wait((frame.tick, Rank::Net), message);
            }
        }
    }

    fn wait(&mut self, place: (u64, Rank), message: Message) {
        let at = self
            .waiting
            .partition_point(|waiting| waiting.place <= place);
        self.waiting.insert(
            at,
            WaitingMessage {
                place,
                settled: false,
                message,
            },
        );
    }

    /// What comes before a place.
    fn release(&mut self, place: (u64, Rank), take: &mut impl FnMut(Message)) {
        let end = self
            .waiting
            .partition_point(|waiting| waiting.place < place);
        self.waiting
            .drain(..end)
            .for_each(|waiting| take(waiting.message));
    }

    fn release_at(&mut self, place: (u64, Rank), take: &mut impl FnMut(Message)) {
        let end = self
            .waiting
            .partition_point(|waiting| waiting.place <= place);
        self.waiting
            .drain(..end)
            .for_each(|waiting| take(waiting.message));
    }

    fn tick(&mut self, head: &TickHead, take: &mut impl FnMut(Message)) {
        let record = &mut self.record;
        for tool in 0..self.tool_count {
            let Ok(row) = self.rows.pop() else { break };
            (record.input.poses[tool], record.output.tools[tool]) = (row.pose, row.output);
        }
        let output = &mut record.output;
        (output.tick, output.net_revision, output.state_hash) =
            (head.tick, head.net_revision, head.state_hash);
        (output.moving, output.quality, output.fault) = (head.moving, head.quality, head.fault);
        (record.late_ns, record.input.skipped, record.stage_ns) =
            (head.late_ns, head.skipped, head.stage_ns);
        (record.shift_ns, record.wait_ns) = (head.shift_ns, head.wait_ns);
        take(Message::tick(record, self.tool_count));
        self.last_tick = head.tick;
        self.stages.add(&head.stage_ns);
        self.late += u64::from(head.late_ns > LATE_NS);
        self.skipped += u64::from(head.skipped);
        if let Some(fault) = head.fault {
            let said = fault.said(|body| format!("{body} (from 0)"));
            take(Message::event(head.tick, "fault", &said));
        }
        if head.tick.is_multiple_of(100) {
            take(self.stats());
        }
    }

    /// Statistics since the start.
    pub fn stats(&self) -> Message {
        let stats = pb::Stats {
            tick: self.last_tick,
            late_ticks: self.late,
            skipped_ticks: self.skipped,
            stage_ns: self
                .stages
                .named()
                .flat_map(|(_, h)| [h.quantile(0.5), h.quantile(0.99), h.max()])
                .collect(),
            dropped_records: self.gauges.dropped.load(Ordering::Relaxed),
        };
        Message::new(Topic::Stats, self.last_tick, &stats)
    }

    /// Newest tick handed over.
    pub fn last_tick(&self) -> u64 {
        self.last_tick
    }
}
