//! The bus thread: everything that leaves the daemon, and every answer.

use crate::scene::Scene;
use crate::tick::journal::JournalGauges;
use crate::tick::ports::{BusPorts, CommandRequest, LinkCounters, PoseInbox};
use crate::tick::record::{Command, TickOutput, TickRecord};
use crate::tick::stats::{Histogram, LATE_NS};
use crate::wire;
use palpate_proto::codec::{decode, encode, encoding_schema};
use palpate_proto::keys::Keys;
use palpate_proto::messages::{
    ContactSet, ControlNet, EventKind, LoopState, LoopStatus, Message, SceneSnapshot, SimEvent, ToolForce, ToolPose,
};
use palpate_proto::rpc::{METHODS, Reply, Request};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, OnceLock};
use std::thread::{JoinHandle, Thread};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use zenoh::Wait;
use zenoh::bytes::Encoding;
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::Query;
use zenoh::sample::SampleKind;

/// Takes what a viewer shows. Called by the bus thread; must not wait.
pub trait ViewSink: Send {
    /// A tool's newest force.
    fn force(&mut self, tool: usize, force: &ToolForce);
    /// A body's newest net.
    fn net(&mut self, net: &ControlNet);
    /// All contacts, some sixty times a second while there are any, and when they begin and end.
    fn contacts(&mut self, contacts: &ContactSet);
    /// Health.
    fn status(&mut self, status: &LoopStatus);
}

/// What the bus needs to know beside its ports.
pub struct BusSettings {
    /// The scene.
    pub scene: Arc<Scene>,
    /// SHA-256 of the scene file.
    pub scene_hash: [u8; 32],
    /// Instance name.
    pub instance: String,
    /// Viewer, if any.
    pub viewer: Option<Box<dyn ViewSink>>,
    /// Bytes and drops of the recorder, if any.
    pub recorder: Option<Arc<JournalGauges>>,
}

/// A running bus thread.
pub struct Bus {
    stop: Arc<AtomicBool>,
    thread: JoinHandle<BusReport>,
    waker: Thread,
}

/// What the bus saw.
#[derive(Clone, Debug, Default)]
pub struct BusReport {
    /// Events published.
    pub events: u64,
    /// Poses taken, by tool.
    pub poses: Vec<u64>,
}

/// What callbacks hand to the bus thread. Queries wait here until the bus replies.
enum Inbox {
    Rpc(&'static str, Query),
    Scene(Query),
    Status(Query),
    Net(usize, Query),
    Info(Query),
    ToolToken { tool: String, present: bool },
}

/// Requests that may wait for the bus thread; more are refused by silence, and the client's query times out.
const INBOX: usize = 256;
const STATUS_EVERY: Duration = Duration::from_millis(100);
const CONTACTS_EVERY: Duration = Duration::from_micros(16_667);
const NET_REFRESH: Duration = Duration::from_secs(1);

impl Bus {
    /// Declares everything on the session and starts the thread.
    ///
    /// # Errors
    /// Zenoh refused a declaration, or the instance name is no id.
    pub fn start(session: zenoh::Session, ports: BusPorts, settings: BusSettings) -> Result<Self, String> {
        let keys = Keys::new(&settings.instance).map_err(|e| e.to_string())?;
        let stop = Arc::new(AtomicBool::new(false));
        let (inbox, requests) = sync_channel(INBOX);
        let declared = Declared::new(&session, &keys, &settings.scene, &ports, &inbox).map_err(|e| e.to_string())?;
        let shared_stop = stop.clone();
        let wake: Arc<OnceLock<Thread>> = ports.bus_thread.clone();
        let thread = std::thread::Builder::new()
            .name("palpate-bus".into())
            .spawn(move || BusThread::new(session, ports, settings, declared, requests, shared_stop).run())
            .map_err(|e| e.to_string())?;
        let waker = thread.thread().clone();
        let _ = wake.set(waker.clone());
        Ok(Self { stop, thread, waker })
    }

