//! Where a surface comes from.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// `surface = { builtin = "teardrop", net = [8, 8] }`, `{ file = "x.json" }` or `{ inline = {…} }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurfaceSpec {
    /// Name of a builtin: `sheet`, `sphere`, `teardrop`, `torus`.
    #[serde(default)]
    pub builtin: Option<String>,
    /// Net of a builtin; its own default when absent.
    #[serde(default)]
    pub net: Option<[usize; 2]>,
    /// Size of a builtin, m: side of the sheet, radius of the sphere, length of the teardrop, great
    /// radius of the torus.
    #[serde(default)]
    pub size: Option<f64>,
    /// A `palpate.surface.v1` file, relative to the scene file.
    #[serde(default)]
    pub file: Option<PathBuf>,
    /// A `palpate.surface.v1` document in place.
    #[serde(default)]
    pub inline: Option<serde_json::Value>,
}
