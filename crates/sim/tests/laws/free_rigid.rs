//! Free rigid bodies: flight, tumbling, rolling, rest, and what tools do to them.

use crate::common::{Laws as _, World, pose};
use palpate_geometry::math::{Point3, SavedState, Vector3, state_hash};
use palpate_geometry::surface::{builtin, file};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::file as scene_file;
use palpate_sim::tick::{RigidMotion, restore};
use std::path::Path;

const FAR: [f64; 3] = [0.0, 0.0, 5.0];
const G: f64 = 9.81;
const DT: f64 = 1e-3;

/// A scene with a far tool, gravity along −z turned about y, and what is said.
fn world(slope_rad: f64, bodies: &str) -> World {
    World::new(&format!(
        "[gravity]\nacceleration = [{:?}, 0.0, {:?}]\n{bodies}\n[[tool]]\nid = \"far\"\nshape = {{ point = {{}} }}\n\
         pose = {{ position = {FAR:?} }}\n",
        G * libm::sin(slope_rad),
        -G * libm::cos(slope_rad)
    ))
}

/// A ball of 20 mm radius.
fn ball(z: f64, more: &str) -> String {
    format!(
        "[[body]]\nid = \"ball\"\nsurface = {{ builtin = \"sphere\", net = [24, 15], size = 0.02 }}\n\
         pose = {{ position = [0.0, 0.0, {z:?}] }}\nfree = true\nmaterial = {{ density_kg_m3 = 1000.0 }}\n{more}\n"
    )
}

/// A builtin sphere of 20 mm, stretched; its file must live as long as the text is used.
fn ellipsoid(stretch: [f64; 3], more: &str) -> (tempfile::TempDir, String) {
    let mut surface = builtin("sphere", None, Some(0.02)).unwrap();
    for p in surface.net_mut().points_mut() {
        *p = Point3::new(p.x * stretch[0], p.y * stretch[1], p.z * stretch[2]);
    }
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("stone.json");
    std::fs::write(&path, file::write(&surface, file::Unit::Metre)).unwrap();
    let text = format!(
        "[[body]]\nid = \"stone\"\nsurface = {{ file = {path:?} }}\nfree = true\nmaterial = {{ density_kg_m3 = 1000.0 }}\n{more}\n"
    );
    (directory, text)
}

const FLOOR: &str = "[[body]]\nid = \"floor\"\nsurface = { builtin = \"sheet\", size = 4.0 }\n";

fn rub(a: &str, b: &str, mu: f64) -> String {
    format!("[[contact]]\npair = [\"{a}\", \"{b}\"]\nfriction = {{ mu = {mu:?} }}\n")
}

fn motion(world: &World, body: usize) -> RigidMotion {
    world.state.rigid_motion(&world.scene, body).unwrap()
}

fn run(world: &mut World, ticks: usize) {
    for _ in 0..ticks {
        world.at_in_place(FAR);
    }
}

#[test]
fn a_thrown_body_flies_as_symplectic_euler_says() {
    let mut world = world(
        0.0,
        &ball(
            0.0,
            "velocity_m_s = [1.0, 0.0, 2.0]\nspin_rad_s = [0.0, 30.0, 0.0]",
        ),
    );
    let start = motion(&world, 0);
    let n = 1_000;
    run(&mut world, n);
    let now = motion(&world, 0);
    let steps = n as f64;
    let fallen = G * DT * DT * 0.5 * steps * (steps + 1.0);
    let expected =
        start.centre + Vector3::new(1.0, 0.0, 2.0) * (steps * DT) - Vector3::z() * fallen;
    let off = (now.centre - expected).norm();
    assert!(off < 1e-12, "{} for {expected}: {off:e}", now.centre);
    assert_eq!(now.momentum, start.momentum);
    let vz = 2.0 - G * steps * DT;
    assert!((now.velocity_m_s - Vector3::new(1.0, 0.0, vz)).norm() < 1e-12);
    // The net is where the motion says.
    let rest = world.scene.rest_surface(0).unwrap().net().points();
    let mut net = rest.to_vec();
    world.state.copy_net(&world.scene, 0, &mut net);
    for (p, rest) in net.iter().zip(rest) {
        let (now_m, then_m) = ((p - now.centre).norm(), (rest - start.centre).norm());
        assert!((now_m - then_m).abs() < 1e-12 && (p - rest).norm() > 1.0);
    }
}

