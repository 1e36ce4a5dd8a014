//! What moves tools: a motion that is followed exactly, a force that is kept, taps over a grid, or a
//! simulated device with a hand on it, near or far away.

use super::error::ScenarioError;
use super::files::Source;
use super::scan::{ScanSpec, Scanner};
use palpate_client::device::{
    Channel, DeviceModel, Hand, Interpolation, Network, Passivity, PassivitySettings, Path,
    SimulatedDevice, Waypoint, devices,
};
use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_proto::text::located;
use palpate_sim::haptics::DevicePose;
use palpate_sim::solve::grip::GRAB;
use palpate_sim::tick::record::ToolOutput;
use serde::Deserialize;

/// `hands.TOOL = { … }`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum HandSpec {
    /// `{ motion = "press.toml" }`: way-points, followed exactly.
    Motion(String),
    /// `{ force = { … } }`: touches, and keeps a force.
    Force(ForceSpec),
    /// `{ scan = { … } }`: taps over a grid.
    Scan(ScanSpec),
    /// `{ device = { … } }`: a device with a hand that wants to follow a motion.
    Device(DeviceHandSpec),
}

/// A force along a direction from the tool's start, kept by a hand that makes up each tick for a
/// fiftieth of what is missing.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceSpec {
    /// Where the hand pushes or pulls to, any length above 0.
    pub direction: [f64; 3],
    /// N.
    pub force_n: f64,
    /// Force over displacement of what is pushed, about, N/m.
    pub stiffness_n_m: f64,
    /// s; then the tool goes to where it is away.
    pub hold_s: f64,
    /// Where it touches at first, m: a touch so light that nothing gives.
    pub touch: [f64; 3],
    /// Grab there.
    #[serde(default)]
    pub grab: bool,
    /// Where it goes afterwards, m.
    pub away: [f64; 3],
}

/// A simulated device.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviceHandSpec {
    /// Way-points that the hand wants to follow.
    pub motion: String,
    /// A preset of `palpate device --device`.
    pub model: String,
    /// light, relaxed or firm.
    pub hand: String,
    /// Each way, s.
    #[serde(default)]
    pub delay_s: f64,
    /// The device controls its port's energy.
    #[serde(default)]
    pub passivity: bool,
}

/// The motion file of a tool, as `palpate device --motion` reads it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MotionFile {
    #[serde(rename = "waypoint")]
    waypoints: Vec<Waypoint>,
    #[serde(default)]
    interpolation: Interpolation,
    #[serde(default)]
    repeat: bool,
}

/// A hand at work.
pub enum HandAtWork {
    Path(Path),
    Force(ForceHand),
    Scan(Box<Scanner>),
    Device(Box<FarDevice>),
}

pub struct ForceHand {
    spec: ForceSpec,
    direction: Vector3,
    place: Point3,
}

/// A device, its hand, and the network between it and the loop.
pub struct FarDevice {
    path: Path,
    device: SimulatedDevice,
    poses: Channel<[f64; 3]>,
    forces: Channel<[f64; 3]>,
    passivity: Option<Passivity>,
    felt_n: [f64; 3],
    reported: [f64; 3],
}

impl HandSpec {
    /// Reads its files; `start` is where the tool starts, m.
    pub fn at_work(
        &self,
        run: &str,
        start: [f64; 3],
        source: &Source,
    ) -> Result<HandAtWork, ScenarioError> {
        let wrong = |reason: String| ScenarioError::run(run, reason);
        Ok(match self {
            Self::Motion(file) => HandAtWork::Path(path(file, source)?),
            Self::Force(spec) => {
                let direction = Vector3::from(spec.direction).try_normalize(0.0);
                HandAtWork::Force(ForceHand {
                    direction: direction
                        .ok_or_else(|| wrong(format!("{:?} is no direction", spec.direction)))?,
                    place: Point3::from(spec.touch),
                    spec: spec.clone(),
                })
            }
            Self::Scan(spec) => HandAtWork::Scan(Box::new(Scanner::new(spec).map_err(wrong)?)),
            Self::Device(spec) => {
                let known = devices();
                let named = |model: &&DeviceModel| model.name == spec.model;
                let model = known.iter().find(named).ok_or_else(|| {
                    let names: Vec<&str> = known.iter().map(|model| model.name.as_str()).collect();
                    wrong(format!(
                        "{:?} is no device; there are {names:?}",
                        spec.model
                    ))
                })?;
                let hand = Hand::preset(&spec.hand).map_err(|e| wrong(e.to_string()))?;
                let network = Network {
                    delay_s: spec.delay_s,
                    ..Network::default()
                };
                let channel = || Channel::new(network).map_err(|e| wrong(e.to_string()));
                HandAtWork::Device(Box::new(FarDevice {
                    path: path(&spec.motion, source)?,
                    poses: channel()?,
                    forces: channel()?,
                    passivity: (spec.passivity)
                        .then(|| Passivity::new(PassivitySettings::strict(model))),
                    device: SimulatedDevice::new(model.clone(), hand, start, 1),
                    felt_n: [0.0; 3],
                    reported: start,
                }))
            }
        })
    }
}

