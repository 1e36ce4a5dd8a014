//! Models, methods and materials: what each promises.

use crate::common::{Laws as _, World, press};
use palpate_geometry::math::Vector3;
use palpate_sim::body::DeformableState;

const BALL: &str = r#"
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.02 } }
pose = { position = [0.0, 0.0, 0.05] }
coupling = { stiffness_n_m = inf, damping_n_s_m = 0.0 }
device = { force_max_n = 1e9, ramp_s = 0.0 }
"#;

/// A slab of 0.1 m × 0.1 m × 0.03 m with its underside fixed, and a ball.
fn slab(model: &str, more: &str) -> String {
    format!(
        r#"
[[body]]
id = "slab"
surface = {{ builtin = "sheet", net = [7, 7], size = 0.1 }}
model = "{model}"
lattice = {{ layers = 4, refine = "none", thickness_m = 0.03 }}
fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}]
{more}
{BALL}"#
    )
}

/// The teardrop with few nodes.
fn drop(model: &str, lattice: &str, more: &str) -> String {
    format!(
        r#"
[[body]]
id = "drop"
surface = {{ builtin = "teardrop", net = [8, 8] }}
model = "{model}"
lattice = {{ {lattice} }}
fixed = [{{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }}]
{more}
{}"#,
        BALL.replace("0.02 }", "0.01 }")
            .replace("[0.0, 0.0, 0.05]", "[0.06, 0.003, 0.045]")
    )
}

fn body(world: &World) -> &DeformableState {
    world.state.bodies[0].deformable.as_ref().unwrap()
}

/// How far the middle of the slab's surface is below where it was. Control points move farther than
/// the surface.
fn dent_m(world: &World) -> f64 {
    let mut surface = world.scene.rest_surface(0).unwrap().clone();
    world
        .state
        .copy_net(&world.scene, 0, surface.net_mut().points_mut());
    -surface.point(0.5, 0.5).z
}

fn base_n(world: &World) -> f64 {
    world
        .scene
        .deformable(0)
        .unwrap()
        .base_reaction_n(body(world))
        .norm()
}

#[test]
fn methods_agree_at_rest_and_xpbd_softens() {
    // The contact of the explicit method answers with compliances found at rest, along z. What they
    // are off by, loaded, is left as a gap, and tells as the compliance of a tick nears that of
    // rest: 0.6 % of the force at 500 kPa. It is a method for soft bodies.
    let force = |method: &str, young: f64, damping: f64| {
        let more = format!(
            "integrator = {{ method = \"{method}\", substeps = 4 }}\n\
             material = {{ young_pa = {young:?}, damping_s = {damping:?} }}"
        );
        let mut world = World::new(&slab("lattice", &more));
        let force = press(&mut world, 0.003, 500);
        // The reaction of the base is by the law: a method that has not solved it does not balance.
        let solved = (base_n(&world) / force - 1.0).abs() < 5e-3;
        assert!(
            solved != (method == "xpbd"),
            "{method}: base {} N, tool {force} N",
            base_n(&world)
        );
        force / young
    };
    let implicit = force("implicit", 20e3, 5e-3);
    for (method, young, damping) in [
        ("explicit", 20e3, 5e-3),
        ("explicit", 60e3, 3e-3),
        ("implicit", 20e6, 5e-3),
    ] {
        let share = force(method, young, damping) / implicit;
        println!("{method} {young} Pa: {share}");
        assert!(
            (share - 1.0).abs() < 5e-3,
            "{method} at {young} Pa gives {share} of the implicit force"
        );
    }
    // Four substeps of one iteration do not converge on a stiff body: it only looks stable.
    let soft = force("xpbd", 20e6, 5e-3) / implicit;
    println!("xpbd keeps {soft} of the force");
    assert!(soft < 0.5, "xpbd keeps {soft} of the force");
}