// 10 s about the middle axis, a little off: it flips over and over (Ashbaugh, Chicone and Cushman 1991).
#[test]
fn a_tumbling_body_keeps_its_momenta_and_its_energy_and_flips() {
    let (_file, text) = ellipsoid(
        [1.6, 1.0, 0.6],
        "velocity_m_s = [0.1, 0.0, 0.0]\nspin_rad_s = [0.01, 20.0, 0.02]",
    );
    let mut world = World::new(&format!(
        "{text}\n[[tool]]\nid = \"far\"\nshape = {{ point = {{}} }}\npose = {{ position = {FAR:?} }}\n"
    ));
    let start = motion(&world, 0);
    let (mut worst, mut flips, mut up) = (0.0f64, 0, true);
    let axis = world.scene.rest_surface(0).unwrap().net().points().to_vec();
    let far = (0..axis.len())
        .max_by(|&a, &b| axis[a].y.total_cmp(&axis[b].y))
        .unwrap();
    for _ in 0..10_000 {
        world.at_in_place(FAR);
        let now = motion(&world, 0);
        worst = worst.max((now.energy_j / start.energy_j - 1.0).abs());
        assert_eq!(now.momentum, start.momentum);
        assert_eq!(now.velocity_m_s, start.velocity_m_s);
        let there = world.state.carried_point(&world.scene, 0, &axis[far]) - now.centre;
        let along = there.y / (axis[far].y - start.centre.y);
        if (along < -0.8 && up) || (along > 0.8 && !up) {
            (flips, up) = (flips + 1, !up);
        }
    }
    println!("tumbling: energy off by {worst:e}, {flips} flips");
    assert!(worst < 1e-3, "energy off by {worst:e}");
    assert!(flips >= 3, "{flips} flips");
    let off = motion(&world, 0).centre - start.centre - Vector3::new(1.0, 0.0, 0.0);
    assert!(off.norm() < 1e-10, "{off}");
}

#[test]
fn a_spinning_body_loses_nothing_of_its_spin() {
    let spin = 20.0 * std::f64::consts::PI;
    let (_file, text) = ellipsoid(
        [1.0, 1.0, 0.4],
        &format!("spin_rad_s = [0.0, 0.0, {spin:?}]"),
    );
    let mut world = World::new(&format!(
        "{text}\n[[tool]]\nid = \"far\"\nshape = {{ point = {{}} }}\npose = {{ position = {FAR:?} }}\n"
    ));
    let mark = world.scene.rest_surface(0).unwrap().net().points()[40];
    run(&mut world, 1_000);
    let now = motion(&world, 0);
    assert!(
        (now.spin_rad_s.z / spin - 1.0).abs() < 1e-9,
        "{}",
        now.spin_rad_s
    );
    // Ten turns later every point is back.
    let back = world.state.carried_point(&world.scene, 0, &mark);
    assert!((back - mark).norm() < 1e-5, "{}", (back - mark).norm());
}

#[test]
fn a_ball_on_a_slope_rolls_or_slides_as_coulomb_says() {
    for (degrees, mu) in [(10.0f64, 0.5), (30.0, 0.1)] {
        let slope = degrees.to_radians();
        let text = format!("{FLOOR}{}{}", ball(0.02, ""), rub("ball", "floor", mu));
        let mut world = world(slope, &text);
        run(&mut world, 100);
        let (before, first) = (motion(&world, 1), 100.0 * DT);
        run(&mut world, 300);
        let now = motion(&world, 1);
        let acceleration = (now.velocity_m_s.x - before.velocity_m_s.x) / 0.3;
        let rolls = mu > 2.0 / 7.0 * libm::tan(slope);
        let expected = match rolls {
            true => G * libm::sin(slope) * 5.0 / 7.0,
            false => G * (libm::sin(slope) - mu * libm::cos(slope)),
        };
        // Where it touches: 0 while it rolls.
        let slip = now.velocity_m_s.x - 0.02 * now.spin_rad_s.y;
        println!(
            "{degrees} degrees, mu {mu}: {acceleration} m/s2 for {expected}, slip {slip:e} m/s, z {} after {first} s",
            now.centre.z
        );
        assert!(
            (acceleration / expected - 1.0).abs() < 0.02,
            "{acceleration} for {expected}"
        );
        assert_eq!(rolls, slip.abs() < 0.01 * now.velocity_m_s.x, "slip {slip}");
        assert!((now.centre.z - 0.02).abs() < 2e-4, "{}", now.centre.z);
    }
}

