//! Surfaces and meshes to and from the files of other programs.
//!
//! | format | surfaces | meshes | points |
//! |---|---|---|---|
//! | JSON (`palpate.surface.v1`) | read, write | | |
//! | STEP | read, write | | |
//! | IGES | read, write | | |
//! | STL | | read, write | read |
//! | OBJ | | read, write | read |
//! | PLY | | read | read |
//! | glTF (`.glb`) | | read, write | read |
//! | text (`.xyz`, `.csv`, `.txt`) | | | read |
//!
//! ```text
//! bytes ── step | iges ──▶ FileSurface: net, knots with multiplicities ──▶ Surface ──▶ Written ── step | iges ──▶ text
//! ```
//! Whatever the bytes, reading ends with a value or a typed error; memory stays within a constant
//! times their number.
//!
//! ```
//! use palpate_geometry::exchange::{Format, Pick, read_surface, write_surface};
//! use palpate_geometry::surface::{builtin, file::Unit};
//!
//! let drop = builtin("teardrop", None, None)?;
//! let file = write_surface(&drop, Format::Step, Unit::Metre)?;
//! let read = read_surface(&file, Format::Step, Pick::First)?;
//! assert_eq!(read.surface.net(), drop.net());
//! assert_eq!((read.count, read.unit.to_string().as_str()), (1, "m"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod iges;
pub mod mesh;
mod number;
mod spline;
pub mod step;
mod units;

#[cfg(test)]
mod extremes_tests;
#[cfg(test)]
mod testing;

pub use iges::IgesError;
pub use mesh::MeshFileError;
pub use spline::SplineError;
pub use step::StepError;
pub use units::LengthUnit;

use crate::math::Point3;
use crate::surface::file::{Document, Unit};
use crate::surface::{FileError, MergedKnots, Mesh, Surface, Trim, file};
use std::fmt;
use std::path::{Path, PathBuf};

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `palpate.surface.v1`.
    Json,
    /// ISO 10303-21.
    Step,
    /// IGES 5.3.
    Iges,
    /// STL triangles.
    Stl,
    /// Wavefront OBJ triangles.
    Obj,
    /// PLY triangles or points.
    Ply,
    /// glTF 2.0, binary.
    Glb,
    /// A point a line.
    Points,
}

impl Format {
    /// By the ending of a file's name, in either case.
    ///
    /// # Errors
    /// An ending that none of ours has.
    pub fn of(path: impl AsRef<Path>) -> Result<Self, ExchangeError> {
        let extension = path
            .as_ref()
            .extension()
            .map(|e| e.to_string_lossy().to_lowercase())
            .unwrap_or_default();
        match extension.as_str() {
            "json" => Ok(Self::Json),
            "step" | "stp" => Ok(Self::Step),
            "iges" | "igs" => Ok(Self::Iges),
            "stl" => Ok(Self::Stl),
            "obj" => Ok(Self::Obj),
            "ply" => Ok(Self::Ply),
            "glb" => Ok(Self::Glb),
            "xyz" | "csv" | "txt" => Ok(Self::Points),
            _ => Err(ExchangeError::Extension { extension }),
        }
    }

    /// As people call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Json => "palpate.surface.v1 (JSON)",
            Self::Step => "STEP",
            Self::Iges => "IGES",
            Self::Stl => "STL",
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Glb => "glTF",
            Self::Points => "points as text",
        }
    }
}

/// Which surface of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pick {
    /// The first.
    #[default]
    First,
    /// By place, from 0.
    Index(usize),
    /// By number: `#id` of STEP, the directory entry of IGES.
    Id(u64),
}

impl Pick {
    /// The number of the picked one.
    fn among(self, ids: &[u64]) -> Option<u64> {
        match self {
            Self::First => ids.first().copied(),
            Self::Index(index) => ids.get(index).copied(),
            Self::Id(id) => ids.contains(&id).then_some(id),
        }
    }
}

