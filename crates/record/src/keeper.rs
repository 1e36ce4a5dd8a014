//! The recorder thread: takes the stream and keeps it, in a recording, in memory, in snapshots.

use super::disk::Disk;
use super::file::{ClosingFile, SessionFile};
use super::format::WriteError;
use super::head::Head;
use super::memory::Memory;
use super::message::{Mark, Message};
use super::parts::{MOST_WAITING, Parts, Split};
use super::recorder::{check_name, place};
use super::report::RecordingReport;
use super::stream::TickStream;
use super::views::Views;
use palpate_drive::archive::{ArchiveNews, ArchiveRequest};
use palpate_drive::journal::{JournalGauges, keeping};
use std::collections::{BTreeSet, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, Sender};
use std::time::{Duration, Instant};

/// What others say to the thread.
pub(super) enum Mail {
    Ask {
        id: u64,
        request: ArchiveRequest,
    },
    Event {
        tick: u64,
        kind: String,
        detail: String,
    },
    /// What comes when the stream so far has ended.
    Next(Box<KeptScene>),
}

/// A scene that the loop runs, or may go on with.
pub(super) struct KeptScene {
    pub stream: TickStream,
    pub head: Arc<Head>,
    pub views: Option<Views>,
}

/// Some seconds around a moment, on their way to a file.
struct Snapshot {
    id: u64,
    file: SessionFile,
    /// What the file does not have yet: minutes are not written in one turn, during which the loop
    /// would be left alone.
    backlog: VecDeque<Arc<Message>>,
    last_tick: u64,
    /// Nothing more comes.
    complete: bool,
    dropped_before: u64,
}

/// A file that is written and waits for the disk.
struct Closing {
    file: ClosingFile,
    of: Whose,
    /// When it was asked for.
    since: Instant,
}

/// Whose file it is, and who waits for it.
enum Whose {
    /// Of a recording that goes on.
    Part {
        generation: u32,
    },
    /// Of one that was ended.
    Recording {
        asked: Option<u64>,
    },
    Snapshot {
        asked: Option<u64>,
    },
}

/// A recording that waits for its first keyframe, or is under way.
struct OpenRecording {
    parts: Parts,
    /// Begins with the keyframe that answers this.
    generation: u32,
    begun: bool,
    /// Who asked for it.
    asked: Option<u64>,
}

/// Where files go.
pub(super) struct Shelf {
    pub disk: Arc<dyn Disk>,
    pub directory: PathBuf,
    pub split: Split,
}

/// What the thread shares with others.
pub(super) struct KeeperEnds {
    pub gauges: Arc<JournalGauges>,
    /// Since when ticks are wanted; 0: none are.
    pub wanted: Arc<AtomicU32>,
    pub stop: Arc<AtomicBool>,
    pub mail: Receiver<Mail>,
    pub news: Sender<ArchiveNews>,
}

pub(super) struct Keeper {
    scene: KeptScene,
    shelf: Shelf,
    /// The last seconds.
    memory: Option<Memory>,
    pub ends: KeeperEnds,
    recording: Option<OpenRecording>,
    snapshots: Vec<Snapshot>,
    closing: Vec<Closing>,
    /// Parts that made room for others.
    deleted: BTreeSet<PathBuf>,
    /// Message bytes of recordings that were ended.
    bytes_before: u64,
    /// Losses that were reported, and when.
    reported: (u64, Instant),
    generation: u32,
    /// Scenes made, in order; the loop took some of them.
    next: VecDeque<KeptScene>,
    report: RecordingReport,
}

/// From one look at what has come to the next.
pub(super) const TURN: Duration = Duration::from_millis(5);
/// Why nothing more is begun.
const CROWDED: &str = "too many files wait for the disk; try again when it has them";
/// Most snapshots under way at once; most files that wait for the disk.
const MAX_SNAPSHOTS: usize = 8;
/// Most message bytes of a snapshot that are written in a turn.
const SNAPSHOT_SLICE: usize = 1 << 20;
/// Longest that who ends a recording waits for the disk: clients give up after three seconds.
const ANSWER_WITHIN: Duration = Duration::from_secs(2);
/// Longest that the end of the program waits for the disk.
const END_WITHIN: Duration = Duration::from_secs(10);
/// Between two words about losses.
const TELL_EVERY: Duration = Duration::from_secs(1);

