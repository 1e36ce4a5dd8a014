//! From device pose to rendered force: device state, proxy, virtual coupling, limiter.

mod device;

pub use device::DevicePose;
