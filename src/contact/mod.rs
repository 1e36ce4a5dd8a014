//! What a tool touches.
//!
//! ```text
//! proxy::constrain   the tool's proxy moves towards where coupling wants it, held back by the surface as it stands
//! rows::gather       one unilateral row for the foot, one for each surface sample inside the tool
//! complementarity    forces λ ≥ 0 with D λ + gap ≥ 0, by projected Gauss–Seidel
//! ```
//! Normals point out of the body, towards the tool; a gap is negative where the tool is inside.

pub mod broad;
pub mod complementarity;
mod depth;
pub mod exact;
pub mod implicit;
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
