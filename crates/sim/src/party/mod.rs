//! The parties of contact: tools on their couplings, and bodies, each with its state and its buffers.
//!
//! ```text
//! tool     a virtual coupling between a device and the tool's proxy
//! body     a surface, which stands still, or
//! moved      goes where a script, a device or a command sends it
//! free       goes where gravity and contact take it
//!            or deforms: see [`crate::body`]
//! rigid    the tick of bodies that are moved or free
//! ```

mod body;
mod free;
mod moved;
pub(crate) mod rigid;
mod tool;

pub use body::{BodyScratch, BodyState};
pub(crate) use body::{DeformingScratch, box_of};
pub(crate) use free::Gives;
pub use free::{Flight, RigidMotion};
pub use moved::{Course, RigidState, Sent};
pub(crate) use moved::{RigidScratch, RigidStep};
pub(crate) use tool::ToolScratch;
pub use tool::ToolState;
