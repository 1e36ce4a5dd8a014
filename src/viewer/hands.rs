//! What pages do on the bus: they hold tools, send poses and commands, as any other client does.
//!
//! A thread of its own speaks to the bus through the daemon's session: poses of pages are admitted,
//! counted and recorded where those of all clients are, and a slow bus does not hold up the sockets.
//!
//! In lockstep a tick waits for a pose of every tool, and a page has sixty a second; in real time a mouse,
//! which has no motor, may be silent for a moment. Both times its newest pose is sent again ([`Steady`]).

use super::frames::{answer_frame, refused_frame};
use super::holders::{Holders, Socket};
use super::steady::{Pace, Steady};
use axum::body::Bytes;
use palpate_client::{holder_id, publisher};
use palpate_proto::codec::{decode, encode};
use palpate_proto::keys::Keys;
use palpate_proto::messages::{DeviceInfo, ToolPose};
use palpate_proto::rpc::{Answer, Call, METHODS};
use palpate_sim::scene::Scene;
use palpate_sim::scene::spec::Clock;
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::{Duration, Instant};
use tokio::sync::mpsc::Sender;
use zenoh::Wait;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Publisher;
use zenoh::qos::CongestionControl;

/// Orders that may wait; a socket that has more to say waits.
const ORDERS: usize = 256;
/// Commands are answered within this, and snapshots this long after their last second.
const PATIENCE: Duration = Duration::from_secs(60);

/// Frames for one page beside those of the board: answers and refusals.
pub(super) type Outbox = Sender<Bytes>;

/// What a page wants.
pub(super) enum Order {
    /// A tool, with the device that moves it.
    Claim { tool: String, device: Vec<u8> },
    /// To move it.
    Pose { tool: String, pose: Vec<u8> },
    /// To give it back.
    Release { tool: String },
    /// Simulated over real time, for a scene in lockstep.
    Speed { speed: f64 },
    /// A command.
    Call {
        method: String,
        id: u64,
        arguments: Vec<u8>,
    },
    /// Nothing any more.
    Gone,
}

/// An order and who gave it.
pub(super) struct FromPage {
    pub(super) socket: Socket,
    pub(super) order: Order,
    pub(super) outbox: Outbox,
}

/// A tool that a page holds.
struct Held {
    poses: Publisher<'static>,
    devices: Publisher<'static>,
    /// Goes with each message: who sends it.
    holder: Vec<u8>,
    /// Its device pushes the hand.
    motors: bool,
    _token: LivelinessToken,
    /// How its poses are repeated; `None`: each is passed on once, as it came.
    pace: Option<Pace>,
    /// What is repeated, once there was a pose.
    steady: Option<Steady>,
}

/// The pages' end of the bus.
struct Hands {
    session: zenoh::Session,
    keys: Keys,
    holders: Arc<Holders>,
    held: HashMap<String, Held>,
    /// A recording is played here: no one moves its tools.
    played: bool,
    scene: Arc<Scene>,
    /// In lockstep, simulated over real time.
    speed: f64,
}

/// What a page may ask for, simulated over real time.
const SPEEDS: std::ops::RangeInclusive<f64> = 1e-3..=10.0;

/// Starts the thread; it ends when no one can give orders any more.
///
/// # Errors
/// No thread could be made.
pub(super) fn start(
    session: zenoh::Session,
    keys: Keys,
    holders: Arc<Holders>,
    played: bool,
    scene: Arc<Scene>,
) -> std::io::Result<SyncSender<FromPage>> {
    let (orders, inbox) = sync_channel(ORDERS);
    let hands = Hands {
        session,
        keys,
        holders,
        held: HashMap::new(),
        played,
        scene,
        speed: 1.0,
    };
    std::thread::Builder::new()
        .name("palpate-hands".into())
        .spawn(move || hands.run(&inbox))?;
    Ok(orders)
}

