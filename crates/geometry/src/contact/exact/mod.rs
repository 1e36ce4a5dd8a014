//! Certified narrow phases: queries of the surface itself, exact to rounding, that miss no region.
//!
//! ```text
//! ball    local minima of the distance of its centre, and the global foot where the centre is inside
//! plane   local maxima of the depth below it
//! ```

pub mod ball;
mod patches;
pub mod plane;
#[cfg(test)]
mod tests;

pub(crate) use self::patches::Patches;
use super::MAX_CONTACTS;
use crate::surface::{ClosestPoint, ClosestSolver, Summit, Surface};

/// Gaps above the margin by less than this share of the size still count: tangency is contact of
/// depth 0.
const TANGENT: f64 = 1e-12;

/// Scratch of the exact narrow phases against one surface, sized once. Nothing in it outlives a
/// query.
#[derive(Clone, Debug)]
pub struct ExactScratch {
    feet: Vec<ClosestPoint>,
    summits: Vec<Summit>,
    patches: Patches,
    /// Box of the first net, diagonal, m.
    size_m: f64,
    /// The surface bounds a volume.
    closed: bool,
}

impl ExactScratch {
    /// Makes room for the contacts and pieces of a surface.
    pub fn new(surface: &Surface, solver: &mut ClosestSolver) -> Self {
        Self {
            feet: Vec::with_capacity(MAX_CONTACTS),
            summits: Vec::with_capacity(MAX_CONTACTS),
            patches: Patches::new(surface, solver),
            size_m: surface.size(),
            closed: surface.topology().is_closed(),
        }
    }
}
