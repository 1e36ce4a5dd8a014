//! The bus thread: everything that leaves the daemon, and every answer.

use super::declared::{Declared, Inbox, Roles};
use super::devices::Devices;
use super::edit::Change;
use super::history::History;
use super::metrics::Figures;
use super::tally::ToolTally;
use crate::drive::archive::Archive;
use crate::drive::editor::Editor;
use crate::drive::journal::JournalGauges;
use crate::drive::overload::CAUSES;
use crate::drive::playback::PlayerEnd;
use crate::drive::ports::{BusPorts, PoseInbox};
use crate::drive::stats::Histogram;
use crate::wire;
use palpate_proto::codec::encode;
use palpate_proto::keys::Keys;
use palpate_proto::messages::{
    ContactSet, ControlNet, EventKind, LoopState, LoopStatus, RecorderState, SimEvent, ToolForce,
};
use palpate_proto::rpc::Answer;
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::TickOutput;
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
    /// Other bodies than before; nets follow. `gaps`: by body, the rows and columns of its net
    /// after which no line goes on.
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

/// Requests that may wait for the bus thread; more are refused by silence, and the client's query
/// times out.
const INBOX: usize = 256;
const STATUS_EVERY: Duration = Duration::from_millis(100);

impl Bus {
    /// Declares everything on the session and starts the thread.
    ///
    /// # Errors
    /// Zenoh refused a declaration, or the instance name is no id.
    pub fn start(
        session: zenoh::Session,
        ports: BusPorts,
        settings: BusSettings,
    ) -> Result<Self, String> {
        let keys = Keys::new(&settings.instance).map_err(|e| e.to_string())?;
        let stop = Arc::new(AtomicBool::new(false));
        let (inbox, requests) = sync_channel(INBOX);
        let devices = Devices::new(&settings.scene);
        let roles = Roles {
            player: settings.player.is_some(),
            viewer: settings.viewer.is_some(),
        };
        let declared = Declared::new(
            &session,
            &keys,
            &settings.scene,
            &ports,
            &devices,
            &inbox,
            roles,
        )
        .map_err(|e| e.to_string())?;
        let shared_stop = stop.clone();
        let wake: Arc<OnceLock<Thread>> = ports.bus_thread.clone();
        let thread = std::thread::Builder::new()
            .name("palpate-bus".into())
            .spawn(move || {
                BusThread::new(
                    session,
                    keys,
                    ports,
                    settings,
                    declared,
                    devices,
                    requests,
                    shared_stop,
                )
                .run()
            })
            .map_err(|e| e.to_string())?;
        let waker = thread.thread().clone();
        let _ = wake.set(waker.clone());
        Ok(Self {
            stop,
            thread,
            waker,
        })
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
    pub(super) last_contacts: Instant,
    /// Anything touched in the last tick seen.
    pub(super) touching: bool,
    pub(super) last_nets: Instant,
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
            lockstep: scene.clock == palpate_sim::scene::spec::Clock::Lockstep
                || settings.player.is_some(),
            session,
            keys,
            ports,
            declared: Some(declared),
            devices,
            contact_wanted: vec![false; scene.tool_count()],
            requests,
            stop,
            output: TickOutput::for_tools(scene.tool_count()),
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
            self.settle(id, &Answer::refused("the daemon is going down"));
        }
        self.declared = None;
        if let Err(error) = self.session.close().wait() {
            tracing::warn!(%error, "closing the session");
        }
        let received = |inbox: &Arc<PoseInbox>| inbox.counters.received.load(Ordering::Relaxed);
        BusReport {
            events: self.events,
            poses: self.ports.poses.iter().map(received).collect(),
            suppressed: (0..self.tools.len())
                .map(|tool| self.devices.suppressed(tool))
                .collect(),
        }
    }

    fn serve(&mut self) {
        let player_news = self.player_news();
        self.take_receipts();
        self.publish_forces();
        // The receipt of a change comes before its first tick: all that came before the change is
        // told now.
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
        self.declared
            .as_ref()
            .expect("taken only at the end of run")
    }

    /// Declares the bodies of the scene as it is now.
    pub(super) fn declare_bodies(&mut self) -> zenoh::Result<()> {
        match &mut self.declared {
            Some(declared) => declared.bodies(&self.session, &self.keys, &self.settings.scene),
            None => Ok(()),
        }
    }

    /// Publishes an event.
    pub(super) fn event(&mut self, kind: EventKind) {
        self.events += 1;
        let event = SimEvent {
            tick: self.status.tick,
            seq: self.events,
            t_ns: server_ns(),
            kind,
        };
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

pub(super) fn server_ns() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |t| t.as_nanos() as u64)
}
