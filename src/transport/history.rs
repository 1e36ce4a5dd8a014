//! The last events, for those who come late or missed one.

use palpate_proto::messages::SimEvent;
use std::collections::VecDeque;

/// Events kept.
pub(super) const KEPT: usize = 256;

/// The newest events, oldest first.
#[derive(Debug, Default)]
pub(super) struct History {
    events: VecDeque<SimEvent>,
}

impl History {
    /// Keeps one more; the oldest leaves.
    pub(super) fn push(&mut self, event: SimEvent) {
        if self.events.len() == KEPT {
            self.events.pop_front();
        }
        self.events.push_back(event);
    }

    /// Those whose number is above `seq`.
    pub(super) fn after(&self, seq: u64) -> impl Iterator<Item = &SimEvent> {
        self.events.iter().filter(move |event| event.seq > seq)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_proto::messages::EventKind;

    #[test]
    fn the_newest_are_kept_and_given_by_number() {
        let mut history = History::default();
        for seq in 1..=300 {
            history.push(SimEvent {
                tick: seq,
                seq,
                t_ns: 0,
                kind: EventKind::Reset,
            });
        }
        let seqs = |after| {
            history
                .after(after)
                .map(|event| event.seq)
                .collect::<Vec<_>>()
        };
        assert_eq!(seqs(0), (45..=300).collect::<Vec<_>>());
        assert_eq!(seqs(298), [299, 300]);
        assert_eq!(seqs(300), [0u64; 0]);
        assert_eq!(seqs(u64::MAX), [0u64; 0]);
    }
}
