//! Replay: the recorded inputs through the same step, compared bit for bit. Where ticks are missing it goes on from the next
//! keyframe: a loss is a gap, not a difference.

use super::message::SessionHash;
use super::reader::{Keyframe, NetRecord, ReadError, Session};
use super::{build_id, convert};
use crate::math::{Point3, state_hash};
use crate::scene::spec::SceneSpec;
use crate::scene::{Scene, SceneError};
use crate::tick::record::{Command, TickRecord};
use crate::tick::{apply, restore, step};
use serde::Serialize;
use std::path::Path;

/// Why a session cannot be replayed at all.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The file.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Its scene.
    #[error("the recorded scene does not parse: {0}")]
    SceneText(String),
    /// Its scene.
    #[error("the recorded scene does not build: {0}")]
    Scene(#[from] SceneError),
    /// No state to start from.
    #[error("no keyframe at or before tick {from}, and one is needed to start from")]
    NoKeyframe {
        /// Wanted start.
        from: u64,
    },
    /// The state is of another scene.
    #[error("keyframe at tick {tick}: {source}")]
    State {
        /// Its tick.
        tick: u64,
        /// Cause.
        source: crate::math::StateError,
    },
}

/// The first place where recording and replay part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Tick.
    pub tick: u64,
    /// Field, for example `tools[0].force_n.x`.
    pub field: String,
    /// Recorded value.
    pub recorded: String,
    /// Replayed value.
    pub replayed: String,
    /// Steps of floating point between them, when both are floats.
    pub ulps: Option<u64>,
}

/// What a replay found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReplayReport {
    /// Ticks whose every output and state hash were equal by bits.
    pub ticks_matched: u64,
    /// Ticks of the recording.
    pub ticks_recorded: u64,
    /// Nets that were compared.
    pub nets_matched: u64,
    /// Ticks missing.
    pub gaps: u64,
    /// The recording was finished and lost nothing.
    pub clean: bool,
    /// Recorded by this very build.
    pub same_build: bool,
    /// Where they part, if they do.
    pub first_difference: Option<Difference>,
    /// Simulated over wall time.
    pub realtime_factor: f64,
    /// Hash of all replayed ticks, hexadecimal.
    pub session_hash: String,
}

impl ReplayReport {
    /// Complete, and equal at every tick.
    pub fn passed(&self) -> bool {
        self.first_difference.is_none() && self.clean && self.gaps == 0
    }
}

