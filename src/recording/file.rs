//! One MCAP file.
//!
//! It is `FILE.part` until it is finished; chunks are flushed five times a second, so that a killed
//! daemon loses no more than that, and reach the disk once a second, which is what a power cut takes;
//! nothing written is ever touched again. log_time is tick ×
//! dt: plots are even and files comparable; publish_time is the wall clock.

use super::channel::Channels;
use super::disk::{Disk, DiskFile};
use super::format::{
    END, RUN, SCENE_EFFECTIVE, SCENE_TEXT, SNAPSHOT, TOOLS, TOTALS, WriteError, checked, options,
};
use super::head::Head;
use super::message::{Mark, Message, SessionHash, wall_ns};
use super::totals::Tally;
use super::views::Views;
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest time between flushes.
const FLUSH_EVERY: Duration = Duration::from_millis(200);
/// Largest chunk before compression, bytes.
const CHUNK: u64 = 256 << 10;

/// An open file.
pub(super) struct SessionFile {
    mcap: mcap::Writer<NoSeek<Box<dyn DiskFile>>>,
    part: PathBuf,
    target: PathBuf,
    dt_ns: u64,
    channels: Channels,
    views: Option<Views>,
    last_flush: Instant,
    /// A keyframe was written: without one, nothing can be replayed.
    urgent: bool,
    /// Message bytes before compression.
    pub bytes: u64,
    pub ticks: u64,
    pub first_tick: u64,
    pub last_tick: u64,
    pub last_hash: u64,
    pub session: SessionHash,
    skipped: u64,
    tally: Tally,
}

/// `FILE.part`.
pub(crate) fn part_of(target: &Path) -> PathBuf {
    PathBuf::from(format!("{}.part", target.display()))
}

impl SessionFile {
    /// Makes `target.part` with its head. `position` says which part of a session this is.
    pub fn create(
        disk: &dyn Disk,
        target: &Path,
        head: &Head,
        position: &[(&str, String)],
        views: Option<Views>,
    ) -> Result<Self, WriteError> {
        Self::create_as(disk, part_of(target), target, head, position, views)
    }

    /// The same under another name while it is written.
    pub fn create_as(
        disk: &dyn Disk,
        part: PathBuf,
        target: &Path,
        head: &Head,
        position: &[(&str, String)],
        views: Option<Views>,
    ) -> Result<Self, WriteError> {
        if target.exists() {
            let advice = "move it away, or name another file";
            return Err(WriteError::Exists {
                path: target.to_owned(),
                advice,
            });
        }
        let file = disk.create(&part).map_err(|source| match source.kind() {
            std::io::ErrorKind::AlreadyExists => {
                let advice = "a killed daemon left it, or another process is writing it: `palpate recover` completes it";
                WriteError::Exists { path: part.clone(), advice }
            }
            _ => WriteError::Io { path: part.clone(), source },
        })?;
        let written = Self::begin(file, head, position).and_then(|(mut mcap, channels)| {
            let views = views.map(|views| views.declared(&mut mcap)).transpose()?;
            // Readable from the first moment on, and a full disk shows before anyone relies on the
            // file.
            mcap.flush()?;
            Ok((mcap, channels, views))
        });
        let (mcap, channels, views) = written.map_err(|source| {
            // Nothing is in it yet.
            let _ = std::fs::remove_file(&part);
            WriteError::mcap(&part, source)
        })?;
        Ok(Self {
            mcap,
            part,
            target: target.to_owned(),
            dt_ns: head.dt_ns,
            channels,
            views,
            last_flush: disk.now(),
            urgent: false,
            bytes: 0,
            ticks: 0,
            first_tick: 0,
            last_tick: 0,
            last_hash: 0,
            session: SessionHash::default(),
            skipped: 0,
            tally: Tally::new(&head.tools),
        })
    }

    #[allow(clippy::type_complexity)]
    fn begin(
        file: Box<dyn DiskFile>,
        head: &Head,
        position: &[(&str, String)],
    ) -> mcap::McapResult<(mcap::Writer<NoSeek<Box<dyn DiskFile>>>, Channels)> {
        let mut mcap = options()
            .compression(Some(mcap::Compression::Zstd))
            .compression_level(1)
            .compression_threads(0)
            .chunk_size(Some(CHUNK))
            .disable_seeking(true)
            .create(NoSeek::new(file))?;
        let mut run = head.metadata();
        run.extend(
            position
                .iter()
                .map(|(key, value)| ((*key).to_owned(), value.clone())),
        );
        mcap.write_metadata(&Metadata {
            name: RUN.into(),
            metadata: checked(run),
        })?;
        let toml = "application/toml";
        for (name, kind, bytes) in [
            (SCENE_TEXT, toml, head.scene_text.as_bytes()),
            (SCENE_EFFECTIVE, toml, head.effective_scene.as_bytes()),
            (SNAPSHOT, "application/octet-stream", &head.shown.snapshot),
            (TOOLS, "application/json", head.shown.tools.as_bytes()),
        ] {
            if bytes.is_empty() {
                continue;
            }
            let attachment = mcap::Attachment {
                log_time: 0,
                create_time: wall_ns(),
                name: name.into(),
                media_type: kind.into(),
                data: bytes.into(),
            };
            mcap.attach(&attachment)?;
        }
        let bodies: Vec<&str> = head.bodies.iter().map(|body| body.id.as_str()).collect();
        let channels = Channels::announce(&mut mcap, &bodies)?;
        Ok((mcap, channels))
    }

