//! Parts against all that is no ball and no plane: solid tools, bodies that deform, each other.

use crate::common::{Laws as _, World, pose, step_file};
use palpate_geometry::math::{Point3, Random, Vector3};
use palpate_geometry::skin::SkinSolver;

const STIFFNESS_N_M: f64 = 500.0;

fn part(more: &str) -> String {
    format!(
        "[[body]]\nid = \"part\"\nsurface = {{ inline = {{ step = '''\n{}''' }} }}\n{more}\n",
        step_file("filleted_box")
    )
}

fn tool(shape: &str, start: [f64; 3]) -> String {
    format!(
        "[[tool]]\nid = \"tool\"\nshape = {{ {shape} }}\npose = {{ position = {start:?} }}\n\
         coupling = {{ stiffness_n_m = {STIFFNESS_N_M}, damping_n_s_m = 0.0 }}\n\
         device = {{ force_max_n = 500.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }}\n"
    )
}

// Solids of every kind press on the top of a rounded box, 20 mm high, with the force of their depth, and slide over it.
#[test]
fn solid_tools_press_a_part_with_the_force_of_their_depth() {
    let shapes = [
        ("box = { half_extents_m = [0.006, 0.005, 0.004] }", 0.004),
        (
            "capsule = { radius_m = 0.003, half_length_m = 0.005 }",
            0.008,
        ),
        ("surface = { builtin = \"sphere\", size = 0.005 }", 0.005),
    ];
    for (shape, below_m) in shapes {
        let start = [0.02, 0.02, 0.06];
        let mut world = World::new(&(part("") + &tool(shape, start)));
        let mut worst = 0.0_f64;
        for k in 0..1_200 {
            let down_m = 1e-4 * f64::from(k.min(200));
            let x = 0.02 + 2e-5 * f64::from((k - 300).clamp(0, 900));
            let at = [x, 0.02, 0.02 + below_m + 0.0185 - down_m];
            let force = world.at(at).tools[0].force_n;
            let depth_m = 0.02 + below_m - at[2];
            if k > 220 {
                worst = worst
                    .max((force - Vector3::z() * STIFFNESS_N_M * depth_m).norm() / STIFFNESS_N_M);
            }
        }
        println!("{shape}: off by {worst:e} m");
        // A ball of control points is round to 1e-5 of its radius.
        assert!(worst < 2e-6, "{shape}: off by {worst} m");
    }
}

fn net(world: &World, body: usize) -> Vec<Point3> {
    let mut points = world.scene.skin(body).points().to_vec();
    world.state.copy_net(&world.scene, body, &mut points);
    points
}

// One part lies on another that is fixed: level, still, with all its weight.
#[test]
fn a_free_part_lies_on_a_part() {
    let upper = "free = true\nmaterial = { density_kg_m3 = 2700.0 }\npose = { position = [0.012, 0.007, 0.0205] }\n";
    let text = "[gravity]\nacceleration = [0.0, 0.0, -9.81]\n".to_owned()
        + &part("")
        + &part(upper).replace("id = \"part\"", "id = \"upper\"")
        + "[[contact]]\npair = [\"part\", \"upper\"]\nfriction = { mu = 0.5 }\n"
        + &tool("sphere = { radius_m = 0.002 }", [0.0, 0.0, 0.2]);
    let mut world = World::new(&text);
    for _ in 0..600 {
        world.silent();
    }
    let before = net(&world, 1);
    let mut weight_n = Vector3::zeros();
    for _ in 0..400 {
        world.silent();
        weight_n += world.scratch.contact_force_on(1) / 400.0;
    }
    let after = net(&world, 1);
    let moved = before.iter().zip(&after).map(|(a, b)| (a - b).norm());
    let moved_m = moved.fold(0.0, f64::max);
    let mut heights_m: Vec<f64> = after.iter().map(|p| p.z).collect();
    heights_m.sort_by(f64::total_cmp);
    let part = world.scene.skin(1).part().expect("a part").part();
    let mass_kg = 2700.0 * part.moments().expect("closed").volume_m3;
    println!(
        "moved {moved_m:e} m, bears {weight_n:?} N of {}, {heights_m:?}",
        mass_kg * 9.81
    );
    assert!(moved_m < 1e-6, "{moved_m} m");
    assert!(
        (heights_m[0] - 0.02).abs() < 2e-5 && heights_m[3] - heights_m[0] < 2e-6,
        "{heights_m:?}"
    );
    assert!(
        (weight_n - Vector3::z() * mass_kg * 9.81).norm() < 1e-3 * mass_kg * 9.81,
        "{weight_n:?}"
    );
}

