//! The tick: `step` (pure), its records, and, with the `daemon` feature, ports, pacer and driver
//! thread.
//!
//! ```text
//! poses ─▶ latch ─▶ step = render (force known) ─▶ deform ─▶ TickRecord ─▶ bus, recorder
//! commands ─▶ applied between ticks, recorded with the tick before which they took effect
//! ```

mod admit;
mod balance;
mod between;
mod by_tool;
mod cover;
mod emit;
mod face;
mod feet;
mod gather;
mod grip;
mod iterate;
mod load;
mod manifold;
mod motion;
mod near;
pub mod record;
mod step;
mod stick;

pub use step::{apply, deform, render, restore, step, step_into};
