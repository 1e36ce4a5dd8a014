//! What a node says beside its arms: contact wrenches, control nets to draw, and services.

use super::node::{RosNode, RosPublisher, RosReceiver, TriggerCall};
use palpate_client::proto::messages::{ControlNet, SceneSnapshot, ToolContact};
use palpate_client::proto::rpc::Call;
use palpate_client::{Latest, Palpate};
use palpate_devices::ros2::{Header, Marker, MarkerArray, Qos, WrenchStamped};
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
/// Calls that may wait; more are answered by nobody, and time out.
const CALLS: usize = 64;
const LINE_LIST: i32 = 5;
/// Width of the lines of a net, as a part of the body's size.
const LINE_WIDTH: f64 = 0.002;

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

    /// Takes from the bus what somebody subscribes to, and nothing else.
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
                Some(net_marker(k, &net, body.periodic, &self.frame))
            })
            .collect();
        if !markers.is_empty() {
            self.markers.put(&MarkerArray { markers });
        }
    }
}

/// The lines of a control net, closed where it is periodic.
pub fn net_marker(number: usize, net: &ControlNet, periodic: [bool; 2], frame: &str) -> Marker {
    let [nu, nv] = [usize::from(net.count_u), usize::from(net.count_v)];
    let at = |u: usize, v: usize| net.points.get(u % nu.max(1) * nv + v % nv.max(1)).copied();
    let mut points = Vec::new();
    let mut line = |from: Option<[f64; 3]>, to: Option<[f64; 3]>| {
        if let (Some(from), Some(to)) = (from, to) {
            points.extend([from, to]);
        }
    };
    for u in 0..nu {
        for v in 0..nv {
            if u + 1 < nu || periodic[0] {
                line(at(u, v), at(u + 1, v));
            }
            if v + 1 < nv || periodic[1] {
                line(at(u, v), at(u, v + 1));
            }
        }
    }
    let extent = |c: usize| {
        let values = || net.points.iter().map(|point| point[c]);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    let size = extent(0).max(extent(1)).max(extent(2)).max(0.0);
    Marker {
        header: Header::new(super::super::unix_ns(), frame),
        ns: net.body.clone(),
        id: i32::try_from(number).unwrap_or(i32::MAX),
        shape: LINE_LIST,
        orientation: [0.0, 0.0, 0.0, 1.0],
        scale: [LINE_WIDTH * size, 0.0, 0.0],
        color: [0.2, 0.6, 0.9, 1.0],
        points,
        ..Marker::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn net(count_u: u16, count_v: u16) -> ControlNet {
        ControlNet {
            tick: 1,
            revision: 1,
            body: "sheet".into(),
            degree_u: 3,
            degree_v: 3,
            count_u,
            count_v,
            points: (0..count_u * count_v)
                .map(|k| [f64::from(k), 0.0, 0.0])
                .collect(),
            weights: None,
        }
    }

    #[test]
    fn a_net_has_a_line_between_neighbours_and_is_closed_where_periodic() {
        let lines = |periodic| net_marker(0, &net(4, 5), periodic, "world").points.len() / 2;
        assert_eq!(lines([false, false]), 3 * 5 + 4 * 4);
        assert_eq!(lines([true, false]), 4 * 5 + 4 * 4);
        assert_eq!(lines([true, true]), 4 * 5 + 4 * 5);
    }
}
