//! What lies between every device and its tool: frames, scale, clutch, velocity, and the rules that
//! make a force zero.

use crate::frame::{Frame, v3};
use crate::guard::Cap;
use crate::link::{Command, Reading, Rest, State, ToolAnswer};
use crate::velocity::Differentiator;

/// How a device moves its tool.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplerSettings {
    /// Where the device's frame lies in the world.
    pub frame: Frame,
    /// While this button is down the tool stays, and the device moves without force.
    pub clutch_button: Option<u32>,
    /// While this button is down the tool holds what it touches.
    pub grab_button: Option<u32>,
    /// Low-pass of differentiated velocities, Hz.
    pub velocity_cutoff_hz: f64,
    /// What the device gets at most.
    pub cap: Cap,
    /// Time in which forces fade when the clutch or a pause takes them away, and come back, s.
    pub fade_s: f64,
    /// Length of a tick, s.
    pub dt_s: f64,
}

impl Default for CouplerSettings {
    fn default() -> Self {
        Self {
            frame: Frame::default(),
            clutch_button: None,
            grab_button: Some(0),
            velocity_cutoff_hz: 100.0,
            cap: Cap {
                force_n: f64::INFINITY,
                torque_nm: f64::INFINITY,
            },
            fade_s: 0.1,
            dt_s: 1e-3,
        }
    }
}

/// A pose for the tool, in the world's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolMotion {
    /// m.
    pub position: [f64; 3],
    /// Unit quaternion x y z w.
    pub orientation: [f64; 4],
    /// m/s.
    pub linear_velocity: [f64; 3],
    /// rad/s.
    pub angular_velocity: [f64; 3],
    /// Bit 0: grab.
    pub buttons: u32,
    /// The reading's.
    pub time_ns: u64,
}

/// A turn and a shift that the clutch has added.
#[derive(Clone, Copy, Debug)]
struct Shift {
    turn: [f64; 4],
    /// Where the device was when the clutch was released, in the world.
    from: [f64; 3],
    /// Where the tool is for that.
    to: [f64; 3],
}

/// Between one device and one tool. Gets every reading and every answer in their order.
#[derive(Clone, Debug)]
pub struct Coupler {
    settings: CouplerSettings,
    velocity: Differentiator,
    shift: Option<Shift>,
    /// Where the tool was when the clutch was pressed.
    held: Option<([f64; 3], [f64; 4])>,
    last: Option<([f64; 3], [f64; 4])>,
    gain: f64,
    tick: Option<u64>,
    refused: u64,
}

/// A quaternion farther than this from length 1 is refused.
const UNIT: f64 = 1e-3;
/// Within this it is taken as it is, so that its bits are kept.
const EXACT: f64 = 1e-9;

impl Coupler {
    /// Nothing came yet.
    pub fn new(settings: CouplerSettings) -> Self {
        Self {
            velocity: Differentiator::new(settings.velocity_cutoff_hz),
            shift: None,
            held: None,
            last: None,
            gain: 1.0,
            tick: None,
            refused: 0,
            settings,
        }
    }

    /// Readings that were not finite or whose orientation was no rotation.
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// The tool's pose for a reading; `None` for one that cannot be: it is counted and left.
    pub fn motion(&mut self, reading: &Reading) -> Option<ToolMotion> {
        let Some(orientation) = checked(reading) else {
            self.refused += 1;
            return None;
        };
        let frame = self.settings.frame;
        let velocity = match reading.velocity {
            Some(measured) => measured,
            None => self
                .velocity
                .sample(reading.position, orientation, reading.time_ns),
        };
        let place = frame.position(reading.position);
        let turned = frame.orientation(orientation);
        let down = |button: Option<u32>| {
            button.is_some_and(|button| button < 32 && reading.buttons >> button & 1 == 1)
        };
        let clutched = down(self.settings.clutch_button);
        let held = match (clutched, self.held) {
            (true, None) => {
                self.held = self.last.or(Some(self.shifted(place, turned)));
                self.held
            }
            (true, held) => held,
            (false, Some((to, orientation))) => {
                self.shift = Some(Shift {
                    turn: v3::turn(orientation, v3::inverse(turned)),
                    from: place,
                    to,
                });
                self.held = None;
                None
            }
            (false, None) => None,
        };
        let still = held.is_some();
        let (position, orientation) = held.unwrap_or_else(|| self.shifted(place, turned));
        self.last = Some((position, orientation));
        let moving = |velocity: [f64; 3]| if still { [0.0; 3] } else { velocity };
        Some(ToolMotion {
            position,
            orientation,
            linear_velocity: moving(frame.linear(velocity[0])),
            angular_velocity: moving(frame.angular(velocity[1])),
            buttons: u32::from(down(self.settings.grab_button)),
            time_ns: reading.time_ns,
        })
    }

    /// A pose after all that the clutch has moved. The tool's path keeps its direction: only its
    /// orientation and origin shift.
    fn shifted(&self, place: [f64; 3], turned: [f64; 4]) -> ([f64; 3], [f64; 4]) {
        match &self.shift {
            None => (place, turned),
            Some(shift) => {
                let orientation = v3::turn(shift.turn, turned);
                (
                    v3::add(shift.to, v3::sub(place, shift.from)),
                    v3::unit(orientation).unwrap_or(turned),
                )
            }
        }
    }

    /// What the device's motors are to do for the newest answer.
    pub fn command(&mut self, answer: &ToolAnswer) -> Command {
        let passed = match self.tick {
            Some(tick) if tick == answer.tick => 0,
            Some(tick) => answer.tick.saturating_sub(tick).max(1),
            None => 1,
        };
        self.tick = Some(answer.tick);
        let away = self.held.is_some() || answer.paused;
        let step = passed as f64 * self.settings.dt_s / self.settings.fade_s.max(1e-9);
        self.gain = match away {
            true => (self.gain - step).max(0.0),
            false => (self.gain + step).min(1.0),
        };
        let why = match answer {
            ToolAnswer { fault: true, .. } => Some(Rest::Fault),
            ToolAnswer { stale: true, .. } => Some(Rest::Stale),
            ToolAnswer { silent: true, .. } => Some(Rest::Silent),
            ToolAnswer { paused: true, .. } if self.gain == 0.0 => Some(Rest::Paused),
            _ => None,
        };
        if let Some(why) = why {
            return Command::rest(why, answer.time_ns);
        }
        let back = |v: [f64; 3]| self.settings.frame.back(v3::scale(v, self.gain));
        let (force, torque) = self
            .settings
            .cap
            .limit(back(answer.force), back(answer.torque));
        Command {
            force,
            torque,
            state: State::Active,
            time_ns: answer.time_ns,
        }
    }
}

/// The orientation of a reading that can be; it is made exactly one if it nearly is.
fn checked(reading: &Reading) -> Option<[f64; 4]> {
    let velocity = reading.velocity.unwrap_or_default();
    let numbers = reading
        .position
        .iter()
        .chain(&reading.orientation)
        .chain(velocity.iter().flatten());
    if !numbers.into_iter().all(|x| x.is_finite()) {
        return None;
    }
    let size = reading
        .orientation
        .iter()
        .map(|x| x * x)
        .sum::<f64>()
        .sqrt();
    match (size - 1.0).abs() {
        off if off <= EXACT => Some(reading.orientation),
        off if off <= UNIT => v3::unit(reading.orientation),
        _ => None,
    }
}

#[cfg(test)]
#[path = "coupler_tests.rs"]
mod tests;
