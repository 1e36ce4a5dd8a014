//! Motion scripts: where the hand wants to be at a time. Smooth: position, velocity and acceleration are continuous.

use palpate_proto::messages::SceneSnapshot;
use serde::{Deserialize, Serialize};

/// Where on a body to work: chosen from the scene, so that scripts need no numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// A place near the surface, m.
    pub point: [f64; 3],
    /// From the body towards the tool, unit.
    pub outward: [f64; 3],
    /// Along the surface, unit, across `outward`.
    pub along: [f64; 3],
    /// Distance from `point` at which the tool is surely free, m.
    pub clear_m: f64,
}

/// A step of a motion file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// s from the start, growing.
    pub time_s: f64,
    /// m.
    pub position: [f64; 3],
}

/// A motion file: `[[waypoint]] time_s, position`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionFile {
    /// In order of time.
    #[serde(rename = "waypoint")]
    pub waypoints: Vec<Waypoint>,
}

/// Why a motion was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// Not a motion we know.
    #[error("{0:?} is no motion; there are press, slide, tap, circle, pull, or a file with [[waypoint]] entries")]
    Unknown(String),
    /// The scene has nothing to touch.
    #[error("the scene has no body {0:?} to aim at")]
    NoBody(String),
    /// Waypoints out of order or not finite.
    #[error("waypoint {0} is not finite, or its time is not later than the one before")]
    Waypoint(usize),
    /// No waypoints.
    #[error("a motion file needs at least one [[waypoint]]")]
    Empty,
}

/// What the hand does.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// In by `depth_m`, hold, out, again.
    Press {
        /// Where.
        target: Target,
        /// Past the first touch, m.
        depth_m: f64,
    },
    /// In, then to and fro along the surface.
    Slide {
        /// Where.
        target: Target,
        /// m.
        depth_m: f64,
    },
    /// Quick light presses.
    Tap {
        /// Where.
        target: Target,
        /// m.
        depth_m: f64,
    },
    /// In, then round on the surface.
    Circle {
        /// Where.
        target: Target,
        /// m.
        depth_m: f64,
    },
    /// In to a touch, grab, out by as much as a press goes in, let go, again.
    Pull {
        /// Where.
        target: Target,
        /// m.
        depth_m: f64,
    },
    /// Through given places.
    Waypoints(Vec<Waypoint>),
}

/// 0 at 0, 1 at 1, with zero first and second derivative at both ends; held outside.
fn ramp(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}

fn shift(a: [f64; 3], b: [f64; 3], s: f64) -> [f64; 3] {
    [a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s]
}

impl Motion {
    /// A motion by name, aimed at a body of the scene (the first, if none is named) for a tool that starts where the scene
    /// puts it.
    ///
    /// # Errors
    /// An unknown name, or a scene without that body.
    pub fn named(name: &str, scene: &SceneSnapshot, tool: &str, depth_m: f64) -> Result<Self, MotionError> {
        let target = Target::of(scene, tool).ok_or_else(|| MotionError::NoBody(tool.to_owned()))?;
        match name {
            "press" => Ok(Self::Press { target, depth_m }),
            "slide" => Ok(Self::Slide { target, depth_m }),
            "tap" => Ok(Self::Tap { target, depth_m }),
            "circle" => Ok(Self::Circle { target, depth_m }),
            "pull" => Ok(Self::Pull { target, depth_m }),
            other => Err(MotionError::Unknown(other.to_owned())),
        }
    }

    /// A motion through waypoints.
    ///
    /// # Errors
    /// None, or times that do not grow.
    pub fn through(file: MotionFile) -> Result<Self, MotionError> {
        let points = file.waypoints;
        if points.is_empty() {
            return Err(MotionError::Empty);
        }
        for (k, point) in points.iter().enumerate() {
            let finite = point.time_s.is_finite() && point.position.iter().all(|x| x.is_finite());
            if !finite || (k > 0 && point.time_s <= points[k - 1].time_s) {
                return Err(MotionError::Waypoint(k));
            }
        }
        Ok(Self::Waypoints(points))
    }

    /// What the hand holds down: bit 0 grabs.
    pub fn buttons(&self, t: f64) -> u32 {
        match self {
            Self::Pull { .. } => u32::from((1.5..3.3).contains(&(t % 4.0))),
            _ => 0,
        }
    }

