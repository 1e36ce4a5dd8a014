//! Build a scene and step it in process, without a daemon.
//!
//! A probe of radius 10 mm is lowered 2 mm into a rigid ball. On a rigid body at rest the force is
//! stiffness × penetration depth.
//!
//! `cargo run -p palpate-sim --example step_scene`

use palpate_sim::World;
use palpate_sim::scene::SceneError;
use palpate_sim::tick::record::TickOutput;

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

/// Presses the probe 2 mm into the ball within 120 ticks; returns every output.
fn press() -> Result<Vec<TickOutput>, SceneError> {
    let mut world = World::parse(SCENE)?;
    let height_m = |k: u32| 0.03 - 1e-4 * f64::from(k.min(20));
    Ok((0..120)
        .map(|k| world.at([0.0, 0.0, height_m(k)]))
        .collect())
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
