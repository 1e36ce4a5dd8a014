//! A tool whose shape is a function of x, y, z: a rounded cube, x⁸ + y⁸ + z⁸ ≤ a⁸.
//!
//! The scene file gives the function as text; the gradient comes from automatic differentiation.
//! The tool is pressed with one face against a rigid ball, where it acts like a flat plate.
//!
//! `cargo run -p palpate-sim --example custom_shape`

use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::TickInput;
use palpate_sim::tick::step;
use std::path::Path;

// Lengths in units of 10 mm keep the eighth powers near 1. Taking the eighth root makes the function
// grow like a distance.
const SCENE: &str = r#"
[[body]]
id = "ball"
surface = { builtin = "sphere", size = 0.02 }

[[tool]]
id = "cube"
shape = { implicit = { f = "0.01 * (((x/0.01)^8 + (y/0.01)^8 + (z/0.01)^8 + 1e-12)^0.125 - 1)", reach_m = 0.018 } }
pose = { position = [0.0, 0.0, 0.04] }
coupling = { stiffness_n_m = 500.0, damping_n_s_m = 0.0 }
device = { ramp_s = 0.0 }
"#;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let loaded = file::parse(SCENE, "custom_shape.toml", Path::new("."))?;
    let scene = Scene::build(&loaded.spec, Path::new("."))?;
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    let mut force_n = Vector3::zeros();
    for k in 0..400_u64 {
        // Down to 29 mm: the lower face is then 1 mm inside the ball of radius 20 mm.
        let height_m = 0.031 - 2e-5 * k.min(100) as f64;
        let mut input = TickInput::default();
        input.poses[0] = Some(DevicePose {
            seq: k + 1,
            t_client_ns: 0,
            position: Point3::new(0.0, 0.0, height_m),
            orientation: Rotation::identity(),
            linear_velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            buttons: 0,
        });
        let output = step(&scene, &mut state, &mut scratch, &input);
        assert!(output.fault.is_none());
        force_n = output.tools[0].force_n;
        if k % 40 == 0 {
            println!("{:.2} mm: {:.4} N", height_m * 1e3, force_n.z);
        }
    }
    // 500 N/m × 1 mm, straight up.
    assert!(
        (force_n - Vector3::new(0.0, 0.0, 0.5)).norm() < 1e-6,
        "{force_n}"
    );
    Ok(())
}
