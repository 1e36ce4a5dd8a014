//! Contacts with a part: with its faces, edges and vertices as the file has them.
//!
//! ```text
//! ball    local minima of the distance of its centre, and the closest point where the centre is inside
//! plane   local minima of the height above it, all corners of what lies on it
//! solid   as a tool against surfaces and other parts: as a mesh that asks the part for distances
//! ```
//! Contacts name places of the part by the two numbers that [`Part::point`] takes. The closest point is always among them,
//! so that no gap between faces, and no edge that is off them, lets a tool through.

pub mod ball;
pub mod plane;
mod solid;
#[cfg(test)]
mod solid_tests;
#[cfg(test)]
mod tests;

pub use solid::PartSolid;

use crate::math::Pose;
use crate::part::{Part, PartMinima, PartSolver};

/// Gaps above the margin by less than this share of the size still count: tangency is contact of depth 0.
const TANGENT: f64 = 1e-12;

/// A part where it stands.
#[derive(Debug)]
pub struct PartSide<'a> {
    /// In its own frame.
    pub part: &'a Part,
    /// From its own frame to the world's.
    pub pose: &'a Pose,
    /// Scratch of the same part.
    pub solver: &'a mut PartSolver,
}

/// Scratch of contact queries with one part, sized once. Nothing in it outlives a query.
#[derive(Clone, Debug)]
pub struct PartScratch {
    minima: PartMinima,
    size_m: f64,
}

impl PartScratch {
    /// Scratch for a part.
    pub fn new(part: &Part) -> Self {
        Self {
            minima: PartMinima::new(part),
            size_m: part.size_m(),
        }
    }
}
