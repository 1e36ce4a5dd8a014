//! STEP (ISO 10303-21, of AP203, AP214 or AP242): parts, and single B-spline surfaces.
//!
//! ```text
//! bytes ── syntax: #id → where its text is ──▶ surface: one instance and its points ──▶ FileSurface ──▶ Surface
//!                                         └──▶ units: the context above it → metres
//! ```
//! A part ([`read_part`]) is all that the products of a file are made of, where its assemblies put them:
//! ```text
//! assembly: which solids, where ──▶ topology: shells, faces, loops ──▶ carriers, curves ──▶ Brep ── placed ──▶ ImportedPart
//!     └──▶ units: each representation's own context
//! ```
//! [`write_part`] writes one as AP242, [`write_parts`] several.
//!
//! A single surface ([`read`]): `B_SPLINE_SURFACE_WITH_KNOTS`, `BEZIER_SURFACE`, `UNIFORM_SURFACE` and
//! `QUASI_UNIFORM_SURFACE`, each also as a complex instance with `RATIONAL_B_SPLINE_SURFACE`. The
//! surface is taken whole, where its assemblies put it: trimming curves, further places of the same
//! part and other faces are left out, and [`Imported::left_out`] says so.
//!
//! The parser is ours. Of the crates, `ruststep` 0.4 brings 47 others and `truck-stepio` 98, the
//! latter writes no rational surfaces, and both build the whole file in memory by recursion, whose
//! depth the file chooses. What is needed is small: an index of where each instance is, and a
//! reader for the few that make the surface.

mod assembly;
mod carriers;
mod composite;
mod curves;
mod entity;
mod faces;
mod offset;
mod part;
mod pick;
mod placement;
mod surface;
mod syntax;
mod topology;
mod units;
mod write;
mod write_part;

pub use part::{ImportedPart, PlacedSolid, read_part};
pub use pick::{PartLeftOut, PartPick};
pub use write::write;
pub(in crate::exchange) use write_part::written_unit;
pub use write_part::{WritePartError, write_part, write_parts};

use super::spline::SplineError;
use super::{Imported, Pick};
use crate::math::Pose;
use crate::part::OutOfRange;
use crate::surface::{Loaded, SurfaceError};
use syntax::Exchange;

