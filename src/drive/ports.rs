//! Between the tick thread and the rest: wait-free on the tick's side, nothing allocated after the
//! start.
//!
//! ```text
//! PoseInbox (newest wins) ─▶ ┐                ┌─▶ outputs (force known)   ┐
//! commands ────────────────▶ ├─ tick thread ──┼─▶ records (tick done)     ├─▶ bus
//!                            ┘                └─▶ nets, command receipts  ┘
//! ```

use super::inbox::InboxSlot;
pub use super::inbox::{LinkCounters, Offered, PoseInbox};
use super::overload::CAUSES;
use super::swap::Swap;
use palpate_geometry::math::Point3;
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::{Scene, SceneState, quality};
use palpate_sim::tick::record::{Command, TickOutput, TickRecord};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock};
use std::thread::Thread;

/// Outputs and records in flight: a quarter of a second at 1 kHz.
const RING: usize = 256;
/// Nets a second at most.
const NET_HZ: f64 = 60.0;
/// Net buffers a body.
const NET_BUFFERS: usize = 4;

/// A command and the number under which its receipt comes back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommandRequest {
    /// Chosen by the sender.
    pub id: u64,
    /// What to do.
    pub command: Command,
}

/// First tick on which a command had effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Receipt {
    /// Of the request.
    pub id: u64,
    /// Tick.
    pub tick: u64,
}

/// A net on its way to the bus.
#[derive(Clone, Debug)]
pub struct NetFrame {
    /// After this tick.
    pub tick: u64,
    /// Revision.
    pub revision: u64,
    /// Body index.
    pub body: usize,
    /// u-major, m.
    pub points: Vec<Point3>,
}

/// The tick's end of a net port.
pub(super) struct NetPort {
    free: rtrb::Consumer<Box<NetFrame>>,
    full: rtrb::Producer<Box<NetFrame>>,
    sent_revision: u64,
    sent_tick: u64,
    /// Its body moves, so that there are buffers.
    moves: bool,
}

/// The bus's end of a net port.
pub struct NetEnd {
    free: rtrb::Producer<Box<NetFrame>>,
    full: rtrb::Consumer<Box<NetFrame>>,
}

impl NetEnd {
    /// Hands the newest net to `use_it`, dropping older ones.
    pub fn newest(&mut self, mut use_it: impl FnMut(&NetFrame)) {
        let mut newest = None;
        while let Ok(frame) = self.full.pop() {
            if let Some(old) = newest.replace(frame) {
                let _ = self.free.push(old);
            }
        }
        if let Some(frame) = newest {
            use_it(&frame);
            let _ = self.free.push(frame);
        }
    }
}

/// Ticks that overran for one cause.
#[derive(Debug, Default)]
pub struct Overruns {
    /// How many.
    pub count: AtomicU64,
    /// The longest, ns.
    pub worst_ns: AtomicU64,
}

/// Counters of the loop that anyone may read.
#[derive(Debug, Default)]
pub struct LoopCounters {
    /// Records the bus did not take in time.
    pub bus_drops: AtomicU64,
    /// Overruns since the bus last looked, by cause.
    pub overruns: [Overruns; CAUSES.len()],
    /// Why quality last changed: index of a cause, or [`super::overload::QUIET`].
    pub quality_cause: AtomicUsize,
    /// Asks the loop to fade its forces and end.
    pub stop: AtomicBool,
    /// The loop has ended.
    pub finished: AtomicBool,
}

