//! Hands that hold still, creep and turn: how much the force of a tool with edges and faces changes from tick to tick.
//!
//! Each tool comes down on each body until it touches and 2.8 mm further, in poses of which half are random and half lay a
//! face, edge or generator flush, tilted by nothing or by up to 0.3 rad. What is left after 50 ms is measured: the
//! largest step of force and torque in a tick, and how far the force is from stiffness times the way to the nearest free
//! place, which is searched with the tool as a cloud of points.

use super::Suite;
use crate::Row;
use crate::measure::Times;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::math::{Point3, Pose, Random, Rotation, Vector3, rotation_by};
use palpate_geometry::surface::{ClosestSolver, Surface};
use palpate_sim::World;
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::Scene;
use palpate_sim::solve::hold::{Barrier, hold};
use palpate_sim::tick::record::TickOutput;
use std::collections::BTreeSet;
use std::time::Instant;

const STIFFNESS_N_M: f64 = 1000.0;
/// How far the hand goes on from where it touches, m, and on its way there in a tick.
const DEEP_M: f64 = 2.8e-3;
const APPROACH_M: f64 = 2e-4;
const PRESS_M: f64 = 1e-4;
/// Where it begins, from the middle of the body or its surface, m.
const AWAY_M: f64 = 0.1;
/// Of a hand that creeps, in a tick: 20 mm/s.
const CREEP_M: f64 = 2e-5;
/// Ticks that it holds, and those of them that do not count.
const HELD: usize = 300;
const SETTLING: usize = 50;
/// Lengths that torques are compared by, m.
const ARM_M: f64 = 0.02;
const TILTS_RAD: [f64; 7] = [0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-2, 0.3];
/// A force below this is no touch, N.
const TOUCH_N: f64 = 1e-3;

/// Shape, half-turns of what lays it flush, as a rotation vector.
const TOOLS: [(&str, &str, [[f64; 3]; 2]); 11] = {
    const DOWN: [f64; 3] = [0.0; 3];
    const UP: [f64; 3] = [std::f64::consts::PI, 0.0, 0.0];
    const LYING: [f64; 3] = [0.0, std::f64::consts::FRAC_PI_2, 0.0];
    [
        (
            "cone 45°",
            "{ cone = { half_angle_rad = 0.785, height_m = 0.015 } }",
            [UP, [0.0, std::f64::consts::FRAC_PI_2 + 0.785, 0.0]],
        ),
        (
            "cone 17°",
            "{ cone = { half_angle_rad = 0.3, height_m = 0.015 } }",
            [UP, [0.0, std::f64::consts::FRAC_PI_2 + 0.3, 0.0]],
        ),
        (
            "cylinder",
            "{ cylinder = { radius_m = 0.009, half_length_m = 0.012 } }",
            [DOWN, LYING],
        ),
        (
            "disc",
            "{ cylinder = { radius_m = 0.015, half_length_m = 0.0015 } }",
            [DOWN, LYING],
        ),
        (
            "box",
            "{ box = { half_extents_m = [0.011, 0.008, 0.006] } }",
            [DOWN, LYING],
        ),
        (
            "plate",
            "{ box = { half_extents_m = [0.018, 0.016, 0.0012] } }",
            [DOWN, LYING],
        ),
        (
            "torus",
            "{ torus = { major_radius_m = 0.012, minor_radius_m = 0.004 } }",
            [DOWN, LYING],
        ),
        ("mesh", WEDGE, [DOWN, LYING]),
        (
            "implicit bar",
            "{ implicit = { f = \"max(x^2 + y^2 - 0.009^2, (abs(z) - 0.012) * 0.02)\", reach_m = 0.03 } }",
            [DOWN, LYING],
        ),
        (
            "implicit block",
            "{ implicit = { f = \"max(abs(x) - 0.011, abs(y) - 0.008, abs(z) - 0.006)\", reach_m = 0.03 } }",
            [DOWN, LYING],
        ),
        ("surface", PUCK, [DOWN, LYING]),
    ]
};
/// A wedge as a mesh.
const WEDGE: &str = "{ mesh = { inline = { vertices = [[-0.01, -0.008, -0.006], [0.01, -0.008, -0.006], [0.01, 0.008, -0.006], [-0.01, 0.008, -0.006], [-0.01, 0.0, 0.008], [0.01, 0.0, 0.008]], triangles = [[0, 2, 1], [0, 3, 2], [0, 1, 5], [0, 5, 4], [2, 3, 4], [2, 4, 5], [1, 2, 5], [0, 4, 3]] } } }";

