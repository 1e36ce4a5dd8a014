//! Motions by name: where the hand wants to be at a time. Position, velocity and acceleration are
//! continuous, and the velocity is the exact derivative, so that the hand's damper follows it
//! without lag.

use super::hand::Goal;
use super::motion_error::MotionError;
use super::path::Path;
use super::session::Session;
use super::smooth::Flow;
use super::target::Target;
use palpate_proto::messages::SceneSnapshot;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// What the hand does, aimed by a [`Target`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// In by the depth, hold, out, again: four seconds.
    Press,
    /// In, then to and fro along the surface.
    Slide,
    /// Quick presses, two a second.
    Tap,
    /// In, then round on the surface.
    Circle,
    /// In to a touch, grab, out by as much as a press goes in, let go, again: four seconds.
    Pull,
    /// In, then trembling there: half a millimetre at 5 and 9 Hz.
    Tremor,
    /// Still, clear of the body.
    Hold,
}

impl Kind {
    /// By name.
    ///
    /// # Errors
    /// Not one of them.
    pub fn named(name: &str) -> Result<Self, MotionError> {
        Ok(match name {
            "press" => Self::Press,
            "slide" => Self::Slide,
            "tap" => Self::Tap,
            "circle" => Self::Circle,
            "pull" => Self::Pull,
            "tremor" => Self::Tremor,
            "hold" => Self::Hold,
            other => return Err(MotionError::Unknown(other.to_owned())),
        })
    }

    /// Where the hand wants to be.
    pub(super) fn place(self, target: &Target, depth_m: f64, t: Flow) -> [Flow; 3] {
        let none = Flow::default();
        match self {
            Self::Press => {
                // Approach, press, hold, release.
                let cycle = t.cycle(4.0);
                let pressed = cycle.ramp(0.5, 1.0) - cycle.ramp(2.5, 1.0);
                target.place(target.height(pressed, depth_m), none, none)
            }
            Self::Tap => {
                let cycle = t.cycle(0.5);
                let pressed = cycle.ramp(0.1, 0.12) - cycle.ramp(0.25, 0.12);
                target.place(target.height(pressed, depth_m), none, none)
            }
            Self::Pull => {
                let cycle = t.cycle(4.0);
                // Half as deep as a press, then out beyond the surface; free of it before the next
                // cycle.
                let touch = cycle.ramp(0.3, 0.9) * (target.clear_m + 0.5 * depth_m);
                let pull = cycle.ramp(1.7, 1.0) * (1.5 * depth_m);
                let leave = cycle.ramp(3.3, 0.6) * (target.clear_m - depth_m);
                target.place(
                    Flow::constant(target.clear_m) - touch + pull + leave,
                    none,
                    none,
                )
            }
            Self::Slide => {
                let height = target.height(t.ramp(0.5, 1.0), depth_m);
                let swing = (t.since(1.5) * (TAU * 0.25)).sin() * t.ramp(1.5, 0.5);
                target.place(height, swing * 0.008, none)
            }
            Self::Circle => {
                let height = target.height(t.ramp(0.5, 1.0), depth_m);
                let angle = t.since(1.5) * (TAU * 0.25);
                let radius = t.ramp(1.5, 1.0) * 0.006;
                target.place(height, radius * angle.cos(), radius * angle.sin())
            }
            Self::Tremor => {
                let shake = |hz: f64| (t * (TAU * hz)).sin() * t.ramp(1.5, 0.5) * 0.000_25;
                let height = target.height(t.ramp(0.5, 1.0), depth_m) + shake(5.0) + shake(9.0);
                target.place(height, shake(9.0) - shake(5.0), none)
            }
            Self::Hold => target.place(Flow::constant(target.clear_m), none, none),
        }
    }

    /// What the hand holds down: bit 0 grabs.
    pub(super) fn buttons(self, t: f64) -> u32 {
        u32::from(self == Self::Pull && (1.5..3.3).contains(&t.rem_euclid(4.0)))
    }
}

/// What the hand does.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// One thing over and over.
    Named {
        /// Kind of motion.
        kind: Kind,
        /// Where the motion is aimed.
        target: Target,
        /// Past the first touch, m.
        depth_m: f64,
    },
    /// Through given places.
    Path(Path),
    /// One thing after another.
    Session(Session),
}