impl Hands {
    fn run(mut self, inbox: &Receiver<FromPage>) {
        loop {
            self.send_due();
            let order = match self.next_due() {
                None => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(due) => inbox.recv_timeout(due.saturating_duration_since(Instant::now())),
            };
            let FromPage {
                socket,
                order,
                outbox,
            } = match order {
                Ok(order) => order,
                Err(RecvTimeoutError::Timeout) => continue,
                Err(RecvTimeoutError::Disconnected) => return,
            };
            let (key, done) = match order {
                Order::Claim { tool, device } => {
                    (key(&tool, "device"), self.claim(socket, &tool, &device))
                }
                Order::Pose { tool, pose } => (key(&tool, "pose"), self.pose(socket, &tool, &pose)),
                Order::Release { tool } => (key(&tool, "release"), self.release(socket, &tool)),
                Order::Speed { speed } => ("speed".to_owned(), self.set_speed(speed)),
                Order::Call {
                    method,
                    id,
                    arguments,
                } => {
                    self.call(&method, id, arguments, outbox);
                    continue;
                }
                Order::Gone => {
                    for tool in self.holders.of(socket) {
                        self.give_back(&tool);
                    }
                    continue;
                }
            };
            if let Err(reason) = done {
                // A page that reads nothing misses what it did wrong.
                let _ = outbox.try_send(refused_frame(&key, &reason));
            }
        }
    }

    fn claim(&mut self, socket: Socket, tool: &str, device: &[u8]) -> Result<(), String> {
        if self.played {
            return Err("this is a recording that is played: nobody moves its tools".into());
        }
        let info: DeviceInfo = decode(device, "").map_err(|e| e.to_string())?;
        let info = info.validated().map_err(|e| e.to_string())?;
        let name = match info.name.as_str() {
            "" => "a page",
            name => name,
        };
        let has_it = self.holders.claim(socket, tool, name)?;
        if has_it && (self.held.get(tool)).is_some_and(|held| held.motors != info.has_motors()) {
            return Err(format!(
                "tool {tool:?} was taken by a device {} motors (dof_force, dof_torque): give it back before another takes it",
                if info.has_motors() { "without" } else { "with" }
            ));
        }
        if !has_it {
            match self.hold(tool, &info) {
                Ok(held) => drop(self.held.insert(tool.to_owned(), held)),
                Err(error) => {
                    self.holders.release(tool);
                    return Err(format!("Zenoh: {error}"));
                }
            }
        }
        match self.held.get(tool) {
            Some(held) => {
                let put = held.devices.put(encode(&info));
                let put = put.attachment(&held.holder).wait();
                put.map_err(|e| format!("Zenoh: {e}"))
            }
            None => Ok(()),
        }
    }

    fn hold(&self, tool: &str, info: &DeviceInfo) -> zenoh::Result<Held> {
        let keys = &self.keys;
        Ok(Held {
            // As every client holds its tool.
            _token: (self.session.liveliness())
                .declare_token(keys.live_tool(tool))
                .wait()?,
            poses: publisher::<ToolPose>(&self.session, keys.tool_pose(tool))?,
            devices: publisher::<DeviceInfo>(&self.session, keys.tool_device(tool))?,
            holder: holder_id(&self.session),
            motors: info.has_motors(),
            pace: self.pace_of(tool, info),
            steady: None,
        })
    }

    /// How the poses of a device are repeated: in lockstep of any, in real time of one that pushes no one. Who
    /// has a motor in the hand must lose the force when its poses stop.
    fn pace_of(&self, tool: &str, info: &DeviceInfo) -> Option<Pace> {
        if self.scene.clock == Clock::Lockstep {
            return Some(Pace::Lockstep {
                every: Duration::from_secs_f64(self.scene.dt_s / self.speed),
            });
        }
        let tool = self.scene.tool_index(tool).filter(|_| !info.has_motors())?;
        let device = &self.scene.spec.tools[tool].device;
        Some(Pace::realtime(device.stale_s, device.speed_max_m_s))
    }

    /// What is no pose is passed on as it came: that is judged and counted where those of all clients are.
    fn pose(&mut self, socket: Socket, tool: &str, pose: &[u8]) -> Result<(), String> {
        let mine = self.holders.holds(socket, tool);
        let Some(held) = self.held.get_mut(tool).filter(|_| mine) else {
            return Err(format!("this page does not hold tool {tool:?}"));
        };
        let read = decode::<ToolPose>(pose, "").map(ToolPose::validated);
        if let (Some(pace), Ok(Ok(pose))) = (held.pace, read) {
            let now = Instant::now();
            match &mut held.steady {
                Some(steady) => steady.take(&pose, now, pace),
                None => held.steady = Some(Steady::new(&pose, now)),
            }
            return Ok(());
        }
        let put = held.poses.put(pose).attachment(&held.holder).wait();
        put.map_err(|e| format!("Zenoh: {e}"))
    }

