//! Parts: what CAD systems write, faces that are trimmed pieces of planes, cylinders, cones, spheres, tori and B-splines.
//!
//! ```text
//! Brep (as in the file) ──▶ Part: edges with their gaps, loops in (u, v), tree ──▶ closest point, sign, area, volume, triangles
//! ```

mod basins;
pub(crate) mod bezier;
mod brep;
mod build;
mod carrier;
mod chart;
mod closest;
mod curve;
mod fan;
pub(crate) mod flat;
mod foot;
mod ground;
mod measure;
mod minima;
mod near;
mod orient;
#[expect(clippy::module_inception)]
mod part;
mod patch;
pub(crate) mod pcurve;
mod place;
mod rectangle;
mod senses;
mod sharp;
mod tree;
mod triangles;
mod trim;
mod warm;

pub use brep::{Brep, BrepBound, BrepCurve, BrepEdge, BrepFace, BrepShell, OutOfRange, Placing};
pub(crate) use carrier::is_unit;
pub use carrier::{Axes, Carrier};
pub use closest::PartSolver;
pub use curve::CurveProblem;
pub(crate) use curve::{chain_between, chain_of};
pub use flat::FlatProblem;
pub use foot::{PartFoot, Support};
pub(crate) use ground::{CornerGround, EdgeGround, FaceGround, Wire};
pub use measure::{PartMeasure, PartMoments};
pub(crate) use minima::{Mark, PartMinima};
pub use part::{FaceInfo, Part, PartError};
pub use senses::{SenseProblem, Senses};
pub(crate) use sharp::SharpEdge;
pub use triangles::{Fineness, PartMesh, TrianglesError};
pub use trim::TrimProblem;

#[cfg(test)]
pub(crate) mod hand;
#[cfg(test)]
mod tests;
