//! Devices and programs that do not speak our messages: each against a daemon as a process.

mod guard;
mod haply;
mod peer;
mod peers;
mod ros2;
