//! Sessions on disk: MCAP with Protobuf channels that any MCAP tool opens.
//!
//! ```text
//! tick thread ─▶ RecorderPort ═bounded rings═▶ Stream ─in order─▶ Keeper ─┬▶ Parts ─▶ SessionFile ─▶ FILE.part ─▶ FILE
//! bus thread ──▶ Archive: events, record_start/stop, snapshot ───────────▶ ├▶ Memory (the last seconds)
//!                                                                         └▶ snapshots ─▶ SessionFile
//! FILE ─▶ Session ─▶ Follower (reader) ─▶ replay, figures, play, info, export, recover
//! ```

mod channel;
pub mod chart;
mod container;
mod disk;
mod export;
mod figures;
mod file;
mod file_info;
mod format;
mod head;
mod info;
mod inputs;
mod keeper;
mod memory;
mod message;
mod parts;
mod play;
mod port;
mod reader;
mod recorder;
mod recover;
mod replay;
mod report;
mod rerun;
mod self_check;
mod stream;
mod thin;
mod totals;
mod views;

pub use channel::{EventRecord, Happening, Keyframe, NetRecord, OtherRecord, Topic, channel_table};
pub use disk::{Disk, DiskFile, DiskSync, DiskTask, FileSystem};
pub use disk::{create_new, give_name};
pub use export::{
    BucketedCurve, ExportError, Range, Series, USUAL, csv, explain, net_at, plots, ros2_bag, series,
};
pub use figures::{
    BodyFigures, Deviation, Figures, FiguresError, HashDifference, Hashes, Simulation, Tolerances,
    ToolFigures, deviations, simulate, simulate_figures,
};
pub use file::part_of;
pub use file_info::{ChannelInfo, FileInfo};
pub use format::WriteError;
pub use info::{Info, Origin, computed_info, info};
pub use inputs::{InputBlock, InputsError, Reduced, RunError, Start, record_again, reduce};
pub use message::SessionHash;
pub use message::wall_ns;
pub use parts::Split;
pub use play::{PlayError, PlayReport, PlaySettings, Player, played_scene};
pub use port::RecorderPort;
pub use reader::{Contents, Follower, Place, ReadError, Session, SessionHeader};
pub use recorder::{Recorder, RecorderSettings, SceneChanges, SteppedRecorder, default_path};
pub use recover::RecoverError;
pub use recover::{Recovered, recover};
pub use replay::{
    Difference, Divergence, ReplayError, ReplayOptions, ReplayReport, recorded_scene, replay,
    replay_with,
};
pub use report::{RecordingReport, RecordingSummary};
pub use self_check::{SelfCheck, SelfCheckPort, SelfCheckReport, SelfDifference};
pub use thin::{Thinned, thinned};
pub use totals::{StageInfo, ToolInfo, Totals};
pub use totals::{stage_infos, write_stages};
pub use views::{LOG as LOG_VIEW, Pictures, ViewTopic, log as log_view, stamp_of};

/// Layout of recordings; readers refuse others.
pub const FORMAT_VERSION: u32 = 2;

/// Hash of the sources that decide what a run of a batch gives: those of a tick, simulated devices, motions, figures.
pub const RUN_SOURCE: &str = env!("PALPATE_RUN_SOURCE");
/// Target that this was compiled for.
pub const TARGET: &str = env!("PALPATE_TARGET");
/// Compiler, with its version.
pub const RUSTC: &str = env!("PALPATE_RUSTC");

/// What this program was built from: recordings made by another build may replay with other bits.
pub fn build_id() -> String {
    let profile = if cfg!(debug_assertions) {
        "debug"
    } else {
        "release"
    };
    format!(
        "palpate {} source {} {profile}",
        env!("CARGO_PKG_VERSION"),
        env!("PALPATE_SOURCE")
    )
}
