//! Zenoh: sessions, quality of service, and the bus thread.
//!
//! Callbacks run on Zenoh's receive threads: they decode to a stack value, store it and return. All
//! puts and replies are made by the bus thread; the tick thread never calls Zenoh.

mod answers;
mod bus;
mod contacts;
mod deadband;
mod declared;
mod desk;
mod devices;
mod edit;
mod events;
mod forces;
mod history;
mod link;
mod metrics;
mod nets;
mod poses;
mod rpc;
mod schemas;
mod session;
mod tally;
mod view;

pub use bus::{Bus, BusReport, BusSettings};
pub use metrics::LoopMetrics;
pub use session::{DEFAULT_ENDPOINT, Role, SessionError, SessionSettings, is_taken, open};
pub use view::ViewSink;
