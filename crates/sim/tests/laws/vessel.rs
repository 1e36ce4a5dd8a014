//! A branching tube is touched and deforms: one surface whose stem is drawn twice and whose edges
//! are joined.

use crate::common::{Laws as _, World};
use palpate_geometry::basis::Side;
use palpate_geometry::math::{Point3, SavedState, Vector3, state_hash};
use palpate_geometry::surface::{self, Surface};
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::restore;
use std::fmt::Write as _;
use std::path::Path;

const VESSEL: &str = include_str!("../../../../scenes/vessel.toml");
const RADIUS_M: f64 = 0.004;

/// The scene with a rigidly held ball in place of its pen, and `more` for the body.
fn vessel(more: &str) -> String {
    let (body, _) = VESSEL.split_once("[[tool]]").unwrap();
    format!(
        "{}{more}\n{}",
        body.replace("vessel.json", "../../scenes/vessel.json"),
        ball()
    )
}

fn ball() -> String {
    format!(
        "[[tool]]\nid = \"ball\"\nshape = {{ sphere = {{ radius_m = {RADIUS_M:?} }} }}\n\
         pose = {{ position = [0.0, -0.04, -0.03] }}\ncoupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}\n\
         device = {{ force_max_n = 1e9, ramp_s = 0.0 }}\n"
    )
}

fn rest(world: &World) -> Surface {
    world.scene.rest_surface(0).unwrap().clone()
}

/// The surface as it is.
fn now(world: &World) -> Surface {
    let mut surface = rest(world);
    world
        .state
        .copy_net(&world.scene, 0, surface.net_mut().points_mut());
    surface
}

/// A way over the surface at rest: places with outward normals.
type Way = Vec<(Point3, Vector3)>;

fn way(surface: &Surface, places: impl IntoIterator<Item = (f64, f64)>) -> Way {
    places
        .into_iter()
        .map(|(u, v)| (surface.point(u, v), surface.normal(u, v)))
        .collect()
}

fn between(a: f64, b: f64, steps: usize) -> impl Iterator<Item = f64> {
    (0..=steps).map(move |k| a + (b - a) * k as f64 / steps as f64)
}

/// Just before a joint.
const BEFORE: f64 = 1e-9;

/// Ways over every kind of joint.
fn ways(surface: &Surface) -> Vec<(&'static str, Way)> {
    let n = 300;
    let front = between(11.0, 12.0 - BEFORE, n)
        .chain(between(0.0, 1.0, n))
        .map(|u| (u, 9.0));
    let back = between(5.0, 7.0, 2 * n).map(|u| (u, 9.0));
    let back_of_branch = between(17.0, 19.0, 2 * n).map(|u| (u, 3.0));
    let outer = between(5.0, 6.0 - BEFORE, n)
        .chain(between(6.0, 7.0, n))
        .map(|v| (3.3, v));
    let other_outer = between(5.0, 6.0 - BEFORE, n)
        .map(|v| (20.7, v))
        .chain(between(6.0, 7.0, n).map(|v| (8.7, v)));
    let arch = between(5.0, 6.0 - BEFORE, n)
        .map(|v| (9.4, v))
        .chain(between(6.0 - BEFORE, 5.0, n).map(|v| (14.6, v)));
    vec![
        ("front of the stem", way(surface, front)),
        ("back of the stem", way(surface, back)),
        ("back of a branch", way(surface, back_of_branch)),
        ("branch to stem", way(surface, outer)),
        ("other branch to stem", way(surface, other_outer)),
        ("arch", way(surface, arch)),
    ]
}

fn touch((point, normal): &(Point3, Vector3), depth_m: f64) -> [f64; 3] {
    (point + normal * (RADIUS_M - depth_m)).coords.into()
}

