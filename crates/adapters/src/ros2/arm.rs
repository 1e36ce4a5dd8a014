//! A device behind ROS topics.

use super::node::{Intake, RosNode, RosPublisher, RosReceiver};
use super::plan::ArmPlan;
use palpate_devices::ros2::{
    Attachment, Bool, ButtonKind, Empty, Float64MultiArray, ForceKind, Gid, Header, Joy,
    OmniButtonEvent, OmniFeedback, PoseStamped, Qos, TwistStamped, Vector3Stamped, Wrench,
    WrenchStamped,
};
use palpate_devices::{Command, DeviceEnd, Reading, State};
use std::convert::Infallible;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Messages that may wait.
const QUEUE: usize = 256;
/// A second publisher is heard when the first one has been silent for so long.
const SILENCE: Duration = Duration::from_millis(250);
/// A velocity older than this is not used.
const VELOCITY: Duration = Duration::from_millis(50);

enum Input {
    Pose(PoseStamped, i64),
    Velocity([[f64; 3]; 2]),
    Buttons(u32),
}

/// What goes to a device that publishes poses.
pub struct RosArm {
    inputs: Receiver<Input>,
    lockstep: bool,
    velocity: Option<([[f64; 3]; 2], Instant)>,
    buttons: u32,
    frame: String,
    force_kind: ForceKind,
    force: RosPublisher,
    free: Option<RosPublisher>,
    absolute: Option<RosPublisher>,
    resting: bool,
    intake: Arc<Intake>,
    closing: Arc<AtomicBool>,
    _receivers: Vec<RosReceiver>,
}

/// Puts inputs into the queue of an arm.
#[derive(Clone)]
struct Door {
    queue: SyncSender<Input>,
    intake: Arc<Intake>,
    lockstep: bool,
    closing: Arc<AtomicBool>,
    topic: String,
}

