//! The examples that need a daemon run and hold what they assert.

use std::path::PathBuf;

#[allow(dead_code, reason = "its main is for people")]
#[path = "../../examples/recording_test.rs"]
mod recording_test;
#[allow(dead_code, reason = "its main is for people")]
#[path = "../../clients/rust/examples/tool_client.rs"]
mod tool_client;

fn program() -> PathBuf {
    env!("CARGO_BIN_EXE_palpate").into()
}

#[test]
fn recording_test_runs() {
    recording_test::run(program()).unwrap();
}

#[test]
fn tool_client_runs() {
    tool_client::press(program()).unwrap();
}
