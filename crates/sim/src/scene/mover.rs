//! What moves a rigid body: a script, a tool that carries it, commands, or forces.

use super::door::{At, words_of_another};
use super::free::Free;
use super::spec::{BodySpec, InterpolationSpec, MotionSpec, SceneSpec};
use palpate_geometry::math::{Point3, Pose, Rotation, Vector3, rotation_by, turn_between};
use std::f64::consts::TAU;

/// Most way-points of a motion, and most shakes.
const MOST_ENTRIES: usize = 10_000;
/// Fastest that anything may move a body, m/s: of scripts a limit that is checked, of tools one that
/// holds them back.
pub(crate) const SPEED_MAX_M_S: f64 = 10.0;
/// The same for its rotation, rad/s.
pub(crate) const TURNING_MAX_RAD_S: f64 = 100.0;

/// A rigid body that moves.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mover {
    /// The body's frame at the start, where its surface at rest is; of a free body: its centre of mass
    /// and principal axes.
    pub placement: Pose,
    /// What moves it.
    pub by: MovedBy,
}

/// What moves a body when no command does.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum MovedBy {
    /// A motion of its own.
    Script(Script),
    /// The device of a tool, which starts at `start`.
    Tool { tool: usize, start: Pose },
    /// Contact and gravity.
    Forces(Box<Free>),
}

impl Mover {
    /// Contact moves it.
    pub fn gives_way(&self) -> bool {
        self.free().is_some()
    }

    /// The constants of a body that forces move.
    pub fn free(&self) -> Option<&Free> {
        match &self.by {
            MovedBy::Forces(free) => Some(free),
            MovedBy::Script(_) | MovedBy::Tool { .. } => None,
        }
    }
}

/// A motion, checked.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Script {
    places: Vec<Place>,
    shakes: Vec<Shake>,
    linear: bool,
    repeat: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    time_s: f64,
    hold_s: f64,
    position: Point3,
    rotation: Rotation,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Shake {
    way: Vector3, // amplitude along its direction, m
    frequency_hz: f64,
    from_s: f64,
    to_s: f64,
}

/// Reads `motion` and `carried_by` of a body. The outer `None` is a problem.
pub(super) fn build(
    scene: &SceneSpec,
    spec: &BodySpec,
    placement: &Pose,
    at: &At<'_>,
) -> Option<Option<Mover>> {
    let key = match (&spec.motion, &spec.carried_by) {
        (None, None) => return Some(None),
        (Some(_), Some(_)) => {
            return at
                .key("carried_by")
                .refused("a body has either a motion or a tool that carries it; drop one of them");
        }
        (Some(_), None) => "motion",
        (None, Some(_)) => "carried_by",
    };
    if spec.model().model().deforms() {
        return at.key(key).refused(format!(
            "only rigid bodies are moved so; let {:?} lie on a rigid body that moves, or use model = \"rigid\"",
            spec.id
        ));
    }
    let by = match (&spec.motion, &spec.carried_by) {
        (Some(motion), _) => MovedBy::Script(script(motion, placement, &at.key("motion"))?),
        (None, Some(id)) => carried(scene, id, &at.key("carried_by"))?,
        (None, None) => return Some(None),
    };
    Some(Some(Mover {
        placement: *placement,
        by,
    }))
}

fn carried(scene: &SceneSpec, id: &str, at: &At<'_>) -> Option<MovedBy> {
    let Some(tool) = scene.tools.iter().position(|tool| tool.id == id) else {
        let known: Vec<&str> = scene.tools.iter().map(|tool| tool.id.as_str()).collect();
        return at.refused(format!(
            "there is no tool {id:?} in this scene; its tools are {known:?}"
        ));
    };
    if scene.gravity.frame.as_deref() == Some(id) {
        return at.refused(format!(
            "{id:?} carries all bodies already (gravity.frame); drop one of the two"
        ));
    }
    let pose = &scene.tools[tool].pose;
    let start = at.attempt(|| at.pose(&pose.position, &pose.orientation));
    // A pose that is no pose is a problem of the tool's.
    let start = start.unwrap_or_else(Pose::identity);
    Some(MovedBy::Tool { tool, start })
}

/// Replaces a motion's file by what is in it; `at` is the motion's table.
pub(super) fn inline_file(motion: &mut MotionSpec, at: &At<'_>) -> Option<()> {
    if let Some(read) = from_file(motion, at)? {
        *motion = read;
    }
    Some(())
}

