//! The bus thread: everything that leaves the daemon, and every answer.

use super::declared::{Declared, Inbox, Roles};
use super::devices::Devices;
use super::edit::Change;
use super::history::History;
use super::metrics::Figures;
use super::tally::ToolTally;
use crate::scene::Scene;
use crate::tick::archive::Archive;
use crate::tick::editor::Editor;
use crate::tick::journal::JournalGauges;
use crate::tick::overload::CAUSES;
use crate::tick::playback::PlayerEnd;
use crate::tick::ports::{BusPorts, PoseInbox};
use crate::tick::record::TickOutput;
use crate::tick::stats::Histogram;
use crate::wire;
use palpate_proto::codec::encode;
use palpate_proto::keys::Keys;
use palpate_proto::messages::{
    ContactSet, ControlNet, EventKind, LoopState, LoopStatus, RecorderState, SimEvent, ToolForce,
};
use palpate_proto::rpc::Reply;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Arc, OnceLock};
use std::thread::{JoinHandle, Thread};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use zenoh::Wait;
use zenoh::query::Query;

/// Takes what a viewer shows. Called by the bus thread; must not wait.
pub trait ViewSink: Send {
    /// A tool's newest force.
    fn force(&mut self, tool: usize, force: &ToolForce);
    /// A body's newest net.
    fn net(&mut self, net: &ControlNet);
    /// All contacts, some sixty times a second while there are any, and when they begin and end.
    fn contacts(&mut self, contacts: &ContactSet);
    /// Other bodies than before; nets follow. `gaps`: by body, the rows and columns of its net after which no line goes on.
    fn bodies(&mut self, ids: &[&str], gaps: Vec<(String, [Vec<usize>; 2])>);
    /// Health.
    fn status(&mut self, status: &LoopStatus);
    /// Everything that is counted, ten times a second.
    fn figures(&mut self, figures: &Figures);
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
    /// Where its page is.
    pub viewer_url: Option<String>,
    /// Bytes and drops of the recorder, if any.
    pub recorder: Option<Arc<JournalGauges>>,
    /// Who records on demand, if anyone does.
    pub archive: Option<Box<dyn Archive>>,
    /// Who remakes the scene on demand, if anyone does.
    pub editor: Option<Box<dyn Editor>>,
    /// Who plays a recording instead of a loop, if that is what runs here.
    pub player: Option<PlayerEnd>,
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
    /// Forces left out because no hand could tell them from the last one, by tool.
    pub suppressed: Vec<u64>,
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
        let devices = Devices::new(&settings.scene);
        let roles = Roles { player: settings.player.is_some(), viewer: settings.viewer.is_some() };
        let declared = Declared::new(&session, &keys, &settings.scene, &ports, &devices, &inbox, roles)
            .map_err(|e| e.to_string())?;
        let shared_stop = stop.clone();
        let wake: Arc<OnceLock<Thread>> = ports.bus_thread.clone();
        let thread = std::thread::Builder::new()
            .name("palpate-bus".into())
            .spawn(move || {
                BusThread::new(session, keys, ports, settings, declared, devices, requests, shared_stop).run()
            })
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

/// The thread's own.
pub(super) struct BusThread {
    session: zenoh::Session,
    pub(super) keys: Keys,
    pub(super) ports: BusPorts,
    pub(super) settings: BusSettings,
    declared: Option<Declared>,
    pub(super) devices: Devices,
    /// Somebody subscribes to what contacts do, by tool.
    pub(super) contact_wanted: Vec<bool>,
    pub(super) requests: Receiver<Inbox>,
    stop: Arc<AtomicBool>,
    pub(super) output: TickOutput,
    pub(super) nets: Vec<ControlNet>,
    pub(super) status: LoopStatus,
    pub(super) pending: Vec<(u64, Query)>,
    pub(super) next_id: u64,
    pub(super) events: u64,
    pub(super) history: History,
    /// Of the scene, under way.
    pub(super) change: Option<Change>,
    /// Since the start, by cause.
    pub(super) overruns: [u64; CAUSES.len()],
    pub(super) period: Histogram,
    pub(super) step: Histogram,
    /// By tool: refused poses, stale ticks, in contact, stale now.
    pub(super) tools: Vec<ToolTally>,
    pub(super) last_status: Instant,
    pub(super) last_overruns: Instant,
    last_contacts: Instant,
    /// Anything touched in the last tick seen.
    touching: bool,
    last_nets: Instant,
    pub(super) lockstep: bool,
}

impl BusThread {
    fn new(
        session: zenoh::Session,
        keys: Keys,
        ports: BusPorts,
        settings: BusSettings,
        declared: Declared,
        devices: Devices,
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
            recorder: RecorderState::Off,
            recorder_bytes: 0,
            recorder_drops: 0,
            quality_level: 0,
        };
        let now = Instant::now();
        Self {
            tools: vec![ToolTally::default(); scene.tool_count()],
            // In lockstep and out of a recording every force is told.
            lockstep: scene.clock == crate::scene::spec::Clock::Lockstep || settings.player.is_some(),
            session,
            keys,
            ports,
            declared: Some(declared),
            devices,
            contact_wanted: vec![false; scene.tool_count()],
            requests,
            stop,
            output: TickOutput::default(),
            nets,
            status,
            pending: Vec::new(),
            next_id: 1,
            events: 0,
            history: History::default(),
            change: None,
            overruns: [0; CAUSES.len()],
            period: Histogram::default(),
            step: Histogram::default(),
            last_status: now,
            last_overruns: now,
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
        for id in self.pending.iter().map(|(id, _)| *id).collect::<Vec<_>>() {
            self.settle(id, &Reply::refused("the daemon is going down"));
        }
        self.declared = None;
        if let Err(error) = self.session.close().wait() {
            tracing::warn!(%error, "closing the session");
        }
        let received = |inbox: &Arc<PoseInbox>| inbox.counters.received.load(Ordering::Relaxed);
        BusReport {
            events: self.events,
            poses: self.ports.poses.iter().map(received).collect(),
            suppressed: (0..self.tools.len()).map(|tool| self.devices.suppressed(tool)).collect(),
        }
    }

