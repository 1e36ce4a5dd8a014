//! A simulated device as a CRTK arm, for other people's stacks.

use super::super::simulated::SimulatedHand;
use super::super::unix_ns;
use super::node::{Intake, RosNode, RosPublisher};
use palpate_devices::ros2::{
    Empty, Header, Joy, OperatingState, PoseStamped, Qos, StringStamped, TwistStamped,
    WrenchStamped,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};

/// Messages that may wait.
const QUEUE: usize = 256;
/// Between two operating states without news.
const STATE_EVERY: Duration = Duration::from_secs(1);
const FRAME: &str = "world";

enum Input {
    Force([f64; 3], [f64; 3]),
    Free,
    Word(String),
}

/// What a run saw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmReport {
    /// Poses published.
    pub poses: u64,
    /// Forces received.
    pub forces: u64,
    /// Greatest force received, N.
    pub peak_force_n: f64,
}

/// Publishes `NS/measured_cp`, `measured_cv`, `button1` and `operating_state`, obeys `NS/body/servo_cf`,
/// `servo_cf`, `free` and `state_command`, until the time is over or `stop` is set.
///
/// As the drivers of real devices do, it applies the last force until another one comes.
///
/// # Errors
/// Zenoh refused.
pub fn simulate_arm(
    session: &zenoh::Session,
    namespace: &str,
    mut hand: SimulatedHand,
    duration: Duration,
    stop: &AtomicBool,
) -> zenoh::Result<ArmReport> {
    let name = namespace.trim_matches('/').replace('/', "_");
    let node = RosNode::new(session, 0, &format!("palpate_{name}"))?;
    let topic = |name: &str| format!("{}/{name}", namespace.trim_end_matches('/'));
    let poses = node.publisher::<PoseStamped>(&topic("measured_cp"), Qos::Newest)?;
    let velocities = node.publisher::<TwistStamped>(&topic("measured_cv"), Qos::Newest)?;
    let buttons = node.publisher::<Joy>(&topic("button1"), Qos::Reliable)?;
    let states = node.publisher::<OperatingState>(&topic("operating_state"), Qos::Reliable)?;
    let (queue, inputs) = sync_channel(QUEUE);
    let intake = Arc::new(Intake::default());
    let _receivers = receivers(&node, &topic, &intake, &queue)?;
    let (mut report, mut applied) = (ArmReport::default(), Applied::default());
    let (mut pressed, mut reported) = (None, None::<(Instant, bool)>);
    let begun = Instant::now();
    while !stop.load(Ordering::Relaxed) && begun.elapsed() < duration {
        applied.take(&inputs, &mut report);
        let (force, torque) = applied.now();
        let pose = hand.step(force, torque);
        let header = Header::new(unix_ns(), FRAME);
        velocities.put(&TwistStamped {
            header: header.clone(),
            linear: pose.linear_velocity,
            angular: pose.angular_velocity,
        });
        poses.put(&PoseStamped {
            header: header.clone(),
            position: pose.position,
            orientation: pose.orientation,
        });
        report.poses += 1;
        let down = pose.buttons & 1;
        if pressed.replace(down) != Some(down) {
            buttons.put(&Joy {
                header,
                axes: Vec::new(),
                buttons: vec![down as i32],
            });
        }
        if reported
            .is_none_or(|(at, enabled)| enabled != applied.enabled || at.elapsed() > STATE_EVERY)
        {
            reported = Some((Instant::now(), applied.enabled));
            tell_state(&states, applied.enabled);
        }
        let due = Duration::from_secs_f64(report.poses as f64 * hand.dt_s());
        std::thread::sleep(due.saturating_sub(begun.elapsed()));
    }
    Ok(report)
}

fn tell_state(states: &RosPublisher, enabled: bool) {
    states.put(&OperatingState {
        header: Header::new(unix_ns(), FRAME),
        state: if enabled { "ENABLED" } else { "DISABLED" }.to_owned(),
        is_homed: true,
        is_busy: false,
    });
}

fn receivers(
    node: &RosNode,
    topic: &impl Fn(&str) -> String,
    intake: &Arc<Intake>,
    queue: &SyncSender<Input>,
) -> zenoh::Result<Vec<super::RosReceiver>> {
    let mut receivers = Vec::new();
    for name in ["body/servo_cf", "servo_cf"] {
        let queue = queue.clone();
        let take = move |wrench: WrenchStamped, _| {
            let _ = queue.try_send(Input::Force(wrench.force, wrench.torque));
        };
        receivers.push(node.subscriber(&topic(name), Qos::Newest, intake, take)?);
    }
    let free = queue.clone();
    let take = move |_: Empty, _| drop(free.try_send(Input::Free));
    receivers.push(node.subscriber(&topic("free"), Qos::Reliable, intake, take)?);
    let word = queue.clone();
    let take = move |said: StringStamped, _| drop(word.try_send(Input::Word(said.string)));
    receivers.push(node.subscriber(&topic("state_command"), Qos::Reliable, intake, take)?);
    Ok(receivers)
}

/// The force that acts, and whether any may.
struct Applied {
    force: [f64; 3],
    torque: [f64; 3],
    enabled: bool,
}

impl Default for Applied {
    fn default() -> Self {
        Self {
            force: [0.0; 3],
            torque: [0.0; 3],
            enabled: true,
        }
    }
}

impl Applied {
    fn take(&mut self, inputs: &Receiver<Input>, report: &mut ArmReport) {
        while let Ok(input) = inputs.try_recv() {
            match input {
                Input::Force(force, torque) => {
                    (self.force, self.torque) = (force, torque);
                    report.forces += 1;
                    let size = force.iter().map(|f| f * f).sum::<f64>().sqrt();
                    report.peak_force_n = report.peak_force_n.max(size);
                }
                Input::Free => (self.force, self.torque) = ([0.0; 3], [0.0; 3]),
                Input::Word(word) => match word.as_str() {
                    "enable" | "resume" => self.enabled = true,
                    "disable" | "pause" => {
                        *self = Self {
                            enabled: false,
                            ..Self::default()
                        };
                    }
                    // "home": it is.
                    _ => {}
                },
            }
        }
    }

    fn now(&self) -> ([f64; 3], [f64; 3]) {
        match self.enabled {
            true => (self.force, self.torque),
            false => ([0.0; 3], [0.0; 3]),
        }
    }
}
