//! Meshes and point clouds: STL, OBJ, PLY, glTF, and points as text.
//!
//! STL, OBJ and PLY name no unit: they are written in the unit asked for, and read in the unit given.
//! glTF is in metres, with y up; ours is z.

mod glb;
mod glb_read;
mod obj;
mod ply;
mod points;
mod polygon;
mod stl;

pub use glb::write as write_glb;
pub use glb_read::read as read_glb;
pub use obj::{read as read_obj, read_points as read_obj_points, write as write_obj};
pub use ply::{read as read_ply, read_points as read_ply_points};
pub use points::read as read_text_points;
pub use polygon::Flaw;
pub use stl::{read as read_stl, write as write_stl, write_ascii as write_stl_ascii};

use crate::math::{MOST_COORDINATE_M, Point3, first_outside};
use crate::surface::Mesh;

/// Why a mesh or a point cloud was not read or written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshFileError {
    /// Nothing to write, or nothing in the file.
    #[error("there are no {0}")]
    Empty(&'static str),
    /// A triangle with a corner that does not exist.
    #[error("triangle {triangle} has corner {corner}, the mesh has {count}")]
    Corner {
        /// Index of the triangle.
        triangle: usize,
        /// Its corner.
        corner: u32,
        /// Corners of the mesh.
        count: usize,
    },
    /// Normals that are not one a corner.
    #[error("{given} normals for {needed} corners")]
    Normals {
        /// Given number.
        given: usize,
        /// Needed number.
        needed: usize,
    },
    /// A coordinate that is not finite, or too large to calculate with.
    #[error(
        "corner {corner} has coordinate {value} m, not a finite number within ±{MOST_COORDINATE_M:e} m"
    )]
    Coordinate {
        /// Index of the corner.
        corner: usize,
        /// The value given.
        value: f64,
    },
    /// A face whose corners do not form a polygon.
    #[error("face {face}{}: its {corners} corners {flaw}", at_line(*line))]
    Polygon {
        /// Which one, from 1.
        face: usize,
        /// Line, from 1, in files that have lines.
        line: Option<usize>,
        /// Corners it has.
        corners: usize,
        /// What is wrong with it.
        flaw: Flaw,
    },
    /// Faces of a kind that is not read: the shape would lack them.
    #[error("line {line}: faces of this kind (`{keyword}`) are not read; convert them to polygons")]
    Faces {
        /// Line, from 1.
        line: usize,
        /// What the line begins with.
        keyword: &'static str,
    },
    /// Text with two bytes a letter.
    #[error("the file is text in UTF-16; save it as UTF-8 or ASCII")]
    Wide,
    /// More than the format's counters hold.
    #[error("{count} {what} are more than the format can count")]
    Many {
        /// What there is too much of.
        what: &'static str,
        /// Number given.
        count: usize,
    },
    /// A binary file whose length is not that of its triangles, up to some filling.
    #[error(
        "neither a text STL, which begins with the word solid, nor a binary one: its header counts {triangles} triangles, which need \
         {needed} bytes, and the file has {bytes}; export it anew as STL, or rename it if it is in another format"
    )]
    Length {
        /// Bytes of the file.
        bytes: usize,
        /// Triangles it says it has.
        triangles: u32,
        /// Bytes these take.
        needed: u64,
    },
    /// A file that ends before what it says it has.
    #[error("the {0} file seems to be cut short")]
    Cut(&'static str),
    /// A value that is none of the format's.
    #[error("{format}: expected {wanted}, found {found}")]
    Value {
        /// As people call the format.
        format: &'static str,
        /// What may stand there.
        wanted: &'static str,
        /// What does: a kind, or a number.
        found: String,
    },
    /// A file that is too short to be one.
    #[error("{0} bytes are too few for an STL file")]
    Short(usize),
    /// A line that is none of the format's.
    #[error("line {line}: expected {wanted}, found {found}")]
    Line {
        /// Line, from 1.
        line: usize,
        /// What may stand there.
        wanted: &'static str,
        /// What the line is made of.
        found: String,
    },
}

