//! The tick: `step` (pure), its [stages](stage) and its records.
//!
//! ```text
//! poses ─▶ latch ─▶ step = render (force known) ─▶ deform ─▶ hash ─▶ TickRecord ─▶ bus, recorder
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
pub mod stage;
mod step;
mod stick;

pub use step::{apply, deform, hash, render, restore, step, step_into};