    /// Publishes what is left, undeclares everything and closes the session.
    pub fn finish(self) -> BusReport {
        self.stop.store(true, Ordering::Release);
        self.waker.unpark();
        self.thread.join().unwrap_or_default()
    }
}

fn encoding<M: Message>() -> Encoding {
    Encoding::APPLICATION_OCTET_STREAM.with_schema(encoding_schema::<M>())
}

/// Schema part of a sample's encoding; empty when it has none.
fn schema_of(encoding: &Encoding) -> String {
    let text = encoding.to_string();
    text.split_once(';').map_or(String::new(), |(_, schema)| schema.to_owned())
}

/// Everything declared. Undeclared in this order: nothing comes in before nothing goes out.
struct Declared {
    _pose_subscribers: Vec<zenoh::pubsub::Subscriber<()>>,
    _live_subscriber: zenoh::pubsub::Subscriber<()>,
    _queryables: Vec<zenoh::query::Queryable<()>>,
    _token: zenoh::liveliness::LivelinessToken,
    forces: Vec<Publisher<'static>>,
    nets: Vec<Publisher<'static>>,
    contacts: Publisher<'static>,
    status: Publisher<'static>,
    events: Publisher<'static>,
}

impl Declared {
    fn new(
        session: &zenoh::Session,
        keys: &Keys,
        scene: &Scene,
        ports: &BusPorts,
        inbox: &SyncSender<Inbox>,
    ) -> zenoh::Result<Self> {
        let publisher = |key: String, encoding, priority, congestion, express| {
            session
                .declare_publisher(key)
                .encoding(encoding)
                .priority(priority)
                .congestion_control(congestion)
                .express(express)
                .wait()
        };
        let (drop, block) = (CongestionControl::Drop, CongestionControl::Block);
        let mut forces = Vec::new();
        let mut pose_subscribers = Vec::new();
        for tool in 0..scene.tool_count() {
            let id = scene.tool_id(tool);
            forces.push(publisher(keys.tool_force(id), encoding::<ToolForce>(), Priority::RealTime, drop, true)?);
            let inbox = ports.poses[tool].clone();
            let subscriber = session
                .declare_subscriber(keys.tool_pose(id))
                .callback(move |sample| {
                    if sample.kind() == SampleKind::Put {
                        take_pose(&inbox, &sample.payload().to_bytes(), &schema_of(sample.encoding()));
                    }
                })
                .wait()?;
            pose_subscribers.push(subscriber);
        }
        let mut nets = Vec::new();
        let mut queryables = Vec::new();
        let mut queryable = |key: String, wrap: Box<dyn Fn(Query) -> Inbox + Send + Sync>| -> zenoh::Result<()> {
            let inbox = inbox.clone();
            let callback = move |query| {
                let _ = inbox.try_send(wrap(query));
            };
            queryables.push(session.declare_queryable(key).callback(callback).wait()?);
            Ok(())
        };
        for body in 0..scene.body_count() {
            let key = keys.body_net(scene.body_id(body));
            nets.push(publisher(key.clone(), encoding::<ControlNet>(), Priority::Data, drop, false)?);
            queryable(key, Box::new(move |query| Inbox::Net(body, query)))?;
        }
        queryable(keys.scene(), Box::new(Inbox::Scene))?;
        queryable(keys.status(), Box::new(Inbox::Status))?;
        queryable(keys.meta_info(), Box::new(Inbox::Info))?;
        for method in METHODS {
            queryable(keys.rpc(method), Box::new(move |query| Inbox::Rpc(method, query)))?;
        }
        let live_inbox = inbox.clone();
        let live_keys = keys.clone();
        let live_subscriber = session
            .liveliness()
            .declare_subscriber(keys.live_tool("*"))
            .callback(move |sample| {
                if let Some(tool) = live_keys.tool_of_live(sample.key_expr().as_str()) {
                    let present = sample.kind() == SampleKind::Put;
                    let _ = live_inbox.try_send(Inbox::ToolToken { tool: tool.to_owned(), present });
                }
            })
            .wait()?;
        let token = session.liveliness().declare_token(keys.live_server(&session.zid().to_string())).wait()?;
        Ok(Self {
            _pose_subscribers: pose_subscribers,
            _live_subscriber: live_subscriber,
            _queryables: queryables,
            _token: token,
            forces,
            nets,
            contacts: publisher(keys.contact(), encoding::<ContactSet>(), Priority::DataHigh, drop, false)?,
            status: publisher(keys.status(), encoding::<LoopStatus>(), Priority::DataHigh, drop, false)?,
            events: publisher(keys.event(), encoding::<SimEvent>(), Priority::InteractiveLow, block, false)?,
        })
    }
}

/// Decodes, checks, stores. Runs on a receive thread: counts what it refuses and never logs a flood.
fn take_pose(inbox: &PoseInbox, bytes: &[u8], schema: &str) {
    match decode::<ToolPose>(bytes, schema) {
        Err(error) => {
            if inbox.counters.malformed.fetch_add(1, Ordering::Relaxed) == 0 {
                tracing::warn!(%error, "a pose was dropped; later ones are only counted");
            }
        }
        Ok(pose) => match pose.validated() {
            Err(error) => {
                if inbox.counters.invalid.fetch_add(1, Ordering::Relaxed) == 0 {
                    tracing::warn!(%error, "a pose was dropped; later ones are only counted");
                }
            }
            Ok(pose) => {
                inbox.offer(wire::device_pose(&pose));
            }
        },
    }
}

struct BusThread {
    session: zenoh::Session,
    ports: BusPorts,
    settings: BusSettings,
    declared: Option<Declared>,
    requests: Receiver<Inbox>,
    stop: Arc<AtomicBool>,
    output: TickOutput,
    nets: Vec<ControlNet>,
    status: LoopStatus,
    pending: Vec<(u64, Query)>,
    next_id: u64,
    events: u64,
    period: Histogram,
    step: Histogram,
    /// By tool: refused poses, stale ticks, in contact, stale now.
    tools: Vec<ToolTally>,
    last_status: Instant,
    last_contacts: Instant,
    /// Anything touched in the last tick seen.
    touching: bool,
    last_nets: Instant,
    lockstep: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct ToolTally {
    jumps: u64,
    stale_ticks: u64,
    touching: bool,
    stale: bool,
    refused: bool,
    joined: bool,
}

impl BusThread {
    fn new(
        session: zenoh::Session,
        ports: BusPorts,
        settings: BusSettings,
        declared: Declared,
        requests: Receiver<Inbox>,
        stop: Arc<AtomicBool>,
    ) -> Self {
        let scene = &settings.scene;
        let nets = wire::all_nets(scene, &scene.initial_state());
        let status = LoopStatus {
            tick: 0,
            state: LoopState::Running,
            rate_hz: 1.0 / scene.dt_s,
            late_ticks: 0,
            skipped_ticks: 0,
            period: Default::default(),
            step: Default::default(),
            tools: Vec::new(),
            recorder_bytes: 0,
            recorder_drops: 0,
            quality_level: 0,
        };
        let now = Instant::now();
        Self {
            tools: vec![ToolTally::default(); scene.tool_count()],
            lockstep: scene.clock == crate::scene::spec::Clock::Lockstep,
            session,
            ports,
            declared: Some(declared),
            requests,
            stop,
            output: TickOutput::default(),
            nets,
            status,
            pending: Vec::new(),
            next_id: 1,
            events: 0,
            period: Histogram::default(),
            step: Histogram::default(),
            last_status: now,
            last_contacts: now,
            touching: false,
            last_nets: now,
            settings,
        }
    }