/// Largest angle between the normals on either side of the joints, degrees; control points of
/// joined rows are equal to the last bit.
fn joints_hold(surface: &Surface) -> f64 {
    let net = surface.net();
    let same = |a: [usize; 2], b: [usize; 2]| {
        let (x, y) = (net.at(a[0], a[1]), net.at(b[0], b[1]));
        assert!(
            (0..3).all(|c| x[c].to_bits() == y[c].to_bits()),
            "{a:?} and {b:?} are apart: {x} and {y}"
        );
    };
    for j in 0..15 {
        same([0, j], [16, j]);
        same([17, j], [33, j]);
        if j >= 8 {
            (0..17).for_each(|i| same([i, j], [i + 17, j]));
        }
    }
    for k in 0..=8 {
        same([k, 7], [k, 8]);
        same([33 - k, 7], [16 - k, 8]);
        same([16 - k, 7], [17 + k, 7]);
    }
    let normal = |u: f64, v: f64, sides: [Side; 2]| {
        let frame = surface.frame_from(u, v, sides[0], sides[1]);
        frame.du.cross(&frame.dv).normalize()
    };
    let (left, right) = (Side::Left, Side::Right);
    let mut worst = 0.0_f64;
    let mut compare = |a: Vector3, b: Vector3| {
        worst = worst.max(a.cross(&b).norm().atan2(a.dot(&b)).to_degrees())
    };
    for k in 0..=40 {
        let share = f64::from(k) / 40.0;
        for v in [5.99 * share, 6.0 + 4.99 * share] {
            compare(normal(0.0, v, [right; 2]), normal(12.0, v, [left, right]));
            compare(normal(6.0, v, [left, right]), normal(6.0, v, [right; 2]));
            compare(normal(12.0, v, [right; 2]), normal(24.0, v, [left, right]));
            compare(normal(18.0, v, [left, right]), normal(18.0, v, [right; 2]));
        }
        let u = 5.99 * share;
        compare(normal(u, 6.0, [right, left]), normal(u, 6.0, [right; 2]));
        compare(
            normal(24.0 - u, 6.0, [left, left]),
            normal(12.0 - u, 6.0, [left, right]),
        );
        compare(
            normal(12.0 - u, 6.0, [left; 2]),
            normal(12.0 + u, 6.0, [right, left]),
        );
    }
    worst
}

#[test]
fn the_scene_loads_and_its_pen_is_pushed_back() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/vessel.toml");
    let loaded = file::load(&path).unwrap();
    let scene = Scene::build(&loaded.spec, path.parent().unwrap()).unwrap();
    let surface = scene.rest_surface(0).unwrap();
    assert!(
        joints_hold(surface) < 1e-4,
        "{} degrees at rest",
        joints_hold(surface)
    );
    let mut world = World::new(&VESSEL.replace("vessel.json", "../../scenes/vessel.json"));
    let mut force = Vector3::zeros();
    for k in 0..800 {
        let depth = 0.002 * (f64::from(k) / 400.0).min(1.0);
        force = world.at([0.0, -0.021 + depth, -0.03]).tools[0].force_n;
    }
    println!("a pen 1 mm into the front of the stem: {force} N");
    assert!(
        force.y < -0.01 && force.x.abs() < 0.05 * force.y.abs(),
        "{force} N"
    );
}

// In each place the ball is pushed out along the normal, about as hard on the stem, on a branch and
// on their joint.
#[test]
fn the_stem_the_branches_and_the_arch_push_back() {
    let mut world = World::new(&vessel(""));
    let surface = rest(&world);
    let places = [
        ("stem, joint", 0.0, 8.5),
        ("stem, side", 3.0, 8.5),
        ("stem, right", 9.0, 8.5),
        ("branch, side", 2.0, 2.5),
        ("other branch", 20.0, 2.5),
        ("joint of branch and stem", 3.0, 6.0),
        ("arch", 9.0, 5.7),
        ("front of the arch", 11.5, 5.5),
    ];
    for (name, u, v) in places {
        let place = (surface.point(u, v), surface.normal(u, v));
        let mut out = world.at(touch(&place, -0.001));
        for k in 0..500 {
            out = world.at(touch(&place, 0.001 * (f64::from(k) / 250.0).min(1.0)));
        }
        let force = out.tools[0].force_n;
        println!(
            "{name}: {force} N, {} along the normal; {} rows",
            force.dot(&place.1),
            out.tools[0].contact_count
        );
        assert!(force.dot(&place.1) > 0.05, "{name}: {force} N");
        assert!(
            force.dot(&place.1) > 0.9 * force.norm(),
            "{name}: {force} N does not push along {}",
            place.1
        );
        for k in 0..400 {
            world.at(touch(&place, 0.001 - 0.006 * f64::from(k) / 400.0));
        }
    }
}

