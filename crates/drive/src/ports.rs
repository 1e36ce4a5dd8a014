//! Between the tick thread and the rest: wait-free on the tick's side, nothing allocated after the
//! start.
//!
//! ```text
//! PoseInbox (newest wins) ─▶ ┐                ┌─▶ outputs (force known)   ┐
//! commands ────────────────▶ ├─ tick thread ──┼─▶ records (tick done)     ├─▶ bus
//!                            ┘                └─▶ nets, command receipts  ┘
//! ```

use super::inbox::{InboxSlot, SentPose};
pub use super::inbox::{LinkCounters, Offered, PoseInbox, SenderId};
use super::nets::NetSchedule;
pub use super::nets::{NetFrame, NetPool};
use super::overload::CAUSES;
use super::pool::Pool;
use super::swap::Swap;
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::Scene;
use palpate_sim::tick::SceneState;
use palpate_sim::tick::record::{Command, TickOutput, TickRecord};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock};
use std::thread::Thread;

/// Outputs and records in flight: a quarter of a second at 1 kHz.
const RING: usize = 256;
/// Outputs or records that the bus reads at once, beside those in the ring.
const IN_HAND: usize = 4;
/// Nets a second at most.
const NET_HZ: f64 = 60.0;
/// Nets of a body in flight.
const NET_RING: usize = 4;
/// Nets of a body that the bus has at once: in the ring, the newest, the one before, and that of who looks
/// inside.
pub const BUS_NETS: usize = NET_RING + 3;

/// A command and the number under which its receipt comes back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommandRequest {
    /// Chosen by the sender.
    pub id: u64,
    /// What to do.
    pub command: Command,
}

/// What a tick publishes, and by tool whose pose it took last.
#[derive(Clone, Debug)]
pub struct Published {
    /// Its forces.
    pub output: TickOutput,
    /// Who sent the poses that they answer; of no one before the first.
    pub senders: Vec<SenderId>,
}

/// First tick on which a command had effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Receipt {
    /// Of the request.
    pub id: u64,
    /// Tick.
    pub tick: u64,
}

/// The tick's end of a scene's nets.
pub(super) struct NetPort {
    /// By body.
    full: Vec<rtrb::Producer<Arc<NetFrame>>>,
    schedule: NetSchedule,
}

/// The bus's end of a body's nets.
pub struct NetEnd {
    full: rtrb::Consumer<Arc<NetFrame>>,
}

