//! What a run comes to.

use serde::{Deserialize, Serialize};

/// What a tool met.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ToolFigures {
    /// Its id.
    pub tool: String,
    /// Greatest force for its device, N.
    #[serde(deserialize_with = "or_nan")]
    pub peak_force_n: f64,
    /// When, s.
    #[serde(deserialize_with = "or_nan")]
    pub peak_force_s: f64,
    /// Deepest contact of the device's tool, m.
    #[serde(deserialize_with = "or_nan")]
    pub peak_depth_m: f64,
    /// Net work of the device on the loop by the end, J.
    #[serde(deserialize_with = "or_nan")]
    pub energy_j: f64,
    /// Most that the loop had made at any time, J.
    #[serde(deserialize_with = "or_nan")]
    pub made_j: f64,
    /// Columns that the sweep asks for; none where no tick had it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub asked: Vec<Option<f64>>,
}

/// JSON writes numbers that are not finite as nothing.
fn or_nan<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

/// What a run came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Why it failed: nothing was simulated, or what was is not to be trusted.
    pub error: Option<String>,
    /// SHA-256 of what it follows from; empty where the scene does not read.
    pub key: String,
    /// Ticks that ran.
    pub ticks: u64,
    /// Ticks with a fault: a body was set back to rest.
    pub faults: u64,
    /// Simulated time, s.
    pub time_s: f64,
    /// By tool, all that the scene has.
    pub tools: Vec<ToolFigures>,
    /// Hash over the state hashes of all ticks, as recordings have it.
    pub session_hash: String,
    /// Hash of the state after the last tick.
    pub state_hash: String,
    /// Wall time, s: of the run that was made, not of one from the cache.
    pub wall_s: f64,
}
