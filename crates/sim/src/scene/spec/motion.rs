//! `motion` of a rigid `[[body]]`: where it goes by itself.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// `motion = { file = "tilt.toml" }`, or the keys of such a file in place. `motion = {}`: the body
/// stays where it is until a command moves it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct MotionSpec {
    /// A TOML file with the other keys, relative to the scene file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// Begin again at the end of the last way-point.
    #[serde(skip_serializing_if = "is_false")]
    pub repeat: bool,
    /// How to go from one way-point to the next.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interpolation: Option<InterpolationSpec>,
    /// `[[waypoint]]`: places at times; none: the body's own placement.
    #[serde(rename = "waypoint", skip_serializing_if = "Vec::is_empty")]
    pub waypoints: Vec<WaypointSpec>,
    /// `[[shake]]`: oscillations, added to that.
    #[serde(rename = "shake", skip_serializing_if = "Vec::is_empty")]
    pub shakes: Vec<ShakeSpec>,
}

/// How to go from one way-point to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum InterpolationSpec {
    /// From rest to rest, with the least jerk.
    #[default]
    Smooth,
    /// At constant speed.
    Linear,
}

/// `[[waypoint]]`, as in motions of tools.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct WaypointSpec {
    /// Time from the start; later than that of the way-point before.
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub time_s: f64,
    /// Origin of the body's frame in the world.
    #[cfg_attr(test, schemars(extend("x-unit" = "m")))]
    pub position: [f64; 3],
    /// Unit quaternion x y z w; that of the way-point before (at first: of the body's placement) if
    /// left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orientation: Option<[f64; 4]>,
    /// How long to stay there.
    #[serde(default)]
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub hold_s: f64,
}

/// `[[shake]]`: a sine along a direction, which swells and fades over one period.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ShakeSpec {
    /// Direction in the world, of any length above 0.
    pub direction: [f64; 3],
    /// Amplitude.
    pub amplitude_m: f64,
    /// Frequency.
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub frequency_hz: f64,
    /// When it begins.
    #[serde(default)]
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub from_s: f64,
    /// When it ends; never if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_s: Option<f64>,
}

fn is_false(value: &bool) -> bool {
    !value
}