// A ring on a slope below the angle of friction stays where it is, and is left alone.
#[test]
fn a_ring_that_friction_holds_lies_still_without_creep() {
    let mut world = world(
        libm::atan(0.15),
        &format!(
            "{FLOOR}[[body]]\nid = \"ring\"\nsurface = {{ builtin = \"torus\", size = 0.03 }}\nfree = true\n\
             pose = {{ position = [0.0, 0.0, 0.0121] }}\nmaterial = {{ density_kg_m3 = 1000.0 }}\n{}",
            rub("ring", "floor", 0.3)
        ),
    );
    let ticks = (0..3_000).find(|_| {
        world.at_in_place(FAR);
        world.state.is_left_alone(1)
    });
    let lay = motion(&world, 1);
    println!("left alone after {ticks:?} ticks at {}", lay.centre);
    run(&mut world, 500);
    let now = motion(&world, 1);
    let force = world.scratch.contact_force_on(1);
    let weight = now.mass_kg * G;
    println!(
        "carried with {force} N of {weight}, speed {:e}",
        now.velocity_m_s.norm()
    );
    assert!(
        (force.norm() / weight - 1.0).abs() < 1e-3,
        "{force} N for {weight}"
    );
    assert!(
        (now.centre - lay.centre).norm() < 1e-7,
        "crept {}",
        (now.centre - lay.centre).norm()
    );
    assert!(ticks.is_some(), "it never came to rest");

    // A pen comes and pushes it up the slope.
    let felt = (0..600)
        .map(|k| {
            let x = now.centre.x + 0.06 - 5e-5 * f64::from(k);
            world.at([x, 0.0, 0.012]).tools[0].force_n.x
        })
        .fold(0.0, f64::max);
    let moved = motion(&world, 1).centre - now.centre;
    println!("pushed with {felt} N by {moved}");
    assert!(felt > 0.2 && moved.x < -5e-3, "{felt} N, {moved}");
}

fn bouncing(a: &str, b: &str, restitution: f64) -> String {
    format!("[[contact]]\npair = [\"{a}\", \"{b}\"]\nrestitution = {restitution:?}\n")
}

/// Energy of a body above a floor at z = 0 that symplectic Euler keeps in flight, J; `rest_m` is the height of
/// its centre on the floor.
fn kept_energy(world: &World, body: usize, rest_m: f64) -> f64 {
    let now = motion(world, body);
    let height = now.centre.z - rest_m - 0.5 * DT * now.velocity_m_s.z;
    now.energy_j + now.mass_kg * G * height
}

// What is dropped keeps the square of its restitution of the energy at each bounce, and rests in the end.
#[test]
fn a_ball_bounces_with_its_restitution_and_comes_to_rest() {
    for restitution in [0.2, 0.5, 0.9, 1.0] {
        let text = format!(
            "{FLOOR}{}{}",
            ball(0.12, ""),
            bouncing("floor", "ball", restitution)
        );
        let mut world = world(0.0, &text);
        let (mut falls, mut before, mut kept) = (0.0f64, kept_energy(&world, 1, 0.02), Vec::new());
        for _ in 0..4_000 {
            world.at_in_place(FAR);
            let (speed, now) = (
                motion(&world, 1).velocity_m_s.z,
                kept_energy(&world, 1, 0.02),
            );
            if falls < -0.1 && speed > 0.0 {
                kept.push((now, before));
            }
            (falls, before) = (speed, now);
        }
        // As a height.
        let weight_n = motion(&world, 1).mass_kg * G;
        let off = kept
            .iter()
            .map(|(now, before)| (now - before * restitution * restitution).abs() / weight_n);
        let off = off.fold(0.0, f64::max);
        let now = motion(&world, 1);
        println!(
            "restitution {restitution}: {} bounces, energy off by {off:e} m of height, at the end {} m/s at {} m",
            kept.len(),
            now.velocity_m_s.z,
            now.centre.z
        );
        // As far as rows know where the surfaces are.
        assert!(!kept.is_empty() && off < 2e-8, "{kept:?}");
        // It may roll.
        let rests = now.velocity_m_s.z.abs() < 1e-9 && (now.centre.z - 0.02).abs() < 1e-6;
        assert_eq!(rests, restitution < 0.95, "{restitution}: {now:?}");
    }
}

