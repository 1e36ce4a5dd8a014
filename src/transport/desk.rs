//! Commands under way: queries that wait for their answer, as many as their methods have
//! [places](super::intake).

use super::answers::reply_to_call;
use super::post::Asked;
use palpate_proto::rpc::Answer;

/// Queries by the number of their command.
pub(super) struct Desk {
    pending: Vec<(u64, Asked)>,
    next_id: u64,
}

impl Desk {
    /// Nothing is under way. Numbers begin at 1; 0 is no one's.
    pub(super) fn new() -> Self {
        Self {
            pending: Vec::new(),
            next_id: 1,
        }
    }

    /// The number that the next command gets.
    pub(super) fn next_id(&self) -> u64 {
        self.next_id
    }

    /// A number for a command of our own, whose answer no one waits for.
    pub(super) fn own_id(&mut self) -> u64 {
        self.next_id += 1;
        self.next_id - 1
    }

    /// Keeps the query of the command that was passed on as [`Desk::next_id`].
    pub(super) fn keep(&mut self, query: Asked) {
        self.pending.push((self.next_id, query));
        self.next_id += 1;
    }

    /// Answers the command that has this number.
    pub(super) fn settle(&mut self, id: u64, answer: &Answer) {
        if let Some(k) = self.pending.iter().position(|(pending, _)| *pending == id) {
            let (_, query) = self.pending.swap_remove(k);
            reply_to_call(&query, answer);
        }
    }

    /// Answers all that are under way.
    pub(super) fn settle_all(&mut self, answer: &Answer) {
        for (_, query) in self.pending.drain(..) {
            reply_to_call(&query, answer);
        }
    }
}
