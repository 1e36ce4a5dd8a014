//! Where poses come in, and what is counted of them.

use palpate_sim::haptics::DevicePose;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread::Thread;

/// Counters of a tool's link, by cause. Each pose that arrives is counted once: as received, or
/// under the first cause for which it was refused.
#[derive(Debug, Default)]
pub struct LinkCounters {
    /// Poses taken.
    pub received: AtomicU64,
    /// Another type or version.
    pub wrong_version: AtomicU64,
    /// Not the bytes of a pose, or more after its end.
    pub malformed: AtomicU64,
    /// More bytes than a pose can have.
    pub oversized: AtomicU64,
    /// Values that are NaN or infinite.
    pub not_finite: AtomicU64,
    /// Quaternions that are not rotations.
    pub bad_quaternion: AtomicU64,
    /// The newest number once more.
    pub duplicated: AtomicU64,
    /// A number below the newest.
    pub out_of_order: AtomicU64,
    /// Poses latched by ticks.
    pub latched: AtomicU64,
}

impl LinkCounters {
    /// Adds one; true when it is the first.
    pub fn count(counter: &AtomicU64) -> bool {
        counter.fetch_add(1, Ordering::Relaxed) == 0
    }
}

/// What became of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Offered {
    /// It is the newest now.
    Taken,
    /// The newest already was this one. `first`: for the first time.
    Duplicate {
        /// None was counted before.
        first: bool,
    },
    /// The newest comes after it. `first`: for the first time.
    OutOfOrder {
        /// None was counted before.
        first: bool,
    },
}

/// Where a receiver puts poses; newest wins. Used by receive threads only, never by the tick.
#[derive(Debug)]
pub struct PoseInbox {
    pub(super) slot: Mutex<InboxSlot>,
    /// Counters.
    pub counters: Arc<LinkCounters>,
    /// Set by a duplicate: its sender missed the force and asks again.
    pub asked_again: AtomicBool,
    pub(super) tick_thread: Arc<OnceLock<Thread>>,
}

#[derive(Debug)]
pub(super) struct InboxSlot {
    pub newest: u64,
    pub input: triple_buffer::Input<Option<DevicePose>>,
}

impl PoseInbox {
    /// Takes a pose, if it is newer than the last.
    pub fn offer(&self, pose: DevicePose) -> Offered {
        let mut slot = self.slot.lock().unwrap_or_else(PoisonError::into_inner);
        // Numbers begin at 1: a first pose numbered 0 repeats nothing.
        if pose.seq == slot.newest && pose.seq > 0 {
            self.asked_again.store(true, Ordering::Release);
            return Offered::Duplicate {
                first: LinkCounters::count(&self.counters.duplicated),
            };
        }
        if pose.seq <= slot.newest {
            return Offered::OutOfOrder {
                first: LinkCounters::count(&self.counters.out_of_order),
            };
        }
        slot.newest = pose.seq;
        slot.input.write(Some(pose));
        LinkCounters::count(&self.counters.received);
        drop(slot);
        if let Some(thread) = self.tick_thread.get() {
            thread.unpark();
        }
        Offered::Taken
    }

    /// Whoever held the tool is gone: the next holder counts from anew.
    pub fn forget_sender(&self) {
        self.slot
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .newest = 0;
    }
}
