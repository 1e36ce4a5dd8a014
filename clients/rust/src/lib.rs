//! Client of the Palpate haptic server.
//!
//! ```no_run
//! use palpate_client::{Connect, Palpate};
//! let palpate = Palpate::connect(&Connect::to("tcp/127.0.0.1:7447"))?;
//! let scene = palpate.scene()?;
//! let mut tool = palpate.tool(&scene.tools[0].id)?;
//! let seq = tool.send(palpate_client::pose_at([0.0, 0.0, 0.05]))?;
//! if let Some(force) = tool.wait_force(seq, std::time::Duration::from_millis(50)) {
//!     println!("{:?} N", force.force);
//! }
//! # Ok::<(), palpate_client::ClientError>(())
//! ```
//! [`device`] simulates haptic devices, hands and networks; [`testing`] starts daemons for integration
//! tests.

mod announce;
mod config;
mod connection;
pub mod device;
mod exact;
pub mod links;
mod newest;
mod ping;
mod publish;
pub mod testing;
mod tls;
mod tool;
mod watch;

pub use config::{
    Named, add_identity, check_private, check_protocol, configuration, identity, is_secured, named,
};
pub use connection::{ClientError, Connect, Latest, Palpate};
pub use exact::is_one_key;
pub use newest::NewestForce;
pub use palpate_proto as proto;
pub use palpate_proto::keys::short_id;
pub use palpate_proto::pose_at;
pub use palpate_proto::watchdog::{Silences, Watchdog};
pub use ping::{PingReport, raw_ping};
pub use publish::{encoding, publisher};
pub use tool::{Forces, Tool, holder_id};
pub use watch::Seen;
