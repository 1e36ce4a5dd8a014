//! Parts as the commands take them: all trimmed faces of a STEP file.

use crate::cli::Outcome;
use palpate_geometry::exchange::step::{self, ImportedPart, PartLeftOut, PlacedSolid};
use palpate_geometry::exchange::{Format, LengthUnit, iges};
use palpate_geometry::part::{Brep, Part, PartMesh};
use std::path::{Path, PathBuf};

/// Most triangles of a part.
const MOST_TRIANGLES: usize = 20_000_000;

/// What was asked of a file that has no such thing.
#[derive(Debug, thiserror::Error)]
pub(super) enum Misuse {
    /// Options of parts for what is none.
    #[error(
        "--part, --instance and --partial choose parts of a STEP file, for `palpate surface info`, `closest`, `convert` and \
         `tessellate`"
    )]
    Options,
    /// A part where one surface is needed.
    #[error(
        "this is a part with {faces} faces, none of them on a B-spline, and a B-spline surface is needed; `palpate surface \
         info` lists the faces"
    )]
    NoSpline { faces: usize },
    /// Cells in knot spans where there are none.
    #[error("--cells divides the spans of one B-spline surface; a part takes --tolerance")]
    Cells,
    /// A format for one surface.
    #[error(
        "a part of {faces} faces is written as .step or .stp, .igs or .iges, or as triangles: .stl, .obj or .glb; `--index N \
         --ignore-trims` takes one of its B-splines whole"
    )]
    Format { faces: usize },
    /// A part where a whole surface is needed.
    #[error(
        "this is a part of {faces} trimmed faces, and truncation takes bodies that are one closed B-spline surface"
    )]
    NotWhole { faces: usize },
    /// A format that has no parts.
    #[error(
        "truncated bodies are parts, which are written as .step or .stp; a name without an extension is a directory for both"
    )]
    Truncated,
    /// A point beyond all lengths.
    #[error("line {line}: the point is too far away to calculate with")]
    Far { line: usize },
}

/// A part (m) and the unit of its file.
pub(super) struct LoadedPart {
    pub(super) part: Part,
    /// As the file has it, but for senses that it has wrongly.
    pub(super) brep: Brep,
    pub(super) length: LengthUnit,
    pub(super) unit: String,
    /// Units to a metre.
    pub(super) per_metre: f64,
    pub(super) solids: Vec<PlacedSolid>,
    pub(super) left_out: PartLeftOut,
    /// What was taken otherwise than the file says.
    pub(super) notes: Vec<String>,
    path: PathBuf,
}

impl LoadedPart {
    pub(super) fn new(
        mut imported: ImportedPart,
        partial: bool,
        path: &Path,
    ) -> anyhow::Result<Self> {
        let part = imported.part(partial)?;
        let ImportedPart {
            brep,
            unit,
            solids,
            left_out,
            notes,
        } = imported;
        Ok(Self {
            part,
            brep,
            per_metre: super::per_metre(&unit),
            unit: unit.name().to_owned(),
            length: unit,
            solids,
            left_out,
            notes,
            path: path.to_owned(),
        })
    }

    /// Says on stderr what the part has not, and what is otherwise than in the file.
    pub(super) fn tell(&self) {
        let path = self.path.display();
        if !self.left_out.is_nothing() {
            eprintln!("note: {path}: left out: {}", self.left_out);
        }
        for note in self.left_out.errors.iter().chain(&self.notes) {
            eprintln!("note: {path}: {note}");
        }
    }

    /// A difference where faces of the file are missing.
    pub(super) fn outcome(&self) -> Outcome {
        match self.left_out.faces.is_empty() && self.left_out.lone_faces == 0 {
            true => Outcome::Ok,
            false => Outcome::Difference,
        }
    }

    /// A STEP or IGES file of it, in the unit of its own file unless another is given.
    pub(super) fn written(
        &self,
        format: Format,
        unit: Option<LengthUnit>,
    ) -> anyhow::Result<String> {
        let name = self.solids.first().map_or("", |solid| &solid.name);
        let one = self.solids.iter().all(|solid| solid.name == name) && !name.is_empty();
        let of_file = self.path.file_stem().unwrap_or_default().to_string_lossy();
        let name = if one { name } else { &of_file };
        let unit = unit.unwrap_or_else(|| self.length.clone());
        Ok(match format {
            Format::Iges => iges::write_part(&self.part, &unit, name)?,
            _ => step::write_part(&self.brep, &unit, name)?,
        })
    }

    /// Triangles within a tolerance (m).
    pub(super) fn triangles(&self, tolerance_m: f64) -> anyhow::Result<PartMesh> {
        Ok(self.part.triangles(tolerance_m, MOST_TRIANGLES)?)
    }
}