/// A puck as a surface: around it cubic, from the middle of one face to that of the other straight, with creases.
const PUCK: &str = "{ surface = { inline = { format = \"palpate.surface.v1\", degree = [3, 1], periodic = [true, false], knots = [[0, 1, 2, 3, 4, 5, 6, 7, 8], [0, 0, 1, 2, 3, 3]], points = [[[0.0, 0.0, -0.006], [0.011081942, 0.0, -0.006], [0.011081942, 0.0, 0.006], [0.0, 0.0, 0.006]], [[0.0, 0.0, -0.006], [0.007836116, 0.007836116, -0.006], [0.007836116, 0.007836116, 0.006], [0.0, 0.0, 0.006]], [[0.0, 0.0, -0.006], [0.0, 0.011081942, -0.006], [0.0, 0.011081942, 0.006], [0.0, 0.0, 0.006]], [[0.0, 0.0, -0.006], [-0.007836116, 0.007836116, -0.006], [-0.007836116, 0.007836116, 0.006], [0.0, 0.0, 0.006]], [[0.0, 0.0, -0.006], [-0.011081942, 0.0, -0.006], [-0.011081942, 0.0, 0.006], [0.0, 0.0, 0.006]], [[0.0, 0.0, -0.006], [-0.007836116, -0.007836116, -0.006], [-0.007836116, -0.007836116, 0.006], [0.0, 0.0, 0.006]], [[0.0, 0.0, -0.006], [-0.0, -0.011081942, -0.006], [-0.0, -0.011081942, 0.006], [0.0, 0.0, 0.006]], [[0.0, 0.0, -0.006], [0.007836116, -0.007836116, -0.006], [0.007836116, -0.007836116, 0.006], [0.0, 0.0, 0.006]]] } } }";

/// A body, and where hands come to it.
struct Target {
    name: &'static str,
    text: String,
    soft: bool,
}

fn targets() -> Vec<Target> {
    let rigid = |name: &'static str, surface: &str| Target {
        name,
        text: format!("surface = {surface}\n"),
        soft: false,
    };
    let saddle = "{ inline = { format = \"palpate.surface.v1\", degree = [2, 2], knots = [[0, 0, 0, 1, 1, 1], [0, 0, 0, 1, 1, 1]], points = [[[-0.1, -0.1, 0.0], [-0.1, 0.0, 0.1], [-0.1, 0.1, 0.0]], [[0.0, -0.1, -0.1], [0.0, 0.0, 0.0], [0.0, 0.1, -0.1]], [[0.1, -0.1, 0.0], [0.1, 0.0, 0.1], [0.1, 0.1, 0.0]]] } }";
    let soft = "model = \"lattice\"\nlattice = { thickness_m = 0.03, layers = 3, refine = [14, 14] }\nmaterial = { young_pa = 20e3 }\nfixed = [{ point = [0.0, 0.0, -0.028], normal = [0.0, 0.0, 1.0] }]\n";
    vec![
        rigid("sheet", "{ builtin = \"sheet\", size = 0.3 }"),
        rigid("sphere", "{ builtin = \"sphere\", size = 0.03 }"),
        rigid("teardrop", "{ builtin = \"teardrop\" }"),
        rigid("torus", "{ builtin = \"torus\", size = 0.03 }"),
        rigid("saddle", saddle),
        Target {
            name: "soft sheet",
            text: format!("surface = {{ builtin = \"sheet\", size = 0.1 }}\n{soft}"),
            soft: true,
        },
    ]
}

/// How a hand comes to a body.
#[derive(Clone, Copy, Debug)]
struct Approach {
    /// Where on or in the body it goes to, m.
    base: Point3,
    /// Unit vector from there to where it comes from.
    from: Vector3,
    turn: Rotation,
}

impl Approach {
    fn of(random: &mut Random, target: &Target, flush: &[[f64; 3]; 2], k: usize) -> Self {
        let mut normal = || (0..12).map(|_| random.unit()).sum::<f64>() - 6.0;
        let mut from = Vector3::new(normal(), normal(), normal());
        let turn = if k.is_multiple_of(2) {
            rotation_by(&(Vector3::new(normal(), normal(), normal())))
        } else {
            let angle = std::f64::consts::TAU * random.unit();
            let tilt = TILTS_RAD[k / 2 % TILTS_RAD.len()];
            let about = Vector3::new(angle.cos(), angle.sin(), 0.0);
            rotation_by(&(about * tilt))
                * rotation_by(&Vector3::from(flush[k / 2 / TILTS_RAD.len() % 2]))
        };
        let angle = std::f64::consts::TAU * random.unit();
        let base = match target.name {
            "sphere" => Point3::origin(),
            "torus" => {
                from = Vector3::new(
                    angle.cos() * from.x.abs(),
                    angle.sin() * from.x.abs(),
                    from.z,
                );
                Point3::new(0.03 * angle.cos(), 0.03 * angle.sin(), 0.0)
            }
            "teardrop" => {
                from.z *= 0.3;
                Point3::new(0.0, 0.0, 0.045)
            }
            _ => {
                from = Vector3::z();
                let room_m = if target.soft { 0.03 } else { 0.08 };
                let mut aside = || room_m * (random.unit() - 0.5);
                Point3::new(aside(), aside(), 0.0)
            }
        };
        Self {
            base,
            from: from.normalize(),
            turn,
        }
    }