/// The tick thread's side.
pub struct TickPorts {
    pub(super) poses: Vec<triple_buffer::Output<Option<DevicePose>>>,
    /// By tool: newest seq that a tick took.
    pub(super) latched: Vec<u64>,
    pub(super) link_counters: Vec<Arc<LinkCounters>>,
    pub(super) commands: rtrb::Consumer<CommandRequest>,
    pub(super) receipts: rtrb::Producer<Receipt>,
    /// Scenes to go on with, and those that were left.
    pub(super) swaps: rtrb::Consumer<Box<Swap>>,
    pub(super) retired: rtrb::Producer<Box<Swap>>,
    outputs: rtrb::Producer<TickOutput>,
    records: rtrb::Producer<TickRecord>,
    pub(super) nets: Vec<NetPort>,
    net_every: u64,
    pub(super) counters: Arc<LoopCounters>,
    bus_thread: Arc<OnceLock<Thread>>,
    pub(super) tick_thread: Arc<OnceLock<Thread>>,
}

/// The other side.
pub struct BusPorts {
    /// By tool.
    pub poses: Vec<Arc<PoseInbox>>,
    /// To the tick.
    pub commands: rtrb::Producer<CommandRequest>,
    /// From the tick.
    pub receipts: rtrb::Consumer<Receipt>,
    /// The next scene, to the tick; one at a time.
    pub swaps: rtrb::Producer<Box<Swap>>,
    /// The scene before it, from the tick.
    pub retired: rtrb::Consumer<Box<Swap>>,
    /// Forces, as soon as they are known.
    pub outputs: rtrb::Consumer<TickOutput>,
    /// Ticks, when they are done.
    pub records: rtrb::Consumer<TickRecord>,
    /// By body.
    pub nets: Vec<NetEnd>,
    /// Of the loop.
    pub counters: Arc<LoopCounters>,
    /// To be set to the thread that serves these ports: it is unparked when a force is ready.
    pub bus_thread: Arc<OnceLock<Thread>>,
    /// The thread that ticks, once it runs: in lockstep it sleeps until it is unparked.
    pub tick_thread: Arc<OnceLock<Thread>>,
}

/// Both ends of the nets of a scene, by body.
pub(super) fn net_ports(scene: &Scene) -> (Vec<NetPort>, Vec<NetEnd>) {
    let (mut nets, mut net_ends) = (Vec::new(), Vec::new());
    for body in 0..scene.body_count() {
        let (mut free_in, free_out) = rtrb::RingBuffer::new(NET_BUFFERS);
        let (full_in, full_out) = rtrb::RingBuffer::new(NET_BUFFERS);
        if scene.deforms(body) {
            let points = scene.rest_surface(body).net().points();
            for _ in 0..NET_BUFFERS {
                let frame = NetFrame {
                    tick: 0,
                    revision: 0,
                    body,
                    points: points.to_vec(),
                };
                let fits = free_in.push(Box::new(frame)).is_ok();
                debug_assert!(fits, "the ring has room for all");
            }
        }
        nets.push(NetPort {
            free: free_out,
            full: full_in,
            sent_revision: 0,
            sent_tick: 0,
            moves: scene.deforms(body),
        });
        net_ends.push(NetEnd {
            free: free_in,
            full: full_out,
        });
    }
    (nets, net_ends)
}

/// Both sides for a scene.
pub fn ports(scene: &Scene) -> (TickPorts, BusPorts) {
    let tick_thread = Arc::new(OnceLock::new());
    let bus_thread = Arc::new(OnceLock::new());
    let counters = Arc::new(LoopCounters::default());
    let (mut poses, mut inboxes, mut link_counters) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..scene.tool_count() {
        let (input, output) = triple_buffer::triple_buffer(&None);
        let counters = Arc::new(LinkCounters::default());
        poses.push(output);
        link_counters.push(counters.clone());
        inboxes.push(Arc::new(PoseInbox {
            slot: Mutex::new(InboxSlot { newest: 0, input }),
            counters,
            asked_again: AtomicBool::new(false),
            tick_thread: tick_thread.clone(),
        }));
    }
    let (command_in, command_out) = rtrb::RingBuffer::new(64);
    let (receipt_in, receipt_out) = rtrb::RingBuffer::new(64);
    let (output_in, output_out) = rtrb::RingBuffer::new(RING);
    let (record_in, record_out) = rtrb::RingBuffer::new(RING);
    let (swap_in, swap_out) = rtrb::RingBuffer::new(1);
    let (retired_in, retired_out) = rtrb::RingBuffer::new(1);
    let (nets, net_ends) = net_ports(scene);
    let tick = TickPorts {
        latched: vec![0; poses.len()],
        poses,
        link_counters,
        commands: command_out,
        receipts: receipt_in,
        swaps: swap_out,
        retired: retired_in,
        outputs: output_in,
        records: record_in,
        nets,
        net_every: ((1.0 / scene.dt_s / NET_HZ).round() as u64).max(1),
        counters: counters.clone(),
        bus_thread: bus_thread.clone(),
        tick_thread: tick_thread.clone(),
    };
    let bus = BusPorts {
        poses: inboxes,
        commands: command_in,
        receipts: receipt_out,
        swaps: swap_in,
        retired: retired_out,
        outputs: output_out,
        records: record_out,
        nets: net_ends,
        counters,
        bus_thread,
        tick_thread,
    };
    (tick, bus)
}

