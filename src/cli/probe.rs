//! `palpate probe`: quasi-static contacts and forces at given poses.

use super::Outcome;
use super::numbers::{self, NumberLine};
use anyhow::Context as _;
use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::Scene;
use palpate_sim::solve::rows::Holder;
use palpate_sim::tick::explain::Explanation;
use palpate_sim::tick::record::{ContactReport, TickInput};
use palpate_sim::tick::{apply, record::Command, step, step_explained};
use palpate_thesis::spheres::{Counters, LevelCounters};
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Scene file, or builtin:NAME.
    scene: PathBuf,
    /// Tool to pose; optional if the scene has only one.
    #[arg(long)]
    tool: Option<String>,
    /// CSV lines `x,y,z[,qx,qy,qz,qw]`, m; `#` starts a comment.
    #[arg(long)]
    poses: PathBuf,
    /// Print one JSON object per line.
    #[arg(long)]
    json: bool,
    /// Say of each pose why its force is what it is: gaps, compliances, residuals.
    #[arg(long)]
    explain: bool,
}

/// Result for one pose.
#[derive(Debug, Serialize)]
struct ProbeRow {
    position: [f64; 3],
    force: [f64; 3],
    torque: [f64; 3],
    proxy: [f64; 3],
    depth: f64,
    contact_count: u32,
    /// Penetration depth of the deepest contact, m.
    contact: Option<ContactRow>,
    /// Contacts that carry force, deepest first, at most sixteen.
    contacts: Vec<ContactRow>,
    /// What the `spheres` method did in the last tick, by pair that uses it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    spheres: Vec<SpheresRow>,
    settled: bool,
    /// Pieces of surfaces that searches gave up on the way, if any: contacts may be missing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pieces_given_up: Option<u64>,
    /// Of the last tick, with `--explain`.
    #[serde(skip_serializing_if = "Option::is_none")]
    explanation: Option<Explanation>,
}

#[derive(Debug, Serialize)]
struct SpheresRow {
    holder: String,
    body: String,
    hulls_apart: bool,
    early_stop: Option<u8>,
    /// Of the body, then of the holder, coarsest first: points, spheres, tests, meets.
    levels: [Vec<[u32; 4]>; 2],
    triangulated_cells: u32,
    triangle_tests: u32,
    triangle_meets: u32,
    dropped: u32,
}

impl SpheresRow {
    fn new(holder: &str, body: &str, counters: &Counters) -> Self {
        let levels = |side: &[LevelCounters]| {
            let used = side
                .iter()
                .rposition(|level| level.spheres > 0)
                .map_or(0, |last| last + 1);
            side[..used]
                .iter()
                .map(|level| [level.points, level.spheres, level.tests, level.meets])
                .collect()
        };
        Self {
            holder: holder.to_owned(),
            body: body.to_owned(),
            hulls_apart: counters.hulls_apart,
            early_stop: counters.early_stop,
            levels: [levels(&counters.body), levels(&counters.tool)],
            triangulated_cells: counters.triangulated_cells,
            triangle_tests: counters.triangle_tests,
            triangle_meets: counters.triangle_meets,
            dropped: counters.dropped,
        }
    }
}

#[derive(Debug, Serialize)]
struct ContactRow {
    body: String,
    u: f64,
    v: f64,
    point: [f64; 3],
    normal: [f64; 3],
    depth: f64,
    force: [f64; 3],
}

impl ContactRow {
    fn new(scene: &Scene, contact: &ContactReport) -> Self {
        Self {
            body: scene.body_id(contact.body as usize).to_owned(),
            u: contact.u,
            v: contact.v,
            point: contact.point.coords.into(),
            normal: contact.normal.into(),
            depth: contact.depth_m,
            force: contact.force_n.into(),
        }
    }
}