impl Keeper {
    pub fn new(scene: KeptScene, shelf: Shelf, memory: Option<Memory>, ends: KeeperEnds) -> Self {
        let reported = (0, shelf.disk.now());
        let mut keeper = Self {
            scene,
            shelf,
            memory,
            ends,
            recording: None,
            snapshots: Vec::new(),
            closing: Vec::new(),
            deleted: BTreeSet::new(),
            bytes_before: 0,
            reported,
            generation: 0,
            next: VecDeque::new(),
            report: RecordingReport::default(),
        };
        keeper.want();
        keeper
    }

    /// Begins a recording: before the loop, from its first state on.
    pub fn begin(&mut self, path: &Path, asked: Option<u64>) -> Result<(), WriteError> {
        check_name(path)?;
        let dropped = self.dropped();
        let parts = Parts::begin(
            &self.shelf.disk,
            &self.scene.head,
            self.scene.views.as_ref(),
            path,
            self.shelf.split,
            dropped,
        )?;
        self.generation += 1;
        self.tell(ArchiveNews::Started {
            path: parts.path().to_owned(),
        });
        self.recording = Some(OpenRecording {
            parts,
            generation: self.generation,
            begun: false,
            asked,
        });
        self.want();
        Ok(())
    }

    fn dropped(&self) -> u64 {
        self.ends.gauges.dropped.load(Ordering::Relaxed)
    }

    fn tell(&self, news: ArchiveNews) {
        // No one listens when no bus runs.
        let _ = self.ends.news.send(news);
    }

    /// Tells the tick thread whether anyone wants ticks, and since when.
    fn want(&mut self) {
        let any = self.recording.is_some() || self.memory.is_some() || !self.snapshots.is_empty();
        if any {
            self.generation = self.generation.max(1);
        }
        (self.ends.wanted).store(if any { self.generation } else { 0 }, Ordering::Release);
        self.show();
    }

    /// Shows in the gauges what the thread is doing.
    fn show(&self) {
        let state = match (&self.recording, &self.report.failure) {
            (Some(_), _) => keeping::RECORDING,
            (None, Some(_)) => keeping::FAILED,
            (None, None) if self.memory.is_some() => keeping::RING,
            (None, None) => keeping::OFF,
        };
        self.ends.gauges.state.store(state, Ordering::Relaxed);
    }

    /// Runs until it is asked to stop and everything is written.
    pub fn run(mut self) -> RecordingReport {
        loop {
            let stop = self.ends.stop.load(Ordering::Acquire);
            self.turn(stop);
            if stop {
                break;
            }
            std::thread::sleep(TURN);
        }
        self.end()
    }

    /// Takes what has come. `stop`: the loop has ended, and nothing comes after it.
    pub fn turn(&mut self, stop: bool) {
        while let Ok(mail) = self.ends.mail.try_recv() {
            match mail {
                Mail::Ask { id, request } => self.answer(id, request),
                Mail::Event { tick, kind, detail } => {
                    self.keep(Message::event(tick, &kind, &detail))
                }
                Mail::Next(next) => self.next.push_back(*next),
            }
        }
        self.take_stream(stop);
        self.write_snapshots(SNAPSHOT_SLICE);
        self.tell_losses(TELL_EVERY);
        self.flush();
        self.close(Duration::ZERO);
    }

    /// Ends what is open, and waits for the disk, but not for ever.
    pub fn end(mut self) -> RecordingReport {
        self.end_recording(None);
        self.end_snapshots();
        self.write_snapshots(usize::MAX);
        let begun = self.shelf.disk.now();
        while !self.closing.is_empty() {
            let waited = self.shelf.disk.now().saturating_duration_since(begun);
            if let Some(left) = END_WITHIN.checked_sub(waited)
                && self.close(left)
            {
                continue;
            }
            for Closing { file, .. } in std::mem::take(&mut self.closing) {
                let error = file.unconfirmed(END_WITHIN);
                tracing::error!(%error, "the disk does not answer");
                self.report.failure.get_or_insert(error);
            }
        }
        for file in &mut self.report.files {
            file.deleted = self.deleted.contains(&file.path);
        }
        self.report.dropped = self.dropped();
        self.report
    }

    /// Takes what has come; all of it, and of the scenes that follow, when the loop has ended.
    fn take_stream(&mut self, stop: bool) {
        loop {
            self.next.retain(|next| !next.stream.is_unused());
            // Asked first: what came before it was abandoned is there by now.
            let over = self.scene.stream.is_abandoned() && !self.next.is_empty();
            let mut messages = Vec::new();
            self.scene
                .stream
                .drain(stop || over, |message| messages.push(message));
            messages.into_iter().for_each(|message| self.keep(message));
            match self.next.pop_front() {
                Some(next) if over => self.change_scene(next),
                Some(next) => return self.next.push_front(next),
                None => return,
            }
        }
    }