impl NetEnd {
    /// The newest net, if one has come; older ones are dropped.
    pub fn newest(&mut self) -> Option<Arc<NetFrame>> {
        let mut newest = None;
        while let Ok(frame) = self.full.pop() {
            newest = Some(frame);
        }
        newest
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

/// Ticks by which steps of bodies were put off because they were not done: by body, those of the first
/// [`LateSteps::BODIES`]; the others count with the last.
#[derive(Debug, Default)]
pub struct LateSteps([AtomicU64; LateSteps::BODIES]);

impl LateSteps {
    /// Bodies that have counts of their own.
    pub const BODIES: usize = 32;

    /// A step of a body is put off by a tick.
    pub fn count(&self, body: u32) {
        let place = (body as usize).min(Self::BODIES - 1);
        self.0[place].fetch_add(1, Ordering::Relaxed);
    }

    /// Ticks since this was asked last, with the bodies, those without any left out.
    pub fn take(&self) -> impl Iterator<Item = (usize, u64)> {
        let counts = self.0.iter().map(|count| count.swap(0, Ordering::Relaxed));
        counts.enumerate().filter(|(_, count)| *count > 0)
    }
}

/// Counters of the loop that anyone may read.
#[derive(Debug, Default)]
pub struct LoopCounters {
    /// Records the bus did not take in time.
    pub bus_drops: AtomicU64,
    /// Overruns since the bus last looked, by cause.
    pub overruns: [Overruns; CAUSES.len()],
    /// Steps that were put off since the bus last looked.
    pub late_steps: LateSteps,
    /// Why quality last changed: index of a cause, or [`super::overload::QUIET`].
    pub quality_cause: AtomicUsize,
    /// Number of the tool whose poses deadlines follow, from 1; 0: none.
    pub followed: AtomicUsize,
    /// Asks the loop to fade its forces and end.
    pub stop: AtomicBool,
    /// The loop has ended.
    pub finished: AtomicBool,
}

/// The tick thread's side.
pub struct TickPorts {
    pub(super) poses: Vec<triple_buffer::Output<Option<SentPose>>>,
    /// By tool: when its newest pose arrived, ns.
    newest_ns: Vec<Arc<AtomicU64>>,
    /// By tool: who sent the newest pose that a tick took.
    senders: Vec<SenderId>,
    /// By tool: when the pose arrived that the newest tick took, if it took one, ns.
    arrived_ns: Vec<Option<u64>>,
    pub(super) link_counters: Vec<Arc<LinkCounters>>,
    pub(super) commands: rtrb::Consumer<CommandRequest>,
    pub(super) receipts: rtrb::Producer<Receipt>,
    /// Scenes to go on with, and those that were left.
    pub(super) swaps: rtrb::Consumer<Box<Swap>>,
    pub(super) retired: rtrb::Producer<Box<Swap>>,
    outputs: Outbox<Published>,
    records: Outbox<TickRecord>,
    pub(super) nets: NetPort,
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
    pub outputs: rtrb::Consumer<Arc<Published>>,
    /// Ticks, when they are done.
    pub records: rtrb::Consumer<Arc<TickRecord>>,
    /// By body.
    pub nets: Vec<NetEnd>,
    /// Of the loop.
    pub counters: Arc<LoopCounters>,
    /// To be set to the thread that serves these ports: it is unparked when a force is ready.
    pub bus_thread: Arc<OnceLock<Thread>>,
    /// The thread that ticks, once it runs: in lockstep it sleeps until it is unparked.
    pub tick_thread: Arc<OnceLock<Thread>>,
}

/// Copies on their way to the bus, in buffers that are there already.
struct Outbox<T> {
    pool: Pool<T>,
    full: rtrb::Producer<Arc<T>>,
}

impl<T: Clone> Outbox<T> {
    /// With the bus's end; `like`: as large as all that is going to be sent.
    fn new(like: &T) -> (Self, rtrb::Consumer<Arc<T>>) {
        let (full, end) = rtrb::RingBuffer::new(RING);
        let pool = Pool::new(RING + IN_HAND, || like.clone());
        (Self { pool, full }, end)
    }

    fn has_room(&self) -> bool {
        self.full.slots() > 0
    }

    /// False when the bus is behind: it does not get this one.
    fn send(&mut self, write: impl FnOnce(&mut T)) -> bool {
        if !self.has_room() {
            return false;
        }
        match self.pool.fill(write) {
            Some(buffer) => self.full.push(buffer.clone()).is_ok(),
            None => false,
        }
    }
}

/// Both ends of the nets of a scene; the bus's are by body.
pub(super) fn net_ports(scene: &Scene) -> (NetPort, Vec<NetEnd>) {
    let rings = (0..scene.body_count()).map(|_| rtrb::RingBuffer::new(NET_RING));
    let (full, ends) = rings
        .map(|(full, end)| (full, NetEnd { full: end }))
        .unzip();
    let schedule = NetSchedule::new(scene, NET_HZ);
    (NetPort { full, schedule }, ends)
}

/// Both sides for a scene.
pub fn ports(scene: &Scene) -> (TickPorts, BusPorts) {
    let tick_thread = Arc::new(OnceLock::new());
    let bus_thread = Arc::new(OnceLock::new());
    let counters = Arc::new(LoopCounters::default());
    let (mut poses, mut inboxes, mut link_counters) = (Vec::new(), Vec::new(), Vec::new());
    let mut newest_ns = Vec::new();
    for _ in 0..scene.tool_count() {
        let (input, output) = triple_buffer::triple_buffer(&None);
        let counters = Arc::new(LinkCounters::default());
        poses.push(output);
        link_counters.push(counters.clone());
        let newest: Arc<AtomicU64> = Arc::default();
        newest_ns.push(newest.clone());
        inboxes.push(Arc::new(PoseInbox {
            slot: Mutex::new(InboxSlot {
                newest: 0,
                holder: None,
                input,
            }),
            counters,
            asked_again: AtomicBool::new(false),
            newest_ns: newest,
            tick_thread: tick_thread.clone(),
        }));
    }
    let (command_in, command_out) = rtrb::RingBuffer::new(64);
    let (receipt_in, receipt_out) = rtrb::RingBuffer::new(64);
    let record = TickRecord::for_tools(scene.tool_count());
    let senders = vec![SenderId::default(); scene.tool_count()];
    let (output_in, output_out) = Outbox::new(&Published {
        output: record.output.clone(),
        senders: senders.clone(),
    });
    let (record_in, record_out) = Outbox::new(&record);
    let (swap_in, swap_out) = rtrb::RingBuffer::new(1);
    let (retired_in, retired_out) = rtrb::RingBuffer::new(1);
    let (nets, net_ends) = net_ports(scene);
    let tick = TickPorts {
        poses,
        newest_ns,
        senders,
        arrived_ns: vec![None; scene.tool_count()],
        link_counters,
        commands: command_out,
        receipts: receipt_in,
        swaps: swap_out,
        retired: retired_in,
        outputs: output_in,
        records: record_in,
        nets,
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
        self.arrived_ns[tool] = None;
        if !slot.update() {
            return None;
        }
        let sent = (*slot.output_buffer())?;
        self.senders[tool] = sent.sender;
        self.arrived_ns[tool] = Some(sent.arrived_ns);
        LinkCounters::count(&self.link_counters[tool].latched);
        Some(sent.pose)
    }

    /// When the poses arrived that the newest tick took, ns of the monotonic clock, by tool.
    pub(super) fn arrivals(&self) -> impl Iterator<Item = (usize, u64)> {
        let arrived = self.arrived_ns.iter().enumerate();
        arrived.filter_map(|(tool, at_ns)| at_ns.map(|at_ns| (tool, at_ns)))
    }

    /// A pose of this tool has come since then, ns of the monotonic clock.
    pub(super) fn has_come_since(&self, tool: usize, since_ns: u64) -> bool {
        self.newest_ns[tool].load(Ordering::Acquire) >= since_ns
    }

    /// True when every tool has a pose that no tick has taken.
    pub(super) fn all_have_news(&self) -> bool {
        self.poses.iter().all(triple_buffer::Output::updated)
    }

    /// The bus has room for another tick with all its nets. For those who may wait: the loop never
    /// does.
    pub fn has_room(&self) -> bool {
        let nets = self.nets.full.iter().all(|full| full.slots() > 0);
        nets && self.outputs.has_room() && self.records.has_room()
    }

    /// Every net is handed over next, whatever was sent before: time runs elsewhere, or stands
    /// still from here on.
    pub fn rewind(&mut self) {
        self.nets.schedule.restart();
    }

    /// Someone asks the loop to end.
    pub fn stop_asked(&self) -> bool {
        self.counters.stop.load(Ordering::Acquire)
    }

    /// The force is known: tell the bus.
    pub fn publish(&mut self, output: &TickOutput) {
        let senders = &self.senders;
        let sent = self.outputs.send(|published| {
            published.output.clone_from(output);
            published.senders.clone_from(senders);
        });
        if !sent {
            self.counters.bus_drops.fetch_add(1, Ordering::Relaxed);
        }
        if let Some(thread) = self.bus_thread.get() {
            thread.unpark();
        }
    }

    /// The tick is done.
    pub fn done(
        &mut self,
        scene: &Scene,
        state: &SceneState,
        record: &TickRecord,
        nets: &mut NetPool,
    ) {
        if !self.records.send(|buffer| buffer.clone_from(record)) {
            self.counters.bus_drops.fetch_add(1, Ordering::Relaxed);
        }
        self.hand_over_nets(scene, state, record.output.tick, nets);
    }

    /// Nets that changed and are due; all of them after [`TickPorts::rewind`].
    pub fn hand_over_nets(
        &mut self,
        scene: &Scene,
        state: &SceneState,
        tick: u64,
        nets: &mut NetPool,
    ) {
        let NetPort { full, schedule } = &mut self.nets;
        for (body, full) in full.iter_mut().enumerate() {
            if !schedule.is_due(state, body, tick) || full.slots() == 0 {
                continue;
            }
            // Without a free frame the net of a later tick will do.
            if let Some(frame) = nets.frame(scene, state, body, tick) {
                schedule.sent(&frame);
                let _ = full.push(frame);
            }
        }
    }
}
