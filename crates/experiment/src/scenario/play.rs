//! One run: the scene as changed, its hands, its meters, and a recording if one is wanted.

use super::change;
use super::design;
use super::error::ScenarioError;
use super::files::Source;
use super::hands::HandAtWork;
use super::measure::Meter;
use super::played::{Played, RunSettings, View};
use super::spec::{CutSpec, RunSpec};
use palpate_drive::journal::Journal;
use palpate_drive::nets::NetPool;
use palpate_drive::ports::BUS_NETS;
use palpate_geometry::cut::CutPlane;
use palpate_geometry::exchange::Format;
use palpate_geometry::math::state_hash;
use palpate_proto::text::located;
use palpate_record::{Recorder, RecorderPort, RecorderSettings};
use palpate_sim::World;
use palpate_sim::body::Deformable;
use palpate_sim::scene::spec::Clock;
use palpate_sim::scene::{Scene, SceneChange, SceneCut, file, inline_files};
use palpate_sim::tick::stage::{Stage, StageTimes};
use std::path::Path;
use std::time::{Duration, Instant};

/// The scene of a run: that of the folder with its changes, files written out, in lockstep.
fn scene_of(run: &RunSpec, source: &Source) -> Result<(file::Loaded, Scene), ScenarioError> {
    let wrong = |reason: String| ScenarioError::run(&run.name, reason);
    let text = source.text("scene.toml")?;
    let mut table: toml::Table = toml::from_str(&text).map_err(|error| {
        wrong(format!(
            "scene.toml: {}",
            located(&text, error.span(), error.message())
        ))
    })?;
    for (path, value) in &run.set {
        change::set(&mut table, path, value).map_err(wrong)?;
    }
    inline(&mut table, source)?;
    let text = toml::to_string(&table).map_err(|error| wrong(error.to_string()))?;
    let at = |source| ScenarioError::Scene {
        run: run.name.clone(),
        source,
    };
    let mut loaded = file::parse(&text, "scene.toml", Path::new(".")).map_err(at)?;
    loaded.spec.loop_.clock = Clock::Lockstep;
    loaded.methods = palpate_thesis::METHODS;
    let mut scene = loaded.build_to_run().map_err(at)?;
    for cut in &run.cut {
        let change = cut_at_rest(&scene, cut).map_err(wrong)?;
        scene = change.build_to_run().map_err(at)?;
        loaded.spec = change.spec().clone();
    }
    for finding in scene.warnings() {
        tracing::warn!(run = run.name, "{}", loaded.message(finding));
    }
    Ok((loaded, scene))
}

/// The scene with a body in pieces.
fn cut_at_rest(scene: &Scene, spec: &CutSpec) -> Result<SceneChange, String> {
    let body = (scene.body_index(&spec.body))
        .ok_or_else(|| format!("cut: the scene has no body {:?}", spec.body))?;
    let plane = CutPlane::through(&spec.point.into(), &spec.normal.into())
        .ok_or("cut: a plane needs a finite point and a normal longer than 0")?;
    if !(0.0..=1.0).contains(&spec.kerf_m) {
        return Err(format!(
            "cut: kerf_m is {}; it must be 0 to 1 m",
            spec.kerf_m
        ));
    }
    let coordinates = scene.deformable(body).map_or(&[][..], Deformable::rest);
    let standing = (scene.skin(body).points(), coordinates);
    let cut = SceneCut::new(scene, body, standing, &plane, spec.kerf_m);
    Ok(cut.map_err(|error| format!("cut: {error}"))?.change)
}

/// Writes surfaces and motions that are files of the scenario out in place.
fn inline(table: &mut toml::Table, source: &Source) -> Result<(), ScenarioError> {
    let Some(toml::Value::Array(bodies)) = table.get_mut("body") else {
        return Ok(());
    };
    for body in bodies.iter_mut().filter_map(toml::Value::as_table_mut) {
        for (key, json) in [("surface", true), ("motion", false)] {
            let Some(toml::Value::Table(part)) = body.get_mut(key) else {
                continue;
            };
            let Some(toml::Value::String(name)) = part.get("file").cloned() else {
                continue;
            };
            let text = source.text(&name)?;
            let wrong = |reason: String| ScenarioError::File {
                path: format!("{}/{name}", source.name()),
                reason,
            };
            let is_step = Format::of(Path::new(&name)).is_ok_and(|format| format == Format::Step);
            part.remove("file");
            if json && is_step {
                part.insert(
                    "inline".into(),
                    toml::Value::Table([("step".into(), text.into())].into_iter().collect()),
                );
            } else if json {
                let value: toml::Value =
                    serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
                part.insert("inline".into(), value);
            } else {
                let read: toml::Table = toml::from_str(&text)
                    .map_err(|error| wrong(located(&text, error.span(), error.message())))?;
                part.extend(read);
            }
        }
    }
    Ok(())
}

/// The loop of a run.
struct Loop {
    world: World,
    nets: NetPool,
    journal: Option<RecorderPort>,
    hands: Vec<Option<HandAtWork>>,
}