#[test]
fn the_automatic_method_says_why() {
    // Most substeps are refused, fewer are compared.
    let cases = [
        (2e3, "explicit", "substeps would take"),
        (2e6, "implicit", "substeps would take"),
        (2e9, "implicit", "substeps a tick, more than"),
    ];
    for (young, method, why) in cases {
        let more =
            format!("integrator = {{ method = \"auto\" }}\nmaterial = {{ young_pa = {young:?} }}");
        let world = World::new(&slab("lattice", &more));
        let plan = world.scene.plan();
        let lattice = plan.bodies[0].deformable.as_ref().unwrap();
        assert_eq!(lattice.method, method, "{}", lattice.why);
        assert!(lattice.why.contains(why), "{}", lattice.why);
    }
}

// Cells count as springs do: explicit passes over them are not free.
#[test]
fn the_automatic_method_counts_the_cells_of_a_continuum() {
    for (iterations, young, method) in [(3, 200.0, "explicit"), (1, 2e6, "implicit")] {
        let more = format!(
            "integrator = {{ method = \"auto\", iterations = {iterations} }}\n\
             material = {{ young_pa = {young:?}, damping_s = 0.0 }}"
        );
        let world = World::new(&slab("continuum", &more));
        let plan = world.scene.plan();
        let lattice = plan.bodies[0].deformable.as_ref().unwrap();
        // "…: N explicit substeps would take X us, implicit Y us".
        let numbers: Vec<f64> = lattice
            .why
            .split([' ', ','])
            .filter_map(|word| word.parse().ok())
            .collect();
        let &[substeps, explicit_us, implicit_us] = &numbers[..] else {
            panic!("{}", lattice.why)
        };
        println!("{young} Pa: {}", lattice.why);
        assert!(
            substeps >= 1.0 && explicit_us > 0.0 && implicit_us > 0.0,
            "{}",
            lattice.why
        );
        assert_eq!(lattice.method, method, "{}", lattice.why);
        assert_eq!(
            explicit_us < implicit_us,
            method == "explicit",
            "{}",
            lattice.why
        );
    }
}

#[test]
fn reduced_and_riding_bodies_carry_what_presses_them() {
    let fine = "layers = 3, refine = [12, 13]";
    // A coarse net reaches from the ball to the base: what presses on fixed control points moves no
    // node, and is not part of the reaction of the law. So the base is moved out of reach.
    let far = |text: String| text.replace("point = [0.0, 0.0, 0.015]", "point = [0.0, 0.0, 0.004]");
    let cases = [
        drop("continuum", fine, ""),
        drop("net", "layers = 2, refine = [12, 13]", ""),
        far(drop(
            "lattice",
            "builder = \"transfinite\", nodes = [8, 8, 8], refine = \"none\"",
            "",
        )),
        far(drop(
            "lattice",
            "builder = \"som\", nodes = [8, 8, 8], refine = \"none\"",
            "",
        )),
    ];
    for text in cases {
        let mut world = World::new(&text);
        let mut force = 0.0;
        for k in 0..3_000 {
            let x = 0.034 - 8e-3 * (f64::from(k) / 800.0).min(1.0);
            force = world.at([x, 0.003, 0.045]).tools[0].force_n.norm();
        }
        println!("base {} N, tool {force} N", base_n(&world));
        assert!(force > 0.02, "{force} N\n{text}");
        assert!(
            (base_n(&world) / force - 1.0).abs() < 1e-2,
            "base {} N, tool {force} N\n{text}",
            base_n(&world)
        );
    }
}

