//! Zenoh: sessions, quality of service, and the bus thread.
//!
//! Callbacks run on Zenoh's receive threads: they decode to a stack value, store it and return. All
//! puts are made by the bus thread and by those of `post`, which may wait for clients; the tick thread
//! never calls Zenoh.

mod answers;
mod budget;
mod bus;
mod clients;
mod contacts;
mod counters;
mod deadband;
mod declared;
mod desk;
mod devices;
mod edit;
mod events;
mod forces;
mod health;
mod history;
mod intake;
mod knives;
mod link;
mod metrics;
mod nets;
mod poses;
mod post;
mod rate;
mod rpc;
mod schemas;
mod session;
mod states;
mod tally;
mod view;

pub(crate) use budget::ROUTER_PATIENCE;
pub(crate) use budget::bound;
pub use budget::{patience, threads_for_many_clients};
pub use bus::{Bus, BusReport, BusSettings};
pub use clients::ClientCounts;
pub use health::Health;
pub use metrics::LoopMetrics;
pub use rate::{RateNews, RateWatch};
pub use rpc::loop_command;
pub use session::{
    Access, DEFAULT_ENDPOINT, DEFAULT_SECURE_ENDPOINT, Open, Role, SessionError, SessionSettings,
    daemon_of, default_listen, is_taken, open, open_told,
};
pub use view::ViewSink;
