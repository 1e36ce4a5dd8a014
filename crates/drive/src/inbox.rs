//! Where poses come in, and what is counted of them.

use super::pacer::now_ns;
use palpate_sim::haptics::DevicePose;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
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
    /// Of a client that does not hold the tool.
    pub strangers: AtomicU64,
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
    /// The newest comes after it, or is too far before it. `first`: for the first time.
    OutOfOrder {
        /// None was counted before.
        first: bool,
    },
    /// Another client holds the tool. `first`: for the first time.
    Stranger {
        /// None was counted before.
        first: bool,
    },
}

/// Who sends, as its messages say. Clients that say nothing are one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SenderId([u8; 24]);

impl SenderId {
    /// From whatever goes along with a message; what is longer than 24 bytes is cut.
    pub fn of(attachment: Option<&[u8]>) -> Self {
        let mut id = [0; 24];
        let bytes = attachment.unwrap_or_default();
        let count = bytes.len().min(id.len());
        id[..count].copy_from_slice(&bytes[..count]);
        Self(id)
    }

    /// As it goes along with forces.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// Enough of it to tell clients apart, as text.
    pub fn short(&self) -> String {
        palpate_proto::keys::short_id(&self.0)
    }
}

/// A holder that was silent for longer loses the tool to the next who sends, ns.
const HELD_NS: u64 = 250_000_000;
/// After so long without a pose of it, the same holder may count from anew, ns.
const SILENT_NS: u64 = 1_000_000_000;
/// A holder that is there does not skip more numbers than these.
const MOST_SKIPPED: u64 = 1 << 20;

/// Where a receiver puts poses; newest wins. Used by receive threads only, never by the tick.
#[derive(Debug)]
pub struct PoseInbox {
    pub(super) slot: Mutex<InboxSlot>,
    /// Counters.
    pub counters: Arc<LinkCounters>,
    /// Set by a duplicate: its sender missed the force and asks again.
    pub asked_again: AtomicBool,
    /// When the newest pose arrived that was taken, ns of the monotonic clock.
    pub(super) newest_ns: Arc<AtomicU64>,
    pub(super) tick_thread: Arc<OnceLock<Thread>>,
}

#[derive(Debug)]
pub(super) struct InboxSlot {
    pub newest: u64,
    /// Who moves the tool, and when it was heard, ns.
    pub holder: Option<(SenderId, u64)>,
    pub input: triple_buffer::Input<Option<SentPose>>,
}

/// A pose as it came.
#[derive(Clone, Copy, Debug)]
pub(super) struct SentPose {
    pub pose: DevicePose,
    pub sender: SenderId,
    /// When, ns of the monotonic clock.
    pub arrived_ns: u64,
}

impl PoseInbox {
    /// Takes a pose, if it is newer than the last and of whoever holds the tool.
    pub fn offer(&self, pose: DevicePose, sender: SenderId) -> Offered {
        self.offer_at(pose, sender, now_ns())
    }

    /// [`Self::offer`] of a pose that came at this time of the monotonic clock, ns.
    pub fn offer_at(&self, pose: DevicePose, sender: SenderId, now_ns: u64) -> Offered {
        let mut slot = self.lock();
        let since_ns = |heard_ns: u64| now_ns.saturating_sub(heard_ns);
        let fresh = (slot.holder).is_some_and(|(_, heard_ns)| since_ns(heard_ns) <= HELD_NS);
        match slot.holder {
            Some((holder, _)) if holder != sender && fresh => {
                return Offered::Stranger {
                    first: LinkCounters::count(&self.counters.strangers),
                };
            }
            // The next holder counts from anew.
            Some((holder, _)) if holder != sender => slot.newest = 0,
            _ => {}
        }
        // And so may one that was silent: a number from the end of the range, sent by mistake or by another
        // without an id, locks no one out for longer.
        let silent = (slot.holder).is_some_and(|(_, heard_ns)| since_ns(heard_ns) > SILENT_NS);
        if silent && pose.seq < slot.newest {
            slot.newest = 0;
        }
        // Numbers begin at 1: a first pose numbered 0 repeats nothing.
        if pose.seq == slot.newest && pose.seq > 0 {
            slot.holder = Some((sender, now_ns));
            self.asked_again.store(true, Ordering::Release);
            return Offered::Duplicate {
                first: LinkCounters::count(&self.counters.duplicated),
            };
        }
        let skipped = fresh
            && slot.newest > 0
            && pose.seq.saturating_sub(1) > slot.newest.saturating_add(MOST_SKIPPED);
        if pose.seq <= slot.newest || skipped {
            return Offered::OutOfOrder {
                first: LinkCounters::count(&self.counters.out_of_order),
            };
        }
        slot.newest = pose.seq;
        slot.holder = Some((sender, now_ns));
        slot.input.write(Some(SentPose {
            pose,
            sender,
            arrived_ns: now_ns,
        }));
        self.newest_ns.store(now_ns, Ordering::Release);
        LinkCounters::count(&self.counters.received);
        drop(slot);
        if let Some(thread) = self.tick_thread.get() {
            thread.unpark();
        }
        Offered::Taken
    }

    /// Who holds the tool.
    pub fn holder(&self) -> Option<SenderId> {
        let (holder, heard_ns) = self.lock().holder?;
        (now_ns().saturating_sub(heard_ns) <= HELD_NS).then_some(holder)
    }

    /// This client holds the tool, or no one does.
    pub fn may_hold(&self, sender: SenderId) -> bool {
        self.holder().is_none_or(|holder| holder == sender)
    }

    /// Whoever held the tool is gone: the next holder counts from anew.
    pub fn forget_sender(&self) {
        let mut slot = self.lock();
        (slot.newest, slot.holder) = (0, None);
    }

    fn lock(&self) -> MutexGuard<'_, InboxSlot> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::{Point3, Rotation, Vector3};

    fn inbox() -> PoseInbox {
        PoseInbox {
            slot: Mutex::new(InboxSlot {
                newest: 0,
                holder: None,
                input: triple_buffer::triple_buffer(&None).0,
            }),
            counters: Arc::default(),
            asked_again: AtomicBool::new(false),
            newest_ns: Arc::default(),
            tick_thread: Arc::default(),
        }
    }

    fn numbered(seq: u64) -> DevicePose {
        DevicePose {
            seq,
            t_client_ns: 0,
            position: Point3::origin(),
            orientation: Rotation::identity(),
            linear_velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            buttons: 0,
        }
    }

    #[test]
    fn a_number_from_the_end_of_the_range_locks_a_tool_for_a_second_at_most() {
        let nobody = SenderId::default();
        for last in [u64::MAX, u64::MAX - 1, 1 << 63, (1 << 53) + 1] {
            let inbox = inbox();
            let offer = |seq, ms| inbox.offer_at(numbered(seq), nobody, ms * 1_000_000);
            assert_eq!(offer(last, 0), Offered::Taken);
            let mut first_taken = None;
            for ms in 1..3000 {
                if offer(ms, ms) == Offered::Taken {
                    first_taken.get_or_insert(ms);
                }
            }
            assert_eq!(first_taken, Some(1001), "after {last}");
            // A pose that comes twice is one, however late.
            assert!(matches!(offer(2999, 9000), Offered::Duplicate { .. }));
        }
    }
}
