//! Devices and programs that do not speak our messages: each against a daemon as a process.

mod peer;
mod ros2;