impl fmt::Display for Pick {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::First => write!(f, "at place 0"),
            Self::Index(index) => write!(f, "at place {index} (from 0)"),
            Self::Id(id) => write!(f, "#{id}"),
        }
    }
}

/// A surface from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The surface, m.
    pub surface: Surface,
    /// Knots of the file that were made one.
    pub merged: Vec<MergedKnots>,
    /// What is kept of it, of a JSON file that says so; `left_out` counts it too, for those who need the whole.
    pub trim: Option<Trim>,
    /// Its number in the file (0 where files have none).
    pub id: u64,
    /// How many surfaces the file has that could have been picked.
    pub count: usize,
    /// The unit that the file's coordinates were in.
    pub unit: LengthUnit,
    /// What the file says beyond this surface.
    pub left_out: LeftOut,
}

/// What a file says and a surface does not have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// Faces of the file.
    pub faces: usize,
    /// Of these, faces on planes, cylinders and other surfaces that are not B-splines.
    pub other_faces: usize,
    /// The surface's face is a part of it.
    pub trimmed: bool,
    /// Places in which assemblies put the surface, where there are several: it is then in its own
    /// coordinates.
    pub placements: usize,
}

impl LeftOut {
    /// The shape in the file is not that of the surface.
    pub fn is_any(&self) -> bool {
        self.trimmed || self.other_faces > 0 || self.placements > 0
    }
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut said = Vec::new();
        if self.trimmed {
            said.push("the trimming of its face".to_owned());
        }
        if self.other_faces > 0 {
            let (others, faces) = (self.other_faces, self.faces);
            said.push(format!(
                "{others} of {faces} faces, which are not B-splines"
            ));
        }
        if self.placements > 0 {
            said.push(format!(
                "the {} places in which assemblies put it",
                self.placements
            ));
        }
        f.write_str(&said.join("; "))
    }
}

