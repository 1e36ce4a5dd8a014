//! What a tick leaves behind, and who may keep it.

use super::record::{Command, TickRecord};
use crate::scene::{Scene, SceneState};
use std::sync::atomic::{AtomicU8, AtomicU64};

/// Keeps what a session needs for its replay. Called on the tick thread: an implementation neither waits nor allocates.
pub trait Journal: Send {
    /// A tick is done.
    fn tick(&mut self, scene: &Scene, state: &SceneState, record: &TickRecord);
    /// A command is about to act on the state after tick `after_tick`.
    fn command(&mut self, after_tick: u64, command: Command);
    /// A full state to restart from: at the start, and after each reset.
    fn keyframe(&mut self, state: &SceneState, state_hash: u64);
}

/// What a journal lets others read while it runs.
#[derive(Debug, Default)]
pub struct JournalGauges {
    /// Bytes written.
    pub bytes: AtomicU64,
    /// Records lost.
    pub dropped: AtomicU64,
    /// One of [`recorder_state`].
    pub state: AtomicU8,
}

/// What a recorder does.
pub mod recorder_state {
    /// Nothing.
    pub const OFF: u8 = 0;
    /// It writes a file.
    pub const RECORDING: u8 = 1;
    /// It keeps the last seconds in memory.
    pub const RING: u8 = 2;
    /// The disk refused.
    pub const FAILED: u8 = 3;
}

/// Keeps nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoJournal;

impl Journal for NoJournal {
    fn tick(&mut self, _: &Scene, _: &SceneState, _: &TickRecord) {}
    fn command(&mut self, _: u64, _: Command) {}
    fn keyframe(&mut self, _: &SceneState, _: u64) {}
}
