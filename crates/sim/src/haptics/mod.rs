//! From device pose to rendered force: what a device says, whether it may be believed, the virtual
//! coupling and how stiff it may be, the energy at the port, the limiter.

mod bounds;
mod coupling;
mod device;
mod limiter;
mod link;
mod passivity;

pub use bounds::{DeviceBounds, DeviceFigures, StiffnessLimits};
pub use coupling::Coupling;
pub use device::DevicePose;
pub use limiter::{RenderedForce, limit};
pub use link::{Admission, Link, LinkLimits, LinkPhase};
pub use passivity::{Motion, Port, Wrench};
