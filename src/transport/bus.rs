//! The bus thread: everything that leaves the daemon, and every answer.
//!
//! Each part has an owner with its own fields; the thread polls them in a fixed order.
//!
//! ```text
//! Declared ─▶ Intake ─▶ Rpc ─▶ LoopLink, Archive, Editor, Player    (commands and their answers)
//! loop ─▶ Forces, Contacts, Nets, Tally, Events ─▶ clients, View    (what is published, and pages see)
//! ```

use super::answers::{key_of, reply, reply_json, reply_text};
use super::clients::ClientLink;
use super::contacts::Contacts;
use super::declared::{Declared, Inboxes, Roles};
use super::devices::Devices;
use super::edit::Edits;
use super::events::Events;
use super::forces::Forces;
use super::health::Health;
use super::intake::{Intake, Notice, Question, Requests};
use super::knives::Knives;
use super::link::LoopLink;
use super::metrics::LoopMetrics;
use super::nets::Nets;
use super::post::{Asked, Post, PostThreads};
use super::rate::RateNews;
use super::rpc::{Parties, Rpc};
use super::schemas;
use super::tally::{Gauges, LoopTally};
use super::view::{View, ViewSink};
use palpate_adapters::AdapterCounts;
use palpate_client::encoding;
use palpate_drive::archive::Archive;
use palpate_drive::editor::Editor;
use palpate_drive::journal::JournalGauges;
use palpate_drive::playback::PlayerEnd;
use palpate_drive::ports::BusPorts;
use palpate_proto::codec::encode;
use palpate_proto::keys::Keys;
use palpate_proto::messages::{ALL, EventKind, LoopState, RecorderState, SceneSnapshot};
use palpate_proto::rpc::{Answer, METHODS};
use palpate_sim::scene::Scene;
use palpate_sim::scene::spec::Clock;
use palpate_wire as wire;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{JoinHandle, Thread};
use std::time::{Duration, Instant};
use zenoh::Wait;
use zenoh::bytes::{Encoding, ZBytes};

