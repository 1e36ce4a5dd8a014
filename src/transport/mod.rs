//! Zenoh: sessions, quality of service, and the bus thread.
//!
//! Callbacks run on Zenoh's receive threads: they decode to a stack value, store it and return. All
//! puts and replies are made by the bus thread; the tick thread never calls Zenoh.

mod answers;
mod bus;
mod deadband;
mod declared;
mod devices;
mod edit;
mod history;
mod metrics;
mod poses;
mod publish;
mod rpc;
mod schemas;
mod session;
mod tally;

pub use bus::{Bus, BusReport, BusSettings, ViewSink};
pub use metrics::Figures;
pub use session::{DEFAULT_ENDPOINT, SessionError, SessionSettings, open};
