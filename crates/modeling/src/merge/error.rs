//! Why patches were not merged.

use palpate_geometry::basis::KnotError;
use palpate_geometry::math::MOST_COORDINATE_M;
use palpate_geometry::surface::SurfaceError;

/// Why patches were not merged. Nothing was changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MergeError {
    /// Fewer than two.
    #[error("{given} patches; merging needs two or more")]
    TooFew {
        /// Patches given.
        given: usize,
    },
    /// Patches and grid disagree.
    #[error(
        "{given} patches do not fill {rows} rows of {columns}: give one for each place, or say how they are arranged"
    )]
    Arrangement {
        /// Patches given.
        given: usize,
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
    /// More than two patches and no grid.
    #[error(
        "{given} patches: say how many rows and columns they make; edges are found for two only"
    )]
    NoGrid {
        /// Patches given.
        given: usize,
    },
    /// Weights that differ.
    #[error("patch {patch} is rational; merging requires surfaces without weights: refit it first")]
    Rational {
        /// Which patch, from 0.
        patch: usize,
    },
    /// A net with a coordinate that is not finite, or of no earthly size.
    #[error(
        "control point {index} of patch {patch} is not finite, or beyond ±{MOST_COORDINATE_M:e} m"
    )]
    NotFinite {
        /// Which patch.
        patch: usize,
        /// Which control point, u-major.
        index: usize,
    },
    /// Knot spans of very different lengths.
    #[error(
        "the knots of patch {patch} in {direction} cannot be scaled to [0, 1]: {source}; remove or move the knots of its shortest span"
    )]
    Spans {
        /// Which patch.
        patch: usize,
        /// `u` or `v` of the patch.
        direction: char,
        /// What is wrong with the scaled knots.
        source: KnotError,
    },
    /// The continuity is not below the degree.
    #[error("C{continuity} needs a degree above {continuity}, the merged degree is {degree} in {direction}: raise it first, or ask for C{}", degree - 1)]
    Continuity {
        /// Asked for.
        continuity: usize,
        /// Degree across the seam.
        degree: usize,
        /// `u` or `v` of the merged surface.
        direction: char,
    },
    /// An edge that is a point, or that the patch does not have because it is periodic there.
    #[error(
        "patch {patch} has no edge to join there: the side is closed, or has collapsed to a point"
    )]
    NoEdge {
        /// Which patch.
        patch: usize,
    },
    /// Edges too far from each other.
    #[error(
        "the edges of patches {a} and {b} are {gap_m} m apart, farther than the shorter is long ({length_m} m): move the patches nearer, or name other edges"
    )]
    TooFar {
        /// A patch.
        a: usize,
        /// The other.
        b: usize,
        /// Mean distance, m.
        gap_m: f64,
        /// The shorter edge, m.
        length_m: f64,
    },
    /// An edge that meets a part of another only.
    #[error(
        "patches {a} and {b} make a T-junction: their edges ({a_m} m, {b_m} m long) end {offset_m} m from each other; split the longer one there"
    )]
    TJunction {
        /// A patch.
        a: usize,
        /// The other.
        b: usize,
        /// Length of the edge of the one, m.
        a_m: f64,
        /// Length of the edge of the other, m.
        b_m: f64,
        /// Larger distance between corners that should meet, along the edge, m.
        offset_m: f64,
    },
    /// A hidden range of more than two patches, of the wrong direction, not finite or not at an
    /// end.
    #[error("hidden range {start}..{end} of patch {patch}: {reason}")]
    Hidden {
        /// Which patch.
        patch: usize,
        /// Start of the range.
        start: f64,
        /// End of the range.
        end: f64,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A curve, of a trim or a crossing, on which lines across the seam cannot end; or a trim that leaves no outer edge.
    #[error(
        "patch {patch} does not end on a graph over its seam: the curve of its trim, or in which it crosses the other patch, \
         {what} at u = {u}, v = {v}; each line across the seam must have one end on it"
    )]
    NoGraph {
        /// Which patch, from 0.
        patch: usize,
        /// What is wrong with the curve.
        what: &'static str,
        /// Where, in the parameters of the patch: u.
        u: f64,
        /// And v.
        v: f64,
    },
    /// Trims where none can be.
    #[error("{given} patches with trims: {reason}")]
    Trims {
        /// Patches given.
        given: usize,
        /// Why not.
        reason: &'static str,
    },
    /// Fewer rows of points than control points.
    #[error(
        "patch {patch} shows {rows} rows of points, too few for its {needed} control points: exclude less, or use more points"
    )]
    TooFewRows {
        /// Which patch.
        patch: usize,
        /// Rows that are left.
        rows: usize,
        /// Control points they should give.
        needed: usize,
    },
    /// Number of points out of range.
    #[error("{given} points in each direction of a patch; from {least} to {most} are possible")]
    Points {
        /// Asked for.
        given: usize,
        /// Smallest possible number.
        least: usize,
        /// Largest possible number.
        most: usize,
    },
    /// A number of the request that makes no sense.
    #[error("{name} is {value}; {wanted}")]
    Value {
        /// Name of the quantity.
        name: &'static str,
        /// What it is.
        value: f64,
        /// What it should be.
        wanted: &'static str,
    },
    /// Exact merging of patches that do not meet, or with something hidden.
    #[error(
        "an exact merge needs whole patches that meet, and the edges of {a} and {b} are up to {gap_m} m apart: use the constrained method"
    )]
    Apart {
        /// A patch.
        a: usize,
        /// The other.
        b: usize,
        /// Largest distance between points that should meet, m.
        gap_m: f64,
    },
    /// A request that the exact method does not take.
    #[error("the exact method does not support {what}: use the constrained method")]
    NotExact {
        /// What it does not take.
        what: &'static str,
    },
    /// A plan used for other patches than it was made for.
    #[error(
        "patch {patch} has a net of another size than when the merge was planned: plan it again"
    )]
    OtherNet {
        /// Which patch.
        patch: usize,
    },
    /// Knots that came out wrong.
    #[error("knots: {0}")]
    Knots(#[from] KnotError),
    /// A surface operation that failed.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}