/// What the file of a motion says; `Some(None)` without one.
fn from_file(motion: &MotionSpec, at: &At<'_>) -> Option<Option<MotionSpec>> {
    let Some(file) = &motion.file else {
        return Some(None);
    };
    let alone = MotionSpec {
        file: Some(file.clone()),
        ..MotionSpec::default()
    };
    if *motion != alone {
        return at.refused("a motion is either a file or way-points and shakes in place, not both");
    }
    let bytes = at.read_file("file", file)?;
    let named = |e: &dyn std::fmt::Display| format!("{}: {e}", at.name_of(file));
    let text = std::str::from_utf8(&bytes).map_err(|e| named(&e));
    let read = text.and_then(|text| {
        let read = toml::from_str::<MotionSpec>(text);
        read.map_err(|error| named(&words_of_another(text, &error)))
    });
    let read = at.key("file").take(read)?;
    if read.file.is_some() {
        return at.key("file").refused(format!(
            "{}: a motion's file names no other file",
            at.name_of(file)
        ));
    }
    Some(Some(read))
}

fn script(motion: &MotionSpec, placement: &Pose, at: &At<'_>) -> Option<Script> {
    let read = from_file(motion, at)?;
    let motion = read.as_ref().unwrap_or(motion);
    let before = at.problem_count();
    for (key, count) in [
        ("waypoint", motion.waypoints.len()),
        ("shake", motion.shakes.len()),
    ] {
        if count > MOST_ENTRIES {
            return at.key(key).refused(format!(
                "{count} entries; a motion has at most {MOST_ENTRIES}"
            ));
        }
    }
    let linear = motion.interpolation == Some(InterpolationSpec::Linear);
    let mut places: Vec<Place> = Vec::with_capacity(motion.waypoints.len());
    for (k, point) in motion.waypoints.iter().enumerate() {
        let at = at.key("waypoint").entry(k);
        at.not_below_zero("time_s", point.time_s, "s");
        at.not_below_zero("hold_s", point.hold_s, "s");
        let kept = places
            .last()
            .map_or(placement.rotation, |last| last.rotation);
        let orientation = point
            .orientation
            .unwrap_or([kept.i, kept.j, kept.k, kept.w]);
        let Some(pose) = at.pose(&point.position, &orientation) else {
            continue;
        };
        let place = Place {
            time_s: point.time_s,
            hold_s: point.hold_s,
            position: Point3::from(pose.translation.vector),
            rotation: pose.rotation,
        };
        if let Some(last) = places.last() {
            check_way(last, &place, linear, &at);
        }
        places.push(place);
    }
    let shakes = motion.shakes.iter().enumerate();
    let shakes: Vec<Option<Shake>> = shakes
        .map(|(k, shake)| {
            let at = at.key("shake").entry(k);
            let direction = at.direction("direction", &shake.direction);
            let amplitude_m = at.not_below_zero("amplitude_m", shake.amplitude_m, "m");
            let frequency_hz = at.above_zero("frequency_hz", shake.frequency_hz, "Hz");
            let from_s = at.not_below_zero("from_s", shake.from_s, "s");
            let to_s = shake.to_s.map(|to_s| at.not_below_zero("to_s", to_s, "s"));
            let (amplitude_m, frequency_hz) = (amplitude_m?, frequency_hz?);
            let speed = TAU * frequency_hz * amplitude_m;
            if speed > SPEED_MAX_M_S {
                return at.key("amplitude_m").refused(format!(
                    "the shake reaches {speed:.3} m/s; at most {SPEED_MAX_M_S} m/s are moved"
                ));
            }
            Some(Shake {
                way: direction? * amplitude_m,
                frequency_hz,
                from_s: from_s?,
                to_s: to_s.unwrap_or(Some(f64::INFINITY))?,
            })
        })
        .collect();
    if motion.repeat && motion.waypoints.is_empty() {
        at.key("repeat")
            .refuse("repeat needs way-points; a shake goes on by itself");
    }
    if let (true, Some(first), Some(last)) = (motion.repeat, places.first(), places.last()) {
        let gap = (last.position - first.position).norm()
            + turn_between(&first.rotation, &last.rotation).norm();
        if gap > 1e-9 || last.time_s + last.hold_s <= 0.0 {
            at.key("repeat")
                .refuse("a motion that repeats ends where it began, at a time above 0");
        }
    }
    if at.problem_count() > before {
        return None;
    }
    Some(Script {
        places,
        shakes: shakes.into_iter().collect::<Option<_>>()?,
        linear,
        repeat: motion.repeat,
    })
}

