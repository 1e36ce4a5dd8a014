//! One recording file.
//!
//! It is `FILE.part` until it is finished. Ten times a second a chunk is ended and handed to the
//! system, so that a killed daemon loses no more than that, however slow the disk is. Once a second
//! the disk is asked to have what was handed over: a power cut costs what was written since the last
//! time that it was asked and has answered. No one waits for its answer, and nothing written is ever
//! touched again. log_time is tick × dt: plots are even and files comparable; publish_time is the
//! wall clock.

use super::channel::{Channels, Topic};
use super::container::{Container, MessageHead};
use super::disk::{Disk, DiskFile, DiskSync, DiskTask};
use super::format::{
    END, LIBRARY, RUN, SCENE_EFFECTIVE, SCENE_TEXT, SNAPSHOT, TOOLS, TOTALS, WriteError, checked,
};
use super::head::Head;
use super::message::{Mark, Message, SessionHash, wall_ns};
use super::report::RecordingSummary;
use super::totals::Tally;
use super::views::Views;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest time between flushes.
const FLUSH_EVERY: Duration = Duration::from_millis(100);
/// Time between two requests to the disk; longer when it has not answered the first by then.
const SYNC_EVERY: Duration = Duration::from_secs(1);
/// An answer that takes longer is worth a word.
const SLOW: Duration = Duration::from_secs(3);

