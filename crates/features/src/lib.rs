//! No code: this crate asks for features of third-party crates that tests and the Python module of the workspace need
//! and the daemon does not. The daemon depends on it, so `cargo run` and `cargo test --workspace` share one build of
//! all dependencies. `tests/daemon/features.rs` checks that they do.
