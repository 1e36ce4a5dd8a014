//! `palpate plan`: what a scene compiles to, with predicted and measured cost.

use super::Outcome;
use anyhow::Context as _;
use palpate_experiment::press::{Measured, beside_finer, measure};
use std::path::PathBuf;
use std::sync::Arc;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Scene file, or builtin:NAME.
    scene: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
    /// Also press the scene with finer nets and one more layer, and print how far its forces at rest are from theirs.
    #[arg(long)]
    finer: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let loaded = super::scenes::load(&args.scene)?;
    let scene = Arc::new(loaded.build()?);
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
    let rest = args
        .finer
        .then(|| beside_finer(&loaded, &scene))
        .transpose()
        .context("with finer nets the scene cannot be built")?;
    if args.json {
        let mut plan = serde_json::to_value(&plan)?;
        plan["warnings"] = serde_json::to_value(&findings)?;
        if let Some(rest) = &rest {
            plan["rest"] = serde_json::to_value(rest)?;
        }
        println!("{plan}");
    } else {
        print!("{plan}");
        for tool in rest.iter().flatten() {
            println!("  {tool}");
        }
        for finding in &findings {
            println!("  note {}", loaded.message(finding));
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
