//! Parts of STEP files as bodies: closed forms, continuity over edges, replay.

use crate::common::{Laws as _, World, pose, step_file};
use palpate_geometry::math::{Point3, Random, SavedState, Vector3, state_hash};
use palpate_geometry::skin::SkinSolver;
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::restore;
use std::path::Path;

const STIFFNESS_N_M: f64 = 500.0;
const RADIUS_M: f64 = 0.003;

/// A part, and a ball that starts outside it.
fn scene(name: &str, start: [f64; 3], more: &str) -> String {
    format!(
        "[[body]]\nid = \"part\"\nsurface = {{ inline = {{ step = '''\n{}''' }} }}\n{more}\n\
         [[tool]]\nid = \"ball\"\nshape = {{ sphere = {{ radius_m = {RADIUS_M} }} }}\n\
         pose = {{ position = {start:?} }}\n\
         coupling = {{ stiffness_n_m = {STIFFNESS_N_M}, damping_n_s_m = 0.0 }}\n\
         device = {{ force_max_n = 500.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }}\n",
        step_file(name)
    )
}

/// Signed distance to a box of 60 × 40 × 20 mm with edges of 4 mm radius, one of whose corners would be the origin.
fn to_rounded_box(p: &Point3) -> f64 {
    let half = Vector3::new(0.026, 0.016, 0.006);
    let away = (p - Point3::new(0.03, 0.02, 0.01)).abs() - half;
    let outside = away.sup(&Vector3::zeros()).norm();
    outside + away.max().min(0.0) - 0.004
}

/// A smooth way around a box, m, at time `t`: near its faces, edges and corners in turn, at a depth below its sides.
fn way(t: f64, (low, high): (Point3, Point3), deep_m: f64) -> Point3 {
    let half = (high - low) * 0.5;
    let direction = Vector3::new(
        (1.3 * t).cos() * (0.7 * t).cos(),
        (1.3 * t).sin() * (0.7 * t).cos(),
        (0.7 * t).sin(),
    );
    let reach = (0..3)
        .map(|c| half[c] / direction[c].abs().max(1e-9))
        .fold(f64::INFINITY, f64::min);
    low + half + direction * (reach - deep_m)
}

// On a convex part the force is that of the distance: K (r − d) along the way to the closest point.
#[test]
fn a_ball_on_a_rounded_box_has_the_force_of_its_depth_over_faces_fillets_and_corners() {
    let mut world = World::new(&scene("filleted_box", [0.03, 0.02, 0.06], ""));
    let bounds = (Point3::origin(), Point3::new(0.06, 0.04, 0.02));
    let (mut touched, mut worst) = (0, 0.0_f64);
    for k in 0..12_000 {
        // From far above; then 1 mm deep, at up to 60 mm/s.
        let deep_m = if k < 200 {
            -0.03 + 1.5e-4 * k as f64
        } else {
            -0.0015
        };
        let at = way(1e-3 * k as f64, bounds, deep_m);
        let tool = world.at(at.into()).tools[0];
        let depth_m = RADIUS_M - to_rounded_box(&at);
        if depth_m > 0.0 && depth_m < RADIUS_M {
            touched += 1;
            let error = (tool.force_n.norm() - STIFFNESS_N_M * depth_m).abs();
            worst = worst.max(error / STIFFNESS_N_M);
            assert!(
                tool.contact.is_some(),
                "at {k}: depth {depth_m} without contact"
            );
        } else if depth_m < -1e-9 {
            assert_eq!(tool.force_n.norm(), 0.0, "at {k}: force at {depth_m} m");
        }
    }
    assert!(touched > 5_000, "{touched} touches");
    assert!(worst < 1e-9, "off by {worst} m");
}

