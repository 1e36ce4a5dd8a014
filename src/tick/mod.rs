//! The tick: `step` (pure), its records, and, with the `daemon` feature, ports, pacer and driver
//! thread.
//!
//! ```text
//! poses ─▶ latch ─▶ step = render (force known) ─▶ deform ─▶ TickRecord ─▶ bus, recorder
//! commands ─▶ applied between ticks, recorded with the tick before which they took effect
//! ```

mod admit;
#[cfg(feature = "daemon")]
pub mod archive;
mod balance;
mod between;
mod cover;
#[cfg(feature = "daemon")]
pub mod driver;
#[cfg(feature = "daemon")]
pub mod editor;
mod emit;
mod face;
mod feet;
mod gather;
mod grip;
#[cfg(feature = "daemon")]
mod inbox;
mod iterate;
pub mod journal;
mod load;
mod manifold;
mod motion;
mod near;
pub mod overload;
#[cfg(feature = "daemon")]
pub mod pacer;
#[cfg(feature = "daemon")]
pub mod playback;
#[cfg(feature = "daemon")]
pub mod ports;
pub mod record;
pub mod stats;
mod step;
mod stick;
#[cfg(feature = "daemon")]
pub mod swap;
#[cfg(feature = "daemon")]
pub mod workers;

pub use step::{apply, deform, render, restore, step};
