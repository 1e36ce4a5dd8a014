//! A tool stays on the side of an open surface it came from, however the surface moves; it changes
//! sides round the rim.

use crate::common::{Laws as _, World};
use palpate_geometry::math::{Point3, Random, Vector3};
use palpate_geometry::surface::ClosestSolver;
use palpate_sim::tick::flags;

const SHEET: &str = include_str!("../../../../scenes/sheet.toml");
const VESSEL: &str = include_str!("../../../../scenes/vessel.toml");
/// A coupling that holds the tool to the device, and a device that bears everything.
const RIGID: &str = "coupling = { stiffness_n_m = inf, damping_n_s_m = 0.0 }\n\
                     device = { force_max_n = 1e9, ramp_s = 0.0 }\n";

fn vessel() -> String {
    VESSEL.replace("vessel.json", "../../scenes/vessel.json")
}

/// A hand's way from 0 to 1 in a time: quintic, at rest at both ends.
fn ramp(t_s: f64, from_s: f64, for_s: f64) -> f64 {
    let x = ((t_s - from_s) / for_s).clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}

/// In from a centimetre away and out again, twice a second; m past the surface at rest.
fn tap(t_s: f64, depth_m: f64) -> f64 {
    let t_s = t_s % 0.5;
    (depth_m + 0.01) * (ramp(t_s, 0.1, 0.12) - ramp(t_s, 0.25, 0.12)) - 0.01
}

/// In from a centimetre away, held, out again, in four seconds; m past the surface at rest.
fn press(t_s: f64, depth_m: f64) -> f64 {
    let t_s = t_s % 4.0;
    (depth_m + 0.01) * (ramp(t_s, 0.5, 1.0) - ramp(t_s, 2.5, 1.0)) - 0.01
}

/// In and out again at a speed; m past the surface at rest.
fn triangle(t_s: f64, depth_m: f64, speed_m_s: f64) -> f64 {
    depth_m - (speed_m_s * t_s - 0.01 - depth_m).abs()
}

/// What a motion felt.
#[derive(Debug, Default)]
struct Felt {
    /// Ticks that pulled the tool in.
    pulls: usize,
    /// Greatest pull, N.
    pull_n: f64,
    /// Greatest push, N.
    push_n: f64,
    /// Ticks with a force while the tool is more than 5 mm clear of the surface at rest.
    caught: usize,
}

/// The first tool goes so deep (m past `touch` against `outward`) at each tick of 1 ms.
fn feel(
    text: &str,
    touch: Vector3,
    outward: Vector3,
    depth_m: impl Fn(f64) -> f64,
    ticks: usize,
) -> Felt {
    let mut world = World::new(text);
    let mut felt = Felt::default();
    for k in 0..ticks {
        let depth = depth_m(k as f64 * 1e-3);
        let out = world.at_in_place((touch - outward * depth).into());
        assert!(out.fault.is_none(), "tick {k}: {:?}", out.fault);
        let tool = out.tools[0];
        let push = tool.contact_force_n.dot(&outward);
        felt.pulls += usize::from(push < -1e-6);
        felt.pull_n = felt.pull_n.max(-push);
        felt.push_n = felt.push_n.max(push);
        felt.caught += usize::from(depth < -0.005 && tool.contact_force_n.norm() > 1e-9);
    }
    felt
}

#[track_caller]
fn never_pulled(name: &str, felt: &Felt) {
    println!("{name}: {felt:?}");
    assert!(felt.push_n > 0.01, "{name}: it never touched: {felt:?}");
    assert!(
        felt.pulls == 0 && felt.caught == 0,
        "{name}: pulled in: {felt:?}"
    );
}

