//! Solids that are pressed fast, deep, suddenly and at random: forces on the way beside those of many iterations, which
//! end where the exact step does; and what comes of it afterwards.

use crate::common::{Laws as _, World};
use palpate_geometry::math::{Point3, Random};
use palpate_geometry::surface::ClosestSolver;
use palpate_sim::tick::flags::DEGRADED;

const SIDE_M: [f64; 2] = [0.003, 0.045];

/// Where a ball of 10 mm that comes along −x first touches the body, m.
fn touch_m(world: &World) -> f64 {
    let surface = world.scene.rest_surface(0).unwrap();
    let mut solver = ClosestSolver::new(surface);
    let (mut inside, mut outside) = (0.0, 0.1);
    for _ in 0..50 {
        let x = 0.5 * (inside + outside);
        let foot = solver.closest(surface, &Point3::new(x, SIDE_M[0], SIDE_M[1]));
        match foot.signed_distance > 0.01 {
            true => outside = x,
            false => inside = x,
        }
    }
    outside
}

/// The teardrop of the specification's table and a ball of 10 mm that nothing holds back, with nothing but the net.
fn scene(model: &str, poisson: f64, damping_s: f64, iterations: usize, tool: &str) -> String {
    let lattice = match model {
        "net" => "layers = 3, refine = [12, 13]",
        _ => "layers = 3, refine = \"none\"",
    };
    format!(
        r#"
[[body]]
id = "drop"
surface = {{ builtin = "teardrop", net = [8, 8] }}
model = "{model}"
material = {{ young_pa = 20e3, poisson = {poisson:?}, damping_s = {damping_s:?} }}
lattice = {{ {lattice} }}
integrator = {{ iterations = {iterations} }}
fixed = [{{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }}]
[[tool]]
id = "ball"
shape = {{ capsule = {{ radius_m = 0.01, half_length_m = 1e-7 }} }}
pose = {{ position = [0.06, 0.003, 0.045] }}
{tool}
[[contact]]
pair = ["ball", "drop"]
near_field = false
"#
    )
}

const HELD: &str = "coupling = { stiffness_n_m = inf, damping_n_s_m = 0.0 }\n\
                    device = { force_max_n = 1e9, ramp_s = 0.0, speed_max_m_s = 1e6 }";

/// Force along x, N, in each tick of a press at a speed to a depth that is then held, and whether it is flagged as
/// degraded.
fn pressed(world: &mut World, speed_m_s: f64, depth_m: f64) -> Vec<(f64, bool)> {
    let touch = touch_m(world);
    let (from, to) = (touch + 1e-3, touch - depth_m);
    let ticks = ((from - to) / (speed_m_s * 1e-3)).ceil() as usize + 100;
    let place = |k: usize| (from - speed_m_s * 1e-3 * k as f64).max(to);
    (0..ticks)
        .map(|k| {
            let tool = &world.at([place(k), SIDE_M[0], SIDE_M[1]]).tools[0];
            (tool.force_n.x, tool.flags & DEGRADED != 0)
        })
        .collect()
}

fn peak(forces: &[(f64, bool)]) -> f64 {
    forces
        .iter()
        .fold(0.0, |most: f64, (f, _)| most.max(f.abs()))
}

/// Of the ticks that count.
fn rms(given: &[(f64, bool)], exact: &[(f64, bool)], counts: impl Fn(&(f64, bool)) -> bool) -> f64 {
    let off = (given.iter().zip(exact))
        .filter(|(given, _)| counts(given))
        .map(|((a, _), (b, _))| (a - b) * (a - b));
    (off.sum::<f64>() / exact.len() as f64).sqrt() / peak(exact)
}

