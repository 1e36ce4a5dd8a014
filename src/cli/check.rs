//! `palpate check`: read, build, dry-run. Prints every problem of the scene.

use super::{Outcome, places, scenes, waiting::Waiting};
use palpate_sim::scene::{Scene, file};
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
    /// Accept bodies and tools whose size or mass suggests that millimetres were read as metres.
    #[arg(long)]
    any_size: bool,
}

/// Ticks that are run, with every tool at its start.
const TICKS: usize = 100;

/// Nothing that a hand presses is longer, m, or heavier, kg.
const MOST_SIZE_M: f64 = 5.0;
const MOST_MASS_KG: f64 = 2_000.0;

/// Nor is a tool this many times longer than the largest body.
const MOST_RATIO: f64 = 20.0;

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
    let plan = scene.plan();
    let predicted_us: f64 = plan.stages.iter().map(|stage| stage.predicted_us).sum();
    // The prediction is of a tick in contact, the measured ticks are not.
    let tick_us = predicted_us.max(times_us[TICKS / 2]);
    let (asked_hz, held_hz) = (1.0 / scene.dt_s, 1e6 / tick_us);
    let odd = sizes(&scene);
    let inside = places::starting_inside(&scene);
    let overlaps = places::overlaps(&scene);
    if json {
        let report = serde_json::json!({
            "scene": scene.name, "bodies": scene.body_count(), "tools": scene.tool_count(), "ticks": state.tick,
            "fault": fault, "rate_hz": asked_hz, "tick_us": tick_us, "holds_hz": held_hz.round(), "sizes": odd,
            "inside": inside, "overlaps": overlaps,
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
    for body in &plan.bodies {
        let slow = body.deformable.as_ref().and_then(|plan| plan.too_slow());
        if let Some(slow) = slow {
            eprintln!("body {}: {slow}", body.id);
        }
    }
    for tool in plan.tools {
        if let (Some(stiffness), Some(passive)) = (tool.stiffness_n_m, tool.passive_n_m)
            && stiffness > passive
        {
            eprintln!(
                "tool {}: a coupling of {stiffness} N/m exceeds what its device renders passively in any hand \
                 ({passive:.0} N/m); `bounded = true` in its coupling reduces it to that",
                tool.id
            );
        }
    }
    for problem in inside.iter().chain(&overlaps) {
        eprintln!("{problem}");
    }
    for problem in &odd {
        eprintln!("{problem}; --any-size accepts it");
    }
    if fault {
        eprintln!("the simulation diverged: a state is not finite after some ticks at rest");
        return Ok(Outcome::Fault);
    }
    if !overlaps.is_empty() {
        return Ok(Outcome::Fault);
    }
    Ok(if odd.is_empty() {
        Outcome::Ok
    } else {
        Outcome::Difference
    })
}

/// `1 body`, `2 bodies`.
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// What is too large or too heavy to be meant.
fn sizes(scene: &Scene) -> Vec<String> {
    let mut odd = Vec::new();
    let mut largest_m = 0.0_f64;
    for (b, body) in scene.plan().bodies.iter().enumerate() {
        let size_m = scene.rest_surface(b).size();
        largest_m = largest_m.max(size_m);
        let mass_kg = body.deformable.as_ref().map_or(0.0, |plan| plan.mass_kg);
        if size_m > MOST_SIZE_M || mass_kg > MOST_MASS_KG {
            let mass = match mass_kg > 0.0 {
                true => format!(" and weighs {mass_kg:.3e} kg"),
                false => String::new(),
            };
            odd.push(format!(
                "body {}: it is {size_m:.3} m long{mass}; is its file in millimetres? (\"unit\": \"mm\" in the file, --unit mm)",
                body.id
            ));
        }
    }
    for t in 0..scene.tool_count() {
        // Planes and cylinders without end are drawn as large as is asked.
        if matches!(scene.shape_name(t), "plane" | "point" | "implicit") {
            continue;
        }
        let points = scene.tool_outline(t, largest_m).points;
        let Some(first) = points.first() else {
            continue;
        };
        let (low, high) = points
            .iter()
            .fold((*first, *first), |(l, h), p| (l.inf(p), h.sup(p)));
        let size_m = (high - low).norm();
        if size_m > MOST_SIZE_M || (largest_m > 0.0 && size_m > MOST_RATIO * largest_m) {
            odd.push(format!(
                "tool {}: it is {size_m:.3} m long, the largest body {largest_m:.3} m; is its file in millimetres? \
                 (unit = \"mm\" in its shape)",
                scene.tool_id(t)
            ));
        }
    }
    odd
}
