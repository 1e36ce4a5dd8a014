//! One run: its scene, its hands, the loop without clock and bus, and what it came to.

use super::asked::Asked;
use super::cache::Cache;
use super::outcome::{Outcome, ToolFigures};
use super::plan::{Case, HandPlan, Plan};
use super::table::Row;
use palpate_client::device::servo::Servo;
use palpate_client::device::{Motion, Network, PassivitySettings, SimulatedDevice};
use palpate_proto::messages::{SceneSnapshot, ToolPose};
use palpate_record::SessionHash;
use palpate_sim::World;
use palpate_sim::scene::file::Loaded;
use palpate_sim::scene::{Scene, inline_files};
use palpate_sim::tick::quantity::{Number, ToolTick};
use palpate_sim::tick::record::{Command, TickOutput};
use palpate_wire as wire;
use sha2::Digest as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

/// The scene of a sample; built when a run of it is not known.
struct Prepared {
    loaded: Loaded,
    /// With defaults, surfaces and motions written out.
    effective: String,
    built: Option<Result<Arc<Scene>, String>>,
}

/// Makes runs of a sweep, one after the other.
pub struct Player {
    plan: Arc<Plan>,
    /// The scene of the last sample: runs of one follow each other.
    prepared: Option<(usize, Result<Prepared, String>)>,
    /// The scene that was built last: the next shares what is equal.
    last: Option<Arc<Scene>>,
}

impl Player {
    pub(super) fn new(plan: Arc<Plan>) -> Self {
        Self {
            plan,
            prepared: None,
            last: None,
        }
    }

    /// The run of this number and what it comes to, and whether it was known. It never fails: what goes wrong is in it.
    pub fn row(&mut self, run: usize, cache: Option<&Cache>) -> (Row, bool) {
        let case = self.plan.case(run);
        let done = catch_unwind(AssertUnwindSafe(|| self.try_outcome(&case, cache)));
        let (outcome, was_known) = done.unwrap_or_else(|panic| {
            self.prepared = None;
            let words = panic.downcast_ref::<String>().map(String::as_str);
            let words = words.or_else(|| panic.downcast_ref::<&str>().copied());
            let error = format!("panicked: {}", words.unwrap_or("no reason given"));
            (Outcome::failed(error, String::new()), false)
        });
        (Row { case, outcome }, was_known)
    }

    /// True if the scene of a run is that of the run before: it need not be built again.
    pub fn has_scene_of(&self, run: usize) -> bool {
        let sample = self.plan.case(run).sample;
        (self.prepared.as_ref()).is_some_and(|(prepared, _)| *prepared == sample)
    }

    fn try_outcome(&mut self, case: &Case, cache: Option<&Cache>) -> (Outcome, bool) {
        if self.prepared.as_ref().map(|(sample, _)| *sample) != Some(case.sample) {
            self.prepared = Some((case.sample, prepare(&self.plan, case)));
        }
        let Some((_, Ok(prepared))) = &mut self.prepared else {
            let reason = match &self.prepared {
                Some((_, Err(reason))) => reason.clone(),
                _ => String::new(),
            };
            return (Outcome::failed(reason, String::new()), false);
        };
        let hands = &self.plan.motions[case.motion].1;
        let key = key(prepared, hands, case.seed, &self.plan);
        if let Some(outcome) = cache.and_then(|cache| cache.get(&key)) {
            return (outcome, true);
        }
        let begun = Instant::now();
        let loaded = &prepared.loaded;
        let (sample, plan, last) = (case.sample, &self.plan, &self.last);
        let build = || {
            let (spec, files) = (&loaded.spec, plan.scene_files());
            let scene = match last {
                Some(last) => last.variant_to_run(spec, files),
                None => Scene::build_to_run_with(spec, files, loaded.methods),
            };
            let scene = scene.map_err(|error| loaded.locate(error).to_string())?;
            // What is found about one sample holds for most.
            for finding in scene.warnings().iter().filter(|_| sample == 0) {
                tracing::warn!(sample, "{}", loaded.message(finding));
            }
            Ok(Arc::new(scene))
        };
        let scene = match prepared.built.get_or_insert_with(build) {
            Ok(scene) => scene.clone(),
            Err(error) => return (Outcome::failed(error.clone(), key), false),
        };
        self.last = Some(scene.clone());
        let mut outcome = match Hands::new(&scene, hands, case.seed) {
            Ok(hands) => play(&scene, hands, plan),
            Err(error) => Outcome::failed(error, String::new()),
        };
        outcome.key = key;
        outcome.wall_s = begun.elapsed().as_secs_f64();
        // What failed is tried again: the reason may lie outside the run.
        if let (None, Some(cache)) = (&outcome.error, cache)
            && let Err(error) = cache.put(&outcome.key, &outcome)
        {
            tracing::warn!("an outcome could not be kept for the next time: {error}");
        }
        (outcome, false)
    }
}

