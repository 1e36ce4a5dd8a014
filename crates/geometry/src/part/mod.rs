//! Parts: what CAD systems write, faces that are trimmed pieces of planes, cylinders, cones, spheres, tori and B-splines.
//!
//! ```text
//! Brep (as in the file) ──▶ Part: edges with their gaps, loops in (u, v), tree ──▶ closest point, sign, area, volume, triangles
//! ```

mod brep;
mod carrier;

pub use brep::{Brep, BrepBound, BrepCurve, BrepEdge, BrepFace, BrepShell, OutOfRange, Placing};
pub use carrier::{Axes, Carrier};