    fn at(&self, height_m: f64) -> Pose {
        Pose::from_parts((self.base + self.from * height_m).coords.into(), self.turn)
    }
}

/// A scene of one tool and one body.
fn hand(target: &Target, shape: &str, start: &Pose) -> World {
    let (p, q) = (start.translation.vector, start.rotation);
    crate::world(&format!(
        "[[body]]\nid = \"b\"\n{}[[tool]]\nid = \"t\"\nshape = {shape}\npose = {{ position = [{:?}, {:?}, {:?}], orientation = [{:?}, {:?}, {:?}, {:?}] }}\ncoupling = {{ stiffness_n_m = {STIFFNESS_N_M:?} }}\ndevice = {{ ramp_s = 0.0, speed_max_m_s = 1e6, force_max_n = 100.0 }}\n",
        target.text, p.x, p.y, p.z, q.i, q.j, q.k, q.w
    ))
}

/// One tick with the hand there.
fn hold_at(hand: &mut World, pose: &Pose) -> TickOutput {
    hand.posed(DevicePose {
        orientation: pose.rotation,
        ..DevicePose::at_rest(pose.translation.vector.into())
    })
}

/// What the hand does when it is there.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Motion {
    Holds,
    /// Along the body, at 20 mm/s.
    Creeps,
    /// Through flush, at 0.1 rad/s.
    Turns,
}

impl Motion {
    fn name(self) -> &'static str {
        match self {
            Self::Holds => "held",
            Self::Creeps => "creeping",
            Self::Turns => "turning",
        }
    }

    /// What the force of a hand that moves changes by in a tick even where nothing jumps, N: stiffness times the way.
    fn least_step_n(self) -> f64 {
        match self {
            Self::Holds => 0.0,
            Self::Creeps => STIFFNESS_N_M * CREEP_M,
            Self::Turns => 5e-3,
        }
    }

    /// The pose after some ticks.
    fn go(self, approach: &Approach, height_m: f64, ticks: usize) -> Pose {
        let pose = approach.at(height_m);
        let k = ticks as f64;
        let aside = approach
            .from
            .cross(&Vector3::new(0.3, 0.5, 0.8))
            .normalize();
        match self {
            Self::Holds => pose,
            Self::Creeps => Pose::from_parts(
                (pose.translation.vector + aside * (CREEP_M * k)).into(),
                pose.rotation,
            ),
            Self::Turns => {
                let turn = rotation_by(&(aside * (1e-4 * (k - 0.5 * HELD as f64))));
                Pose::from_parts(pose.translation, turn * pose.rotation)
            }
        }
    }
}

/// What was seen of one pose.
struct Seen {
    /// Largest step of the force in a tick, of the force; beyond [`Motion::least_step_n`].
    force_step: f64,
    /// Of the torque, of force × 20 mm.
    torque_step: f64,
    times_s: Vec<f64>,
    /// Where the hand and the proxy were in the end, m.
    hand: Point3,
    proxy: Point3,
    force_n: f64,
    turn: Rotation,
}