impl Outcome {
    fn failed(error: String, key: String) -> Self {
        Self {
            error: Some(error),
            key,
            ..Self::default()
        }
    }
}

fn prepare(plan: &Plan, case: &Case) -> Result<Prepared, String> {
    let loaded = plan.scene_of(case).map_err(|error| error.to_string())?;
    let effective = inline_files(&loaded.spec, plan.scene_files()).map_err(|e| e.to_string())?;
    let effective = toml::to_string(&effective).map_err(|error| error.to_string())?;
    Ok(Prepared {
        loaded,
        effective,
        built: None,
    })
}

/// What this program was built from and by: the same give the same outcomes.
pub fn build() -> [String; 4] {
    use palpate_record::{RUN_SOURCE, RUSTC, TARGET, build_id};
    [RUN_SOURCE.into(), TARGET.into(), RUSTC.into(), build_id()]
}

type HandPlans = std::collections::BTreeMap<String, HandPlan>;

/// SHA-256 of all that decides an outcome, each part with its length before it.
fn key(prepared: &Prepared, hands: &HandPlans, seed: u64, plan: &Plan) -> String {
    let mut sha = sha2::Sha256::new();
    let mut add = |text: &str| {
        sha.update((text.len() as u64).to_le_bytes());
        sha.update(text.as_bytes());
    };
    let json = |value: Result<String, serde_json::Error>| value.unwrap_or_default();
    build().iter().for_each(|part| add(part));
    add(&prepared.effective);
    for (tool, hand) in hands {
        add(tool);
        add(&json(serde_json::to_string(&hand.spec)));
        add(hand.motion.as_deref().unwrap_or_default());
        // Debug: figures that are infinite have no JSON.
        add(&format!("{:?}", hand.device));
    }
    add(&seed.to_string());
    add(&plan.for_s.to_bits().to_string());
    plan.columns.iter().for_each(|column| add(column));
    sha.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

/// What moves one tool.
struct HandAtWork {
    tool: usize,
    motion: Motion,
    /// Without one the motion is followed exactly.
    device: Option<Box<(SimulatedDevice, Servo)>>,
}

struct Hands {
    list: Vec<HandAtWork>,
    /// As devices report themselves before the first tick.
    commands: Vec<Command>,
}

impl Hands {
    fn new(scene: &Scene, plans: &HandPlans, seed: u64) -> Result<Self, String> {
        let snapshot = wire::first_snapshot(scene, [0; 32]);
        let mut hands = Self {
            list: Vec::new(),
            commands: Vec::new(),
        };
        for (tool, plan) in plans {
            let index = (scene.tool_index(tool))
                .ok_or_else(|| format!("the scene has no tool {tool:?}"))?;
            let refused = |error: &dyn std::fmt::Display| format!("hands.{tool}: {error}");
            let motion = aimed(plan, &snapshot, tool).map_err(|error| refused(&error))?;
            let spec = &plan.spec;
            let mut device = None;
            if let Some((model, hand)) = &plan.device {
                let network = Network {
                    delay_s: spec.delay_s,
                    jitter_s: spec.jitter_s,
                    loss: spec.loss,
                    reorder: spec.reorder,
                    seed,
                };
                let passivity = (spec.passivity).then(|| PassivitySettings::of(model));
                let servo = Servo::new(network, passivity);
                let info = model.info(spec.delay_s);
                hands.commands.push(Command::Device {
                    tool: index as u32,
                    bounds: wire::device_bounds(scene, index, &info),
                });
                let start = motion.goal(0.0).position;
                device = Some(Box::new((
                    SimulatedDevice::new(model.clone(), hand.clone(), start, seed),
                    servo.map_err(|error| refused(&error))?,
                )));
            }
            hands.list.push(HandAtWork {
                tool: index,
                motion,
                device,
            });
        }
        Ok(hands)
    }
}

fn aimed(
    plan: &HandPlan,
    snapshot: &SceneSnapshot,
    tool: &str,
) -> Result<Motion, impl std::fmt::Display> {
    let spec = &plan.spec;
    match &plan.motion {
        Some(text) => Motion::from_toml(text, &spec.motion, snapshot, tool, spec.depth_m),
        None => Motion::named(&spec.motion, snapshot, tool, spec.depth_m),
    }
}

impl HandAtWork {
    /// The pose of the tick that ends at `time_s`.
    fn pose(&mut self, seq: u64, time_s: f64, dt_s: f64) -> ToolPose {
        let pose = match &mut self.device {
            None => {
                let goal = self.motion.goal(time_s);
                ToolPose {
                    orientation: goal.orientation,
                    linear_velocity: goal.velocity,
                    angular_velocity: goal.angular_velocity,
                    buttons: self.motion.buttons(time_s),
                    ..palpate_client::pose_at(goal.position)
                }
            }
            Some(device) => {
                let (device, servo) = device.as_mut();
                let period = servo.period(device, &self.motion, dt_s, None);
                // In lockstep there is exactly one.
                period.poses.last().copied().unwrap_or(device.pose())
            }
        };
        ToolPose { seq, ..pose }
    }

    /// The force of the tick comes back.
    fn hear(&mut self, output: &TickOutput) {
        if let Some(device) = &mut self.device {
            let (device, servo) = device.as_mut();
            let now_s = device.time_s();
            let force = wire::tool_force(output.tick, output.tick, &output.tools[self.tool]);
            servo.hear(now_s, force);
            servo.collect(now_s);
        }
    }
}

fn play(scene: &Arc<Scene>, mut hands: Hands, plan: &Plan) -> Outcome {
    let mut world = World::start(scene.clone());
    for command in &hands.commands {
        world.apply(*command);
    }
    let mut outcome = Outcome {
        tools: (0..scene.tool_count())
            .map(|tool| ToolFigures {
                tool: scene.tool_id(tool).to_owned(),
                ..ToolFigures::default()
            })
            .collect(),
        ..Outcome::default()
    };
    let [force, depth, energy] =
        ["force", "depth", "energy"].map(|name| Number::named(name).expect("in the table"));
    // Names were looked up when the sweep was read.
    let asked = plan
        .columns
        .iter()
        .flat_map(|name| Asked::named(name))
        .collect();
    let mut asked: Vec<Vec<Asked>> = vec![asked; scene.tool_count()];
    let mut session_hash = SessionHash::default();
    let ticks = (plan.for_s / scene.dt_s).round() as u64;
    for tick in 1..=ticks {
        let time_s = tick as f64 * scene.dt_s;
        for hand in &mut hands.list {
            let pose = hand.pose(tick, time_s, scene.dt_s);
            world.record.input.poses[hand.tool] = Some(wire::device_pose(&pose));
        }
        world.tick();
        let output = &world.record.output;
        for hand in &mut hands.list {
            hand.hear(output);
        }
        for (tool, figures) in outcome.tools.iter_mut().enumerate() {
            let of = ToolTick::of(&world.record, tool);
            let force_n = force.of(&of);
            if force_n > figures.peak_force_n {
                (figures.peak_force_n, figures.peak_force_s) = (force_n, time_s);
            }
            figures.peak_depth_m = figures.peak_depth_m.max(depth.of(&of));
            figures.energy_j = energy.of(&of);
            figures.made_j = figures.made_j.max(-figures.energy_j);
            asked[tool].iter_mut().for_each(|asked| asked.push(&of));
        }
        session_hash.push(tick, output.state_hash);
        outcome.faults += u64::from(output.fault.is_some());
        outcome.state_hash = format!("{:016x}", output.state_hash);
    }
    for (figures, asked) in outcome.tools.iter_mut().zip(&asked) {
        figures.asked = asked.iter().map(Asked::value).collect();
    }
    outcome.ticks = ticks;
    outcome.time_s = ticks as f64 * scene.dt_s;
    outcome.session_hash = format!("{:016x}", session_hash.0);
    if outcome.faults > 0 {
        let n = outcome.faults;
        outcome.error = Some(format!(
            "{n} ticks had a fault: a body came apart or was not finite, and was set back to rest"
        ));
    }
    outcome
}