/// The way between two way-points takes time, and no more than [`SPEED_MAX_M_S`].
fn check_way(from: &Place, to: &Place, linear: bool, at: &At<'_>) {
    let start_s = from.time_s + from.hold_s;
    // Also when one of them is no number.
    let takes_s = to.time_s - start_s;
    if takes_s.is_nan() || takes_s <= 0.0 {
        return at.key("time_s").refuse(format!(
            "time_s is {}; it must be after the way-point before and its hold_s, {start_s} s",
            to.time_s
        ));
    }
    // The smooth way is 15/8 as fast in its middle.
    let peak = if linear { 1.0 } else { 1.875 };
    let speed = peak * (to.position - from.position).norm() / takes_s;
    let turning = peak * turn_between(&from.rotation, &to.rotation).norm() / takes_s;
    if speed > SPEED_MAX_M_S || turning > TURNING_MAX_RAD_S {
        at.key("time_s").refuse(format!(
            "the way there reaches {speed:.1} m/s and {turning:.1} rad/s; at most {SPEED_MAX_M_S} m/s and {TURNING_MAX_RAD_S} rad/s are moved: give it more time"
        ));
    }
}

impl Script {
    /// Where the body's frame is at a time, s; `placement` without way-points.
    pub fn place(&self, placement: &Pose, time_s: f64) -> (Point3, Rotation) {
        let (mut position, rotation) = self.way(placement, time_s);
        for shake in &self.shakes {
            position += shake.at(time_s);
        }
        (position, rotation)
    }

    fn way(&self, placement: &Pose, time_s: f64) -> (Point3, Rotation) {
        let Some(last) = self.places.last() else {
            return (
                Point3::from(placement.translation.vector),
                placement.rotation,
            );
        };
        let length_s = last.time_s + last.hold_s;
        let t = match self.repeat {
            true => time_s - libm::floor(time_s / length_s) * length_s,
            false => time_s,
        };
        let k = self.places.partition_point(|place| place.time_s <= t);
        let Some(to) = self.places.get(k) else {
            return (last.position, last.rotation);
        };
        let Some(from) = k.checked_sub(1).map(|k| &self.places[k]) else {
            return (to.position, to.rotation);
        };
        let start_s = from.time_s + from.hold_s;
        if t <= start_s {
            return (from.position, from.rotation);
        }
        let s = (t - start_s) / (to.time_s - start_s);
        let share = if self.linear { s } else { smooth(s) };
        between(
            (&from.position, &from.rotation),
            (&to.position, &to.rotation),
            share,
        )
    }
}

impl Shake {
    fn at(&self, time_s: f64) -> Vector3 {
        let since_s = time_s - self.from_s;
        if since_s <= 0.0 || time_s >= self.to_s {
            return Vector3::zeros();
        }
        let swell = smooth((since_s * self.frequency_hz).min(1.0));
        let fade = smooth(((self.to_s - time_s) * self.frequency_hz).min(1.0));
        self.way * (libm::sin(TAU * self.frequency_hz * since_s) * swell * fade)
    }
}

/// From 0 to 1 with the least jerk.
pub(crate) fn smooth(s: f64) -> f64 {
    debug_assert!((0.0..=1.0).contains(&s), "a share of the way");
    s * s * s * (10.0 + s * (6.0 * s - 15.0))
}

