//! What a hand may count on: balance in six degrees of freedom, equal and opposite forces, energy
//! that adds up, no steps.

use crate::common::{Laws as _, World, pose, teardrop};
use palpate_geometry::math::{Point3, Rotation, Vector3, rotation_by, turn_between};
use palpate_geometry::surface::ClosestSolver;
use palpate_sim::haptics::DevicePose;
use palpate_sim::tick::flags;
use palpate_sim::tick::record::TickOutput;

const WEAK: &str = "device = { force_max_n = 1e6, ramp_s = 0.0, speed_max_m_s = 1e6 }\n";

/// A bar of 60 mm and 8 mm across over a rigid sheet, held in six degrees of freedom.
fn bar(extra: &str) -> String {
    format!(
        r#"
[[body]]
id = "floor"
surface = {{ builtin = "sheet", size = 0.2 }}
[[tool]]
id = "bar"
shape = {{ cylinder = {{ radius_m = 0.004, half_length_m = 0.03 }} }}
pose = {{ position = [0.0, 0.0, 0.05] }}
coupling = {{ stiffness_n_m = 800.0, damping_n_s_m = 0.5, turning_stiffness_nm_rad = 0.5, turning_damping_nm_s_rad = 1e-4 }}
{WEAK}{extra}"#
    )
}

fn turned(position: [f64; 3], orientation: Rotation) -> DevicePose {
    DevicePose {
        orientation,
        ..pose(0, position)
    }
}

/// The bar's axis along x, its right end lower by an angle.
fn leaning(angle: f64) -> Rotation {
    rotation_by(&Vector3::new(0.0, angle, 0.0))
        * rotation_by(&Vector3::new(0.0, std::f64::consts::FRAC_PI_2, 0.0))
}

