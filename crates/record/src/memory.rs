//! The last seconds of a session in memory, for whoever wants them afterwards.

use super::message::Message;
use std::collections::VecDeque;
use std::sync::Arc;

/// Messages of at least the last so many ticks, from a keyframe on.
pub(super) struct Memory {
    ticks: u64,
    messages: VecDeque<Arc<Message>>,
    /// Ticks of the keyframes in it, ascending.
    keyframes: VecDeque<u64>,
}

impl Memory {
    pub fn new(ticks: u64) -> Self {
        Self {
            ticks: ticks.max(1),
            messages: VecDeque::new(),
            keyframes: VecDeque::new(),
        }
    }

    pub fn push(&mut self, message: &Arc<Message>) {
        if message.is_keyframe() {
            self.keyframes.push_back(message.tick);
        } else if self.keyframes.is_empty() {
            // Without a keyframe before it nothing can be replayed.
            return;
        }
        self.messages.push_back(message.clone());
        // What comes before the second keyframe may go when the rest still reaches back far enough.
        while self.keyframes.len() > 1
            && message.tick.saturating_sub(self.keyframes[1]) >= self.ticks
        {
            self.keyframes.pop_front();
            let mut met = false;
            while let Some(front) = self.messages.front() {
                if front.is_keyframe() && std::mem::replace(&mut met, true) {
                    break;
                }
                self.messages.pop_front();
            }
        }
    }

    /// From the last keyframe at or before `tick` on; from the first there is, when that is later.
    pub fn since(&self, tick: u64) -> impl Iterator<Item = &Arc<Message>> {
        let from = self
            .keyframes
            .iter()
            .rposition(|keyframe| *keyframe <= tick)
            .unwrap_or(0);
        let mut before = from + 1;
        self.messages.iter().skip_while(move |message| {
            before -= usize::from(message.is_keyframe());
            before > 0
        })
    }

    pub fn clear(&mut self) {
        self.messages.clear();
        self.keyframes.clear();
    }

    pub fn is_empty(&self) -> bool {
        self.messages.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Topic;

    fn message(topic: Topic, tick: u64) -> Arc<Message> {
        Arc::new(Message::encoded(topic, tick, vec![0; 10]))
    }

    fn filled(ticks: u64, keep: u64, every: u64) -> Memory {
        let mut memory = Memory::new(keep);
        memory.push(&message(Topic::Event, 0));
        memory.push(&message(Topic::Keyframe, 0));
        for tick in 1..=ticks {
            memory.push(&message(Topic::Tick, tick));
            if tick % every == 0 {
                memory.push(&message(Topic::Keyframe, tick));
            }
        }
        memory
    }

    #[test]
    fn it_begins_with_a_keyframe_and_reaches_back_as_far_as_it_should() {
        for ticks in 0..400 {
            let memory = filled(ticks, 100, 30);
            let first = memory.messages.front().unwrap();
            assert!(first.is_keyframe(), "after {ticks} ticks");
            assert!(
                first.tick == 0 || ticks - first.tick >= 100,
                "after {ticks} ticks it begins at {}",
                first.tick
            );
            assert!(
                ticks - first.tick < 100 + 30 + 1,
                "after {ticks} ticks it still begins at {}",
                first.tick
            );
        }
    }

    #[test]
    fn a_reach_into_the_past_begins_at_the_keyframe_before_it() {
        let memory = filled(395, 100, 30);
        assert_eq!(memory.keyframes, [270, 300, 330, 360, 390]);
        for (tick, begins) in [
            (0, 270),
            (270, 270),
            (299, 270),
            (300, 300),
            (345, 330),
            (395, 390),
        ] {
            let found: Vec<_> = memory.since(tick).collect();
            assert_eq!(found[0].tick, begins, "since {tick}");
            assert!(found[0].is_keyframe());
            assert_eq!(found.last().unwrap().tick, 395);
        }
    }
}