    fn serve(&mut self) {
        let player_news = self.player_news();
        self.take_receipts();
        self.publish_forces();
        // The receipt of a change comes before its first tick: all that came before the change is told now.
        self.follow_change(None);
        while let Ok(record) = self.ports.records.pop() {
            self.tally(&record);
        }
        self.answer_again();
        self.publish_nets();
        while let Ok(request) = self.requests.try_recv() {
            self.answer(request);
        }
        self.take_receipts();
        self.take_archive_news();
        self.take_editor_news();
        self.take_player_news(player_news);
        if self.last_status.elapsed() >= STATUS_EVERY {
            self.publish_status();
        }
    }

    /// What is declared.
    pub(super) fn declared(&self) -> &Declared {
        self.declared.as_ref().expect("taken only at the end of run")
    }

    fn publish_forces(&mut self) {
        let mut fresh = false;
        while let Ok(output) = self.ports.outputs.peek() {
            let tick = output.tick;
            if self.change.is_some() {
                self.take_receipts();
                self.follow_change(Some(tick));
            }
            let Ok(output) = self.ports.outputs.pop() else { break };
            // In lockstep every tick's force is awaited; in real time only the newest counts.
            if self.lockstep || self.ports.outputs.is_empty() {
                self.output = output;
                fresh = true;
                for tool in 0..self.tools.len() {
                    self.put_tool(tool);
                }
            }
        }
        if fresh {
            self.publish_contacts();
        }
    }

    /// What a tick says of a tool: the force for its device, and what contacts do to it.
    fn put_tool(&mut self, tool: usize) {
        let out = self.output.tools[tool];
        if out.pose_seq == 0 {
            return;
        }
        // In lockstep every tick's force is awaited.
        if self.lockstep || self.devices.wants(tool, self.output.tick, &out) {
            self.put_force(tool);
        } else if let Some(viewer) = &mut self.settings.viewer {
            viewer.force(tool, &wire::tool_force(self.output.tick, server_ns(), &out));
        }
        if self.contact_wanted[tool] {
            let limit_n = self.settings.scene.spec.tools[tool].device.force_max_n;
            let limit_n = limit_n.min(self.devices.force_max_n(tool));
            let contact = wire::tool_contact(self.output.tick, limit_n, &out);
            let _ = self.declared().tool_contacts[tool].put(encode(&contact)).wait();
        }
    }

    /// Whom to tell what contacts do: messages that nobody takes are not made.
    pub(super) fn look_for_listeners(&mut self) {
        for tool in 0..self.tools.len() {
            let status = self.declared().tool_contacts[tool].matching_status().wait();
            self.contact_wanted[tool] = status.is_ok_and(|status| status.matching());
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

    /// All nets go out next, changed or not.
    pub(super) fn refresh_nets(&mut self) {
        self.last_nets = self.last_nets.checked_sub(NET_REFRESH).unwrap_or(self.last_nets);
    }

    /// Declares the bodies of the scene as it is now.
    pub(super) fn declare_bodies(&mut self) -> zenoh::Result<()> {
        match &mut self.declared {
            Some(declared) => declared.bodies(&self.session, &self.keys, &self.settings.scene),
            None => Ok(()),
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

    /// Publishes an event.
    pub(super) fn event(&mut self, kind: EventKind) {
        self.events += 1;
        let event = SimEvent { tick: self.status.tick, seq: self.events, t_ns: server_ns(), kind };
        let _ = self.declared().events.put(encode(&event)).wait();
        if let Some(archive) = &mut self.settings.archive {
            let (kind, detail) = wire::event_words(&event.kind);
            archive.event(event.tick, kind, &detail);
        }
        self.history.push(event);
    }

    /// Keeps the recorder's liveliness token as its state is.
    pub(super) fn show_recording(&mut self) {
        let recording = self.status.recorder == RecorderState::Recording;
        if let Some(declared) = &mut self.declared {
            declared.show_recording(&self.session, recording);
        }
    }
}

fn server_ns() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |t| t.as_nanos() as u64)
}
