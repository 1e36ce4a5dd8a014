//! A subset of rosbridge v2 on the page's server, under `/rosbridge`: poses in, wrenches out, services.
//! For Unity (ROS#), browsers, MATLAB and whatever has a rosbridge client.
//!
//! ```text
//! frames ─▶ Client (a thread) ─┬─▶ Grip ─▶ BridgeArm ─▶ couple ─▶ tool
//!                              └─▶ services, contact wrenches
//! frames ◀─ Outlet ◀─ Hub ◀─ forces of all arms
//! ```
//! Topics and types are those of `[ros2]` in the scene. Only programs of this machine may connect, and
//! pages of other sites only if the daemon names them.

mod arm;
mod outlet;

use super::ros2::{ArmPlan, Plan};
use arm::{Grip, Input};
use axum::Router;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::extract::{ConnectInfo, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt as _, StreamExt as _};
use outlet::{Outlet, Pace};
use palpate_client::proto::messages::ToolContact;
use palpate_client::proto::rpc::Call;
use palpate_client::{Forces, Latest, Palpate};
use palpate_devices::ros2::{ButtonKind, ForceKind};
use palpate_devices::rosbridge::{
    Request, publish, read_buttons, read_pose, read_request, read_twist, same_type,
    service_response, status, wrench,
};
use palpate_http::door::Peer;
use palpate_sim::scene::Scene;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::{Duration, Instant};
use tokio::sync::Semaphore;

/// Clients at once.
const MOST_CLIENTS: usize = 8;
/// Frames of a client that may wait; a client that has more to say waits.
const FRAMES: usize = 256;
/// Longest frame, bytes.
const MOST_BYTES: usize = 64 << 10;
/// Between two looks at contact wrenches and at how old forces are.
const WATCHED_EVERY: Duration = Duration::from_millis(10);
/// A tool that could not be taken is tried again after this.
const AGAIN: Duration = Duration::from_secs(1);
/// Services of one client under way.
const MOST_CALLS: usize = 4;
/// A client that says nothing is asked this often whether it is there, and given up after the second.
const PING: Duration = Duration::from_secs(20);
const SILENCE: Duration = Duration::from_secs(60);
/// Between two looks for room in a queue.
const NAP: Duration = Duration::from_millis(1);
/// What the services are.
const SERVICES: [(&str, Call); 3] = [
    ("reset", Call::Reset),
    ("pause", Call::Pause),
    ("resume", Call::Resume),
];

/// What all clients share.
struct Hub {
    session: zenoh::Session,
    instance: String,
    plan: Plan,
    /// Clients may move tools and call services.
    writable: bool,
    outlets: Mutex<Vec<Weak<Outlet>>>,
    room: Arc<Semaphore>,
}

impl Hub {
    /// Sends a message of a topic to all that want it; nothing is made if no one does.
    fn publish(&self, topic: &str, msg: impl FnOnce() -> Value) {
        let outlets = self.outlets.lock().unwrap_or_else(PoisonError::into_inner);
        let wanting: Vec<Arc<Outlet>> = (outlets.iter())
            .filter_map(Weak::upgrade)
            .filter(|outlet| outlet.wants(topic))
            .collect();
        drop(outlets);
        if !wanting.is_empty() {
            let text: Arc<str> = publish(topic, &msg()).into();
            wanting.iter().for_each(|outlet| outlet.offer(topic, &text));
        }
    }

    fn join(&self) -> Arc<Outlet> {
        let outlet = Arc::new(Outlet::default());
        let mut outlets = self.outlets.lock().unwrap_or_else(PoisonError::into_inner);
        outlets.retain(|known| known.strong_count() > 0);
        outlets.push(Arc::downgrade(&outlet));
        outlet
    }
}

/// The route of a scene, or none where its `[ros2]` does not say what is what.
pub fn routes(session: &zenoh::Session, instance: &str, scene: &Scene, writable: bool) -> Router {
    let plan = match Plan::of(&scene.spec) {
        Ok(plan) => plan,
        Err(error) => {
            tracing::warn!(%error, "/rosbridge is not served");
            return Router::new();
        }
    };
    let hub = Hub {
        session: session.clone(),
        instance: instance.to_owned(),
        plan,
        writable,
        outlets: Mutex::default(),
        room: Arc::new(Semaphore::new(MOST_CLIENTS)),
    };
    Router::new()
        .route("/rosbridge", get(open))
        .with_state(Arc::new(hub))
}