// A ball that hits an equal one at rest: they part with the share of the speed, and keep the momentum.
#[test]
fn two_balls_part_with_the_restitution_of_their_pair() {
    for restitution in [0.0, 0.3, 1.0] {
        let second = ball(0.0, "").replace("\"ball\"", "\"other\"");
        let mut world = World::new(&format!(
            "{}{}{}[[tool]]\nid = \"far\"\nshape = {{ point = {{}} }}\npose = {{ position = {FAR:?} }}\n",
            ball(0.0, "velocity_m_s = [1.0, 0.0, 0.0]"),
            second.replace("[0.0, 0.0, 0.0]", "[0.0605, 0.0, 0.0]"),
            bouncing("ball", "other", restitution)
        ));
        run(&mut world, 100);
        let speeds = [0, 1].map(|body| motion(&world, body).velocity_m_s.x);
        let expected = [0.5 * (1.0 - restitution), 0.5 * (1.0 + restitution)];
        println!("restitution {restitution}: {speeds:?} for {expected:?}");
        for (speed, expected) in speeds.iter().zip(expected) {
            assert!(
                (speed - expected).abs() < 1e-9,
                "{speeds:?} for {expected:?}"
            );
        }
    }
}

// Off centre and with friction: what one gets the other loses.
#[test]
fn two_free_bodies_keep_their_momenta_together() {
    let (_file, text) = ellipsoid(
        [1.6, 1.0, 0.6],
        "velocity_m_s = [0.5, 0.0, 0.0]\nspin_rad_s = [5.0, 10.0, 3.0]",
    );
    let mut world = World::new(&format!(
        "{text}{}{}[[tool]]\nid = \"far\"\nshape = {{ point = {{}} }}\npose = {{ position = {FAR:?} }}\n",
        ball(0.0, "").replace("[0.0, 0.0, 0.0]", "[0.07, 0.012, 0.006]"),
        rub("stone", "ball", 0.4)
    ));
    let whole = |world: &World| {
        let bodies = [motion(world, 0), motion(world, 1)];
        let linear: Vector3 = bodies.iter().map(|m| m.velocity_m_s * m.mass_kg).sum();
        let angular: Vector3 = (bodies.iter())
            .map(|m| m.momentum + m.centre.coords.cross(&(m.velocity_m_s * m.mass_kg)))
            .sum();
        (linear, angular, bodies[0].energy_j + bodies[1].energy_j)
    };
    let start = whole(&world);
    let mut touched = 0;
    for _ in 0..150 {
        touched += usize::from(!world.at_in_place(FAR).contacts.list().is_empty());
    }
    let now = whole(&world);
    let off = [
        (now.0 - start.0).norm() / start.0.norm(),
        (now.1 - start.1).norm() / start.1.norm(),
    ];
    println!(
        "met in {touched} ticks, momenta off by {off:?}, {} J of {} J",
        now.2, start.2
    );
    assert!(touched > 0 && motion(&world, 1).velocity_m_s.norm() > 0.05);
    assert!(off[0] < 1e-13 && off[1] < 1e-9, "{off:?}");
    assert!(now.2 < start.2, "{} J of {} J", now.2, start.2);
}

#[test]
fn a_dropped_stone_only_loses_energy() {
    drop_a_stone(0.0);
}

// Newton's law of impact can make energy of friction where several points meet; here it does not.
#[test]
fn a_stone_that_bounces_only_loses_energy() {
    drop_a_stone(0.6);
}

fn drop_a_stone(restitution: f64) {
    let (_file, text) = ellipsoid(
        [1.6, 1.0, 0.6],
        "pose = { position = [0.0, 0.0, 0.08] }\nspin_rad_s = [3.0, 8.0, -5.0]\nvelocity_m_s = [0.3, 0.1, 0.0]",
    );
    let contact = rub("stone", "floor", 0.4) + &format!("restitution = {restitution:?}\n");
    let mut world = world(0.0, &format!("{FLOOR}{text}{contact}"));
    let start = kept_energy(&world, 1, 0.0);
    let (mut before, mut gained, mut most) = (start, 0.0f64, 0.0f64);
    let mut deepest = 0.0f64;
    for _ in 0..1_500 {
        world.at_in_place(FAR);
        let now = kept_energy(&world, 1, 0.0);
        gained += (now - before).max(0.0);
        most = most.max(now - before);
        before = now;
        deepest = deepest.max(-lowest(&world, 1));
    }
    println!(
        "stone: {start} J to {before} J, gained {gained:e} J in all, {most:e} J at once, {deepest:e} m deep"
    );
    assert!(
        before < 0.8 * start && gained < 0.01 * start,
        "gained {gained}"
    );
    assert!(deepest < 2e-4, "{deepest}");
}