impl Motion {
    /// A motion by name, aimed at the nearest body of the scene for a tool that starts where the
    /// scene puts it.
    ///
    /// # Errors
    /// An unknown name, or a scene without a body.
    pub fn named(
        name: &str,
        scene: &SceneSnapshot,
        tool: &str,
        depth_m: f64,
    ) -> Result<Self, MotionError> {
        let kind = Kind::named(name)?;
        let target = Target::of(scene, tool).ok_or_else(|| MotionError::NoBody(tool.to_owned()))?;
        Ok(Self::Named {
            kind,
            target,
            depth_m,
        })
    }

    /// What the hand holds down: bit 0 grabs.
    pub fn buttons(&self, t: f64) -> u32 {
        match self {
            Self::Named { kind, .. } => kind.buttons(t),
            Self::Path(path) => path.buttons(t),
            Self::Session(session) => session.buttons(t),
        }
    }

    /// Where the hand wants to be, and how fast it moves there.
    pub fn goal(&self, t: f64) -> Goal {
        match self {
            Self::Named {
                kind,
                target,
                depth_m,
            } => passing(kind.place(target, *depth_m, Flow::time(t))),
            Self::Path(path) => path.goal(t),
            Self::Session(session) => session.goal(t),
        }
    }
}

pub(super) fn passing(place: [Flow; 3]) -> Goal {
    Goal::moving(place.map(|x| x.value), place.map(|x| x.rate))
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::motion_error::NAMES;
    use super::*;

    pub(in super::super) const TARGET: Target = Target {
        point: [0.02, 0.0, 0.045],
        outward: [1.0, 0.0, 0.0],
        along: [0.0, 0.0, 1.0],
        clear_m: 0.01,
    };

    /// Smooth enough for a hand, and the velocity is the derivative of the positions.
    pub(in super::super) fn check_smooth(motion: &Motion, seconds: i32) {
        let dt = 1e-3;
        let at = |k: i32| motion.goal(f64::from(k) * dt);
        for k in 1..seconds * 1_000 {
            let (before, here, after) = (at(k - 1), at(k), at(k + 1));
            for c in 0..3 {
                let speed = (after.position[c] - before.position[c]) / (2.0 * dt);
                let bend =
                    (after.position[c] - 2.0 * here.position[c] + before.position[c]) / (dt * dt);
                assert!(
                    speed.abs() < 0.5,
                    "{motion:?} at {k} ms moves at {speed} m/s"
                );
                assert!(
                    bend.abs() < 10.0,
                    "{motion:?} at {k} ms accelerates at {bend} m/s²"
                );
                // Central differences err by dt²/6 of the third derivative, here below 1000 m/s³.
                let gap = (speed - here.velocity[c]).abs();
                assert!(
                    gap < 2e-4,
                    "{motion:?} at {k} ms: {speed} m/s, told {}",
                    here.velocity[c]
                );
            }
        }
    }

    #[test]
    fn every_motion_is_smooth_enough_for_a_hand_and_tells_its_velocity() {
        for name in NAMES.split(", ") {
            let kind = Kind::named(name).unwrap();
            check_smooth(
                &Motion::Named {
                    kind,
                    target: TARGET,
                    depth_m: 0.004,
                },
                10,
            );
        }
    }

    #[test]
    fn a_press_reaches_its_depth_and_a_pull_grabs() {
        let press = Motion::Named {
            kind: Kind::Press,
            target: TARGET,
            depth_m: 0.004,
        };
        assert!((press.goal(2.0).position[0] - 0.016).abs() < 1e-15);
        assert!((press.goal(3.9).position[0] - 0.03).abs() < 1e-15);
        let pull = Motion::Named {
            kind: Kind::Pull,
            target: TARGET,
            depth_m: 0.004,
        };
        assert_eq!(
            (
                pull.buttons(1.0),
                pull.buttons(2.0),
                pull.buttons(3.5),
                pull.buttons(6.0)
            ),
            (0, 1, 0, 1)
        );
    }

    #[test]
    fn an_unknown_motion_is_told_what_there_is() {
        let error = Kind::named("poke").unwrap_err().to_string();
        assert!(
            error.contains("poke") && error.contains("tremor") && error.contains("[[step]]"),
            "{error}"
        );
    }
}
