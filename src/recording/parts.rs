//! A recording: one file, or numbered parts of bounded size and length, the oldest of which make
//! room for the newest.

use super::channel::Topic;
use super::disk::Disk;
use super::file::SessionFile;
use super::format::WriteError;
use super::head::Head;
use super::message::Message;
use super::report::RecordingSummary;
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

impl Split {
    fn splits(&self) -> bool {
        self.bytes.is_some() || self.duration.is_some() || self.total_bytes.is_some()
    }

    /// Of a total without a size, a part is an eighth.
    fn part_bytes(&self) -> Option<u64> {
        self.bytes.or(self
            .total_bytes
            .filter(|_| self.duration.is_none())
            .map(|total| (total / 8).max(1)))
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
    /// Finished parts that are still there, with their sizes on disk.
    finished: VecDeque<(PathBuf, u64)>,
    summaries: Vec<RecordingSummary>,
    /// A keyframe on which the next part may begin, and what followed it: the next tick decides.
    held: Vec<Message>,
}

/// `dir/name.mcap` → `dir/name-0003.mcap`.
fn numbered(path: &Path, number: u32) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}-{number:04}.mcap"))
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
            finished: VecDeque::new(),
            summaries: Vec::new(),
            held: Vec::new(),
        })
    }

    /// File under way.
    pub fn path(&self) -> &Path {
        self.file.target()
    }

    /// Message bytes of the part under way.
    pub fn bytes(&self) -> u64 {
        self.summaries
            .iter()
            .map(|summary| summary.bytes)
            .sum::<u64>()
            + self.file.bytes
    }

    /// Newest tick written.
    pub fn last_tick(&self) -> u64 {
        self.file.last_tick
    }

    /// `dropped`: records lost so far, of all the daemon did.
    pub fn put(&mut self, message: &Message, dropped: u64) -> Result<(), WriteError> {
        let begins = message.is_keyframe() && self.file.ticks > 0 && self.is_full();
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

    fn is_full(&self) -> bool {
        let ticks = self.file.last_tick.saturating_sub(self.file.first_tick) + 1;
        let long =
            |most: Duration| u128::from(ticks) * u128::from(self.head.dt_ns) >= most.as_nanos();
        self.split
            .part_bytes()
            .is_some_and(|most| self.file.bytes >= most)
            || self.split.duration.is_some_and(long)
    }

    fn next_part(&mut self, dropped: u64) -> Result<(), WriteError> {
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
        let summary = close(
            done,
            dropped - self.dropped_before,
            &[("next_part", name_of(&target))],
        )?;
        self.dropped_before = dropped;
        let size = std::fs::metadata(&summary.path).map_or(0, |data| data.len());
        self.finished.push_back((summary.path.clone(), size));
        self.summaries.push(summary);
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

    /// Deletes the oldest parts of this recording until the rest, with one part more, fits.
    fn make_room(&mut self) {
        let Some(most) = self.split.total_bytes else {
            return;
        };
        let largest = self
            .finished
            .iter()
            .map(|(_, size)| *size)
            .max()
            .unwrap_or(0);
        while self.finished.len() > 1
            && self.finished.iter().map(|(_, size)| size).sum::<u64>() + largest > most
            && let Some((path, _)) = self.finished.pop_front()
        {
            match std::fs::remove_file(&path) {
                Ok(()) => {
                    tracing::info!(part = %path.display(), "deleted to stay within the disk budget")
                }
                Err(error) => {
                    tracing::warn!(part = %path.display(), %error, "a part could not be deleted")
                }
            }
        }
    }

    /// Ends the recording.
    pub fn finish(
        mut self,
        stats: &Message,
        dropped: u64,
    ) -> (Vec<RecordingSummary>, Result<(), WriteError>) {
        let ended = self.release().and_then(|()| self.file.put(stats));
        let ended = ended.and_then(|()| close(self.file, dropped - self.dropped_before, &[]));
        let ended = ended.map(|summary| self.summaries.push(summary));
        (self.summaries, ended)
    }

    /// What was finished before the disk refused.
    pub fn abandon(self) -> Vec<RecordingSummary> {
        self.summaries
    }
}

fn close(
    file: SessionFile,
    dropped: u64,
    position: &[(&str, String)],
) -> Result<RecordingSummary, WriteError> {
    let mut summary = RecordingSummary {
        path: file.target().to_owned(),
        ticks: file.ticks,
        first_tick: file.first_tick,
        last_tick: file.last_tick,
        final_hash: file.last_hash,
        session_hash: file.session.0,
        dropped,
        bytes: file.bytes,
    };
    summary.path = file.finish(dropped, true, position)?;
    Ok(summary)
}
