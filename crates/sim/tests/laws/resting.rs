//! Bodies that lie on others are left alone until something comes near.

use crate::common::{Laws as _, World};
use palpate_geometry::math::{SavedState, Vector3};
use palpate_geometry::surface::{builtin, file};
use palpate_sim::tick::restore;

/// A soft lentil on a slope of half the coefficient of friction, and a ball far above it.
fn lentil() -> World {
    let mut surface = builtin("sphere", None, Some(0.02)).unwrap();
    for point in surface.net_mut().points_mut() {
        point.z *= 0.4;
    }
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("lentil.json");
    std::fs::write(&path, file::write(&surface, file::Unit::Metre)).unwrap();
    let angle = slope_rad();
    let text = format!(
        r#"
[gravity]
acceleration = [{}, 0.0, {}]
[[body]]
id = "floor"
surface = {{ builtin = "sheet", size = 0.4 }}
[[body]]
id = "lentil"
surface = {{ file = {path:?} }}
pose = {{ position = [0.0, 0.0, 0.008] }}
model = "lattice"
material = {{ young_pa = 20e3, density_kg_m3 = 1000.0, damping_s = 5e-3 }}
lattice = {{ layers = 2, refine = "none" }}
[[contact]]
pair = ["lentil", "floor"]
friction = {{ mu = 0.3 }}
[[tool]]
id = "ball"
shape = {{ sphere = {{ radius_m = 0.005 }} }}
pose = {{ position = [0.0, 0.0, 0.1] }}
"#,
        9.81 * libm::sin(angle),
        -9.81 * libm::cos(angle)
    );
    World::new(&text)
}

fn slope_rad() -> f64 {
    libm::atan(0.15)
}

const HIGH: [f64; 3] = [0.0, 0.0, 0.1];

fn is_left_alone(world: &World) -> bool {
    let lentil = world.state.bodies[1].deformable.as_ref().unwrap();
    lentil.is_left_alone()
}

/// Until the lentil lies still.
fn come_to_rest(world: &mut World) {
    let ticks = (0..8_000).find(|_| {
        world.at_in_place(HIGH);
        is_left_alone(world)
    });
    println!("at rest after {ticks:?} ticks");
    assert!(ticks.is_some(), "the lentil never came to rest");
}

fn net(world: &World) -> Vec<palpate_geometry::math::Point3> {
    let mut net = world.scene.rest_surface(1).unwrap().net().points().to_vec();
    world.state.copy_net(&world.scene, 1, &mut net);
    net
}

#[test]
fn a_body_that_lies_on_another_is_left_alone_with_its_forces() {
    let mut world = lentil();
    let mass = world.scene.deformable(1).unwrap().mass_kg();
    come_to_rest(&mut world);
    let before = net(&world);
    let warm = world.state.warm.rows().len();
    for _ in 0..500 {
        let output = world.at_in_place(HIGH).clone();
        let total: Vector3 = output.contacts.list().iter().map(|c| c.force_n).sum();
        // The normals of the list point from the lentil to the floor or the other way round. Contact
        // forces tremble by a percent and more from tick to tick; those that stay bear the weight.
        let bears = |force: Vector3| {
            let up = Vector3::new(-libm::sin(slope_rad()), 0.0, libm::cos(slope_rad()));
            (force / (9.81 * mass) - up).norm() < 6e-3
        };
        let upwards = total * total.z.signum();
        assert!(bears(upwards), "{total} N reported for {mass} kg");
        let on_lentil = world.scratch.contact_force_on(1);
        assert!(bears(on_lentil), "{on_lentil} for {mass} kg");
        assert_eq!(
            world.scratch.row_count(),
            0,
            "its rows are gathered all the same"
        );
    }
    assert_eq!(net(&world), before, "it moved");
    assert_eq!(world.state.warm.rows().len(), warm, "forces were forgotten");

    // A tool comes near: the body steps again, from where it was, and is pressed.
    let mut force = 0.0;
    for k in 0..1_500 {
        let z = 0.1 - 0.0835 * f64::from(k.min(1_000)) / 1_000.0;
        force = world.at([0.0, 0.0, z]).tools[0].force_n.z;
        if force == 0.0 && k < 900 {
            let now = net(&world);
            let moved = now.iter().zip(&before).map(|(a, b)| (a - b).norm());
            let most = moved.fold(0.0, f64::max);
            assert!(most < 2e-5, "tick {k}: {most} m from where it lay");
        }
    }
    assert!(!is_left_alone(&world), "it is pressed and yet left alone");
    assert!(force > 0.05, "pressed with {force} N");
}

#[test]
fn a_state_saved_while_a_body_is_left_alone_goes_on_bit_for_bit() {
    let mut world = lentil();
    come_to_rest(&mut world);
    for _ in 0..50 {
        world.at_in_place(HIGH);
    }
    let mut saved = SavedState::default();
    saved.save_from(&world.state);
    let mut other = lentil();
    restore(&other.scene, &mut other.state, &mut other.scratch, &saved).unwrap();
    other.seq = world.seq;
    for k in 0..1_500 {
        let z = 0.1 - 0.0835 * f64::from(k.min(1_000)) / 1_000.0;
        let (a, b) = (world.at([0.0, 0.0, z]), other.at([0.0, 0.0, z]));
        assert_eq!(a, b, "tick {k} after the keyframe");
    }
}

#[test]
fn balls_whose_contacts_tremble_are_left_alone_where_they_lie() {
    for model in ["lattice", "continuum", "net"] {
        // Few control points, one pole down: contact is at three or four points that wander.
        let mut world = World::new(&format!(
            r#"
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[body]]
id = "floor"
surface = {{ builtin = "sheet", size = 0.4 }}
[[body]]
id = "ball"
surface = {{ builtin = "sphere", size = 0.02 }}
pose = {{ position = [0.0, 0.0, 0.02] }}
model = "{model}"
material = {{ young_pa = 20e3, density_kg_m3 = 1000.0, damping_s = 5e-3 }}
lattice = {{ layers = 2, refine = "none" }}
[[tool]]
id = "ball"
shape = {{ sphere = {{ radius_m = 0.005 }} }}
pose = {{ position = [0.0, 0.0, 0.1] }}
"#
        ));
        let mass = world.scene.deformable(1).unwrap().mass_kg();
        let ticks = (0..4_000).find(|_| {
            world.at_in_place(HIGH);
            is_left_alone(&world)
        });
        let borne = world.scratch.contact_force_on(1).norm() / (9.81 * mass);
        println!("{model}: at rest after {ticks:?} ticks, borne {borne:.4} of its weight");
        assert!(ticks.is_some(), "{model}: it never came to rest");
        // On average it is the weight; what is kept are the forces of one tick.
        assert!((borne - 1.0).abs() < 0.05, "{model}: {borne}");
    }
}
