//! One motion after another, as in a session of work; and motion files.
//!
//! ```toml
//! repeat = true
//!
//! [[step]]
//! motion = "press"     # press, slide, tap, circle, pull, tremor, hold
//! for_s = 4.0
//! depth_m = 0.003      # past the first touch; what the caller says if left out
//! grip = 1.5           # times the hand's; 1 if left out
//! ```
//! or
//! ```toml
//! interpolation = "smooth"   # or "linear"
//!
//! [[waypoint]]
//! time_s = 0.0
//! position = [0.05, 0.0, 0.045]
//! ```

use super::hand::Goal;
use super::motion::{Kind, Motion, passing};
use super::motion_error::MotionError;
use super::path::{Interpolation, Path, Waypoint};
use super::smooth::Flow;
use super::target::Target;
use palpate_proto::messages::SceneSnapshot;
use palpate_proto::text::located;
use serde::Deserialize;

/// From one step to the next the hand goes over in this time, s.
pub const BLEND_S: f64 = 0.4;

/// A step of a session.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Kind of motion.
    pub kind: Kind,
    /// How long, s; longer than [`BLEND_S`].
    pub for_s: f64,
    /// Past the first touch, m.
    pub depth_m: f64,
    /// Times the hand's grip.
    pub grip: f64,
}

/// A checked session. Its last step goes on for ever, unless it repeats.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    target: Target,
    steps: Vec<Step>,
    repeat: bool,
}