// Power at the surface is power into the volume: a load on the net does the same work on its
// coordinates as the forces that hold it do on the nodes.
#[test]
fn nodes_and_coordinates_agree_on_work() {
    let text = drop("net", "layers = 2, refine = [12, 13]", "");
    let world = World::new(&text);
    let lattice = world.scene.deformable(0).unwrap();
    let mut state = lattice.rest_state();
    for (k, p) in state.positions.iter_mut().enumerate() {
        *p += Vector3::new(
            libm::sin(k as f64),
            libm::cos(3.0 * k as f64),
            libm::sin(7.0 * k as f64),
        ) * 1e-6;
    }
    let mut scratch = lattice.scratch();
    let forces: Vec<Vector3> = lattice
        .internal_forces(&state, &mut scratch)
        .iter()
        .map(|f| Vector3::new(f[0], f[1], f[2]))
        .collect();
    let step: Vec<Vector3> = (0..forces.len())
        .map(|k| Vector3::new(libm::cos(k as f64), 0.3, libm::sin(2.0 * k as f64)) * 1e-8)
        .collect();
    let energy = |sign: f64| {
        let mut moved = state.clone();
        moved
            .positions
            .iter_mut()
            .zip(&step)
            .for_each(|(p, s)| *p += s * sign);
        lattice.energy_j(&moved)
    };
    let by_energy = energy(-1.0) - energy(1.0);
    let by_forces: f64 = forces.iter().zip(&step).map(|(f, s)| 2.0 * f.dot(s)).sum();
    assert!(
        (by_energy / by_forces - 1.0).abs() < 1e-5,
        "{by_energy} J by energy, {by_forces} J by forces"
    );
}

#[test]
fn a_free_body_keeps_its_momentum_and_loses_energy() {
    for model in ["lattice", "continuum", "membrane"] {
        for method in ["implicit", "explicit"] {
            let text = slab(model, &format!("integrator = {{ method = \"{method}\" }}"));
            let text = text.replace(
                "fixed = [{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }]",
                "",
            );
            let mut world = World::new(&text);
            let masses = world.scene.deformable(0).unwrap().masses().to_vec();
            for (k, v) in world.state.bodies[0]
                .deformable
                .as_mut()
                .unwrap()
                .velocities
                .iter_mut()
                .enumerate()
            {
                *v = Vector3::new(
                    1.0,
                    0.1 * libm::sin(k as f64),
                    0.1 * libm::cos(2.0 * k as f64),
                );
            }
            world.scratch = world.scene.scratch(&world.state);
            let momentum = |world: &World| -> Vector3 {
                body(world)
                    .velocities
                    .iter()
                    .zip(&masses)
                    .map(|(v, m)| v * *m)
                    .sum()
            };
            let before = momentum(&world);
            let lattice_energy =
                |world: &World| world.scene.deformable(0).unwrap().energy_j(body(world));
            // Symplectic steps swing about the energy. An implicit one from the inertial prediction
            // loses it over any period, though not in each tick of one: it is below what it was at
            // the start, and its highest in 100 ticks, more than a period, below that of those before.
            // The angular momentum that a step loses is given back, with its energy.
            let slack = if method == "explicit" {
                1.2
            } else {
                1.0 + 1e-9
            };
            let first = lattice_energy(&world);
            let mut highest = first;
            for _ in 0..5 {
                let mut most = 0.0_f64;
                for _ in 0..100 {
                    world.at([0.0, 0.0, 10.0]);
                    most = most.max(lattice_energy(&world));
                }
                assert!(
                    most <= highest * slack && most <= first * slack,
                    "{model} {method}: {most} J after {highest} J"
                );
                highest = if method == "explicit" { first } else { most };
            }
            let miss = (momentum(&world) - before).norm() / before.norm();
            assert!(miss < 1e-10, "{model} {method}: momentum off by {miss}");
        }
    }
}

