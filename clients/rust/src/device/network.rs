//! A network between device and daemon: delay, jitter, loss and reordering, by the device's own
//! time.
//!
//! What happens to an item depends on the seed and on how many went before it, not on a clock: a
//! run in lockstep repeats by bits.

use super::model::{DeviceError, check};
use super::random::Random;

/// One way of a network.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Network {
    /// Every item takes at least this long, s.
    pub delay_s: f64,
    /// And up to this much more, uniformly, s. By itself it keeps the order.
    pub jitter_s: f64,
    /// Share of items that never arrive, 0 to 1.
    pub loss: f64,
    /// Share of items that arrive after the one sent next, 0 to 1.
    pub reorder: f64,
    /// Decides which.
    pub seed: u64,
}

impl Network {
    /// True when it does nothing.
    pub fn is_perfect(&self) -> bool {
        self.delay_s == 0.0 && self.jitter_s == 0.0 && self.loss == 0.0 && self.reorder == 0.0
    }
}

struct Travelling<T> {
    arrives_ns: u64,
    item: T,
}

/// Items under way.
pub struct Channel<T> {
    network: Network,
    random: Random,
    travelling: Vec<Travelling<T>>, // by arrival, then by sending
    last_sent_ns: u64,
    last_in_order_ns: u64,
    sent: u64,
    lost: u64,
}

/// Times are compared in whole ns: 0.005 s after 0.001 s must be 0.006 s.
fn nanoseconds(seconds: f64) -> u64 {
    (seconds * 1e9).round() as u64
}

impl<T> Channel<T> {
    /// An empty channel.
    ///
    /// # Errors
    /// A figure no network has.
    pub fn new(network: Network) -> Result<Self, DeviceError> {
        for (field, value) in [("delay", network.delay_s), ("jitter", network.jitter_s)] {
            check(
                "network",
                field,
                value,
                (0.0..=60.0).contains(&value),
                "a time from 0 to 60 s",
            )?;
        }
        for (field, value) in [("loss", network.loss), ("reorder", network.reorder)] {
            check(
                "network",
                field,
                value,
                (0.0..=1.0).contains(&value),
                "a share from 0 to 1",
            )?;
        }
        let random = Random::new(network.seed);
        Ok(Self {
            network,
            random,
            travelling: Vec::new(),
            last_sent_ns: 0,
            last_in_order_ns: 0,
            sent: 0,
            lost: 0,
        })
    }

    /// Sends an item at a time that does not go back.
    pub fn send(&mut self, now_s: f64, item: T) {
        // Three draws an item, used or not: one option of a network leaves what the others decide
        // as it was.
        let [lost, late, jitter] = [
            self.random.uniform(),
            self.random.uniform(),
            self.random.uniform(),
        ];
        let now_ns = nanoseconds(now_s);
        let apart_ns = now_ns.saturating_sub(self.last_sent_ns);
        self.last_sent_ns = now_ns;
        self.sent += 1;
        if lost < self.network.loss {
            self.lost += 1;
            return;
        }
        let takes_s = self.network.delay_s + jitter * self.network.jitter_s;
        let mut arrives_ns = now_ns + nanoseconds(takes_s);
        if late < self.network.reorder {
            // One and a half sending intervals late, and whatever jitter the next may meet.
            arrives_ns += apart_ns + apart_ns / 2 + nanoseconds(self.network.jitter_s);
        } else {
            arrives_ns = arrives_ns.max(self.last_in_order_ns);
            self.last_in_order_ns = arrives_ns;
        }
        let place = self
            .travelling
            .partition_point(|other| other.arrives_ns <= arrives_ns);
        self.travelling
            .insert(place, Travelling { arrives_ns, item });
    }