    fn run(mut self) -> BusReport {
        while !self.stop.load(Ordering::Acquire) {
            std::thread::park_timeout(Duration::from_millis(1));
            self.serve();
        }
        self.serve();
        self.event(EventKind::Stopping);
        self.publish_status();
        for (_, query) in std::mem::take(&mut self.pending) {
            let error = Some("the daemon is going down".to_owned());
            reply_json(&query, &Reply { ok: false, tick: None, error });
        }
        self.declared = None;
        if let Err(error) = self.session.close().wait() {
            tracing::warn!(%error, "closing the session");
        }
        let received = |inbox: &Arc<PoseInbox>| inbox.counters.received.load(Ordering::Relaxed);
        BusReport { events: self.events, poses: self.ports.poses.iter().map(received).collect() }
    }

    fn serve(&mut self) {
        self.publish_forces();
        while let Ok(record) = self.ports.records.pop() {
            self.tally(&record);
        }
        self.answer_again();
        self.publish_nets();
        while let Ok(request) = self.requests.try_recv() {
            self.answer(request);
        }
        while let Ok(receipt) = self.ports.receipts.pop() {
            if let Some(k) = self.pending.iter().position(|(id, _)| *id == receipt.id) {
                let (_, query) = self.pending.swap_remove(k);
                reply_json(&query, &Reply { ok: true, tick: Some(receipt.tick), error: None });
            }
        }
        if self.last_status.elapsed() >= STATUS_EVERY {
            self.publish_status();
        }
    }

