//! `palpate plan`: what a scene compiles to, with predicted and measured cost.

use super::Outcome;
use super::pressing::Pressing;
use palpate_sim::scene::Scene;
use palpate_sim::scene::file::Loaded;
use palpate_sim::scene::spec::RefineSpec;
use palpate_sim::tick::record::{TickInput, TickOutput, TickRecord};
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
    /// Also press the scene with finer nets, and print how far its forces at rest are from theirs: what net and
    /// layers get wrong, about.
    #[arg(long)]
    finer: bool,
}

/// Ticks that are run for a measured figure.
const TICKS: usize = 300;
/// Forces that change by no more than this share in so many ticks are at rest; looked at so often.
const STILL: f64 = 1e-4;
const REST_TICKS: usize = 100;
const REST_ROUNDS: usize = 50;

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
    let rest = args
        .finer
        .then(|| beside_finer(&loaded, &scene))
        .transpose()?;
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

/// Of a tool that rests in the body that it pressed.
#[derive(serde::Serialize)]
struct RestForce {
    tool: String,
    force_n: f64,
    finer_n: f64,
}

impl std::fmt::Display for RestForce {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            tool,
            force_n,
            finer_n,
        } = self;
        write!(
            f,
            "tool {tool} at rest: {force_n:.4} N, with finer nets {finer_n:.4} N"
        )?;
        match *finer_n > 0.0 {
            true => write!(f, " ({:+.1} % off)", 100.0 * (force_n / finer_n - 1.0)),
            false => Ok(()),
        }
    }
}

/// Forces of tools that press bodies and rest there, beside those with nets half as fine again and one more layer.
fn beside_finer(loaded: &Loaded, scene: &Scene) -> anyhow::Result<Vec<RestForce>> {
    let mut finer = loaded.spec.clone();
    for (b, body) in finer.bodies.iter_mut().enumerate() {
        let Some(deformable) = scene.deformable(b) else {
            continue;
        };
        let net = scene.rest_surface(b).net();
        let counts = [net.rows(), net.columns()].map(|count| count + count.div_ceil(2));
        body.lattice.refine = RefineSpec::Counts(counts);
        if !deformable.cells().is_empty() {
            body.lattice.layers = Some(body.layers() + 1);
        }
    }
    let finer = Scene::build(&finer, &loaded.directory)
        .map_err(|error| anyhow::anyhow!("with finer nets the scene cannot be built: {error}"))?;
    let mut poses = Vec::new();
    let forces = pressed(scene, |scene, input, step| {
        let mut pressing = Pressing::new(scene);
        while pressing.approach(input) {
            poses.push(input.poses.clone());
            pressing.felt(&step(input));
        }
    });
    let finer = pressed(&finer, |_, input, step| {
        for poses in &poses {
            input.poses.clone_from(poses);
            step(input);
        }
    });
    let tools = forces.into_iter().zip(finer).enumerate();
    let rest = tools.map(|(t, (force_n, finer_n))| RestForce {
        tool: scene.tool_id(t).to_owned(),
        force_n,
        finer_n,
    });
    Ok(rest.collect())
}

/// Forces of tools, N, that went where `press` leads them, once they are at rest there.
fn pressed(
    scene: &Scene,
    press: impl FnOnce(&Scene, &mut TickInput, &mut dyn FnMut(&TickInput) -> TickOutput),
) -> Vec<f64> {
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    let TickRecord {
        mut input,
        mut output,
        ..
    } = TickRecord::for_tools(scene.tool_count());
    press(scene, &mut input, &mut |input| {
        step(scene, &mut state, &mut scratch, input)
    });
    let mut forces = vec![0.0; scene.tool_count()];
    for _ in 0..REST_ROUNDS {
        for _ in 0..REST_TICKS {
            for pose in input.poses.as_mut_slice().iter_mut().flatten() {
                pose.seq += 1;
            }
            output = step(scene, &mut state, &mut scratch, &input);
        }
        let now = output.tools.first(forces.len());
        let now: Vec<f64> = now.map(|tool| tool.force_n.norm()).collect();
        let still = forces
            .iter()
            .zip(&now)
            .all(|(before, now)| (now - before).abs() <= STILL * now);
        forces = now;
        if still {
            break;
        }
    }
    forces
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
