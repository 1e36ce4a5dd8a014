//! The tick: `step` (pure), its [stages](stage) and its records.
//!
//! ```text
//! poses ─▶ latch ─▶ step = render (force known) ─▶ deform ─▶ hash ─▶ TickRecord ─▶ bus, recorder
//! commands ─▶ applied between ticks, recorded with the tick before which they took effect
//! ```

mod admit;
mod arrive;
mod audit;
pub(crate) mod balance;
mod by_tool;
mod carry_over;
mod executor;
pub mod flags;
mod frame;
mod invariants;
mod iterate;
mod late;
pub(crate) mod load;
mod motion;
pub mod quality;
pub mod quantity;
pub mod record;
mod scratch;
pub mod stage;
mod state;
mod step;

pub use crate::contact::{PairState, Warm, WarmRow};
pub use crate::party::{
    BodyScratch, BodyState, Course, Flight, Pipeline, RigidMotion, RigidState, Sent, ToolState,
};
pub use crate::report::explain;
pub use carry_over::CarryOver;
pub use executor::{Executor, MOST_LOTS};
pub use frame::FrameState;
pub use late::late_step;
pub use scratch::Scratch;
pub use state::{RunState, SceneState};
pub(crate) use step::depths_at_start;
pub use step::{apply, deform, hash, render, restore, step, step_explained, step_into};
