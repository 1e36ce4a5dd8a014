//! Bodies in a frame that is carried about.

use crate::common::{Laws as _, World, pose};
use palpate_geometry::math::{Rotation, Vector3};
use palpate_sim::haptics::DevicePose;
use palpate_sim::tick::record::{TickInput, TickOutput};
use palpate_sim::tick::step;

/// A slab of jelly, 0.1 m × 0.1 m × 0.03 m with its underside fixed, which a hand may carry.
fn slab(frame: &str, integrator: &str) -> World {
    World::new(&format!(
        r#"
[gravity]
acceleration = [0.0, 0.0, -9.81]
{frame}
[[body]]
id = "slab"
surface = {{ builtin = "sheet", net = [7, 7], size = 0.1 }}
model = "continuum"
lattice = {{ layers = 4, refine = "none", thickness_m = 0.03 }}
fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}]
material = {{ preset = "jelly", damping_s = 0.02 }}
{integrator}
[[tool]]
id = "hand"
shape = {{ point = {{}} }}
"#
    ))
}

/// Mean displacement of the slab's coordinates from rest, m.
fn drift(world: &World) -> Vector3 {
    let rest = world.scene.deformable(0).unwrap().rest_state();
    let now = &world.state.bodies[0].deformable.as_ref().unwrap().positions;
    let moved: Vector3 = now.iter().zip(&rest.positions).map(|(a, b)| a - b).sum();
    moved / rest.positions.len() as f64
}

/// One tick with the hand at a place, turned about y.
fn tick(world: &mut World, position: [f64; 3], angle: f64) -> TickOutput {
    world.seq += 1;
    let mut input = TickInput::default();
    let orientation = Rotation::from_axis_angle(&Vector3::y_axis(), angle);
    input.poses[0] = Some(DevicePose {
        orientation,
        ..pose(world.seq, position)
    });
    step(&world.scene, &mut world.state, &mut world.scratch, &input)
}

#[test]
fn a_carried_body_feels_its_hand_tilt_and_shake() {
    let mut world = slab("frame = \"hand\"", "");
    for _ in 0..1_500 {
        tick(&mut world, [0.0; 3], 0.0);
    }
    let level = drift(&world);
    assert!(
        level.z < -1e-6 && level.x.abs() < 0.01 * level.z.abs(),
        "level: {level}"
    );
    for k in 0..3_000 {
        tick(
            &mut world,
            [0.0; 3],
            0.3 * (f64::from(k) / 1_000.0).min(1.0),
        );
    }
    // Turned about y by a positive angle, down is towards −x … of the frame: g sin(angle) against g
    // cos(angle).
    let tilted = drift(&world);
    assert!(tilted.x.abs() > 0.2 * level.z.abs(), "tilted: {tilted}");
    assert!(
        (tilted.x > 0.0)
            == (Rotation::from_axis_angle(&Vector3::y_axis(), -0.3) * -Vector3::z())
                .x
                .is_sign_positive()
    );
    // A hand that speeds up throws it back.
    for k in 0..100 {
        let t = f64::from(k) * 1e-3;
        tick(&mut world, [0.0, 0.5 * 20.0 * t * t, 0.0], 0.3);
    }
    assert!(drift(&world).y < -1e-5, "thrown back: {}", drift(&world));
}

#[test]
fn a_carried_body_at_rest_stays_awake_for_its_hand() {
    // Slower than a millimetre a second is still: at rest on a table this slab sleeps.
    let settings = "integrator = { sleep_m_s = 1e-3 }";
    let (mut table, mut carried) = (slab("", settings), slab("frame = \"hand\"", settings));
    let slept = |world: &World| world.state.bodies[0].deformable.as_ref().unwrap().slept;
    for _ in 0..800 {
        // The point of the tool is out of the slab's way.
        tick(&mut table, [0.0, 0.0, 1.0], 0.0);
        tick(&mut carried, [0.0, 0.0, 1.0], 0.0);
    }
    assert!(
        slept(&table) > 200,
        "on the table it slept {} ticks",
        slept(&table)
    );
    let level = drift(&carried);
    for k in 0..2_000 {
        tick(
            &mut carried,
            [0.0, 0.0, 1.0],
            0.3 * (f64::from(k) / 1_000.0).min(1.0),
        );
    }
    let tilted = drift(&carried);
    assert!(
        tilted.x.abs() > 0.2 * level.z.abs(),
        "level: {level}, tilted: {tilted}"
    );
    assert_eq!(slept(&carried), 0);
}
