//! What the ticks of a recording come to, summed up in one pass.
//!
//! The recorder sums up while it writes, and leaves the result in the file it finishes: whoever
//! only wants the figures need not read the ticks. Whoever reads the ticks sums up with the same
//! code, in the same order, and comes to the same bits.

use super::channel::Happening;
use super::figures::{ToolFigures, ToolSum};
use super::inputs::InputBlock;
use super::message::{Message, SessionHash};
use palpate_drive::stats::{Histogram, LATE_NS, StageHistograms};
use palpate_sim::tick::record::{Command, TickInput, TickRecord};
use palpate_wire::{ConvertError, command_to_proto};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// Figures of all ticks of a recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Totals {
    /// Ticks.
    pub ticks: u64,
    /// First of them.
    pub first_tick: Option<u64>,
    /// Last of them.
    pub last_tick: Option<u64>,
    /// Ticks missing between the first and the last.
    pub gaps: u64,
    /// Deadlines skipped.
    pub skipped_ticks: u64,
    /// Ticks that began more than 100 µs late.
    pub late_ticks: u64,
    /// Keyframes.
    pub keyframes: u64,
    /// Tick of the first keyframe.
    pub first_keyframe: Option<u64>,
    /// Commands by name.
    pub commands_by_name: BTreeMap<String, u64>,
    /// Nets.
    pub nets: u64,
    /// Events.
    pub events: u64,
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
    /// By channel id: messages and their bytes, before compression. Empty once they are in
    /// [`super::FileInfo`].
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub channels: BTreeMap<u16, (u64, u64)>,
}

/// Figures of a tool.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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

/// Sums up what it is given, in order.
#[derive(Debug)]
pub(super) struct Tally {
    totals: Totals,
    tools: Vec<(ToolSum, u64)>,
    /// By stage, then of whole ticks.
    histograms: StageHistograms,
    lateness: Histogram,
    session_hash: SessionHash,
    final_hash: u64,
}

impl Tally {
    /// Of a scene with these tools.
    pub fn new(tools: &[String]) -> Self {
        let tools = tools.iter().map(|id| (ToolSum::new(id.clone()), 0));
        Self {
            totals: Totals::default(),
            tools: tools.collect(),
            histograms: StageHistograms::default(),
            lateness: Histogram::default(),
            session_hash: SessionHash::default(),
            final_hash: 0,
        }
    }

    /// Takes in what a follower met.
    pub fn take(&mut self, happening: &Happening) {
        let totals = &mut self.totals;
        match happening {
            Happening::Tick(record) => self.tick(record),
            Happening::Keyframe(keyframe) => self.keyframe(keyframe.tick),
            Happening::Command(after_tick, command) => self.command(*after_tick, *command),
            Happening::Event(_) => totals.events += 1,
            Happening::Net(_) => totals.nets += 1,
            Happening::Inputs(block) => self.inputs(block),
            Happening::Other(_) => {}
        }
    }

    /// Takes in what a recorder writes.
    pub fn write(&mut self, message: &Message) -> Result<(), ConvertError> {
        self.take(&message.topic.decode(&message.data)?);
        Ok(())
    }

    /// Counts a message of a channel.
    pub fn count(&mut self, channel: u16, bytes: usize) {
        let count = self.totals.channels.entry(channel).or_default();
        *count = (count.0 + 1, count.1 + bytes as u64);
    }

    fn keyframe(&mut self, tick: u64) {
        self.totals.keyframes += 1;
        self.totals.first_keyframe.get_or_insert(tick);
    }

    fn command(&mut self, after_tick: u64, command: Command) {
        let name = command_to_proto(after_tick, command).name;
        *self.totals.commands_by_name.entry(name).or_default() += 1;
    }

    /// Counts a tick with what went into it.
    fn input(&mut self, tick: u64, input: &TickInput) {
        let totals = &mut self.totals;
        totals.ticks += 1;
        totals.first_tick.get_or_insert(tick);
        if let Some(last) = totals.last_tick {
            let missing = tick.saturating_sub(last).saturating_sub(1);
            totals.gaps = totals.gaps.saturating_add(missing);
        }
        totals.last_tick = Some(tick);
        let poses = input.poses.first(self.tools.len());
        for ((_, poses), pose) in self.tools.iter_mut().zip(poses) {
            *poses += u64::from(pose.is_some());
        }
    }

    fn inputs(&mut self, block: &InputBlock) {
        for (after_tick, command) in &block.commands {
            self.command(*after_tick, *command);
        }
        for (tick, input) in (block.tick..).zip(&block.ticks) {
            self.input(tick, input);
        }
    }

    fn tick(&mut self, record: &TickRecord) {
        let tick = record.output.tick;
        self.input(tick, &record.input);
        let totals = &mut self.totals;
        totals.skipped_ticks += u64::from(record.input.skipped);
        totals.late_ticks += u64::from(record.late_ns > LATE_NS);
        self.session_hash.push(tick, record.output.state_hash);
        self.final_hash = record.output.state_hash;
        let outputs = record.output.tools.first(self.tools.len());
        for ((sum, _), output) in self.tools.iter_mut().zip(outputs) {
            sum.push(tick, output);
        }
        self.lateness.add(record.late_ns);
        self.histograms.add(&record.stage_ns);
    }

    /// What it comes to.
    pub fn finish(self) -> Totals {
        let tools = self.tools.iter();
        Totals {
            final_hash: format!("{:016x}", self.final_hash),
            session_hash: self.session_hash.to_string(),
            tools: tools
                .map(|(sum, poses)| tool(sum.finish(), *poses))
                .collect(),
            stages: stage_infos(&self.histograms),
            lateness: stage_info("late", &self.lateness),
            ..self.totals
        }
    }
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
pub fn stage_infos(histograms: &StageHistograms) -> Vec<StageInfo> {
    histograms
        .named()
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

/// The stage table.
pub fn write_stages(f: &mut impl fmt::Write, stages: &[StageInfo]) -> fmt::Result {
    writeln!(
        f,
        "  {:<8} {:>10} {:>10} {:>10}",
        "stage", "p50 us", "p99 us", "max us"
    )?;
    stages.iter().try_for_each(|stage| write_stage(f, stage))
}

pub(super) fn write_stage(f: &mut impl fmt::Write, stage: &StageInfo) -> fmt::Result {
    writeln!(
        f,
        "  {:<8} {:>10.1} {:>10.1} {:>10.1}",
        stage.stage, stage.p50_us, stage.p99_us, stage.max_us
    )
}
