//! A session at a glance.

use super::figures::recorded_tools;
use super::file_info::FileInfo;
use super::message::SessionHash;
use super::reader::Session;
use super::{ToolFigures, convert, names};
use crate::drive::stats::{Histogram, LATE_NS};
use palpate_sim::tick::record::{STAGE_COUNT, STAGE_NAMES};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// Figures of a session.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Info {
    /// File.
    pub path: String,
    /// Scene name.
    pub scene: String,
    /// Build that made it.
    pub build: String,
    /// SHA-256 of the scene file.
    pub scene_sha256: String,
    /// Bodies, by index.
    pub bodies: Vec<String>,
    /// When it was begun, ns since 1970.
    pub started_unix_ns: Option<u64>,
    /// s.
    pub duration_s: f64,
    /// Ticks.
    pub ticks: u64,
    /// First of them.
    pub first_tick: Option<u64>,
    /// Last of them.
    pub last_tick: Option<u64>,
    /// Ticks missing between the first and the last.
    pub gaps: u64,
    /// Records lost while recording.
    pub dropped_records: u64,
    /// Deadlines skipped.
    pub skipped_ticks: u64,
    /// Ticks that began more than 100 µs late.
    pub late_ticks: u64,
    /// Finished, and nothing lost.
    pub clean: bool,
    /// One of several files of a session, or what was kept of a longer one.
    pub is_part: bool,
    /// Metadata of the recorder about this part, as written.
    pub part: BTreeMap<String, String>,
    /// All that the head says: format, target, clock and more.
    pub metadata: BTreeMap<String, String>,
    /// Why reading stopped early, if it did.
    pub cut_short: Option<String>,
    /// Keyframes.
    pub keyframes: u64,
    /// Commands.
    pub commands: u64,
    /// Commands by name.
    pub commands_by_name: BTreeMap<String, u64>,
    /// Nets.
    pub nets: u64,
    /// Hash of the last state, hexadecimal.
    pub final_hash: String,
    /// Hash of all ticks, hexadecimal: equal for sessions that went through the same states.
    pub session_hash: String,
    /// Figures by tool.
    pub tools: Vec<ToolInfo>,
    /// Figures by stage, and of the whole tick.
    pub stages: Vec<StageInfo>,
    /// How late ticks began.
    pub lateness: StageInfo,
    /// What the file is made of, when that was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<FileInfo>,
}

/// Figures of a tool.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToolInfo {
    /// Id.
    pub id: String,
    /// Poses that took effect.
    pub poses: u64,
    /// Ticks in contact.
    pub contact_ticks: u64,
    /// Times that contact began.
    pub contact_phases: u64,
    /// First tick in contact.
    pub first_contact_tick: Option<u64>,
    /// Largest force, N.
    pub peak_force_n: f64,
    /// Root of the mean square of the force over all ticks, N.
    pub rms_force_n: f64,
    /// Deepest penetration of the device's tool, m.
    pub peak_depth_m: f64,
    /// Work done by the hand, J.
    pub energy_j: f64,
    /// What the passivity controller took away, J.
    pub dissipated_j: f64,
}

/// Figures of a stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageInfo {
    /// Name.
    pub stage: String,
    /// µs.
    pub p50_us: f64,
    /// µs.
    pub p99_us: f64,
    /// µs.
    pub max_us: f64,
}

/// Sums a session up.
pub fn info(session: &Session) -> Info {
    let run = |key: &str| session.header.run.get(key).cloned().unwrap_or_default();
    let mut poses = vec![0; names(session, "tools").len()];
    let mut histograms: Vec<Histogram> = (0..=STAGE_COUNT).map(|_| Histogram::default()).collect();
    let mut lateness = Histogram::default();
    let mut session_hash = SessionHash::default();
    for record in &session.ticks {
        session_hash.push(record.output.tick, record.output.state_hash);
        let applied = record.input.poses.first(poses.len());
        poses
            .iter_mut()
            .zip(applied)
            .for_each(|(count, pose)| *count += u64::from(pose.is_some()));
        lateness.add(record.late_ns);
        let mut whole = 0;
        for (histogram, ns) in histograms.iter_mut().zip(record.stage_ns) {
            histogram.add(u64::from(ns));
            whole += u64::from(ns);
        }
        histograms[STAGE_COUNT].add(whole);
    }
    let name = |command| convert::command_to_proto(0, command).name;
    let mut commands_by_name = BTreeMap::new();
    session
        .commands
        .iter()
        .for_each(|(_, command)| *commands_by_name.entry(name(*command)).or_default() += 1);
    let (first, last) = (session.ticks.first(), session.ticks.last());
    let dt_s = session.run_number("dt_ns").unwrap_or(0) as f64 * 1e-9;
    let part = part(session);
    let starts_late = session
        .keyframes
        .first()
        .is_some_and(|keyframe| keyframe.tick > 0);
    Info {
        path: session.path.display().to_string(),
        scene: run("scene"),
        build: run("build"),
        scene_sha256: run("scene_sha256"),
        bodies: names(session, "bodies"),
        started_unix_ns: session.run_number("started_unix_ns"),
        duration_s: session.ticks.len() as f64 * dt_s,
        ticks: session.ticks.len() as u64,
        first_tick: first.map(|record| record.output.tick),
        last_tick: last.map(|record| record.output.tick),
        gaps: session.gaps(),
        dropped_records: session.end_number("dropped_records").unwrap_or(0),
        skipped_ticks: session
            .ticks
            .iter()
            .map(|record| u64::from(record.skipped))
            .sum(),
        late_ticks: session
            .ticks
            .iter()
            .filter(|record| record.late_ns > LATE_NS)
            .count() as u64,
        clean: session.is_clean() && session.cut_short.is_none(),
        is_part: starts_late || !part.is_empty(),
        part,
        metadata: session.header.run.clone(),
        cut_short: session.cut_short.clone(),
        keyframes: session.keyframes.len() as u64,
        commands: session.commands.len() as u64,
        commands_by_name,
        nets: session.nets.len() as u64,
        final_hash: format!("{:016x}", last.map_or(0, |record| record.output.state_hash)),
        session_hash: format!("{:016x}", session_hash.0),
        tools: recorded_tools(session)
            .into_iter()
            .zip(poses)
            .map(|(figures, poses)| tool(figures, poses))
            .collect(),
        stages: stage_infos(&histograms),
        lateness: stage_info("late", &lateness),
        file: None,
    }
}

