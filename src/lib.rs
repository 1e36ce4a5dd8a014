//! Palpate: touch on deforming B-spline surfaces at 1 kHz.
//!
//! Layers, in reading order; each imports only those before it: [`math`] → [`basis`] → [`surface`]
//! → [`contact`] → [`body`] | [`haptics`] → [`scene`] → [`tick`] → wire → transport | recording →
//! editing → viewer, bench, cli. Those from wire on come with the `daemon` feature. [`exchange`]
//! hangs off [`surface`], [`modeling`] off [`contact`]: above them only editing, bench and cli use
//! them.

pub mod basis;
#[cfg(any(feature = "daemon", feature = "bench-peers"))]
pub mod bench;
pub mod body;
pub mod contact;
pub mod exchange;
pub mod haptics;
pub mod math;
pub mod modeling;
pub mod scene;
pub mod surface;
pub mod tick;

#[cfg(feature = "daemon")]
pub mod cli;
#[cfg(feature = "daemon")]
pub mod editing;
#[cfg(feature = "daemon")]
pub mod recording;
#[cfg(feature = "daemon")]
pub mod transport;
#[cfg(feature = "daemon")]
pub mod viewer;
#[cfg(feature = "daemon")]
pub mod wire;