async fn open(
    State(hub): State<Arc<Hub>>,
    ConnectInfo(Peer(address)): ConnectInfo<Peer>,
    upgrade: WebSocketUpgrade,
) -> Response {
    if !address.ip().to_canonical().is_loopback() {
        let words = "only programs of the daemon's machine may use /rosbridge\n";
        return (StatusCode::FORBIDDEN, words).into_response();
    }
    let Ok(place) = hub.room.clone().try_acquire_owned() else {
        let words = format!("{MOST_CLIENTS} clients are connected: close one first\n");
        return (StatusCode::SERVICE_UNAVAILABLE, words).into_response();
    };
    upgrade
        .max_message_size(MOST_BYTES)
        .max_frame_size(MOST_BYTES)
        .on_upgrade(move |socket| async move {
            let _place = place;
            serve(socket, hub).await;
        })
}

async fn serve(socket: WebSocket, hub: Arc<Hub>) {
    let (out, back) = socket.split();
    let (frames, inbox) = sync_channel(FRAMES);
    let outlet = hub.join();
    let client = Client {
        palpate: None,
        hub,
        outlet: outlet.clone(),
        grips: BTreeMap::new(),
        watched: BTreeMap::new(),
        calls: Arc::default(),
        gone: Arc::default(),
    };
    let gone = client.gone.clone();
    // Zenoh's calls wait, which this runtime's thread must not.
    let started = std::thread::Builder::new()
        .name("palpate-rosbridge".into())
        .spawn(move || client.run(&inbox));
    if let Err(error) = started {
        tracing::warn!(%error, "no thread for a client of rosbridge");
        return;
    }
    tokio::select! {
        () = show(out, &outlet) => {}
        () = listen(back, frames) => {}
    }
    gone.store(true, Ordering::Release);
}

/// Sends what is due until the client is gone. While it does not read, only this waits.
async fn show(mut out: SplitSink<WebSocket, Message>, outlet: &Outlet) {
    let mut ping = tokio::time::interval(PING);
    loop {
        let (texts, next) = outlet.take(Instant::now());
        let any = !texts.is_empty();
        for text in texts {
            if out.feed(Message::text(&*text)).await.is_err() {
                return;
            }
        }
        if any && out.flush().await.is_err() {
            return;
        }
        let due = async {
            match next {
                Some(due) => tokio::time::sleep_until(due.into()).await,
                None => std::future::pending().await,
            }
        };
        tokio::select! {
            () = outlet.news() => {}
            () = due => {}
            _ = ping.tick() => if out.send(Message::Ping(Default::default())).await.is_err() {
                return;
            },
        }
    }
}

/// Takes what a client says until it is gone.
async fn listen(mut back: SplitStream<WebSocket>, frames: SyncSender<String>) {
    loop {
        let mut frame = match tokio::time::timeout(SILENCE, back.next()).await {
            Ok(Some(Ok(Message::Text(text)))) => text.to_string(),
            Ok(Some(Ok(Message::Binary(bytes)))) => String::from_utf8_lossy(&bytes).into_owned(),
            Ok(Some(Ok(Message::Ping(_) | Message::Pong(_)))) => continue,
            Ok(Some(Ok(Message::Close(_)) | Err(_)) | None) | Err(_) => return,
        };
        loop {
            match frames.try_send(frame) {
                Ok(()) => break,
                Err(TrySendError::Disconnected(_)) => return,
                Err(TrySendError::Full(again)) => frame = again,
            }
            tokio::time::sleep(NAP).await;
        }
    }
}

/// What a topic of the plan is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Pose,
    Velocity,
    Button(ButtonKind),
    Force(ForceKind),
    Free,
    Contact,
    Silence,
}

