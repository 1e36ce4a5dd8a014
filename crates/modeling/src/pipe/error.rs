//! Why a spine was refused.

use palpate_geometry::basis::KnotError;

/// What is wrong with a spine, where, and how to fix it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PipeError {
    /// No extent, or one that overflows.
    #[error(
        "the control points span {size_m} m; a spine needs a length between 1e-140 and 1e140 m"
    )]
    Size {
        /// Largest side of the box around the control points, m.
        size_m: f64,
    },
    /// Coordinates whose rounding is as large as the spine.
    #[error(
        "the spine is {size_m} m large and {distance_m} m from the origin, which loses too many digits; move it closer"
    )]
    FarAway {
        /// Largest side of the box around the control points, m.
        size_m: f64,
        /// Distance of its middle from the origin, m.
        distance_m: f64,
    },
    /// More pieces than pairs can be searched.
    #[error(
        "{pieces} spans, at most {} are searched; cut the spine",
        super::MOST_PIECES
    )]
    TooManyPieces {
        /// Spans of the curve.
        pieces: usize,
    },
    /// A gap.
    #[error(
        "the spine jumps by {gap_m} m at parameter {parameter}; a pipe needs a connected spine"
    )]
    Disjoined {
        /// Parameter on the spine.
        parameter: f64,
        /// How far, m.
        gap_m: f64,
    },
    /// A point without a tangent.
    #[error(
        "the derivative vanishes at parameter {parameter}: no tangent there; move apart the control points that meet"
    )]
    NotRegular {
        /// Parameter on the spine.
        parameter: f64,
    },
    /// Weights of which some span lost all digits.
    #[error(
        "the span from parameter {parameter} has a Bézier weight of {weight}; bring the weights closer together"
    )]
    Weights {
        /// Start of the span.
        parameter: f64,
        /// The weight.
        weight: f64,
    },
    /// Knots whose spans cannot be cut out.
    #[error("knots: {0}")]
    Knots(KnotError),
}