    /// Where it will be.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Writes a message, and what is shown of it.
    pub fn put(&mut self, message: &Message) -> Result<(), WriteError> {
        match message.mark {
            Mark::Tick {
                state_hash,
                skipped,
            } => {
                if self.ticks == 0 {
                    self.first_tick = message.tick;
                }
                self.ticks += 1;
                self.skipped += u64::from(skipped);
                (self.last_tick, self.last_hash) = (message.tick, state_hash);
                self.session.push(message.tick, state_hash);
            }
            Mark::Keyframe { .. } => self.urgent = true,
            Mark::None => {}
        }
        let channel_id = self.channels.number(message.topic, message.body);
        // Saturates for numbers that only a damaged file can hold.
        let log_time = message.tick.saturating_mul(self.dt_ns);
        let header = MessageHeader {
            channel_id,
            sequence: message.tick as u32,
            log_time,
            publish_time: message.wall_ns,
        };
        self.bytes += message.data.len() as u64;
        self.tally.count(channel_id, message.data.len());
        let summed = self.tally.write(message);
        debug_assert!(summed.is_ok(), "a message of ours: {summed:?}");
        let mut written = self.mcap.write_to_known_channel(&header, &message.data);
        if let Some(views) = &mut self.views {
            let (mcap, bytes) = (&mut self.mcap, &mut self.bytes);
            let tally = &mut self.tally;
            written = written.and_then(|()| {
                views.show(message, |channel_id, data| {
                    *bytes += data.len() as u64;
                    tally.count(channel_id, data.len());
                    mcap.write_to_known_channel(
                        &MessageHeader {
                            channel_id,
                            ..header
                        },
                        data,
                    )
                })
            });
        }
        written.map_err(|source| self.mcap_error(source))
    }

    fn mcap_error(&self, source: mcap::McapError) -> WriteError {
        WriteError::mcap(&self.part, source)
    }

    /// Flushes when it is time, so that a kill loses little.
    pub fn flush_if_due(&mut self, now: Instant) -> Result<(), WriteError> {
        let since = now.saturating_duration_since(self.last_flush);
        if std::mem::take(&mut self.urgent) || since >= FLUSH_EVERY {
            self.last_flush = now;
            self.mcap
                .flush()
                .map_err(|source| self.mcap_error(source))?;
        }
        Ok(())
    }

    /// Ends the file and gives it its name.
    pub fn finish(
        mut self,
        dropped: u64,
        clean: bool,
        position: &[(&str, String)],
    ) -> Result<PathBuf, WriteError> {
        let mut end = BTreeMap::from([
            ("first_tick".to_string(), self.first_tick.to_string()),
            ("last_tick".to_string(), self.last_tick.to_string()),
            ("ticks".to_string(), self.ticks.to_string()),
            ("final_hash".to_string(), format!("{:016x}", self.last_hash)),
            (
                "session_hash".to_string(),
                format!("{:016x}", self.session.0),
            ),
            ("dropped_records".to_string(), dropped.to_string()),
            ("skipped_ticks".to_string(), self.skipped.to_string()),
            ("clean".to_string(), (clean && dropped == 0).to_string()),
        ]);
        end.extend(
            position
                .iter()
                .map(|(key, value)| ((*key).to_owned(), value.clone())),
        );
        let bad = |source| WriteError::mcap(&self.part, source);
        // Numbers that JSON does not have, or a message that was not ours to sum up: readers count
        // for themselves.
        if let Ok(totals) = serde_json::to_vec(&self.tally.finish()) {
            let attachment = mcap::Attachment {
                log_time: self.last_tick.saturating_mul(self.dt_ns),
                create_time: wall_ns(),
                name: TOTALS.into(),
                media_type: "application/json".into(),
                data: totals.into(),
            };
            self.mcap.attach(&attachment).map_err(bad)?;
        }
        self.mcap
            .write_metadata(&Metadata {
                name: END.into(),
                metadata: checked(end),
            })
            .map_err(bad)?;
        self.mcap.finish().map_err(bad)?;
        let mut file = self.mcap.into_inner().into_inner();
        let io = |source| WriteError::Io {
            path: self.part.clone(),
            source,
        };
        file.flush().and_then(|()| file.sync()).map_err(io)?;
        // A hard link fails where a rename would overwrite what came there meanwhile.
        match std::fs::hard_link(&self.part, &self.target) {
            Ok(()) => std::fs::remove_file(&self.part).map_err(io)?,
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {
                let advice = "another program created it in the meantime; the finished recording is in the .part file next to it";
                return Err(WriteError::Exists {
                    path: self.target,
                    advice,
                });
            }
            Err(_) => std::fs::rename(&self.part, &self.target).map_err(io)?,
        }
        Ok(self.target)
    }
}