// A strip clamped at one end, bending under its own weight: w = q L⁴ / 8 D, D = E t³ / 12 (1 − ν²)
// for a plate that bends to a cylinder; rows bend each for themselves, so there is no other
// curvature at the sides that would make it softer. The step's matrix holds what stretches the
// sheet in all three directions, so an iteration moves a flat sheet in bending by a share of (t /
// L)² only: this strip is thick and has five of them, and no damping, which is by the same matrix.
#[test]
fn a_membrane_bends_as_a_plate_of_its_thickness() {
    let (young, thickness, density, gravity, side) = (1e6, 4e-3_f64, 1_000.0, 1e-2, 0.1_f64);
    let text = format!(
        r#"
[gravity]
acceleration = [0.0, 0.0, -{gravity:?}]
[[body]]
id = "strip"
surface = {{ builtin = "sheet", net = [24, 6], size = {side:?} }}
model = "membrane"
material = {{ young_pa = {young:?}, density_kg_m3 = {density:?}, damping_s = 0.0 }}
lattice = {{ refine = "none", thickness_m = {thickness:?} }}
integrator = {{ sleep_m_s = 0.0, iterations = 5 }}
fixed = [{{ u = [0.0, 0.06], v = [0.0, 1.0] }}]
{BALL}"#
    );
    let mut world = World::new(&text);
    world.rest(|world| _ = world.at_in_place([0.0, 0.0, 10.0]), 4_000);
    let sag = body(&world)
        .positions
        .iter()
        .map(|p| -p.z)
        .fold(0.0, f64::max);
    // Clamped are the control points up to the last one within the range.
    let clamped = world.scene.deformable(0).unwrap();
    let free = (0..clamped.coordinate_count()).filter(|&k| clamped.unknown(k).is_none());
    let held = free
        .map(|k| clamped.rest_state().positions[k].x + 0.5 * side)
        .fold(0.0, f64::max);
    let length = side - held;
    let load = density * gravity * thickness;
    let plate = young * thickness.powi(3) / (12.0 * (1.0 - 1.0 / 9.0));
    let exact = load * length.powi(4) / (8.0 * plate);
    println!("membrane: sags by {sag} m, a plate by {exact} m");
    assert!(
        (sag / exact - 1.0).abs() < 0.1,
        "sags by {sag} m, a plate by {exact} m"
    );
}

#[test]
fn clay_keeps_its_dent_and_gel_does_not_as_a_lattice() {
    keeps_its_dent("lattice");
}

#[test]
fn clay_keeps_its_dent_and_gel_does_not_as_a_continuum() {
    keeps_its_dent("continuum");
}

#[test]
fn clay_keeps_its_dent_and_gel_does_not_as_a_net() {
    keeps_its_dent("net");
}

fn keeps_its_dent(model: &str) {
    let after_press = |material: &str| {
        let mut world = World::new(&slab(model, &format!("material = {{ {material} }}")));
        press(&mut world, 0.006, 500);
        for _ in 0..2_000 {
            world.at([0.0, 0.0, 0.06]);
        }
        dent_m(&world)
    };
    // The softest motions of a net take more than two seconds to die out.
    let rounding = if model == "net" { 1e-6 } else { 1e-7 };
    let gel = after_press("preset = \"gel\"");
    assert!(gel.abs() < rounding, "{model}: gel keeps {gel} m");
    let clay = after_press("preset = \"plasticine\"");
    assert!(clay > 0.5e-3 && clay < 6e-3, "clay keeps {clay} m of 6 mm");
    let spread = after_press(
        "plastic = { yield_strain = 0.01, rate_per_s = 20.0, hardening = 0.1, spread_m = 0.03 }",
    );
    assert!(
        spread > 0.2e-3 && spread < 6e-3,
        "with its flow spread it keeps {spread} m"
    );
    let hard = after_press("plastic = { yield_strain = 10.0, rate_per_s = 20.0 }");
    println!(
        "{model}: dents of 6 mm: gel {gel}, clay {clay}, spread {spread}, below yield {hard} m"
    );
    assert!(
        hard.abs() < rounding,
        "{model}: below yield it keeps {hard} m"
    );
}

#[test]
fn plasticine_gives_more_to_more_force_and_less_when_stiffer() {
    // A limit of the device's force makes a press of constant force.
    let dent = |force_n: f64, young: f64| {
        let text = slab(
            "lattice",
            &format!("material = {{ preset = \"plasticine\", young_pa = {young:?} }}"),
        )
        .replace("stiffness_n_m = inf", "stiffness_n_m = 1e6")
        .replace("force_max_n = 1e9", &format!("force_max_n = {force_n:?}"));
        let mut world = World::new(&text);
        for k in 0..1_500 {
            world.at([0.0, 0.0, 0.02 - 0.01 * (f64::from(k) / 500.0).min(1.0)]);
        }
        dent_m(&world)
    };
    let forces = [10.0, 30.0, 60.0].map(|force| dent(force, 13e6));
    println!("dents by 10, 30, 60 N: {forces:?}");
    assert!(
        forces[0] > 0.0 && forces.windows(2).all(|pair| pair[0] < pair[1]),
        "{forces:?}"
    );
    let stiffness = [5e6, 13e6, 30e6].map(|young| dent(30.0, young));
    println!("dents at 5, 13, 30 MPa: {stiffness:?}");
    assert!(
        stiffness.windows(2).all(|pair| pair[0] > pair[1]),
        "{stiffness:?}"
    );
}

