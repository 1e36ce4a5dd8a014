//! What haptic devices and other people's programs speak, as data. No sockets, no clock: the server
//! (`palpate_adapters`) connects these to a bus.
//!
//! ```text
//! bytes ─▶ ros2 | rosbridge | haply ─▶ Reading ─▶ Coupler ─▶ pose of a tool
//! bytes ◀─ ros2 | rosbridge | haply ◀─ Command ◀─ Coupler ◀─ force of a tool
//! ```
//! [`Coupler`] is the same for all of them: frames, scale, clutch, velocity, and the rules that make a
//! force zero. A device is an implementation of [`DeviceEnd`].

pub mod cdr;
mod coupler;
mod frame;
mod guard;
pub mod haply;
pub mod igtl;
mod link;
pub mod ros2;
pub mod rosbridge;
mod velocity;

pub use coupler::{Coupler, CouplerSettings, ToolMotion};
pub use frame::{Frame, FrameError};
pub use guard::Cap;
pub use link::{Command, DeviceEnd, Reading, Rest, State, ToolAnswer};
pub use velocity::Differentiator;
