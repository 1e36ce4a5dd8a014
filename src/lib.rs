//! The Palpate server: the simulation of [`palpate_sim`] driven at a fixed rate, over Zenoh, with
//! recordings that replay bit for bit.
//!
//! ```text
//! drive ──▶ wire ──▶ transport | recording ──▶ editing, viewer, adapters, auth ──▶ cli
//! ```
//! Transport and recording do not know each other; they meet in [`drive::archive`] and
//! [`drive::playback`]. `docs/ARCHITECTURE.md` shows how a tick passes through all of it.

pub mod adapters;
pub mod auth;
pub mod batch;
/// Pictures of curves as SVG, for `export --svg` and the benches; not part of the library.
#[doc(hidden)]
pub mod chart;
pub mod cli;
mod door;
pub mod drive;
pub mod editing;
pub mod faults;
pub mod fleet;
mod program;
pub mod recording;
pub mod relay;
pub mod scenario;
pub mod transport;
pub mod viewer;
pub mod wire;

/// Rust blocks of the guides are compiled, and run where they can be.
#[cfg(doctest)]
mod guides {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/branch.md")]
    struct Branch;
    #[doc = include_str!("../docs/recording.md")]
    struct Recording;
}
