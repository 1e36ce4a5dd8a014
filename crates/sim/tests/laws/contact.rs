//! Contact in the loop: several regions at once, shapes of all kinds, bodies against bodies.

use crate::common::{Laws as _, World, pose};
use palpate_geometry::math::{Rotation, Vector3};
use palpate_sim::solve::rows::Holder;
use palpate_sim::tick::record::{TickInput, TickOutput};
use palpate_sim::tick::step;

/// A scene of one rigid sheet of given degree in u and v with this tool.
fn sheet(degree: [usize; 2], points: &[Vec<[f64; 3]>], shape: &str, start: [f64; 3]) -> String {
    let clamped = |p: usize, n: usize| -> Vec<f64> {
        let inner = n - p;
        let mut knots = vec![0.0; p];
        knots.extend((0..=inner).map(|k| k as f64 / inner as f64));
        knots.extend(vec![1.0; p]);
        knots
    };
    let knots = [
        clamped(degree[0], points.len()),
        clamped(degree[1], points[0].len()),
    ];
    format!(
        r#"
[[body]]
id = "sheet"
[body.surface.inline]
format = "palpate.surface.v1"
degree = {degree:?}
periodic = [false, false]
knots = {knots:?}
points = {points:?}
[[tool]]
id = "tool"
shape = {shape}
pose = {{ position = {start:?} }}
coupling = {{ stiffness_n_m = 500.0, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 500.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }}
"#
    )
}

fn groove(shape: &str) -> String {
    let line = |x: f64, z: f64| vec![[x, -0.05, z], [x, 0.05, z]];
    sheet(
        [1, 1],
        &[line(-0.05, 0.05), line(0.0, 0.0), line(0.05, 0.05)],
        shape,
        [0.0, 0.0, 0.06],
    )
}

// A ball of 10 mm in a groove of two planes at 45° rests at 10 mm × √2 above the crease. Held down
// by d it feels K d up, half of that from either wall; drawn aside within the groove it is held by
// both as if the groove were a slot.
#[test]
fn a_ball_in_a_groove_is_held_by_both_walls() {
    let mut world = World::new(&groove("{ sphere = { radius_m = 0.01 } }"));
    let rest = 0.01 * 2f64.sqrt();
    for k in 0..=400 {
        world.at([
            0.0,
            0.0,
            0.06 - (0.06 - rest + 0.004) * f64::from(k) / 400.0,
        ]);
    }
    let mut last: Option<TickOutput> = None;
    for k in -300i32..=300 {
        let x = f64::from(k) * 1e-5;
        let out = world.at([x, 0.0, rest - 0.004]);
        let tool = out.tools[0];
        // Down by 4 mm and aside by at most 3: within the cone of the two normals.
        let expected = Vector3::new(-500.0 * x, 0.0, 500.0 * 0.004);
        assert!(
            (tool.force_n - expected).norm() < 2e-3 * expected.norm(),
            "at {x}: {} for {expected}",
            tool.force_n
        );
        assert_eq!(
            out.contacts.list().len(),
            2,
            "at {x}: {:?}",
            out.contacts.list()
        );
        let sum: Vector3 = out.contacts.list().iter().map(|c| c.force_n).sum();
        assert!((sum - tool.force_n).norm() < 1e-9);
        for contact in out.contacts.list() {
            assert!(
                (contact.normal.z - 0.5f64.sqrt()).abs() < 1e-6,
                "{}",
                contact.normal
            );
        }
        last = Some(out);
    }
    assert!(last.is_some());
}

// Out of one wall's reach and back: what a region adds begins and ends at nothing.
#[test]
fn force_does_not_jump_when_a_region_appears_or_leaves() {
    let mut world = World::new(&groove("{ sphere = { radius_m = 0.01 } }"));
    let rest = 0.01 * 2f64.sqrt();
    for k in 0..=400 {
        world.at([
            0.0,
            0.0,
            0.06 - (0.06 - rest + 0.002) * f64::from(k) / 400.0,
        ]);
    }
    let (mut before, mut place) = (
        world.at([0.0, 0.0, rest - 0.002]).tools[0].force_n,
        Vector3::new(0.0, 0.0, rest - 0.002),
    );
    let (mut seen, mut worst) = ([0u32; 3], 0.0f64);
    for k in 0..6_000 {
        let t = f64::from(k) * 1e-3;
        let next = Vector3::new(
            0.008 * (3.0 * t).sin(),
            0.01 * (1.1 * t).sin(),
            rest - 0.002 + 0.001 * (5.0 * t).sin(),
        );
        let out = world.at([next.x, next.y, next.z]);
        let step = (out.tools[0].force_n - before).norm();
        let moved = (next - place).norm();
        // A projection onto a convex set moves no farther than what is projected; force is K times
        // the way between both.
        assert!(
            step <= 500.0 * 2.0 * moved + 1e-6,
            "tick {k}: force steps by {step} N, the hand by {moved} m"
        );
        worst = worst.max(step / (500.0 * moved).max(1e-12));
        (before, place) = (out.tools[0].force_n, next);
        seen[out.contacts.list().len().min(2)] += 1;
    }
    println!("ticks with 0, 1, 2 regions: {seen:?}; largest step {worst:.3} of K times the hand's");
    assert!(seen[1] > 100 && seen[2] > 100, "{seen:?}");
}

