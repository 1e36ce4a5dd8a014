//! Recording and scene changes allocate nothing on the tick thread. A program of its own, because
//! the counting allocator replaces that of the whole process.

#[path = "../../crates/sim/tests/common/mod.rs"]
mod common;
#[path = "../../crates/sim/tests/common/counting.rs"]
mod counting;
mod drive;
#[path = "../daemon/common/live.rs"]
mod live;
mod recorder;
mod scene_changes;