fn path(file: &str, source: &Source) -> Result<Path, ScenarioError> {
    let wrong = |reason: String| ScenarioError::File {
        path: format!("{}/{file}", source.name()),
        reason,
    };
    let text = source.text(file)?;
    let read: MotionFile = toml::from_str(&text)
        .map_err(|error| wrong(located(&text, error.span(), error.message())))?;
    Path::new(read.waypoints, read.interpolation, read.repeat, file)
        .map_err(|error| wrong(error.to_string()))
}

impl HandAtWork {
    /// The pose for the tick that ends at a time, s; `last` is what the tool got in the tick before.
    pub fn pose(&mut self, seq: u64, time_s: f64, dt_s: f64, last: &ToolOutput) -> DevicePose {
        let (position, orientation, buttons) = match self {
            Self::Path(path) => {
                let goal = path.goal(time_s);
                (goal.position, goal.orientation, path.buttons(time_s))
            }
            Self::Force(hand) => {
                let (place, buttons) = hand.place(time_s, last);
                (place.coords.into(), [0.0, 0.0, 0.0, 1.0], buttons)
            }
            Self::Scan(scanner) => {
                let place = scanner.place(time_s, last);
                (place.coords.into(), [0.0, 0.0, 0.0, 1.0], 0)
            }
            Self::Device(far) => (far.place(time_s, dt_s, last), [0.0, 0.0, 0.0, 1.0], 0),
        };
        let [x, y, z, w] = orientation;
        DevicePose {
            seq,
            t_client_ns: 0,
            position: Point3::from(position),
            orientation: Rotation::new_normalize(nalgebra::Quaternion::new(w, x, y, z)),
            linear_velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            buttons,
        }
    }

    /// The device, if it is one.
    pub fn device(&self) -> Option<&FarDevice> {
        match self {
            Self::Device(far) => Some(far),
            _ => None,
        }
    }

    /// What taps found, if it is a scan.
    pub fn scanner(&self) -> Option<&Scanner> {
        match self {
            Self::Scan(scanner) => Some(scanner),
            _ => None,
        }
    }
}

impl ForceHand {
    fn place(&mut self, time_s: f64, last: &ToolOutput) -> (Point3, u32) {
        let ForceSpec {
            force_n,
            stiffness_n_m,
            hold_s,
            grab,
            away,
            ..
        } = self.spec;
        if time_s > hold_s {
            return (Point3::from(away), 0);
        }
        // A touch first; a grip takes hold in it.
        if time_s > 0.02 {
            let force = -self.direction.dot(&last.force_n);
            self.place += self.direction * (0.02 * (force_n - force) / stiffness_n_m);
        }
        (self.place, if grab { GRAB } else { 0 })
    }
}

impl FarDevice {
    fn place(&mut self, time_s: f64, dt_s: f64, last: &ToolOutput) -> [f64; 3] {
        self.forces.send(time_s, last.force_n.into());
        if let Some(force) = self.forces.receive(time_s).last() {
            self.felt_n = force;
        }
        let here = self.device.pose().position;
        let held = match &mut self.passivity {
            Some(passivity) => passivity.force(self.felt_n, here, dt_s),
            None => self.felt_n,
        };
        let goal = self.path.goal(time_s - 0.5 * dt_s);
        self.device.advance(goal, held, dt_s);
        self.poses.send(time_s, self.device.pose().position);
        if let Some(pose) = self.poses.receive(time_s).last() {
            self.reported = pose;
        }
        self.reported
    }

    /// Where it is, m.
    pub fn position(&self) -> [f64; 3] {
        self.device.true_position()
    }

    /// What it gave to the loop so far, J: below zero, the loop made energy.
    pub fn given_j(&self) -> f64 {
        self.device.energy().loop_j
    }
}