/// Two equal hills at x = ±30 mm, 10 mm high in the net.
fn hills() -> Vec<Vec<[f64; 3]>> {
    let height = [0.0, 0.0, 0.01, 0.0, 0.0, 0.01, 0.0, 0.0];
    let ridge = [0.0, 0.3, 1.0, 1.0, 0.3, 0.0];
    (0..8)
        .map(|i| {
            let x = -0.07 + 0.02 * i as f64;
            (0..6)
                .map(|j| [x, -0.05 + 0.02 * j as f64, height[i] * ridge[j]])
                .collect()
        })
        .collect()
}

/// One tick with the first tool at a pose.
fn posed(world: &mut World, position: [f64; 3], rotation: Rotation) -> TickOutput {
    world.seq += 1;
    let mut input = TickInput::default();
    input.poses[0] = Some(palpate_sim::haptics::DevicePose {
        orientation: rotation,
        ..pose(world.seq, position)
    });
    step(&world.scene, &mut world.state, &mut world.scratch, &input)
}

// The plane lies on both hills: each bears half, and the moment is that of both about the tool's
// reference point.
#[test]
fn a_plane_on_two_hills_feels_the_moment_of_both() {
    let text = sheet(
        [3, 3],
        &hills(),
        "{ plane = { normal = [0.0, 0.0, -1.0] } }",
        [0.0, 0.0, 0.02],
    );
    let mut world = World::new(&text);
    world.at([0.004, 0.0, 0.02]);
    let surface = world.scene.rest_surface(0).unwrap().clone();
    let top = (0..=400)
        .map(|k| surface.point(f64::from(k) / 400.0, 0.5).z)
        .fold(0.0, f64::max);
    let out = world.at([0.004, 0.0, top - 0.001]);
    let (tool, list) = (out.tools[0], out.contacts.list());
    assert_eq!(list.len(), 2, "{list:?}");
    assert!(
        (tool.force_n - Vector3::new(0.0, 0.0, 0.5)).norm() < 1e-3,
        "{}",
        tool.force_n
    );
    // Hills are mirror images: the mean of their places is x = 0, 4 mm beside the reference point.
    let expected = Vector3::new(0.0, 0.004 * 0.5, 0.0);
    assert!(
        (tool.torque_nm - expected).norm() < 1e-2 * expected.norm(),
        "{}",
        tool.torque_nm
    );
    assert!(
        (list[0].force_n.z - list[1].force_n.z).abs() < 1e-3,
        "{list:?}"
    );

    // Rocked from one hill to the other, force and moment change by little in a small turn.
    let (mut before, mut hills_seen) = (None, [false; 3]);
    for k in -100..=100 {
        let turn = Rotation::from_axis_angle(&Vector3::y_axis(), f64::from(k) * 5e-4);
        let tool = posed(&mut world, [0.0, 0.0, top - 0.001], turn).tools[0];
        if let Some((force, torque)) = before {
            let (df, dt): (f64, f64) = (
                (tool.force_n - force as Vector3).norm(),
                (tool.torque_nm - torque as Vector3).norm(),
            );
            // A turn of 0.5 mrad at 30 mm moves a hill's depth by 15 µm: 7.5 mN, 0.23 mN m, of
            // either hill.
            assert!(
                df < 0.03 && dt < 1e-3,
                "turn {k}: force steps by {df}, moment by {dt}"
            );
        }
        before = Some((tool.force_n, tool.torque_nm));
        hills_seen[tool.contact_count.min(2) as usize] = true;
    }
    assert!(hills_seen[1] && hills_seen[2], "{hills_seen:?}");
}

