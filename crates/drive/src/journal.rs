//! What a tick leaves behind, and who may keep it.

use super::nets::NetPool;
use palpate_sim::scene::Scene;
use palpate_sim::tick::SceneState;
use palpate_sim::tick::record::{Command, TickRecord};
use std::sync::atomic::{AtomicU8, AtomicU64};

/// Keeps what a session needs for its replay. Called on the tick thread: an implementation neither
/// waits nor allocates.
pub trait Journal: Send {
    /// A tick is done. `nets` gives its control nets, which others may have asked for as well.
    fn tick(&mut self, scene: &Scene, state: &SceneState, record: &TickRecord, nets: &mut NetPool);
    /// A command is about to act on the state after tick `after_tick`.
    fn command(&mut self, after_tick: u64, command: Command);
    /// A full state to restart from: at the start, and after each reset.
    fn keyframe(&mut self, state: &SceneState, state_hash: u64);
    /// Nets of a body that it may hold at once.
    fn nets_held(&self) -> usize {
        0
    }
}

/// Values of [`JournalGauges::state`].
pub mod keeping {
    /// Nothing is kept.
    pub const OFF: u8 = 0;
    /// A file is being written.
    pub const RECORDING: u8 = 1;
    /// The last seconds are kept in memory.
    pub const RING: u8 = 2;
    /// The disk refused.
    pub const FAILED: u8 = 3;
}

/// What a journal lets others read while it runs.
#[derive(Debug, Default)]
pub struct JournalGauges {
    /// One of [`keeping`].
    pub state: AtomicU8,
    /// Bytes written.
    pub bytes: AtomicU64,
    /// Records lost.
    pub dropped: AtomicU64,
}

/// Keeps nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoJournal;

impl Journal for NoJournal {
    fn tick(&mut self, _: &Scene, _: &SceneState, _: &TickRecord, _: &mut NetPool) {}
    fn command(&mut self, _: u64, _: Command) {}
    fn keyframe(&mut self, _: &SceneState, _: u64) {}
}