/// Lets a hand touch, go deep and do its motion. None where it misses the body.
fn watch(target: &Target, shape: &str, approach: &Approach, motion: Motion) -> Option<Seen> {
    let mut hand = hand(target, shape, &approach.at(AWAY_M));
    let mut height_m = AWAY_M;
    while hold_at(&mut hand, &motion.go(approach, height_m, 0)).tools[0]
        .contact_force_n
        .norm()
        < TOUCH_N
    {
        height_m -= APPROACH_M;
        if height_m < -AWAY_M {
            return None;
        }
    }
    let deepest_m = height_m - DEEP_M;
    while height_m > deepest_m {
        height_m -= PRESS_M;
        hold_at(&mut hand, &motion.go(approach, height_m, 0));
    }
    let free_n = motion.least_step_n();
    let mut last: Option<(Vector3, Vector3)> = None;
    let (mut force_step, mut torque_step, mut times_s) = (0.0_f64, 0.0_f64, Vec::new());
    let mut seen = None;
    for k in 0..HELD {
        let pose = motion.go(approach, height_m, k);
        let start = Instant::now();
        let output = hold_at(&mut hand, &pose);
        let took_s = start.elapsed().as_secs_f64();
        if k < SETTLING {
            continue;
        }
        times_s.push(took_s);
        let tool = &output.tools[0];
        let (force, torque) = (tool.contact_force_n, tool.contact_torque_nm);
        let force_n = force.norm();
        if let Some((before, torque_before)) = last {
            let step_n = ((force - before).norm() - free_n).max(0.0);
            let step_nm = ((torque - torque_before).norm() - free_n * ARM_M).max(0.0);
            if force_n > TOUCH_N {
                force_step = force_step.max(step_n / force_n);
                torque_step = torque_step.max(step_nm / (force_n * ARM_M));
            }
        }
        last = Some((force, torque));
        seen = Some((
            Point3::from(pose.translation.vector),
            tool.proxy_position,
            force_n,
        ));
    }
    let (hand, proxy, force_n) = seen?;
    Some(Seen {
        force_step,
        torque_step,
        times_s,
        hand,
        proxy,
        force_n,
        turn: approach.turn,
    })
}

/// The tool as points of its surface, half a millimetre apart and closer, in its frame.
fn cloud(scene: &Scene) -> Vec<Point3> {
    const APART_M: f64 = 5e-4;
    /// Points nearer than this are one, m.
    const SAME_M: f64 = 5e-6;
    let outline = scene.tool_outline(0, 1.0);
    let mut points = Vec::new();
    for &[a, b, c] in &outline.triangles {
        let [a, b, c] = [a, b, c].map(|k| outline.points[k as usize]);
        let longest_m = (b - a).norm().max((c - a).norm()).max((c - b).norm());
        let n = (longest_m / APART_M).ceil().max(1.0) as usize;
        for i in 0..=n {
            for j in 0..=n - i {
                points.push(a + (b - a) * (i as f64 / n as f64) + (c - a) * (j as f64 / n as f64));
            }
        }
    }
    // The outline has chords where the tool is round.
    if let ToolShape::Implicit { tool, .. } = scene.tool_shape(0) {
        for point in &mut points {
            if let Some((gap_m, inwards)) = tool.signed_gap(&Pose::identity(), point) {
                *point += inwards * gap_m;
            }
        }
    }
    // Nor has it edges, where it was made from a function.
    if let Some(features) = scene.tool_shape(0).features() {
        points.extend(&features.corners);
        for edge in &features.edges {
            let n = (edge.length_m() / (0.25 * APART_M)).ceil();
            points.extend((0..n as u32).map(|k| edge.at(f64::from(k) / n).0));
        }
    }
    let mut seen = BTreeSet::new();
    points.retain(|p| seen.insert(p.coords.map(|x| (x / SAME_M).round() as i64).data.0));
    points
}

/// The way from a hand to the nearest free place of the tool in the neighbourhood of where it stands, m.
fn way_out(points: &[Point3], surface: &Surface, seen: &Seen) -> Option<f64> {
    const ROUNDS: usize = 12;
    /// Points farther away do not matter, m.
    const NEAR_M: f64 = 1.5e-3;
    let mut solver = ClosestSolver::new(surface);
    let closed = surface.topology().is_closed();
    let turned: Vec<Vector3> = points.iter().map(|p| seen.turn * p.coords).collect();
    let (mut place, mut way_m) = (seen.proxy, None);
    // How far the tool may go until each point is near, m.
    let mut clear_m = vec![0.0; turned.len()];
    let mut went_m = 0.0;
    for _ in 0..ROUNDS {
        let mut barriers: Vec<Barrier> = Vec::new();
        for (offset, clear_m) in turned.iter().zip(&mut clear_m) {
            *clear_m -= went_m;
            if *clear_m > 0.0 {
                continue;
            }
            let p = place + offset;
            let foot = solver.closest(surface, &p);
            *clear_m = foot.distance - NEAR_M;
            let beside =
                !closed && (p - foot.point - foot.normal * foot.signed_distance).norm() > 1e-9;
            if foot.signed_distance.abs() < NEAR_M && !beside {
                // Where the hand would have the point, by the plane below where it is.
                let depth_m = -(foot.signed_distance + foot.normal.dot(&(seen.hand - place)));
                barriers.push(Barrier {
                    normal: foot.normal,
                    depth_m,
                    part_m: 0.0,
                });
            }
        }
        if !hold(&mut barriers) {
            return None;
        }
        let way: Vector3 = barriers.iter().map(|b| b.normal * b.part_m).sum();
        went_m = (seen.hand + way - place).norm();
        place = seen.hand + way;
        way_m = Some(way.norm());
    }
    way_m
}

