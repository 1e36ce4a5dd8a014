//! A recording: one file, or numbered parts of bounded size and length, the oldest of which make
//! room for the newest.

use super::channel::Topic;
use super::disk::Disk;
use super::file::{ClosingFile, SessionFile, part_of};
use super::format::WriteError;
use super::head::Head;
use super::message::Message;
use super::views::Views;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// When a new part begins, and how much all may take. Parts begin with a keyframe, so that each can
/// be replayed alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Split {
    /// Message bytes of a part before compression.
    pub bytes: Option<u64>,
    /// Simulated time of a part.
    pub duration: Option<Duration>,
    /// Bytes on disk of all parts together; the oldest are deleted.
    pub total_bytes: Option<u64>,
}

/// A finished part and the one under way fit a total, with a second of either to spare.
const PARTS_OF_A_TOTAL: u64 = 3;
/// A part has at least so many ticks, whatever its share of a total.
const LEAST_TICKS: u64 = 100;
/// Of a total without a size or a duration of parts, a part is this share before compression.
const PARTS_UNTOLD: u64 = 8;
/// Files that may wait for the disk before no further one is begun.
pub(super) const MOST_WAITING: usize = 8;

impl Split {
    fn splits(&self) -> bool {
        self.bytes.is_some() || self.duration.is_some() || self.total_bytes.is_some()
    }

    /// Parts of these bounds fit the total. `head_bytes`: what a part has before its first message.
    ///
    /// # Errors
    /// They do not.
    pub(super) fn check(&self, head_bytes: u64) -> Result<(), WriteError> {
        let Some(total_bytes) = self.total_bytes else {
            return Ok(());
        };
        if let Some(part_bytes) = self.bytes.filter(|most| *most > total_bytes) {
            return Err(WriteError::PartAboveTotal {
                part_bytes,
                total_bytes,
            });
        }
        // Half of a part at least are ticks.
        let least_bytes = 2 * PARTS_OF_A_TOTAL * head_bytes;
        match total_bytes < least_bytes {
            true => Err(WriteError::SmallTotal {
                total_bytes,
                head_bytes,
                least_bytes,
            }),
            false => Ok(()),
        }
    }

    /// A part of so many bytes on disk leaves no room for another.
    fn takes_its_share(&self, disk_bytes: u64) -> bool {
        let total = self.total_bytes;
        total.is_some_and(|total| disk_bytes >= total / PARTS_OF_A_TOTAL)
    }

    /// A file of so many bytes before compression, on disk, and so much time is long enough.
    fn is_full(&self, bytes: u64, disk_bytes: u64, time_ns: u128) -> bool {
        let untold = self.bytes.is_none() && self.duration.is_none();
        let total = self.total_bytes;
        let share = total.filter(|_| untold).map(|total| total / PARTS_UNTOLD);
        self.bytes.or(share).is_some_and(|most| bytes >= most)
            || self.takes_its_share(disk_bytes)
            || self.duration.is_some_and(|most| time_ns >= most.as_nanos())
    }
}

/// An open recording.
pub(super) struct Parts {
    disk: Arc<dyn Disk>,
    head: Arc<Head>,
    views: Option<Views>,
    stem: PathBuf,
    split: Split,
    number: u32,
    file: SessionFile,
    /// Losses before this part.
    dropped_before: u64,
    /// Message bytes of the parts before it.
    bytes_before: u64,
    /// Finished parts that are still there, with their sizes on disk.
    finished: VecDeque<(PathBuf, u64)>,
    /// A keyframe on which the next part may begin, and what followed it: the next tick decides.
    held: Vec<Arc<Message>>,
    /// Parts that ended, until someone takes them to wait for the disk.
    pub closing: Vec<ClosingFile>,
    /// Parts that were deleted, until someone takes note.
    pub deleted: Vec<PathBuf>,
    /// Files that wait for the disk beside `closing`.
    pub waiting: usize,
    /// A keyframe was asked for, to end this part.
    asked: bool,
}

/// `dir/name.mcap` → `dir/name-0003.mcap`.
fn numbered(path: &Path, number: u32) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{number:04}.mcap"));
    path.with_file_name(name)
}

