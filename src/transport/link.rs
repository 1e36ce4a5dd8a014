//! The bus's ends of what goes to the loop, and of what comes back for it.

use palpate_drive::ports::{CommandRequest, Receipt};
use palpate_drive::swap::Swap;
use palpate_sim::tick::record::Command;
use std::sync::{Arc, OnceLock};
use std::thread::Thread;

/// Commands and scenes to the loop, receipts and scenes it has left from there.
pub(super) struct LoopLink {
    pub(super) commands: rtrb::Producer<CommandRequest>,
    pub(super) receipts: rtrb::Consumer<Receipt>,
    pub(super) swaps: rtrb::Producer<Box<Swap>>,
    pub(super) retired: rtrb::Consumer<Box<Swap>>,
    pub(super) tick_thread: Arc<OnceLock<Thread>>,
}

impl LoopLink {
    /// Passes a command on; its receipt has the same number.
    ///
    /// # Errors
    /// Too many are waiting.
    pub(super) fn command(&mut self, id: u64, command: Command) -> Result<(), String> {
        self.commands
            .push(CommandRequest { id, command })
            .map_err(|_| "too many commands are waiting; try again".to_owned())
    }

    /// Hands over the next scene; false if the loop has not taken the last one yet.
    pub(super) fn swap(&mut self, swap: Box<Swap>) -> bool {
        let taken = self.swaps.push(swap).is_ok();
        if taken && let Some(thread) = self.tick_thread.get() {
            // A loop in lockstep may sleep.
            thread.unpark();
        }
        taken
    }

    /// Drops scenes that the loop has left, elsewhere: a large one takes its time.
    pub(super) fn drop_retired(&mut self) {
        while let Ok(retired) = self.retired.pop() {
            let _ = std::thread::Builder::new()
                .name("palpate-retired".into())
                .spawn(move || drop(retired));
        }
    }
}