/// Height of the lowest point of a body's surface, m.
fn lowest(world: &World, body: usize) -> f64 {
    let mut surface = world.scene.rest_surface(body).unwrap().clone();
    world
        .state
        .copy_net(&world.scene, body, surface.net_mut().points_mut());
    let (u, v) = (surface.knots_u().domain(), surface.knots_v().domain());
    let mut least = f64::INFINITY;
    for i in 0..=24 {
        for j in 0..=24 {
            let at = |(a, b): (f64, f64), k: i32| a + (b - a) * f64::from(k) / 24.0;
            least = least.min(surface.point(at(u, i), at(v, j)).z);
        }
    }
    least
}

#[test]
fn a_ball_rests_on_a_soft_slab_with_its_weight() {
    let slab = "[[body]]\nid = \"slab\"\nsurface = { builtin = \"sheet\", net = [9, 9], size = 0.1 }\n\
                model = \"lattice\"\nmaterial = { young_pa = 20e3, damping_s = 0.02 }\n\
                lattice = { layers = 3, refine = \"none\", thickness_m = 0.02 }\n\
                fixed = [{ point = [0.0, 0.0, -0.0199], normal = [0.0, 0.0, 1.0] }]\n";
    let mut world = world(0.0, &format!("{slab}{}", ball(0.0205, "")));
    run(&mut world, 1_000);
    let mut mean = 0.0;
    for _ in 0..200 {
        world.at_in_place(FAR);
        mean += world.scratch.contact_force_on(1).z / 200.0;
    }
    let now = motion(&world, 1);
    let weight = now.mass_kg * G;
    println!(
        "slab: {mean} N of {weight}, z {}, v {:e}",
        now.centre.z,
        now.velocity_m_s.norm()
    );
    assert!((mean / weight - 1.0).abs() < 0.01, "{mean} N for {weight}");
    assert!(
        now.centre.z < 0.02 && now.centre.z > 0.01,
        "{}",
        now.centre.z
    );
}

const PEN: &str = "[[tool]]\nid = \"pen\"\nshape = { sphere = { radius_m = 0.005 } }\n\
                   coupling = { stiffness_n_m = 500.0, damping_n_s_m = 0.0 }\n\
                   device = { force_max_n = 1e3, ramp_s = 0.0, speed_max_m_s = 1e3 }\n";

// A pen behind the ball follows it at a depth: the force is what moves it, and off its centre it turns it.
#[test]
fn a_push_moves_and_turns_a_body_by_its_mass_and_moments() {
    let mut world = World::new(&format!(
        "{}{PEN}pose = {{ position = [-0.03, 0.0, 0.0] }}\n",
        ball(0.0, "")
    ));
    world.at_in_place([-0.03, 0.0, 0.0]);
    let mut impulse = Vector3::zeros();
    for k in 0..200 {
        let x = -0.026 + 1e-4 * f64::from(k);
        let out = world.at_in_place([x, 0.0, 0.0]);
        impulse -= out.tools[0].force_n * DT;
    }
    let now = motion(&world, 0);
    println!("push: {impulse} N s, {} m/s", now.velocity_m_s);
    assert!(impulse.x > 1e-3, "{impulse}");
    let expected = impulse / now.mass_kg;
    assert!(
        (now.velocity_m_s - expected).norm() < 1e-9 * expected.norm(),
        "{expected}"
    );
    assert!(now.spin_rad_s.norm() < 1e-6, "{}", now.spin_rad_s);

    // Beside the middle of a stone: along its normal, which misses the centre.
    let (_file, text) = ellipsoid([1.6, 1.0, 0.6], "");
    let mut world = World::new(&format!(
        "{text}{PEN}pose = {{ position = [0.016, -0.04, 0.0] }}\n"
    ));
    world.at_in_place([0.016, -0.04, 0.0]);
    let (mut impulse, mut turn) = (Vector3::zeros(), Vector3::zeros());
    for k in 0..60 {
        let centre = motion(&world, 0).centre;
        let out = world.at_in_place([0.016, -0.024 + 1e-4 * f64::from(k), 0.0]);
        if let Some(contact) = out.tools[0].contact {
            let push = -out.tools[0].force_n;
            impulse += push * DT;
            turn += (contact.point - centre).cross(&push) * DT;
        }
    }
    let now = motion(&world, 0);
    println!(
        "off centre: {impulse} N s, {turn} N m s, momentum {}",
        now.momentum
    );
    assert!(turn.norm() > 1e-6, "{turn}");
    assert!(
        (now.momentum - turn).norm() < 1e-6 * turn.norm(),
        "{} for {turn}",
        now.momentum
    );
    // About z its moment is m/5 (a² + b²), near what the builtin sphere is.
    let moment = now.mass_kg / 5.0 * 0.02f64.powi(2) * (1.6f64.powi(2) + 1.0);
    assert!(
        (now.spin_rad_s.z * moment / turn.z - 1.0).abs() < 0.02,
        "{}",
        now.spin_rad_s
    );
}