impl Part {
    fn kind(self) -> &'static str {
        match self {
            Self::Pose => "geometry_msgs/PoseStamped",
            Self::Velocity => "geometry_msgs/TwistStamped",
            Self::Button(ButtonKind::Joy) => "sensor_msgs/Joy",
            Self::Button(ButtonKind::Bool) => "std_msgs/Bool",
            Self::Button(ButtonKind::OmniButtonEvent) => "omni_msgs/OmniButtonEvent",
            Self::Force(ForceKind::WrenchStamped) | Self::Contact => "geometry_msgs/WrenchStamped",
            Self::Force(ForceKind::Wrench) => "geometry_msgs/Wrench",
            Self::Force(ForceKind::Vector3Stamped) => "geometry_msgs/Vector3Stamped",
            Self::Force(ForceKind::Float64MultiArray) => "std_msgs/Float64MultiArray",
            Self::Force(ForceKind::OmniFeedback) => "omni_msgs/OmniFeedback",
            Self::Free => "std_msgs/Empty",
            Self::Silence => "std_msgs/Float64",
        }
    }

    fn is_input(self) -> bool {
        matches!(self, Self::Pose | Self::Velocity | Self::Button(_))
    }
}

/// The topics of an arm.
fn parts<'a>(arm: &'a ArmPlan, node: &str) -> Vec<(String, Part)> {
    let topic = |topic: &'a Option<String>, part| topic.iter().map(move |t| (t.clone(), part));
    let mut parts = vec![
        (arm.pose.clone(), Part::Pose),
        (arm.force.clone(), Part::Force(arm.force_kind)),
        (own_topic(arm, node, "measured_cf"), Part::Contact),
        (own_topic(arm, node, "silence"), Part::Silence),
    ];
    parts.extend(topic(&arm.velocity, Part::Velocity));
    parts.extend(topic(&arm.free, Part::Free));
    parts.extend((arm.button.iter()).map(|(topic, kind)| (topic.clone(), Part::Button(*kind))));
    parts
}

fn own_topic(arm: &ArmPlan, node: &str, name: &str) -> String {
    format!("/{node}/{}/{name}", arm.tool.replace('-', "_"))
}

/// What is published of a tool for as long as a client wants it.
enum Watched {
    /// What contacts do.
    Contacts(Latest<ToolContact>),
    /// How old the newest force is.
    Silence(Forces),
}

/// One client, on a thread of its own.
struct Client {
    /// Made when it is needed.
    palpate: Option<Palpate>,
    hub: Arc<Hub>,
    outlet: Arc<Outlet>,
    /// By arm: the tool that it moves, and since when it tries.
    grips: BTreeMap<usize, (Grip, Instant)>,
    /// By topic.
    watched: BTreeMap<String, Watched>,
    /// Each call under way has one.
    calls: Arc<()>,
    /// Its socket is closed.
    gone: Arc<AtomicBool>,
}