/// Plays a run.
///
/// # Errors
/// As [`super::Scenario::run`].
pub fn play(
    run: &RunSpec,
    source: &Source,
    settings: &RunSettings,
    meters: &mut [Meter],
) -> Result<Played, ScenarioError> {
    let (loaded, scene) = scene_of(run, source)?;
    let wrong = |reason: String| ScenarioError::run(&run.name, reason);
    for meter in meters.iter_mut() {
        meter.begin(&scene).map_err(wrong)?;
    }
    let mut hands: Vec<Option<HandAtWork>> = (0..scene.tool_count()).map(|_| None).collect();
    for (tool, hand) in &run.hands {
        let index = (scene.tool_index(tool))
            .ok_or_else(|| wrong(format!("hands: the scene has no tool {tool:?}")))?;
        let start = loaded.spec.tools[index].pose.position;
        hands[index] = Some(hand.at_work(&run.name, start, source)?);
    }
    let mut recorder = None;
    let mut journal = None;
    if let (Some(path), true) = (&settings.record, run.for_s > 0.0) {
        let effective = inline_files(&loaded.spec, &loaded.directory)
            .map_err(|error| wrong(error.to_string()))?;
        let settings = RecorderSettings::new(&loaded.text, &effective).to(path);
        let (started, port) = Recorder::start(settings, &scene)?;
        (recorder, journal) = (Some((started, path.clone())), Some(port));
    }
    let nets = NetPool::new(
        &scene,
        BUS_NETS + journal.as_ref().map_or(0, Journal::nets_held),
    );
    let mut played = Played::default();
    let mut at_work = Loop {
        world: World::start(scene),
        nets,
        journal,
        hands,
    };
    let seconds = run.for_s.min(settings.most_s.unwrap_or(f64::INFINITY));
    let ticks = (seconds / at_work.world.scene.dt_s).round() as u64;
    let done = at_work.run(ticks, meters, &mut played);
    drop(at_work.journal.take());
    if let Some((recorder, path)) = recorder {
        let report = recorder.finish();
        if let Some(failure) = report.failure {
            return Err(failure.into());
        }
        if report.dropped > 0 {
            return Err(wrong(format!("the recorder lost {} ticks", report.dropped)));
        }
        played.files.push(path);
    }
    done.map_err(wrong)?;
    let view = at_work.view(seconds);
    design::after(run, source, settings, &view, &mut played)?;
    for meter in meters.iter_mut() {
        meter.finish(&view, &played);
    }
    Ok(played)
}

impl Loop {
    fn view(&self, time_s: f64) -> View<'_> {
        View {
            scene: &self.world.scene,
            state: &self.world.state,
            scratch: &self.world.scratch,
            record: &self.world.record,
            hands: &self.hands,
            time_s,
        }
    }

    fn run(&mut self, ticks: u64, meters: &mut [Meter], played: &mut Played) -> Result<(), String> {
        let dt_s = self.world.scene.dt_s;
        let hash_of_start = state_hash(&self.world.state);
        if let Some(journal) = &mut self.journal {
            journal.keyframe(&self.world.state, hash_of_start);
        }
        let mut taken_ns: Vec<u64> = Vec::with_capacity(ticks as usize);
        for tick in 1..=ticks {
            let time_s = tick as f64 * dt_s;
            let Self {
                world,
                nets,
                journal,
                hands,
            } = self;
            let record = &mut world.record;
            for (tool, hand) in hands.iter_mut().enumerate() {
                record.input.poses[tool] = hand
                    .as_mut()
                    .map(|hand| hand.pose(tick, time_s, dt_s, &record.output.tools[tool]));
            }
            let mut times = [0; Stage::COUNT];
            let mut since = Instant::now();
            world.staged(|stage| {
                let now = Instant::now();
                let ns = now.duration_since(since).as_nanos();
                times[stage as usize] = u32::try_from(ns).unwrap_or(u32::MAX);
                since = now;
            });
            let World {
                scene,
                state,
                record,
                ..
            } = world;
            record.stage_ns = StageTimes::from(times);
            taken_ns.push(record.stage_ns.total());
            nets.begin();
            if let Some(journal) = journal {
                // A recording is complete: the loop waits for the disk, as no device waits for it.
                while !journal.has_room() {
                    std::thread::sleep(Duration::from_millis(1));
                }
                journal.tick(scene, state, record, nets);
            }
            played.faults += u64::from(record.output.fault.is_some());
            for (tool, hand) in hands.iter().enumerate() {
                if hand.is_some() {
                    let out = &record.output.tools[tool];
                    let place = match hand.as_ref().and_then(HandAtWork::device) {
                        Some(device) => device.position(),
                        None => out.proxy_position.coords.into(),
                    };
                    let trace = played.trace.tools.entry(scene.tool_id(tool).to_owned());
                    (trace.or_default()).push((place, out.force_n.norm()));
                }
            }
            let view = self.view(time_s);
            for meter in meters.iter_mut() {
                meter.tick(&view);
            }
        }
        played.ticks = ticks;
        played.state_hash = self.world.record.output.state_hash;
        played.map = (self.hands.iter().flatten())
            .find_map(HandAtWork::scanner)
            .map(|scanner| scanner.map().clone());
        taken_ns.sort_unstable();
        if !taken_ns.is_empty() {
            let at = |share: f64| {
                taken_ns[((taken_ns.len() - 1) as f64 * share).round() as usize] as f64 * 1e-3
            };
            played.tick_us = Some([at(0.5), at(0.99), at(1.0)]);
        }
        match played.faults {
            0 => Ok(()),
            n => Err(format!(
                "{n} ticks had a fault: a body came apart or was not finite, and was set back to rest"
            )),
        }
    }
}