fn pinch(k: u32) -> [([f64; 3], u32); 2] {
    let t = f64::from(k) * DT;
    let gap = 0.026 - 0.006 * (t / 0.2).min(1.0);
    let z = 0.02 + 0.03 * ((t - 0.3) / 0.5).clamp(0.0, 1.0);
    [([-gap, 0.0, z], 0), ([gap, 0.0, z], 0)]
}

#[test]
fn two_tools_pinch_a_ball_and_lift_it() {
    let finger = |id: &str, x: f64| {
        format!(
            "[[tool]]\nid = \"{id}\"\nshape = {{ sphere = {{ radius_m = 0.005 }} }}\npose = {{ position = [{x:?}, 0.0, 0.02] }}\n\
             coupling = {{ stiffness_n_m = 500.0, damping_n_s_m = 1.0 }}\nfriction = {{ mu = 0.8 }}\n"
        )
    };
    let mut world = World::new(&format!(
        "[gravity]\nacceleration = [0.0, 0.0, -9.81]\n{FLOOR}{}{}{}{}",
        ball(0.02, ""),
        finger("left", -0.026),
        finger("right", 0.026),
        rub("ball", "floor", 0.5)
    ));
    let mut saved = SavedState::default();
    let mut hashes = Vec::new();
    for k in 0..1_200 {
        world.all_in_place(&pinch(k));
        match k {
            700 => saved.save_from(&world.state),
            701.. => hashes.push(state_hash(&world.state)),
            _ => {}
        }
    }
    let now = motion(&world, 1);
    println!(
        "pinched: centre {}, {:e} m/s",
        now.centre,
        now.velocity_m_s.norm()
    );
    assert!((now.centre.z - 0.05).abs() < 2e-3, "{}", now.centre);
    assert!(now.velocity_m_s.norm() < 1e-3, "{}", now.velocity_m_s);
    let borne = world.scratch.contact_force_on(1);
    assert!((borne.z / (now.mass_kg * G) - 1.0).abs() < 1e-3, "{borne}");

    // A state saved in between goes on bit for bit.
    let mut other = World::new(&scene_text(&world));
    restore(&other.scene, &mut other.state, &mut other.scratch, &saved).unwrap();
    assert_eq!(other.state.tick, 701);
    other.seq = 701;
    for (k, hash) in (701..1_200).zip(hashes) {
        other.all_in_place(&pinch(k));
        assert_eq!(state_hash(&other.state), hash, "tick {k}");
    }
}

fn scene_text(world: &World) -> String {
    toml::to_string(&world.scene.spec).unwrap()
}