impl Door {
    /// In lockstep every pose has its tick: a sender that is faster waits.
    fn pass(&self, mut input: Input) {
        loop {
            match self.queue.try_send(input) {
                Ok(()) | Err(TrySendError::Disconnected(_)) => return,
                Err(TrySendError::Full(_)) if !self.lockstep => {
                    let why = "it came faster than poses are taken";
                    return self.intake.drop_one(&self.intake.overrun, &self.topic, why);
                }
                Err(TrySendError::Full(again)) => input = again,
            }
            if self.closing.load(Ordering::Relaxed) {
                return;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

impl RosArm {
    /// Declares the topics of an arm.
    ///
    /// # Errors
    /// Zenoh refused.
    pub fn new(node: &RosNode, plan: &ArmPlan, world: &str, lockstep: bool) -> zenoh::Result<Self> {
        let (queue, inputs) = sync_channel(QUEUE);
        let intake = Arc::new(Intake::default());
        let closing = Arc::new(AtomicBool::new(false));
        let door = Door {
            queue,
            intake: intake.clone(),
            lockstep,
            closing: closing.clone(),
            topic: plan.pose.clone(),
        };
        // Before the subscribers: who answers at once is heard.
        let force = match plan.force_kind {
            ForceKind::WrenchStamped => node.publisher::<WrenchStamped>(&plan.force, Qos::Newest),
            ForceKind::Wrench => node.publisher::<Wrench>(&plan.force, Qos::Newest),
            ForceKind::Vector3Stamped => node.publisher::<Vector3Stamped>(&plan.force, Qos::Newest),
            ForceKind::Float64MultiArray => {
                node.publisher::<Float64MultiArray>(&plan.force, Qos::Newest)
            }
            ForceKind::OmniFeedback => node.publisher::<OmniFeedback>(&plan.force, Qos::Newest),
        }?;
        let reliable = |topic: &Option<String>| topic.clone();
        let free = reliable(&plan.free)
            .map(|topic| node.publisher::<Empty>(&topic, Qos::Reliable))
            .transpose()?;
        let absolute = reliable(&plan.absolute)
            .map(|topic| node.publisher::<Bool>(&topic, Qos::Reliable))
            .transpose()?;
        let mut receivers = Vec::new();
        if let Some(topic) = &plan.velocity {
            let door = door.clone();
            let take = move |twist: TwistStamped, _| {
                door.pass(Input::Velocity([twist.linear, twist.angular]));
            };
            receivers.push(node.subscriber(topic, Qos::Newest, &intake, take)?);
        }
        if let Some((topic, kind)) = &plan.button {
            receivers.push(buttons(node, topic, *kind, &intake, door.clone())?);
        }
        let gate = Gate {
            door,
            frame: plan.frame.clone(),
            crtk: plan.free.is_some(),
            owner: Mutex::new(None),
        };
        let take = move |pose, attachment| gate.take(pose, &attachment);
        receivers.push(node.subscriber(&plan.pose, Qos::Newest, &intake, take)?);
        Ok(Self {
            inputs,
            lockstep,
            velocity: None,
            buttons: 0,
            frame: plan.frame.clone().unwrap_or_else(|| world.to_owned()),
            force_kind: plan.force_kind,
            force,
            free,
            absolute,
            resting: true,
            intake,
            closing,
            _receivers: receivers,
        })
    }

    /// What came, and what was dropped.
    pub fn intake(&self) -> &Arc<Intake> {
        &self.intake
    }

    /// Takes an input; gives the reading that a pose is.
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
            Input::Pose(pose, source_ns) => {
                if self.frame != pose.header.frame_id && !pose.header.frame_id.is_empty() {
                    self.frame.clone_from(&pose.header.frame_id);
                }
                let fresh =
                    |(_, at): &([[f64; 3]; 2], Instant)| self.lockstep || at.elapsed() < VELOCITY;
                let stamp_ns = pose.header.stamp.to_ns();
                Some(Reading {
                    position: pose.position,
                    orientation: pose.orientation,
                    velocity: self.velocity.filter(fresh).map(|(velocity, _)| velocity),
                    buttons: self.buttons,
                    time_ns: match stamp_ns {
                        0 => u64::try_from(source_ns).unwrap_or(0),
                        stamp_ns => stamp_ns,
                    },
                })
            }
        }
    }

    fn put(&self, command: &Command) {
        let Command { force, torque, .. } = *command;
        let header = || Header::new(command.time_ns, &self.frame);
        match self.force_kind {
            ForceKind::WrenchStamped => self.force.put(&WrenchStamped {
                header: header(),
                force,
                torque,
            }),
            ForceKind::Wrench => self.force.put(&Wrench { force, torque }),
            ForceKind::Vector3Stamped => self.force.put(&Vector3Stamped {
                header: header(),
                vector: force,
            }),
            ForceKind::Float64MultiArray => self.force.put(&Float64MultiArray {
                data: force.to_vec(),
                ..Float64MultiArray::default()
            }),
            ForceKind::OmniFeedback => self.force.put(&OmniFeedback {
                force,
                position: [0.0; 3],
            }),
        }
    }
}

impl Drop for RosArm {
    fn drop(&mut self) {
        self.closing.store(true, Ordering::Relaxed);
    }
}

impl DeviceEnd for RosArm {
    type Error = Infallible;

    /// In real time the newest pose of those that wait; in lockstep each.
    fn reading(&mut self, patience: Duration) -> Result<Option<Reading>, Infallible> {
        let until = Instant::now() + patience;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            let mut newest = match self.inputs.recv_timeout(left) {
                Ok(input) => self.take(input),
                Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => return Ok(None),
            };
            if !self.lockstep {
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
        match command.state {
            State::Active => {
                if self.resting
                    && let Some(absolute) = &self.absolute
                {
                    absolute.put(&Bool { data: true });
                }
                self.resting = false;
                self.put(command);
            }
            // Once: another program may have the device from now on.
            State::Resting(why) if !self.resting => {
                self.resting = true;
                self.put(command);
                if let Some(free) = &self.free {
                    free.put(&Empty::default());
                }
                tracing::info!(?why, "a ROS device rests");
            }
            State::Resting(_) => {}
        }
        Ok(())
    }
}

/// Lets poses in: valid ones, of one publisher, in the right frame.
struct Gate {
    door: Door,
    frame: Option<String>,
    crtk: bool,
    owner: Mutex<Option<(Gid, Instant)>>,
}

impl Gate {
    fn take(&self, pose: PoseStamped, attachment: &Attachment) {
        let (intake, topic) = (&self.door.intake, &self.door.topic);
        if self.crtk && pose.header.stamp.to_ns() == 0 {
            let why = "its stamp is 0: not valid, says CRTK";
            return intake.drop_one(&intake.not_valid, topic, why);
        }
        if let Some(frame) = &self.frame
            && *frame != pose.header.frame_id
        {
            let why = format!("its frame is {:?}, not {frame:?}", pose.header.frame_id);
            return intake.drop_one(&intake.wrong_frame, topic, &why);
        }
        {
            let mut owner = self.owner.lock().unwrap_or_else(PoisonError::into_inner);
            match &mut *owner {
                Some((gid, heard)) if *gid == attachment.gid => *heard = Instant::now(),
                Some((_, heard)) if heard.elapsed() < SILENCE => {
                    let why = "another publisher moves this tool";
                    return intake.drop_one(&intake.other_publisher, topic, why);
                }
                none => *none = Some((attachment.gid, Instant::now())),
            }
        }
        intake.taken.fetch_add(1, Ordering::Relaxed);
        self.door.pass(Input::Pose(pose, attachment.source_ns));
    }
}

fn buttons(
    node: &RosNode,
    topic: &str,
    kind: ButtonKind,
    intake: &Arc<Intake>,
    door: Door,
) -> zenoh::Result<RosReceiver> {
    let bits = |buttons: &[i32]| {
        let down = buttons.iter().take(32).enumerate();
        down.fold(0, |bits, (k, &button)| bits | u32::from(button != 0) << k)
    };
    let pass = move |bits| door.pass(Input::Buttons(bits));
    match kind {
        ButtonKind::Joy => node.subscriber(topic, Qos::Reliable, intake, move |joy: Joy, _| {
            pass(bits(&joy.buttons));
        }),
        ButtonKind::Bool => node.subscriber(topic, Qos::Reliable, intake, move |flag: Bool, _| {
            pass(u32::from(flag.data));
        }),
        ButtonKind::OmniButtonEvent => {
            let take = move |event: OmniButtonEvent, _| {
                pass(bits(&[event.grey_button, event.white_button]));
            };
            node.subscriber(topic, Qos::Reliable, intake, take)
        }
    }
}
