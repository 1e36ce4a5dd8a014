//! Merging: two or more patches become one B-spline surface of a chosen continuity.
//!
//! ```text
//! ground     patches and request ──▶ checked and laid
//!   rim        the curves on which a patch ends: rows before them, lines to them
//!   layout     edges that meet, turns that make them meet, refusal of what cannot be joined
//!   overlap    where two patches cross
//!   sheet      a laid patch, its lines drawn so that they end on a curve
//! build      the ground ──▶ everything below, in this order
//!   axis       the patches seen along one direction, as bundles of lines
//!   knots      knots end to end, the seam, and the knots that continuity frees
//!   search     shares of the domain and places of the knots that miss least, on a few lines
//!   fit        least squares with held ends, banded
//!   plan       all that does not depend on nets, as a pair of small matrices for each patch ──▶ the merged net
//! tolerance  the same with more and more knots
//! exact      no fit: elevation and knot insertion
//! reading    rows and lines, measured alike; the better one is taken
//! report     what the merged surface misses, and its continuity as measured
//! cases      seven cases to compare methods by
//! ```
//! C^c is exact by construction: of all functions over knots with the seam k times (k = degree),
//! those that are C^c there are the ones over knots with the seam k − c times. The linear
//! constraints and their elimination are the basis itself. Source: refitting of discretised points
//! with blending matrices (chapter 4 of the design's source thesis).

mod axis;
mod build;
pub mod cases;
mod error;
mod exact;
mod fit;
mod ground;
mod knots;
mod layout;
mod overlap;
mod plan;
mod reading;
mod report;
mod rim;
mod search;
mod sheet;
mod spec;
#[cfg(test)]
mod tests;
mod tolerance;
mod turn;

pub use error::MergeError;
pub use layout::{Layout, Placed};
pub use plan::{BlockRows, MergePlan};
pub use reading::{Reading, Seen};
pub use report::{CLOSE_M, Continuity, Deviation, Report};
pub use spec::{Arrangement, DegreeRule, Edge, Hidden, HideBy, MergeMethod, MergeSpec};
pub use turn::Turn;

use palpate_geometry::surface::{Direction, Surface};

/// A line of the merged surface along which patches meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seam {
    /// The parameter that is constant.
    pub direction: Direction,
    /// Its value.
    pub at: f64,
}

/// Patches that became one.
#[derive(Clone, Debug)]
pub struct Merged {
    /// The one; its sides are those of the first patch.
    pub surface: Surface,
    /// Which patch lies where.
    pub layout: Layout,
    /// Where points of the patches lie on the merged surface: of the blocks in u, and in v.
    pub rows: [Vec<BlockRows>; 2],
    /// Where patches meet.
    pub seams: Vec<Seam>,
    /// To merge the same patches again when their nets have moved; none of an exact merge.
    pub plan: Option<MergePlan>,
    /// Whether the tolerance was reached, when there was one.
    pub within_tolerance: Option<bool>,
    /// The ways that were tried where patches end on curves; else none.
    pub readings: Vec<Reading>,
    /// The one of them that was taken.
    pub hide_by: Option<HideBy>,
}

/// Merges patches. Pure: surfaces in, a surface out.
///
/// # Errors
/// Patches that cannot be joined, or a request that makes no sense: [`MergeError`] says which and
/// what would help.
///
/// # Examples
/// ```
/// use palpate_geometry::surface::builtin;
/// use palpate_modeling::merge::{MergeMethod, MergeSpec, merge};
/// let left = builtin("sheet", None, None)?;
/// let mut right = left.clone();
/// let x: Vec<f64> = left.net().points().iter().map(|point| point.x).collect();
/// let width_m = x.iter().copied().fold(f64::MIN, f64::max) - x.iter().copied().fold(f64::MAX, f64::min);
/// right.net_mut().points_mut().iter_mut().for_each(|point| point.x += width_m);
/// let spec = MergeSpec {
///     method: MergeMethod::Constrained,
///     tolerance_m: Some(1e-9),
///     ..MergeSpec::default()
/// };
/// let merged = merge(&[left, right], &spec)?;
/// assert_eq!(merged.within_tolerance, Some(true));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn merge(surfaces: &[Surface], spec: &MergeSpec) -> Result<Merged, MergeError> {
    if spec.method == MergeMethod::Exact {
        return exact::merge(surfaces, spec);
    }
    let ground = ground::Ground::new(surfaces, spec)?;
    let by = |by| {
        let job = build::Job::new(surfaces, &ground, spec, by)?;
        match spec.tolerance_m {
            Some(tolerance_m) if spec.method == MergeMethod::Constrained => {
                tolerance::merge(job, tolerance_m)
            }
            _ => job.merged(),
        }
    };
    match ground.rims {
        [None, None] => by(HideBy::Rows),
        _ => reading::taken(surfaces, &ground, spec, by),
    }
}
