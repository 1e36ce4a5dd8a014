//! Reads a recording, finished or cut short, as a stream.
//!
//! ```text
//! file ─▶ Source ─▶ index, or a walk over all records ─▶ Layout: head, chunks, channels ─▶ Session
//! Session ─▶ Follower ─ one chunk (Page) at a time ─▶ ticks, nets, commands, keyframes, events
//! ```
//! Memory grows with the number of chunks by some sixty bytes each, and by the largest chunk for
//! each follower; a chunk larger than 64 MiB is damage.

mod contents;
mod error;
mod follower;
mod index;
mod keyframes;
mod layout;
mod page;
mod scene_text;
mod session;
mod source;

pub use contents::Contents;
pub use error::ReadError;
pub use follower::{Follower, Place};
pub use layout::SessionHeader;
pub use session::Session;

pub(super) use scene_text::recorded_spec;

pub(super) use keyframes::{
    first_keyframe, first_keyframe_where, keyframe_chunks, last_keyframe_until, last_tick_between,
};
