//! From device pose to rendered force: what a device says, whether it may be believed, the virtual coupling, the limiter.

mod coupling;
mod device;
mod limiter;
mod link;

pub use coupling::Coupling;
pub use device::DevicePose;
pub use limiter::{RenderedForce, limit};
pub use link::{Admission, Link, LinkLimits, LinkPhase};
