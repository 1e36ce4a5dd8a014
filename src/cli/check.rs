//! `palpate check`: read, build, dry-run. Prints every problem of the scene.

use super::{Outcome, scenes, waiting::Waiting};
use palpate_sim::scene::{FindingKind, file};
use palpate_sim::tick::record::TickInput;
use palpate_sim::tick::step;
use std::path::PathBuf;
use std::time::Instant;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Scene file, or builtin:NAME (see `palpate scenes`).
    scene: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
    /// Accept what is unusual: sizes and values that suggest a slip of units, such as millimetres read as metres.
    #[arg(long)]
    any_size: bool,
}

/// Ticks that are run, with every tool at its start.
const TICKS: usize = 100;

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let loaded = scenes::load(&args.scene)?;
    let outcome = judge(&loaded, args.json)?;
    Ok(match outcome {
        Outcome::Difference if args.any_size => Outcome::Ok,
        outcome => outcome,
    })
}

/// Builds a scene, runs some ticks and prints what stands out.
///
/// # Errors
/// A scene that cannot be built.
pub fn judge(loaded: &file::Loaded, json: bool) -> anyhow::Result<Outcome> {
    let scene = {
        let _waiting = Waiting::begin("building the scene");
        loaded.build()?
    };
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    let mut fault = false;
    let mut times_us = Vec::with_capacity(TICKS);
    for _ in 0..TICKS {
        let begun = Instant::now();
        fault |= step(&scene, &mut state, &mut scratch, &TickInput::default())
            .fault
            .is_some();
        times_us.push(begun.elapsed().as_secs_f64() * 1e6);
    }
    times_us.sort_by(f64::total_cmp);
    // The prediction is of a tick in contact, the measured ticks are not.
    let tick_us = scene.predicted_tick_us().max(times_us[TICKS / 2]);
    let (asked_hz, held_hz) = (1.0 / scene.dt_s, 1e6 / tick_us);
    let findings = scene.findings();
    if json {
        let report = serde_json::json!({
            "scene": scene.name, "bodies": scene.body_count(), "tools": scene.tool_count(), "ticks": state.tick,
            "fault": fault, "rate_hz": asked_hz, "tick_us": tick_us, "holds_hz": held_hz.round(), "warnings": findings,
        });
        println!("{report}");
    } else {
        println!(
            "{}: {}, {}, {} ticks run; a tick in contact takes about {tick_us:.0} us, which allows {held_hz:.0} Hz of {asked_hz:.0}",
            scene.name,
            counted(scene.body_count(), "body", "bodies"),
            counted(scene.tool_count(), "tool", "tools"),
            state.tick
        );
    }
    if held_hz < asked_hz {
        eprintln!(
            "too slow for {asked_hz:.0} Hz here: use a coarser net or fewer layers, `every` to step bodies apart, or a lower \
             rate_hz; `palpate plan` shows what costs, `palpate doctor SCENE` measures"
        );
    }
    for finding in &findings {
        let accept = match finding.kind {
            FindingKind::Unusual => "; --any-size accepts it",
            FindingKind::Wrong | FindingKind::Limit => "",
        };
        eprintln!("{}{accept}", loaded.message(finding));
    }
    let is = |kind| findings.iter().any(|finding| finding.kind == kind);
    if fault {
        eprintln!(
            "the simulation diverged: a body came apart or was not finite after some ticks at rest"
        );
    }
    Ok(match () {
        () if fault || is(FindingKind::Wrong) => Outcome::Fault,
        () if is(FindingKind::Unusual) => Outcome::Difference,
        () => Outcome::Ok,
    })
}

/// `1 body`, `2 bodies`.
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
