//! HTTP beside a loop that must not wait: connections bounded in number and time, who may ask, compressed texts.
//!
//! ```text
//! door ─▶ listener ─┐
//! guard, gzip ──────┴─▶ server
//! ```

pub mod door;
mod guard;
mod gzip;
mod listener;
mod server;

pub use guard::Hosts;
pub use server::Server;
