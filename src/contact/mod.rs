//! What a tool touches.
//!
//! ```text
//! broad             pairs whose boxes meet
//! exact, implicit,  contacts of one tool shape with a surface, certified or polished to rounding
//! mesh, pair, own   … of a mesh, of two surfaces, of a surface with itself
//! spheres           the same on sampled points, as fast or as exact as their number
//!      └──────────▶ ContactSet: contacts in order of depth, rectangles in touch, overlap
//! swept             first touch of a tool on its way
//! proxy             a ball held back by the surface as it stands
//! rows              a unilateral row for each contact, and for each surface sample inside the other party
//! complementarity   forces λ ≥ 0 with D λ + gap ≥ 0, by projected Gauss–Seidel
//! friction          the same for forces with three components: Coulomb's cone, grips
//! grip              what a tool holds on to while it grabs
//! sharing, cones    how several rigid contacts of one tool share its force
//! ```
//! Normals point out of the body, towards the tool; a gap is negative where the tool is inside.

pub mod broad;
pub mod complementarity;
pub mod cones;
pub mod delassus;
mod depth;
pub mod exact;
pub mod friction;
pub mod grip;
pub mod implicit;
#[cfg(test)]
mod joint_tests;
pub mod mesh;
pub mod own;
pub mod pair;
pub mod proxy;
pub mod rows;
mod samples;
mod set;
mod shape;
pub mod sharing;
pub mod spheres;
pub mod swept;

pub use samples::{SampleGrid, distance_squared_to_box};
pub use set::{Contact, ContactSet, MAX_CONTACTS, Reach, Rectangle};
pub use shape::{SurfaceShape, ToolShape};
