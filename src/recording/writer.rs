//! Writes a session to MCAP.
//!
//! The file is `FILE.part` until it is finished; chunks are flushed at least four times a second, so that a killed daemon
//! loses no more than that. log_time is tick × dt: plots are even and files comparable; publish_time is the wall clock.

use super::convert::{command_to_proto, tick_to_proto};
use super::{FORMAT_VERSION, build_id, topics};
use crate::math::{Point3, SavedState};
use crate::tick::record::{Command, TickRecord};
use mcap::records::{MessageHeader, Metadata};
use palpate_proto::recording as pb;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Why a recording could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The file system.
    #[error("{path}: {source}")]
    Io {
        /// File.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// The MCAP writer.
    #[error("{path}: {source}")]
    Mcap {
        /// File.
        path: PathBuf,
        /// Cause.
        source: mcap::McapError,
    },
    /// The scene has no text form, so nothing could be replayed.
    #[error("{path}: the scene cannot be written out: {reason}")]
    Scene {
        /// File.
        path: PathBuf,
        /// Cause.
        reason: String,
    },
}

/// Running hash of all ticks of a session: two sessions with equal hashes went through the same states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SessionHash(pub u64);

impl SessionHash {
    /// Takes the next tick in.
    pub fn push(&mut self, tick: u64, state_hash: u64) {
        let mixed = (self.0 ^ state_hash).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
        self.0 = (mixed ^ tick).wrapping_mul(0xbf58_476d_1ce4_e5b9) ^ (mixed >> 31);
    }
}

/// What goes into the head of a recording.
#[derive(Clone, Debug)]
pub struct Head {
    /// Scene name.
    pub scene: String,
    /// Scene file as the user wrote it.
    pub scene_text: String,
    /// Scene with defaults and surfaces written out: what a replay builds from.
    pub effective_scene: String,
    /// Length of a tick, ns.
    pub dt_ns: u64,
    /// Tools, by index.
    pub tools: Vec<String>,
    /// Bodies, by index.
    pub bodies: Vec<BodyHead>,
    /// More metadata.
    pub extra: BTreeMap<String, String>,
}

/// What a net channel needs to know of its body.
#[derive(Clone, Debug)]
pub struct BodyHead {
    /// Id.
    pub id: String,
    /// Degree, u then v.
    pub degree: [usize; 2],
    /// Net size, u then v.
    pub count: [usize; 2],
}

/// Metadata record at the start.
pub(super) const RUN: &str = "palpate.run";
/// Metadata record at the end.
pub(super) const END: &str = "palpate.end";
/// Attachment: the scene file as written.
pub(super) const SCENE_TEXT: &str = "scene.toml";
/// Attachment: the scene as built.
pub(super) const SCENE_EFFECTIVE: &str = "scene.effective.toml";

/// Longest time between flushes.
const FLUSH_EVERY: std::time::Duration = std::time::Duration::from_millis(200);

pub(super) struct Writer {
    mcap: mcap::Writer<BufWriter<File>>,
    part: PathBuf,
    target: PathBuf,
    head: Head,
    channels: Channels,
    buffer: Vec<u8>,
    last_flush: Instant,
    pub bytes: u64,
    pub ticks: u64,
    pub last_tick: u64,
    pub last_hash: u64,
    pub session: SessionHash,
    pub skipped: u64,
}

struct Channels {
    tick: u16,
    keyframe: u16,
    command: u16,
    event: u16,
    stats: u16,
    nets: Vec<u16>,
}

fn wall_ns() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |t| t.as_nanos() as u64)
}

impl Writer {
    pub fn create(target: &Path, head: Head) -> Result<Self, WriteError> {
        let part = PathBuf::from(format!("{}.part", target.display()));
        let io = |source| WriteError::Io { path: part.clone(), source };
        if let Some(directory) = part.parent().filter(|d| !d.as_os_str().is_empty()) {
            std::fs::create_dir_all(directory).map_err(io)?;
        }
        let file = File::create(&part).map_err(io)?;
        let bad = |source| WriteError::Mcap { path: part.clone(), source };
        let mut mcap = mcap::WriteOptions::new()
            .compression(Some(mcap::Compression::Lz4))
            .chunk_size(Some(64 << 10))
            .library(format!("palpate {}", env!("CARGO_PKG_VERSION")))
            .create(BufWriter::new(file))
            .map_err(bad)?;
        let mut run = BTreeMap::from([
            ("format".to_string(), FORMAT_VERSION.to_string()),
            ("build".to_string(), build_id()),
            ("scene".to_string(), head.scene.clone()),
            ("scene_sha256".to_string(), sha256_hex(&head.scene_text)),
            ("dt_ns".to_string(), head.dt_ns.to_string()),
            ("tools".to_string(), head.tools.join(",")),
            ("bodies".to_string(), head.bodies.iter().map(|body| body.id.as_str()).collect::<Vec<_>>().join(",")),
            ("started_unix_ns".to_string(), wall_ns().to_string()),
        ]);
        run.extend(head.extra.clone());
        mcap.write_metadata(&Metadata { name: RUN.into(), metadata: run }).map_err(bad)?;
        for (name, text) in [(SCENE_TEXT, &head.scene_text), (SCENE_EFFECTIVE, &head.effective_scene)] {
            let attachment = mcap::Attachment {
                log_time: 0,
                create_time: wall_ns(),
                name: name.into(),
                media_type: "application/toml".into(),
                data: text.as_bytes().into(),
            };
            mcap.attach(&attachment).map_err(bad)?;
        }
        let channels = Channels::add(&mut mcap, &head).map_err(bad)?;
        // Readable from the first moment on, and a full disk shows before anyone relies on the file.
        mcap.flush().map_err(bad)?;
        Ok(Self {
            mcap,
            part,
            target: target.to_owned(),
            head,
            channels,
            buffer: Vec::new(),
            last_flush: Instant::now(),
            bytes: 0,
            ticks: 0,
            last_tick: 0,
            last_hash: 0,
            session: SessionHash::default(),
            skipped: 0,
        })
    }

