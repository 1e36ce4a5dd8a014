//! Levels of [`SceneState::quality`](super::SceneState::quality): from each on, a tick does less.

/// Bodies iterate once a step.
pub const ONE_ITERATION: u8 = 1;
/// A quarter of the sweeps over contacts.
pub const FEWER_SWEEPS: u8 = 2;
/// Nets are published and recorded ten times rarer.
pub const RARE_NETS: u8 = 3;
/// The last level.
pub const LOWEST: u8 = RARE_NETS;
