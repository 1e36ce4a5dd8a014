//! The tick thread's side: bounded rings, no waiting, no allocation. What does not fit is counted
//! and lost, and the file says so.

use super::self_check::room_for_states;
use super::stream::{KeyframeBuffer, TickHead, TickStream, ToolRow};
use palpate_drive::journal::{Journal, JournalGauges};
use palpate_drive::nets::{NetFrame, NetPool, NetSchedule};
use palpate_drive::pool::Pool;
use palpate_sim::scene::Scene;
use palpate_sim::tick::SceneState;
use palpate_sim::tick::record::{Command, TickRecord};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// Ticks the rings hold: eight seconds at 1 kHz, more than a disk stalls.
const RING_TICKS: usize = 8_192;
/// Keyframe buffers: one is filled while others are written.
const KEYFRAME_BUFFERS: usize = 8;
/// Nets of a body in flight: two seconds at 60 Hz.
const NET_RING: usize = 128;

/// A command with the tick after which it acts.
pub(super) type Applied = (u64, Command);

/// The journal of a scene's loop. It sleeps until someone wants ticks, and then begins with a
/// keyframe.
pub struct RecorderPort {
    heads: rtrb::Producer<TickHead>,
    rows: rtrb::Producer<ToolRow>,
    commands: rtrb::Producer<Applied>,
    keyframes: Pool<KeyframeBuffer>,
    full_keyframes: rtrb::Producer<Arc<KeyframeBuffer>>,
    /// By body.
    nets: Vec<rtrb::Producer<Arc<NetFrame>>>,
    net_schedule: NetSchedule,
    gauges: Arc<JournalGauges>,
    /// 0: no one wants ticks. When it changes, someone wants a keyframe to begin with.
    wanted: Arc<AtomicU32>,
    generation: u32,
    /// A keyframe of this generation is still to come.
    owed: bool,
    /// The keyframe to begin with has left: ticks follow.
    open: bool,
    /// A command was lost: ticks after it do not follow from those before, and are lost too, until
    /// the next keyframe.
    torn: bool,
    tool_count: usize,
    keyframe_every: u64,
    /// Tick after which the last commands acted, and how many.
    commanded: (u64, u32),
}

/// Both ends for a scene.
pub(super) fn port(
    scene: &Scene,
    gauges: Arc<JournalGauges>,
    wanted: Arc<AtomicU32>,
) -> (RecorderPort, TickStream) {
    let (heads, heads_out) = rtrb::RingBuffer::new(RING_TICKS);
    let (rows, rows_out) = rtrb::RingBuffer::new(RING_TICKS * scene.tool_count().max(1));
    let (commands, commands_out) = rtrb::RingBuffer::new(RING_TICKS);
    let keyframes = Pool::new(KEYFRAME_BUFFERS, || KeyframeBuffer {
        tick: 0,
        hash: 0,
        commands: 0,
        generation: 0,
        saved: room_for_states(scene),
    });
    let (full_keyframes, keyframes_out) = rtrb::RingBuffer::new(KEYFRAME_BUFFERS);
    let (nets, nets_out) = (0..scene.body_count())
        .map(|_| rtrb::RingBuffer::new(NET_RING))
        .unzip();
    let rate = 1.0 / scene.dt_s;
    let record = &scene.spec.record;
    let port = RecorderPort {
        heads,
        rows,
        commands,
        keyframes,
        full_keyframes,
        nets,
        net_schedule: NetSchedule::new(scene, record.net_hz),
        gauges: gauges.clone(),
        wanted,
        generation: 0,
        owed: false,
        open: false,
        torn: false,
        tool_count: scene.tool_count(),
        keyframe_every: ((record.keyframe_s * rate).round() as u64).max(1),
        commanded: (0, 0),
    };
    (
        port,
        TickStream::new(
            scene,
            heads_out,
            rows_out,
            commands_out,
            keyframes_out,
            nets_out,
            gauges,
        ),
    )
}

