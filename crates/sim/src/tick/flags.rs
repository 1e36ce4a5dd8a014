//! Bits of [`ToolOutput::flags`](super::record::ToolOutput::flags); the wire uses the same.

/// The newest pose that was believed is older than the stale limit; the force ramps to zero.
pub const STALE: u32 = 1;
/// The force was limited: to what the device can bear or, with `RAMPING`, to what the limit is on its way up.
/// Not set while the force is on its way to none, or there (stale, refused, paused).
pub const SATURATED: u32 = 1 << 1;
/// Bodies stand still.
pub const PAUSED: u32 = 1 << 2;
/// This tick's pose was refused.
pub const REFUSED: u32 = 1 << 3;
/// The force limit moves: up to its full value, or down to zero. At rest at either it is not set.
pub const RAMPING: u32 = 1 << 4;
/// The force was not finite and was made zero, or the tick before set a body back to rest: the
/// force is safe, not right.
pub const FAULT: u32 = 1 << 5;
/// The tool holds on to what it grabbed.
pub const GRABBING: u32 = 1 << 6;
/// A damper was added to keep the loop from making energy.
pub const DAMPED: u32 = 1 << 7;
/// No force: the tool was seated inside a body, and what its contacts would give was not small once since then.
pub const WITHHELD: u32 = 1 << 8;
/// The force is less accurate than the scene asks for: the step of a body that the tool presses, or that such a
/// body presses, fell back to another matrix or was shortened, quality is lowered, or the force may be off by more than
/// 5 % and 0.02 N.
pub const DEGRADED: u32 = 1 << 9;