// Over faces, edges, concave places and gaps of files a ball whose device stays outside of the part is never without
// contact while it is pressed, and its force changes no more than its way explains.
#[test]
fn forces_over_edges_are_continuous_and_never_vanish() {
    for name in [
        "shelled_box",
        "thread",
        "text_cut",
        "turned",
        "pipe",
        "loft",
        "saddle",
        "cone_tip",
    ] {
        let mut random = Random(7);
        let (mut touched, mut lost, mut worst) = (0, 0, 0.0_f64);
        for _ in 0..4 {
            let mut world = World::new(&scene(name, [0.0, 0.0, 0.5], ""));
            let (low, high) = world.scene.skin(0).part().expect("a part").part().bounds();
            let mut solver = SkinSolver::new(world.scene.skin(0));
            let phase = random.float(0.0, 20.0);
            let mut before: Option<(Point3, Vector3)> = None;
            for k in 0..2_000 {
                // Over the part from outside, then 1 mm into the ball, at 20 to 60 mm/s.
                let over = way(phase + 5e-4 * f64::from(k), (low, high), -0.004);
                let foot = solver.closest(world.scene.skin(0), &over);
                let away_m = if k < 200 {
                    0.004 - 1e-5 * f64::from(k)
                } else {
                    0.002
                };
                let at = foot.point + (over - foot.point) / foot.distance * away_m;
                let tool = world.at(at.into()).tools[0];
                let seen = solver.closest(world.scene.skin(0), &at);
                let pressed = seen.distance < RADIUS_M - 1e-7;
                touched += usize::from(pressed);
                lost += usize::from(pressed && tool.contact.is_none());
                // Where the path itself jumps, over a hollow, the force may.
                if let Some((place, force)) = before
                    && (at - place).norm() < 2e-4
                    && pressed
                {
                    let step_m = (tool.force_n - force).norm() / STIFFNESS_N_M;
                    worst = worst.max(step_m / ((at - place).norm() + 1e-6));
                }
                before = Some((at, tool.force_n));
            }
        }
        println!("{name}: {touched} touches, {lost} lost, steps up to {worst} of the way");
        assert_eq!(lost, 0, "{name}");
        // Where two faces of a hollow hold the ball, its proxy goes farther than the device: by 1/sin of half their angle.
        assert!(worst < 3.0, "{name}: a step of {worst} of the way's");
        assert!(touched > 4_000, "{name}: {touched} touches");
    }
}

// A part that comes up under a ball that is held still lifts its proxy, however deep the device comes to be.
#[test]
fn a_part_that_moves_lifts_a_ball() {
    let more = "motion = { waypoint = [ { time_s = 0.2, position = [0.0, 0.0, 0.0] }, { time_s = 0.7, position = [0.0, 0.0, 0.01] } ] }";
    let start = [0.03, 0.02, 0.026];
    let mut world = World::new(&scene("filleted_box", start, more));
    let mut tool = world.at(start).tools[0];
    for _ in 0..1_000 {
        tool = world.at(start).tools[0];
    }
    let expected_n = STIFFNESS_N_M * (0.030 + RADIUS_M - start[2]);
    assert!(
        (tool.force_n - Vector3::z() * expected_n).norm() < 1e-9,
        "{}",
        tool.force_n
    );
    assert!((tool.proxy_position.z - (0.030 + RADIUS_M)).abs() < 1e-12);
}

// What only a net can do is refused by name.
#[test]
fn parts_that_would_deform_are_refused_with_what_would_help() {
    for (more, words) in [
        ("model = \"continuum\"", "surface fit"),
        (
            "fixed = [{ point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }]",
            "no nodes",
        ),
    ] {
        let text = scene("filleted_box", [0.0, 0.0, 0.5], more);
        let built = file::parse(&text, "test.toml", Path::new("."))
            .and_then(|loaded| Scene::build(&loaded.spec, Path::new(".")));
        let error = built.err().map(|e| e.to_string()).unwrap_or_default();
        assert!(error.contains(words), "{more}: {error}");
    }
}

// A state taken in the middle of a slide goes on to the same bits.
#[test]
fn a_slide_over_a_part_replays_from_any_state() {
    let text = scene("thread", [0.0, 0.0, 0.5], "");
    let mut world = World::new(&text);
    let (low, high) = world.scene.skin(0).part().expect("a part").part().bounds();
    let at = |k: usize| {
        way(
            2.5e-4 * k as f64,
            (low, high),
            if k < 200 {
                5e-5 * k as f64 - 0.012
            } else {
                -0.002
            },
        )
    };
    let mut saved = SavedState::default();
    for k in 0..1_200 {
        if k == 700 {
            saved.save_from(&world.state);
        }
        world.at(at(k).into());
    }
    let end = state_hash(&world.state);
    let mut again = World::new(&text);
    again.seq = 700;
    restore(&again.scene, &mut again.state, &mut again.scratch, &saved)
        .expect("a state of the same scene");
    for k in 700..1_200 {
        again.at(at(k).into());
    }
    assert_eq!(state_hash(&again.state), end);
}

/// A part as a tool, over a rigid sheet at z = 0.
fn tool_over_sheet(name: &str, height_m: f64) -> String {
    format!(
        "[[body]]\nid = \"sheet\"\nsurface = {{ builtin = \"sheet\", size = 0.3 }}\n\
         [[tool]]\nid = \"part\"\nshape = {{ surface = {{ inline = {{ step = '''\n{}''' }} }} }}\n\
         pose = {{ position = [-0.03, -0.02, {height_m}] }}\n\
         coupling = {{ stiffness_n_m = {STIFFNESS_N_M}, damping_n_s_m = 0.0 }}\n\
         device = {{ force_max_n = 500.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }}\n",
        step_file(name)
    )
}