// What an iteration leaves does not grow with λ: 0.499 has 500 times μ.
#[test]
fn a_fast_press_is_right_after_one_iteration_whatever_the_compressibility() {
    for (model, poisson) in [
        ("continuum", 0.0),
        ("continuum", 0.3),
        ("continuum", 0.49),
        ("continuum", 0.499),
        ("net", 0.3),
        ("net", 0.49),
        ("net", 0.499),
    ] {
        let forces = |iterations: usize, depth_m: f64| {
            let mut world = World::new(&scene(model, poisson, 2e-3, iterations, HELD));
            pressed(&mut world, 0.2, depth_m)
        };
        for (depth_m, most_end) in [(4e-3, 0.015), (1e-2, 0.03)] {
            let exact = forces(12, depth_m);
            for iterations in [1, 2] {
                let given = forces(iterations, depth_m);
                let off = rms(&given, &exact, |_| true);
                let quiet = rms(&given, &exact, |(_, flagged)| !flagged);
                let flagged = given.iter().filter(|(_, flagged)| *flagged).count();
                let end = given.last().unwrap().0 / exact.last().unwrap().0 - 1.0;
                println!(
                    "{model} {poisson}, {depth_m} m, {iterations} it: rms {:.2} % (not flagged {:.2}), end {:+.2} %, peak {:.3} N, \
                     {flagged} flagged",
                    100.0 * off,
                    100.0 * quiet,
                    100.0 * end,
                    peak(&given)
                );
                // Two iterations of a nearly incompressible net that is pressed so deep strain its smallest cells by more
                // than a step may: it is shortened, and off by 5 %.
                let shortened =
                    model == "net" && poisson > 0.49 && iterations == 2 && depth_m > 5e-3;
                let (most, most_end) = if shortened {
                    (0.05, 0.05)
                } else {
                    (0.02, most_end)
                };
                // The ball stops within a tick, and what it pressed flies on: a net takes a firmer matrix then, and says so.
                let most_all = if model == "net" { most + 0.01 } else { most };
                let most_flagged = given.len() / 6;
                assert!(
                    quiet < most
                        && off < most_all
                        && end.abs() < most_end
                        && flagged <= most_flagged,
                    "{model} {poisson} {iterations}: {off} {end} {flagged}"
                );
            }
        }
    }
}

// Into the body by 7 mm from one tick to the next.
#[test]
fn a_jump_into_a_body_stays_finite_and_it_comes_back() {
    for poisson in [0.3, 0.49, 0.499] {
        for iterations in [1, 2] {
            let mut world = World::new(&scene("continuum", poisson, 2e-3, iterations, HELD));
            let rest = world.state.coordinates(0).unwrap().to_vec();
            let (mut most, mut last, touch) = (0.0_f64, 0.0, touch_m(&world));
            world.at([touch + 1e-3, SIDE_M[0], SIDE_M[1]]);
            for _ in 0..300 {
                let output = world.at([touch - 7e-3, SIDE_M[0], SIDE_M[1]]);
                assert!(output.fault.is_none());
                last = output.tools[0].force_n.x;
                most = most.max(last);
            }
            let mut apart = 0.0;
            for _ in 0..1500 {
                world.at([0.2, 0.0, 0.0]);
            }
            for (a, b) in world.state.coordinates(0).unwrap().iter().zip(&rest) {
                apart = (a - b).norm().max(apart);
            }
            println!(
                "{poisson}, {iterations} it: most {most:.2} N, held {last:.3} N, back to {apart:.1e} m"
            );
            assert!(most < 50.0 && last > 0.1 && apart < 1e-3);
        }
    }
}