impl Session {
    /// Checks steps. `origin` names them in errors.
    ///
    /// # Errors
    /// None, or a step that cannot be done.
    pub fn new(
        target: Target,
        steps: Vec<Step>,
        repeat: bool,
        origin: &str,
    ) -> Result<Self, MotionError> {
        if steps.is_empty() {
            return Err(MotionError::Kind {
                origin: origin.to_owned(),
            });
        }
        for (k, step) in steps.iter().enumerate() {
            let check = |field, value: f64, good: bool, expected| match good {
                true => Ok(()),
                false => {
                    let (origin, entry, index) = (origin.to_owned(), "step", k + 1);
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
            let long = step.for_s.is_finite() && step.for_s > BLEND_S;
            check(
                "for_s",
                step.for_s,
                long,
                "a finite time above 0.4 s, in which one step goes over into the next",
            )?;
            check(
                "depth_m",
                step.depth_m,
                step.depth_m.abs() <= 1.0,
                "a depth of at most 1 m",
            )?;
            check(
                "grip",
                step.grip,
                (0.0..=100.0).contains(&step.grip),
                "a factor from 0 to 100",
            )?;
        }
        Ok(Self {
            target,
            steps,
            repeat,
        })
    }

    /// The step at a time, the time within it, and the step before.
    fn at(&self, t: f64) -> (&Step, f64, Option<&Step>) {
        let length: f64 = self.steps.iter().map(|step| step.for_s).sum();
        let (mut left, again) = if self.repeat && t >= length {
            (t.rem_euclid(length), true)
        } else {
            (t.max(0.0), false)
        };
        let last = self.steps.len() - 1;
        let mut before = if again { self.steps.last() } else { None };
        for (k, step) in self.steps.iter().enumerate() {
            if left < step.for_s || k == last {
                return (step, left, before);
            }
            left -= step.for_s;
            before = Some(step);
        }
        (&self.steps[last], left, before)
    }

    /// What the hand holds down.
    pub fn buttons(&self, t: f64) -> u32 {
        let (step, since, _) = self.at(t);
        step.kind.buttons(since)
    }

    /// Where the hand wants to be.
    pub fn goal(&self, t: f64) -> Goal {
        let (step, since, before) = self.at(t);
        let new = step
            .kind
            .place(&self.target, step.depth_m, Flow::time(since));
        let Some(before) = before.filter(|_| since < BLEND_S) else {
            return Goal {
                grip: step.grip,
                ..passing(new)
            };
        };
        // The step before goes on while it fades.
        let old = before.kind.place(
            &self.target,
            before.depth_m,
            Flow::time(before.for_s + since),
        );
        let share = Flow::time(since).ramp(0.0, BLEND_S);
        let place = [0, 1, 2].map(|c| old[c] + (new[c] - old[c]) * share);
        Goal {
            grip: before.grip + (step.grip - before.grip) * share.value,
            ..passing(place)
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MotionFile {
    interpolation: Option<Interpolation>,
    #[serde(default)]
    repeat: bool,
    #[serde(default)]
    waypoint: Vec<Waypoint>,
    #[serde(default)]
    step: Vec<StepEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StepEntry {
    motion: Kind,
    for_s: f64,
    depth_m: Option<f64>,
    #[serde(default = "own")]
    grip: f64,
}

fn own() -> f64 {
    1.0
}

impl Motion {
    /// A motion from TOML text. `origin` names it in errors; steps are aimed as [`Motion::named`]
    /// are, and go `depth_m` deep unless they say how deep.
    ///
    /// # Errors
    /// Not such TOML, an entry that cannot be done, or a scene without a body to aim at.
    pub fn from_toml(
        text: &str,
        origin: &str,
        scene: &SceneSnapshot,
        tool: &str,
        depth_m: f64,
    ) -> Result<Self, MotionError> {
        let target = || Target::of(scene, tool).ok_or_else(|| MotionError::NoBody(tool.to_owned()));
        parse(text, origin, target, depth_m)
    }
}

fn parse(
    text: &str,
    origin: &str,
    target: impl FnOnce() -> Result<Target, MotionError>,
    depth_m: f64,
) -> Result<Motion, MotionError> {
    let file: MotionFile = toml::from_str(text).map_err(|error| MotionError::Toml {
        origin: origin.to_owned(),
        reason: located(text, error.span(), error.message()),
    })?;
    match (file.waypoint.is_empty(), file.step.is_empty()) {
        (false, true) => Path::new(
            file.waypoint,
            file.interpolation.unwrap_or_default(),
            file.repeat,
            origin,
        )
        .map(Motion::Path),
        (true, false) if file.interpolation.is_none() => {
            let step = |entry: StepEntry| Step {
                kind: entry.motion,
                for_s: entry.for_s,
                depth_m: entry.depth_m.unwrap_or(depth_m),
                grip: entry.grip,
            };
            let steps = file.step.into_iter().map(step).collect();
            Session::new(target()?, steps, file.repeat, origin).map(Motion::Session)
        }
        _ => Err(MotionError::Kind {
            origin: origin.to_owned(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::super::motion::tests::{TARGET, check_smooth};
    use super::*;

    fn read(text: &str) -> Result<Motion, MotionError> {
        parse(text, "m.toml", || Ok(TARGET), 0.004)
    }

    const SESSION: &str = "repeat = true\n[[step]]\nmotion = \"press\"\nfor_s = 2.2\ngrip = 2.0\n\
        [[step]]\nmotion = \"slide\"\nfor_s = 3.3\ndepth_m = 0.002\n[[step]]\nmotion = \"pull\"\nfor_s = 4.0\n\
        [[step]]\nmotion = \"tremor\"\nfor_s = 2.5\n[[step]]\nmotion = \"tap\"\nfor_s = 1.23\n";

    #[test]
    fn steps_go_over_into_each_other_smoothly_wherever_they_are_cut() {
        let session = read(SESSION).unwrap();
        check_smooth(&session, 40);
        assert_eq!((session.goal(1.0).grip, session.goal(3.0).grip), (2.0, 1.0));
        assert!((session.goal(2.4).grip - 1.5).abs() < 1e-12);
        // Two seconds into the pull, and so again in the second round of 13.23 s.
        assert_eq!(
            (
                session.buttons(7.5),
                session.buttons(7.5 + 13.23),
                session.buttons(2.0)
            ),
            (1, 1, 0)
        );
        let once = read(&SESSION.replace("true", "false")).unwrap();
        assert_eq!(once.goal(1.0), session.goal(1.0));
        check_smooth(&once, 20);
    }

    #[test]
    fn mistakes_are_told_with_their_place_and_what_would_do() {
        let told = |text: &str| read(text).unwrap_err().to_string();
        assert!(
            told("").contains("m.toml: a motion needs [[waypoint]] entries or [[step]] entries")
        );
        let both = format!("{SESSION}[[waypoint]]\ntime_s = 0\nposition = [0, 0, 0]\n");
        assert!(matches!(read(&both), Err(MotionError::Kind { .. })));
        let short = told("[[step]]\nmotion = \"tap\"\nfor_s = 0.1\n");
        assert!(
            short.contains("m.toml: step 1: for_s is 0.1; a finite time above 0.4 s"),
            "{short}"
        );
        let unknown = told("[[step]]\nmotion = \"poke\"\nfor_s = 1\n");
        assert!(
            unknown.contains("tremor") && unknown.contains("line 2"),
            "{unknown}"
        );
        let foreign = told("speed = 1\n");
        assert!(
            foreign.contains("line 1") && foreign.contains("expected"),
            "{foreign}"
        );
    }

    #[test]
    fn the_examples_are_motions() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/motions");
        let mut count = 0;
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let text = std::fs::read_to_string(&path).unwrap();
            let motion = read(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            if !text.contains("linear") {
                check_smooth(&motion, 20);
            }
            count += 1;
        }
        assert!(count >= 3);
    }
}