/// The stem as a plain tube, drawn so many times.
fn tube(copies: usize) -> String {
    let whole: serde_json::Value =
        serde_json::from_str(include_str!("../../../../scenes/vessel.json")).unwrap();
    let rows: Vec<Vec<serde_json::Value>> = (0..17)
        .map(|i| whole["points"][i].as_array().unwrap()[8..].to_vec())
        .collect();
    let all: Vec<_> = (0..copies).flat_map(|_| rows.clone()).collect();
    let mut knots = vec![0.0; 4];
    for copy in 0..copies {
        let at = |k: usize| (12 * copy + k) as f64;
        knots.extend((1..6).map(at));
        knots.extend([at(6); 3]);
        knots.extend((7..12).map(at));
        knots.extend([at(12); 4]);
    }
    let mut text = String::from("[[body]]\nid = \"tube\"\nmodel = \"membrane\"\n");
    let _ = writeln!(
        text,
        "surface = {{ inline = {{ format = \"{}\", degree = [3, 2], periodic = [false, false], knots = [{}, \
         [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 5.0, 5.0]], points = {} }} }}",
        surface::file::FORMAT,
        serde_json::to_string(&knots).unwrap(),
        serde_json::to_string(&all).unwrap(),
    );
    let last = 12.0 * copies as f64;
    let _ = writeln!(
        text,
        "material = {{ young_pa = 1e6, density_kg_m3 = 1050.0, damping_s = 2e-3 }}\n\
         lattice = {{ thickness_m = 0.003, refine = \"none\" }}\n\
         fixed = [{{ u = [0.0, {last:?}], v = [0.0, 0.0] }}, {{ u = [0.0, {last:?}], v = [5.0, 5.0] }}]\n{}",
        ball()
    );
    text
}

// A tube that is drawn twice, or three times, is the tube: as heavy, as stiff, touched once.
#[test]
fn a_duplicated_tube_is_the_tube() {
    let mut forces = Vec::new();
    for copies in 1..=3 {
        let mut world = World::new(&tube(copies));
        let surface = rest(&world);
        let mut found = Vec::new();
        for (u, v) in [(3.0, 2.5), (0.0, 2.5), (9.4, 1.7)] {
            let place = (surface.point(u, v), surface.normal(u, v));
            let mut out = world.at(touch(&place, -0.001));
            for k in 0..600 {
                out = world.at(touch(&place, 0.0015 * (f64::from(k) / 300.0).min(1.0)));
            }
            found.push((out.tools[0].force_n, out.tools[0].contact_count));
            (0..400)
                .for_each(|k| _ = world.at(touch(&place, 0.0015 - 0.006 * f64::from(k) / 400.0)));
        }
        println!("{copies} times: {found:?}; area {} m²", surface.area());
        forces.push(found);
    }
    for (place, ((one, _), ((two, rows), (three, again)))) in forces[0]
        .iter()
        .zip(forces[1].iter().zip(&forces[2]))
        .enumerate()
    {
        assert!(
            (two - three).norm() < 1e-9 * two.norm(),
            "place {place}: {two} N twice, {three} N three times"
        );
        assert_eq!(rows, again, "place {place}");
        // The second place is on the seam, where a plain net is touched on one of its two sides:
        // its force is tilted by 1 degree.
        let most = if place == 1 { 0.02 } else { 1e-3 };
        assert!(
            (one - two).norm() < most * one.norm(),
            "place {place}: {one} N once, {two} N twice"
        );
    }
}

/// What a slide along a way feels: least and greatest force, and the greatest step from one tick to
/// the next, N.
struct Slide {
    least: f64,
    most: f64,
    step: f64,
}

