//! The tick: `step` (pure), its [stages](stage) and its records.
//!
//! ```text
//! poses ─▶ latch ─▶ step = render (force known) ─▶ deform ─▶ hash ─▶ TickRecord ─▶ bus, recorder
//! commands ─▶ applied between ticks, recorded with the tick before which they took effect
//! ```

mod admit;
mod audit;
mod balance;
mod between;
mod bounce;
mod by_tool;
mod carry_over;
mod degraded;
mod dent;
mod emit;
pub mod explain;
mod feet;
pub mod flags;
mod follow;
mod frame;
mod gather;
mod grip;
mod iterate;
mod late;
mod load;
mod lying;
mod manifold;
mod meeting;
mod motion;
mod near;
pub mod quality;
pub mod record;
mod rest;
mod resting;
mod scratch;
pub mod stage;
mod state;
mod step;
mod stick;
mod warm;

pub use crate::party::{
    BodyScratch, BodyState, Course, Flight, Pipeline, RigidMotion, RigidState, Sent, ToolState,
};
pub use frame::FrameState;
pub use late::late_step;
pub use scratch::Scratch;
pub use state::{PairState, RunState, SceneState};
pub(crate) use step::depths_at_start;
pub use step::{apply, deform, hash, render, restore, step, step_explained, step_into};
pub use warm::{Warm, WarmRow};
