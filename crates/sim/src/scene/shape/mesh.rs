//! A closed triangle mesh.

use super::interface::Shape;
use super::outline;
use crate::scene::door::At;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::contact::mesh::MeshTool;
use palpate_geometry::exchange::{self, Format};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::Mesh;
use palpate_geometry::surface::file::Unit;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// `mesh = { file = "probe.stl", unit = "mm" }`: a closed triangle mesh in the tool's frame, from exactly one of
/// `file`, `inline`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MeshSpec {
    /// An STL, OBJ, PLY or glTF (.glb) file, relative to the scene file.
    #[serde(default)]
    pub file: Option<PathBuf>,
    /// The mesh in place, in metres.
    #[serde(default)]
    pub inline: Option<InlineMesh>,
    /// Length unit of the file; glTF is always in metres.
    #[serde(default)]
    pub unit: MeshUnit,
}

/// A mesh in place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct InlineMesh {
    /// Corners.
    #[cfg_attr(test, schemars(extend("x-unit" = "m")))]
    pub vertices: Vec<[f64; 3]>,
    /// Indices of corners, from 0, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Length unit of a mesh file, which has none of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum MeshUnit {
    /// The mesh file is in metres.
    #[default]
    M,
    /// The mesh file is in millimetres.
    Mm,
}

impl Shape for MeshSpec {
    fn build(&self, at: &At<'_>) -> Option<ToolShape> {
        let (key, vertices, triangles) = match (&self.file, &self.inline) {
            (Some(file), None) => {
                let mesh = self.read(file, at)?;
                ("file", mesh.points, mesh.triangles)
            }
            (None, Some(mesh)) => {
                let vertices = mesh.vertices.iter().map(|&p| Point3::from(p)).collect();
                ("inline", vertices, mesh.triangles.clone())
            }
            _ => return at.refused("mesh needs exactly one of file, inline"),
        };
        let tool = at.key(key).take(MeshTool::new(&vertices, &triangles))?;
        Some(ToolShape::Mesh(Box::new(tool)))
    }

    fn outline(&self, built: &ToolShape, _view_m: f64) -> Mesh {
        match built {
            ToolShape::Mesh(tool) => {
                Mesh::from_triangles(tool.vertices().to_vec(), tool.triangles().to_vec())
                    .unwrap_or_else(outline::nothing)
            }
            _ => outline::nothing(),
        }
    }

    fn inline_files(&mut self, at: &At<'_>) -> Option<()> {
        let Some(file) = &self.file else {
            return Some(());
        };
        let read = self.read(file, at)?;
        let vertices = read.points.iter().map(|p| p.coords.into()).collect();
        *self = Self {
            file: None,
            inline: Some(InlineMesh {
                vertices,
                triangles: read.triangles,
            }),
            unit: MeshUnit::M,
        };
        Some(())
    }
}

impl MeshSpec {
    fn read(&self, file: &Path, at: &At<'_>) -> Option<Mesh> {
        let bytes = at.read_file("file", file)?;
        let unit = match self.unit {
            MeshUnit::M => Unit::Metre,
            MeshUnit::Mm => Unit::Millimetre,
        };
        let read = Format::of(file).and_then(|format| exchange::read_mesh(&bytes, format, unit));
        at.key("file")
            .take(read.map_err(|e| format!("{}: {e}", at.name_of(file))))
    }
}