/// What the bus needs to know beside its ports.
pub struct BusSettings {
    /// The scene.
    pub scene: Arc<Scene>,
    /// SHA-256 of the scene file.
    pub scene_hash: [u8; 32],
    /// Instance name.
    pub instance: String,
    /// Where others than this machine and holders of identities may come in and do everything.
    pub open: Vec<String>,
    /// Viewer, if any.
    pub viewer: Option<Box<dyn ViewSink>>,
    /// Where its page is.
    pub viewer_url: Option<String>,
    /// Bytes and drops of the recorder, if any.
    pub recorder: Option<Arc<JournalGauges>>,
    /// The keeper of recordings, if there is one.
    pub archive: Option<Box<dyn Archive>>,
    /// The editor of the scene, if there is one.
    pub editor: Option<Box<dyn Editor>>,
    /// The player of a recording that runs here instead of a loop, if one does.
    pub player: Option<PlayerEnd>,
    /// What adapters count.
    pub adapters: AdapterCounts,
    /// Where the newest figures are left, for who asks about them beside the viewer.
    pub health: Option<Arc<Health>>,
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

/// Answers are made for so long before the next forces: a snapshot of a large scene takes milliseconds.
const ANSWERING: Duration = Duration::from_millis(1);
const STATUS_EVERY: Duration = Duration::from_millis(100);

impl Bus {
    /// Declares everything on the session and starts the thread.
    ///
    /// # Errors
    /// Zenoh refused a declaration, or the instance name is not a valid id.
    pub fn start(
        session: zenoh::Session,
        ports: BusPorts,
        settings: BusSettings,
    ) -> Result<Self, String> {
        let keys = Keys::new(&settings.instance).map_err(|e| e.to_string())?;
        let stop = Arc::new(AtomicBool::new(false));
        let wake = ports.bus_thread.clone();
        let bus = BusThread::new(session, keys, ports, settings, stop.clone())
            .map_err(|e| e.to_string())?;
        let thread = std::thread::Builder::new()
            .name("palpate-bus".into())
            .spawn(move || bus.run())
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

/// What is served, as of now.
struct Served {
    scene: Arc<Scene>,
    scene_hash: [u8; 32],
    keys: Keys,
    instance: String,
    open: Vec<String>,
    viewer_url: Option<String>,
    adapters: AdapterCounts,
    health: Option<Arc<Health>>,
}

/// The owners of all parts, and the order in which they are polled.
struct BusThread {
    session: zenoh::Session,
    served: Served,
    declared: Declared,
    requests: Requests,
    stop: Arc<AtomicBool>,
    link: LoopLink,
    rpc: Rpc,
    edits: Edits,
    knives: Knives,
    devices: Devices,
    forces: Forces,
    contacts: Contacts,
    nets: Nets,
    tally: LoopTally,
    last_status: Instant,
    events: Events,
    /// What sends answers, nets and events.
    posts: PostThreads,
    /// Events that pages have.
    shown_events: u64,
    view: View,
}

impl BusThread {
    fn new(
        session: zenoh::Session,
        keys: Keys,
        ports: BusPorts,
        settings: BusSettings,
        stop: Arc<AtomicBool>,
    ) -> zenoh::Result<Self> {
        let scene = settings.scene;
        let posts = PostThreads::default();
        let nets_post = Post::new("palpate-nets", &posts);
        let events_post = Post::new("palpate-events", &posts);
        // Who has the answer to a seek finds the net of that tick: they keep their order.
        let after_nets = settings.player.as_ref().map(|_| nets_post.clone());
        let (intake, requests) = Intake::new(&posts, after_nets, scene.tool_count());
        let devices = Devices::new(&scene);
        let roles = Roles {
            player: settings.player.is_some(),
            viewer: settings.viewer.is_some(),
        };
        // In lockstep and out of a recording every force is published.
        let every = scene.clock == Clock::Lockstep || roles.player;
        let (session_of, poses) = (&session, &ports.poses);
        let clients: Vec<Arc<ClientLink>> = poses.iter().map(|_| Arc::default()).collect();
        let outputs = ports.outputs;
        let forces = Forces::new(session_of, &keys, &scene, outputs, poses, &clients, every)?;
        let contacts = Contacts::new(session_of, &keys, scene.tool_count())?;
        let nets = Nets::new(
            session_of,
            &keys,
            &scene,
            ports.nets,
            intake.clone(),
            nets_post,
        )?;
        let events = Events::new(session_of, &keys, settings.archive, events_post)?;
        let gauges = Gauges {
            poses: poses.clone(),
            counters: ports.counters,
            recorder: settings.recorder,
        };
        let tally = LoopTally::new(
            session_of,
            &keys,
            &scene,
            ports.records,
            gauges,
            roles.player,
        )?;
        // Last, with the tokens that say that all of it is there.
        let inboxes = Inboxes {
            poses,
            clients: &clients,
            devices: &devices,
            intake: &intake,
        };
        let declared = Declared::new(session_of, &keys, &scene, &inboxes, roles)?;
        let knives = match settings.editor {
            Some(_) => Knives::new(&scene),
            None => Knives::none(),
        };
        let mut bus = Self {
            session,
            declared,
            requests,
            stop,
            link: LoopLink {
                commands: ports.commands,
                receipts: ports.receipts,
                swaps: ports.swaps,
                retired: ports.retired,
                tick_thread: ports.tick_thread,
            },
            rpc: Rpc::new(settings.player),
            edits: Edits::new(settings.editor),
            knives,
            devices,
            forces,
            contacts,
            nets,
            tally,
            last_status: Instant::now(),
            events,
            posts,
            shown_events: 0,
            view: View::new(settings.viewer),
            served: Served {
                scene,
                scene_hash: settings.scene_hash,
                keys,
                instance: settings.instance,
                open: settings.open,
                viewer_url: settings.viewer_url,
                adapters: settings.adapters,
                health: settings.health,
            },
        };
        bus.show_scene();
        Ok(bus)
    }

    fn run(mut self) -> BusReport {
        while !self.stop.load(Ordering::Acquire) {
            std::thread::park_timeout(Duration::from_millis(1));
            self.serve();
        }
        self.serve();
        self.rpc.end();
        self.events.tell(EventKind::Stopping);
        self.publish_status();
        let reason = Answer::refused("the daemon is going down");
        self.rpc.desk.settle_all(&reason);
        let report = BusReport {
            events: self.events.count(),
            poses: self.forces.received(),
            suppressed: self.devices.all_suppressed(),
        };
        // Nothing comes in before nothing goes out.
        drop(self.declared);
        drop((
            self.nets,
            self.forces,
            self.contacts,
            self.tally,
            self.events,
            self.requests,
            self.rpc,
        ));
        self.posts.finish();
        if let Err(error) = self.session.close().wait() {
            tracing::warn!(%error, "closing the session");
        }
        report
    }

    fn serve(&mut self) {
        // First, and all of them: a command waits for no question.
        self.take_commands();
        if self.tally.is_ending() {
            self.rpc.end();
        }
        let player_news = self.rpc.player_news();
        self.take_receipts();
        self.publish_forces();
        // The receipt of a change comes before its first tick: all that came before the change is
        // published now.
        self.follow_change(None);
        self.tally
            .poll(&self.served.scene, &mut self.events, |record| {
                self.knives.see(&self.served.scene, record);
            });
        self.forces.answer_again();
        let newcomer = self.view.take_newcomer();
        self.nets
            .publish(&self.served.scene, newcomer, &mut self.view);
        if self.tally.take_apart() {
            self.stop_apart();
        }
        self.show_forces(newcomer);
        self.take_notices();
        self.answer_questions();
        self.take_receipts();
        self.rpc.take_archive_news(&mut self.events);
        self.take_edits();
        self.rpc.take_player_news(player_news, &mut self.events);
        if self.last_status.elapsed() >= STATUS_EVERY {
            self.publish_status();
        }
        self.show_events();
        self.view.tell(|sink| sink.turn_over());
    }

    /// Takes what has become of changes, and begins with the next cut of a tool.
    fn take_edits(&mut self) {
        let next_tick = self.tally.status().tick + 1;
        let (link, desk, events) = (&mut self.link, &mut self.rpc.desk, &mut self.events);
        self.edits.take_news(next_tick, link, desk, events);
        let (scene, nets) = (&self.served.scene, &self.nets);
        while !self.edits.under_way()
            && let Some(cut) = self.knives.next_cut(scene, nets)
        {
            self.edits.ask_cut(desk.own_id(), scene, nets, cut, events);
        }
    }

    /// Shows pages the scene as it stands.
    fn show_scene(&mut self) {
        if self.view.is_there() {
            let snapshot = encode(&self.snapshot());
            let scene = &self.served.scene;
            self.view.tell(|sink| sink.scene(scene, &snapshot));
        }
    }

    /// Shows pages what tools feel; `all`: one has just opened.
    fn show_forces(&mut self, all: bool) {
        if self.view.forces_due() || all {
            let scene = &self.served.scene;
            self.forces.show(scene, &self.devices, all, &mut self.view);
        }
        if all {
            let contacts = wire::contact_set(&self.served.scene, self.forces.newest());
            self.view.message("", &contacts);
        }
    }

    /// Shows pages the events since the last time.
    fn show_events(&mut self) {
        if self.events.count() > self.shown_events && self.view.is_there() {
            for event in self.events.after(self.shown_events) {
                self.view.tell(|sink| sink.event(&encode(event)));
            }
            self.shown_events = self.events.count();
        }
    }

    /// Answers commands that have had their effect. That of a change waits until all of the scene
    /// before it is published.
    fn take_receipts(&mut self) {
        while let Ok(receipt) = self.link.receipts.pop() {
            if !self.edits.take_receipt(receipt) {
                self.rpc.desk.settle(receipt.id, &Answer::at(receipt.tick));
            }
        }
    }

    fn publish_forces(&mut self) {
        let mut fresh = false;
        while let Some(tick) = self.forces.next_tick() {
            if self.edits.under_way() {
                self.take_receipts();
                self.follow_change(Some(tick));
            }
            let scene = &self.served.scene;
            fresh |= self.forces.publish_next(scene, &mut self.devices);
        }
        // A loop that has ended is not slow.
        if self.rpc.state() != LoopState::Stopping
            && let Some(news) = self.forces.rate_news()
        {
            self.tell_rate(news);
        }
        if fresh {
            let (scene, output) = (&self.served.scene, self.forces.newest());
            self.contacts.publish(scene, output, &mut self.view);
        }
    }

    /// A body has come apart, and would do so again: the loop pauses, which fades all forces, until someone
    /// changes what did it.
    fn stop_apart(&mut self) {
        let advice = "the loop is paused; `reset` and `resume` begin anew";
        tracing::error!(advice, "a body has come apart");
        if self.rpc.pause(&mut self.link, &mut self.events).is_err() {
            tracing::error!("too many commands are waiting: the loop was not paused");
        }
    }

    /// Tells clients why their forces fade.
    fn tell_rate(&mut self, news: RateNews) {
        match news {
            RateNews::Lost(hz) => {
                let nominal_hz = 1.0 / self.served.scene.dt_s;
                let reason = format!(
                    "the loop runs at {hz:.0} of {nominal_hz:.0} Hz: forces fade until it keeps its rate"
                );
                tracing::error!(reason);
                self.events.tell(EventKind::Fault { reason });
            }
            RateNews::Kept => tracing::info!("the loop keeps its rate again: forces come back"),
        }
    }

    /// Goes on with the next scene if the loop does from `tick` on, or has published all before it
    /// (`None`).
    fn follow_change(&mut self, tick: Option<u64>) {
        let Some(mut next) = self.edits.due(tick) else {
            return;
        };
        let scene = next.scene.clone();
        let ends = std::mem::take(&mut next.nets);
        (self.served.scene, self.served.scene_hash) = (scene.clone(), next.scene_hash);
        self.forces.forget_contacts();
        self.nets
            .change(&self.session, &self.served.keys, &scene, ends);
        self.show_scene();
        let what = std::mem::take(&mut next.what);
        self.events.tell(EventKind::SceneChanged { what });
        self.link.drop_retired();
        next.settle(&mut self.rpc.desk);
    }

    fn publish_status(&mut self) {
        self.last_status = Instant::now();
        self.forces.look_for_listeners();
        self.tally.end_period(&self.served.scene, &mut self.events);
        self.read_gauges();
        let recording = self.tally.status().recorder == RecorderState::Recording;
        self.declared.show_recording(&self.session, recording);
        self.tally.publish();
        if let Some(health) = &self.served.health {
            health.put(self.figures());
        }
        if self.view.is_there() {
            let figures = self.figures();
            if self.view.watched() {
                self.view.message("", &figures.status);
            }
            self.view.tell(|sink| sink.figures(&figures));
        }
    }

    /// Brings the status up to date.
    fn read_gauges(&mut self) {
        let (scene, output) = (&self.served.scene, self.forces.newest());
        let (state, forces) = (self.rpc.state(), self.forces.counts());
        self.tally.read_gauges(scene, output, state, &forces);
    }

    /// Takes the commands that have come in.
    fn take_commands(&mut self) {
        while let Ok((method, asked)) = self.requests.commands.try_recv() {
            let scene = &self.served.scene;
            let parties = Parties {
                link: &mut self.link,
                events: &mut self.events,
                edits: &mut self.edits,
                scene,
                nets: &self.nets,
                newest: self.forces.newest(),
            };
            self.rpc.take(method, asked, parties);
        }
    }

    /// Takes what clients said of themselves: that they hold a tool or no longer do, and their devices.
    fn take_notices(&mut self) {
        for tool in 0..self.served.scene.tool_count() {
            let Notice {
                left,
                joined,
                reported,
            } = self.requests.notices.take(tool);
            let scene = &self.served.scene;
            let id = scene.tool_id(tool);
            if left {
                self.view.tell(|sink| sink.token(id, false));
                self.forces.forget_sender(tool);
                self.devices.forget(tool);
            }
            if joined {
                self.view.tell(|sink| sink.token(id, true));
                self.devices.release(tool, &mut self.link);
            }
            if let Some(info) = reported {
                let (link, events) = (&mut self.link, &mut self.events);
                self.view
                    .tell(|sink| sink.device(id, &info.name, &encode(&*info)));
                self.devices.reported(tool, *info, scene, link, events);
            }
        }
    }

    /// Answers questions, for as long as forces can wait.
    fn answer_questions(&mut self) {
        let begun = Instant::now();
        // Many may ask for the same: it is made once.
        let mut snapshot = None;
        while let Ok((question, asked)) = self.requests.questions.try_recv() {
            match question {
                Question::Scene => {
                    let bytes = snapshot
                        .get_or_insert_with(|| ZBytes::from(encode(&self.snapshot())))
                        .clone();
                    asked.answer(key_of(&asked), bytes, encoding::<SceneSnapshot>());
                }
                other => self.answer(other, &asked),
            }
            if begun.elapsed() > ANSWERING {
                break;
            }
        }
    }

    fn answer(&mut self, question: Question, asked: &Asked) {
        let served = &self.served;
        match question {
            Question::Scene => reply(asked, &self.snapshot()),
            Question::Status => {
                self.read_gauges();
                reply(asked, self.tally.status());
            }
            Question::Net(body) => {
                // A body that has just gone is not answered for: the query ends empty.
                let nets = self.nets.all(&served.scene);
                if let Some(net) = nets.iter().find(|net| net.body == body) {
                    reply(asked, net);
                }
            }
            Question::Info => reply_json(asked, key_of(asked), &self.info()),
            Question::Schema => schemas::answer(&served.keys, asked),
            Question::Metrics => {
                self.read_gauges();
                let encoding = Encoding::APPLICATION_OPENMETRICS_TEXT;
                reply_text(asked, self.figures().text(), encoding);
            }
            Question::Events => self.events.answer(asked),
            Question::Device(tool) => {
                // Nothing to say is not an answer: the query ends empty.
                if let Some(info) = self.devices.info(tool) {
                    reply(asked, info);
                }
            }
        }
    }

    /// All that a late client needs.
    fn snapshot(&mut self) -> SceneSnapshot {
        let served = &self.served;
        let (nets, output) = (self.nets.all(&served.scene), self.forces.newest());
        wire::scene_snapshot(&served.scene, served.scene_hash, nets, output)
    }

    fn info(&self) -> serde_json::Value {
        let scene = &self.served.scene;
        serde_json::json!({
            "name": "palpate",
            "version": env!("CARGO_PKG_VERSION"),
            "instance": self.served.instance,
            "scene": scene.name,
            "rate_hz": 1.0 / scene.dt_s,
            "tools": (0..scene.tool_count()).map(|t| scene.tool_id(t)).collect::<Vec<_>>(),
            "bodies": (0..scene.body_count()).map(|b| scene.body_id(b)).collect::<Vec<_>>(),
            "devices": self.devices.report(|tool| (scene.tool_id(tool), self.forces.holder(tool))),
            "forces": self.forces.report(scene),
            "messages": ALL.iter().map(|message| message.name).collect::<Vec<_>>(),
            "methods": METHODS,
            "lockstep": scene.clock == Clock::Lockstep,
            "played": self.rpc.plays(),
            "open": self.served.open,
            "warnings": scene.warnings().iter().map(|finding| &finding.what).collect::<Vec<_>>(),
            "recorder": self.tally.status().recorder,
            "viewer": self.served.viewer_url,
        })
    }

    /// Everything that is counted, as of the last [`BusThread::read_gauges`].
    fn figures(&self) -> LoopMetrics {
        LoopMetrics {
            instance: self.served.instance.clone(),
            open: self.served.open.len() as u64,
            scene: self.served.scene.name.clone(),
            status: self.tally.status().clone(),
            overruns: self.tally.overruns(),
            bus_drops: self.tally.bus_drops(),
            events: self.events.count(),
            suppressed: self.devices.all_suppressed(),
            clients: self.forces.clients(),
            overtaken: self.forces.overtaken(),
            strangers: self.forces.strangers(),
            degraded: self.tally.degraded(),
            adapters: self.served.adapters.read(),
            measured_hz: self.forces.rate().measured_hz(),
            rate_lost: self.forces.rate().is_lost(),
            descriptions_refused: self.devices.all_refused(),
        }
    }
}