/// At rest: the force changes by less than this share of itself (plus 1 µN) over [`WINDOW`] ticks.
const SETTLED: f64 = 1e-5;
const WINDOW: u64 = 50;
/// Ticks per pose after which settling is given up: where bodies deform, and where none does and nothing swings.
const PATIENCE: u64 = 20_000;
const RIGID_PATIENCE: u64 = 1_000;
/// Stride towards a pose, m a tick: slow enough for a deforming body to follow.
const STRIDE_M: f64 = 1e-4;
/// Longest way, m.
const MOST_WAY_M: f64 = 10.0;

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let loaded = super::scenes::load(&args.scene)?;
    let mut spec = loaded.spec.clone();
    // Quasi-static: no ramp, no limit in the way of a jump between poses.
    for tool in &mut spec.tools {
        tool.device.ramp_s = 0.0;
        tool.device.speed_max_m_s = 1e6;
        tool.coupling.damping_n_s_m = 0.0;
        tool.coupling.turning_damping_nm_s_rad = 0.0;
    }
    let scene = loaded.built_to_run(&spec)?;
    super::scenes::warn(&loaded, &scene);
    let tool = match &args.tool {
        Some(id) => scene
            .tool_index(id)
            .with_context(|| format!("the scene has no tool {id:?}"))?,
        None if scene.tool_count() == 1 => 0,
        None => anyhow::bail!(
            "the scene has {} tools; name one with --tool",
            scene.tool_count()
        ),
    };
    let poses = read_poses(&args.poses)?;
    if (0..scene.body_count()).any(|body| scene.deforms(body)) {
        let start = Point3::from(scene.spec.tools[tool].pose.position);
        let far = |pose: &&DevicePose| (pose.position - start).norm() > MOST_WAY_M;
        if let Some(pose) = poses.iter().find(far) {
            anyhow::bail!(
                "{}:{}: the pose is {:.3e} m from where tool {:?} starts, more than {MOST_WAY_M} m, and the way there is \
                 gone in strides of {STRIDE_M} m; are the poses in millimetres? Or let the tool start nearer",
                args.poses.display(),
                pose.seq,
                (pose.position - start).norm(),
                scene.tool_id(tool)
            );
        }
    }
    if !args.json {
        println!("{:>36}  {:>36} {:>10}", "position m", "force N", "depth mm");
    }
    for pose in poses {
        let row = probe(&scene, tool, &pose, args.explain);
        if let Some(count) = row.pieces_given_up {
            eprintln!(
                "note: line {}: searches gave up {count} pieces of surfaces that needed too much work; contacts may be missing",
                pose.seq
            );
        }
        if args.json {
            println!("{}", serde_json::to_string(&row)?);
        } else {
            let [x, y, z] = row.position;
            let [fx, fy, fz] = row.force;
            println!(
                "{x:>12.6}{y:>12.6}{z:>12.6}  {fx:>12.6}{fy:>12.6}{fz:>12.6} {:>10.4}",
                row.depth * 1e3
            );
            for row in &row.spheres {
                let SpheresRow {
                    holder,
                    body,
                    levels: [ours, theirs],
                    triangle_tests,
                    ..
                } = row;
                println!(
                    "    spheres {holder} on {body}: points, spheres, tests, meets by level {ours:?} {theirs:?}, {triangle_tests} triangle tests"
                );
            }
            if let Some(explanation) = &row.explanation {
                for line in super::explain::words(explanation).lines() {
                    println!("    {line}");
                }
            }
            for ContactRow {
                body,
                u,
                v,
                point: [x, y, z],
                depth,
                force,
                ..
            } in &row.contacts
            {
                let force = Vector3::from(*force).norm();
                println!(
                    "    {body} at u {u:.6} v {v:.6}: point {x:.6} {y:.6} {z:.6}, depth {:.4} mm, {force:.6} N",
                    depth * 1e3
                );
            }
        }
    }
    Ok(Outcome::Ok)
}

fn read_poses(path: &Path) -> anyhow::Result<Vec<DevicePose>> {
    let rows = numbers::read(path, &[3, 7], "x,y,z or x,y,z,qx,qy,qz,qw")?;
    let pose = |NumberLine { line, values }: NumberLine| {
        let orientation = if let [_, _, _, x, y, z, w] = values[..] {
            let quaternion = nalgebra::Quaternion::new(w, x, y, z);
            anyhow::ensure!(
                (quaternion.norm() - 1.0).abs() < 1e-6,
                "{}:{line}: the quaternion is not of unit length",
                path.display()
            );
            Rotation::from_quaternion(quaternion)
        } else {
            Rotation::identity()
        };
        Ok(DevicePose {
            seq: line as u64,
            t_client_ns: 0,
            position: Point3::new(values[0], values[1], values[2]),
            orientation,
            linear_velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            buttons: 0,
        })
    };
    rows.into_iter().map(pose).collect()
}

/// Moves from the tool's start straight to the pose and holds it until the force has settled.
fn probe(scene: &Scene, tool: usize, pose: &DevicePose, explain: bool) -> ProbeRow {
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    apply(scene, &mut state, &mut scratch, Command::Reset);
    let start = Point3::from(scene.spec.tools[tool].pose.position);
    let way = pose.position - start;
    let deforming = (0..scene.body_count()).any(|body| scene.deforms(body));
    let strides = if deforming {
        (way.norm() / STRIDE_M).ceil().max(1.0) as u64
    } else {
        1
    };
    let input = |position: Point3| {
        let mut input = TickInput::default();
        input.poses[tool] = Some(DevicePose { position, ..*pose });
        input
    };
    let mut run = |position: Point3| step(scene, &mut state, &mut scratch, &input(position));
    // The first pose seats the proxy; it belongs outside.
    let mut out = run(start);
    for k in 1..=strides {
        out = run(start + way * (k as f64 / strides as f64));
    }
    let (mut settled, mut ticks, mut before) = (false, 0, out.tools[tool].force_n);
    let patience = if deforming { PATIENCE } else { RIGID_PATIENCE };
    while !settled && ticks < patience {
        for _ in 0..WINDOW {
            out = run(pose.position);
        }
        ticks += WINDOW;
        let force = out.tools[tool].force_n;
        settled = (force - before).norm() <= SETTLED * force.norm() + 1e-6;
        before = force;
    }
    let explanation = explain.then(|| {
        let here = input(pose.position);
        step_explained(scene, &mut state, &mut scratch, &here, &mut out)
    });
    let own = out
        .contacts
        .list()
        .iter()
        .filter(|contact| contact.holder == Holder::Tool(tool as u32));
    let counters = scratch
        .other_queries(scene)
        .filter_map(|(holder, body, query)| {
            Some((holder, body, palpate_thesis::spheres::counters_of(query)?))
        });
    let pieces_given_up = Some(scratch.pieces_given_up()).filter(|&count| count > 0);
    let out = &out.tools[tool];
    ProbeRow {
        position: pose.position.coords.into(),
        force: out.force_n.into(),
        torque: out.torque_nm.into(),
        proxy: out.proxy_position.coords.into(),
        depth: out.contact.map_or(0.0, |contact| contact.depth_m),
        contact_count: out.contact_count,
        contact: out
            .contact
            .as_ref()
            .map(|contact| ContactRow::new(scene, contact)),
        contacts: own.map(|contact| ContactRow::new(scene, contact)).collect(),
        spheres: counters
            .map(|(holder, body, counters)| SpheresRow::new(holder, body, counters))
            .collect(),
        settled,
        pieces_given_up,
        explanation,
    }
}