/// Presses a ball at the start of a way, lets it rest, slides it along and lifts it.
fn slide(world: &mut World, name: &str, way: &Way) -> Slide {
    let depth = 0.0008;
    (0..300).for_each(|k| {
        _ = world.at(touch(
            &way[0],
            -0.001 + (depth + 0.001) * f64::from(k) / 299.0,
        ))
    });
    (0..300).for_each(|_| _ = world.at(touch(&way[0], depth)));
    let mut forces = Vec::new();
    let mut places = Vec::new();
    for place in way {
        let out = world.at(touch(place, depth));
        forces.push(out.tools[0].force_n);
        places.push((
            out.tools[0].contact.map(|c| (c.u, c.v)),
            out.tools[0].contact_count,
        ));
    }
    let angle = if world.scene.body_id(0) == "vessel" {
        joints_hold(&now(world))
    } else {
        0.0
    };
    let end = way.last().unwrap();
    (0..400).for_each(|k| _ = world.at(touch(end, depth - 0.006 * f64::from(k) / 400.0)));
    let step = |k: usize| (forces[k + 1] - forces[k]).norm();
    let worst = (0..forces.len() - 1)
        .max_by(|&a, &b| step(a).total_cmp(&step(b)))
        .unwrap();
    let sizes = || forces.iter().map(|f| f.norm());
    let found = Slide {
        least: sizes().fold(f64::INFINITY, f64::min),
        most: sizes().fold(0.0, f64::max),
        step: step(worst),
    };
    let near: Vec<String> = (worst.saturating_sub(3)..(worst + 5).min(forces.len()))
        .map(|k| format!("{:.4} N at {:.4?}", forces[k].norm(), places[k]))
        .collect();
    println!(
        "{name}: {:.4} to {:.4} N, largest step {:.5} N of {} ticks, joints turn by {angle:.2} degrees; around it {near:?}",
        found.least,
        found.most,
        found.step,
        forces.len()
    );
    found
}

// Over every joint the ball is held all the way; over those of the stem it feels what it feels on a
// plain tube.
#[test]
fn a_ball_slides_over_every_joint() {
    let mut world = World::new(&vessel(""));
    let surface = rest(&world);
    for (name, way) in ways(&surface) {
        let found = slide(&mut world, name, &way);
        assert!(found.least > 0.0, "{name}: let go");
        assert!(
            found.step < 0.5 * found.most,
            "{name}: the force jumps by {} N of {} N",
            found.step,
            found.most
        );
    }
    let ring = |n: usize| {
        between(11.0, 12.0 - BEFORE, n)
            .chain(between(0.0, 1.0, n))
            .map(|u| (u, 2.5))
    };
    let mut slides = Vec::new();
    for copies in 1..=2 {
        let mut world = World::new(&tube(copies));
        let way = way(&rest(&world), ring(300));
        slides.push(slide(&mut world, &format!("{copies} times"), &way));
    }
    let [plain, twice] = [&slides[0], &slides[1]];
    assert!(
        (twice.most / plain.most - 1.0).abs() < 0.1,
        "{} N, on a plain tube {} N",
        twice.most,
        plain.most
    );
    assert!(
        twice.step < 1.5 * plain.step + 0.01 * plain.most,
        "{} N, on a plain tube {} N",
        twice.step,
        plain.step
    );
}

#[test]
fn after_thousands_of_ticks_copies_are_equal_and_a_replay_has_the_same_bits() {
    let text = vessel("integrator = { iterations = 2 }");
    let mut first = World::new(&text);
    let surface = rest(&first);
    let way: Way = ways(&surface)
        .into_iter()
        .flat_map(|(_, way)| way)
        .step_by(2)
        .collect();
    let place = |k: usize| touch(&way[k % way.len()], 0.0008);
    let (mut second, mut saved) = (World::new(&text), SavedState::default());
    let mut worst = 0.0_f64;
    for k in 0..3_000 {
        let (a, b) = (first.at(place(k)), second.at(place(k)));
        assert_eq!(a.state_hash, b.state_hash, "tick {k}");
        if k == 1_500 {
            saved.save_from(&first.state);
        }
        if k % 100 == 0 {
            worst = worst.max(joints_hold(&now(&first)));
        }
    }
    println!("joints turn by up to {worst} degrees");
    assert!(worst < 15.0, "{worst} degrees");
    restore(
        &second.scene,
        &mut second.state,
        &mut second.scratch,
        &saved,
    )
    .unwrap();
    second.seq = 1_501;
    for k in 1_501..3_000 {
        second.at(place(k));
    }
    assert_eq!(state_hash(&first.state), state_hash(&second.state));
}

