//! Libraries that are Python modules.

use serde::de::DeserializeOwned;
use std::io::Write;
use std::process::{Command, Stdio};

/// Names a Python that can import what the scripts need.
pub const PYTHON: &str = "PALPATE_PYTHON";

/// Runs a script that reads JSON and prints JSON: its last line that is an answer, or why there is none.
/// `None` where no Python is named.
pub fn answer<A: DeserializeOwned>(
    script: &str,
    input: &serde_json::Value,
) -> Option<Result<A, String>> {
    let program = std::env::var(PYTHON).ok()?;
    Some(run(&program, script, input))
}

fn run<A: DeserializeOwned>(
    program: &str,
    script: &str,
    input: &serde_json::Value,
) -> Result<A, String> {
    let said = |e: std::io::Error| format!("{program}: {e}");
    let mut child = Command::new(program)
        .args(["-c", script])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(said)?;
    if let Some(mut stdin) = child.stdin.take() {
        stdin
            .write_all(input.to_string().as_bytes())
            .map_err(said)?;
    }
    let output = child.wait_with_output().map_err(said)?;
    // Engines print banners.
    let text = String::from_utf8_lossy(&output.stdout);
    let answer = text
        .lines()
        .rev()
        .find_map(|line| serde_json::from_str(line).ok());
    answer.ok_or_else(|| {
        let errors = String::from_utf8_lossy(&output.stderr);
        let last = errors.lines().rfind(|line| !line.trim().is_empty());
        format!("it did not run: {}", last.unwrap_or("no message"))
    })
}
