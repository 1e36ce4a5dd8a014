//! What reaches the client of a tool: forces sent to it, forces that it received, and how old they are.
//!
//! A client says with each pose, after its id in the attachment, how many forces have come and which was the
//! newest ([`Receipt`]). Clients that say nothing are not counted here.

use palpate_drive::ports::SenderId;
use palpate_drive::stats::Histogram;
use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};
use zenoh::bytes::ZBytes;

/// Where the id of a client ends in its attachment, and its receipt begins.
const ID_BYTES: usize = 24;
/// Forces that a receipt may name, the newest: a second of a usual loop.
const SENT_KEPT: usize = 1_000;

/// What a client has received, as it says with a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Receipt {
    /// Forces since it took the tool.
    received: u64,
    /// `t_server_ns` of the newest of them; 0: none yet.
    newest_ns: u64,
}

impl Receipt {
    /// From an attachment; `None` where there is none in it.
    pub(super) fn of(attachment: &[u8]) -> Option<Self> {
        let (received, rest) = attachment.get(ID_BYTES..)?.split_first_chunk()?;
        let (newest, rest) = rest.split_first_chunk()?;
        rest.is_empty().then_some(Self {
            received: u64::from_le_bytes(*received),
            newest_ns: u64::from_le_bytes(*newest),
        })
    }
}

/// What is counted of the client that holds a tool.
#[derive(Clone, Debug, PartialEq)]
pub struct ClientCounts {
    /// Its id, shortened.
    pub client: String,
    /// Forces published since its first receipt.
    pub published: u64,
    /// Forces that came to it since then, as it says.
    pub received: u64,
    /// Age of the newest force that it had, when its pose came here, ns: median, 99th percentile, maximum.
    pub age_ns: [u64; 3],
}

/// The client of one tool. Receive threads note what it says, the bus thread what is sent.
#[derive(Debug, Default)]
pub(super) struct ClientLink(Mutex<Link>);

#[derive(Debug, Default)]
struct Link {
    counted: Option<Counted>,
    /// Forces sent so far, and when the newest were, by their stamps.
    sent: u64,
    stamps: VecDeque<u64>,
    /// Forces that did not come to the clients before this one.
    lost_before: u64,
}

impl Link {
    /// How many forces had been sent with the one that has this stamp.
    fn sent_until(&self, stamp_ns: u64) -> Option<u64> {
        let newer = self.stamps.iter().rev().position(|&at| at == stamp_ns)?;
        Some(self.sent - newer as u64)
    }
}

#[derive(Debug)]
struct Counted {
    sender: SenderId,
    /// What it had received with its first receipt.
    before: u64,
    received: u64,
    published: u64,
    age: Histogram,
    /// Forces sent and received with the first one that it names.
    base: Option<(u64, u64)>,
    /// Of those sent since then, up to the one that it named last, the ones that did not come.
    lost: u64,
}

impl ClientLink {
    /// A pose was taken; `attachment` came with it at `now_ns` by the daemon's clock.
    pub(super) fn heard(&self, sender: SenderId, attachment: Option<&ZBytes>, now_ns: u64) {
        let bytes = attachment.map(ZBytes::to_bytes);
        if let Some(receipt) = bytes.as_deref().and_then(Receipt::of) {
            self.note(sender, receipt, now_ns);
        }
    }

    fn note(&self, sender: SenderId, receipt: Receipt, now_ns: u64) {
        let mut link = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let link = &mut *link;
        let sent = link.sent_until(receipt.newest_ns);
        if let Some(other) = link.counted.take_if(|counted| counted.sender != sender) {
            link.lost_before += other.lost;
        }
        let counted = link.counted.get_or_insert_with(|| Counted {
            sender,
            before: receipt.received,
            received: receipt.received,
            published: 0,
            age: Histogram::default(),
            base: None,
            lost: 0,
        });
        // What is on its way is not lost: only forces up to the one that it names should be there.
        if let Some(sent) = sent {
            let (sent_then, received_then) = *counted.base.get_or_insert((sent, receipt.received));
            let here = receipt.received.saturating_sub(received_then);
            counted.lost = sent.saturating_sub(sent_then).saturating_sub(here);
        }
        counted.received = counted.received.max(receipt.received);
        // By the daemon's own clock both times. A time to come is a lie or of another daemon.
        if let Some(age_ns) = now_ns
            .checked_sub(receipt.newest_ns)
            .filter(|_| receipt.newest_ns > 0)
        {
            counted.age.add(age_ns);
        }
    }

