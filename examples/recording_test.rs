//! Record a session, replay it, and compare: a regression test for an application that uses Palpate.
//!
//! `cargo run --example recording_test`

use palpate_client::pose_at;
use palpate_client::testing::TestSession;
use palpate_record::{Contents, Session, replay};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

type Error = Box<dyn std::error::Error>;

const SCENE: &str = include_str!("../scenes/rigid-teardrop.toml");

/// Presses the ball into the drop in lockstep, records it, and returns the recording and the
/// largest force in x, N.
fn record(daemon: &Path) -> Result<(Session, f64), Error> {
    let mut session = TestSession::of(SCENE).program(daemon).start()?;
    let mut ball = session.tool("ball")?;
    let mut peak_n = 0.0_f64;
    for k in 0..500 {
        let x_m = 0.06 - 7.5e-5 * f64::from(k);
        let force = session.step(&mut ball, pose_at([x_m, 0.003, 0.045]))?;
        peak_n = peak_n.max(force.force[0]);
    }
    let bytes = session.finish(ball)?;
    Ok((Session::parse(Path::new("session.mcap"), &bytes)?, peak_n))
}

/// Runs the example with a daemon's program.
pub fn run(daemon: PathBuf) -> Result<(), Error> {
    let (first, peak_n) = record(&daemon)?;
    println!(
        "{} ticks recorded, peak force {peak_n:.4} N",
        first.tick_count()
    );
    assert!((1.0..8.0).contains(&peak_n), "{peak_n} N");

    // The recording replays bit for bit.
    let report = replay(&first, 0, |_, _| {})?;
    assert!(report.passed());
    println!("the replay is bit-identical");

    // A second session with the same poses has the same states.
    let (second, again_n) = record(&daemon)?;
    assert_eq!(peak_n, again_n);
    let (first, second) = (Contents::of(&first)?, Contents::of(&second)?);
    assert_eq!(first.ticks.len(), second.ticks.len());
    for (a, b) in first.ticks.iter().zip(&second.ticks) {
        assert_eq!(
            a.output.state_hash, b.output.state_hash,
            "tick {}",
            a.output.tick
        );
    }
    println!("a second session is identical");
    Ok(())
}

/// Runs the example. The daemon is this program itself: started with `serve …` it behaves like
/// `palpate serve …`.
pub fn main() -> ExitCode {
    if std::env::args().nth(1).as_deref() == Some("serve") {
        return palpate::cli::main();
    }
    let done = std::env::current_exe().map_err(Error::from).and_then(run);
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
