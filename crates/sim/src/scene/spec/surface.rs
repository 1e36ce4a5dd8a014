//! Where a surface comes from.

use super::MeshUnit;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// `surface = { builtin = "teardrop", net = [8, 8] }`, `{ file = "organ.step" }` or `{ inline = {…} }`: exactly
/// one of the three. A STEP file with more than one whole B-spline is a part, for rigid bodies.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SurfaceSpec {
    /// Name of a builtin surface.
    #[serde(default)]
    #[cfg_attr(test, schemars(extend("enum" = palpate_geometry::surface::builtin::BUILTINS)))]
    pub builtin: Option<String>,
    /// Control points in u and v of a builtin (its own default when absent), or of the surface fitted to a mesh
    /// (14 × 14).
    #[serde(default)]
    pub net: Option<[usize; 2]>,
    /// Size of a builtin: side of the sheet (0.1 when absent), radius of the sphere (0.05), length of the
    /// teardrop (0.1), great radius of the torus (0.05).
    #[serde(default)]
    #[cfg_attr(test, schemars(range(min = 1e-9, max = 1e9), extend("x-unit" = "m")))]
    pub size: Option<f64>,
    /// A surface file (`palpate.surface.v1` as .json, .step, .stp, .iges, .igs), or a closed mesh (.stl, .obj, .ply,
    /// .glb) to which a surface is fitted; relative to the scene file.
    #[serde(default)]
    pub file: Option<PathBuf>,
    /// Which surface of a STEP or IGES file with several, from 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub index: Option<usize>,
    /// Name or number of a product of a STEP file of which only a part is meant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// Which of the places where a STEP file puts it, from 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instance: Option<usize>,
    /// Length unit of a mesh file, which needs it; glTF is always in metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<MeshUnit>,
    /// A `palpate.surface.v1` document in place, or `{ step = "…" }`, the text of a STEP file.
    #[serde(default)]
    pub inline: Option<serde_json::Value>,
}