    fn set_speed(&mut self, speed: f64) -> Result<(), String> {
        if self.scene.clock != Clock::Lockstep {
            return Err(
                "this scene runs in real time: only scenes in lockstep have a speed".into(),
            );
        }
        if !SPEEDS.contains(&speed) {
            return Err(format!(
                "a speed is a number from {} to {}, not {speed}",
                SPEEDS.start(),
                SPEEDS.end()
            ));
        }
        self.speed = speed;
        let every = Duration::from_secs_f64(self.scene.dt_s / speed);
        for held in self.held.values_mut() {
            held.pace = Some(Pace::Lockstep { every });
        }
        Ok(())
    }

    /// When the next pose leaves, if one does.
    fn next_due(&self) -> Option<Instant> {
        let due = |held: &Held| held.steady.as_ref()?.due(held.pace?);
        self.held.values().filter_map(due).min()
    }

    /// Sends the poses whose time has come.
    fn send_due(&mut self) {
        let now = Instant::now();
        for held in self.held.values_mut() {
            let (Some(steady), Some(pace)) = (&mut held.steady, held.pace) else {
                continue;
            };
            if steady.due(pace).is_some_and(|due| due <= now) {
                let pose = encode(&steady.send(now, pace));
                // A link that is gone says so with the next claim or pose that is passed on.
                let _ = held.poses.put(pose).attachment(&held.holder).wait();
            }
        }
    }

    fn release(&mut self, socket: Socket, tool: &str) -> Result<(), String> {
        if !self.holders.holds(socket, tool) {
            return Err(format!("this page does not hold tool {tool:?}"));
        }
        self.give_back(tool);
        Ok(())
    }

    fn give_back(&mut self, tool: &str) {
        // The token goes before others may have the tool.
        self.held.remove(tool);
        self.holders.release(tool);
    }

    fn call(&self, method: &str, id: u64, arguments: Vec<u8>, outbox: Outbox) {
        let mut answering = Answering {
            id,
            outbox,
            answered: false,
        };
        let refuse = |reason: String| Answer::<()>::refused(reason);
        if !METHODS.contains(&method) {
            let known = METHODS.join(", ");
            return answering.answer(&refuse(format!(
                "there is no method {method:?}; there are {known}"
            )));
        }
        // What is wrong with it is said by the daemon; its time is needed here.
        let after = match Call::parse(method, &arguments) {
            Ok(Call::Snapshot { after, .. }) => {
                Duration::try_from_secs_f64(after).unwrap_or_default()
            }
            _ => Duration::ZERO,
        };
        let asked = (self.session)
            .get(self.keys.rpc(method))
            .payload(arguments)
            .congestion_control(CongestionControl::Drop)
            .timeout(PATIENCE.saturating_add(after))
            .callback_mut(move |reply| {
                if let Ok(sample) = reply.result() {
                    let json = String::from_utf8_lossy(&sample.payload().to_bytes()).into_owned();
                    answering.send(&json);
                }
            })
            .wait();
        // The callback, dropped with the query, has answered.
        if let Err(error) = asked {
            tracing::debug!(%error, "a command of the page");
        }
    }
}

fn key(tool: &str, what: &str) -> String {
    format!("tool/{tool}/{what}")
}

/// Answers a command once, and if no one else does then when it is dropped.
struct Answering {
    id: u64,
    outbox: Outbox,
    answered: bool,
}

impl Answering {
    fn send(&mut self, json: &str) {
        if !std::mem::replace(&mut self.answered, true) {
            let _ = self.outbox.try_send(answer_frame(self.id, json));
        }
    }

    fn answer(&mut self, answer: &Answer<()>) {
        self.send(&serde_json::to_string(answer).unwrap_or_default());
    }
}

impl Drop for Answering {
    fn drop(&mut self) {
        self.answer(&Answer::refused("no answer came in time"));
    }
}