// Turned by any angle, a rounded box touches with its lowest point, which is no corner of its triangles.
#[test]
fn a_part_as_a_tool_presses_with_the_depth_of_its_lowest_point() {
    let mut random = Random(11);
    let mut worst = 0.0_f64;
    for _ in 0..6 {
        let turn = random.rotation();
        let mut world = World::new(&tool_over_sheet("filleted_box", 0.2));
        // The support of a rounded box downwards, from its origin.
        let down = turn.inverse_transform_vector(&-Vector3::z());
        let half = Vector3::new(0.026, 0.016, 0.006);
        let lowest_m = down.dot(&Vector3::new(0.03, 0.02, 0.01)) + half.dot(&down.abs()) + 0.004;
        let mut force_n = 0.0;
        for k in 0..400 {
            let height_m = lowest_m + 0.02 - 1e-4 * f64::from(k.min(220));
            let mut device = pose(0, [-0.03, -0.02, height_m]);
            device.orientation = turn;
            force_n = world.posed(device).tools[0].force_n.z;
        }
        worst = worst.max((force_n / STIFFNESS_N_M - 0.002).abs());
    }
    println!("off by {worst:e} m");
    assert!(worst < 1e-7, "off by {worst} m");
}

// A free part lies on a plane on its corners: it bears its weight and stays where it is.
#[test]
fn a_free_part_lies_still_on_a_plane() {
    let text = format!(
        "[gravity]\nacceleration = [0.0, 0.0, -9.81]\n[[body]]\nid = \"part\"\nfree = true\n\
         material = {{ density_kg_m3 = 2700.0 }}\npose = {{ position = [0.0, 0.0, 0.001] }}\n\
         surface = {{ inline = {{ step = '''\n{}''' }} }}\n\
         [[tool]]\nid = \"floor\"\nshape = {{ plane = {{ normal = [0.0, 0.0, 1.0] }} }}\n\
         [[contact]]\npair = [\"floor\", \"part\"]\nfriction = {{ mu = 0.5 }}\n",
        step_file("shelled_box")
    );
    let mut world = World::new(&text);
    let floor = pose(0, [0.0; 3]);
    for _ in 0..600 {
        world.posed(floor);
    }
    let corners = |world: &World| {
        let mut points = world.scene.skin(0).points().to_vec();
        world.state.copy_net(&world.scene, 0, &mut points);
        points
    };
    let before = corners(&world);
    for _ in 0..400 {
        world.posed(floor);
    }
    let after = corners(&world);
    let moved = before.iter().zip(&after).map(|(a, b)| (a - b).norm());
    let moved_m = moved.fold(0.0, f64::max);
    let weight_n = world.scratch.contact_force_on(0).z;
    let part = world.scene.skin(0).part().expect("a part").part();
    let mass_kg = 2700.0 * part.moments().expect("closed").volume_m3;
    println!(
        "moved {moved_m:e} m, bears {weight_n} N of {}",
        mass_kg * 9.81
    );
    assert!(moved_m < 1e-6, "{moved_m} m");
    assert!(
        (weight_n / (mass_kg * 9.81) - 1.0).abs() < 1e-3,
        "{weight_n} N"
    );
    // Its lower corners are level.
    let mut heights_m: Vec<f64> = after.iter().map(|p| p.z).collect();
    heights_m.sort_by(f64::total_cmp);
    assert!(heights_m[3] - heights_m[0] < 1e-6, "{heights_m:?}");
}

// What is taken otherwise than the file says is said, of bodies and of tools: here two faces whose loops run the wrong way.
#[test]
fn faces_that_are_turned_are_warned_of() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/bracket.step");
    let text = std::fs::read_to_string(path).expect("the part of the scenes");
    let wrong = text.replace("#90=FACE_BOUND('',#89,.F.)", "#90=FACE_BOUND('',#89,.T.)");
    for (step, warned) in [(text, 0), (wrong, 2)] {
        let surface = format!("{{ inline = {{ step = '''\n{step}''' }} }}");
        let scene = format!(
            "[[body]]\nid = \"part\"\nsurface = {surface}\n[[body]]\nid = \"sheet\"\n\
             surface = {{ builtin = \"sheet\" }}\npose = {{ position = [0.0, 0.0, 0.5] }}\n\
             [[tool]]\nid = \"tool\"\nshape = {{ surface = {surface} }}\npose = {{ position = [0.0, 0.0, 0.7] }}\n\
             [[contact]]\npair = [\"tool\", \"part\"]\nmethod = \"none\"\n"
        );
        let loaded = file::parse(&scene, "test.toml", Path::new(".")).expect("a scene");
        let built =
            Scene::build_to_run(&loaded.spec, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
        let said = built
            .warnings()
            .iter()
            .filter(|w| w.what.contains("faces turned"));
        assert_eq!(said.count(), warned);
    }
}
