//! `palpate plan`: what a scene compiles to, with predicted and measured cost.

use super::Outcome;
use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::TickRecord;
use palpate_sim::tick::{deform, hash, render};
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
    let (render_us, deform_us) = measure(&scene);
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
    if args.json {
        println!("{}", serde_json::to_string(&plan)?);
    } else {
        print!("{plan}");
    }
    Ok(Outcome::Ok)
}

/// Median µs of render and of deform with every tool held at its start.
fn measure(scene: &Scene) -> (f64, f64) {
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    let (mut renders, mut deforms) = (Vec::with_capacity(TICKS), Vec::with_capacity(TICKS));
    let TickRecord {
        mut input,
        mut output,
        ..
    } = TickRecord::for_tools(scene.tool_count());
    for k in 0..TICKS {
        for (t, tool) in scene.spec.tools.iter().enumerate() {
            input.poses[t] = Some(DevicePose {
                seq: k as u64 + 1,
                t_client_ns: 0,
                position: Point3::from(tool.pose.position),
                orientation: Rotation::identity(),
                linear_velocity: Vector3::zeros(),
                angular_velocity: Vector3::zeros(),
                buttons: 0,
            });
        }
        let start = Instant::now();
        render(scene, &mut state, &mut scratch, &input, &mut output);
        let between = Instant::now();
        deform(scene, &mut state, &mut scratch, &mut output);
        hash(&state, &mut output);
        renders.push((between - start).as_secs_f64() * 1e6);
        deforms.push(between.elapsed().as_secs_f64() * 1e6);
    }
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    (median(&mut renders), median(&mut deforms))
}
