//! What drives the tick in real time: threads, clocks, and what passes in and out of the loop.
//!
//! ```text
//! PoseInbox, commands, Swap ──▶ driver (pacer, overload) ──▶ tick::step ──▶ outputs, Journal, nets
//! ```

pub mod archive;
pub mod driver;
pub mod editor;
mod inbox;
pub mod journal;
mod maker;
pub mod nets;
pub mod overload;
pub mod pacer;
pub mod phase;
pub mod playback;
pub mod pool;
pub mod ports;
pub mod stats;
pub mod swap;
pub mod threads;
pub mod workers;
