//! `palpate plan`: what a scene compiles to, with predicted and measured cost.

use super::Outcome;
use super::pressing::Pressing;
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::TickRecord;
use palpate_sim::tick::{deform, hash, render, step};
use std::path::PathBuf;
use std::time::Instant;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Scene file, or builtin:NAME.
    scene: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Ticks that are run for a measured figure.
const TICKS: usize = 300;

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let loaded = super::scenes::load(&args.scene)?;
    let scene = loaded.build()?;
    let mut plan = scene.plan();
    let Measured {
        render_us,
        deform_us,
        touching,
    } = measure(&scene);
    let share = |prefix: &str| {
        plan.stages
            .iter()
            .filter(|stage| stage.stage.starts_with(prefix))
            .count()
            .max(1) as f64
    };
    let (renders, deforms) = (share("render"), share("deform"));
    for stage in &mut plan.stages {
        let measured = if stage.stage.starts_with("render") {
            render_us / renders
        } else {
            deform_us / deforms
        };
        stage.measured_us = Some(measured);
    }
    let findings = scene.findings();
    if args.json {
        let mut plan = serde_json::to_value(&plan)?;
        plan["warnings"] = serde_json::to_value(&findings)?;
        println!("{plan}");
    } else {
        print!("{plan}");
        for finding in &findings {
            println!("  note {}", loaded.told(finding));
        }
    }
    let tools = scene.tool_count();
    if touching < tools {
        eprintln!(
            "note: measured with {touching} of {tools} tools in contact: the others reach no body"
        );
    }
    Ok(Outcome::Ok)
}

/// Medians of ticks in contact.
struct Measured {
    render_us: f64,
    deform_us: f64,
    /// Tools in contact in the last tick.
    touching: usize,
}

/// Median µs of render and of deform while every tool presses the body nearest to it.
fn measure(scene: &Scene) -> Measured {
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    let (mut renders, mut deforms) = (Vec::with_capacity(TICKS), Vec::with_capacity(TICKS));
    let TickRecord {
        mut input,
        mut output,
        ..
    } = TickRecord::for_tools(scene.tool_count());
    let mut pressing = Pressing::new(scene);
    while pressing.approach(&mut input) {
        output = step(scene, &mut state, &mut scratch, &input);
        pressing.felt(&output);
    }
    for _ in 0..TICKS {
        pressing.hold(&mut input);
        let start = Instant::now();
        render(scene, &mut state, &mut scratch, &input, &mut output);
        let between = Instant::now();
        deform(scene, &mut state, &mut scratch, &mut output);
        hash(&state, &mut output);
        renders.push((between - start).as_secs_f64() * 1e6);
        deforms.push(between.elapsed().as_secs_f64() * 1e6);
    }
    let touching = (0..scene.tool_count())
        .filter(|&tool| output.tools[tool].contact_count > 0)
        .count();
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    Measured {
        render_us: median(&mut renders),
        deform_us: median(&mut deforms),
        touching,
    }
}