/// A share of the way from one placement to another.
pub(crate) fn between(
    from: (&Point3, &Rotation),
    to: (&Point3, &Rotation),
    share: f64,
) -> (Point3, Rotation) {
    let turn = turn_between(from.1, to.1);
    let position = from.0 + (to.0 - from.0) * share;
    (position, rotation_by(&(turn * share)) * from.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::file;
    use std::path::Path;
    use std::sync::Arc;

    fn bowl(motion: &str) -> String {
        format!(
            "[[body]]\nid = \"bowl\"\nsurface = {{ builtin = \"sheet\" }}\npose = {{ position = [0.1, 0.0, 0.0] }}\n{motion}\n[[tool]]\nid = \"hand\"\n"
        )
    }

    fn mover(motion: &str) -> Result<Mover, String> {
        let loaded =
            file::parse(&bowl(motion), "m.toml", Path::new(".")).map_err(|e| e.to_string())?;
        let mut scene = loaded.build().map_err(|e| e.to_string())?;
        let body = Arc::get_mut(&mut scene.bodies[0]).ok_or("it is shared")?;
        body.mover.take().ok_or("it does not move".into())
    }

    #[test]
    fn a_script_passes_its_places_and_shakes_about_them() {
        let text = "motion = { waypoint = [ { time_s = 1.0, position = [0.1, 0.0, 0.0], hold_s = 0.5 }, \
                    { time_s = 2.5, position = [0.1, 0.0, 0.2], orientation = [0.0, 0.7071067811865476, 0.0, 0.7071067811865476] } ], \
                    shake = [ { direction = [0.0, 2.0, 0.0], amplitude_m = 0.01, frequency_hz = 2.0, from_s = 3.0, to_s = 6.0 } ] }";
        let Mover { placement, by } = mover(text).unwrap();
        let MovedBy::Script(script) = by else {
            panic!()
        };
        let at = |t: f64| script.place(&placement, t);
        for t in [0.0, 1.0, 1.4] {
            assert_eq!(
                at(t),
                (Point3::new(0.1, 0.0, 0.0), Rotation::identity()),
                "{t}"
            );
        }
        let (middle, turned) = at(2.0);
        assert!((middle.z - 0.1).abs() < 1e-15 && (turned.angle() - TAU / 8.0).abs() < 1e-12);
        assert!((at(2.9).0.z - 0.2).abs() < 1e-15);
        // A quarter of a period after the swell: full amplitude along y only.
        let (top, _) = at(3.625);
        assert!((top - Point3::new(0.1, 0.01, 0.2)).norm() < 1e-15, "{top}");
        assert_eq!(at(6.0).0.y, 0.0);
        // Smooth to a tick: no step is longer than the speed of the shake or of the way says.
        for k in 0..7_000 {
            let (a, b) = (at(f64::from(k) * 1e-3).0, at(f64::from(k + 1) * 1e-3).0);
            assert!((b - a).norm() < 4e-4, "{k}: {}", (b - a).norm());
        }
    }

    #[test]
    fn what_cannot_be_moved_is_refused_with_its_place() {
        for (motion, reason) in [
            ("carried_by = \"foot\"", "no tool \"foot\""),
            ("carried_by = \"hand\"\nmotion = {}", "drop one of them"),
            (
                "carried_by = \"hand\"\nmodel = \"membrane\"",
                "only rigid bodies",
            ),
            ("motion = { file = \"none.toml\" }", "there is no file"),
            ("motion = { file = \"a\", repeat = true }", "not both"),
            ("motion = { repeat = true }", "repeat needs way-points"),
            (
                "motion = { waypoint = [ { time_s = 0.0, position = [0.0, 0.0, 0.0] }, { time_s = 0.0, position = [0.0, 0.0, 0.1] } ] }",
                "after the way-point before",
            ),
            (
                "motion = { waypoint = [ { time_s = 0.0, position = [0.0, 0.0, 0.0] }, { time_s = 0.001, position = [0.0, 0.0, 0.1] } ] }",
                "give it more time",
            ),
            (
                "motion = { waypoint = [ { time_s = nan, position = [0.0, 0.0, 0.0] } ] }",
                "time_s is NaN",
            ),
            (
                "motion = { shake = [ { direction = [0.0, 0.0, 0.0], amplitude_m = 1.0, frequency_hz = 1.0 } ] }",
                "no direction",
            ),
            (
                "motion = { shake = [ { direction = [1.0, 0.0, 0.0], amplitude_m = 1.0, frequency_hz = 10.0 } ] }",
                "at most 10 m/s",
            ),
            ("motion = { wayPoint = [] }", "did you mean \"waypoint\""),
        ] {
            let error = mover(motion).unwrap_err();
            assert!(error.contains(reason), "{motion}: {error}");
        }
        assert!(mover("motion = {}").is_ok() && mover("carried_by = \"hand\"").is_ok());
    }
}
