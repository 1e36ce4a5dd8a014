//! The Palpate server: the simulation of [`palpate_sim`] driven at a fixed rate, over Zenoh, with
//! recordings that replay bit for bit.
//!
//! ```text
//! transport ──▶ editing, viewer, auth, fleet, relay ──▶ cli
//! ```
//! The loop is `palpate-drive`, recordings are `palpate-record`. They and the bus know each other only through
//! [`palpate_drive::archive`] and [`palpate_drive::playback`]. `docs/ARCHITECTURE.md` shows how a tick passes through all of it.

pub mod auth;
pub mod cli;
pub mod editing;
pub mod fleet;
mod program;
pub mod relay;
pub mod transport;
pub mod viewer;

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