    fn declared(&self) -> &Declared {
        self.declared.as_ref().expect("taken only at the end of run")
    }

    fn publish_forces(&mut self) {
        let mut fresh = false;
        while let Ok(output) = self.ports.outputs.pop() {
            // In lockstep every tick's force is awaited; in real time only the newest counts.
            if self.lockstep || self.ports.outputs.is_empty() {
                self.output = output;
                fresh = true;
                for tool in 0..self.tools.len() {
                    self.put_force(tool);
                }
            }
        }
        if fresh {
            self.publish_contacts();
        }
    }

    fn put_force(&mut self, tool: usize) {
        let out = &self.output.tools[tool];
        if out.pose_seq == 0 {
            return;
        }
        let force = wire::tool_force(self.output.tick, server_ns(), out);
        let _ = self.declared().forces[tool].put(encode(&force)).wait();
        if let Some(viewer) = &mut self.settings.viewer {
            viewer.force(tool, &force);
        }
    }

    /// A duplicate pose means that its force got lost.
    fn answer_again(&mut self) {
        for tool in 0..self.tools.len() {
            if self.ports.poses[tool].asked_again.swap(false, Ordering::AcqRel) && self.lockstep {
                self.put_force(tool);
            }
        }
    }

    fn publish_contacts(&mut self) {
        let mut changed = false;
        for (tally, out) in self.tools.iter_mut().zip(&self.output.tools) {
            changed |= tally.touching != out.contact.is_some();
            tally.touching = out.contact.is_some();
        }
        // Bodies may touch without a tool.
        let any = !self.output.contacts.list().is_empty();
        changed |= self.touching != any;
        self.touching = any;
        let due = self.last_contacts.elapsed() >= CONTACTS_EVERY && any;
        if changed || due {
            self.last_contacts = Instant::now();
            let set = wire::contact_set(&self.settings.scene, &self.output);
            if let Some(viewer) = &mut self.settings.viewer {
                viewer.contacts(&set);
            }
            let _ = self.declared().contacts.put(encode(&set)).wait();
        }
    }

    fn publish_nets(&mut self) {
        let refresh = self.last_nets.elapsed() >= NET_REFRESH;
        for body in 0..self.nets.len() {
            let mut fresh = None;
            let scene = &self.settings.scene;
            self.ports.nets[body].newest(|frame| {
                fresh = Some(wire::control_net(scene, body, frame.tick, frame.revision, &frame.points));
            });
            let changed = fresh.is_some();
            if let Some(net) = fresh {
                self.nets[body] = net;
            }
            if changed || refresh {
                let _ = self.declared().nets[body].put(encode(&self.nets[body])).wait();
                if let Some(viewer) = &mut self.settings.viewer {
                    viewer.net(&self.nets[body]);
                }
            }
        }
        if refresh {
            self.last_nets = Instant::now();
        }
    }