    fn put(&mut self, channel_id: u16, tick: u64, message: &impl prost::Message) -> Result<(), WriteError> {
        self.buffer.clear();
        message.encode(&mut self.buffer).expect("a Vec grows");
        // Saturates for numbers that only a damaged file can hold.
        let log_time = tick.saturating_mul(self.head.dt_ns);
        let header = MessageHeader { channel_id, sequence: tick as u32, log_time, publish_time: wall_ns() };
        self.bytes += self.buffer.len() as u64;
        self.mcap.write_to_known_channel(&header, &self.buffer).map_err(|source| self.mcap_error(source))
    }

    fn mcap_error(&self, source: mcap::McapError) -> WriteError {
        WriteError::Mcap { path: self.part.clone(), source }
    }

    pub fn tick(&mut self, record: &TickRecord) -> Result<(), WriteError> {
        self.ticks += 1;
        self.skipped += u64::from(record.skipped);
        (self.last_tick, self.last_hash) = (record.output.tick, record.output.state_hash);
        self.session.push(record.output.tick, record.output.state_hash);
        let message = tick_to_proto(record, self.head.tools.len());
        self.put(self.channels.tick, record.output.tick, &message)
    }

    /// `commands`: how many of the commands after `tick` the state holds already.
    pub fn keyframe(
        &mut self,
        tick: u64,
        state_hash: u64,
        commands: u32,
        saved: &SavedState,
    ) -> Result<(), WriteError> {
        let (words, floats) = (saved.words.clone(), saved.floats.clone());
        let message = pb::Keyframe { tick, state_hash, words, floats, commands };
        self.put(self.channels.keyframe, tick, &message)
    }

    pub fn command(&mut self, after_tick: u64, command: Command) -> Result<(), WriteError> {
        self.put(self.channels.command, after_tick, &command_to_proto(after_tick, command))
    }

    pub fn event(&mut self, tick: u64, kind: &str, detail: &str) -> Result<(), WriteError> {
        self.put(self.channels.event, tick, &pb::Event { tick, kind: kind.into(), detail: detail.into() })
    }

    pub fn stats(&mut self, stats: &pb::Stats) -> Result<(), WriteError> {
        self.put(self.channels.stats, stats.tick, stats)
    }

    pub fn net(&mut self, tick: u64, revision: u64, body: usize, points: &[Point3]) -> Result<(), WriteError> {
        let head = &self.head.bodies[body];
        let message = pb::ControlNet {
            tick,
            revision,
            body: head.id.clone(),
            degree_u: head.degree[0] as u32,
            degree_v: head.degree[1] as u32,
            count_u: head.count[0] as u32,
            count_v: head.count[1] as u32,
            points: points.iter().flat_map(|p| [p.x, p.y, p.z]).collect(),
        };
        self.put(self.channels.nets[body], tick, &message)
    }

    /// Flushes when it is time, so that a kill loses little.
    pub fn flush_if_due(&mut self) -> Result<(), WriteError> {
        if self.last_flush.elapsed() >= FLUSH_EVERY {
            self.last_flush = Instant::now();
            self.mcap.flush().map_err(|source| self.mcap_error(source))?;
        }
        Ok(())
    }

    /// Ends the file and gives it its name.
    pub fn finish(mut self, dropped: u64, clean: bool) -> Result<PathBuf, WriteError> {
        let end = BTreeMap::from([
            ("last_tick".to_string(), self.last_tick.to_string()),
            ("ticks".to_string(), self.ticks.to_string()),
            ("final_hash".to_string(), format!("{:016x}", self.last_hash)),
            ("session_hash".to_string(), format!("{:016x}", self.session.0)),
            ("dropped_records".to_string(), dropped.to_string()),
            ("skipped_ticks".to_string(), self.skipped.to_string()),
            ("clean".to_string(), (clean && dropped == 0).to_string()),
        ]);
        let bad = |source| WriteError::Mcap { path: self.part.clone(), source };
        self.mcap.write_metadata(&Metadata { name: END.into(), metadata: end }).map_err(bad)?;
        self.mcap.finish().map_err(bad)?;
        let io = |source| WriteError::Io { path: self.part.clone(), source };
        let mut file = self.mcap.into_inner();
        std::io::Write::flush(&mut file).map_err(io)?;
        file.get_ref().sync_all().map_err(io)?;
        std::fs::rename(&self.part, &self.target).map_err(io)?;
        Ok(self.target)
    }
}

impl Channels {
    fn add(mcap: &mut mcap::Writer<BufWriter<File>>, head: &Head) -> mcap::McapResult<Self> {
        let mut channel = |topic: &str, message: &str| {
            let schema = mcap.add_schema(&format!("palpate.v1.{message}"), "protobuf", pb::DESCRIPTORS)?;
            mcap.add_channel(schema, topic, "protobuf", &BTreeMap::new())
        };
        Ok(Self {
            tick: channel(topics::TICK, "Tick")?,
            keyframe: channel(topics::KEYFRAME, "Keyframe")?,
            command: channel(topics::COMMAND, "Command")?,
            event: channel(topics::EVENT, "Event")?,
            stats: channel(topics::STATS, "Stats")?,
            nets: head
                .bodies
                .iter()
                .map(|body| channel(&format!("/body/{}/net", body.id), "ControlNet"))
                .collect::<Result<_, _>>()?,
        })
    }
}

fn sha256_hex(text: &str) -> String {
    use sha2::Digest as _;
    sha2::Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}
