//! A simulated haptic device: a mass held by a hand that follows a motion script, and pushed by the rendered force.
//!
//! ```text
//! Motion (script) ─▶ Hand: spring and damper ─▶ SimulatedDevice: mass, damping ◀─ rendered force, held between answers
//!                                                      └─▶ pose
//! ```
//! Stepping knows neither clock nor bus; [`run`] joins it to a [`crate::Tool`].

mod motion;
pub mod run;
mod simulated;

pub use motion::{Motion, MotionError, MotionFile, Target, Waypoint};
pub use simulated::{DeviceParameters, SimulatedDevice};
