//! The parties of contact: tools on their couplings, and bodies, each with its constants, its state and its
//! buffers, and what it does in the stages of a tick.
//!
//! ```text
//! Party        tool       a virtual coupling between a device and the tool's proxy
//!              fixed      a surface that stands still
//!              moved      goes where a script, a device or a command sends it
//!              free       goes where gravity and contact take it
//!              deforming  gives way: see [`crate::body`]
//! contract     what all of them do in the stages of a tick
//! body         the state and the buffers of the last four
//! kinds        the one place that says of which kind a body is
//! ```

mod body;
mod contract;
mod deforming;
mod fixed;
mod flight;
mod free;
mod kinds;
mod moved;
mod on_coupling;
mod pipeline;
mod rigid;
mod tool;

pub use body::{BodyScratch, BodyState};
pub(crate) use contract::{Around, Begun, Party, Problem};
pub(crate) use deforming::view;
pub(crate) use flight::Gives;
pub use flight::{Flight, RigidMotion};
pub(crate) use kinds::BodyParty;
pub(crate) use on_coupling::torque_limit_nm;
pub use pipeline::Pipeline;
pub(crate) use rigid::RigidStep;
pub use rigid::{Course, RigidState, Sent};
pub(crate) use tool::ToolScratch;
pub use tool::ToolState;