/// Replays a session from the keyframe at or before tick `from` (0: the start). `progress` is called now and then with the
/// ticks done and all.
///
/// # Errors
/// A file or scene that cannot be replayed; a difference is no error but part of the report.
pub fn replay(session: &Session, from: u64, mut progress: impl FnMut(u64, u64)) -> Result<ReplayReport, ReplayError> {
    let spec: SceneSpec =
        toml::from_str(&session.header.effective_scene).map_err(|e| ReplayError::SceneText(e.to_string()))?;
    let scene = Scene::build(&spec, Path::new("."))?;
    let first = session.keyframes.iter().rev().find(|keyframe| keyframe.tick <= from);
    let first = first.ok_or(ReplayError::NoKeyframe { from })?;
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    let mut report = ReplayReport {
        ticks_matched: 0,
        ticks_recorded: session.ticks.len() as u64,
        nets_matched: 0,
        gaps: session.gaps() + session.ticks.first().map_or(0, |record| record.output.tick.saturating_sub(1)),
        clean: session.is_clean() && session.cut_short.is_none(),
        same_build: session.header.run.get("build").is_some_and(|build| *build == build_id()),
        first_difference: None,
        realtime_factor: 0.0,
        session_hash: String::new(),
    };
    let started = std::time::Instant::now();
    let mut session_hash = SessionHash::default();
    let mut commands = &session.commands[..];
    let mut nets = session.nets.iter().peekable();
    let mut net = Vec::new();
    let records: Vec<&TickRecord> = session.ticks.iter().filter(|record| record.output.tick > first.tick).collect();
    let mut seated = false;
    for record in &records {
        if !seated || record.output.tick > state.tick.saturating_add(1) {
            // At the start and after a gap only a keyframe knows the state; ticks before the next one are skipped.
            seated = false;
            let Some(keyframe) = keyframe_before(&session.keyframes, record.output.tick) else { continue };
            restore(&scene, &mut state, &mut scratch, &keyframe.saved)
                .map_err(|source| ReplayError::State { tick: keyframe.tick, source })?;
            let hash = state_hash(&state);
            if hash != keyframe.state_hash {
                let found = difference(keyframe.tick, "keyframe.state_hash", keyframe.state_hash, hash);
                report.first_difference = Some(found);
                break;
            }
            commands = after_keyframe(&session.commands, keyframe);
            seated = true;
        }
        while let Some(((_, command), rest)) =
            commands.split_first().filter(|((after, _), _)| *after < record.output.tick)
        {
            apply(&scene, &mut state, &mut scratch, *command);
            commands = rest;
        }
        let output = step(&scene, &mut state, &mut scratch, &record.input);
        session_hash.push(output.tick, output.state_hash);
        let replayed = TickRecord { output, ..**record };
        if let Some(found) = compare(record, &replayed, scene.tool_count()) {
            report.first_difference = Some(found);
            break;
        }
        report.ticks_matched += 1;
        while nets.next_if(|recorded| recorded.tick < output.tick).is_some() {}
        while let Some(recorded) = nets.next_if(|recorded| recorded.tick == output.tick) {
            let Some(body) = (0..scene.body_count()).find(|&body| scene.body_id(body) == recorded.body) else {
                continue;
            };
            net.resize(scene.rest_surface(body).net().points().len(), Point3::origin());
            state.copy_net(&scene, body, &mut net);
            report.first_difference = compare_net(recorded, &net);
            if report.first_difference.is_some() {
                break;
            }
            report.nets_matched += 1;
        }
        if report.first_difference.is_some() {
            break;
        }
        if report.ticks_matched.is_multiple_of(500) {
            progress(report.ticks_matched, records.len() as u64);
        }
    }
    report.realtime_factor = report.ticks_matched as f64 * scene.dt_s / started.elapsed().as_secs_f64().max(1e-9);
    report.session_hash = format!("{:016x}", session_hash.0);
    Ok(report)
}

/// The last keyframe of the tick before.
fn keyframe_before(keyframes: &[Keyframe], tick: u64) -> Option<&Keyframe> {
    let end = keyframes.partition_point(|keyframe| keyframe.tick < tick);
    keyframes[..end].last().filter(|keyframe| keyframe.tick + 1 == tick)
}

/// Commands that the state of a keyframe does not hold yet.
fn after_keyframe<'a>(commands: &'a [(u64, Command)], keyframe: &Keyframe) -> &'a [(u64, Command)] {
    let first = commands.partition_point(|(after, _)| *after < keyframe.tick);
    let end = commands.partition_point(|(after, _)| *after <= keyframe.tick);
    &commands[end.min(first + keyframe.commands as usize)..]
}

fn compare_net(recorded: &NetRecord, net: &[Point3]) -> Option<Difference> {
    let replayed: Vec<f64> = net.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    let field = |what: String| format!("body {:?} net {what}", recorded.body);
    if recorded.points.len() != replayed.len() {
        let (a, b) = (recorded.points.len() as u64, replayed.len() as u64);
        return Some(difference(recorded.tick, &field("length".into()), a, b));
    }
    let k = first_apart(&recorded.points, &replayed)?;
    let field = field(format!("point {} coordinate {}", k / 3, k % 3));
    Some(float_difference(recorded.tick, field, recorded.points[k], replayed[k]))
}

fn difference(tick: u64, field: &str, recorded: u64, replayed: u64) -> Difference {
    let text = |value| if field.ends_with("hash") { format!("{value:016x}") } else { format!("{value}") };
    Difference { tick, field: field.into(), recorded: text(recorded), replayed: text(replayed), ulps: None }
}

