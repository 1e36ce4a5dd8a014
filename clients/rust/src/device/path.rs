//! A path through given places.

use super::hand::Goal;
use super::motion_error::MotionError;
use super::smooth::Flow;
use super::v3;
use serde::{Deserialize, Serialize};

/// A place to pass at a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// s from the start, growing.
    pub time_s: f64,
    /// Position, m.
    pub position: [f64; 3],
    /// How long to stay, s.
    #[serde(default)]
    pub hold_s: f64,
    /// Quaternion x y z w; that of the way-point before (at first: unturned) if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orientation: Option<[f64; 4]>,
    /// What is held down from here on to the next. Bit 0 grabs.
    #[serde(default)]
    pub buttons: u32,
    /// Times the hand's grip, reached here.
    #[serde(default = "own")]
    pub grip: f64,
}

fn own() -> f64 {
    1.0
}

impl Waypoint {
    /// A place and a time.
    pub fn new(time_s: f64, position: [f64; 3]) -> Self {
        Self {
            time_s,
            position,
            hold_s: 0.0,
            orientation: None,
            buttons: 0,
            grip: 1.0,
        }
    }
}

/// How to go from one way-point to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Interpolation {
    /// From rest to rest, with the least jerk.
    #[default]
    Smooth,
    /// At constant speed, as for motions that were measured.
    Linear,
}

/// A checked path. The hand is at the first place until its time, and stays at the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    points: Vec<Waypoint>, // their orientations are all given, unit
    interpolation: Interpolation,
    repeat: bool,
}

impl Path {
    /// Checks way-points. `origin` names them in errors.
    ///
    /// # Errors
    /// None, one that is not finite, times that do not grow, or a repeating path that does not end
    /// where it began.
    pub fn new(
        points: Vec<Waypoint>,
        interpolation: Interpolation,
        repeat: bool,
        origin: &str,
    ) -> Result<Self, MotionError> {
        let mut points = points;
        let first = *points.first().ok_or_else(|| MotionError::Kind {
            origin: origin.to_owned(),
        })?;
        let (mut free_s, mut orientation) = (f64::NEG_INFINITY, v3::UNTURNED);
        let last = points.len();
        for (k, point) in points.iter_mut().enumerate() {
            let check = |field, value: f64, good: bool, expected| match good {
                true => Ok(()),
                false => {
                    let (origin, entry, index) = (origin.to_owned(), "waypoint", k + 1);
                    Err(MotionError::Entry {
                        origin,
                        entry,
                        index,
                        field,
                        value,
                        expected,
                    })
                }
            };
            let later = point.time_s.is_finite() && point.time_s > free_s && point.time_s >= 0.0;
            check(
                "time_s",
                point.time_s,
                later,
                "a time, not negative, after the way-point before and its hold_s",
            )?;
            for value in point.position {
                check("position", value, value.is_finite(), "a finite place in m")?;
            }
            let finite = point.hold_s.is_finite() && point.hold_s >= 0.0;
            check("hold_s", point.hold_s, finite, "a finite time, 0 or more")?;
            check(
                "grip",
                point.grip,
                (0.0..=100.0).contains(&point.grip),
                "a factor from 0 to 100",
            )?;
            if let Some(given) = point.orientation {
                let size = given.iter().map(|x| x * x).sum::<f64>().sqrt();
                check(
                    "orientation",
                    size,
                    (size - 1.0).abs() < 1e-3,
                    "a quaternion x y z w of length 1",
                )?;
                orientation = v3::unit(given);
            }
            point.orientation = Some(orientation);
            free_s = point.time_s + point.hold_s;
            if repeat && k + 1 == last {
                let gap = v3::norm(v3::sub(point.position, first.position));
                check(
                    "position",
                    gap,
                    gap < 1e-9,
                    "the first place again (repeat = true)",
                )?;
                check(
                    "time_s",
                    point.time_s,
                    free_s > 0.0,
                    "a time above 0 (repeat = true)",
                )?;
            }
        }
        Ok(Self {
            points,
            interpolation,
            repeat,
        })
    }

    fn time(&self, t: f64) -> f64 {
        let length = self
            .points
            .last()
            .map_or(0.0, |last| last.time_s + last.hold_s);
        if self.repeat { t.rem_euclid(length) } else { t }
    }

    /// What the hand holds down.
    pub fn buttons(&self, t: f64) -> u32 {
        let t = self.time(t);
        self.points
            .iter()
            .rfind(|point| point.time_s <= t)
            .map_or(0, |point| point.buttons)
    }

