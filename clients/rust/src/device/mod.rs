//! A simulated haptic device: hardware as a daemon sees it.
//!
//! ```text
//! Motion ─▶ Hand ─▶ SimulatedDevice ─▶ encoder ─▶ Channel ─▶ daemon
//!                        ▲                                      │
//!                        └── Passivity (if wanted) ◀── Channel ◀┘
//! ```
//! [`DeviceModel`] has the figures of common devices (`docs/devices.md` their sources), [`Hand`]
//! those of a hand. Stepping knows neither clock nor bus; [`run`] joins it to a [`crate::Tool`].

mod carriage;
mod encoder;
mod hand;
mod model;
mod motion;
mod motion_error;
mod network;
mod oscillator;
mod passivity;
mod path;
mod presets;
mod random;
mod rotation;
pub mod run;
pub mod servo;
mod session;
mod simulated;
mod smooth;
mod target;
mod v3;

pub use hand::{Goal, Grip, Hand};
pub use model::{DeviceError, DeviceModel};
pub use motion::{Kind, Motion};
pub use motion_error::MotionError;
pub use network::{Channel, Network};
pub use passivity::{Passivity, PassivitySettings};
pub use path::{Interpolation, Path, Waypoint};
pub use presets::devices;
pub use session::{BLEND_S, Session, Step};
pub use simulated::{Energy, SimulatedDevice};
pub use target::Target;