fn two_drops(gap_m: f64) -> String {
    include_str!("../../../../scenes/two-drops.toml")
        .replace("-0.0357", &format!("{:?}", -0.0352 - gap_m))
}

// Both drops are the same and stand side by side: pressed together, each gives way.
#[test]
fn two_soft_bodies_press_each_other_apart_and_stay_apart() {
    let mut world = World::new(&two_drops(-0.003));
    let far = [0.2, 0.0, 0.045];
    for _ in 0..1_500 {
        world.at(far);
    }
    let out = world.at(far);
    let touching: Vec<_> = out
        .contacts
        .list()
        .iter()
        .filter(|c| matches!(c.holder, Holder::Body(_)))
        .collect();
    assert!(!touching.is_empty(), "the drops overlap and do not touch");
    let force: Vector3 = touching.iter().map(|c| c.force_n).sum();
    let deepest = touching.iter().map(|c| c.depth_m).fold(0.0, f64::max);
    println!(
        "{} contacts, {:.4} N, left over {:.2e} m",
        touching.len(),
        force.norm(),
        deepest
    );
    assert!(force.norm() > 0.01, "{force}");
    assert!(deepest < 2e-5, "they still overlap by {deepest} m");
    // At rest: nothing moves any more.
    let again = world.at(far);
    let change: Vector3 = again
        .contacts
        .list()
        .iter()
        .map(|c| c.force_n)
        .sum::<Vector3>()
        - force;
    assert!(
        change.norm() < 1e-3 * force.norm(),
        "force still changes by {change}"
    );
}

// A ball presses the first drop, the first drop the second.
#[test]
fn a_push_goes_through_a_body_into_the_next() {
    let mut world = World::new(&two_drops(0.0005));
    let press = |world: &mut World, x: f64| {
        world.rest(|world| _ = world.at_in_place([x, 0.003, 0.045]), 2_000);
        let out = &world.record.output;
        let sum = |tool: bool| -> f64 {
            let own = out
                .contacts
                .list()
                .iter()
                .filter(|c| matches!(c.holder, Holder::Tool(_)) == tool);
            own.map(|c| c.force_n).sum::<Vector3>().norm()
        };
        (sum(true), sum(false))
    };
    for k in 0..200 {
        world.at([0.06 - 0.035 * f64::from(k) / 200.0, 0.003, 0.045]);
    }
    let light = press(&mut world, 0.022);
    let firm = press(&mut world, 0.014);
    println!("hand and neighbour: {light:?} N, then {firm:?} N");
    assert!(firm.0 > light.0 && firm.1 > light.1 && firm.1 > 0.01);
    // What the neighbour bears came through the first drop, whose stand bears the rest.
    assert!(firm.1 < firm.0, "{firm:?}");
}

fn globe(shape: &str, extra: &str) -> String {
    format!(
        r#"
[[body]]
id = "globe"
surface = {{ builtin = "sphere", size = 0.05 }}
[[tool]]
id = "tool"
shape = {shape}
pose = {{ position = [0.09, 0.0, 0.0] }}
coupling = {{ stiffness_n_m = 700.0, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 500.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }}
{extra}
"#
    )
}

/// The worst miss of K × depth over a path around the globe, relative to the largest force; ticks
/// in touch.
fn worst_on_globe(text: &str) -> (f64, u32) {
    let mut world = World::new(text);
    let (mut worst, mut touched) = (0.0f64, 0);
    for k in 0..1_500 {
        let t = f64::from(k) * 2e-3;
        let radius = 0.0585 + 0.0025 * (9.0 * t + 1.0).cos();
        let (polar, azimuth) = (1.57 - 0.3 * t, 0.4 * t);
        let n = Vector3::new(
            polar.sin() * azimuth.cos(),
            polar.sin() * azimuth.sin(),
            polar.cos(),
        );
        let place = n * radius;
        if k == 0 {
            for s in 0..=100 {
                let place = n * (0.09 + (radius - 0.09) * f64::from(s) / 100.0);
                world.at([place.x, place.y, place.z]);
            }
        }
        let tool = world.at([place.x, place.y, place.z]).tools[0];
        let expected = n * (700.0 * (0.06 - radius).max(0.0));
        worst = worst.max((tool.force_n - expected).norm() / (700.0 * 0.004));
        touched += u32::from(tool.contact.is_some());
    }
    (worst, touched)
}

