//! Devices and programs that do not speak Palpate's own messages, each a client of the bus.
//!
//! ```text
//! device ─▶ DeviceEnd::reading ─▶ Coupler ─▶ pose  ─▶ bus ─▶ loop
//! device ◀─ DeviceEnd::apply   ◀─ Coupler ◀─ force ◀─ bus ◀─ loop
//! ```
//! What is said is in `palpate-devices`; here are the sockets and threads. [`couple`] is the same for
//! every device: another device is another [`palpate_devices::DeviceEnd`].

mod counts;
mod couple;
pub mod haply;
pub mod haply_service;
pub mod igtl;
pub mod ros2;
pub mod rosbridge;
pub mod simulated;

pub use counts::{AdapterCount, AdapterCounts};
pub use couple::{CoupleError, Coupling, Report, couple};

use std::time::{SystemTime, UNIX_EPOCH};

/// Wall clock, ns since 1970.
pub fn unix_ns() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |time| time.as_nanos() as u64)
}
