//! A run while it goes on, and what it came to.

use super::hands::HandAtWork;
use super::scan::StiffnessMap;
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::TickRecord;
use palpate_sim::tick::{SceneState, Scratch};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// How to run one run.
#[derive(Clone, Debug, Default)]
pub struct RunSettings {
    /// Record to this file.
    pub record: Option<PathBuf>,
    /// Where surfaces and pictures go.
    pub out: Option<PathBuf>,
    /// No longer than this, s.
    pub most_s: Option<f64>,
}

/// Where the devices of a run were, tick by tick.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// By tool: position in the world, m, and force on the device, N.
    pub tools: BTreeMap<String, Vec<([f64; 3], f64)>>,
}

/// What a run came to, beside its meters.
#[derive(Clone, Debug, Default)]
pub struct Played {
    /// Figures of modeling steps, by name.
    pub values: BTreeMap<String, f64>,
    /// Of a scan.
    pub map: Option<StiffnessMap>,
    /// Of tools.
    pub trace: Trace,
    /// Wall time of ticks, µs: median, 99 %, greatest. Not the same twice.
    pub tick_us: Option<[f64; 3]>,
    /// Hash of the state after the last tick.
    pub state_hash: u64,
    /// Faults, such as a body set back to rest.
    pub faults: u64,
    /// Ticks that ran.
    pub ticks: u64,
    /// Files written.
    pub files: Vec<PathBuf>,
}

/// A run at a time.
pub struct View<'a> {
    pub scene: &'a Scene,
    pub state: &'a SceneState,
    pub scratch: &'a Scratch,
    pub record: &'a TickRecord,
    pub hands: &'a [Option<HandAtWork>],
    pub time_s: f64,
}
