//! Tools that press the bodies nearest to them: times of ticks in contact, and forces beside those with finer nets.

use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_geometry::skin::SkinSolver;
use palpate_sim::World;
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::file::Loaded;
use palpate_sim::scene::spec::RefineSpec;
use palpate_sim::scene::{Scene, SceneError};
use palpate_sim::tick::record::{TickInput, TickOutput};
use palpate_sim::tick::stage::Stage;
use serde::Serialize;
use std::sync::Arc;
use std::time::Instant;

/// Ticks that are run for a measured figure.
const TICKS: usize = 300;
/// Forces that change by no more than this share in so many ticks are at rest; looked at so often.
const STILL: f64 = 1e-4;
const REST_TICKS: usize = 100;
const REST_ROUNDS: usize = 50;

/// Stride of a tool, relative to the size of the body that it goes to.
const STRIDE: f64 = 2e-3;

/// How deep it presses from its first contact on, relative to the same.
const DEPTH: f64 = 0.03;

/// Strides at most.
const MOST_STRIDES: usize = 2_000;

/// One tool on its way.
struct Way {
    at: Point3,
    orientation: Rotation,
    /// Towards the body, as long as a stride; zero for a tool that presses nothing.
    stride: Vector3,
    /// Strides left.
    left: usize,
    touched: bool,
}

/// The tools of a scene.
pub struct Pressing {
    ways: Vec<Way>,
    seq: u64,
}

impl Pressing {
    /// Every tool at its start, about to go to the closest point of any body.
    pub fn new(scene: &Scene) -> Self {
        let way = |tool: usize| {
            let pose = &scene.spec.tools[tool].pose;
            let at = Point3::from(pose.position);
            let [x, y, z, w] = pose.orientation;
            let orientation = Rotation::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
            let carries = scene.spec.gravity.frame.as_deref() == Some(scene.tool_id(tool));
            let nearest = (0..scene.body_count())
                .filter(|_| !carries)
                .map(|body| {
                    let skin = scene.skin(body);
                    let foot = SkinSolver::new(skin).closest(skin, &at);
                    (foot, skin.size_m())
                })
                .min_by(|(a, _), (b, _)| a.signed_distance.total_cmp(&b.signed_distance));
            let stride = nearest.map_or_else(Vector3::zeros, |(foot, size_m)| {
                let towards = (foot.point - at).try_normalize(0.0).unwrap_or(-foot.normal);
                // From inside the way out is the way away from contact.
                let sign = if foot.signed_distance < 0.0 {
                    -1.0
                } else {
                    1.0
                };
                towards * (sign * STRIDE * size_m)
            });
            Way {
                at,
                orientation,
                stride,
                left: MOST_STRIDES,
                touched: false,
            }
        };
        Self {
            ways: (0..scene.tool_count()).map(way).collect(),
            seq: 0,
        }
    }

    /// Poses of the next tick, each tool a stride further; false when all have arrived.
    pub fn approach(&mut self, input: &mut TickInput) -> bool {
        let mut moving = false;
        for way in &mut self.ways {
            if way.left > 0 && way.stride != Vector3::zeros() {
                way.at += way.stride;
                way.left -= 1;
                moving = true;
            }
        }
        self.hold(input);
        moving
    }

    /// From its first contact on a tool goes on only as deep as it presses.
    pub fn felt(&mut self, output: &TickOutput) {
        for (t, way) in self.ways.iter_mut().enumerate() {
            if !way.touched && output.tools[t].contact_count > 0 {
                way.touched = true;
                way.left = way.left.min((DEPTH / STRIDE) as usize);
            }
        }
    }

    /// Poses of the next tick, with every tool where it is.
    pub fn hold(&mut self, input: &mut TickInput) {
        self.seq += 1;
        for (t, way) in self.ways.iter().enumerate() {
            input.poses[t] = Some(DevicePose {
                seq: self.seq,
                orientation: way.orientation,
                ..DevicePose::at_rest(way.at.coords.into())
            });
        }
    }
}

/// Of a tool that rests in the body that it pressed.
#[derive(Clone, Debug, Serialize)]
pub struct RestForce {
    /// Its id.
    pub tool: String,
    /// N.
    pub force_n: f64,
    /// With finer nets, N.
    pub finer_n: f64,
    /// Both forces had come to rest, without a fault.
    pub at_rest: bool,
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
///
/// # Errors
/// The scene does not build with such nets.
pub fn beside_finer(loaded: &Loaded, scene: &Arc<Scene>) -> Result<Vec<RestForce>, SceneError> {
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
    let finer = Arc::new(loaded.built(&finer)?);
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
fn pressed(
    scene: &Arc<Scene>,
    mut next: impl FnMut(&mut TickInput, &TickOutput) -> bool,
) -> Pressed {
    let mut world = World::start(scene.clone());
    let mut sound = true;
    while next(&mut world.record.input, &world.record.output) {
        sound &= world.tick().fault.is_none();
    }
    let mut forces_n = vec![0.0; scene.tool_count()];
    for _ in 0..REST_ROUNDS {
        for _ in 0..REST_TICKS {
            let poses = world.record.input.poses.as_mut_slice();
            poses.iter_mut().flatten().for_each(|pose| pose.seq += 1);
            sound &= world.tick().fault.is_none();
        }
        let now = world.record.output.tools.first(forces_n.len());
        let now: Vec<f64> = now.map(|tool| tool.force_n.norm()).collect();
        let mut pairs = forces_n.iter().zip(&now);
        let still = pairs.all(|(before, now)| (now - before).abs() <= STILL * now);
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
pub struct Measured {
    /// Of the stage that renders forces, µs.
    pub render_us: f64,
    /// Of the stages that deform bodies, µs.
    pub deform_us: f64,
    /// Tools in contact in the last tick.
    pub touching: usize,
}

/// Times of ticks while every tool presses the body nearest to it.
pub fn measure(scene: &Arc<Scene>) -> Measured {
    let mut world = World::start(scene.clone());
    let (mut renders, mut deforms) = (Vec::with_capacity(TICKS), Vec::with_capacity(TICKS));
    let mut pressing = Pressing::new(scene);
    while pressing.approach(&mut world.record.input) {
        pressing.felt(world.tick());
    }
    for _ in 0..TICKS {
        pressing.hold(&mut world.record.input);
        let mut took_us = [0.0; Stage::COUNT];
        let mut since = Instant::now();
        world.staged(|stage| {
            let now = Instant::now();
            took_us[stage as usize] = (now - since).as_secs_f64() * 1e6;
            since = now;
        });
        renders.push(took_us[Stage::Render as usize]);
        deforms.push(took_us[Stage::Deform as usize] + took_us[Stage::Hash as usize]);
    }
    let touching = (0..scene.tool_count())
        .filter(|&tool| world.record.output.tools[tool].contact_count > 0)
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
