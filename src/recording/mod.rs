//! Sessions on disk: MCAP with Protobuf channels that any MCAP tool opens.
//!
//! ```text
//! tick thread ─▶ RecorderPort ═bounded rings═▶ recorder thread ─▶ Writer ─▶ FILE.part ─finish─▶ FILE
//! FILE ─▶ Session (reader) ─▶ replay, info, recover, play
//! ```

mod convert;
mod info;
mod play;
mod reader;
mod recorder;
mod recover;
mod replay;
mod writer;

pub use info::{Info, info};
pub(crate) use info::{stage_infos, write_stages};
pub use play::{PlayError, PlayReport, PlaySettings, Player, played_scene};
pub use reader::{ReadError, Session, SessionHeader};
pub use recorder::{Recorder, RecorderPort, RecorderSettings, RecordingSummary, default_path};
pub use recover::RecoverError;
pub use recover::{Recovered, recover};
pub use replay::{Difference, ReplayError, ReplayReport, replay};
pub use writer::{SessionHash, WriteError};

/// Topics.
pub(crate) mod topics {
    /// Every tick.
    pub const TICK: &str = "/sim/tick";
    /// Full states.
    pub const KEYFRAME: &str = "/sim/keyframe";
    /// Commands.
    pub const COMMAND: &str = "/sim/command";
    /// Events.
    pub const EVENT: &str = "/sim/event";
    /// Loop statistics.
    pub const STATS: &str = "/sim/stats";
}

/// Layout of recordings; readers refuse others.
pub const FORMAT_VERSION: u32 = 1;

/// What this program was built from: recordings made by another build may replay with other bits.
pub fn build_id() -> String {
    let commit = option_env!("PALPATE_GIT_COMMIT").unwrap_or("unknown");
    let profile = if cfg!(debug_assertions) { "debug" } else { "release" };
    format!("palpate {} {commit} {} {profile}", env!("CARGO_PKG_VERSION"), std::env::consts::ARCH)
}