    fn tally(&mut self, record: &TickRecord) {
        use crate::scene::flags;
        self.status.tick = record.output.tick;
        self.status.late_ticks += u64::from(record.late_ns > LATE_NS);
        self.status.skipped_ticks += u64::from(record.skipped);
        let dt_ns = (self.settings.scene.dt_s * 1e9) as u64;
        self.period.add(dt_ns * (1 + u64::from(record.skipped)) + record.late_ns);
        self.step.add(record.stage_ns.iter().map(|&ns| u64::from(ns)).sum());
        for t in 0..self.tools.len() {
            let out = &record.output.tools[t];
            let id = || self.settings.scene.tool_id(t).to_owned();
            let mut events = Vec::new();
            let tally = &mut self.tools[t];
            let stale = out.flags & flags::STALE != 0;
            let refused = out.flags & flags::REFUSED != 0;
            tally.stale_ticks += u64::from(stale);
            tally.jumps += u64::from(refused);
            if !tally.joined && out.pose_seq > 0 {
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
        if record.output.fault.is_some() {
            self.event(EventKind::Fault { reason: "a state was not finite; the body was set back to rest".into() });
        }
    }

    fn event(&mut self, kind: EventKind) {
        self.events += 1;
        let event = SimEvent { tick: self.status.tick, seq: self.events, t_ns: server_ns(), kind };
        let _ = self.declared().events.put(encode(&event)).wait();
    }

    fn publish_status(&mut self) {
        self.last_status = Instant::now();
        self.status.period = wire::quantiles(&self.period);
        self.status.step = wire::quantiles(&self.step);
        self.period.clear();
        self.step.clear();
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
            self.status.recorder_bytes = recorder.bytes.load(Ordering::Relaxed);
            self.status.recorder_drops = recorder.dropped.load(Ordering::Relaxed);
        }
        let _ = self.declared().status.put(encode(&self.status)).wait();
        if let Some(viewer) = &mut self.settings.viewer {
            viewer.status(&self.status);
        }
    }

    fn answer(&mut self, request: Inbox) {
        match request {
            Inbox::Scene(query) => {
                let scene = &self.settings.scene;
                let snapshot = wire::scene_snapshot(scene, self.settings.scene_hash, &self.nets, &self.output);
                reply::<SceneSnapshot>(&query, &snapshot);
            }
            Inbox::Status(query) => reply(&query, &self.status),
            Inbox::Net(body, query) => reply(&query, &self.nets[body]),
            Inbox::Info(query) => reply_json(&query, &self.info()),
            Inbox::ToolToken { tool, present } => {
                if let (false, Some(t)) = (present, self.settings.scene.tool_index(&tool)) {
                    self.ports.poses[t].forget_sender();
                }
            }
            Inbox::Rpc(method, query) => self.rpc(method, query),
        }
    }

    fn info(&self) -> serde_json::Value {
        let scene = &self.settings.scene;
        serde_json::json!({
            "name": "palpate",
            "version": env!("CARGO_PKG_VERSION"),
            "instance": self.settings.instance,
            "scene": scene.name,
            "rate_hz": 1.0 / scene.dt_s,
            "tools": (0..scene.tool_count()).map(|t| scene.tool_id(t)).collect::<Vec<_>>(),
            "bodies": (0..scene.body_count()).map(|b| scene.body_id(b)).collect::<Vec<_>>(),
            "messages": [ToolPose::NAME, ToolForce::NAME, ControlNet::NAME, ContactSet::NAME, LoopStatus::NAME,
                SimEvent::NAME, SceneSnapshot::NAME],
        })
    }

    fn rpc(&mut self, method: &'static str, query: Query) {
        let payload = query.payload().map(|p| p.to_bytes().into_owned()).unwrap_or_default();
        let request = match Request::parse(&payload) {
            Ok(request) => request,
            Err(error) => {
                let error = Some(format!("the arguments of {method} do not parse: {error}"));
                return reply_json(&query, &Reply { ok: false, tick: None, error });
            }
        };
        let (command, event) = match method {
            "reset" => (Command::Reset, Some(EventKind::Reset)),
            "pause" => (Command::Pause, Some(EventKind::Paused)),
            "resume" => (Command::Resume, Some(EventKind::Resumed)),
            "step" => (Command::Step(request.ticks.unwrap_or(1)), None),
            _ => (Command::Stop, None),
        };
        let id = self.next_id;
        self.next_id += 1;
        if self.ports.commands.push(CommandRequest { id, command }).is_err() {
            let error = Some("too many commands are waiting; try again".to_owned());
            return reply_json(&query, &Reply { ok: false, tick: None, error });
        }
        match command {
            Command::Pause => self.status.state = LoopState::Paused,
            Command::Resume => self.status.state = LoopState::Running,
            Command::Stop => self.status.state = LoopState::Stopping,
            Command::Reset | Command::Step(_) | Command::Quality(_) => {}
        }
        self.pending.push((id, query));
        if let Some(kind) = event {
            self.event(kind);
        }
    }
}

fn reply<M: Message>(query: &Query, message: &M) {
    let _ = query.reply(query.key_expr().clone(), encode(message)).encoding(encoding::<M>()).wait();
}

fn reply_json(query: &Query, value: &impl serde::Serialize) {
    let text = serde_json::to_string(value).unwrap_or_default();
    let _ = query.reply(query.key_expr().clone(), text).encoding(Encoding::APPLICATION_JSON).wait();
}

fn server_ns() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |t| t.as_nanos() as u64)
}