/// Why a STEP file was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// Another kind of file.
    #[error("not a STEP file: it should begin with \"ISO-10303-21;\"")]
    NotStep,
    /// Cut short.
    #[error("line {line}: the file ends inside {inside}; it seems to be cut short")]
    Unfinished {
        /// Where what is unfinished begins.
        line: usize,
        /// What is unfinished.
        inside: &'static str,
    },
    /// Against the grammar.
    #[error("line {line}: expected {wanted}, found {found}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// What may stand there.
        wanted: &'static str,
        /// What does, shortened.
        found: String,
    },
    /// Two instances of one number.
    #[error("#{0} is defined twice")]
    Twice(u64),
    /// A reference to nothing.
    #[error("#{from} refers to #{to}, which the file does not define")]
    Missing {
        /// The instance that refers.
        from: u64,
        /// What it refers to.
        to: u64,
    },
    /// An attribute of another kind.
    #[error("#{id}: {what} should be {wanted}, but is {found}")]
    Attribute {
        /// Number of the instance (`#id`) in the file.
        id: u64,
        /// Entity and attribute.
        what: String,
        /// What should stand there.
        wanted: &'static str,
        /// What does, shortened.
        found: String,
    },
    /// Nothing that we read.
    #[error("no B-spline surface among the file's {instances} instances{}", if .others.is_empty() { String::new() } else {
        format!(" (there are {}: convert them to B-splines where the file comes from)", .others.join(", "))
    })]
    NoSurface {
        /// How many instances there are.
        instances: usize,
        /// Surfaces of other kinds that the file has.
        others: Vec<&'static str>,
    },
    /// No surface of that number.
    #[error("no B-spline surface {pick}; the file has {} of them: {}", ids.len(), some(ids))]
    NoSuch {
        /// What was asked for.
        pick: Pick,
        /// Instance numbers of the surfaces there are.
        ids: Vec<u64>,
    },
    /// Values that make no surface.
    #[error("#{id}: {source}")]
    Spline {
        /// Number of the instance (`#id`) in the file.
        id: u64,
        /// What is wrong.
        source: SplineError,
    },
    /// A place in an assembly where no surface can be.
    #[error("#{id}, where its assembly puts it: {source}")]
    Placed {
        /// Number of the instance (`#id`) in the file.
        id: u64,
        /// What is wrong.
        source: SurfaceError,
    },
    /// An entity that cannot be taken over.
    #[error("#{id}: {entity} is not read: {why}")]
    Unreadable {
        /// Number of the instance (`#id`) in the file.
        id: u64,
        /// Its name.
        entity: String,
        /// Why, or what would help.
        why: &'static str,
    },
    /// A number that cannot be.
    #[error("#{id}: {what} is {value:?}; it should be {wanted}")]
    Value {
        /// Number of the instance (`#id`) in the file.
        id: u64,
        /// Entity and attribute.
        what: String,
        /// As given.
        value: f64,
        /// What may stand there.
        wanted: &'static str,
    },
    /// Edges that do not meet.
    #[error(
        "#{id}: the loop is open by {gap_m:.3e} m behind edge #{edge}, more than {allowed_m:.3e} m: repair the part in the \
         CAD system that wrote the file"
    )]
    OpenLoop {
        /// Number of the loop (`#id`) in the file.
        id: u64,
        /// The edge that ends there.
        edge: u64,
        /// How far the next one starts from its end.
        gap_m: f64,
        /// How far it may.
        allowed_m: f64,
    },
    /// No unit of length.
    #[error("#{id}: its context names no unit of length; set one where the file comes from")]
    NoLengthUnit {
        /// Number of the representation, the context or the solid (`#id`) in the file.
        id: u64,
    },
    /// No part of that name.
    #[error("no part is called \"{name}\"; there {}", match names.as_slice() {
        [] => "are no names".to_owned(),
        names => format!("are: {}", names.join(", ")),
    })]
    NoPart {
        /// What was asked for.
        name: String,
        /// Those that have solids.
        names: Vec<String>,
    },
    /// Not that many places.
    #[error("no place {instance} (from 0); the part has {count} of them")]
    NoInstance {
        /// What was asked for.
        instance: usize,
        /// How many there are.
        count: usize,
    },
    /// No solid or sheet.
    #[error(
        "no solid or sheet with faces among the file's {instances} instances; left out: {left_out}"
    )]
    NoFaces {
        /// How many instances there are.
        instances: usize,
        /// What the file has instead.
        left_out: String,
    },
    /// More than fits.
    #[error("more than {most} {what}: pick one part of the assembly")]
    TooMany {
        /// The limit.
        most: usize,
        /// Of what.
        what: &'static str,
    },
    /// Shared entities that would be read over and over.
    #[error("#{id}: solids share so much that the file would be read more than 16 times")]
    TooOften {
        /// Number of the instance (`#id`) where it was stopped.
        id: u64,
    },
    /// An assembly inside itself.
    #[error("#{id}: the assembly contains itself")]
    Cycle {
        /// Number of a representation (`#id`) in the file.
        id: u64,
    },
    /// An assembly that leads out of the range of lengths.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// A length unit that is not a length.
    #[error("#{id}: the length unit is {metres} m; it should be above 0 and finite")]
    Unit {
        /// Number of the instance (`#id`) in the file.
        id: u64,
        /// Its size.
        metres: f64,
    },
}

/// The first few instance numbers.
fn some(ids: &[u64]) -> String {
    let mut text: Vec<String> = ids.iter().take(8).map(|id| format!("#{id}")).collect();
    if ids.len() > 8 {
        text.push("…".to_owned());
    }
    text.join(", ")
}

/// The instance numbers of all B-spline surfaces of a file, ascending.
///
/// # Errors
/// Not a STEP file, cut short, or without such a surface.
pub fn surfaces(bytes: &[u8]) -> Result<Vec<u64>, StepError> {
    surface::find(&Exchange::index(bytes)?)
}

/// Reads one surface of a file. A closed one is turned outwards; an open one follows the sense of
/// the face that uses it.
///
/// # Errors
/// See [`StepError`]; each says what is wrong and where.
pub fn read(bytes: &[u8], pick: Pick) -> Result<Imported, StepError> {
    let exchange = Exchange::index(bytes)?;
    let ids = surface::find(&exchange)?;
    let Some(id) = pick.among(&ids) else {
        return Err(StepError::NoSuch { pick, ids });
    };
    let unit = units::length_unit(&exchange, id)?;
    let file = surface::read(&exchange, id, &unit)?;
    let built = file
        .build()
        .map_err(|source| StepError::Spline { id, source })?;
    let flip = surface::face_sense(&exchange, id) == Some(false);
    let Loaded { surface, merged } = built;
    let surface = surface.with_flip_normal(flip).oriented_outward();
    let mut left_out = faces::left_out(&exchange, id, &ids, &surface, &unit);
    let places = placement::places(&exchange, id, &unit)?;
    let surface = match places.as_slice() {
        [one] if *one != Pose::identity() => surface
            .placed(one)
            .map_err(|source| StepError::Placed { id, source })?,
        [_] => surface,
        several => {
            left_out.placements = several.len();
            surface
        }
    };
    Ok(Imported {
        surface,
        merged,
        id,
        count: ids.len(),
        unit,
        trim: None,
        left_out,
    })
}

#[cfg(test)]
mod entities_tests;
#[cfg(test)]
mod part_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod write_part_tests;