impl RecorderPort {
    /// There is room for the next tick: a loop that waits for it loses nothing.
    pub fn has_room(&self) -> bool {
        let quarter = RING_TICKS / 4;
        self.heads.slots() > quarter
            && self.rows.slots() > quarter * self.tool_count
            && self.full_keyframes.slots() > KEYFRAME_BUFFERS / 2
            && self.nets.iter().all(|nets| nets.slots() > NET_RING / 2)
    }

    fn lost(&mut self) {
        self.gauges.dropped.fetch_add(1, Ordering::Relaxed);
        // A replay goes on from the next keyframe: let it come soon.
        self.owed = true;
    }

    /// Looks whether someone wants ticks.
    fn look(&mut self) -> bool {
        let wanted = self.wanted.load(Ordering::Acquire);
        if wanted != self.generation {
            self.open &= self.generation != 0 && wanted != 0;
            (self.generation, self.owed) = (wanted, wanted != 0);
        }
        self.generation != 0
    }

    fn push_tick(&mut self, record: &TickRecord) {
        if self.torn || self.heads.slots() == 0 || self.rows.slots() < self.tool_count {
            return self.lost();
        }
        for tool in 0..self.tool_count {
            let row = ToolRow {
                pose: record.input.poses[tool],
                output: record.output.tools[tool],
            };
            let _ = self.rows.push(row);
        }
        let _ = self.heads.push(TickHead::of(record));
    }

    fn push_nets(&mut self, scene: &Scene, state: &SceneState, tick: u64, nets: &mut NetPool) {
        for (body, full) in self.nets.iter_mut().enumerate() {
            if !self.net_schedule.is_due(state, body, tick) || full.slots() == 0 {
                continue;
            }
            // Without a free frame the net of a later tick will do.
            if let Some(frame) = nets.frame(scene, state, body, tick) {
                self.net_schedule.sent(&frame);
                let _ = full.push(frame);
            }
        }
    }

    fn push_keyframe(&mut self, state: &SceneState, state_hash: u64) {
        let commands = if self.commanded.0 == state.tick {
            self.commanded.1
        } else {
            0
        };
        let generation = self.generation;
        let fill = |buffer: &mut KeyframeBuffer| {
            (buffer.tick, buffer.hash) = (state.tick, state_hash);
            (buffer.commands, buffer.generation) = (commands, generation);
            buffer.saved.save_from(state);
        };
        // Without a free buffer the next tick tries again: a replay starts from any keyframe.
        let Some(buffer) = self.keyframes.fill(fill).cloned() else {
            self.owed = true;
            return;
        };
        // The ring has room for all buffers.
        let _ = self.full_keyframes.push(buffer);
        (self.owed, self.open, self.torn) = (false, true, false);
        // Whoever starts at a keyframe finds every net within a tick of it.
        self.net_schedule.restart();
    }
}

impl Journal for RecorderPort {
    fn tick(&mut self, scene: &Scene, state: &SceneState, record: &TickRecord, nets: &mut NetPool) {
        if !self.look() {
            return;
        }
        let tick = record.output.tick;
        if self.open {
            self.push_tick(record);
            self.push_nets(scene, state, tick, nets);
        }
        if self.owed || tick.is_multiple_of(self.keyframe_every) {
            self.push_keyframe(state, record.output.state_hash);
        }
    }

    fn command(&mut self, after_tick: u64, command: Command) {
        if !self.open || !self.look() {
            return;
        }
        if self.commands.push((after_tick, command)).is_err() {
            self.torn = true;
            return self.lost();
        }
        let before = if self.commanded.0 == after_tick {
            self.commanded.1
        } else {
            0
        };
        self.commanded = (after_tick, before + 1);
    }

    fn keyframe(&mut self, state: &SceneState, hash: u64) {
        if self.look() {
            self.push_keyframe(state, hash);
        }
    }

    fn nets_held(&self) -> usize {
        // In the ring, and the one that is being encoded.
        NET_RING + 1
    }
}