// A ball of jelly comes down on a part, lies on it and goes into it nowhere.
#[test]
fn a_jelly_lies_on_a_part() {
    let jelly = "[[body]]\nid = \"jelly\"\nsurface = { builtin = \"sphere\", size = 0.015 }\nmodel = \"lattice\"\n\
        pose = { position = [0.03, 0.02, 0.0355] }\nlattice = { layers = 2, refine = \"none\" }\n\
        material = { young_pa = 20e3, density_kg_m3 = 1000.0, damping_s = 5e-3 }\n";
    let text = "[gravity]\nacceleration = [0.0, 0.0, -9.81]\n".to_owned()
        + &part("")
        + jelly
        + &tool("sphere = { radius_m = 0.002 }", [0.0, 0.0, 0.2]);
    let mut world = World::new(&text);
    let mass_kg = world.scene.deformable(1).expect("jelly").mass_kg();
    for _ in 0..1_500 {
        world.silent();
    }
    let mut weight_n = Vector3::zeros();
    for _ in 0..500 {
        world.silent();
        weight_n += world.scratch.contact_force_on(1) / 500.0;
    }
    let surface = world
        .scene
        .surface_with(1, &net(&world, 1))
        .expect("a surface")
        .expect("a surface");
    let mut solver = SkinSolver::new(world.scene.skin(0));
    let mut random = Random(3);
    let mut deepest_m = 0.0_f64;
    for _ in 0..20_000 {
        let p = surface.point(random.unit(), random.unit());
        deepest_m = deepest_m.max(-solver.closest(world.scene.skin(0), &p).signed_distance);
    }
    println!(
        "bears {weight_n:?} N of {}, {deepest_m:e} m deep",
        mass_kg * 9.81
    );
    assert!(
        (weight_n.z / (mass_kg * 9.81) - 1.0).abs() < 1e-2,
        "{weight_n:?}"
    );
    assert!(deepest_m < 5e-5, "{deepest_m} m deep");
}

// The part is pushed by nothing: what moves into a fixed one is held, from any side and at any angle.
#[test]
fn a_turned_block_presses_a_part_with_its_lowest_corner() {
    let mut random = Random(5);
    let half = Vector3::new(0.006, 0.005, 0.004);
    let mut worst = 0.0_f64;
    for _ in 0..8 {
        let turn = random.rotation();
        let lowest_m = turn
            .inverse_transform_vector(&Vector3::z())
            .abs()
            .dot(&half);
        let shape = "box = { half_extents_m = [0.006, 0.005, 0.004] }";
        let mut world = World::new(&(part("") + &tool(shape, [0.03, 0.02, 0.06])));
        let mut force_n = Vector3::zeros();
        for k in 0..400 {
            let height_m = 0.02 + lowest_m + 0.02 - 1e-4 * f64::from(k.min(215));
            let mut device = pose(0, [0.03, 0.02, height_m]);
            device.orientation = turn;
            force_n = world.posed(device).tools[0].force_n;
        }
        worst = worst.max((force_n - Vector3::z() * STIFFNESS_N_M * 0.0015).norm() / STIFFNESS_N_M);
    }
    println!("off by {worst:e} m");
    assert!(worst < 1e-7, "off by {worst} m");
}
