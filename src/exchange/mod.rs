//! Surfaces and meshes to and from the files of other programs.
//!
//! | format | surfaces | meshes | points |
//! |---|---|---|---|
//! | JSON (`palpate.surface.v1`) | read, write | | |
//! | STEP | read, write | | |
//! | IGES | read, write | | |
//! | STL | | read, write | read |
//! | OBJ | | write | read |
//! | glTF (`.glb`) | | write | |
//! | text (`.xyz`, `.csv`, `.txt`) | | | read |
//!
//! ```text
//! bytes ── step | iges ──▶ FileSurface: net, knots with multiplicities ──▶ Surface ──▶ Written ── step | iges ──▶ text
//! ```
//! Whatever the bytes, reading ends with a value or a typed error; memory stays within a constant times their number.
//!
//! ```
//! use palpate::exchange::{Format, Pick, read_surface, write_surface};
//! use palpate::surface::{builtin, file::Unit};
//!
//! let drop = builtin("teardrop", None, None)?;
//! let file = write_surface(&drop, Format::Step, Unit::Metre)?;
//! let read = read_surface(&file, Format::Step, Pick::First)?;
//! assert_eq!(read.surface.net(), drop.net());
//! assert_eq!((read.count, read.unit.to_string().as_str()), (1, "m"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod number;
mod spline;
pub mod step;
mod units;

#[cfg(test)]
mod testing;

pub use spline::SplineError;
pub use step::StepError;
pub use units::LengthUnit;

use crate::surface::{FileError, Surface, file};
use std::fmt;
use std::path::Path;

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `palpate.surface.v1`.
    Json,
    /// ISO 10303-21.
    Step,
}

impl Format {
    /// By the ending of a file's name, in either case.
    ///
    /// # Errors
    /// An ending that none of ours has.
    pub fn of(path: impl AsRef<Path>) -> Result<Self, ExchangeError> {
        let extension = path.as_ref().extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        match extension.as_str() {
            "json" => Ok(Self::Json),
            "step" | "stp" => Ok(Self::Step),
            _ => Err(ExchangeError::Extension { extension }),
        }
    }

    /// As people call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Json => "palpate.surface.v1 (JSON)",
            Self::Step => "STEP",
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
    /// Its number in the file (0 where files have none).
    pub id: u64,
    /// How many surfaces the file has that could have been picked.
    pub count: usize,
    /// The unit that the file's coordinates were in.
    pub unit: LengthUnit,
}

/// Why a file was not read or written.
#[derive(Debug, thiserror::Error)]
pub enum ExchangeError {
    /// An ending that none of ours has.
    #[error("no format is known by the ending \".{extension}\"; there are .json, .step, .stp")]
    Extension {
        /// The ending, without its point.
        extension: String,
    },
    /// A `palpate.surface.v1` document.
    #[error(transparent)]
    Json(#[from] FileError),
    /// A text format with bytes that are no text.
    #[error("byte {at} is not UTF-8 text")]
    Text {
        /// Where.
        at: usize,
    },
    /// A STEP file.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A surface that a format has no form for.
    #[error(transparent)]
    Spline(#[from] SplineError),
}

/// Reads one surface.
///
/// # Errors
/// See [`ExchangeError`]; each says what is wrong and where.
pub fn read_surface(bytes: &[u8], format: Format, pick: Pick) -> Result<Imported, ExchangeError> {
    match format {
        Format::Json => {
            let text = std::str::from_utf8(bytes).map_err(|error| ExchangeError::Text { at: error.valid_up_to() })?;
            let surface = file::read(text)?;
            Ok(Imported { surface, id: 0, count: 1, unit: LengthUnit::of_metres("m", 1.0, 1.0) })
        }
        Format::Step => Ok(step::read(bytes, pick)?),
    }
}

/// The file of one surface, coordinates in `unit`. In metres, reading it gives the same numbers bit for bit.
///
/// # Errors
/// A format without surfaces, or a surface that the format has no form for.
pub fn write_surface(surface: &Surface, format: Format, unit: file::Unit) -> Result<Vec<u8>, ExchangeError> {
    match format {
        Format::Json => Ok(file::write(surface, unit).into_bytes()),
        Format::Step => Ok(step::write(surface, unit)?.into_bytes()),
    }
}
