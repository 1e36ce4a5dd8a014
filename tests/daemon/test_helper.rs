//! The client's helper for tests of one's own, as its guide shows it.

use palpate_client::pose_at;
use palpate_client::testing::{TestError, TestSession};
use palpate_record::{Contents, Session, replay};
use std::path::Path;

const PROGRAM: &str = env!("CARGO_BIN_EXE_palpate");

/// A rigid ball of 20 mm at the origin, a point held by 500 N/m.
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

#[test]
fn forces_can_be_asserted_to_the_last_digit_and_sessions_repeat_by_bits() {
    let run = || {
        let mut session = TestSession::of(SCENE).program(PROGRAM).start().unwrap();
        let mut pen = session.tool("pen").unwrap();
        assert!(pen.is_lockstep());
        let above = session.step(&mut pen, pose_at([0.0, 0.0, 0.03])).unwrap();
        assert_eq!(above.force, [0.0; 3]);
        let mut force = above;
        for k in 1..=120 {
            force = session
                .step(&mut pen, pose_at([0.0, 0.0, 0.03 - 1e-4 * f64::from(k)]))
                .unwrap();
        }
        // 2 mm deep: 500 N/m × 2 mm.
        assert!((force.force[2] - 1.0).abs() < 1e-9, "{force:?}");
        assert_eq!(force.tick, 121);
        let bytes = session.finish(pen).unwrap();
        Session::parse(Path::new("session.mcap"), &bytes).unwrap()
    };
    let (first, second) = (run(), run());
    assert_eq!(first.tick_count(), 121);
    assert!(replay(&first, 0, |_, _| {}).unwrap().passed());
    let hashes = |session: &Session| {
        let kept = Contents::of(session).unwrap();
        kept.ticks
            .iter()
            .map(|tick| tick.output.state_hash)
            .collect::<Vec<_>>()
    };
    assert_eq!(hashes(&first), hashes(&second));
}

#[test]
fn what_goes_wrong_is_told_with_the_words_of_the_daemon() {
    let wrong = TestSession::of("[[boddy]]\nid = \"x\"\n")
        .program(PROGRAM)
        .start()
        .map(|_| ());
    let Err(TestError::Ended { stderr, .. }) = &wrong else {
        panic!("{wrong:?}")
    };
    assert!(stderr.contains("boddy"), "{stderr}");
    let nowhere = TestSession::of(SCENE)
        .program("/nowhere/palpate")
        .start()
        .map(|_| ());
    assert!(
        matches!(&nowhere, Err(TestError::Io { what, .. }) if what.contains("/nowhere")),
        "{nowhere:?}"
    );
    let mut session = TestSession::of(SCENE).program(PROGRAM).start().unwrap();
    let error = session.tool("brush").map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("brush") && error.contains("pen"), "{error}");
}