    /// What has arrived by now, in order of arrival.
    pub fn receive(&mut self, now_s: f64) -> impl Iterator<Item = T> + '_ {
        let now_ns = nanoseconds(now_s);
        let count = self
            .travelling
            .partition_point(|item| item.arrives_ns <= now_ns);
        self.travelling
            .drain(..count)
            .map(|travelling| travelling.item)
    }

    /// Items sent.
    pub fn sent(&self) -> u64 {
        self.sent
    }

    /// Items that never arrive.
    pub fn lost(&self) -> u64 {
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sends 0, 1, 2… every ms and tells what arrives in each ms.
    fn arrivals(network: Network, count: usize) -> Vec<Vec<usize>> {
        let mut channel = Channel::new(network).unwrap();
        (0..count)
            .map(|k| {
                let now_s = k as f64 * 1e-3;
                channel.send(now_s, k);
                channel.receive(now_s).collect()
            })
            .collect()
    }

    #[test]
    fn a_perfect_network_hands_over_at_once() {
        assert!(Network::default().is_perfect());
        let seen = arrivals(Network::default(), 100);
        assert!(seen.iter().enumerate().all(|(k, items)| *items == [k]));
    }

    #[test]
    fn a_delay_of_five_milliseconds_is_five_periods_exactly() {
        for (k, items) in arrivals(
            Network {
                delay_s: 0.005,
                ..Network::default()
            },
            2_000,
        )
        .iter()
        .enumerate()
        {
            let expected: &[usize] = if k < 5 { &[] } else { &[k - 5] };
            assert_eq!(items, expected, "at {k} ms");
        }
    }

    #[test]
    fn jitter_keeps_the_order_and_its_bounds() {
        let network = Network {
            delay_s: 0.004,
            jitter_s: 0.003,
            seed: 5,
            ..Network::default()
        };
        let mut delays = Vec::new();
        let mut last = None;
        for (k, items) in arrivals(network, 5_000).into_iter().enumerate() {
            for item in items {
                assert!(last < Some(item), "{item} after {last:?}");
                last = Some(item);
                delays.push(k - item);
            }
        }
        // More than 4 and less than 7, seen at the next whole ms.
        assert_eq!(
            (delays.iter().min(), delays.iter().max()),
            (Some(&5), Some(&7))
        );
    }

    #[test]
    fn loss_and_reordering_come_in_the_share_asked_for() {
        let network = Network {
            loss: 0.1,
            reorder: 0.05,
            seed: 3,
            ..Network::default()
        };
        let mut channel = Channel::new(network).unwrap();
        let (mut got, mut overtaken, mut newest) = (0, 0, 0);
        for k in 1..=20_000u64 {
            channel.send(k as f64 * 1e-3, k);
            for item in channel.receive(k as f64 * 1e-3) {
                got += 1;
                overtaken += u64::from(item < newest);
                newest = newest.max(item);
            }
        }
        // Standard deviations: 42 and 28. An item held back is not overtaken if the next is lost or
        // late too.
        assert!(
            (channel.lost() as f64 - 2_000.0).abs() < 170.0,
            "{}",
            channel.lost()
        );
        assert!(
            (overtaken as f64 - 0.9 * 0.05 * (0.9 * 0.95) * 20_000.0).abs() < 110.0,
            "{overtaken}"
        );
        assert!(channel.sent() == 20_000 && got + channel.lost() >= 19_998);
    }

    #[test]
    fn the_seed_decides_and_bad_figures_are_refused() {
        let network = Network {
            delay_s: 0.002,
            jitter_s: 0.004,
            loss: 0.1,
            reorder: 0.1,
            seed: 9,
        };
        assert_eq!(arrivals(network, 500), arrivals(network, 500));
        assert_ne!(
            arrivals(network, 500),
            arrivals(
                Network {
                    seed: 10,
                    ..network
                },
                500
            )
        );
        for bad in [
            Network {
                delay_s: -1.0,
                ..network
            },
            Network {
                jitter_s: f64::NAN,
                ..network
            },
            Network {
                loss: 1.5,
                ..network
            },
            Network {
                reorder: f64::INFINITY,
                ..network
            },
        ] {
            assert!(matches!(
                Channel::<u8>::new(bad),
                Err(DeviceError::Figure { .. })
            ));
        }
    }
}
