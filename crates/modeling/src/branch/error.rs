//! Why a tree or a net was refused.

use palpate_geometry::basis::KnotError;
use palpate_geometry::surface::SurfaceError;
use std::fmt;

/// The rules that make a branching net exactly G1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub enum Rule {
    /// Joints in u: the control points before, on and after a joint are collinear at one ratio, or
    /// in the joint's plane.
    R1,
    /// Arch: the open book is the inverted T moved along one direction.
    R2,
    /// Outline: open book, inverted T and the layers below are collinear at one ratio.
    R3,
    /// No fold: the control points beside a joint are not closer than the rows.
    R4,
    /// Disjoined in v: the knot of a fork has multiplicity q + 1.
    R5,
}

impl Rule {
    /// What it asks, in a line.
    pub fn asks(self) -> &'static str {
        match self {
            Self::R1 => {
                "joints in u: neighbours on one line at one ratio, or in the plane of the joint"
            }
            Self::R2 => "arch: the open book is the inverted T moved along one direction",
            Self::R3 => "outline: open book, inverted T and layers on straight lines at one ratio",
            Self::R4 => "no fold: neighbours of a joint no closer than the rows",
            Self::R5 => "disjoined in v: multiplicity q + 1 at a fork",
        }
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self:?}")
    }
}

/// Why a tree was rejected, or why a surface is not a branching net.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BranchError {
    /// A tree that would not be smooth.
    #[error("rule {rule} ({}) is broken at {place}: {what}; {mend}", rule.asks())]
    Rule {
        /// Which rule.
        rule: Rule,
        /// Node of the tree, or leaf, joint and row of a net.
        place: String,
        /// With the numbers.
        what: String,
        /// What to change.
        mend: String,
    },
    /// A number outside its range.
    #[error("{place}: {field} is {value}; it must be {allowed}")]
    Value {
        /// Node of the tree.
        place: String,
        /// As in the tree's file.
        field: &'static str,
        /// As given.
        value: f64,
        /// Its range.
        allowed: &'static str,
    },
    /// More than anyone wants.
    #[error("the tree has {what} = {value}; at most {most} are supported")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How much.
        value: usize,
        /// The limit.
        most: usize,
    },
    /// A surface whose knots or net do not have the shape of a branching net.
    #[error("not a branching net: {what}; {mend}")]
    NotBranched {
        /// What is missing, and where.
        what: String,
        /// What to change.
        mend: &'static str,
    },
    /// The knots are invalid.
    #[error(transparent)]
    Knots(#[from] KnotError),
    /// The net: coordinates that are not finite.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}