    /// A force with this stamp is published.
    pub(super) fn sent(&self, stamp_ns: u64) {
        let mut link = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        link.sent += 1;
        if link.stamps.len() == SENT_KEPT {
            link.stamps.pop_front();
        }
        link.stamps.push_back(stamp_ns);
        if let Some(counted) = &mut link.counted {
            counted.published += 1;
        }
    }

    /// Forces sent, and those of them that did not come to clients that say what comes.
    pub(super) fn sent_and_lost(&self) -> (u64, u64) {
        let link = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let lost = link.counted.as_ref().map_or(0, |counted| counted.lost);
        (link.sent, link.lost_before + lost)
    }

    /// What was counted, if the tool's client says what it receives.
    pub(super) fn counts(&self) -> Option<ClientCounts> {
        let link = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        link.counted.as_ref().map(|counted| ClientCounts {
            client: counted.sender.short(),
            published: counted.published,
            received: counted.received.saturating_sub(counted.before),
            age_ns: [
                counted.age.quantile(0.5),
                counted.age.quantile(0.99),
                counted.age.max(),
            ],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attachment(id: u8, received: u64, newest_ns: u64) -> Vec<u8> {
        [
            &[id; 24][..],
            &received.to_le_bytes(),
            &newest_ns.to_le_bytes(),
        ]
        .concat()
    }

    fn tell(link: &ClientLink, bytes: &[u8], now_ns: u64) {
        let sender = SenderId::of(Some(bytes));
        link.heard(sender, Some(&ZBytes::from(bytes)), now_ns);
    }

    #[test]
    fn each_client_is_counted_from_its_first_receipt_on() {
        let link = ClientLink::default();
        link.sent(5);
        assert_eq!(link.counts(), None);
        // It heard 40 forces of the client before it.
        tell(&link, &attachment(1, 40, 0), 9_000);
        for k in 1..=100 {
            link.sent(1_000_000 * k);
            tell(
                &link,
                &attachment(1, 40 + k, 1_000_000 * k),
                1_000_000 * k + 800,
            );
        }
        let counts = link.counts().unwrap();
        assert_eq!((counts.published, counts.received), (100, 100));
        assert!(
            counts.age_ns.iter().all(|age| (800..=900).contains(age)),
            "{counts:?}"
        );
        tell(&link, &attachment(2, 7, 0), 5);
        let other = link.counts().unwrap();
        assert_eq!(
            (other.published, other.received, other.age_ns),
            (0, 0, [0; 3])
        );
        assert_ne!(other.client, counts.client);
    }

    // Sixteen forces are under way to a client that speaks sixty times a second, and none of them is lost.
    #[test]
    fn a_force_is_lost_when_its_client_has_a_newer_one_and_not_before() {
        let link = ClientLink::default();
        let (mut received, mut dropped) = (0, 0);
        for stamp in 1..=3_000_u64 {
            link.sent(stamp);
            // From the thousandth on every tenth is dropped on the way, which takes five of them.
            let arrived = stamp.saturating_sub(5);
            if arrived > 0 {
                let falls = arrived > 1_000 && arrived % 10 == 0;
                (received, dropped) = (received + u64::from(!falls), dropped + u64::from(falls));
                if stamp % 16 == 0 && !falls {
                    tell(&link, &attachment(1, received, arrived), stamp);
                    assert_eq!(link.sent_and_lost(), (stamp, dropped), "{stamp}");
                }
            }
        }
        assert!(dropped > 150);
        // The next holder begins anew, and what was lost before stays counted.
        link.sent(3_001);
        tell(&link, &attachment(2, 1, 3_001), 3_001);
        link.sent(3_002);
        link.sent(3_003);
        let before = link.sent_and_lost().1;
        tell(&link, &attachment(2, 2, 3_003), 3_003);
        assert_eq!(link.sent_and_lost(), (3_003, before + 1));
        // A stamp that nothing had says nothing.
        tell(&link, &attachment(2, 0, 77), 3_004);
        assert_eq!(link.sent_and_lost(), (3_003, before + 1));
    }

    #[test]
    fn what_is_no_receipt_or_a_lie_counts_nothing() {
        let link = ClientLink::default();
        for bytes in [&[][..], &[3; 24], &[3; 39], &[3; 41], &[3; 1000]] {
            tell(&link, bytes, 1);
            link.heard(SenderId::default(), None, 1);
            assert_eq!(link.counts(), None, "{}", bytes.len());
        }
        // A force from the future, and counters that fall or leap.
        for received in [5, 0, u64::MAX, 1] {
            tell(&link, &attachment(9, received, u64::MAX), 1_000);
        }
        let counts = link.counts().unwrap();
        assert_eq!((counts.received, counts.age_ns), (u64::MAX - 5, [0; 3]));
    }
}