    /// Where the hand wants to be.
    pub fn goal(&self, t: f64) -> Goal {
        let t = self.time(t);
        let k = self.points.partition_point(|point| point.time_s <= t);
        let rest = |point: &Waypoint| Goal {
            orientation: point.orientation.unwrap_or(v3::UNTURNED),
            grip: point.grip,
            ..Goal::at(point.position)
        };
        let Some(b) = self.points.get(k) else {
            return rest(&self.points[k - 1]);
        };
        let Some(a) = k.checked_sub(1).map(|k| self.points[k]) else {
            return rest(b);
        };
        let start = a.time_s + a.hold_s;
        let length = b.time_s - start;
        let share = match self.interpolation {
            Interpolation::Smooth => Flow::time(t).ramp(start, length),
            Interpolation::Linear if t < start => Flow::default(),
            Interpolation::Linear => Flow {
                value: (t - start) / length,
                rate: 1.0 / length,
            },
        };
        let way = v3::sub(b.position, a.position);
        let (from, to) = (rest(&a).orientation, rest(b).orientation);
        let turn = v3::to_vector(v3::turn(to, v3::inverse(from)));
        Goal {
            position: v3::add(a.position, v3::scale(way, share.value)),
            velocity: v3::scale(way, share.rate),
            orientation: v3::turn(v3::from_vector(v3::scale(turn, share.value)), from),
            angular_velocity: v3::scale(turn, share.rate),
            grip: a.grip + (b.grip - a.grip) * share.value,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Motion;
    use super::super::motion::tests::check_smooth;
    use super::*;

    fn path(points: Vec<Waypoint>, repeat: bool) -> Result<Path, MotionError> {
        Path::new(points, Interpolation::Smooth, repeat, "m.toml")
    }

    #[test]
    fn way_points_are_passed_at_their_times_and_held() {
        let turned = v3::from_vector([0.0, 0.0, 1.0]);
        let points = vec![
            Waypoint {
                hold_s: 0.2,
                ..Waypoint::new(0.5, [0.0; 3])
            },
            Waypoint {
                orientation: Some(turned),
                grip: 3.0,
                buttons: 1,
                ..Waypoint::new(1.2, [0.05, 0.0, 0.0])
            },
        ];
        let smooth = path(points.clone(), false).unwrap();
        let linear = Path::new(points, Interpolation::Linear, false, "m.toml").unwrap();
        for path in [&smooth, &linear] {
            assert_eq!(path.goal(0.1), Goal::at([0.0; 3]));
            assert_eq!(path.goal(0.7).position, [0.0; 3]);
            assert!((path.goal(0.95).position[0] - 0.025).abs() < 1e-15);
            assert!((path.goal(0.95).grip - 2.0).abs() < 1e-12);
            assert!((v3::to_vector(path.goal(0.95).orientation)[2] - 0.5).abs() < 1e-15);
            assert_eq!(
                (
                    path.buttons(1.0),
                    path.buttons(1.2),
                    path.goal(9.0).position[0]
                ),
                (0, 1, 0.05)
            );
        }
        // A quarter of the way in time: 10/64 − 15/256 + 6/1024 of the way, or a quarter.
        assert!((smooth.goal(0.825).position[0] - 0.05 * 0.103_515_625).abs() < 1e-15);
        assert!((linear.goal(0.825).position[0] - 0.0125).abs() < 1e-15);
        assert!((linear.goal(0.825).velocity[0] - 0.1).abs() < 1e-12);
        assert!((linear.goal(0.825).angular_velocity[2] - 2.0).abs() < 1e-12);
        check_smooth(&Motion::Path(smooth), 2);
    }

    #[test]
    fn a_repeating_path_goes_on() {
        let points = vec![
            Waypoint::new(0.0, [0.0; 3]),
            Waypoint::new(0.5, [0.01, 0.02, 0.0]),
            Waypoint {
                hold_s: 0.25,
                ..Waypoint::new(1.0, [0.0; 3])
            },
        ];
        let path = path(points, true).unwrap();
        assert!(
            v3::norm(v3::sub(
                path.goal(0.3).position,
                path.goal(0.3 + 1.25 * 4.0).position
            )) < 1e-12
        );
        check_smooth(&Motion::Path(path), 6);
    }

    #[test]
    fn what_cannot_be_gone_is_told_with_its_place() {
        let entry = |error: MotionError| match error {
            MotionError::Entry { index, field, .. } => (index, field),
            other => panic!("{other}"),
        };
        let at = Waypoint::new;
        assert!(matches!(path(vec![], false), Err(MotionError::Kind { .. })));
        let two = |b| path(vec![at(0.0, [0.0; 3]), b], false).unwrap_err();
        assert_eq!(entry(two(at(0.0, [0.0; 3]))), (2, "time_s"));
        assert_eq!(entry(two(at(f64::NAN, [0.0; 3]))), (2, "time_s"));
        assert_eq!(
            entry(two(at(1.0, [0.0, f64::INFINITY, 0.0]))),
            (2, "position")
        );
        assert_eq!(
            entry(two(Waypoint {
                hold_s: -1.0,
                ..at(1.0, [0.0; 3])
            })),
            (2, "hold_s")
        );
        assert_eq!(
            entry(two(Waypoint {
                grip: f64::NAN,
                ..at(1.0, [0.0; 3])
            })),
            (2, "grip")
        );
        assert_eq!(
            entry(two(Waypoint {
                orientation: Some([0.0; 4]),
                ..at(1.0, [0.0; 3])
            })),
            (2, "orientation")
        );
        let open = path(vec![at(0.0, [0.0; 3]), at(1.0, [0.1, 0.0, 0.0])], true).unwrap_err();
        assert!(open.to_string().contains("first place again"), "{open}");
        assert_eq!(entry(open), (2, "position"));
    }
}