/// What the recorder says of parts: `part`, `previous_part`, `next_part`.
fn part(session: &Session) -> BTreeMap<String, String> {
    let entries = session.header.run.iter().chain(&session.header.end);
    let about = entries.filter(|(key, _)| *key == "part" || key.ends_with("_part"));
    about
        .map(|(key, value)| (key.clone(), value.clone()))
        .collect()
}

fn tool(figures: ToolFigures, poses: u64) -> ToolInfo {
    ToolInfo {
        id: figures.id,
        poses,
        contact_ticks: figures.contact_ticks,
        contact_phases: figures.contact_phases,
        first_contact_tick: figures.first_contact_tick,
        peak_force_n: figures.peak_force_n,
        rms_force_n: figures.rms_force_n,
        peak_depth_m: figures.peak_depth_m,
        energy_j: figures.energy_j,
        dissipated_j: figures.dissipated_j,
    }
}

/// Rows of a stage table: the stages, then the whole tick.
pub(crate) fn stage_infos(histograms: &[Histogram]) -> Vec<StageInfo> {
    STAGE_NAMES
        .iter()
        .copied()
        .chain(["tick"])
        .zip(histograms)
        .map(|(stage, h)| stage_info(stage, h))
        .collect()
}

fn stage_info(stage: &str, histogram: &Histogram) -> StageInfo {
    let us = |ns: u64| ns as f64 * 1e-3;
    StageInfo {
        stage: stage.into(),
        p50_us: us(histogram.quantile(0.5)),
        p99_us: us(histogram.quantile(0.99)),
        max_us: us(histogram.max()),
    }
}

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.path)?;
        writeln!(
            f,
            "  scene {}, {:.3} s, {} ticks ({} missing), {}",
            self.scene,
            self.duration_s,
            self.ticks,
            self.gaps,
            if self.clean { "clean" } else { "NOT clean" }
        )?;
        if let Some(reason) = &self.cut_short {
            writeln!(
                f,
                "  cut short: {reason}; `palpate recover` makes a finished file of what is there"
            )?;
        }
        if let (true, Some(first), Some(last)) = (self.is_part, self.first_tick, self.last_tick) {
            writeln!(f, "  a part of a longer session: ticks {first} to {last}")?;
        }
        for (key, value) in &self.part {
            writeln!(f, "  {key}: {value}")?;
        }
        writeln!(
            f,
            "  {} keyframes, {} commands, {} nets; {} records lost, {} ticks skipped, {} late",
            self.keyframes,
            self.commands,
            self.nets,
            self.dropped_records,
            self.skipped_ticks,
            self.late_ticks
        )?;
        if !self.commands_by_name.is_empty() {
            let list: Vec<String> = self
                .commands_by_name
                .iter()
                .map(|(name, count)| format!("{count} {name}"))
                .collect();
            writeln!(f, "  commands: {}", list.join(", "))?;
        }
        writeln!(
            f,
            "  session hash {}, final state {}",
            self.session_hash, self.final_hash
        )?;
        writeln!(f, "  made by {}", self.build)?;
        for tool in &self.tools {
            writeln!(
                f,
                "  tool {}: {} poses, {} ticks in contact ({} times), peak force {:.4} N, RMS {:.4} N, peak depth {:.3} mm, \
                 work of the hand {:.6} J, taken away {:.6} J",
                tool.id,
                tool.poses,
                tool.contact_ticks,
                tool.contact_phases,
                tool.peak_force_n,
                tool.rms_force_n,
                tool.peak_depth_m * 1e3,
                tool.energy_j,
                tool.dissipated_j
            )?;
        }
        write_stages(f, &self.stages)?;
        write_stage(f, &self.lateness)?;
        self.file
            .as_ref()
            .map_or(Ok(()), |file| write!(f, "{file}"))
    }
}

/// The stage table.
pub(crate) fn write_stages(f: &mut impl fmt::Write, stages: &[StageInfo]) -> fmt::Result {
    writeln!(
        f,
        "  {:<8} {:>10} {:>10} {:>10}",
        "stage", "p50 us", "p99 us", "max us"
    )?;
    stages.iter().try_for_each(|stage| write_stage(f, stage))
}

fn write_stage(f: &mut impl fmt::Write, stage: &StageInfo) -> fmt::Result {
    writeln!(
        f,
        "  {:<8} {:>10.1} {:>10.1} {:>10.1}",
        stage.stage, stage.p50_us, stage.p99_us, stage.max_us
    )
}