// Refined by itself, or as asked, the net stays whole and the force nearly the same.
#[test]
fn a_refined_vessel_keeps_its_joints() {
    let base = vessel("");
    let mut found = Vec::new();
    for refine in [
        "\"none\"",
        "\"auto\"",
        "[50, 20]",
        "{ u = [2.5], v = [8.5] }",
    ] {
        let mut world =
            World::new(&base.replace("refine = \"none\"", &format!("refine = {refine}")));
        let surface = rest(&world);
        assert!(surface.joints().unwrap().is_whole(), "{refine}");
        let shown = surface
            .joints()
            .unwrap()
            .patches()
            .iter()
            .filter(|p| p.duplicate_of.is_none())
            .count();
        assert_eq!(shown, 6, "{refine}");
        let place = (surface.point(3.0, 8.5), surface.normal(3.0, 8.5));
        let mut force = Vector3::zeros();
        for k in 0..500 {
            force = world
                .at(touch(&place, 0.001 * (f64::from(k) / 250.0).min(1.0)))
                .tools[0]
                .force_n;
        }
        println!(
            "refine = {refine}: {} x {} points, {} N",
            surface.net().rows(),
            surface.net().columns(),
            force.norm()
        );
        found.push(force.norm());
    }
    assert!(
        found.iter().all(|f| (f / found[0] - 1.0).abs() < 0.5),
        "{found:?} N"
    );
}

#[test]
fn solids_and_spheres_are_refused_with_what_to_use_instead() {
    let build = |text: &str| {
        let loaded = file::parse(text, "test.toml", Path::new(".")).unwrap();
        let error = Scene::build_with(&loaded.spec, Path::new("."), palpate_thesis::METHODS)
            .map(|_| ())
            .unwrap_err();
        assert_eq!(error.problems.len(), 1, "{error}");
        error.problems[0].clone()
    };
    for model in ["lattice", "continuum", "net"] {
        let error = build(&vessel("").replace("\"membrane\"", &format!("\"{model}\"")));
        assert_eq!(error.path, "body[0].model");
        assert!(error.reason.contains("membrane"), "{error}");
    }
    let contact = "[[contact]]\npair = [\"ball\", \"vessel\"]\nmethod = \"spheres\"\n";
    let error = build(&format!("{}{contact}", vessel("")));
    assert!(
        error.path.starts_with("contact[0]") && error.reason.contains("exact"),
        "{error}"
    );
}

// A vessel that stands still: a stylus on a spring meets one surface, whichever patch it is on.
#[test]
fn a_rigid_vessel_is_touched_as_evenly() {
    let text = vessel("")
        .replace("\"membrane\"", "\"rigid\"")
        .replace("stiffness_n_m = inf", "stiffness_n_m = 500.0");
    let text: String = text
        .lines()
        .filter(|l| !l.starts_with("fixed"))
        .map(|l| format!("{l}\n"))
        .collect();
    let mut world = World::new(&text);
    let surface = rest(&world);
    for (name, way) in ways(&surface) {
        let depth = 0.0005;
        (0..50).for_each(|k| {
            _ = world.at(touch(
                &way[0],
                -0.001 + (depth + 0.001) * f64::from(k) / 49.0,
            ))
        });
        for place in &way {
            let out = world.at(touch(place, depth));
            let force = out.tools[0].force_n;
            let off = (force - place.1 * (500.0 * depth)).norm() / (500.0 * depth);
            assert!(off < 0.02, "{name}: {force} N at {}, off by {off}", place.0);
        }
        let end = way.last().unwrap();
        (0..50).for_each(|k| _ = world.at(touch(end, depth - 0.006 * f64::from(k) / 50.0)));
    }
}

// The seam where the surface's two ends lie upon each other was taken for a rim, beside which a tool may go
// round: a point that pressed a crease into it and slid aside was inside all at once.
#[test]
fn a_point_that_slides_off_the_seam_of_a_dent_stays_outside() {
    let (body, tool) = VESSEL.split_once("[[tool]]").unwrap();
    let body = body.replace("vessel.json", "../../scenes/vessel.json");
    let mut world = World::new(&format!("{body}[[tool]]{tool}"));
    let smooth = |t: f64| {
        let t = t.clamp(0.0, 1.0);
        t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)
    };
    for tick in 0..1_400 {
        let t = f64::from(tick) * 1e-3;
        let (pressed, slid) = (smooth(t / 0.6), smooth((t - 0.8) / 0.6));
        let force = world.at([0.004 * slid, -0.03 + 0.0145 * pressed, -0.03 + 0.01 * slid]);
        let force = force.tools[0].force_n;
        assert!(tick < 600 || force.y < -0.4, "tick {tick}: {force} N");
    }
}
