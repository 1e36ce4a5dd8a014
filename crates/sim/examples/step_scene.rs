//! Build a scene and step it in process, without a daemon.
//!
//! A probe of radius 10 mm is lowered 2 mm into a rigid ball. On a rigid body at rest the force is
//! stiffness × penetration depth.
//!
//! `cargo run -p palpate-sim --example step_scene`

use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::{TickInput, TickOutput};
use palpate_sim::tick::step;
use std::path::Path;

const SCENE: &str = r#"
[[body]]
id = "ball"
surface = { builtin = "sphere", size = 0.02 }

[[tool]]
id = "probe"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.0, 0.0, 0.04] }
coupling = { stiffness_n_m = 500.0, damping_n_s_m = 0.0 }
device = { ramp_s = 0.0 }
"#;

/// A pose of the first tool: numbered from 1, at a position, not moving, not rotated.
fn at(seq: u64, position: [f64; 3]) -> TickInput {
    let mut input = TickInput::default();
    input.poses[0] = Some(DevicePose {
        seq,
        t_client_ns: 0,
        position: Point3::from(position),
        orientation: Rotation::identity(),
        linear_velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
        buttons: 0,
    });
    input
}

/// Presses the probe 2 mm into the ball within 120 ticks; returns every output.
fn press() -> Result<Vec<TickOutput>, Box<dyn std::error::Error>> {
    let loaded = file::parse(SCENE, "step_scene.toml", Path::new("."))?;
    let scene = Scene::build(&loaded.spec, Path::new("."))?;
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    let outputs = (0..120_u64).map(|k| {
        let height_m = 0.03 - 1e-4 * k.min(20) as f64;
        step(
            &scene,
            &mut state,
            &mut scratch,
            &at(k + 1, [0.0, 0.0, height_m]),
        )
    });
    Ok(outputs.collect())
}

/// Runs the example.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let outputs = press()?;
    for output in outputs.iter().step_by(10) {
        println!("tick {:3}: {:.4} N", output.tick, output.tools[0].force_n.z);
    }
    let last = outputs.last().ok_or("no tick")?;
    // 500 N/m × 2 mm.
    assert!((last.tools[0].force_n.z - 1.0).abs() < 1e-9);

    // The same inputs give the same bits.
    let again = press()?;
    assert!(
        outputs
            .iter()
            .zip(&again)
            .all(|(a, b)| a.state_hash == b.state_hash)
    );
    println!(
        "state hash after {} ticks: {:016x}, twice",
        last.tick, last.state_hash
    );
    Ok(())
}