/// What a bar says of many poses.
#[derive(Default)]
struct Verdict {
    poses: usize,
    bad: usize,
    force_step: f64,
    torque_step: f64,
    /// Largest distance of the force from what the way out says, of itself.
    off: f64,
    times_s: Vec<f64>,
}

impl Suite<'_> {
    pub(super) fn still(&mut self, wanted: &dyn Fn(&str) -> bool) {
        let poses = self.count(200).max(4);
        for motion in [Motion::Holds, Motion::Creeps, Motion::Turns] {
            for target in targets() {
                for (tool, shape, flush) in &TOOLS {
                    let case = format!("still/{}/{}/{tool}", motion.name(), target.name);
                    if wanted(&case) {
                        let verdict = survey(&target, shape, flush, motion, poses);
                        (self.out)(row(&case, verdict));
                    }
                }
            }
        }
    }
}

fn survey(
    target: &Target,
    shape: &str,
    flush: &[[f64; 3]; 2],
    motion: Motion,
    poses: usize,
) -> Verdict {
    // Poses whose force is compared: a cloud takes long.
    const COMPARED: usize = 3;
    let mut random = Random(7411);
    let mut verdict = Verdict::default();
    let (force_bar, torque_bar) = match motion {
        Motion::Holds => (0.005, 0.01),
        Motion::Creeps | Motion::Turns => (0.02, 0.02),
    };
    let scene = hand(target, shape, &Pose::identity()).scene;
    let points = cloud(&scene);
    for k in 0..poses {
        let approach = Approach::of(&mut random, target, flush, k);
        let Some(seen) = watch(target, shape, &approach, motion) else {
            continue;
        };
        verdict.poses += 1;
        let mut bad = seen.force_step > force_bar || seen.torque_step > torque_bar;
        if motion == Motion::Holds && !target.soft && verdict.poses <= COMPARED {
            let expected_n = way_out(&points, scene.rest_surface(0).expect("a surface"), &seen)
                .map(|way_m| STIFFNESS_N_M * way_m);
            if let Some(expected_n) = expected_n {
                let off = (seen.force_n - expected_n).abs() / expected_n;
                verdict.off = verdict.off.max(off);
                bad |= off > 0.01;
            }
        }
        verdict.bad += usize::from(bad);
        verdict.force_step = verdict.force_step.max(seen.force_step);
        verdict.torque_step = verdict.torque_step.max(seen.torque_step);
        verdict.times_s.extend(seen.times_s);
    }
    verdict
}

fn row(case: &str, verdict: Verdict) -> Row {
    let note = format!(
        "{} of {} bad; torque {:.1e} of force × 20 mm; force off by {:.1e}",
        verdict.bad, verdict.poses, verdict.torque_step, verdict.off
    );
    Row {
        wrong: Some(verdict.bad),
        ..Row::new("contact", case, "step of the force")
            .timed(Times::of(verdict.times_s))
            .off_by(verdict.force_step, "of the force")
            .saying(note)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn none_is_bad(motion: Motion, poses: usize, bodies: &[&str]) {
        let mut found = Vec::new();
        for target in targets().iter().filter(|t| bodies.contains(&t.name)) {
            for (tool, shape, flush) in &TOOLS {
                let verdict = survey(target, shape, flush, motion, poses);
                assert!(verdict.poses > 0, "{} misses {}", tool, target.name);
                if verdict.bad > 0 {
                    let case = format!("{}/{tool}", target.name);
                    found.push(row(&case, verdict).note + " " + &case);
                }
            }
        }
        assert!(found.is_empty(), "{found:#?}");
    }

    const RIGID: [&str; 5] = ["sheet", "sphere", "saddle", "teardrop", "torus"];

    #[test]
    fn a_hand_that_holds_still_feels_a_force_that_does() {
        none_is_bad(Motion::Holds, 2, &RIGID);
    }

    #[test]
    fn a_hand_that_creeps_feels_no_jump() {
        none_is_bad(Motion::Creeps, 2, &RIGID);
    }

    // Not on a ring: its highest circle is level, and a flat that turns through flush touches it all around within a tick.
    #[test]
    fn a_hand_that_turns_through_flush_feels_no_jump() {
        none_is_bad(Motion::Turns, 2, &RIGID[..4]);
    }
}