fn float_difference(tick: u64, field: String, recorded: f64, replayed: f64) -> Difference {
    // Bits of floats, made monotonic across zero.
    let order = |x: f64| {
        let bits = x.to_bits() as i64;
        if bits < 0 { i64::MIN.wrapping_sub(bits) } else { bits }
    };
    let ulps = (!recorded.is_nan() && !replayed.is_nan()).then(|| order(recorded).abs_diff(order(replayed)));
    Difference { tick, field, recorded: format!("{recorded:e}"), replayed: format!("{replayed:e}"), ulps }
}

/// First field that is not equal by bits, outputs before the hash: a force says more than a hash.
fn compare(recorded: &TickRecord, replayed: &TickRecord, tool_count: usize) -> Option<Difference> {
    let tick = recorded.output.tick;
    let (a, b) = (convert::tick_to_proto(recorded, tool_count), convert::tick_to_proto(replayed, tool_count));
    if a.tick != b.tick {
        return Some(difference(tick, "tick", a.tick, b.tick));
    }
    for (t, (x, y)) in a.tools.iter().zip(&b.tools).enumerate() {
        let names: [(&str, u64, u64); 5] = [
            ("pose_seq", x.pose_seq, y.pose_seq),
            ("t_client_ns", x.t_client_ns, y.t_client_ns),
            ("pose_age_ticks", x.pose_age_ticks.into(), y.pose_age_ticks.into()),
            ("flags", x.flags.into(), y.flags.into()),
            ("contact_count", x.contact_count.into(), y.contact_count.into()),
        ];
        for (name, x, y) in names {
            if x != y {
                return Some(difference(tick, &format!("tools[{t}].{name}"), x, y));
            }
        }
        if let Some(k) = first_apart(&x.values, &y.values) {
            let field = format!("tools[{t}].{}", value_name(k));
            return Some(float_difference(tick, field, x.values[k], y.values[k]));
        }
        match (&x.contact, &y.contact) {
            (None, None) => {}
            (Some(x), Some(y)) if x.body == y.body => {
                if let Some(k) = first_apart(&x.values, &y.values) {
                    let field = format!("tools[{t}].contact.{}", contact_name(k));
                    return Some(float_difference(tick, field, x.values[k], y.values[k]));
                }
            }
            (x, y) => {
                let body =
                    |c: &Option<palpate_proto::recording::Contact>| c.as_ref().map_or(0, |c| u64::from(c.body) + 1);
                return Some(difference(tick, &format!("tools[{t}].contact.body"), body(x), body(y)));
            }
        }
    }
    let rest: [(&str, u64, u64); 5] = [
        ("net_revision", a.net_revision, b.net_revision),
        ("fault", a.fault.into(), b.fault.into()),
        ("moving", a.moving.into(), b.moving.into()),
        ("quality", a.quality.into(), b.quality.into()),
        ("state_hash", a.state_hash, b.state_hash),
    ];
    rest.into_iter().find(|(_, x, y)| x != y).map(|(name, x, y)| difference(tick, name, x, y))
}

fn first_apart(a: &[f64], b: &[f64]) -> Option<usize> {
    a.iter().zip(b).position(|(x, y)| x.to_bits() != y.to_bits())
}

fn value_name(k: usize) -> String {
    let groups = [
        ("force_n", 3),
        ("torque_nm", 3),
        ("proxy_position", 3),
        ("proxy_orientation", 4),
        ("contact_force_n", 3),
        ("contact_torque_nm", 3),
    ];
    let mut k = k;
    for (name, len) in groups {
        if k < len {
            return format!("{name}.{}", ["x", "y", "z", "w"][k]);
        }
        k -= len;
    }
    ["energy_j", "dissipated_j"][k.min(1)].into()
}

fn contact_name(k: usize) -> &'static str {
    let names = ["u", "v", "point.x", "point.y", "point.z", "normal.x", "normal.y", "normal.z", "depth_m"];
    names.get(k).copied().unwrap_or(["force_n.x", "force_n.y", "force_n.z"][k.saturating_sub(names.len()).min(2)])
}
