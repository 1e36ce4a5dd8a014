//! A tool that clients of rosbridge move.

use super::super::ros2::{ArmPlan, hold_tool};
use super::super::{Coupling, couple, unix_ns};
use super::Hub;
use palpate_client::Palpate;
use palpate_devices::ros2::ForceKind;
use palpate_devices::rosbridge::{
    JsonPose, array, omni_feedback, plain_wrench, vector_stamped, wrench,
};
use palpate_devices::{Command, Coupler, DeviceEnd, Reading, State};
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::time::{Duration, Instant};

/// Inputs that may wait.
const QUEUE: usize = 256;
/// A velocity older than this is not used.
const VELOCITY: Duration = Duration::from_millis(50);

/// What a client says of a device.
pub(super) enum Input {
    Pose(JsonPose),
    Velocity([[f64; 3]; 2]),
    Buttons(u32),
}

/// The end of an arm that a connection has; the tool is given back when it is dropped.
pub(super) struct Grip {
    inputs: SyncSender<Input>,
    stop: Arc<AtomicBool>,
    /// The arm has ended, whatever the reason.
    ended: Arc<AtomicBool>,
    lockstep: bool,
}

impl Grip {
    /// Takes a tool, on a thread of its own. `reported` gets the reason for a failure.
    ///
    /// # Errors
    /// No thread.
    pub(super) fn take(
        hub: &Arc<Hub>,
        arm: &ArmPlan,
        reported: impl FnOnce(String) + Send + 'static,
    ) -> std::io::Result<Self> {
        let (inputs, queue) = sync_channel(QUEUE);
        let (stop, ended) = (Arc::<AtomicBool>::default(), Arc::<AtomicBool>::default());
        let grip = Self {
            inputs,
            stop: stop.clone(),
            ended: ended.clone(),
            lockstep: hub.plan.lockstep,
        };
        let (hub, arm) = (hub.clone(), arm.clone());
        std::thread::Builder::new()
            .name(format!("palpate-rosbridge-{}", arm.tool))
            .spawn(move || {
                if let Err(error) = move_tool(&hub, &arm, queue, &stop) {
                    reported(format!("{error:#}"));
                }
                ended.store(true, Ordering::Release);
            })?;
        Ok(grip)
    }

    /// The tool is not held any more.
    pub(super) fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Acquire)
    }

    /// Passes an input on. In lockstep every pose has its tick: who is faster waits, until it is `gone`.
    pub(super) fn pass(&self, mut input: Input, gone: &AtomicBool) {
        while let Err(TrySendError::Full(again)) = self.inputs.try_send(input) {
            if !self.lockstep || self.has_ended() || gone.load(Ordering::Acquire) {
                return;
            }
            input = again;
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

impl Drop for Grip {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Release);
    }
}

fn move_tool(
    hub: &Arc<Hub>,
    arm: &ArmPlan,
    inputs: Receiver<Input>,
    stop: &AtomicBool,
) -> anyhow::Result<()> {
    let palpate = Palpate::over(hub.session.clone(), &hub.instance)?;
    let token = palpate.keys().live_tool(&arm.tool);
    let holders = palpate.live(&token, Duration::ZERO, |_| true)?;
    anyhow::ensure!(
        holders.is_empty(),
        "tool {:?} is held by somebody else",
        arm.tool
    );
    let name = format!("rosbridge {}", arm.pose);
    let (mut tool, info) = hold_tool(&palpate, arm, &name, hub.plan.lockstep)?;
    let mut device = BridgeArm {
        hub: hub.clone(),
        arm: arm.clone(),
        inputs,
        velocity: None,
        buttons: 0,
        frame: arm.frame.clone().unwrap_or_else(|| hub.plan.frame.clone()),
        resting: true,
    };
    let coupling = Coupling {
        coupler: Coupler::new(arm.coupler.clone()),
        info,
        stop,
    };
    let report = couple(&mut device, &mut tool, coupling)?;
    tracing::info!(
        tool = arm.tool,
        poses = report.readings,
        refused = report.refused,
        forces = report.commands,
        peak_n = report.peak_force_n,
        "rosbridge device"
    );
    Ok(())
}

/// The device of a client.
struct BridgeArm {
    hub: Arc<Hub>,
    arm: ArmPlan,
    inputs: Receiver<Input>,
    velocity: Option<([[f64; 3]; 2], Instant)>,
    buttons: u32,
    frame: String,
    resting: bool,
}

impl BridgeArm {
    fn take(&mut self, input: Input) -> Option<Reading> {
        match input {
            Input::Velocity(velocity) => {
                self.velocity = Some((velocity, Instant::now()));
                None
            }
            Input::Buttons(buttons) => {
                self.buttons = buttons;
                None
            }
            Input::Pose(pose) => {
                if !pose.frame.is_empty() && pose.frame != self.frame {
                    self.frame = pose.frame;
                }
                let lockstep = self.hub.plan.lockstep;
                let fresh =
                    |(_, at): &([[f64; 3]; 2], Instant)| lockstep || at.elapsed() < VELOCITY;
                Some(Reading {
                    position: pose.position,
                    orientation: pose.orientation,
                    velocity: self.velocity.filter(fresh).map(|(velocity, _)| velocity),
                    buttons: self.buttons,
                    time_ns: pose.stamp_ns.unwrap_or_else(unix_ns),
                })
            }
        }
    }
}

impl DeviceEnd for BridgeArm {
    type Error = Infallible;

    /// In real time the newest pose of those that wait; in lockstep each.
    fn reading(&mut self, patience: Duration) -> Result<Option<Reading>, Infallible> {
        let until = Instant::now() + patience;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            let mut newest = match self.inputs.recv_timeout(left) {
                Ok(input) => self.take(input),
                Err(RecvTimeoutError::Timeout) => return Ok(None),
                Err(RecvTimeoutError::Disconnected) => {
                    // The client is gone; whoever runs this stops soon.
                    std::thread::sleep(left);
                    return Ok(None);
                }
            };
            if !self.hub.plan.lockstep {
                while let Ok(input) = self.inputs.try_recv() {
                    newest = self.take(input).or(newest);
                }
            }
            if newest.is_some() {
                return Ok(newest);
            }
        }
    }

    fn apply(&mut self, command: &Command) -> Result<(), Infallible> {
        let rests = command.state != State::Active;
        if rests && self.resting {
            return Ok(());
        }
        self.resting = rests;
        let Command {
            force,
            torque,
            time_ns,
            ..
        } = *command;
        let frame = &self.frame;
        self.hub
            .publish(&self.arm.force, || match self.arm.force_kind {
                ForceKind::WrenchStamped => wrench(time_ns, frame, force, torque),
                ForceKind::Wrench => plain_wrench(force, torque),
                ForceKind::Vector3Stamped => vector_stamped(time_ns, frame, force),
                ForceKind::Float64MultiArray => array(force),
                ForceKind::OmniFeedback => omni_feedback(force),
            });
        if let Some(free) = self.arm.free.as_ref().filter(|_| rests) {
            self.hub.publish(free, || serde_json::json!({}));
        }
        Ok(())
    }
}