    /// Another scene is another file: each can be replayed alone. Seconds in memory begin anew,
    /// snapshots end here.
    fn change_scene(&mut self, next: KeptScene) {
        self.end_snapshots();
        if let Some(memory) = &mut self.memory {
            memory.clear();
        }
        let (stats, dropped) = (self.scene.stream.stats(), self.dropped());
        self.scene = next;
        let mut changed = Ok(());
        if let Some(recording) = &mut self.recording {
            let views = self.scene.views.as_ref();
            changed = recording
                .parts
                .change(&self.scene.head, views, &stats, dropped);
        }
        self.take_parts();
        if let Err(error) = changed {
            self.fail(error);
        }
    }

    /// Hands a message to all who keep something.
    fn keep(&mut self, message: Message) {
        let message = Arc::new(message);
        let dropped = self.dropped();
        if let Some(memory) = &mut self.memory {
            memory.push(&message);
        }
        if let Some(recording) = &mut self.recording {
            if let Mark::Keyframe { generation } = message.mark
                && !recording.begun
                && generation >= recording.generation
            {
                recording.begun = true;
                if let Some(id) = recording.asked.take() {
                    let path = recording.parts.path().to_owned();
                    let _ = self.ends.news.send(ArchiveNews::Done {
                        id,
                        tick: message.tick + 1,
                        path,
                    });
                }
            }
            let kept = if recording.begun {
                recording.parts.put(&message, dropped)
            } else {
                Ok(())
            };
            self.take_parts();
            if let Err(error) = kept {
                self.fail(error);
            }
        } else if self.report.failure.is_some() && message.is_tick() {
            self.ends.gauges.dropped.fetch_add(1, Ordering::Relaxed);
        }
        for snapshot in &mut self.snapshots {
            if !snapshot.complete {
                snapshot.backlog.push_back(message.clone());
                snapshot.complete = message.is_tick() && message.tick >= snapshot.last_tick;
            }
        }
    }

    /// Says in the recording and in the log that records were lost, if that was not said within this
    /// time: the status counts them.
    fn tell_losses(&mut self, every: Duration) {
        let (dropped, now) = (self.dropped(), self.shelf.disk.now());
        let lost = dropped - self.reported.0;
        let keeps = self.recording.is_some() || self.memory.is_some();
        if !keeps || self.ends.gauges.state.load(Ordering::Relaxed) == keeping::FAILED {
            // After a failure that was reported, all are.
            self.reported.0 = dropped;
        } else if lost > 0 && now.saturating_duration_since(self.reported.1) >= every {
            self.reported = (dropped, now);
            let words = format!("{lost} records: the disk did not take them in time");
            tracing::warn!(lost, "records lost: the disk did not take them in time");
            self.keep(Message::event(
                self.scene.stream.last_tick(),
                "records_lost",
                &words,
            ));
        }
    }

    fn flush(&mut self) {
        let mut failed = None;
        if let Some(recording) = &mut self.recording {
            failed = recording.parts.flush_if_due().err();
            let bytes = self.bytes_before + recording.parts.bytes();
            self.ends.gauges.bytes.store(bytes, Ordering::Relaxed);
        }
        if let Some(error) = failed {
            self.fail(error);
        }
    }

    /// Takes the parts that a recording has ended.
    fn take_parts(&mut self) {
        let Some(recording) = &mut self.recording else {
            return;
        };
        let generation = recording.generation;
        let since = self.shelf.disk.now();
        let ended = recording.parts.closing.drain(..).map(|file| Closing {
            file,
            of: Whose::Part { generation },
            since,
        });
        self.closing.extend(ended);
        recording.parts.waiting = self.closing.len();
        self.deleted.extend(recording.parts.deleted.drain(..));
    }

