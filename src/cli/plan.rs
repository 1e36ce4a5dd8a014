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
    /// Also press the scene with finer nets and one more layer, and print how far its forces at rest are from theirs.
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

/// Of a tool that rests in the body that it pressed.
#[derive(serde::Serialize)]
struct RestForce {
    tool: String,
    force_n: f64,
    finer_n: f64,
    /// Both forces had come to rest, without a fault.
    at_rest: bool,
}

impl std::fmt::Display for RestForce {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            tool,
            force_n,
            finer_n,
            at_rest,
        } = self;
        let state = if *at_rest {
            "at rest"
        } else {
            "not at rest yet"
        };
        write!(
            f,
            "tool {tool} {state}: {force_n:.4} N, with finer nets {finer_n:.4} N"
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
        let (_, counts) = scene.net_size(b);
        let counts = counts.map(|count| count + count.div_ceil(2));
        body.lattice.refine = RefineSpec::Counts(counts);
        if !deformable.cells().is_empty() {
            body.lattice.layers = Some(body.layers() + 1);
        }
    }
    let finer = Scene::build_with(&finer, &loaded.directory, loaded.methods)
        .map_err(|error| anyhow::anyhow!("with finer nets the scene cannot be built: {error}"))?;
    let mut pressing = Pressing::new(scene);
    let mut poses = Vec::new();
    let coarse = pressed(scene, |input, output| {
        pressing.felt(output);
        let more = pressing.approach(input);
        poses.push(input.poses.clone());
        more
    });
    let mut poses = poses.into_iter().peekable();
    let finer = pressed(&finer, |input, _| {
        if let Some(next) = poses.next() {
            input.poses = next;
        }
        poses.peek().is_some()
    });
    let tools = coarse.forces_n.into_iter().zip(finer.forces_n).enumerate();
    let rest = tools.map(|(t, (force_n, finer_n))| RestForce {
        tool: scene.tool_id(t).to_owned(),
        force_n,
        finer_n,
        at_rest: coarse.at_rest && finer.at_rest,
    });
    Ok(rest.collect())
}

/// Forces of tools after a press.
struct Pressed {
    forces_n: Vec<f64>,
    /// They had come to rest, without a fault.
    at_rest: bool,
}

/// Presses until `next`, which gives the poses of a tick after the last one's output, says that all have arrived, and
/// waits there until forces are at rest.
fn pressed(scene: &Scene, mut next: impl FnMut(&mut TickInput, &TickOutput) -> bool) -> Pressed {
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    let TickRecord {
        mut input,
        mut output,
        ..
    } = TickRecord::for_tools(scene.tool_count());
    let mut sound = true;
    while next(&mut input, &output) {
        output = step(scene, &mut state, &mut scratch, &input);
        sound &= output.fault.is_none();
    }
    let mut forces_n = vec![0.0; scene.tool_count()];
    for _ in 0..REST_ROUNDS {
        for _ in 0..REST_TICKS {
            for pose in input.poses.as_mut_slice().iter_mut().flatten() {
                pose.seq += 1;
            }
            output = step(scene, &mut state, &mut scratch, &input);
            sound &= output.fault.is_none();
        }
        let now = output.tools.first(forces_n.len());
        let now: Vec<f64> = now.map(|tool| tool.force_n.norm()).collect();
        let still = forces_n
            .iter()
            .zip(&now)
            .all(|(before, now)| (now - before).abs() <= STILL * now);
        forces_n = now;
        if still {
            return Pressed {
                forces_n,
                at_rest: sound,
            };
        }
    }
    Pressed {
        forces_n,
        at_rest: false,
    }
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
