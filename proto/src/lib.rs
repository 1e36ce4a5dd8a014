//! What Palpate says on the bus and writes into recordings.
//!
//! [`messages`] are the bus messages, [`codec`] their bytes, [`keys`] where they travel, [`rpc`]
//! the JSON of commands; with the `recording` feature, `recording` holds the Protobuf messages of
//! MCAP files and `foxglove` those that common viewers know; [`schema`] holds the layouts of the bus
//! messages; [`text`] makes words of others fit to be shown. `docs/wire.md` of the project gives them
//! for people who write a client without this crate.

pub mod any;
pub mod codec;
mod decode_error;
mod device;
#[cfg(feature = "recording")]
pub mod foxglove;
pub mod keys;
pub mod layout;
pub mod messages;
mod pose;
#[cfg(feature = "recording")]
pub mod recording;
pub mod rpc;
pub mod schema;
pub mod text;
pub mod watchdog;

pub use device::DeviceError;
pub use pose::pose_at;
pub use watchdog::Watchdog;