// A surface tool in the shape of a ball, and a ball on sampled points: all feel K × depth, each to
// its own accuracy.
#[test]
fn shapes_and_methods_agree_on_a_globe() {
    let ball = "{ sphere = { radius_m = 0.01 } }";
    let spheres = "[[contact]]\npair = [\"tool\", \"globe\"]\nmethod = \"spheres\"\nresolution = ";
    let cases = [
        ("ball", globe(ball, ""), 1e-9),
        // Planes through the contacts of one more look: a hand 4 mm deep in a globe of 60 mm turns
        // them by a fifteenth of what it turns by in a tick, a milliradian.
        (
            "surface",
            globe("{ surface = { builtin = \"sphere\", size = 0.01 } }", ""),
            2e-4,
        ),
        (
            "implicit",
            globe(
                "{ implicit = { f = \"sqrt(x^2 + y^2 + z^2) - 0.01\" } }",
                "",
            ),
            2e-4,
        ),
        (
            "ellipsoid",
            globe("{ ellipsoid = { semi_axes_m = [0.01, 0.01, 0.01] } }", ""),
            2e-4,
        ),
        // Triangles with sides of h = 2π R / rows tilt by up to h / 2 R = π / rows.
        (
            "spheres 244",
            globe(ball, &format!("{spheres}[244, 244]")),
            std::f64::consts::PI / 244.0,
        ),
        (
            "spheres 82",
            globe(ball, &format!("{spheres}[82, 82]")),
            std::f64::consts::PI / 82.0,
        ),
    ];
    for (name, text, bar) in cases {
        let (worst, touched) = worst_on_globe(&text);
        println!("{name}: {worst:.1e} of the largest force over {touched} ticks in touch");
        assert!(touched > 500, "{name}: {touched}");
        assert!(worst < bar, "{name}: {worst}");
    }
}

/// A cube of 20 mm as a mesh.
const CUBE: &str = "{ mesh = { inline = { vertices = [[-0.01, -0.01, -0.01], [0.01, -0.01, -0.01], [0.01, 0.01, -0.01], \
[-0.01, 0.01, -0.01], [-0.01, -0.01, 0.01], [0.01, -0.01, 0.01], [0.01, 0.01, 0.01], [-0.01, 0.01, 0.01]], triangles = \
[[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], \
[3, 0, 4], [3, 4, 7]] } } }";

// The face of a cube on the top of the globe, moved about by less than the face is wide.
#[test]
fn a_cube_on_a_globe_feels_its_depth_as_a_function_and_as_a_mesh() {
    for (name, shape) in [
        ("box", "{ box = { half_extents_m = [0.01, 0.01, 0.01] } }"),
        ("mesh", CUBE),
    ] {
        let mut world = World::new(&globe(shape, ""));
        for k in 0..=200 {
            world.at([0.09 - 0.0305 * f64::from(k) / 200.0, 0.0, 0.0]);
        }
        let mut worst = 0.0f64;
        for k in 0..300 {
            let t = f64::from(k) * 1e-2;
            let depth = 0.001 + 0.0008 * (2.0 * t).sin();
            let out = world.at([0.06 - depth, 0.003 * t.sin(), 0.002 * (1.7 * t).cos()]);
            let expected = Vector3::new(700.0 * depth, 0.0, 0.0);
            worst = worst.max((out.tools[0].force_n - expected).norm() / expected.norm());
            assert!(
                !out.contacts.list().is_empty(),
                "{name}: nothing touches at {t}"
            );
        }
        println!("{name}: {worst:.1e} of the force");
        assert!(worst < 1e-6, "{name}: {worst}");
    }
}

// 120 mm in one tick, past the middle of the globe.
#[test]
fn a_surface_tool_that_jumps_through_the_body_is_held_on_the_side_it_came_from() {
    let mut world = World::new(&globe(
        "{ surface = { builtin = \"sphere\", size = 0.01 } }",
        "",
    ));
    world.at([0.09, 0.0, 0.0]);
    let tool = world.at([-0.03, 0.0, 0.0]).tools[0];
    assert!(
        (tool.proxy_position.x - 0.06).abs() < 1e-6,
        "proxy at {}",
        tool.proxy_position
    );
    assert!(
        (tool.force_n.x - 700.0 * 0.09).abs() < 1e-2,
        "{}",
        tool.force_n
    );
}