/// Why a file was not read or written.
#[derive(Debug, thiserror::Error)]
pub enum ExchangeError {
    /// An ending that none of ours has.
    #[error(
        "unknown file extension \".{extension}\"; use .json, .step, .stp, .iges, .igs, .stl, .obj, .ply, .glb and, for points, \
         .xyz, .csv, .txt"
    )]
    Extension {
        /// The ending, without its point.
        extension: String,
    },
    /// A file that cannot be read.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The underlying error.
        source: std::io::Error,
    },
    /// A `palpate.surface.v1` document.
    #[error(transparent)]
    Json(#[from] FileError),
    /// A text format with bytes that are not text.
    #[error("byte {at} is not UTF-8 text")]
    Text {
        /// Offset of the byte.
        at: usize,
    },
    /// A STEP file.
    #[error(transparent)]
    Step(#[from] StepError),
    /// An IGES file.
    #[error(transparent)]
    Iges(#[from] IgesError),
    /// A mesh or a point cloud.
    #[error(transparent)]
    Mesh(#[from] MeshFileError),
    /// A format that is for other things.
    #[error("{} is not a format to {verb} {what}; use {instead}", format.name())]
    Kind {
        /// The format.
        format: Format,
        /// `read` or `write`.
        verb: &'static str,
        /// What was to be read or written.
        what: &'static str,
        /// Formats that do.
        instead: &'static str,
    },
    /// A surface that a format has no form for.
    #[error(transparent)]
    Spline(#[from] SplineError),
}

/// What has surfaces, for messages.
const SURFACES: &str = "STEP, IGES or JSON";

/// Reads one surface.
///
/// # Errors
/// See [`ExchangeError`]; each says what is wrong and where.
pub fn read_surface(bytes: &[u8], format: Format, pick: Pick) -> Result<Imported, ExchangeError> {
    match format {
        Format::Json => {
            let text = std::str::from_utf8(bytes).map_err(|error| ExchangeError::Text {
                at: error.valid_up_to(),
            })?;
            let Document { loaded, trim, unit } = file::read_document(text)?;
            let unit = LengthUnit::of_metres(unit.name(), 1.0, unit.per_metre());
            let left_out = LeftOut {
                trimmed: trim.is_some(),
                ..LeftOut::default()
            };
            Ok(Imported {
                surface: loaded.surface,
                merged: loaded.merged,
                trim,
                id: 0,
                count: 1,
                unit,
                left_out,
            })
        }
        Format::Step => Ok(step::read(bytes, pick)?),
        Format::Iges => Ok(iges::read(bytes, pick)?),
        Format::Stl | Format::Obj | Format::Ply | Format::Glb | Format::Points => {
            Err(ExchangeError::Kind {
                format,
                verb: "read",
                what: "a surface from",
                instead: SURFACES,
            })
        }
    }
}

/// Reads one surface from a file; the file extension determines the format.
///
/// # Errors
/// A file that cannot be read, an ending that none of our formats has, or what [`read_surface`]
/// says.
pub fn read_surface_file(path: impl AsRef<Path>, pick: Pick) -> Result<Imported, ExchangeError> {
    let path = path.as_ref();
    let format = Format::of(path)?;
    let bytes = std::fs::read(path).map_err(|source| ExchangeError::File {
        path: path.to_owned(),
        source,
    })?;
    read_surface(&bytes, format, pick)
}

/// The file of one surface, coordinates in `unit`. In metres, reading it gives the same numbers bit
/// for bit.
///
/// # Errors
/// A format without surfaces, or a surface that the format has no form for.
///
/// # Examples
/// ```
/// use palpate_geometry::exchange::{Format, Pick, read_surface, write_surface};
/// use palpate_geometry::surface::{builtin, file::Unit};
/// let sheet = builtin("sheet", None, None)?;
/// let step = write_surface(&sheet, Format::Step, Unit::Metre)?;
/// let back = read_surface(&step, Format::Step, Pick::First)?;
/// assert_eq!(back.surface.net(), sheet.net());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_surface(
    surface: &Surface,
    format: Format,
    unit: Unit,
) -> Result<Vec<u8>, ExchangeError> {
    match format {
        Format::Json => Ok(file::write(surface, unit).into_bytes()),
        Format::Step => Ok(step::write(surface, unit)?.into_bytes()),
        Format::Iges => Ok(iges::write(surface, unit)?.into_bytes()),
        Format::Stl | Format::Obj | Format::Ply | Format::Glb | Format::Points => {
            Err(ExchangeError::Kind {
                format,
                verb: "write",
                what: "a surface to",
                instead: SURFACES,
            })
        }
    }
}

/// The file of a mesh, coordinates in `unit` (glTF: always metres); STL in its binary form.
///
/// # Errors
/// A format without meshes, or a mesh that is empty or whose parts do not fit each other or the
/// format.
pub fn write_mesh(mesh: &Mesh, format: Format, unit: Unit) -> Result<Vec<u8>, ExchangeError> {
    match format {
        Format::Stl => Ok(mesh::write_stl(mesh, unit)?),
        Format::Obj => Ok(mesh::write_obj(mesh, unit)?.into_bytes()),
        Format::Glb => Ok(mesh::write_glb(mesh)?),
        Format::Json | Format::Step | Format::Iges | Format::Ply | Format::Points => {
            Err(ExchangeError::Kind {
                format,
                verb: "write",
                what: "a mesh to",
                instead: "STL, OBJ or glTF",
            })
        }
    }
}

/// The triangles of an STL, OBJ, PLY or glTF file; coordinates in `unit` (glTF: always metres).
///
/// # Errors
/// A format without triangles that are read, or a file that is cut short or names corners it does
/// not have.
pub fn read_mesh(bytes: &[u8], format: Format, unit: Unit) -> Result<Mesh, ExchangeError> {
    match format {
        Format::Stl => Ok(mesh::read_stl(bytes, unit)?),
        Format::Obj => Ok(mesh::read_obj(bytes, unit)?),
        Format::Ply => Ok(mesh::read_ply(bytes, unit)?),
        Format::Glb => Ok(mesh::read_glb(bytes)?),
        _ => Err(ExchangeError::Kind {
            format,
            verb: "read",
            what: "a mesh from",
            instead: "STL, OBJ, PLY or glTF (.glb)",
        }),
    }
}

/// The points of a cloud: corners of an STL, OBJ, PLY or glTF file (of STL and glTF each once), or lines
/// of text; coordinates in `unit` (glTF: always metres).
///
/// # Errors
/// A format without points, or a file that is cut short or has a line that is not a point.
pub fn read_points(bytes: &[u8], format: Format, unit: Unit) -> Result<Vec<Point3>, ExchangeError> {
    match format {
        Format::Stl => Ok(mesh::read_stl(bytes, unit)?.points),
        Format::Obj => Ok(mesh::read_obj_points(bytes, unit)?),
        Format::Ply => Ok(mesh::read_ply_points(bytes, unit)?),
        Format::Glb => Ok(mesh::read_glb(bytes)?.points),
        Format::Points => Ok(mesh::read_text_points(bytes, unit)?),
        Format::Json | Format::Step | Format::Iges => {
            let instead = "STL, OBJ, PLY, glTF (.glb) or text (.xyz, .csv)";
            Err(ExchangeError::Kind {
                format,
                verb: "read",
                what: "points from",
                instead,
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_known_by_the_ending_of_a_name() {
        let cases = [
            ("a/b.step", Format::Step),
            ("b.STP", Format::Step),
            ("c.igs", Format::Iges),
            ("c.IGES", Format::Iges),
            ("d.json", Format::Json),
            ("e.stl", Format::Stl),
            ("f.obj", Format::Obj),
            ("g.glb", Format::Glb),
            ("i.PLY", Format::Ply),
            ("h.csv", Format::Points),
        ];
        for (path, format) in cases {
            assert_eq!(Format::of(path).unwrap(), format, "{path}");
        }
        for path in ["a.dae", "a", "", ".step"] {
            assert!(
                matches!(Format::of(path), Err(ExchangeError::Extension { .. })),
                "{path}"
            );
        }
    }

    #[test]
    fn every_format_reads_and_writes_what_it_is_for_and_says_so_otherwise() {
        for (name, surface) in testing::surfaces() {
            for format in [Format::Json, Format::Step, Format::Iges] {
                let bytes = write_surface(&surface, format, Unit::Metre).unwrap();
                assert_eq!(
                    read_surface(&bytes, format, Pick::First).unwrap().surface,
                    surface,
                    "{name}, {format:?}"
                );
            }
        }
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/opencascade/periodic.step");
        assert!(
            read_surface_file(path, Pick::First)
                .unwrap()
                .surface
                .knots_u()
                .is_periodic()
        );
        assert!(matches!(
            read_surface_file("/nowhere/a.step", Pick::First),
            Err(ExchangeError::File { .. })
        ));
        let message = read_surface(b"", Format::Stl, Pick::First)
            .unwrap_err()
            .to_string();
        assert_eq!(
            message,
            "STL is not a format to read a surface from; use STEP, IGES or JSON"
        );
        let mesh = Mesh::default();
        assert!(matches!(
            write_mesh(&mesh, Format::Step, Unit::Metre),
            Err(ExchangeError::Kind { .. })
        ));
        assert!(matches!(
            write_mesh(&mesh, Format::Glb, Unit::Metre),
            Err(ExchangeError::Mesh(MeshFileError::Empty(_)))
        ));
        assert!(matches!(
            read_points(b"", Format::Step, Unit::Metre),
            Err(ExchangeError::Kind { .. })
        ));
        assert_eq!(
            read_points(b"1 2 3", Format::Points, Unit::Metre).unwrap(),
            [Point3::new(1.0, 2.0, 3.0)]
        );
        assert!(matches!(
            read_surface(&[b'{', 0xff], Format::Json, Pick::First),
            Err(ExchangeError::Text { at: 1 })
        ));
    }
}