/// An open file.
pub(super) struct SessionFile {
    mcap: Container<Box<dyn Write + Send>>,
    sync: Syncing,
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

/// What the disk was asked to have, and has.
struct Syncing {
    disk: Box<dyn DiskSync>,
    /// When it was asked last, and up to which byte.
    asked: (Instant, u64),
    /// It has not answered yet.
    under_way: bool,
    /// Last tick that was written before it was asked, and before it was asked and answered.
    asked_tick: u64,
    safe_tick: u64,
    /// A slow answer was reported.
    reported: bool,
}

/// `FILE.part`.
pub fn part_of(target: &Path) -> PathBuf {
    let mut part = target.as_os_str().to_owned();
    part.push(".part");
    part.into()
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
            io::ErrorKind::AlreadyExists => {
                let advice = "a killed daemon left it, or another process is writing it: `palpate recover` completes it";
                WriteError::Exists { path: part.clone(), advice }
            }
            _ => WriteError::Io { path: part.clone(), source },
        })?;
        let DiskFile { bytes, sync } = file;
        let written = Self::begin(bytes, head, position, views);
        let (mcap, channels, views) = written.map_err(|source| {
            // Nothing is in it yet.
            let _ = std::fs::remove_file(&part);
            let path = part.clone();
            WriteError::Io { path, source }
        })?;
        let now = disk.now();
        Ok(Self {
            mcap,
            sync: Syncing {
                disk: sync,
                asked: (now, 0),
                under_way: false,
                asked_tick: 0,
                safe_tick: 0,
                reported: false,
            },
            part,
            target: target.to_owned(),
            dt_ns: head.dt_ns,
            channels,
            views,
            last_flush: now,
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
    fn begin<W: Write>(
        to: W,
        head: &Head,
        position: &[(&str, String)],
        views: Option<Views>,
    ) -> io::Result<(Container<W>, Channels, Option<Views>)> {
        let mut mcap = Container::new(to, LIBRARY)?;
        let mut run = head.metadata();
        run.extend(
            position
                .iter()
                .map(|(key, value)| ((*key).to_owned(), value.clone())),
        );
        mcap.metadata(RUN, &checked(run))?;
        let toml = "application/toml";
        for (name, kind, bytes) in [
            (SCENE_TEXT, toml, head.scene_text.as_bytes()),
            (SCENE_EFFECTIVE, toml, head.effective_scene.as_bytes()),
            (SNAPSHOT, "application/octet-stream", &head.shown.snapshot),
            (TOOLS, "application/json", head.shown.tools.as_bytes()),
        ] {
            if !bytes.is_empty() {
                mcap.attach(name, kind, 0, wall_ns(), bytes)?;
            }
        }
        let bodies: Vec<&str> = head.bodies.iter().map(|body| body.id.as_str()).collect();
        let channels = Channels::announce(&mut mcap, &Topic::RECORDED, &bodies);
        let views = views.map(|views| views.declared(&mut mcap));
        // Readable from the first moment on, and a full disk shows before anyone relies on the file.
        mcap.end_chunk()?;
        mcap.hand_over()?;
        Ok((mcap, channels, views))
    }

    /// Bytes that a file has before its first message.
    ///
    /// # Errors
    /// None that a disk makes.
    pub fn head_bytes(head: &Head, views: Option<Views>) -> io::Result<u64> {
        Ok(Self::begin(io::sink(), head, &[], views)?.0.len())
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
        let channel = self.channels.number(message.topic, message.body);
        let head = MessageHead {
            channel,
            sequence: message.tick as u32,
            // Saturates for numbers that only a damaged file can hold.
            log_time: message.tick.saturating_mul(self.dt_ns),
            publish_time: message.wall_ns,
        };
        self.bytes += message.data.len() as u64;
        self.tally.count(channel, message.data.len());
        let summed = self.tally.write(message);
        debug_assert!(summed.is_ok(), "a message of ours: {summed:?}");
        let mut written = self.mcap.message(head, &message.data);
        if let Some(views) = &mut self.views {
            let (mcap, bytes) = (&mut self.mcap, &mut self.bytes);
            let tally = &mut self.tally;
            written = written.and_then(|()| {
                views.show(message, |channel, data| {
                    *bytes += data.len() as u64;
                    tally.count(channel, data.len());
                    mcap.message(MessageHead { channel, ..head }, data)
                })
            });
        }
        written.map_err(|source| self.io(source))
    }

    fn io(&self, source: io::Error) -> WriteError {
        let path = self.part.clone();
        WriteError::Io { path, source }
    }

    /// Bytes on disk, and in memory on their way there.
    pub fn len(&self) -> u64 {
        self.mcap.len()
    }

    /// Hands over what is there when it is time, so that a kill loses little, and asks the disk to
    /// have it, so that a power cut does not lose much more.
    pub fn flush_if_due(&mut self, now: Instant) -> Result<(), WriteError> {
        let since = now.saturating_duration_since(self.last_flush);
        let mut flushed = Ok(());
        if std::mem::take(&mut self.urgent) || since >= FLUSH_EVERY {
            self.last_flush = now;
            flushed = self.mcap.end_chunk();
        }
        flushed
            .and_then(|()| self.mcap.hand_over())
            .map_err(|source| self.io(source))?;
        self.sync
            .look(now, self.mcap.len(), self.last_tick, &self.part)
    }

    /// Ends the file, and asks the disk for it under its name.
    pub fn finish(
        mut self,
        dropped: u64,
        clean: bool,
        position: &[(&str, String)],
    ) -> Result<ClosingFile, WriteError> {
        let mut end = BTreeMap::from([
            ("first_tick".to_string(), self.first_tick.to_string()),
            ("last_tick".to_string(), self.last_tick.to_string()),
            ("ticks".to_string(), self.ticks.to_string()),
            ("final_hash".to_string(), format!("{:016x}", self.last_hash)),
            ("session_hash".to_string(), self.session.to_string()),
            ("dropped_records".to_string(), dropped.to_string()),
            ("skipped_ticks".to_string(), self.skipped.to_string()),
            ("clean".to_string(), (clean && dropped == 0).to_string()),
        ]);
        end.extend(
            position
                .iter()
                .map(|(key, value)| ((*key).to_owned(), value.clone())),
        );
        // Numbers that JSON does not have, or a message that was not ours to sum up: readers count
        // for themselves.
        let totals = serde_json::to_vec(&self.tally.finish()).ok();
        let time = self.last_tick.saturating_mul(self.dt_ns);
        let attached = totals.map_or(Ok(()), |totals| {
            let json = "application/json";
            self.mcap.attach(TOTALS, json, time, wall_ns(), &totals)
        });
        let ended = attached.and_then(|()| self.mcap.metadata(END, &checked(end)));
        let ended = ended.and_then(|()| self.mcap.finish());
        let path = self.part.clone();
        let len = ended.map_err(|source| WriteError::Io { path, source })?;
        let mut sync = self.sync;
        sync.disk.begin(DiskTask::Sync);
        sync.disk.begin(DiskTask::Name {
            part: self.part.clone(),
            target: self.target.clone(),
        });
        Ok(ClosingFile {
            syncs: 1 + u32::from(sync.under_way),
            sync,
            part: self.part,
            len,
            summary: RecordingSummary {
                path: self.target,
                ticks: self.ticks,
                first_tick: self.first_tick,
                last_tick: self.last_tick,
                final_hash: self.last_hash,
                session_hash: self.session.0,
                dropped,
                bytes: self.bytes,
                deleted: false,
            },
        })
    }
}

impl Syncing {
    /// Takes the disk's answer, and asks again when it is time. `written`: bytes so far.
    fn look(
        &mut self,
        now: Instant,
        written: u64,
        last_tick: u64,
        part: &Path,
    ) -> Result<(), WriteError> {
        let since = now.saturating_duration_since(self.asked.0);
        if self.under_way {
            match self.disk.ended(Duration::ZERO) {
                None if since >= SLOW && !std::mem::replace(&mut self.reported, true) => {
                    tracing::warn!(
                        file = %part.display(), after_tick = self.safe_tick,
                        "the disk has not answered for {} s: recording goes on, but a power cut now would cost what was recorded since",
                        since.as_secs()
                    );
                }
                None => {}
                Some(Err(source)) => return Err(self.lost(part, source)),
                Some(Ok(())) => (self.under_way, self.safe_tick) = (false, self.asked_tick),
            }
        }
        if !self.under_way && since >= SYNC_EVERY && written > self.asked.1 {
            self.disk.begin(DiskTask::Sync);
            (self.asked, self.asked_tick) = ((now, written), last_tick);
            (self.under_way, self.reported) = (true, false);
        }
        Ok(())
    }

    /// After a sync that failed, what it was to bring to the disk is on the disk, in memory, or gone:
    /// the system does not say.
    fn lost(&self, part: &Path, source: io::Error) -> WriteError {
        WriteError::Sync {
            path: part.to_owned(),
            after_tick: self.safe_tick,
            source,
        }
    }
}

/// A file that is written, and waits for the disk and its name.
pub(super) struct ClosingFile {
    sync: Syncing,
    /// Answers that come before that to its naming.
    syncs: u32,
    part: PathBuf,
    /// Bytes on disk.
    pub len: u64,
    pub summary: RecordingSummary,
}

impl ClosingFile {
    /// What came of it; `None` if the disk does not answer within this time.
    pub fn ended(&mut self, within: Duration) -> Option<Result<(), WriteError>> {
        while self.syncs > 0 {
            if let Err(source) = self.sync.disk.ended(within)? {
                return Some(Err(self.sync.lost(&self.part, source)));
            }
            self.syncs -= 1;
        }
        let named = self.sync.disk.ended(within)?;
        Some(named.map_err(|source| match source.kind() {
            io::ErrorKind::AlreadyExists => WriteError::Exists {
                path: self.summary.path.clone(),
                advice: "another program created it in the meantime; the finished recording is in the .part file next to it",
            },
            _ => WriteError::Io {
                path: self.part.clone(),
                source,
            },
        }))
    }

    /// The disk has not answered for so long.
    pub fn unconfirmed(&self, waited: Duration) -> WriteError {
        WriteError::Unconfirmed {
            path: self.part.clone(),
            waited_s: waited.as_secs(),
        }
    }

    /// Waits as long as it takes; gives the file's name.
    pub fn wait(mut self) -> Result<PathBuf, WriteError> {
        const FOR_EVER: Duration = Duration::from_secs(u32::MAX as u64);
        match self.ended(FOR_EVER) {
            Some(ended) => ended.map(|()| self.summary.path),
            None => Err(self.unconfirmed(FOR_EVER)),
        }
    }
}
