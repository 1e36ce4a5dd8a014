//! Devices and programs that do not speak our messages: each against a daemon as a process.

mod foxglove;
mod guard;
mod haply;
mod igtl;
pub mod peer;
mod peers;
pub mod ros2;
mod rosbridge;