/// Every coordinate can be calculated with, and written in single precision in either unit.
fn checked(points: &[Point3]) -> Result<(), MeshFileError> {
    match first_outside(points) {
        Some((corner, value)) => Err(MeshFileError::Coordinate { corner, value }),
        None => Ok(()),
    }
}

/// What every writer relies on.
fn check(mesh: &Mesh) -> Result<(), MeshFileError> {
    if mesh.triangles.is_empty() {
        return Err(MeshFileError::Empty("triangles"));
    }
    if mesh.normals.len() != mesh.points.len() {
        return Err(MeshFileError::Normals {
            given: mesh.normals.len(),
            needed: mesh.points.len(),
        });
    }
    for what in [
        ("corners", mesh.points.len()),
        ("triangles", mesh.triangles.len()),
    ] {
        // Counters have 32 bits, and so have lengths in bytes: 24 a corner, 50 a triangle.
        if what.1 > (u32::MAX / 64) as usize {
            return Err(MeshFileError::Many {
                what: what.0,
                count: what.1,
            });
        }
    }
    checked(&mesh.points)?;
    let count = mesh.points.len();
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        if let Some(&corner) = corners.iter().find(|corner| **corner as usize >= count) {
            return Err(MeshFileError::Corner {
                triangle,
                corner,
                count,
            });
        }
    }
    Ok(())
}

fn at_line(line: Option<usize>) -> String {
    line.map(|line| format!(" at line {line}"))
        .unwrap_or_default()
}

/// A text without the mark of its encoding that some programs put before it.
fn plain(bytes: &[u8]) -> Result<&[u8], MeshFileError> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(MeshFileError::Wide);
    }
    Ok(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
}

/// What ends the lines of a text: a line feed, or, where there is none before a return, that.
fn line_end(text: &[u8]) -> u8 {
    match text.iter().position(|byte| matches!(byte, b'\n' | b'\r')) {
        Some(at) if text[at] == b'\r' && text.get(at + 1) != Some(&b'\n') => b'\r',
        _ => b'\n',
    }
}

/// Lines of a text with their numbers. Bytes that are not UTF-8 are shown as such, where they
/// matter.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let end = line_end(bytes);
    bytes
        .split(move |&byte| byte == end)
        .enumerate()
        .map(|(k, line)| (k + 1, line.trim_ascii()))
}

/// The words of a line.
fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
}

/// The next three words as a point.
fn point<'a>(mut words: impl Iterator<Item = &'a [u8]>, per_metre: f64) -> Option<Point3> {
    let mut next = || Some(super::number::parse(words.next()?)? / per_metre);
    let point = Point3::new(next()?, next()?, next()?);
    first_outside(&[point]).is_none().then_some(point)
}

fn wrong_line(line: usize, wanted: &'static str, text: &[u8]) -> MeshFileError {
    MeshFileError::Line {
        line,
        wanted,
        found: described(text),
    }
}

/// What a line is made of. It is not repeated: a scene of somebody else can name any file, and the
/// message goes where that one can read it.
fn described(line: &[u8]) -> String {
    let separates = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b',' | b';');
    let fields = line.split(separates).filter(|field| !field.is_empty());
    let is_number = |field: &&[u8]| super::number::parse(field).is_some_and(f64::is_finite);
    let (numbers, words): (Vec<_>, Vec<_>) = fields.partition(is_number);
    let counted = |count: usize, what: &str| match count {
        0 => None,
        1 => Some(format!("a {what}")),
        _ => Some(format!("{count} {what}s")),
    };
    let parts = [
        counted(words.len(), "word"),
        counted(numbers.len(), "number"),
    ];
    match parts
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(" and ")
    {
        nothing if nothing.is_empty() => "an empty line".into(),
        parts => parts,
    }
}

#[cfg(test)]
mod dialect_tests;
#[cfg(test)]
mod scans_tests;
#[cfg(test)]
mod tests;