/// Sheet and vessel, with the coupling of the scene and a rigid one.
fn couplings(text: &str) -> [(String, &'static str); 2] {
    [
        (text.to_owned(), "soft coupling"),
        (format!("{text}{RIGID}"), "rigid coupling"),
    ]
}

#[test]
fn taps_on_a_soft_sheet_never_pull_in() {
    for (text, coupling) in couplings(SHEET) {
        for depth in [0.003, 0.006] {
            let felt = feel(
                &text,
                Vector3::zeros(),
                Vector3::z(),
                |t| tap(t, depth),
                2_000,
            );
            never_pulled(&format!("sheet, tap {depth} m, {coupling}"), &felt);
        }
    }
}

#[test]
fn a_tool_that_left_a_soft_sheet_feels_nothing() {
    for (text, coupling) in couplings(SHEET) {
        for (depth, speed) in [(0.003, 0.02), (0.003, 0.1), (0.008, 0.3)] {
            let way = |t: f64| triangle(t, depth, speed);
            let ticks = ((0.05 + depth) / speed * 1e3) as usize;
            let felt = feel(&text, Vector3::zeros(), Vector3::z(), way, ticks);
            never_pulled(
                &format!("sheet, {depth} m at {speed} m/s, {coupling}"),
                &felt,
            );
        }
    }
}

#[test]
fn presses_and_taps_on_a_vessel_never_pull_in() {
    let touch = Vector3::new(0.0, -0.02, -0.03);
    for (text, coupling) in couplings(&vessel()) {
        let felt = feel(&text, touch, -Vector3::y(), |t| press(t, 0.003), 4_000);
        never_pulled(&format!("vessel, press, {coupling}"), &felt);
        let felt = feel(&text, touch, -Vector3::y(), |t| tap(t, 0.003), 1_000);
        never_pulled(&format!("vessel, tap, {coupling}"), &felt);
    }
}

/// A number between 0 and 1; the same sequence on every machine.
fn random(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64
}

// Poked in random places, as fast as 0.6 m/s and 12 mm deep, and left while it still swings.
#[test]
fn random_pokes_with_any_tool_never_pull_in() {
    let shapes = [
        "point = {}",
        "sphere = { radius_m = 0.004 }",
        "cone = { half_angle_rad = 0.3, height_m = 0.02 }",
    ];
    for (text, coupling) in couplings(SHEET) {
        for (n, shape) in shapes.into_iter().enumerate() {
            let text = text.replace("point = {} }", &format!("{shape} }}"));
            let mut world = World::new(&text);
            let mut seed = 11 + n as u64;
            let mut from = [0.0, 0.0, 0.03];
            let (mut low_n, mut high_n) = (0.0_f64, 0.0_f64);
            for poke in 0..if n == 2 { 8 } else { 40 } {
                // In, then out.
                let aim = [
                    0.06 * (random(&mut seed) - 0.5),
                    0.06 * (random(&mut seed) - 0.5),
                ];
                let depths = [-0.012 * random(&mut seed), 0.006 + 0.02 * random(&mut seed)];
                for z in depths {
                    let to = [aim[0], aim[1], z + if n == 1 { 0.004 } else { 0.0 }];
                    let for_s = 0.05 + 0.1 * random(&mut seed);
                    let ticks = (for_s * 1e3) as usize;
                    for k in 1..=ticks {
                        let share = ramp(k as f64 / ticks as f64, 0.0, 1.0);
                        let place = [0, 1, 2].map(|c| from[c] + (to[c] - from[c]) * share);
                        let force = world.at_in_place(place).tools[0].contact_force_n;
                        (low_n, high_n) = (low_n.min(force.z), high_n.max(force.z));
                        assert!(
                            force.z > -1e-6,
                            "{shape}, {coupling}, poke {poke}, at {place:?}: {force} N"
                        );
                    }
                    from = to;
                }
            }
            println!("{shape}, {coupling}: {low_n} to {high_n} N");
            assert!(high_n > 0.1, "{shape}, {coupling}: at most {high_n} N");
        }
    }
}

/// The sheet, 0.1 m wide at z = 0, standing still.
fn rigid_sheet(shape: &str) -> String {
    format!(
        "[[body]]\nid = \"sheet\"\nsurface = {{ builtin = \"sheet\", net = [8, 8], size = 0.1 }}\n\
         [[tool]]\nid = \"pen\"\nshape = {{ {shape} }}\npose = {{ position = [0.0, 0.0, 0.03] }}\n\
         coupling = {{ stiffness_n_m = 500.0, damping_n_s_m = 0.0 }}\n\
         device = {{ force_max_n = 1e9, ramp_s = 0.0 }}\n"
    )
}

/// The tool goes straight from place to place at a speed; the force at each tick.
fn walk(world: &mut World, places: &[[f64; 3]], speed_m_s: f64) -> Vec<Vector3> {
    let mut forces = Vec::new();
    for pair in places.windows(2) {
        let [a, b] = [Vector3::from(pair[0]), Vector3::from(pair[1])];
        let ticks = ((b - a).norm() / (speed_m_s * 1e-3)).ceil();
        for k in 1..=ticks as usize {
            let place = a + (b - a) * (k as f64 / ticks);
            forces.push(world.at_in_place(place.into()).tools[0].contact_force_n);
        }
    }
    forces
}

const TOOLS: [(&str, f64); 3] = [
    ("point = {}", 0.0),
    ("sphere = { radius_m = 0.004 }", 0.004),
    ("ellipsoid = { semi_axes_m = [0.004, 0.004, 0.004] }", 0.004),
];

#[test]
fn a_tool_that_went_round_the_rim_is_held_from_the_other_side() {
    for (shape, radius_m) in TOOLS {
        for speed in [0.05, 0.5, 2.0] {
            let mut world = World::new(&rigid_sheet(shape));
            let (above, below) = (0.01, -0.01);
            let round = [
                [0.0, 0.0, above],
                [0.07, 0.0, above],
                [0.07, 0.0, below],
                [0.0, 0.0, below],
            ];
            let free = walk(&mut world, &round, speed);
            let touched = free.iter().filter(|force| force.norm() > 0.0).count();
            assert_eq!(touched, 0, "{shape} at {speed} m/s: held on its way round");
            let pressed = [round[3], [0.0, 0.0, 0.002 - radius_m]];
            let force = *walk(&mut world, &pressed, 0.1).last().unwrap();
            let expected = Vector3::new(0.0, 0.0, -500.0 * 0.002);
            assert!(
                (force - expected).norm() < 1e-6,
                "{shape} at {speed} m/s: {force} N"
            );
        }
    }
}

#[test]
fn a_tool_that_is_pushed_over_the_rim_comes_free() {
    for (shape, radius_m) in TOOLS {
        let mut world = World::new(&rigid_sheet(shape));
        let z = radius_m - 0.001;
        let way = [[0.03, 0.0, 0.02], [0.03, 0.0, z], [0.07, 0.0, z]];
        let forces = walk(&mut world, &way, 0.05);
        let most = forces.iter().fold(0.0_f64, |most, force| most.max(force.z));
        assert!((most - 0.5).abs() < 1e-3, "{shape}: {most} N of 0.5 N");
        assert!(
            forces.iter().all(|force| force.norm() < 0.6),
            "{shape}: {forces:?}"
        );
        let last = forces.last().unwrap();
        assert_eq!(
            last.norm(),
            0.0,
            "{shape}: it hangs at the rim with {last} N"
        );
    }
}

/// Greatest depth behind the surface as it then is, m, and the force once all is at rest, N: the pen
/// goes down onto the sheet at a speed and stays for 0.3 s and as long as it takes.
fn plunge(text: &str, depth_m: f64, speed_m_s: f64) -> (f64, f64) {
    let mut world = World::new(text);
    let mut now = world.scene.rest_surface(0).unwrap().clone();
    let mut solver = ClosestSolver::new(&now);
    let (way, mut behind_m, mut end_n) = (0.02 + depth_m, 0.0_f64, 0.0);
    let ticks = (way / (speed_m_s * 1e-3)).ceil() as usize;
    for k in 0..ticks + 300 {
        let z = 0.02 - (speed_m_s * 1e-3 * k as f64).min(way);
        end_n = world.at_in_place([0.0, 0.0, z]).tools[0].contact_force_n.z;
        world
            .state
            .copy_net(&world.scene, 0, now.net_mut().points_mut());
        solver.net_changed();
        let foot = solver.closest(&now, &Point3::new(0.0, 0.0, z));
        // What a tip goes in beyond the net is no way through.
        behind_m = behind_m.max(-foot.signed_distance - world.state.pairs[0].sunk_m);
    }
    world.rest(
        |world| {
            end_n = world.at_in_place([0.0, 0.0, -depth_m]).tools[0]
                .contact_force_n
                .z
        },
        3_000,
    );
    (behind_m, end_n)
}

// At 1 m/s the sheet is thrown off, comes back, and meets the pen at several metres a second: more
// in a tick than the distance at which a contact becomes a row. What a continuum does of that is below.
#[test]
fn a_rigidly_held_pen_passes_no_soft_sheet_however_fast_it_comes() {
    let cone = "cone = { half_angle_rad = 0.3, height_m = 0.02 } }";
    let springs = SHEET.replace("continuum", "lattice");
    for (name, scene, tool, speeds) in [
        (
            "point on springs",
            &springs[..],
            "point = {} }",
            &[1.0, 3.0][..],
        ),
        ("cone on springs", &springs, cone, &[1.0, 3.0]),
        ("point", SHEET, "point = {} }", &[1.0]),
        ("cone", SHEET, cone, &[1.0]),
    ] {
        let text = format!("{scene}{RIGID}").replace("point = {} }", tool);
        for depth in [0.002, 0.01] {
            let (_, slow_n) = plunge(&text, depth, 0.2);
            for &speed in speeds {
                let (behind_m, end_n) = plunge(&text, depth, speed);
                println!(
                    "{name}, {depth} m at {speed} m/s: {behind_m} m behind, {end_n} N of {slow_n} N"
                );
                // Rows are tangent planes: what slides on them by what it moves in a tick is behind by the
                // square of that over twice the sheet's radius of curvature, here 0.1 m or more.
                let slid_m = speed * 1e-3;
                assert!(
                    behind_m < slid_m * slid_m / 0.2,
                    "{name}, {depth} m at {speed} m/s: {behind_m} m behind"
                );
                assert!(
                    (end_n / slow_n - 1.0).abs() < 0.01,
                    "{name}: {end_n} N, slowly {slow_n} N"
                );
            }
        }
    }
}

/// A free ball, 20 mm high, on a rigid open sheet under a plate that is held rigidly.
fn pressed_ball(layers: usize) -> String {
    format!(
        "[[body]]\nid = \"sheet\"\nsurface = {{ builtin = \"sheet\", net = [8, 8], size = 0.2 }}\n\
         [[body]]\nid = \"ball\"\nsurface = {{ builtin = \"sphere\", size = 0.01, net = [12, 12] }}\n\
         pose = {{ position = [0.003, 0.002, 0.0101] }}\nmodel = \"lattice\"\n\
         material = {{ young_pa = 20e3, density_kg_m3 = 1000.0, damping_s = 2e-3 }}\n\
         lattice = {{ layers = {layers}, refine = \"none\" }}\n\
         [[tool]]\nid = \"plate\"\nshape = {{ plane = {{ normal = [0.0, 0.0, -1.0] }} }}\n\
         pose = {{ position = [0.0, 0.0, 0.022] }}\n{RIGID}\
         [[contact]]\npair = [\"plate\", \"sheet\"]\nmethod = \"none\"\n"
    )
}

// At 3 m/s the pen strains cells of the continuum by more in a tick than a step may, and passes: not without a sign.
#[test]
fn a_pen_too_fast_for_a_sheet_gets_degraded_forces() {
    let mut world = World::new(&format!("{SHEET}{RIGID}"));
    let mut degraded = 0;
    for k in 0..10 {
        let output = world.at_in_place([0.0, 0.0, 0.02 - 3e-3 * f64::from(k)]);
        degraded += u32::from(output.tools[0].flags & flags::DEGRADED != 0);
    }
    assert!(degraded > 0, "{degraded} ticks are flagged");
}

// Crushed to 0.35 of its height, without friction: its surface folds, and beside a fold the far end of
// the sheet seems to lie inside it.
#[test]
fn a_free_ball_crushed_on_an_open_sheet_stays_there() {
    for layers in [2, 4] {
        for speed in [0.02, 0.2] {
            let mut world = World::new(&pressed_ball(layers));
            let mut now = world.scene.rest_surface(1).unwrap().clone();
            let (top, down) = (0.022, 0.015);
            let ticks = (down / (speed * 1e-3)) as usize;
            for k in 0..ticks + 300 {
                let z = top - (speed * 1e-3 * k as f64).min(down);
                world.at_in_place([0.0, 0.0, z]);
                world
                    .state
                    .copy_net(&world.scene, 1, now.net_mut().points_mut());
                let places =
                    (0..256).map(|n| now.point((n / 16) as f64 / 16.0, (n % 16) as f64 / 16.0));
                for place in places {
                    // Crushed to a third, 7 mm, it folds, and folds bulge between the rows by a millimetre; a ball
                    // that is passed is below by its height. Nothing holds it sideways, and the sheet ends at 0.1 m.
                    let out = place.z.min(z - place.z);
                    let aside = place.x.hypot(place.y);
                    assert!(
                        out > -2e-3 && aside < 0.08,
                        "{layers} layers at {speed} m/s, tick {k}, plate at {z}: {place}"
                    );
                }
            }
        }
    }
}

#[test]
fn no_tool_passes_a_rigid_sheet_however_fast_it_comes() {
    let cone = ("cone = { half_angle_rad = 0.3, height_m = 0.02 }", 0.0);
    for (shape, radius_m) in TOOLS.into_iter().chain([cone]) {
        for speed in [0.3, 1.0, 3.0, 7.0] {
            let mut world = World::new(&rigid_sheet(shape));
            let end = [0.013, 0.0, radius_m - 0.002];
            let forces = walk(&mut world, &[[0.01, 0.0, 0.03], end, end], speed);
            let mut force = *forces.last().unwrap();
            for _ in 0..5 {
                force = world.at_in_place(end).tools[0].contact_force_n;
            }
            let expected = Vector3::new(0.0, 0.0, 500.0 * 0.002);
            assert!(
                (force - expected).norm() < 1e-6,
                "{shape} at {speed} m/s: {force} N"
            );
        }
    }
}

// The loop stands still while a hand presses on an open sheet: the force is gone for that long, comes back by its ramp, and the
// tool is still above.
#[test]
fn a_loop_that_stalls_lets_no_tool_through_a_sheet() {
    for shape in [
        "{ point = {} }",
        "{ sphere = { radius_m = 0.002 } }",
        "{ ellipsoid = { semi_axes_m = [0.004, 0.003, 0.002] } }",
    ] {
        let mut world = World::new(&format!(
            "[[body]]\nid = \"sheet\"\nsurface = {{ builtin = \"sheet\", size = 0.1 }}\n[[tool]]\nid = \"t\"\nshape = {shape}\n\
             pose = {{ position = [0.0, 0.0, 0.03] }}\ncoupling = {{ stiffness_n_m = 1000.0 }}\n"
        ));
        let deep = [0.0, 0.0, -0.002];
        let way = |k: u32| [0.0, 0.0, 0.03 - 0.032 * f64::from(k) / 200.0];
        (1..=200).for_each(|k| drop(world.at(way(k))));
        let pressed = (0..50).map(|_| world.at(deep)).last().unwrap().tools[0];
        assert!(pressed.force_n.z > 1.9, "{shape}: {}", pressed.force_n);
        for skipped in [30, 60, 100, 10_000] {
            let first = world.late(skipped, deep).tools[0];
            let faded = skipped > 50 + 20;
            let share = first.force_n.norm() / pressed.force_n.norm();
            assert!(
                share <= 1.0 + 1e-9 && (!faded || share < 0.5),
                "{shape}, {skipped}: {share}"
            );
            let after = (0..50).map(|_| world.at(deep)).last().unwrap().tools[0];
            let change = (after.force_n - pressed.force_n).norm();
            assert!(
                change < 1e-6 * pressed.force_n.norm(),
                "{shape}, {skipped}: {}",
                after.force_n
            );
        }
    }
}

/// A gel ball of 20 mm just above the sheet of 0.1 m, at a place; nothing holds it.
fn ball_above_a_sheet(model: &str, at: [f64; 3]) -> String {
    let lattice = match model {
        "net" => "",
        "membrane" => "lattice = { thickness_m = 0.002, refine = \"none\" }",
        _ => "lattice = { layers = 3, refine = [10, 10] }",
    };
    format!(
        r#"
[gravity]
acceleration = [0, 0, -9.81]
[[body]]
id = "floor"
surface = {{ builtin = "sheet", size = 0.1 }}
[[body]]
id = "ball"
surface = {{ builtin = "sphere", size = 0.02 }}
model = "{model}"
pose = {{ position = {at:?} }}
material = {{ young_pa = 50e3, damping_s = 2e-3 }}
{lattice}
[[tool]]
id = "far"
shape = {{ point = {{}} }}
pose = {{ position = [5, 5, 5] }}
"#
    )
}

// What is closed has an inside and a sheet has none, so a ball that falls past the edge is pushed by how deep the edge
// is in the ball. Whatever it overlaps, it never has more energy than it began with.
#[test]
fn a_soft_ball_that_falls_past_the_edge_of_a_sheet_gains_nothing() {
    let mut random = Random(40);
    for model in ["lattice", "continuum", "net", "membrane"] {
        for case in 0..4 {
            let over_m = 1e-4 * (120.0_f64).powf(random.unit());
            let along_m = match case % 2 {
                0 => 0.06 * (random.unit() - 0.5),
                // Past the corner.
                _ => 0.05 + 0.015 * random.unit(),
            };
            let at = [0.05 + 0.02 - over_m, along_m, 0.0202];
            let mut world = World::new(&ball_above_a_sheet(model, at));
            let mut net =
                vec![Point3::origin(); world.scene.rest_surface(1).unwrap().net().points().len()];
            let mut last = world.centre(1, &mut net);
            let start = last;
            for k in 0..250 {
                let out = world.silent_in_place();
                assert!(out.fault.is_none(), "{model} {case}: {:?}", out.fault);
                let now = world.centre(1, &mut net);
                let speed = (now - last) * 1e3;
                last = now;
                let gained = 0.5 * speed.norm_squared() + 9.81 * (now.z - start.z);
                assert!(
                    gained < 1e-3,
                    "{model}, over by {over_m}: {gained} J/kg in tick {k}"
                );
            }
            // Those that graze fall on, below the sheet.
            assert!(
                over_m > 5e-3 || last.z < -0.1,
                "{model}, over by {over_m}: {last}"
            );
        }
    }
}

/// Round the rim at x = 0.05: from above the sheet to below it, at a distance from it.
fn round_the_rim(share: f64, away_m: f64) -> [f64; 3] {
    let (flat_m, bend_m) = (0.01, std::f64::consts::PI * away_m);
    let way_m = share * (2.0 * flat_m + bend_m);
    let (x, z) = if way_m < flat_m {
        (0.04 + way_m, away_m)
    } else if way_m < flat_m + bend_m {
        let angle = (way_m - flat_m) / away_m;
        (0.05 + away_m * angle.sin(), away_m * angle.cos())
    } else {
        (0.05 - (way_m - flat_m - bend_m), -away_m)
    };
    [x, 0.002, z]
}

// There and back again: what a hand is pushed away with, it gets back, and it is pushed away from the sheet all the way.
#[test]
fn a_ball_that_goes_round_the_rim_and_back_is_pushed_away_all_the_way() {
    for radius_m in [0.003, 0.01] {
        let text = format!(
            r#"
[[body]]
id = "floor"
surface = {{ builtin = "sheet", size = 0.1 }}
[[tool]]
id = "ball"
shape = {{ sphere = {{ radius_m = {radius_m} }} }}
pose = {{ position = [0.04, 0.002, 0.03] }}
coupling = {{ stiffness_n_m = 1000.0 }}
device = {{ ramp_s = 0.0, speed_max_m_s = 1e6, force_max_n = 100.0 }}
"#
        );
        let mut world = World::new(&text);
        let away_m = radius_m - 3e-4;
        for k in 0..200 {
            world.at([0.04, 0.002, 0.03 + (away_m - 0.03) * f64::from(k) / 199.0]);
        }
        let ticks = 4_000;
        let (mut work_j, mut along_j) = (0.0, 0.0);
        let mut last = Point3::from(round_the_rim(0.0, away_m));
        let mut before = Vector3::z() * 0.3;
        for k in 1..=2 * ticks {
            let share = f64::from(if k <= ticks { k } else { 2 * ticks - k }) / f64::from(ticks);
            let hand = Point3::from(round_the_rim(share, away_m));
            let force = world.at(hand.coords.into()).tools[0].contact_force_n;
            let foot = Point3::new(hand.x.min(0.05), hand.y, 0.0);
            let push_n = force.dot(&(hand - foot).normalize());
            assert!(
                (push_n - 0.3).abs() < 3e-3,
                "radius {radius_m}, tick {k} at {hand}: {force:?}"
            );
            work_j += 0.5 * (before + force).dot(&(hand - last));
            along_j += force.norm() * (hand - last).norm();
            (last, before) = (hand, force);
        }
        // The force is that of where the hand was a tick before, and on a bend turned by as much: that is lost, and
        // nothing gained.
        let turned = (last - Point3::from(round_the_rim(1.0 / f64::from(ticks), away_m))).norm();
        let lost_j = along_j * turned / away_m;
        assert!(
            work_j > -lost_j && work_j < 1e-9 * along_j,
            "{work_j} J of {along_j}, {lost_j}"
        );
    }
}