#[test]
fn a_gripping_tool_lifts_a_stone_and_lets_it_fall() {
    let (_file, text) = ellipsoid([1.6, 1.0, 0.6], "pose = { position = [0.0, 0.0, 0.012] }");
    let mut world = World::new(&format!(
        "[gravity]\nacceleration = [0.0, 0.0, -9.81]\n{FLOOR}{text}{}{PEN}grip = {{ force_max_n = 20.0 }}\npose = {{ position = [0.0, 0.0, 0.04] }}\n",
        rub("stone", "floor", 0.5)
    ));
    for k in 0..1_500 {
        let t = f64::from(k) * DT;
        let down = 0.04 - 0.0125 * (t / 0.2).min(1.0);
        let z = down + 0.03 * ((t - 0.3) / 0.4).clamp(0.0, 1.0);
        let held = (0.25..1.2).contains(&t);
        world.posed_in_place(DevicePose {
            buttons: u32::from(held),
            ..pose(0, [0.0, 0.0, z])
        });
        if k == 1_150 {
            let now = motion(&world, 1);
            println!("held: {}, {:e} m/s", now.centre, now.velocity_m_s.norm());
            assert!(now.centre.z > 0.035, "{}", now.centre);
        }
    }
    let now = motion(&world, 1);
    println!("let go: {}, {:e} m/s", now.centre, now.velocity_m_s.norm());
    assert!(now.centre.z < 0.02, "{}", now.centre);
}

// Rigid on rigid on the floor: each carries what is above it.
#[test]
fn a_stack_stands_and_bears_its_weight() {
    let (_file, text) = ellipsoid([1.5, 1.5, 0.4], "pose = { position = [0.0, 0.0, 0.0081] }");
    let upper = text
        .replace("\"stone\"", "\"upper\"")
        .replace("0.0081]", "0.0242]");
    let mut world = world(
        0.0,
        &format!(
            "{FLOOR}{text}{upper}{}{}",
            rub("stone", "floor", 0.5),
            rub("stone", "upper", 0.5)
        ),
    );
    run(&mut world, 800);
    let (low, high) = (motion(&world, 1), motion(&world, 2));
    let weight = low.mass_kg * G;
    let on_floor = world.scratch.contact_force_on(0);
    println!(
        "stack: {on_floor} N of {}, at {} and {}, {:e} and {:e} m/s",
        2.0 * weight,
        low.centre,
        high.centre,
        low.velocity_m_s.norm(),
        high.velocity_m_s.norm()
    );
    assert!(
        (on_floor.z / (-2.0 * weight) - 1.0).abs() < 0.02,
        "{on_floor}"
    );
    assert!(high.centre.z > 0.022, "{}", high.centre);
}

#[test]
fn what_cannot_be_free_is_refused_with_its_line() {
    let refused = |body: &str, reason: &str| {
        let text = format!("[[body]]\nid = \"a\"\nfree = true\n{body}\n[[tool]]\nid = \"hand\"\n");
        let loaded = scene_file::parse(&text, "free.toml", Path::new("."));
        let error = match loaded {
            Ok(loaded) => loaded.build().unwrap_err().to_string(),
            Err(error) => error.to_string(),
        };
        assert!(
            error.contains(reason) && error.contains("free.toml:"),
            "{body}: {error}"
        );
    };
    let sphere = "surface = { builtin = \"sphere\" }\n";
    refused("surface = { builtin = \"sheet\" }", "closed surface");
    for (more, reason) in [
        ("material = { density_kg_m3 = 0.0 }", "density_kg_m3"),
        ("motion = {}", "drop motion or free"),
        ("carried_by = \"hand\"", "drop carried_by or free"),
        ("model = \"lattice\"", "drop free, or use model = \"rigid\""),
        (
            "fixed = [{ u = [0.0, 1.0], v = [0.0, 1.0] }]",
            "drop fixed or free",
        ),
        ("velocity_m_s = [1e3, 0.0, 0.0]", "no longer than"),
        ("self_contact = true", "self_contact"),
    ] {
        refused(&format!("{sphere}{more}"), reason);
    }
}

#[test]
fn the_plan_tells_mass_centre_and_moments() {
    let plan = world(0.0, &ball(0.5, "")).scene.plan();
    let free = plan.bodies[0].free.as_ref().unwrap();
    // The spline is a sphere to within its own approximation.
    let mass = 4.0 / 3.0 * std::f64::consts::PI * 0.02_f64.powi(3) * 1000.0;
    assert!(
        (free.mass_kg / mass - 1.0).abs() < 2e-3,
        "{} kg",
        free.mass_kg
    );
    assert!((free.centre_m[2] - 0.5).abs() < 1e-12);
    for moment in free.moments_kg_m2 {
        let sphere = 0.4 * free.mass_kg * 0.02_f64.powi(2);
        assert!((moment / sphere - 1.0).abs() < 5e-3, "{moment} kg m2");
    }
    let text = plan.to_string();
    assert!(
        text.contains("free: 0.03") && text.contains("kg m2"),
        "{text}"
    );
}
