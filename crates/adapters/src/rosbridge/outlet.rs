//! What goes to one client: answers in their order, messages of topics as it asked for them.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::Notify;

/// Answers that may wait for a client; more are dropped.
const LETTERS: usize = 256;
/// Messages of a topic that may wait, whatever the client asks for.
const LONGEST: usize = 256;

/// How a client wants the messages of a topic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pace {
    /// Least time between two messages.
    pub(super) every: Duration,
    /// Messages that may wait.
    pub(super) queue: usize,
}

#[derive(Default)]
struct Topic {
    /// By subscription.
    paces: BTreeMap<String, Pace>,
    waiting: VecDeque<Arc<str>>,
    sent: Option<Instant>,
}

impl Topic {
    /// Of several subscriptions to a topic the quickest and the shortest counts, as in rosbridge.
    fn pace(&self) -> Pace {
        let every = self.paces.values().map(|pace| pace.every).min();
        let queue = self.paces.values().map(|pace| pace.queue).min();
        Pace {
            every: every.unwrap_or_default(),
            queue: queue.unwrap_or_default().clamp(1, LONGEST),
        }
    }

    fn due(&self) -> Option<Instant> {
        self.sent.map(|sent| sent + self.pace().every)
    }
}

#[derive(Default)]
struct State {
    letters: VecDeque<Arc<str>>,
    topics: BTreeMap<String, Topic>,
}

/// The way to one client. Nothing that is put in waits.
#[derive(Default)]
pub(super) struct Outlet {
    state: Mutex<State>,
    news: Notify,
}

impl Outlet {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sends an answer.
    pub(super) fn answer(&self, text: String) {
        let mut state = self.lock();
        if state.letters.len() < LETTERS {
            state.letters.push_back(text.into());
        }
        drop(state);
        self.news.notify_one();
    }

    /// The client wants a topic; `id` names its subscription.
    pub(super) fn subscribe(&self, topic: &str, id: &str, pace: Pace) {
        let mut state = self.lock();
        let wanted = state.topics.entry(topic.to_owned()).or_default();
        wanted.paces.insert(id.to_owned(), pace);
    }

    /// It does not want it any more: one subscription, or all of the topic.
    pub(super) fn unsubscribe(&self, topic: &str, id: Option<&str>) {
        let mut state = self.lock();
        if let Some(known) = state.topics.get_mut(topic) {
            match id {
                Some(id) => drop(known.paces.remove(id)),
                None => known.paces.clear(),
            }
            if known.paces.is_empty() {
                state.topics.remove(topic);
            }
        }
    }

    /// The client wants this topic.
    pub(super) fn wants(&self, topic: &str) -> bool {
        self.lock().topics.contains_key(topic)
    }

    /// A message of a topic, for a client that wants it; of those that wait the oldest leave.
    pub(super) fn offer(&self, topic: &str, text: &Arc<str>) {
        let mut state = self.lock();
        let Some(wanted) = state.topics.get_mut(topic) else {
            return;
        };
        let room = wanted.pace().queue;
        while wanted.waiting.len() >= room {
            wanted.waiting.pop_front();
        }
        wanted.waiting.push_back(text.clone());
        drop(state);
        self.news.notify_one();
    }

    /// All that is due, and when the next is if something waits.
    pub(super) fn take(&self, now: Instant) -> (Vec<Arc<str>>, Option<Instant>) {
        let mut state = self.lock();
        let mut texts: Vec<Arc<str>> = state.letters.drain(..).collect();
        let mut next: Option<Instant> = None;
        for topic in state.topics.values_mut() {
            while !topic.waiting.is_empty() {
                if let Some(due) = topic.due().filter(|due| *due > now) {
                    next = Some(next.map_or(due, |next| next.min(due)));
                    break;
                }
                topic.sent = Some(now);
                texts.extend(topic.waiting.pop_front());
            }
        }
        (texts, next)
    }

    /// Resolves when something was put in.
    pub(super) async fn news(&self) {
        self.news.notified().await;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    fn texts(outlet: &Outlet, now: Instant) -> Vec<String> {
        let (texts, _) = outlet.take(now);
        texts.iter().map(ToString::to_string).collect()
    }

    fn offer(outlet: &Outlet, texts: &[&str]) {
        for text in texts {
            outlet.offer("/f", &Arc::from(*text));
        }
    }

    #[test]
    fn a_client_that_is_slow_gets_the_newest_and_answers_are_not_lost() {
        let (outlet, now) = (Outlet::default(), Instant::now());
        offer(&outlet, &["0"]);
        assert!(texts(&outlet, now).is_empty(), "nobody asked for it");
        let pace = Pace {
            every: Duration::ZERO,
            queue: 0,
        };
        outlet.subscribe("/f", "a", pace);
        offer(&outlet, &["1", "2", "3"]);
        outlet.answer("x".into());
        assert_eq!(texts(&outlet, now), ["x", "3"]);
    }

    #[test]
    fn throttled_messages_wait_in_a_queue_as_long_as_was_asked_for() {
        let (outlet, now) = (Outlet::default(), Instant::now());
        let pace = Pace {
            every: 10 * MS,
            queue: 2,
        };
        outlet.subscribe("/f", "a", pace);
        offer(&outlet, &["1"]);
        assert_eq!(texts(&outlet, now), ["1"]);
        offer(&outlet, &["2", "3", "4"]);
        let (none, due) = outlet.take(now + 3 * MS);
        assert_eq!((none.len(), due), (0, Some(now + 10 * MS)));
        assert_eq!(texts(&outlet, now + 10 * MS), ["3"]);
        assert_eq!(texts(&outlet, now + 20 * MS), ["4"]);
        // A second subscription to the topic is quicker: it counts.
        outlet.subscribe(
            "/f",
            "b",
            Pace {
                every: MS,
                queue: 9,
            },
        );
        offer(&outlet, &["5", "6"]);
        assert_eq!(texts(&outlet, now + 21 * MS), ["5"]);
        assert_eq!(texts(&outlet, now + 22 * MS), ["6"]);
        outlet.unsubscribe("/f", Some("b"));
        assert!(outlet.wants("/f"));
        outlet.unsubscribe("/f", None);
        assert!(!outlet.wants("/f"));
    }
}
