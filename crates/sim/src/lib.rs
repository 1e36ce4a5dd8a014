//! The simulation: scenes, deforming bodies, contact forces, haptic couplings and the tick.
//!
//! ```text
//! solve ──▶ body | haptics ──▶ scene ──▶ party ──▶ contact ──▶ rest ──▶ report ──▶ tick ──▶ world
//! ```
//! [`tick::step`] is pure: no clock, no I/O, no allocation, no lock, no error. Given the same build
//! and inputs it computes the same bits. What drives it in real time, publishes and records it is
//! in the `palpate` crate.

// Tests compare with formulas as they stand; the list of clippy.toml holds for what simulates.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod body;
pub mod contact;
pub mod haptics;
mod in_place;
pub mod party;
pub mod report;
mod rest;
pub mod scene;
mod side_by_side;
pub mod solve;
pub mod tick;
mod world;

pub use world::World;
