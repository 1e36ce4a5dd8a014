//! Merging: two or more patches become one B-spline surface of a chosen continuity.
//!
//! ```text
//! build      patches and request ──▶ everything below, in this order
//!   layout     edges that meet, turns that make them meet, refusal of what cannot be joined
//!   overlap    where two patches cross, and so which rows of points are left out
//!   axis       the patches seen along one direction, as bundles of lines
//!   knots      knots end to end, the seam, and the knots that continuity frees
//!   search     shares of the domain and places of the knots that miss least, on a few lines
//!   fit        least squares with held ends, banded
//!   plan       all that does not depend on nets, as a pair of small matrices for each patch ──▶ the merged net
//! tolerance  the same with more and more knots
//! exact      no fit: elevation and knot insertion
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
mod knots;
mod layout;
mod overlap;
mod plan;
mod report;
mod search;
mod spec;
#[cfg(test)]
mod tests;
mod tolerance;
mod turn;

pub use error::MergeError;
pub use layout::{Layout, Placed};
pub use plan::{BlockRows, MergePlan};
pub use report::{CLOSE_M, Continuity, Deviation, Report};
pub use spec::{Arrangement, DegreeRule, Edge, Hidden, MergeMethod, MergeSpec};
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
/// use palpate_modeling::merge::{MergeSpec, merge};
/// let left = builtin("sheet", None, None)?;
/// let mut right = left.clone();
/// let x: Vec<f64> = left.net().points().iter().map(|point| point.x).collect();
/// let width_m = x.iter().copied().fold(f64::MIN, f64::max) - x.iter().copied().fold(f64::MAX, f64::min);
/// right.net_mut().points_mut().iter_mut().for_each(|point| point.x += width_m);
/// let merged = merge(&[left, right], &MergeSpec::default())?;
/// assert!(merged.within_tolerance);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn merge(surfaces: &[Surface], spec: &MergeSpec) -> Result<Merged, MergeError> {
    match spec.method {
        MergeMethod::Exact => exact::merge(surfaces, spec),
        MergeMethod::Seed | MergeMethod::Constrained => {
            let job = build::Job::new(surfaces, spec)?;
            match spec.tolerance_m {
                Some(tolerance_m) if spec.method == MergeMethod::Constrained => {
                    tolerance::merge(surfaces, job, tolerance_m)
                }
                _ => job.merged(),
            }
        }
    }
}