/// Lowest point of the bar: of the rims of its two ends.
fn lowest(position: &Point3, orientation: &Rotation) -> f64 {
    let axis = orientation * Vector3::z();
    let down = -Vector3::z();
    let rim = (down - axis * down.dot(&axis))
        .try_normalize(1e-12)
        .unwrap_or_default()
        * 0.004;
    [0.03, -0.03]
        .map(|s| position.z + axis.z * s + rim.z)
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

// One end of the leaning bar touches. Held still, the proxy is where spring, torsion spring and
// floor balance: F = K (p − d), τ = K_r × the turn, and the bar touches the floor and no more.
#[test]
fn a_bar_that_may_turn_finds_the_balance_of_force_and_torque() {
    for angle in [0.05, 0.2, 0.5] {
        let mut world = World::new(&bar(""));
        let device = leaning(angle);
        let start = turned([0.0, 0.0, 0.05], device);
        world.posed(start);
        let low = 0.05 - lowest(&start.position, &device);
        let mut out = Default::default();
        for k in 0..1_500 {
            let depth = 0.003 * (f64::from(k) / 500.0).min(1.0);
            let height = low + 0.002 - 0.002 * (f64::from(k) / 100.0).min(1.0) - depth;
            out = world.posed(turned([0.0, 0.0, height], device));
        }
        let tool = out.tools[0];
        let (place, turn) = (
            tool.proxy_position,
            turn_between(&device, &tool.proxy_orientation),
        );
        let force = (place - Point3::new(0.0, 0.0, low - 0.003)) * 800.0;
        assert!(
            (tool.contact_force_n - force).norm() < 1e-6,
            "{angle}: {} for {force}",
            tool.contact_force_n
        );
        assert!(
            (tool.contact_torque_nm - turn * 0.5).norm() < 1e-7,
            "{angle}: {} for {}",
            tool.contact_torque_nm,
            turn * 0.5
        );
        let gap = lowest(&place, &tool.proxy_orientation);
        assert!(
            gap.abs() < 1e-8,
            "{angle}: the bar is {gap} m off the floor"
        );
        // An end pushed up turns the bar, so it gives way more than the spring alone: softer by
        // more than a tenth.
        assert!(
            force.z > 0.2 && force.z < 0.9 * 800.0 * 0.003,
            "{angle}: {} N",
            force.z
        );
        // Nothing moves any more.
        let again = world.posed(turned([0.0, 0.0, low - 0.003], device)).tools[0];
        assert!((again.contact_force_n - tool.contact_force_n).norm() < 1e-9);
    }
}

// Laid flat and turned about the vertical by the hand, the bar sticks by friction: the whole turn
// is in the torsion spring. Turned on, it slips, and the torque stays what friction bears.
#[test]
fn a_bar_that_sticks_is_wound_up_and_then_slips_round() {
    let mut world = World::new(&bar("friction = { mu = 0.4 }\n"));
    let flat = leaning(0.0);
    world.posed(turned([0.0, 0.0, 0.05], flat));
    for k in 0..400 {
        let height = 0.006 - 0.0045 * (f64::from(k) / 300.0).min(1.0);
        world.posed(turned([0.0, 0.0, height], flat));
    }
    let pressed = world.posed(turned([0.0, 0.0, 0.0015], flat)).tools[0];
    let push = pressed.contact_force_n.z;
    assert!((push - 800.0 * 0.0025).abs() < 1e-6, "{push} N");
    let spin = |angle: f64| rotation_by(&Vector3::new(0.0, 0.0, angle)) * flat;
    let (mut wound, mut torques) = (0.0, Vec::new());
    for k in 1..=1_000 {
        let angle = 0.3 * f64::from(k) / 1_000.0;
        let tool = world.posed(turned([0.0, 0.0, 0.0015], spin(angle))).tools[0];
        let torque = -tool.contact_torque_nm.z;
        if torque > 0.999 * 0.5 * angle {
            wound = angle;
        }
        torques.push(torque);
        assert!(
            (tool.contact_force_n.z - push).abs() < 0.02 * push,
            "at {angle}: {} N",
            tool.contact_force_n
        );
    }
    // μ F r, with r between the middle and the ends of the bar.
    let most = 0.4 * push * 0.03;
    let last = torques[999];
    assert!(
        wound > 0.01 && last <= most * (1.0 + 1e-6) && last > 0.3 * most,
        "wound to {wound}, {last} of {most} N m"
    );
    let held = torques[800..]
        .iter()
        .fold(0.0, |worst: f64, t| worst.max((t / last - 1.0).abs()));
    assert!(held < 0.05, "slipping, the torque varies by {held}");
}

#[test]
fn drag_adds_to_friction_as_far_as_it_slips() {
    let text = |mu: f64| {
        format!(
            "[[body]]\nid = \"floor\"\nsurface = {{ builtin = \"sheet\", size = 0.4 }}\n[[tool]]\nid = \"ball\"\n\
             pose = {{ position = [-0.1, 0.0, 0.03] }}\n\
             coupling = {{ stiffness_n_m = 1000.0, damping_n_s_m = 0.0 }}\n{WEAK}\
             friction = {{ mu = {mu:?}, viscous_n_s_m = 3.0 }}\n"
        )
    };
    for (mu, speed) in [(0.0, 0.05), (0.0, 0.4), (0.3, 0.05), (0.3, 0.2)] {
        let mut world = World::new(&text(mu));
        world.at([-0.1, 0.0, 0.03]);
        world.at([-0.1, 0.0, 0.0101]);
        let mut tool = Default::default();
        for k in 0..400 {
            tool = world
                .at([-0.1 + speed * 1e-3 * f64::from(k), 0.0, 0.008])
                .tools[0];
        }
        let expected = mu * 2.0 + 3.0 * speed;
        assert!(
            (-tool.force_n.x - expected).abs() < 1e-6 * expected,
            "μ {mu}, {speed} m/s: {}",
            tool.force_n
        );
        assert!((tool.force_n.z - 2.0).abs() < 1e-9 && tool.force_n.y.abs() < 1e-9);
        // Let go along the floor, the ball is drawn after the hand until friction alone holds it.
        for _ in 0..3_000 {
            tool = world.at([-0.1 + speed * 0.4, 0.0, 0.008]).tools[0];
        }
        assert!(
            -tool.force_n.x <= mu * 2.0 + 1e-9,
            "it rests with {}",
            tool.force_n
        );
    }
}

const FREE_DROP: &str = r#"
[[body]]
id = "drop"
surface = { builtin = "teardrop", net = [8, 8] }
model = "lattice"
material = { young_pa = 20e3, density_kg_m3 = 1000.0, damping_s = 1e-3 }
lattice = { layers = 2, refine = "none" }
integrator = { sleep_m_s = 0.0 }
"#;

// A body that nothing holds: what the hand feels, and only that, changes its momentum.
#[test]
fn the_body_feels_the_opposite_of_what_the_hand_feels() {
    let tools = [
        ("sphere = { radius_m = 0.01 }", ""),
        ("point = {}", ""),
        (
            "sphere = { radius_m = 0.01 }",
            "friction = { mu = 0.5, viscous_n_s_m = 0.5 }\n",
        ),
        ("ellipsoid = { semi_axes_m = [0.008, 0.01, 0.012] }", ""),
        (
            "box = { half_extents_m = [0.01, 0.01, 0.01] }",
            "friction = { mu = 0.5 }\n",
        ),
    ];
    for (shape, friction) in tools {
        for turning in ["", ", turning_stiffness_nm_rad = 0.2"] {
            let text = format!(
                "{FREE_DROP}[[tool]]\nid = \"tool\"\nshape = {{ {shape} }}\npose = {{ position = [0.06, 0.003, 0.045] }}\n\
                 coupling = {{ stiffness_n_m = 300.0, damping_n_s_m = 1.0{turning} }}\n\
                 device = {{ force_max_n = 0.02, ramp_s = 0.0 }}\n{friction}"
            );
            let mut world = World::new(&text);
            let masses = world.scene.deformable(0).unwrap().masses().to_vec();
            let momentum = |world: &World| -> Vector3 {
                let body = world.state.bodies[0].deformable.as_ref().unwrap();
                body.velocities
                    .iter()
                    .zip(&masses)
                    .map(|(v, m)| v * *m)
                    .sum()
            };
            let (mut before, mut touched, mut limited) = (momentum(&world), 0, 0);
            for k in 0..600 {
                let x = 0.06 - 0.045 * (f64::from(k) / 400.0).min(1.0);
                let tool = world.at([x, 0.003, 0.045 + 1e-5 * f64::from(k)]).tools[0];
                let now = momentum(&world);
                let miss = (now - before + tool.force_n * 1e-3).norm();
                // Rounding of sums of some hundred momenta.
                assert!(
                    miss <= 1e-9 * (1e-3 * tool.force_n.norm()) + 1e-15,
                    "{shape} at {k}: off by {miss} of {}",
                    tool.force_n
                );
                before = now;
                touched += u32::from(tool.force_n.norm() > 0.002);
                limited += u32::from(tool.flags & flags::SATURATED != 0);
            }
            assert!(
                touched > 50 && limited > 0,
                "{shape}: {touched} ticks in touch, {limited} limited"
            );
        }
    }
}

/// How far a ball of 10 mm goes into the body beyond what its net shows, m.
fn dent_m(world: &World, proxy: &Point3) -> f64 {
    let mut net = world.scene.rest_surface(0).unwrap().net().points().to_vec();
    world.state.copy_net(&world.scene, 0, &mut net);
    let surface = world.scene.surface_with(0, &net).unwrap().unwrap();
    0.01 - ClosestSolver::new(&surface)
        .closest(&surface, proxy)
        .signed_distance
}

// Pressed slowly and held: what the hand put in is in the body's springs, in the coupling and in the
// dent that the net is too coarse for; let go as slowly, it comes back.
#[test]
fn work_of_the_hand_is_stored_and_comes_back() {
    let fixed = "fixed = [{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }]\nintegrator";
    let text = FREE_DROP
        .replace("integrator", fixed)
        .replace("net = [8, 8]", "net = [12, 12]");
    let text = format!(
        "{text}[[tool]]\nid = \"ball\"\npose = {{ position = [0.06, 0.003, 0.045] }}\n\
         coupling = {{ stiffness_n_m = 300.0, damping_n_s_m = 0.0 }}\n{WEAK}"
    );
    let mut world = World::new(&text);
    let at = |share: f64| [0.032 - 0.005 * share, 0.003, 0.045];
    world.at(at(0.0));
    // Slow: what the material's damping and the step's own take goes with the speed.
    let ticks = 30_000;
    let mut tool = Default::default();
    let (mut in_dent, mut last) = (0.0, (0.0, 0.0));
    for k in 0..=ticks {
        tool = world.at(at(f64::from(k) / f64::from(ticks))).tools[0];
        let force = tool.contact_force_n.norm();
        if k % 30 == 0 && force > 0.0 {
            let dent = dent_m(&world, &tool.proxy_position);
            in_dent += 0.5 * (force + last.0) * (dent - last.1);
            last = (force, dent);
        }
    }
    let body = world.state.bodies[0].deformable.as_ref().unwrap();
    let in_coupling = 0.5 * tool.contact_force_n.norm_squared() / 300.0;
    let (put_in, whole) = (
        tool.energy_j,
        world.scene.deformable(0).unwrap().energy_j(body) + in_coupling + in_dent,
    );
    println!("in the dent {in_dent} J of {whole} J, {} m deep", last.1);
    assert!(tool.force_n.norm() > 0.24, "{}", tool.force_n);
    for k in (0..=ticks).rev() {
        tool = world.at(at(f64::from(k) / f64::from(ticks))).tools[0];
    }
    let lost = tool.energy_j;
    println!(
        "work differs from what is stored by {:.2} %; {lost} J did not come back",
        (put_in / whole - 1.0) * 100.0
    );
    assert!(
        (put_in / whole - 1.0).abs() < 0.01,
        "{put_in} J put in, {whole} J stored"
    );
    // A foot is elsewhere on the way out than on the way in, by what it settles in a tick, and how far a
    // force goes in depends on where.
    assert!(
        lost.abs() < 3e-5 * whole,
        "{lost} J of {whole} J did not come back"
    );
}

/// Largest step of the force between two ticks, relative to the force, along a path.
fn largest_step(world: &mut World, path: impl Fn(f64) -> [f64; 3], ticks: usize) -> (f64, usize) {
    let (mut before, mut worst, mut touched) = (Vector3::zeros(), 0.0f64, 0);
    for k in 0..ticks {
        let force = world.at(path(k as f64 / ticks as f64)).tools[0].force_n;
        if before.norm() > 0.0 && force.norm() > 0.0 {
            touched += 1;
            worst = worst.max((force - before).norm() / force.norm());
        }
        before = force;
    }
    (worst, touched)
}

// Once round a ring of two periodic directions: over seams and every knot, at 70 mm/s on a rigid
// one and at 35 mm/s on a soft one. There a row of contacts that comes or goes bends the force,
// which goes with the speed; it does not break it.
#[test]
fn the_force_has_no_step_over_seams_and_knots() {
    let tools = [
        "sphere = { radius_m = 0.006 }",
        "point = {}",
        "ellipsoid = { semi_axes_m = [0.005, 0.006, 0.007] }",
    ];
    for shape in tools {
        for (model, ticks) in [("rigid", 5_000), ("membrane", 10_000)] {
            if shape.starts_with("ellipsoid") && model != "rigid" {
                continue;
            }
            let radius = if shape.starts_with("point") {
                0.0
            } else {
                0.006
            };
            let text = format!(
                "[[body]]\nid = \"ring\"\nsurface = {{ builtin = \"torus\", size = 0.05 }}\nmodel = \"{model}\"\n{}[[tool]]\nid = \"tool\"\n\
                 shape = {{ {shape} }}\npose = {{ position = [0.09, 0.0, 0.0] }}\n\
                 coupling = {{ stiffness_n_m = 400.0, damping_n_s_m = 0.0 }}\n{WEAK}",
                if model == "rigid" {
                    ""
                } else {
                    "material = { young_pa = 200e3 }\nlattice = { refine = \"none\", thickness_m = 0.002 }\nfixed = [{ point = [0.0, 0.0, -0.005], normal = [0.0, 0.0, 1.0] }]\n"
                }
            );
            let mut world = World::new(&text);
            let surface = world.scene.rest_surface(0).unwrap().clone();
            // Along a line of the surface, 1.5 mm deep, once round the ring.
            let v = 0.37;
            let place = |share: f64, depth: f64| -> [f64; 3] {
                let (start, end) = surface.knots_u().domain();
                let u = start + (end - start) * share.rem_euclid(1.0);
                (surface.point(u, v) + surface.normal(u, v) * (radius - depth)).into()
            };
            world.at(place(0.0, -0.004));
            for k in 0..600 {
                world.at(place(
                    0.0,
                    -0.004 + 0.0055 * (f64::from(k) / 500.0).min(1.0),
                ));
            }
            let (worst, touched) = largest_step(&mut world, |share| place(share, 0.0015), ticks);
            println!(
                "{shape} on a {model} ring: largest step {:.3} % of the force",
                worst * 100.0
            );
            assert!(touched > ticks - 100, "{touched} ticks in touch");
            assert!(
                worst < 0.01,
                "{shape} on a {model} ring: a step of {worst} of the force"
            );
        }
    }
}

/// A mass of 100 g pushed by 1 N into a wall through the loop, without a hand to damp it.
fn bounce(passivity: bool, stiffness: f64, damping: f64, ticks: usize) -> (f64, f64, f64) {
    let text = format!(
        "[[body]]\nid = \"floor\"\nsurface = {{ builtin = \"sheet\", size = 0.2 }}\n[[tool]]\nid = \"tool\"\nshape = {{ point = {{}} }}\n\
         pose = {{ position = [0.0, 0.0, 0.01] }}\ncoupling = {{ stiffness_n_m = {stiffness:?}, damping_n_s_m = 0.0 }}\n\
         device = {{ force_max_n = 20.0, ramp_s = 0.0, speed_max_m_s = 100.0, passivity = {passivity} }}\n"
    );
    let mut world = World::new(&text);
    let (mass, dt, count) = (0.1, 1e-3, 50);
    let (mut z, mut v, mut force) = (0.001, 0.0, 0.0);
    let (mut least, mut swing) = (f64::INFINITY, 0.0f64);
    for k in 0..ticks {
        for _ in 0..count {
            v += (force - 1.0 - damping * v) / mass * dt / f64::from(count);
            z += v * dt / f64::from(count);
        }
        let tool = world.at([0.0, 0.0, z]).tools[0];
        force = tool.force_n.z;
        least = least.min(tool.energy_j);
        if k > ticks * 9 / 10 {
            swing = swing.max((z + 1.0 / stiffness).abs());
        }
    }
    (least, world.state.tools[0].port.energy_j(), swing)
}

// Above 2 b / T a wall feeds an oscillation; the controller takes what it would make.
#[test]
fn the_passivity_controller_takes_what_a_wall_beyond_its_limit_makes() {
    let damping = 0.5;
    let limit = 2.0 * damping / 1e-3;
    let (_, _, swing) = bounce(false, 0.9 * limit, damping, 60_000);
    assert!(swing < 1e-6, "below the limit it still swings by {swing} m");
    let (_, made, swing) = bounce(false, 3.0 * limit, damping, 10_000);
    assert!(
        made < -0.01 && swing > 1e-3,
        "beyond the limit: {made} J, {swing} m"
    );
    let (least, end, swing) = bounce(true, 3.0 * limit, damping, 10_000);
    println!("with the controller: least {least} J, end {end} J, swing {swing} m");
    // What one tick made is taken in the next.
    assert!(
        end > -1e-6 && least > -1e-4,
        "with the controller: {end} J, at least {least} J"
    );
    assert!(swing < 2e-4, "with the controller it swings by {swing} m");
}

#[test]
fn a_body_that_is_not_finite_goes_back_to_rest_and_the_next_force_says_so() {
    let mut world = World::new(&teardrop(20e3, "\"none\""));
    let press = |world: &mut World| world.all(&[([0.027, 0.003, 0.045], 0)]);
    for _ in 0..20 {
        assert_eq!(press(&mut world).tools[0].flags & flags::FAULT, 0);
    }
    let body = world.state.bodies[0].deformable.as_mut().unwrap();
    body.velocities.fill(Vector3::repeat(f64::NAN));
    body.positions.fill(Point3::from(Vector3::repeat(f64::NAN)));
    let ticks: Vec<_> = (0..6).map(|_| press(&mut world)).collect();
    let faults: Vec<bool> = ticks.iter().map(|out| out.fault.is_some()).collect();
    let flagged = |out: &TickOutput| out.tools[0].flags & flags::FAULT != 0;
    let flag_set: Vec<bool> = ticks.iter().map(flagged).collect();
    assert!(faults.contains(&true), "no fault was met");
    assert_eq!(flag_set[1..], faults[..5], "flags follow faults by a tick");
    assert!(!faults[5], "the body does not recover: {faults:?}");
    for out in &ticks {
        assert!(out.tools[0].force_n.iter().all(|x| x.is_finite()));
    }
    let body = world.state.bodies[0].deformable.as_ref().unwrap();
    assert!(
        body.positions
            .iter()
            .all(|p| p.iter().all(|x| x.is_finite()))
    );
}
