//! What a node says beside its arms: contact wrenches, control nets to draw, and services.

use super::node::{RosNode, RosPublisher, RosReceiver, TriggerCall};
use palpate_client::proto::messages::{ControlNet, SceneSnapshot, ToolContact};
use palpate_client::proto::rpc::Call;
use palpate_client::{Latest, Palpate};
use palpate_devices::ros2::{Header, Marker, MarkerArray, NetLines, Qos, WrenchStamped};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant};

/// Nets a second at most.
const NETS_EVERY: Duration = Duration::from_millis(34);
/// Between two looks at who subscribes.
const LOOK_EVERY: Duration = Duration::from_millis(100);
/// Between two looks at what is new.
const TURN: Duration = Duration::from_millis(1);
/// Calls that may wait; more are answered by no one, and time out.
const CALLS: usize = 64;

/// Contact wrenches of one tool.
struct Contacts {
    out: RosPublisher,
    tool: String,
    newest: Option<Latest<ToolContact>>,
}

/// Everything beside the arms.
pub struct Scenery {
    palpate: Palpate,
    frame: String,
    contacts: Vec<Contacts>,
    markers: RosPublisher,
    nets: Vec<Latest<ControlNet>>,
    snapshot: Option<SceneSnapshot>,
    calls: Receiver<(Call, TriggerCall)>,
    _services: Vec<RosReceiver>,
}

impl Scenery {
    /// Declares the topics and services.
    ///
    /// # Errors
    /// Zenoh refused.
    pub fn new(
        node: &RosNode,
        palpate: Palpate,
        name: &str,
        frame: &str,
        tools: &[String],
    ) -> zenoh::Result<Self> {
        let contacts = tools
            .iter()
            .map(|tool| {
                let topic = format!("/{name}/{}/measured_cf", tool.replace('-', "_"));
                Ok(Contacts {
                    out: node.publisher::<WrenchStamped>(&topic, Qos::Newest)?,
                    tool: tool.clone(),
                    newest: None,
                })
            })
            .collect::<zenoh::Result<_>>()?;
        let (queue, calls) = sync_channel(CALLS);
        let services = [
            ("reset", Call::Reset),
            ("pause", Call::Pause),
            ("resume", Call::Resume),
        ]
        .into_iter()
        .map(|(method, call)| {
            let queue = queue.clone();
            node.trigger(&format!("/{name}/{method}"), move |asked| {
                let _ = queue.try_send((call.clone(), asked));
            })
        })
        .collect::<zenoh::Result<_>>()?;
        Ok(Self {
            palpate,
            frame: frame.to_owned(),
            contacts,
            markers: node.publisher::<MarkerArray>(&format!("/{name}/nets"), Qos::Newest)?,
            nets: Vec::new(),
            snapshot: None,
            calls,
            _services: services,
        })
    }

    /// Serves until `stop` is set.
    pub fn run(mut self, stop: &Arc<AtomicBool>) {
        let (mut looked, mut drawn) = (None::<Instant>, Instant::now());
        while !stop.load(Ordering::Relaxed) {
            if looked.is_none_or(|at| at.elapsed() >= LOOK_EVERY) {
                looked = Some(Instant::now());
                self.look();
            }
            self.tell_contacts();
            if !self.nets.is_empty() && drawn.elapsed() >= NETS_EVERY {
                drawn = Instant::now();
                self.draw();
            }
            if let Ok((call, asked)) = self.calls.recv_timeout(TURN) {
                match self.palpate.rpc(call) {
                    Ok(tick) => asked.answer(true, format!("at tick {tick}")),
                    Err(error) => asked.answer(false, error.to_string()),
                }
            }
        }
    }

    /// Takes from the bus what someone subscribes to, and nothing else.
    fn look(&mut self) {
        for contact in &mut self.contacts {
            match (contact.out.is_wanted(), &contact.newest) {
                (true, None) => contact.newest = self.palpate.contacts(&contact.tool).ok(),
                (false, Some(_)) => contact.newest = None,
                _ => {}
            }
        }
        match (self.markers.is_wanted(), self.nets.is_empty()) {
            (true, true) => {
                self.snapshot = self.palpate.scene().ok();
                let bodies = self.snapshot.iter().flat_map(|scene| &scene.bodies);
                self.nets = bodies
                    .filter_map(|body| self.palpate.nets(&body.id).ok())
                    .collect();
            }
            (false, false) => self.nets.clear(),
            _ => {}
        }
    }

    fn tell_contacts(&self) {
        for contact in &self.contacts {
            if let Some(newest) = contact.newest.as_ref().and_then(Latest::take) {
                contact.out.put(&WrenchStamped {
                    header: Header::new(super::super::unix_ns(), &self.frame),
                    force: newest.force,
                    torque: newest.torque,
                });
            }
        }
    }

    fn draw(&self) {
        let Some(scene) = &self.snapshot else { return };
        let bodies = scene.bodies.iter().enumerate();
        let markers: Vec<Marker> = bodies
            .zip(&self.nets)
            .filter_map(|((k, body), net)| {
                let net = net.take()?;
                let lines = NetLines {
                    number: k,
                    body: &net.body,
                    count: [net.count_u, net.count_v].map(usize::from),
                    periodic: body.periodic,
                    points: &net.points,
                };
                Some(lines.marker(super::super::unix_ns(), &self.frame))
            })
            .collect();
        if !markers.is_empty() {
            self.markers.put(&MarkerArray { markers });
        }
    }
}
