//! Why a piece has no surface of its own.

use super::fit::{LEAST_COUNTS, MOST_POINTS};
use crate::cut::CutMeshError;
use crate::math::MOST_COORDINATE_M;
use crate::surface::SurfaceError;

/// Why a piece has no such surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PieceSkinError {
    /// A number that is not of a piece.
    #[error("there is no piece {piece}: the cut has {count}, counted from 0")]
    Piece {
        /// As asked for.
        piece: usize,
        /// As there are.
        count: usize,
    },
    /// A sheet has no inside.
    #[error("a piece of an open sheet bounds no body: close the surface before the cut")]
    Sheet,
    /// A body has caps.
    #[error("the pieces of this cut have caps: cut the surface as a sheet")]
    Solid,
    /// A sheet with more than two rims.
    #[error(
        "the piece is a sheet with {rims} rims: one net covers a sheet with one, or with two as a tube has; cut it across \
         first"
    )]
    Rims {
        /// How many.
        rims: usize,
    },
    /// It does not spread over a net.
    #[error(
        "the surface of the piece would have {:.1} % more or less area than it, as where it folds: move the plane, or refine \
         the net of what is cut", 100.0 * more
    )]
    Folded {
        /// By how much more, of the area.
        more: f64,
    },
    /// Control points nowhere, or too many of them.
    #[error(
        "control points {spacing_m:e} m apart are not possible: it must be above 0, and {MOST_POINTS} points at most cover the \
         piece"
    )]
    Spacing {
        /// As asked for, m.
        spacing_m: f64,
    },
    /// Too small or too large a net.
    #[error(
        "a net of {} × {} is not possible: it takes {} × {} control points at least, {MOST_POINTS} at most altogether",
        counts[0], counts[1], LEAST_COUNTS[0], LEAST_COUNTS[1]
    )]
    Counts {
        /// As asked for.
        counts: [usize; 2],
    },
    /// The surface at rest is another one.
    #[error(
        "the surface at rest does not have the knots and the net of the surface that was cut: give the same one, moved"
    )]
    Rest,
    /// A hole goes through the piece.
    #[error(
        "the piece has {handles} holes through it, as a ring that is not cut across: no net of rows and columns goes around \
         them; cut the ring across first"
    )]
    Handles {
        /// How many.
        handles: usize,
    },
    /// Rims or faces that touch in a point.
    #[error(
        "parts of the piece's boundary touch in single points: move or tilt the plane by a thousandth of the size"
    )]
    Pinched,
    /// More triangles than allowed.
    #[error(
        "the piece's boundary takes more than {most} triangles: it is too thin or too rough; move or tilt the plane"
    )]
    TooFine {
        /// As allowed.
        most: usize,
    },
    /// Matter goes nowhere.
    #[error(
        "a place of the piece is at ({x} m, {y} m, {z} m) at rest, not finite within ±{MOST_COORDINATE_M:e} m: `matter` must \
         give a place for every point of the caps"
    )]
    NotFinite {
        /// m.
        x: f64,
        /// m.
        y: f64,
        /// m.
        z: f64,
    },
    /// Triangles of skin and caps.
    #[error("the piece is not divided into triangles: {0}")]
    Triangles(#[from] CutMeshError),
    /// A surface that cannot be.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}