impl Client {
    fn run(mut self, inbox: &Receiver<String>) {
        let mut reported = Instant::now();
        loop {
            let frame = match self.watched.is_empty() {
                true => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
                false => inbox.recv_timeout(WATCHED_EVERY),
            };
            match frame {
                // What a client that is gone has left behind moves nothing.
                Ok(_) if self.gone.load(Ordering::Acquire) => return,
                Ok(frame) => self.take(&frame),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            if reported.elapsed() >= WATCHED_EVERY {
                reported = Instant::now();
                self.tell_watched();
            }
        }
    }

    fn take(&mut self, frame: &str) {
        let request = match read_request(frame) {
            Ok(request) => request,
            Err(error) => return self.outlet.answer(status(None, &error.to_string())),
        };
        let id = match &request {
            Request::Advertise { id, .. }
            | Request::Unadvertise { id, .. }
            | Request::Publish { id, .. }
            | Request::Subscribe { id, .. }
            | Request::Unsubscribe { id, .. } => id.clone(),
            Request::CallService { .. } | Request::SetLevel { .. } => None,
        };
        let done = match request {
            Request::Advertise { topic, kind, .. } => self.advertise(&topic, &kind),
            Request::Unadvertise { topic, .. } => {
                if let Ok((arm, Part::Pose)) = self.find(&topic) {
                    self.grips.remove(&arm);
                }
                Ok(())
            }
            Request::Publish { topic, msg, .. } => self.publish(&topic, &msg),
            Request::Subscribe {
                topic,
                kind,
                throttle_rate,
                queue_length,
                compression,
                id,
            } => {
                let pace = Pace {
                    every: Duration::try_from_secs_f64(throttle_rate * 1e-3).unwrap_or_default(),
                    queue: queue_length,
                };
                let plain = compression.as_deref().is_none_or(|word| word == "none");
                self.subscribe(&topic, kind.as_deref(), plain, id.as_deref(), pace)
            }
            Request::Unsubscribe { topic, id } => {
                self.outlet.unsubscribe(&topic, id.as_deref());
                if !self.outlet.wants(&topic) {
                    self.watched.remove(&topic);
                }
                Ok(())
            }
            Request::CallService { service, id, .. } => {
                self.call(service, id);
                Ok(())
            }
            Request::SetLevel { .. } => Ok(()),
        };
        if let Err(why) = done {
            self.outlet.answer(status(id.as_deref(), &why));
        }
    }

    /// Arm and meaning of a topic.
    fn find(&self, topic: &str) -> Result<(usize, Part), String> {
        let plan = &self.hub.plan;
        let wanted = topic.trim_matches('/');
        let all = (plan.arms.iter().enumerate()).flat_map(|(k, arm)| {
            parts(arm, &plan.node)
                .into_iter()
                .map(move |part| (k, part))
        });
        let mut known = Vec::new();
        for (k, (name, part)) in all {
            if name.trim_matches('/') == wanted {
                return Ok((k, part));
            }
            known.push(name);
        }
        Err(format!(
            "there is no topic {topic:?}; there are {}",
            known.join(", ")
        ))
    }

    fn advertise(&self, topic: &str, kind: &str) -> Result<(), String> {
        let (_, part) = self.find(topic)?;
        self.check_input(topic, part)?;
        match same_type(part.kind(), kind) {
            true => Ok(()),
            false => Err(format!("{topic} is a {}, not a {kind}", part.kind())),
        }
    }

    fn check_input(&self, topic: &str, part: Part) -> Result<(), String> {
        if !part.is_input() {
            return Err(format!("{topic} comes from here: nobody else publishes it"));
        }
        match self.hub.writable {
            true => Ok(()),
            false => Err("this daemon is for viewing only: no tool is moved from here".into()),
        }
    }

    fn publish(&mut self, topic: &str, msg: &Value) -> Result<(), String> {
        let (k, part) = self.find(topic)?;
        self.check_input(topic, part)?;
        let words = |error: palpate_devices::rosbridge::RosbridgeError| error.to_string();
        let input = match part {
            Part::Pose => {
                let pose = read_pose(msg).map_err(words)?;
                let arm = &self.hub.plan.arms[k];
                if arm.free.is_some() && pose.stamp_ns == Some(0) {
                    return Err("its stamp is 0: not valid, says CRTK".into());
                }
                if let Some(frame) = arm.frame.as_ref().filter(|frame| **frame != pose.frame) {
                    return Err(format!("its frame is {:?}, not {frame:?}", pose.frame));
                }
                Input::Pose(pose)
            }
            Part::Velocity => Input::Velocity(read_twist(msg).map_err(words)?),
            _ => Input::Buttons(read_buttons(msg).map_err(words)?),
        };
        let gone = self.gone.clone();
        if let Some(grip) = self.grip(k, part == Part::Pose)? {
            grip.pass(input, &gone);
        }
        Ok(())
    }

    /// The tool of an arm, which a pose takes; `None` while it is not to be had.
    fn grip(&mut self, k: usize, take: bool) -> Result<Option<&Grip>, String> {
        let known = self.grips.get(&k);
        let again = known.is_none_or(|(grip, since)| grip.has_ended() && since.elapsed() > AGAIN);
        if take && again {
            let outlet = self.outlet.clone();
            let reported = move |why: String| outlet.answer(status(None, &why));
            let grip = Grip::take(&self.hub, &self.hub.plan.arms[k], reported);
            let grip = grip.map_err(|error| error.to_string())?;
            self.grips.insert(k, (grip, Instant::now()));
        }
        let known = self.grips.get(&k).map(|(grip, _)| grip);
        Ok(known.filter(|grip| !grip.has_ended()))
    }

    fn subscribe(
        &mut self,
        topic: &str,
        kind: Option<&str>,
        plain: bool,
        id: Option<&str>,
        pace: Pace,
    ) -> Result<(), String> {
        let (k, part) = self.find(topic)?;
        if part.is_input() {
            return Err(format!("{topic} goes in here and does not come out"));
        }
        if let Some(kind) = kind.filter(|kind| !kind.is_empty() && !same_type(part.kind(), kind)) {
            return Err(format!("{topic} is a {}, not a {kind}", part.kind()));
        }
        if !plain {
            return Err("messages are not compressed here: subscribe without compression".into());
        }
        // Under the name by which it is published.
        self.outlet.subscribe(topic, id.unwrap_or_default(), pace);
        if matches!(part, Part::Contact | Part::Silence) && !self.watched.contains_key(topic) {
            let tool = self.hub.plan.arms[k].tool.clone();
            let palpate = self.palpate()?;
            let watched = match part {
                Part::Contact => palpate.contacts(&tool).map(Watched::Contacts),
                _ => palpate.forces(&tool).map(Watched::Silence),
            };
            let watched = watched.map_err(|error| error.to_string())?;
            self.watched.insert(topic.to_owned(), watched);
        }
        Ok(())
    }

    fn palpate(&mut self) -> Result<&Palpate, String> {
        if self.palpate.is_none() {
            let palpate = Palpate::over(self.hub.session.clone(), &self.hub.instance);
            self.palpate = Some(palpate.map_err(|error| error.to_string())?);
        }
        self.palpate.as_ref().ok_or_else(String::new)
    }

    fn tell_watched(&self) {
        for (topic, watched) in &self.watched {
            let msg = match watched {
                Watched::Contacts(newest) => newest.take().map(|contact| {
                    let (now_ns, frame) = (super::unix_ns(), &self.hub.plan.frame);
                    wrench(now_ns, frame, contact.force, contact.torque)
                }),
                Watched::Silence(forces) => {
                    (forces.silence()).map(|silence| json!({ "data": silence.as_secs_f64() }))
                }
            };
            if let Some(msg) = msg {
                let text: Arc<str> = publish(topic, &msg).into();
                self.outlet.offer(topic, &text);
            }
        }
    }

    /// Carries out a service aside: poses go on meanwhile.
    fn call(&self, service: String, id: Option<String>) {
        let answer = {
            let (outlet, service, id) = (self.outlet.clone(), service.clone(), id.clone());
            move |values| outlet.answer(service_response(&service, id.as_deref(), values))
        };
        let node = &self.hub.plan.node;
        let asked = service.trim_start_matches('/');
        if let Some(what) = asked.strip_prefix("rosapi/") {
            return answer(self.about(what));
        }
        let known = SERVICES
            .iter()
            .find(|(name, _)| format!("{node}/{name}") == asked);
        let Some((_, call)) = known else {
            let names = SERVICES.map(|(name, _)| format!("/{node}/{name}"));
            let why = format!(
                "there is no service {service:?}; there are {}",
                names.join(", ")
            );
            return answer(Err(why));
        };
        if !self.hub.writable {
            return answer(Err("this daemon is for viewing only".into()));
        }
        let place = self.calls.clone();
        if Arc::strong_count(&place) > MOST_CALLS + 1 {
            return answer(Err("too many services are under way; try again".into()));
        }
        let (hub, call) = (self.hub.clone(), call.clone());
        let work = move || {
            let _place = place;
            let done = Palpate::over(hub.session.clone(), &hub.instance)
                .and_then(|palpate| palpate.rpc(call));
            // As std_srvs/Trigger: that it did not work is an answer too.
            let (success, message) = match done {
                Ok(tick) => (true, format!("at tick {tick}")),
                Err(error) => (false, error.to_string()),
            };
            answer(Ok(json!({ "success": success, "message": message })));
        };
        let name = "palpate-rosbridge-call".to_owned();
        if let Err(error) = std::thread::Builder::new().name(name).spawn(work) {
            self.outlet
                .answer(status(id.as_deref(), &error.to_string()));
        }
    }

    /// What `rosapi` reports of topics and services.
    fn about(&self, what: &str) -> Result<Value, String> {
        let plan = &self.hub.plan;
        match what {
            "topics" => {
                let all = plan.arms.iter().flat_map(|arm| parts(arm, &plan.node));
                let (names, parts): (Vec<String>, Vec<Part>) = all.unzip();
                let kinds: Vec<&str> = parts.into_iter().map(Part::kind).collect();
                Ok(json!({ "topics": names, "types": kinds }))
            }
            "services" => {
                let names = SERVICES.map(|(name, _)| format!("/{}/{name}", plan.node));
                Ok(json!({ "services": names }))
            }
            other => Err(format!(
                "rosapi here has topics and services, not {other:?}"
            )),
        }
    }
}
