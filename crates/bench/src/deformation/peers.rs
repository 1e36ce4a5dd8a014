//! The same press by other engines: rapier3d in this process, MuJoCo and PyBullet in a Python's.

use super::scenes::SCALES;
use super::{BOX_REFERENCE_N, Effort, Row};
use crate::Times;
use crate::peers::python::PYTHON;
use std::io::Write;
use std::process::{Command, Stdio};

/// What presses in Python: prints one JSON object.
const SCRIPT: &str = include_str!("../../../../benches/peers/deformation.py");

/// What an engine did.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
struct Pressed {
    method: String,
    median_s: f64,
    p99_s: f64,
    /// At rest, N.
    force_n: f64,
    /// Least and greatest force over the end of the press, N.
    range_n: [f64; 2],
    n: usize,
}

/// Rows of all stiffnesses; only of the least and the greatest when `hurried`.
pub(super) fn rows(
    effort: Effort,
    hurried: bool,
    wanted: &dyn Fn(&str) -> bool,
    out: &mut dyn FnMut(Row),
) {
    for (scale, label) in SCALES
        .into_iter()
        .filter(|(scale, _)| !hurried || [1.0, 1000.0].contains(scale))
    {
        let case = format!("indent/12/{label}");
        #[cfg(feature = "peers")]
        if wanted(&format!("indent/12/rapier3d/{label}")) || wanted(&format!("{case}/rapier3d")) {
            rapier(&case, scale, effort, out);
        }
        for engine in ["mujoco", "pybullet"] {
            if wanted(&format!("indent/12/{engine}/{label}")) || wanted(&format!("{case}/{engine}"))
            {
                python(&case, engine, scale, effort, out);
            }
        }
    }
}

/// 0.1 s of pressing, then held.
fn ticks(effort: Effort) -> [usize; 2] {
    if effort == Effort::Quick {
        [100, 60]
    } else {
        [100, 500]
    }
}

#[cfg(feature = "peers")]
fn rapier(case: &str, scale: f64, effort: Effort, out: &mut dyn FnMut(Row)) {
    use super::super::measure::clocked;
    use super::super::peers::rapier::{SoftBox, Solver};
    let mut variants = vec![("rapier3d, 4 substeps", 4, Solver::Rows)];
    if effort == Effort::Full {
        variants.push(("rapier3d, 1 substep", 1, Solver::Rows));
        variants.push(("rapier3d fem, 1 substep", 1, Solver::Elements));
    }
    let [press, hold] = ticks(effort);
    for (method, substeps, solver) in variants {
        let mut soft = SoftBox::new(12, 20e3 * scale, 1e-3, substeps, solver);
        let (mut times, mut forces) = (Vec::new(), Vec::new());
        for k in 0..press + hold {
            let depth = 0.01 * ((k + 1) as f64 / press as f64).min(1.0);
            let (took, force) = clocked(|| soft.press(depth));
            times.push(took.as_secs_f64());
            forces.push(force);
        }
        times.sort_by(f64::total_cmp);
        let last = &forces[forces.len() - 50..];
        let least = last.iter().copied().fold(f64::INFINITY, f64::min);
        let most = last.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let pressed = Pressed {
            method: method.to_owned(),
            median_s: times[times.len() / 2],
            p99_s: times[(times.len() - 1) * 99 / 100],
            force_n: last.iter().sum::<f64>() / 50.0,
            range_n: [least, most],
            n: times.len(),
        };
        out(row(case, scale, &pressed));
    }
}

fn python(case: &str, engine: &str, scale: f64, effort: Effort, out: &mut dyn FnMut(Row)) {
    let Ok(program) = std::env::var(PYTHON) else {
        return;
    };
    match pressed(&program, engine, scale, ticks(effort)) {
        Ok(pressed) => out(row(case, scale, &pressed)),
        Err(why) => out(Row {
            method: engine.to_owned(),
            peer: true,
            ..super::indent::failed(case, &why)
        }),
    }
}

/// What the script says; or why it says nothing.
fn pressed(
    program: &str,
    engine: &str,
    scale: f64,
    [press, hold]: [usize; 2],
) -> Result<Pressed, String> {
    let mut command = Command::new(program);
    command.args([
        "-",
        engine,
        &scale.to_string(),
        &press.to_string(),
        &hold.to_string(),
    ]);
    let child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = child.map_err(|e| format!("{program}: {e}"))?;
    if let Some(mut stdin) = child.stdin.take() {
        stdin
            .write_all(SCRIPT.as_bytes())
            .map_err(|e| format!("{program}: {e}"))?;
    }
    let output = child
        .wait_with_output()
        .map_err(|e| format!("{program}: {e}"))?;
    let said = String::from_utf8_lossy(&output.stdout);
    parsed(&said).ok_or_else(|| {
        let errors = String::from_utf8_lossy(&output.stderr);
        let last = errors
            .lines()
            .rfind(|line| !line.trim().is_empty())
            .unwrap_or("no message");
        format!("{engine} did not run: {last}")
    })
}

/// The last line that is an answer: engines print banners.
fn parsed(said: &str) -> Option<Pressed> {
    said.lines()
        .rev()
        .find_map(|line| serde_json::from_str(line).ok())
}

fn row(case: &str, scale: f64, pressed: &Pressed) -> Row {
    let unscaled = |force_n: f64| force_n / scale;
    let [least, most] = pressed.range_n.map(unscaled);
    let row = Row::new("deformation", case, &pressed.method).timed(Times {
        median_s: pressed.median_s,
        p99_s: pressed.p99_s,
        n: pressed.n,
    });
    let error = unscaled(pressed.force_n) / BOX_REFERENCE_N - 1.0;
    Row {
        peer: true,
        ..row.off_by(error, "of the force")
    }
    .saying(format!(
        "F/scale {:.4} N, {least:.4} to {most:.4} N while held",
        unscaled(pressed.force_n)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_after_a_banner_is_a_row_with_a_signed_error() {
        let said = "engine 4.0\n{\"method\": \"m\", \"median_s\": 0.01, \"p99_s\": 0.02, \"force_n\": 42.0, \
                    \"range_n\": [40.0, 44.0], \"n\": 200}\n";
        let row = row("indent/12/x10", 10.0, &parsed(said).unwrap());
        assert!(
            (row.error.unwrap().value - (4.2 / 5.25 - 1.0)).abs() < 1e-12 && row.peer,
            "{row:?}"
        );
        assert!(row.note.contains("4.0000 to 4.4000"), "{}", row.note);
        assert_eq!(parsed("engine 4.0\n"), None);
    }

    #[test]
    fn a_python_that_is_not_there_is_a_reason_and_no_panic() {
        assert!(
            pressed("no-such-python", "mujoco", 1.0, [1, 1])
                .unwrap_err()
                .contains("no-such-python")
        );
    }
}
