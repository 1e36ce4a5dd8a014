//! The daemon under faults, on a virtual clock: what a fault of network, disk, process or clock must
//! not lead to is looked for over thousands of seeds.
//!
//! ```text
//! seed ─▶ plan: scene, hand, network, faults with their times
//!           └─▶ world: one queue of events, ordered by virtual time
//!                 host    drive::Driver, recorder, inbox, rate watch    as in the daemon
//!                 client  Servo, watchdog, passivity, newest force      as in the client
//!                 wire    loses, delays, reorders, duplicates
//!                 disk    stalls, in writes or in syncs; is full, fails
//!           └─▶ check: at every tick and servo period, and of every recording at the end
//! ```
//! Only threads, sockets and the system's clocks are replaced. Nothing here reads a clock or a random
//! number of the system: a seed repeats bit for bit.

mod check;
mod client;
mod disk;
mod host;
mod messages;
mod plan;
mod world;

pub use messages::{Counts, messages, sequence};
pub use plan::{Fault, Plan};
pub use world::{Report, run};

use std::cell::Cell;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

thread_local! {
    /// Virtual time of the simulation that runs on this thread, ns.
    static NOW_NS: Cell<u64> = const { Cell::new(0) };
}

/// Virtual time, ns.
fn now_ns() -> u64 {
    NOW_NS.with(Cell::get)
}

/// Virtual time for what wants an `Instant`: only differences are ever looked at.
fn now() -> Instant {
    static BEGIN: LazyLock<Instant> = LazyLock::new(Instant::now);
    *BEGIN + Duration::from_nanos(now_ns())
}

fn set_now(ns: u64) {
    NOW_NS.with(|now| now.set(ns));
}

/// What must not happen, and did.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("seed {seed}, {at_s:.6} s: {what}")]
pub struct Violation {
    /// Of the simulation: the same again shows the same again.
    pub seed: u64,
    /// Virtual time, s.
    pub at_s: f64,
    /// The invariant, with figures.
    pub what: String,
}
