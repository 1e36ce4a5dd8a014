//! Contact queries: what a tool or a body touches, and how deep.
//!
//! ```text
//! broad             pairs whose boxes meet
//! exact, implicit,  contacts of one tool shape with a surface, certified or polished to rounding
//! part              … with a part: faces, edges and vertices
//! mesh, pair, own   … of a mesh, of two surfaces, of a surface with itself
//! features          … of corners and edges of a tool, where it has no normal
//! other             … by a method that a caller brings
//!      └──────────▶ ContactSet: contacts in order of depth, rectangles in touch, overlap
//! dispatch          which of these answers for a pair
//! swept             first touch of a tool on its way
//! ```
//! Normals point out of the body, towards the tool; a gap is negative where the tool is inside.

mod balls;
pub mod broad;
mod depth;
pub mod dispatch;
pub mod exact;
mod features;
pub mod implicit;
#[cfg(test)]
mod joint_tests;
pub mod mesh;
mod other;
pub mod own;
pub mod pair;
pub mod part;
mod placed;
mod samples;
mod set;
mod shape;
pub mod swept;

pub use dispatch::Facing;
pub use features::{Curve, Edge, Features};
pub use other::{ContactQuery, OtherMethod};
pub use samples::{ContactSamples, Weights, distance_squared_to_box};
pub use set::{Contact, ContactSet, MAX_CONTACTS, Reach, Rectangle, ToolPoint};
pub use shape::{SurfaceShape, ToolShape};