/// Farthest coordinate from rest half a second, one and one and a half after three seconds of random pokes, m.
fn poked(model: &str, poisson: f64, damping_s: f64, iterations: usize, seed: u64) -> [f64; 3] {
    let tool = "coupling = { stiffness_n_m = 1000.0 }\n\
                device = { force_max_n = 20.0, ramp_s = 0.0, speed_max_m_s = 1e6 }";
    let mut world = World::new(&scene(model, poisson, damping_s, iterations, tool));
    let rest = world.state.coordinates(0).unwrap().to_vec();
    let mut random = Random(seed);
    let touch = touch_m(&world);
    let (mut x, mut side, mut speed) = (touch + 2e-3, SIDE_M, 0.2);
    let mut inwards = true;
    for _ in 0..3000 {
        x += if inwards { -1e-3 } else { 1e-3 } * speed;
        if x < touch - 12e-3 || x > touch + 4e-3 {
            inwards = x > touch;
            speed = random.float(0.05, 0.5);
            let jump = random.vector() * 6e-3;
            side = [SIDE_M[0] + jump.x, SIDE_M[1] + jump.y];
        }
        let output = world.at([x, side[0], side[1]]);
        assert!(
            output.fault.is_none(),
            "{model} {poisson}: {:?}",
            output.fault
        );
    }
    [500; 3].map(|ticks| {
        for _ in 0..ticks {
            world.at([0.3, 0.0, 0.0]);
        }
        let now = world.state.coordinates(0).unwrap();
        let apart = now.iter().zip(&rest).map(|(a, b)| (a - b).norm());
        apart.fold(0.0, f64::max)
    })
}

// Swings of 0.3 have fallen to a tenth of a millimetre by then.
#[test]
fn what_was_poked_at_random_comes_back_to_rest() {
    for (model, poisson, damping_s, iterations) in [
        ("continuum", 0.3, 2e-3, 1),
        ("continuum", 0.499, 2e-3, 1),
        ("continuum", 0.499, 2e-3, 2),
        ("continuum", 0.49, 0.0, 1),
        ("continuum", 0.49, 5e-3, 2),
        ("continuum", 0.49, 2e-2, 1),
        ("net", 0.49, 2e-3, 1),
        ("net", 0.49, 2e-3, 2),
    ] {
        let apart = poked(model, poisson, damping_s, iterations, 5);
        println!("{model} {poisson}, d {damping_s} s, {iterations} it: {apart:?} m");
        let most = if damping_s > 0.0 { 1e-3 } else { 5e-3 };
        assert!(
            apart[2] < most,
            "{model} {poisson} {damping_s} {iterations}: {apart:?}"
        );
    }
}

// A gel ball on a floor under a ball of 0.2 m.
#[test]
fn a_gel_ball_that_is_squeezed_and_held_is_still() {
    let each = [0.3, 0.49, 0.499].map(|poisson| [(poisson, 0.024), (poisson, 0.04)]);
    for (poisson, depth_m) in each.into_iter().flatten() {
        let mut world = World::new(&format!(
            r#"
[[body]]
id = "gel"
surface = {{ builtin = "sphere", size = 0.04 }}
model = "continuum"
material = {{ young_pa = 20e3, poisson = {poisson:?}, damping_s = 2e-3 }}
lattice = {{ layers = 3, refine = "none" }}
fixed = [{{ point = [0.0, 0.0, -0.03], normal = [0.0, 0.0, 1.0] }}]
[[tool]]
id = "ball"
shape = {{ sphere = {{ radius_m = 0.2 }} }}
pose = {{ position = [0.0, 0.0, 0.245] }}
{HELD}
"#
        ));
        let top = 0.04 + 0.2;
        let mut forces = Vec::new();
        for k in 0..1500 {
            let depth = (depth_m * k as f64 / 1000.0).min(depth_m);
            let output = world.at([0.0, 0.0, top + 1e-3 - depth]);
            assert!(output.fault.is_none());
            forces.push(output.tools[0].force_n.z);
        }
        let held = &forces[1400..];
        let step = held
            .windows(2)
            .fold(0.0, |most: f64, f| most.max((f[1] - f[0]).abs()));
        let nodes = world.state.bodies[0].deformable.as_ref().unwrap();
        let speed = nodes
            .velocities
            .iter()
            .fold(0.0, |most: f64, v| most.max(v.norm()));
        println!(
            "{poisson}, {depth_m} m: {:.3} N, steps {:.1e} of it, nodes {speed:.1e} m/s",
            held[0],
            step / held[0]
        );
        assert!(
            step < 1e-3 * held[0] && speed < 1e-3,
            "{poisson}: {step} N, {speed} m/s"
        );
    }
}