    /// Where the hand wants to be, m.
    pub fn goal(&self, t: f64) -> [f64; 3] {
        match self {
            Self::Press { target, depth_m } => {
                // One press is four seconds: approach, press, hold, release.
                let cycle = t % 4.0;
                let pressed = ramp((cycle - 0.5) / 1.0) - ramp((cycle - 2.5) / 1.0);
                target.at(pressed, *depth_m, 0.0)
            }
            Self::Pull { target, depth_m } => {
                let cycle = t % 4.0;
                // Half as deep as a press, then out beyond the surface; free of it before the next cycle.
                let touch = ramp((cycle - 0.3) / 0.9) * (target.clear_m + 0.5 * depth_m);
                let pull = ramp((cycle - 1.7) / 1.0) * 1.5 * depth_m;
                let leave = ramp((cycle - 3.3) / 0.6) * (target.clear_m - depth_m);
                shift(target.point, target.outward, target.clear_m - touch + pull + leave)
            }
            Self::Tap { target, depth_m } => {
                let cycle = t % 0.5;
                let pressed = ramp((cycle - 0.1) / 0.12) - ramp((cycle - 0.25) / 0.12);
                target.at(pressed, *depth_m, 0.0)
            }
            Self::Slide { target, depth_m } => {
                let pressed = ramp((t - 0.5) / 1.0);
                let swing = libm::sin(std::f64::consts::TAU * 0.25 * (t - 1.5).max(0.0)) * ramp((t - 1.5) / 0.5);
                target.at(pressed, *depth_m, 0.008 * swing)
            }
            Self::Circle { target, depth_m } => {
                let pressed = ramp((t - 0.5) / 1.0);
                let angle = std::f64::consts::TAU * 0.25 * (t - 1.5).max(0.0);
                let grow = 0.006 * ramp((t - 1.5) / 1.0);
                let side = target.side();
                let place = target.at(pressed, *depth_m, grow * libm::cos(angle));
                shift(place, side, grow * libm::sin(angle))
            }
            Self::Waypoints(points) => {
                let k = points.partition_point(|point| point.time_s <= t);
                match (k.checked_sub(1).map(|k| points[k]), points.get(k)) {
                    (None, _) => points[0].position,
                    (Some(last), None) => last.position,
                    (Some(a), Some(b)) => {
                        let s = ramp((t - a.time_s) / (b.time_s - a.time_s));
                        let way = [0, 1, 2].map(|c| b.position[c] - a.position[c]);
                        shift(a.position, way, s)
                    }
                }
            }
        }
    }
}

impl Target {
    /// Aims a tool at the body nearest to where the scene puts it: straight towards the body's middle axis.
    pub fn of(scene: &SceneSnapshot, tool: &str) -> Option<Self> {
        let tool = scene.tools.iter().find(|t| t.id == tool)?;
        let from = tool.position;
        let distance = |p: &[f64; 3]| (0..3).map(|c| (p[c] - from[c]) * (p[c] - from[c])).sum::<f64>();
        let body = scene.bodies.iter().filter(|b| !b.rest_points.is_empty()).min_by(|a, b| {
            let least = |body: &palpate_proto::messages::BodySnapshot| {
                body.rest_points.iter().map(distance).fold(f64::INFINITY, f64::min)
            };
            least(a).total_cmp(&least(b))
        })?;
        let near = *body.rest_points.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        // Straight in along the axis on which the tool is farthest from the net's nearest point.
        let away = [0, 1, 2].map(|c| from[c] - near[c]);
        let axis = (0..3).max_by(|&a, &b| away[a].abs().total_cmp(&away[b].abs())).unwrap_or(0);
        let mut outward = [0.0; 3];
        outward[axis] = if away[axis] < 0.0 { -1.0 } else { 1.0 };
        let mut along = [0.0; 3];
        along[if axis == 2 { 0 } else { 2 }] = 1.0;
        // First touch: the ball's centre stands off by its radius from the nearest net point's plane.
        let mut point = from;
        point[axis] = near[axis] + outward[axis] * tool.radius;
        Some(Self { point, outward, along, clear_m: 0.01 })
    }

    /// Third direction.
    fn side(&self) -> [f64; 3] {
        let (a, b) = (self.outward, self.along);
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    /// `pressed` 0: clear of the surface; 1: in by `depth_m`; moved by `along_m`.
    fn at(&self, pressed: f64, depth_m: f64, along_m: f64) -> [f64; 3] {
        let height = self.clear_m - pressed * (self.clear_m + depth_m);
        shift(shift(self.point, self.outward, height), self.along, along_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_motion_is_smooth_enough_for_a_hand() {
        let target =
            Target { point: [0.02, 0.0, 0.045], outward: [1.0, 0.0, 0.0], along: [0.0, 0.0, 1.0], clear_m: 0.01 };
        let depth_m = 0.004;
        let motions = [
            Motion::Press { target, depth_m },
            Motion::Slide { target, depth_m },
            Motion::Tap { target, depth_m },
            Motion::Circle { target, depth_m },
            Motion::Pull { target, depth_m },
            Motion::Waypoints(vec![
                Waypoint { time_s: 0.5, position: [0.0; 3] },
                Waypoint { time_s: 1.0, position: [0.05, 0.0, 0.0] },
            ]),
        ];
        let dt = 1e-3;
        for motion in motions {
            let at = |k: i32| motion.goal(f64::from(k) * dt);
            for k in 1..10_000 {
                for c in 0..3 {
                    let speed = (at(k + 1)[c] - at(k)[c]) / dt;
                    let bend = (at(k + 1)[c] - 2.0 * at(k)[c] + at(k - 1)[c]) / (dt * dt);
                    assert!(speed.abs() < 0.5, "{motion:?} at {k} ms moves at {speed} m/s");
                    assert!(bend.abs() < 10.0, "{motion:?} at {k} ms accelerates at {bend} m/s²");
                }
            }
        }
    }

    #[test]
    fn waypoints_out_of_order_are_refused() {
        let at = |time_s| Waypoint { time_s, position: [0.0; 3] };
        let through = |waypoints| Motion::through(MotionFile { waypoints });
        assert_eq!(through(vec![]), Err(MotionError::Empty));
        assert_eq!(through(vec![at(0.0), at(0.0)]), Err(MotionError::Waypoint(1)));
        assert_eq!(through(vec![at(f64::NAN)]), Err(MotionError::Waypoint(0)));
    }
}