    /// Looks which files the disk has by now; waits for the oldest of them for so long. False if it
    /// has none.
    fn close(&mut self, within: Duration) -> bool {
        let now = self.shelf.disk.now();
        let (mut at, mut any, mut behind) = (0, false, false);
        while at < self.closing.len() {
            let closing = &mut self.closing[at];
            let is_snapshot = matches!(closing.of, Whose::Snapshot { .. });
            // Files of recordings are reported in their order.
            let ended = match behind && !is_snapshot {
                true => None,
                false => closing.file.ended(match at {
                    0 if !any => within,
                    _ => Duration::ZERO,
                }),
            };
            match ended {
                Some(ended) => {
                    let Closing { file, of, .. } = self.closing.remove(at);
                    self.closed(file, of, ended);
                    any = true;
                }
                None => {
                    behind |= !is_snapshot;
                    let late = now.saturating_duration_since(closing.since) >= ANSWER_WITHIN;
                    if let Whose::Recording { asked } | Whose::Snapshot { asked } = &mut closing.of
                        && late
                        && let Some(id) = asked.take()
                    {
                        let reason = closing.file.unconfirmed(ANSWER_WITHIN).to_string();
                        let _ = self.ends.news.send(ArchiveNews::Refused { id, reason });
                    }
                    at += 1;
                }
            }
        }
        let waiting = self.closing.len();
        if let Some(OpenRecording { parts, .. }) = &mut self.recording {
            parts.waiting = waiting;
            if any {
                parts.make_room();
                self.deleted.extend(parts.deleted.drain(..));
            }
            if parts.wants_keyframe() {
                self.generation += 1;
                self.want();
            }
        }
        any
    }

    fn is_crowded(&self) -> bool {
        self.closing.len() >= MOST_WAITING
    }

    /// The disk has a file, or has refused it.
    fn closed(&mut self, file: ClosingFile, of: Whose, ended: Result<(), WriteError>) {
        let (path, tick) = (file.summary.path.clone(), file.summary.last_tick);
        if !matches!(of, Whose::Snapshot { .. }) && ended.is_ok() {
            self.report.files.push(file.summary);
        }
        let asked = match &of {
            Whose::Part { .. } => None,
            Whose::Recording { asked } | Whose::Snapshot { asked } => *asked,
        };
        match (of, ended) {
            (Whose::Part { generation }, Err(error)) if matches!(&self.recording, Some(r) if r.generation == generation) =>
            {
                self.fail(error);
            }
            (Whose::Part { .. } | Whose::Recording { .. }, Err(error)) => {
                self.failed(path, asked, error);
                self.want();
            }
            (Whose::Snapshot { .. }, Err(error)) => self.refuse(asked, &error.to_string()),
            (Whose::Part { .. }, Ok(())) => {}
            (of, Ok(())) => {
                if let Whose::Recording { .. } = of {
                    self.tell(ArchiveNews::Stopped { path: path.clone() });
                }
                if let Some(id) = asked {
                    self.tell(ArchiveNews::Done { id, tick, path });
                }
            }
        }
    }

    fn refuse(&self, asked: Option<u64>, reason: &str) {
        if let Some(id) = asked {
            let reason = reason.to_owned();
            self.tell(ArchiveNews::Refused { id, reason });
        }
    }

    /// Shows that a recording failed, and then reports it: the status has it by then.
    fn failed(&mut self, path: PathBuf, asked: Option<u64>, error: WriteError) {
        tracing::error!(%error, "recording failed");
        let reason = error.to_string();
        self.report.failure = Some(error);
        self.show();
        self.refuse(asked, &reason);
        self.tell(ArchiveNews::Failed { path, reason });
    }

    /// The disk refused. The loop goes on without us; what was flushed stays readable.
    fn fail(&mut self, error: WriteError) {
        let Some(recording) = self.recording.take() else {
            return;
        };
        self.bytes_before += recording.parts.bytes();
        if let Some(memory) = &mut self.memory {
            memory.push(&Arc::new(Message::event(
                self.scene.stream.last_tick(),
                "record_failed",
                &error.to_string(),
            )));
        }
        self.failed(recording.parts.path().to_owned(), recording.asked, error);
        // Ticks go on coming, to be counted as lost.
        self.ends
            .wanted
            .store(self.generation.max(1), Ordering::Release);
    }

    /// Ends the recording, if there is one. `asked` is answered when the disk has it.
    fn end_recording(&mut self, asked: Option<u64>) {
        self.tell_losses(Duration::ZERO);
        let Some(recording) = self.recording.take() else {
            return self.refuse(asked, "nothing is being recorded");
        };
        self.refuse(recording.asked, "it was ended before its first tick");
        self.bytes_before += recording.parts.bytes();
        let path = recording.parts.path().to_owned();
        let stats = self.scene.stream.stats();
        match recording.parts.finish(&stats, self.dropped()) {
            Ok(file) => self.closing.push(Closing {
                file,
                of: Whose::Recording { asked },
                since: self.shelf.disk.now(),
            }),
            Err(error) => self.failed(path, asked, error),
        }
        self.want();
    }

