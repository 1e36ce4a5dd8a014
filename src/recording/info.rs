//! A session at a glance.

use super::message::SessionHash;
use super::reader::Session;
use crate::tick::record::{STAGE_COUNT, STAGE_NAMES};
use crate::tick::stats::{Histogram, LATE_NS};
use serde::Serialize;
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
    /// s.
    pub duration_s: f64,
    /// Ticks.
    pub ticks: u64,
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
    /// Why reading stopped early, if it did.
    pub cut_short: Option<String>,
    /// Keyframes.
    pub keyframes: u64,
    /// Commands.
    pub commands: u64,
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
    /// Largest force, N.
    pub peak_force_n: f64,
    /// Deepest penetration of the device's tool, m.
    pub peak_depth_m: f64,
    /// Work done by the hand, J.
    pub energy_j: f64,
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
    let names = run("tools");
    let mut tools: Vec<ToolInfo> = names
        .split(',')
        .filter(|id| !id.is_empty())
        .map(|id| ToolInfo {
            id: id.into(),
            poses: 0,
            contact_ticks: 0,
            peak_force_n: 0.0,
            peak_depth_m: 0.0,
            energy_j: 0.0,
        })
        .collect();
    let mut histograms: Vec<Histogram> = (0..=STAGE_COUNT).map(|_| Histogram::default()).collect();
    let mut session_hash = SessionHash::default();
    for record in &session.ticks {
        session_hash.push(record.output.tick, record.output.state_hash);
        for (t, tool) in tools.iter_mut().enumerate() {
            let out = &record.output.tools[t];
            tool.poses += u64::from(record.input.poses[t].is_some());
            tool.contact_ticks += u64::from(out.contact.is_some());
            tool.peak_force_n = tool.peak_force_n.max(out.force_n.norm());
            tool.peak_depth_m = tool.peak_depth_m.max(out.contact.map_or(0.0, |contact| contact.depth_m));
            tool.energy_j = out.energy_j;
        }
        let mut whole = 0;
        for (histogram, ns) in histograms.iter_mut().zip(record.stage_ns) {
            histogram.add(u64::from(ns));
            whole += u64::from(ns);
        }
        histograms[STAGE_COUNT].add(whole);
    }
    let last = session.ticks.last();
    let dt_s = session.run_number("dt_ns").unwrap_or(0) as f64 * 1e-9;
    Info {
        path: session.path.display().to_string(),
        scene: run("scene"),
        build: run("build"),
        scene_sha256: run("scene_sha256"),
        duration_s: session.ticks.len() as f64 * dt_s,
        ticks: session.ticks.len() as u64,
        gaps: session.gaps(),
        dropped_records: session.end_number("dropped_records").unwrap_or(0),
        skipped_ticks: session.ticks.iter().map(|record| u64::from(record.skipped)).sum(),
        late_ticks: session.ticks.iter().filter(|record| record.late_ns > LATE_NS).count() as u64,
        clean: session.is_clean() && session.cut_short.is_none(),
        cut_short: session.cut_short.clone(),
        keyframes: session.keyframes.len() as u64,
        commands: session.commands.len() as u64,
        nets: session.nets.len() as u64,
        final_hash: format!("{:016x}", last.map_or(0, |record| record.output.state_hash)),
        session_hash: format!("{:016x}", session_hash.0),
        tools,
        stages: stage_infos(&histograms),
    }
}

/// Rows of a stage table: the stages, then the whole tick.
pub(crate) fn stage_infos(histograms: &[Histogram]) -> Vec<StageInfo> {
    let us = |ns: u64| ns as f64 * 1e-3;
    STAGE_NAMES
        .iter()
        .copied()
        .chain(["tick"])
        .zip(histograms)
        .map(|(stage, h)| StageInfo {
            stage: stage.into(),
            p50_us: us(h.quantile(0.5)),
            p99_us: us(h.quantile(0.99)),
            max_us: us(h.max()),
        })
        .collect()
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
            writeln!(f, "  cut short: {reason}; `palpate recover` makes a finished file of what is there")?;
        }
        writeln!(
            f,
            "  {} keyframes, {} commands, {} nets; {} records lost, {} ticks skipped, {} late",
            self.keyframes, self.commands, self.nets, self.dropped_records, self.skipped_ticks, self.late_ticks
        )?;
        writeln!(f, "  session hash {}, final state {}", self.session_hash, self.final_hash)?;
        writeln!(f, "  made by {}", self.build)?;
        for tool in &self.tools {
            writeln!(
                f,
                "  tool {}: {} poses, {} ticks in contact, peak force {:.4} N, peak depth {:.3} mm, work of the hand {:.6} J",
                tool.id,
                tool.poses,
                tool.contact_ticks,
                tool.peak_force_n,
                tool.peak_depth_m * 1e3,
                tool.energy_j
            )?;
        }
        write_stages(f, &self.stages)
    }
}

/// The stage table.
pub(crate) fn write_stages(f: &mut impl fmt::Write, stages: &[StageInfo]) -> fmt::Result {
    writeln!(f, "  {:<8} {:>10} {:>10} {:>10}", "stage", "p50 us", "p99 us", "max us")?;
    for stage in stages {
        writeln!(f, "  {:<8} {:>10.1} {:>10.1} {:>10.1}", stage.stage, stage.p50_us, stage.p99_us, stage.max_us)?;
    }
    Ok(())
}
