//! Messages that viewers know (Foxglove, Lichtblick, Rerun), generated from `proto/foxglove/` by
//! `cargo run -p palpate-proto --example generate`.
//! Names, numbers and types of fields are the published ones: `tests/foxglove.rs` compares them.
//! Their descriptors are in [`crate::recording::descriptors`].

#![allow(missing_docs, clippy::all)]

pub use prost_types::{Duration, Timestamp};

include!("generated/foxglove.rs");