    fn answer(&mut self, id: u64, request: ArchiveRequest) {
        let refused = |reason: String| ArchiveNews::Refused { id, reason };
        match request {
            ArchiveRequest::Start { path } => {
                if let Some(recording) = &self.recording {
                    let path = recording.parts.path().display().to_string();
                    return self.tell(refused(format!("{path} is being recorded; stop it first")));
                }
                if self.is_crowded() {
                    return self.tell(refused(CROWDED.into()));
                }
                let begun = place(&self.shelf.directory, path, "session").and_then(|path| {
                    self.report.failure = None;
                    self.begin(&path, Some(id))
                        .map_err(|error| error.to_string())
                });
                if let Err(reason) = begun {
                    self.tell(refused(reason));
                }
            }
            ArchiveRequest::Stop => self.end_recording(Some(id)),
            ArchiveRequest::Snapshot {
                before_s,
                after_s,
                path,
            } => {
                if let Err(reason) = self.snapshot(id, before_s, after_s, path) {
                    self.tell(refused(reason));
                }
            }
        }
    }

    fn snapshot(
        &mut self,
        id: u64,
        before_s: f64,
        after_s: f64,
        path: Option<PathBuf>,
    ) -> Result<(), String> {
        let memory = self.memory.as_ref().filter(|memory| !memory.is_empty());
        let memory = memory.ok_or("nothing is kept in memory; start the daemon with --ring 30s")?;
        if self.snapshots.len() >= MAX_SNAPSHOTS {
            return Err(format!(
                "{MAX_SNAPSHOTS} snapshots are being written; wait for one to end"
            ));
        }
        if self.is_crowded() {
            return Err(CROWDED.into());
        }
        let dt_s = self.scene.head.dt_ns as f64 * 1e-9;
        let ticks = |name: &str, seconds: f64| match (0.0..=3_600.0).contains(&seconds) {
            true => Ok((seconds / dt_s).round() as u64),
            false => Err(format!(
                "{name} is {seconds} s; it must be between 0 and 3600"
            )),
        };
        let now = self.scene.stream.last_tick();
        let (from, to) = (
            now.saturating_sub(ticks("before", before_s)?),
            now + ticks("after", after_s)?,
        );
        let path = place(&self.shelf.directory, path, "snapshot")?;
        let position = [("snapshot_tick", now.to_string())];
        let file = SessionFile::create(
            &*self.shelf.disk,
            &path,
            &self.scene.head,
            &position,
            self.scene.views.clone(),
        );
        let backlog: VecDeque<_> = memory.since(from).cloned().collect();
        self.snapshots.push(Snapshot {
            id,
            file: file.map_err(|error| error.to_string())?,
            backlog,
            last_tick: to,
            complete: to <= now,
            dropped_before: self.dropped(),
        });
        Ok(())
    }

    /// Nothing more comes for snapshots.
    fn end_snapshots(&mut self) {
        for snapshot in &mut self.snapshots {
            snapshot.complete = true;
        }
    }

    /// Writes what snapshots lack: of each at most so many bytes and a message.
    fn write_snapshots(&mut self, slice: usize) {
        let (now, dropped) = (self.shelf.disk.now(), self.dropped());
        let mut at = 0;
        while at < self.snapshots.len() {
            let snapshot = &mut self.snapshots[at];
            let (mut written, mut bytes) = (Ok(()), 0);
            while written.is_ok()
                && bytes < slice
                && let Some(message) = snapshot.backlog.pop_front()
            {
                bytes += message.data.len();
                written = snapshot.file.put(&message);
            }
            let written = written.and_then(|()| snapshot.file.flush_if_due(now));
            if written.is_ok() && !(snapshot.complete && snapshot.backlog.is_empty()) {
                at += 1;
                continue;
            }
            let snapshot = self.snapshots.swap_remove(at);
            let lost = dropped - snapshot.dropped_before;
            let ended = written.and_then(|()| snapshot.file.finish(lost, true, &[]));
            match ended {
                Ok(file) => self.closing.push(Closing {
                    file,
                    of: Whose::Snapshot {
                        asked: Some(snapshot.id),
                    },
                    since: now,
                }),
                Err(error) => self.refuse(Some(snapshot.id), &error.to_string()),
            }
        }
    }
}