impl TickPorts {
    /// Newest pose of a tool that no tick has taken yet.
    pub(super) fn latch(&mut self, tool: usize) -> Option<DevicePose> {
        let slot = &mut self.poses[tool];
        if !slot.update() {
            return None;
        }
        let pose = (*slot.output_buffer())?;
        self.latched[tool] = pose.seq;
        LinkCounters::count(&self.link_counters[tool].latched);
        Some(pose)
    }

    /// True when every tool has a pose that no tick has taken.
    pub(super) fn all_have_news(&self) -> bool {
        self.poses.iter().all(triple_buffer::Output::updated)
    }

    /// The bus has room for another tick with all its nets. For those who may wait: the loop never
    /// does.
    pub fn has_room(&self) -> bool {
        let nets = self
            .nets
            .iter()
            .all(|port| !port.moves || port.free.slots() > 0);
        nets && self.outputs.slots() > 0 && self.records.slots() > 0
    }

    /// Every net is handed over next, whatever was sent before: time runs elsewhere, or stands
    /// still from here on.
    pub fn rewind(&mut self) {
        for port in &mut self.nets {
            (port.sent_revision, port.sent_tick) = (u64::MAX, 0);
        }
    }

    /// Somebody asks the loop to end.
    pub fn stop_asked(&self) -> bool {
        self.counters.stop.load(Ordering::Acquire)
    }

    /// The force is known: tell the bus.
    pub fn publish(&mut self, output: &TickOutput) {
        if self.outputs.push(*output).is_err() {
            self.counters.bus_drops.fetch_add(1, Ordering::Relaxed);
        }
        if let Some(thread) = self.bus_thread.get() {
            thread.unpark();
        }
    }

    /// The tick is done.
    pub fn done(&mut self, scene: &Scene, state: &SceneState, record: &TickRecord) {
        if self.records.push(*record).is_err() {
            self.counters.bus_drops.fetch_add(1, Ordering::Relaxed);
        }
        self.hand_over_nets(scene, state, record.output.tick);
    }

    /// Nets that changed and are due; all of them after [`TickPorts::rewind`].
    pub fn hand_over_nets(&mut self, scene: &Scene, state: &SceneState, tick: u64) {
        let net_every = self.net_every
            * if state.quality < quality::RARE_NETS {
                1
            } else {
                10
            };
        for (body, port) in self.nets.iter_mut().enumerate() {
            let soon = tick < port.sent_tick + net_every && port.sent_revision != u64::MAX;
            if state.net_revision(body) == port.sent_revision || soon {
                continue;
            }
            let Ok(mut frame) = port.free.pop() else {
                continue;
            };
            (frame.tick, frame.revision) = (tick, state.net_revision(body));
            state.copy_net(scene, body, &mut frame.points);
            (port.sent_revision, port.sent_tick) = (frame.revision, tick);
            let _ = port.full.push(frame);
        }
    }
}