fn name_of(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

impl Parts {
    pub fn begin(
        disk: &Arc<dyn Disk>,
        head: &Arc<Head>,
        views: Option<&Views>,
        path: &Path,
        split: Split,
        dropped: u64,
    ) -> Result<Self, WriteError> {
        let (target, position) = match split.splits() {
            true => (numbered(path, 1), vec![("part", "1".to_owned())]),
            false => (path.to_owned(), Vec::new()),
        };
        let file = SessionFile::create(&**disk, &target, head, &position, views.cloned())?;
        Ok(Self {
            disk: disk.clone(),
            head: head.clone(),
            views: views.cloned(),
            stem: path.to_owned(),
            split,
            number: 1,
            file,
            dropped_before: dropped,
            bytes_before: 0,
            finished: VecDeque::new(),
            held: Vec::new(),
            closing: Vec::new(),
            deleted: Vec::new(),
            waiting: 0,
            asked: false,
        })
    }

    /// File under way.
    pub fn path(&self) -> &Path {
        self.file.target()
    }

    /// Message bytes of all parts.
    pub fn bytes(&self) -> u64 {
        self.bytes_before + self.file.bytes
    }

    /// `dropped`: records lost so far, of all the daemon did.
    pub fn put(&mut self, message: &Arc<Message>, dropped: u64) -> Result<(), WriteError> {
        let begins =
            message.is_keyframe() && self.file.ticks > 0 && !self.is_crowded() && self.is_full();
        match message.topic {
            // The next part has a tick at least.
            Topic::Tick if !self.held.is_empty() => {
                self.next_part(dropped)?;
                self.release()?;
            }
            _ if begins || !self.held.is_empty() => {
                if begins {
                    // A later keyframe does as well.
                    self.release()?;
                }
                self.held.push(message.clone());
                return Ok(());
            }
            _ => {}
        }
        self.file.put(message)
    }

    fn release(&mut self) -> Result<(), WriteError> {
        std::mem::take(&mut self.held)
            .iter()
            .try_for_each(|message| self.file.put(message))
    }

    pub fn flush_if_due(&mut self) -> Result<(), WriteError> {
        self.file.flush_if_due(self.disk.now())
    }

    /// Too many files wait for the disk: this part goes on until there are fewer.
    fn is_crowded(&self) -> bool {
        self.waiting + self.closing.len() >= MOST_WAITING
    }

    fn is_full(&self) -> bool {
        let ticks = self.file.last_tick.saturating_sub(self.file.first_tick) + 1;
        let time_ns = u128::from(ticks) * u128::from(self.head.dt_ns);
        self.split
            .is_full(self.file.bytes, self.file.len(), time_ns)
    }

    /// The part has taken its share of the total and cannot wait for the next keyframe of the scene's
    /// own: true once for each part.
    pub fn wants_keyframe(&mut self) -> bool {
        let wants = !self.asked
            && !self.is_crowded()
            && self.file.ticks >= LEAST_TICKS
            && self.split.takes_its_share(self.file.len());
        self.asked |= wants;
        wants
    }

    fn next_part(&mut self, dropped: u64) -> Result<(), WriteError> {
        self.asked = false;
        self.number += 1;
        let target = numbered(&self.stem, self.number);
        let position = [
            ("part", self.number.to_string()),
            ("previous_part", name_of(self.file.target())),
        ];
        let next = SessionFile::create(
            &*self.disk,
            &target,
            &self.head,
            &position,
            self.views.clone(),
        )?;
        let done = std::mem::replace(&mut self.file, next);
        let (next_part, lost) = (name_of(&target), dropped - self.dropped_before);
        let done = done.finish(lost, true, &[("next_part", next_part)])?;
        self.dropped_before = dropped;
        self.bytes_before += done.summary.bytes;
        self.finished
            .push_back((done.summary.path.clone(), done.len));
        if let Some(total) = self.split.total_bytes.filter(|total| done.len > *total) {
            let (part, bytes) = (done.summary.path.display(), done.len);
            tracing::warn!(%part, bytes, "a part is larger than --max-total {total} bytes: none is kept but the one that is written");
        }
        self.closing.push(done);
        self.make_room();
        Ok(())
    }

    /// Goes on with another scene, in a part of its own.
    pub fn change(
        &mut self,
        head: &Arc<Head>,
        views: Option<&Views>,
        stats: &Message,
        dropped: u64,
    ) -> Result<(), WriteError> {
        self.release()?;
        self.file.put(stats)?;
        (self.head, self.views) = (head.clone(), views.cloned());
        self.next_part(dropped)
    }

    /// Deletes the oldest parts of this recording until the rest, with one part more, fits. One is
    /// kept if it fits alone.
    pub fn make_room(&mut self) {
        let Some(most) = self.split.total_bytes else {
            return;
        };
        let sizes = |parts: &VecDeque<(PathBuf, u64)>| parts.iter().map(|(_, size)| *size).sum();
        let largest = self.finished.iter().map(|(_, size)| *size).max();
        while let Some((path, _)) = self.finished.front() {
            let kept: u64 = sizes(&self.finished);
            let next = largest.filter(|_| self.finished.len() > 1).unwrap_or(0);
            // One that waits for its name goes when it has it.
            if kept + next <= most || part_of(path).exists() {
                break;
            }
            match std::fs::remove_file(path) {
                Ok(()) => {
                    tracing::info!(part = %path.display(), "deleted to stay within the disk budget")
                }
                Err(error) => {
                    tracing::warn!(part = %path.display(), %error, "a part could not be deleted")
                }
            }
            self.deleted
                .extend(self.finished.pop_front().map(|(path, _)| path));
        }
    }

    /// Ends the recording.
    pub fn finish(mut self, stats: &Message, dropped: u64) -> Result<ClosingFile, WriteError> {
        self.release()?;
        self.file.put(stats)?;
        self.file.finish(dropped - self.dropped_before, true, &[])
    }
}
