//! Why an IGES file was refused.

use crate::exchange::Pick;
use crate::exchange::spline::SplineError;

/// Why an IGES file was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IgesError {
    /// Another kind of file, or one of the other forms of IGES.
    #[error("not an IGES file of fixed 80-column lines: {0}")]
    NotIges(&'static str),
    /// No terminate section, or sections shorter than it says.
    #[error("the file is cut short: {0}")]
    Unfinished(&'static str),
    /// A line out of its place.
    #[error("line {line}: expected {wanted}, found {found}")]
    Line {
        /// Line, from 1.
        line: usize,
        /// What may stand there.
        wanted: &'static str,
        /// What does, shortened.
        found: String,
    },
    /// A parameter of the global section.
    #[error("global parameter {index} ({what}) is {found}")]
    Global {
        /// From 1.
        index: usize,
        /// Its meaning.
        what: &'static str,
        /// What stands there.
        found: String,
    },
    /// A parameter of an entity.
    #[error(
        "entity {kind} at directory entry {id}: parameter {index} ({what}) should be {wanted}, but is {found}"
    )]
    Parameter {
        /// 128, 124 or 408.
        kind: u32,
        /// First line of its directory entry, as the D column numbers it.
        id: u64,
        /// From 1, after the entity's number.
        index: usize,
        /// Its meaning.
        what: &'static str,
        /// What should stand there.
        wanted: &'static str,
        /// What does, shortened.
        found: String,
    },
    /// Parameters that are not there.
    #[error("entity {kind} at directory entry {id} has {given} parameters; it needs {needed}")]
    Few {
        /// 128, 124 or 408.
        kind: u32,
        /// Directory entry.
        id: u64,
        /// Given number.
        given: usize,
        /// Needed number.
        needed: u64,
    },
    /// Parameter lines that are not there.
    #[error(
        "directory entry {id} has its parameters at P {first} to {last}, but the file has {lines} such lines"
    )]
    Pointer {
        /// Directory entry.
        id: u64,
        /// First line.
        first: u64,
        /// Last line.
        last: u64,
        /// Lines of the section.
        lines: usize,
    },
    /// A directory entry that is not there, or not what it should be.
    #[error(
        "directory entry {from} refers to {to} as its transformation matrix, which is not an entity 124"
    )]
    Matrix {
        /// The entry that refers.
        from: u64,
        /// What it refers to.
        to: u64,
    },
    /// Matrices that refer to each other.
    #[error("the transformation matrices of directory entry {0} refer to each other without end")]
    Circle(u64),
    /// Nothing that we read.
    #[error(
        "no B-spline surface (entity 128) among the file's {0} entities; convert its surfaces to B-splines"
    )]
    NoSurface(usize),
    /// No surface of that number.
    #[error("no B-spline surface {pick}; the file has {} of them", ids.len())]
    NoSuch {
        /// What was asked for.
        pick: Pick,
        /// Directory entries of the surfaces there are.
        ids: Vec<u64>,
    },
    /// A surface of which the file means a part.
    #[error("entity 128 at directory entry {id} is cut to {direction} = {start} ..= {end}, its knots go from {} to {}", domain.0, domain.1)]
    Cut {
        /// Directory entry.
        id: u64,
        /// `u` or `v`.
        direction: char,
        /// First parameter.
        start: f64,
        /// Last parameter.
        end: f64,
        /// What the knots have.
        domain: (f64, f64),
    },
    /// Values that make no surface.
    #[error("entity 128 at directory entry {id}: {source}")]
    Spline {
        /// Directory entry.
        id: u64,
        /// What is wrong.
        source: SplineError,
    },
}