#[test]
fn stiffening_springs_press_back_harder_far_out_only() {
    let force = |more: &str, depth: f64| {
        press(
            &mut World::new(&slab(
                "lattice",
                &format!("material = {{ young_pa = 20e3 {more} }}"),
            )),
            depth,
            500,
        )
    };
    let law = ", stiffening = { strain = 0.05, ratio = 6.0, least_length = 0.7, least_length_ratio = 6.0 }";
    assert!((force(law, 0.0005) / force("", 0.0005) - 1.0).abs() < 0.02);
    assert!(force(law, 0.01) > 1.15 * force("", 0.01));
}

#[test]
fn a_stiff_nodule_is_felt() {
    let at = |more: &str| press(&mut World::new(&slab("lattice", more)), 0.003, 500);
    let nodule = "[[body.region]]\nball = { centre = [0.0, 0.0, -0.01], radius_m = 0.02 }\nyoung_pa = 500e3\n";
    let (plain, with) = (at(""), at(nodule));
    assert!(
        with > 1.3 * plain,
        "{with} N over the nodule, {plain} N without"
    );
}

#[test]
fn an_untouched_body_sleeps_and_a_touch_wakes_it() {
    let mut world = World::new(&slab("lattice", ""));
    let mut never = World::new(&slab("lattice", "integrator = { sleep_m_s = 0.0 }"));
    let asleep = |world: &World| world.scene.deformable(0).unwrap().asleep(body(world));
    for _ in 0..300 {
        world.at([0.0, 0.0, 0.05]);
        never.at([0.0, 0.0, 0.05]);
    }
    assert!(asleep(&world) && !asleep(&never));
    assert!(body(&world).slept > 100 && body(&never).slept == 0);
    let (force, awake) = (press(&mut world, 0.003, 500), press(&mut never, 0.003, 500));
    assert!(!asleep(&world));
    assert!(
        (force / awake - 1.0).abs() < 1e-9,
        "{force} N after sleep, {awake} N without"
    );
    // Left alone it swings out and sleeps again, no farther from rest than its last speed could
    // take it.
    for _ in 0..3_000 {
        world.at([0.0, 0.0, 0.05]);
    }
    assert!(asleep(&world));
    let rest = world.scene.deformable(0).unwrap().rest_state();
    let away = body(&world)
        .positions
        .iter()
        .zip(&rest.positions)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max);
    assert!(away < 1e-7, "{away} m");
}

// Golden recordings have no net: these bits are those before and after changes that are meant to change none. A change
// that means to change bits writes them anew, as it blesses golden recordings.
#[test]
fn nets_come_to_the_bits_that_they_came_to() {
    for (poisson, expected) in [(0.3, 0xedbb_7432_73dc_a3ca), (0.49, 0xbc64_7b8b_1398_e330)] {
        let material = format!(
            "material = {{ young_pa = 20e3, density_kg_m3 = 1000.0, poisson = {poisson} }}"
        );
        let mut world = World::new(&drop("net", "layers = 2", &material));
        let mut end = world.silent();
        for k in 0..200 {
            end = world.at([0.035 - 1e-4 * f64::from(k), 0.003, 0.045]);
        }
        assert!(end.tools[0].force_n.norm() > 0.05);
        println!(
            "ν = {poisson}: {:#018x}, {}",
            end.state_hash, end.tools[0].force_n
        );
        assert_eq!(
            end.state_hash, expected,
            "ν = {poisson}: {:#018x}",
            end.state_hash
        );
    }
}
