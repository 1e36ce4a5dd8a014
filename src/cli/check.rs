//! `palpate check`: read, build, dry-run.

use super::Outcome;
use palpate_sim::scene::Scene;
use palpate_sim::scene::file;
use palpate_sim::tick::record::TickInput;
use palpate_sim::tick::step;
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Scene file.
    scene: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let loaded = file::load(&args.scene)?;
    let scene = Scene::build(&loaded.spec, &loaded.directory)?;
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    let mut fault = false;
    for _ in 0..100 {
        fault |= step(&scene, &mut state, &mut scratch, &TickInput::default())
            .fault
            .is_some();
    }
    if args.json {
        let report = serde_json::json!({
            "scene": scene.name, "bodies": scene.body_count(), "tools": scene.tool_count(), "ticks": state.tick, "fault": fault,
        });
        println!("{report}");
    } else {
        println!(
            "{}: {} bodies, {} tools, {} ticks run",
            scene.name,
            scene.body_count(),
            scene.tool_count(),
            state.tick
        );
    }
    for tool in scene.plan().tools {
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
    if fault {
        eprintln!("the simulation diverged: a state is not finite after some ticks at rest");
        return Ok(Outcome::Fault);
    }
    Ok(Outcome::Ok)
}
