//! A client that moves a tool and reads its forces.
//!
//! ```sh
//! cargo build                                                  # the daemon
//! cargo run -p palpate-client --example tool_client             # starts a daemon of its own
//! cargo run -p palpate-client --example tool_client tcp/127.0.0.1:7447   # connects to one
//! ```
//! Connected to a running daemon it takes the first tool of its scene and holds it at its start for
//! one second. With a daemon of its own, in lockstep, it presses a point 2 mm into a rigid ball.

use palpate_client::testing::TestSession;
use palpate_client::{Connect, Palpate, pose_at};
use std::path::PathBuf;
use std::time::Duration;

type Error = Box<dyn std::error::Error>;

const SCENE: &str = r#"
[[body]]
id = "ball"
surface = { builtin = "sphere", size = 0.02 }

[[tool]]
id = "pen"
shape = { point = {} }
pose = { position = [0.0, 0.0, 0.03] }
coupling = { stiffness_n_m = 500.0, damping_n_s_m = 0.0 }
device = { ramp_s = 0.0 }
"#;

/// Presses a point into a ball, in lockstep: each pose gets the force of its own tick.
pub fn press(daemon: PathBuf) -> Result<(), Error> {
    let mut session = TestSession::of(SCENE).program(daemon).start()?;
    let mut pen = session.tool("pen")?;
    let mut force_n = 0.0;
    for k in 0..=120 {
        let height_m = 0.03 - 1e-4 * f64::from(k);
        force_n = session.step(&mut pen, pose_at([0.0, 0.0, height_m]))?.force[2];
        if k % 10 == 0 {
            println!("{:.1} mm: {force_n:.4} N", height_m * 1e3);
        }
    }
    // 500 N/m × 2 mm.
    assert!((force_n - 1.0).abs() < 1e-9, "{force_n} N");
    session.finish(pen)?;
    Ok(())
}

/// Holds the first tool of a running daemon at its start for one second.
pub fn hold(endpoint: &str) -> Result<u64, Error> {
    let palpate = Palpate::connect(&Connect::to(endpoint))?;
    let scene = palpate.scene()?;
    let first = scene.tools.first().ok_or("the scene has no tool")?;
    let mut tool = palpate.tool(&first.id)?;
    let mut answered = 0;
    for _ in 0..1000 {
        let seq = tool.send(pose_at(first.position))?;
        if let Some(force) = tool.wait_force(seq, Duration::from_millis(50)) {
            answered += 1;
            if answered % 100 == 0 {
                println!("tick {}: {:?} N", force.tick, force.force);
            }
        }
    }
    println!("{answered} of 1000 poses were answered");
    Ok(answered)
}

/// The daemon: named by the environment variable `PALPATE`, or built next to this example.
fn daemon() -> Result<PathBuf, Error> {
    if let Some(path) = std::env::var_os("PALPATE") {
        return Ok(path.into());
    }
    let example = std::env::current_exe()?;
    let directory = example.ancestors().nth(2).ok_or("no build directory")?;
    let path = directory
        .join("palpate")
        .with_extension(std::env::consts::EXE_EXTENSION);
    match path.exists() {
        true => Ok(path),
        false => Err(format!("{} is missing: run `cargo build` first", path.display()).into()),
    }
}

/// Runs the example.
pub fn main() -> Result<(), Error> {
    match std::env::args().nth(1) {
        Some(endpoint) => match hold(&endpoint)? {
            0 => Err("no pose was answered".into()),
            _ => Ok(()),
        },
        None => press(daemon()?),
    }
}
