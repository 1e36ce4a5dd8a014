//! The tick thread's side: bounded rings, no waiting, no allocation. What does not fit is counted
//! and lost, and the file says so.

use super::self_check::room_for_states;
use super::stream::{KeyframeBuffer, NetBuffer, Stream, TickHead, ToolRow};
use crate::drive::journal::{Journal, JournalGauges};
use palpate_sim::scene::{Scene, SceneState, quality};
use palpate_sim::tick::record::{Command, TickRecord};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// Ticks the rings hold: eight seconds at 1 kHz, more than a disk stalls.
const RING_TICKS: usize = 8_192;
/// Keyframe buffers: one is filled while others are written.
const KEYFRAME_BUFFERS: usize = 8;
/// Net buffers a body: two seconds at 60 Hz.
const NET_BUFFERS: usize = 128;

/// A command with the tick after which it acts.
pub(super) type Applied = (u64, Command);

/// Buffers that travel full one way and empty back.
pub(super) struct Pool<T> {
    free: rtrb::Consumer<Box<T>>,
    full: rtrb::Producer<Box<T>>,
}

pub(super) struct PoolEnd<T> {
    pub free: rtrb::Producer<Box<T>>,
    pub full: rtrb::Consumer<Box<T>>,
}

fn pool<T>(buffers: impl ExactSizeIterator<Item = T>) -> (Pool<T>, PoolEnd<T>) {
    let count = buffers.len().max(1);
    let (mut free_in, free_out) = rtrb::RingBuffer::new(count);
    let (full_in, full_out) = rtrb::RingBuffer::new(count);
    for buffer in buffers {
        let fits = free_in.push(Box::new(buffer)).is_ok();
        debug_assert!(fits, "the ring has room for all");
    }
    (
        Pool {
            free: free_out,
            full: full_in,
        },
        PoolEnd {
            free: free_in,
            full: full_out,
        },
    )
}

/// The journal of a scene's loop. It sleeps until somebody wants ticks, and then begins with a
/// keyframe.
pub struct RecorderPort {
    heads: rtrb::Producer<TickHead>,
    rows: rtrb::Producer<ToolRow>,
    commands: rtrb::Producer<Applied>,
    keyframes: Pool<KeyframeBuffer>,
    nets: Vec<Pool<NetBuffer>>,
    gauges: Arc<JournalGauges>,
    /// 0: nobody wants ticks. When it changes, somebody wants a keyframe to begin with.
    wanted: Arc<AtomicU32>,
    generation: u32,
    /// A keyframe of this generation is still to come.
    owed: bool,
    /// The keyframe to begin with has left: ticks follow.
    open: bool,
    tool_count: usize,
    keyframe_every: u64,
    net_every: u64,
    /// By body: revision and tick of the last net sent.
    sent: Vec<(u64, u64)>,
    /// Tick after which the last commands acted, and how many.
    commanded: (u64, u32),
}

/// Both ends for a scene.
pub(super) fn port(
    scene: &Scene,
    gauges: Arc<JournalGauges>,
    wanted: Arc<AtomicU32>,
) -> (RecorderPort, Stream) {
    let (heads, heads_out) = rtrb::RingBuffer::new(RING_TICKS);
    let (rows, rows_out) = rtrb::RingBuffer::new(RING_TICKS * scene.tool_count().max(1));
    let (commands, commands_out) = rtrb::RingBuffer::new(256);
    let buffers = (0..KEYFRAME_BUFFERS).map(|_| KeyframeBuffer {
        tick: 0,
        hash: 0,
        commands: 0,
        generation: 0,
        saved: room_for_states(scene),
    });
    let (keyframes, keyframes_end) = pool(buffers);
    let (nets, net_ends) = (0..scene.body_count())
        .map(|body| {
            let points = scene.rest_surface(body).net().points().to_vec();
            let count = if scene.deforms(body) { NET_BUFFERS } else { 0 };
            pool((0..count).map(move |_| NetBuffer {
                tick: 0,
                revision: 0,
                body,
                points: points.clone(),
            }))
        })
        .unzip();
    let rate = 1.0 / scene.dt_s;
    let record = &scene.spec.record;
    let port = RecorderPort {
        heads,
        rows,
        commands,
        keyframes,
        nets,
        gauges: gauges.clone(),
        wanted,
        generation: 0,
        owed: false,
        open: false,
        tool_count: scene.tool_count(),
        keyframe_every: ((record.keyframe_s * rate).round() as u64).max(1),
        net_every: ((rate / record.net_hz).round() as u64).max(1),
        sent: vec![(0, 0); scene.body_count()],
        commanded: (0, 0),
    };
    (
        port,
        Stream::new(
            scene,
            heads_out,
            rows_out,
            commands_out,
            keyframes_end,
            net_ends,
            gauges,
        ),
    )
}

impl RecorderPort {
    fn lost(&mut self) {
        self.gauges.dropped.fetch_add(1, Ordering::Relaxed);
        // A replay goes on from the next keyframe: let it come soon.
        self.owed = true;
    }

    /// Looks whether somebody wants ticks.
    fn look(&mut self) -> bool {
        let wanted = self.wanted.load(Ordering::Acquire);
        if wanted != self.generation {
            self.open &= self.generation != 0 && wanted != 0;
            (self.generation, self.owed) = (wanted, wanted != 0);
        }
        self.generation != 0
    }

    fn push_tick(&mut self, record: &TickRecord) {
        if self.heads.slots() == 0 || self.rows.slots() < self.tool_count {
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

    fn push_nets(&mut self, scene: &Scene, state: &SceneState, tick: u64) {
        let net_every = self.net_every
            * if state.quality < quality::RARE_NETS {
                1
            } else {
                10
            };
        for body in 0..self.nets.len() {
            let (revision, at) = self.sent[body];
            if state.net_revision(body) == revision
                || (revision != u64::MAX && tick < at + net_every)
            {
                continue;
            }
            // Without a free buffer the net of a later tick will do.
            let Ok(mut buffer) = self.nets[body].free.pop() else {
                continue;
            };
            state.copy_net(scene, body, &mut buffer.points);
            (buffer.tick, buffer.revision) = (tick, state.net_revision(body));
            self.sent[body] = (buffer.revision, tick);
            let _ = self.nets[body].full.push(buffer);
        }
    }

    fn push_keyframe(&mut self, state: &SceneState, state_hash: u64) {
        // Without a free buffer the next tick tries again: a replay starts from any keyframe.
        let Ok(mut buffer) = self.keyframes.free.pop() else {
            self.owed = true;
            return;
        };
        (buffer.tick, buffer.hash, buffer.generation) = (state.tick, state_hash, self.generation);
        buffer.commands = if self.commanded.0 == state.tick {
            self.commanded.1
        } else {
            0
        };
        buffer.saved.save_from(state);
        let _ = self.keyframes.full.push(buffer);
        (self.owed, self.open) = (false, true);
        // Whoever starts at a keyframe finds every net within a tick of it.
        self.sent.fill((u64::MAX, 0));
    }
}

impl Journal for RecorderPort {
    fn tick(&mut self, scene: &Scene, state: &SceneState, record: &TickRecord) {
        if !self.look() {
            return;
        }
        let tick = record.output.tick;
        if self.open {
            self.push_tick(record);
            self.push_nets(scene, state, tick);
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
}