/// A soft sausage folded to a hairpin, its lower arm held; a plate presses the upper arm onto it (from
/// under a ball it slips out sideways).
fn folded_sausage(self_contact: bool) -> String {
    let (around, along) = (8, 20);
    let points: Vec<Vec<[f64; 3]>> = (0..around)
        .map(|i| {
            let turn = 2.0 * std::f64::consts::PI * i as f64 / around as f64;
            (0..along)
                .map(|j| {
                    // Along the upper arm, round the bend, back along the lower arm.
                    let t = j as f64 / (along - 1) as f64;
                    let (arm, bend) = (0.04, 0.01);
                    let s = t * (2.0 * arm + std::f64::consts::PI * bend);
                    let angle = ((s - arm) / bend).clamp(0.0, std::f64::consts::PI);
                    let straight = if s < arm {
                        arm - s
                    } else {
                        (s - arm - std::f64::consts::PI * bend).max(0.0)
                    };
                    let tube = 0.009 * (1.0 - (2.0 * t - 1.0).powi(10)).max(0.0).sqrt();
                    let out = bend + tube * turn.cos();
                    [
                        straight - out * angle.sin(),
                        out * angle.cos(),
                        tube * turn.sin(),
                    ]
                })
                .collect()
        })
        .collect();
    let u: Vec<f64> = (0..=around).map(|k| k as f64 / around as f64).collect();
    let inner = along - 3;
    let mut v = vec![0.0; 3];
    v.extend((0..=inner).map(|k| k as f64 / inner as f64));
    v.extend(vec![1.0; 3]);
    format!(
        r#"
[[body]]
id = "sausage"
model = "lattice"
self_contact = {self_contact}
material = {{ young_pa = 8e3 }}
lattice = {{ layers = 2, refine = "none" }}
fixed = [{{ point = [0.0, -0.01, 0.0], normal = [0.0, 1.0, 0.0] }}]
[body.surface.inline]
format = "palpate.surface.v1"
degree = [3, 3]
periodic = [true, false]
knots = [{u:?}, {v:?}]
points = {points:?}
[[tool]]
id = "plate"
shape = {{ plane = {{ normal = [0.0, -1.0, 0.0] }} }}
pose = {{ position = [0.03, 0.034, 0.0] }}
coupling = {{ stiffness_n_m = 500.0, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 500.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }}
"#
    )
}

#[test]
fn a_folded_sausage_meets_itself_and_does_not_go_through() {
    let press = |self_contact: bool| {
        let mut world = World::new(&folded_sausage(self_contact));
        for k in 0..500 {
            world.at([0.03, 0.034 - 0.020 * (f64::from(k) / 300.0).min(1.0), 0.0]);
        }
        world.rest(|world| _ = world.at([0.03, 0.014, 0.0]), 3_000);
        world.at([0.03, 0.014, 0.0])
    };
    let (with, without) = (press(true), press(false));
    let own: Vec<_> = with
        .contacts
        .list()
        .iter()
        .filter(|c| c.holder == Holder::Body(0))
        .collect();
    let (held, free) = (
        with.tools[0].force_n.norm(),
        without.tools[0].force_n.norm(),
    );
    println!(
        "{} places, hand {held:.4} N; {free:.4} N when the ends pass through each other",
        own.len()
    );
    assert!(!own.is_empty(), "the ends do not meet");
    assert!(own.iter().all(|c| c.depth_m < 1e-5), "{own:?}");
    assert!(held > 1.05 * free, "{held} N against {free} N");
}

// Enough pairs for the tree of boxes: every globe is met when the ball comes to it, and no other.
#[test]
fn a_ball_among_many_bodies_meets_each_in_turn() {
    let count = 20;
    let mut text = String::new();
    for k in 0..count {
        text += &format!(
            "[[body]]\nid = \"g{k}\"\nsurface = {{ builtin = \"sphere\", size = 0.02 }}\npose = {{ position = [{:?}, 0.0, 0.0] }}\n",
            0.1 * f64::from(k)
        );
    }
    let tool = globe("{ sphere = { radius_m = 0.01 } }", "");
    text += &tool[tool.find("[[tool]]").unwrap()..].replace("[0.09, 0.0, 0.0]", "[0.0, 0.0, 0.05]");
    let mut world = World::new(&text);
    for k in 0..count {
        let x = 0.1 * f64::from(k);
        for s in 0..=40 {
            world.at([x, 0.0, 0.05 - 0.021 * f64::from(s) / 40.0]);
        }
        let out = world.at([x, 0.0, 0.029]);
        let tool = out.tools[0];
        assert!(
            (tool.force_n - Vector3::new(0.0, 0.0, 0.7)).norm() < 1e-9,
            "globe {k}: {}",
            tool.force_n
        );
        assert_eq!(tool.contact.map(|c| c.body), Some(k as u32));
        world.at([x, 0.0, 0.05]);
    }
}
