//! A session at a glance.

use super::channel::Topic;
use super::file_info::{FileInfo, file_info};
use super::reader::{Follower, ReadError, Session};
use super::totals::{Tally, Totals, write_stage, write_stages};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// Where figures come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// The recorder summed up when it finished the file; chunks were not read.
    Index,
    /// Every chunk was read.
    Chunks,
}

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
    /// Records lost while recording.
    pub dropped_records: u64,
    /// Finished, and nothing lost.
    pub clean: bool,
    /// One of several files of a session, or what was kept of a longer one.
    pub is_part: bool,
    /// Metadata of the recorder about this part, as written.
    pub part: BTreeMap<String, String>,
    /// All that the head says: format, target, clock and more.
    pub metadata: BTreeMap<String, String>,
    /// What is missing of the file, if anything was found missing.
    pub cut_short: Option<String>,
    /// It was reduced to its inputs: forces, stages and hashes are not in it.
    pub inputs_only: bool,
    /// Commands.
    pub commands: u64,
    /// Where the figures of ticks and channels come from.
    pub figures_from: Origin,
    /// Figures of all ticks.
    #[serde(flatten)]
    pub totals: Totals,
    /// What the file is made of.
    pub file: FileInfo,
}

impl std::ops::Deref for Info {
    type Target = Totals;

    fn deref(&self) -> &Totals {
        &self.totals
    }
}

/// Sums a session up: with the figures that its recorder left at its end, if it did; else from
/// every tick, in one pass over the file.
///
/// # Errors
/// As of [`Follower`].
pub fn info(session: &Session) -> Result<Info, ReadError> {
    match written(session) {
        Some(totals) => Ok(of(session, totals, Origin::Index)),
        None => computed_info(session),
    }
}

/// Sums a session up from every tick, whatever its recorder left at its end: the pass reads every
/// chunk, and so finds those that are damaged.
///
/// # Errors
/// As of [`Follower`].
pub fn computed_info(session: &Session) -> Result<Info, ReadError> {
    let mut tally = Tally::new(&session.header.names("tools"));
    let mut follower = Follower::new(session).reading_ahead();
    for happening in &mut follower {
        tally.take(&happening?);
    }
    let mut totals = tally.finish();
    totals.channels.clone_from(follower.counts());
    Ok(of(session, totals, Origin::Chunks))
}

/// What the recorder summed up, if it counted what the index of the file counts.
fn written(session: &Session) -> Option<Totals> {
    let totals: Totals = serde_json::from_str(session.written_totals()?).ok()?;
    let ends = totals.first_tick.zip(totals.last_tick);
    let commands = totals.commands_by_name.values();
    let fits = session.has_index()
        && ends == session.tick_range()
        && totals.ticks == session.tick_count()
        && totals.keyframes == session.message_count(Topic::Keyframe)
        && totals.nets == session.message_count(Topic::Net)
        && totals.events == session.message_count(Topic::Event)
        && commands.fold(0, |sum: u64, n| sum.saturating_add(*n))
            == session.message_count(Topic::Command)
        && totals.tools.len() == session.header.names("tools").len();
    fits.then_some(totals)
}

fn of(session: &Session, mut totals: Totals, figures_from: Origin) -> Info {
    let run = |key: &str| session.header.run.get(key).cloned().unwrap_or_default();
    let dt_s = session.run_number("dt_ns").unwrap_or(0) as f64 * 1e-9;
    let part = part(session);
    let duration_s = totals.ticks as f64 * dt_s;
    let channels = std::mem::take(&mut totals.channels);
    let inputs_only = session.holds_inputs_only();
    if inputs_only {
        totals.session_hash.clear();
        totals.final_hash.clear();
    }
    Info {
        path: session.path.display().to_string(),
        scene: run("scene"),
        build: run("build"),
        scene_sha256: run("scene_sha256"),
        bodies: session.header.names("bodies"),
        started_unix_ns: session.run_number("started_unix_ns"),
        duration_s,
        dropped_records: session.end_number("dropped_records").unwrap_or(0),
        clean: session.is_whole(),
        is_part: totals.first_keyframe.is_some_and(|tick| tick > 0) || !part.is_empty(),
        part,
        metadata: session.header.run.clone(),
        cut_short: session.cut_short().map(str::to_owned),
        inputs_only,
        commands: totals.commands_by_name.values().sum(),
        figures_from,
        file: file_info(session, &channels, duration_s),
        totals,
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
        if self.figures_from == Origin::Index {
            writeln!(
                f,
                "  figures as the recorder summed them up; --check reads every chunk"
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
        if self.inputs_only {
            writeln!(
                f,
                "  inputs only: `palpate replay` runs them, with --record it makes a whole recording"
            )?;
            for tool in &self.tools {
                writeln!(f, "  tool {}: {} poses", tool.id, tool.poses)?;
            }
            writeln!(f, "  made by {}", self.build)?;
            return write!(f, "{}", self.file);
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
        write!(f, "{}", self.file)
    }
}
