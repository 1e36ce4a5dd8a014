//! The recorder thread: takes the stream and keeps it, in a recording, in memory, in snapshots.

use super::disk::Disk;
use super::file::SessionFile;
use super::format::WriteError;
use super::head::Head;
use super::memory::Memory;
use super::message::{Mark, Message};
use super::parts::{Parts, Split};
use super::recorder::place;
use super::report::RecordingReport;
use super::stream::TickStream;
use super::views::Views;
use crate::drive::archive::{ArchiveNews, ArchiveRequest};
use crate::drive::journal::{JournalGauges, keeping};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, Sender};
use std::time::Duration;

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
    Next(Box<NextScene>),
}

/// Another scene that the loop may go on with.
pub(super) struct NextScene {
    pub stream: TickStream,
    pub head: Arc<Head>,
    pub views: Option<Views>,
}

/// Some seconds around a moment, on their way to a file.
struct Snapshot {
    id: u64,
    file: SessionFile,
    last_tick: u64,
    dropped_before: u64,
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

pub(super) struct Keeper {
    pub stream: TickStream,
    pub head: Arc<Head>,
    pub disk: Arc<dyn Disk>,
    pub views: Option<Views>,
    pub split: Split,
    pub directory: PathBuf,
    pub memory: Option<Memory>,
    pub gauges: Arc<JournalGauges>,
    pub wanted: Arc<AtomicU32>,
    pub stop: Arc<AtomicBool>,
    pub mail: Receiver<Mail>,
    pub news: Sender<ArchiveNews>,
    recording: Option<OpenRecording>,
    snapshots: Vec<Snapshot>,
    generation: u32,
    /// Scenes made, in order; the loop took some of them.
    next: VecDeque<NextScene>,
    report: RecordingReport,
}

/// From one look at what has come to the next.
pub(super) const TURN: Duration = Duration::from_millis(5);
/// Most snapshots under way at once.
const MAX_SNAPSHOTS: usize = 8;

impl Keeper {
    #[allow(clippy::too_many_arguments)]
    pub fn new(
        stream: TickStream,
        head: Arc<Head>,
        disk: Arc<dyn Disk>,
        views: Option<Views>,
        split: Split,
        directory: PathBuf,
        memory: Option<Memory>,
        gauges: Arc<JournalGauges>,
        wanted: Arc<AtomicU32>,
        stop: Arc<AtomicBool>,
        mail: Receiver<Mail>,
        news: Sender<ArchiveNews>,
    ) -> Self {
        let mut keeper = Self {
            stream,
            head,
            disk,
            views,
            split,
            directory,
            memory,
            gauges,
            wanted,
            stop,
            mail,
            news,
            recording: None,
            snapshots: Vec::new(),
            generation: 0,
            next: VecDeque::new(),
            report: RecordingReport::default(),
        };
        keeper.want();
        keeper
    }

    /// Begins a recording: before the loop, from its first state on.
    pub fn begin(&mut self, path: &Path, asked: Option<u64>) -> Result<(), WriteError> {
        let dropped = self.dropped();
        let parts = Parts::begin(
            &self.disk,
            &self.head,
            self.views.as_ref(),
            path,
            self.split,
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
        self.gauges.dropped.load(Ordering::Relaxed)
    }

    fn tell(&self, news: ArchiveNews) {
        // Nobody listens when no bus runs.
        let _ = self.news.send(news);
    }

    /// Tells the tick thread whether anyone wants ticks, and since when.
    fn want(&mut self) {
        let any = self.recording.is_some() || self.memory.is_some() || !self.snapshots.is_empty();
        if any {
            self.generation = self.generation.max(1);
        }
        self.wanted
            .store(if any { self.generation } else { 0 }, Ordering::Release);
        let state = match (&self.recording, &self.report.failure) {
            (Some(_), _) => keeping::RECORDING,
            (None, Some(_)) => keeping::FAILED,
            (None, None) if self.memory.is_some() => keeping::RING,
            (None, None) => keeping::OFF,
        };
        self.gauges.state.store(state, Ordering::Relaxed);
    }

    /// Runs until it is asked to stop and everything is written.
    pub fn run(mut self) -> RecordingReport {
        loop {
            let stop = self.stop.load(Ordering::Acquire);
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
        while let Ok(mail) = self.mail.try_recv() {
            match mail {
                Mail::Ask { id, request } => self.answer(id, request),
                Mail::Event { tick, kind, detail } => {
                    self.keep(&Message::event(tick, &kind, &detail))
                }
                Mail::Next(next) => self.next.push_back(*next),
            }
        }
        self.take_stream(stop);
        self.flush();
    }

    /// Ends what is open.
    pub fn end(mut self) -> RecordingReport {
        self.end_recording();
        for snapshot in std::mem::take(&mut self.snapshots) {
            self.end_snapshot(snapshot);
        }
        self.report.dropped = self.dropped();
        self.report
    }

    /// Takes what has come; all of it, and of the scenes that follow, when the loop has ended.
    fn take_stream(&mut self, stop: bool) {
        loop {
            self.next.retain(|next| !next.stream.is_unused());
            // Asked first: what came before it was abandoned is there by now.
            let over = self.stream.is_abandoned() && !self.next.is_empty();
            let mut messages = Vec::new();
            self.stream
                .drain(stop || over, |message| messages.push(message));
            for message in &messages {
                self.keep(message);
            }
            match self.next.pop_front() {
                Some(next) if over => self.change_scene(next),
                Some(next) => return self.next.push_front(next),
                None => return,
            }
        }
    }

    /// Another scene is another file: each can be replayed alone. Seconds in memory begin anew,
    /// snapshots end here.
    fn change_scene(&mut self, next: NextScene) {
        for snapshot in std::mem::take(&mut self.snapshots) {
            self.end_snapshot(snapshot);
        }
        if let Some(memory) = &mut self.memory {
            memory.clear();
        }
        let (stats, dropped) = (self.stream.stats(), self.dropped());
        (self.stream, self.head, self.views) = (next.stream, next.head, next.views);
        if let Some(recording) = &mut self.recording
            && let Err(error) =
                recording
                    .parts
                    .change(&self.head, self.views.as_ref(), &stats, dropped)
        {
            self.fail(error);
        }
    }

    /// Hands a message to all who keep something.
    fn keep(&mut self, message: &Message) {
        let dropped = self.dropped();
        if let Some(memory) = &mut self.memory {
            memory.push(message);
        }
        if let Some(recording) = &mut self.recording {
            if let Mark::Keyframe { generation } = message.mark
                && !recording.begun
                && generation >= recording.generation
            {
                recording.begun = true;
                if let Some(id) = recording.asked.take() {
                    let path = recording.parts.path().to_owned();
                    let _ = self.news.send(ArchiveNews::Done {
                        id,
                        tick: message.tick + 1,
                        path,
                    });
                }
            }
            let kept = if recording.begun {
                recording.parts.put(message, dropped)
            } else {
                Ok(())
            };
            if let Err(error) = kept {
                self.fail(error);
            }
        } else if self.report.failure.is_some() && message.is_tick() {
            self.gauges.dropped.fetch_add(1, Ordering::Relaxed);
        }
        let mut at = 0;
        while at < self.snapshots.len() {
            let snapshot = &mut self.snapshots[at];
            match snapshot.file.put(message) {
                Ok(()) if message.is_tick() && message.tick >= snapshot.last_tick => {
                    let snapshot = self.snapshots.swap_remove(at);
                    self.end_snapshot(snapshot);
                }
                Ok(()) => at += 1,
                Err(error) => {
                    let Snapshot { id, .. } = self.snapshots.swap_remove(at);
                    self.tell(ArchiveNews::Refused {
                        id,
                        reason: error.to_string(),
                    });
                }
            }
        }
    }

    fn flush(&mut self) {
        let mut failed = None;
        if let Some(recording) = &mut self.recording {
            failed = recording.parts.flush_if_due().err();
            let bytes = self.report.files.iter().map(|file| file.bytes).sum::<u64>()
                + recording.parts.bytes();
            self.gauges.bytes.store(bytes, Ordering::Relaxed);
        }
        if let Some(error) = failed {
            self.fail(error);
        }
        let now = self.disk.now();
        for snapshot in &mut self.snapshots {
            // An error shows again with the next message.
            let _ = snapshot.file.flush_if_due(now);
        }
    }

    /// The disk refused. The loop goes on without us; what was flushed stays readable.
    fn fail(&mut self, error: WriteError) {
        let Some(recording) = self.recording.take() else {
            return;
        };
        tracing::error!(%error, "recording failed");
        let path = recording.parts.path().to_owned();
        self.report.files.extend(recording.parts.abandon());
        self.tell(ArchiveNews::Failed {
            path: path.clone(),
            reason: error.to_string(),
        });
        if let Some(id) = recording.asked {
            self.tell(ArchiveNews::Refused {
                id,
                reason: error.to_string(),
            });
        }
        if let Some(memory) = &mut self.memory {
            memory.push(&Message::event(
                self.stream.last_tick(),
                "record_failed",
                &error.to_string(),
            ));
        }
        self.report.failure = Some(error);
        // Ticks go on coming, to be counted as lost.
        self.want();
        self.wanted.store(self.generation.max(1), Ordering::Release);
    }

    fn end_recording(&mut self) -> Option<(u64, PathBuf)> {
        let recording = self.recording.take()?;
        if let Some(id) = recording.asked {
            self.tell(ArchiveNews::Refused {
                id,
                reason: "it was ended before its first tick".into(),
            });
        }
        let (path, tick) = (
            recording.parts.path().to_owned(),
            recording.parts.last_tick(),
        );
        let stats = self.stream.stats();
        let (files, ended) = recording.parts.finish(&stats, self.dropped());
        self.report.files.extend(files);
        match ended {
            Ok(()) => self.tell(ArchiveNews::Stopped { path: path.clone() }),
            Err(error) => {
                tracing::error!(%error, "recording failed");
                self.tell(ArchiveNews::Failed {
                    path: path.clone(),
                    reason: error.to_string(),
                });
                self.report.failure = Some(error);
            }
        }
        self.want();
        Some((tick, path))
    }

    fn answer(&mut self, id: u64, request: ArchiveRequest) {
        let refused = |reason: String| ArchiveNews::Refused { id, reason };
        match request {
            ArchiveRequest::Start { path } => {
                if let Some(recording) = &self.recording {
                    let path = recording.parts.path().display().to_string();
                    return self.tell(refused(format!("{path} is being recorded; stop it first")));
                }
                let begun = place(&self.directory, path, "session").and_then(|path| {
                    self.report.failure = None;
                    self.begin(&path, Some(id))
                        .map_err(|error| error.to_string())
                });
                if let Err(reason) = begun {
                    self.tell(refused(reason));
                }
            }
            ArchiveRequest::Stop => match self.end_recording() {
                None => self.tell(refused("nothing is being recorded".into())),
                Some((tick, path)) => match &self.report.failure {
                    None => self.tell(ArchiveNews::Done { id, tick, path }),
                    Some(error) => self.tell(refused(error.to_string())),
                },
            },
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
        let dt_s = self.head.dt_ns as f64 * 1e-9;
        let ticks = |name: &str, seconds: f64| match (0.0..=3_600.0).contains(&seconds) {
            true => Ok((seconds / dt_s).round() as u64),
            false => Err(format!(
                "{name} is {seconds} s; it must be between 0 and 3600"
            )),
        };
        let now = self.stream.last_tick();
        let (from, to) = (
            now.saturating_sub(ticks("before", before_s)?),
            now + ticks("after", after_s)?,
        );
        let path = place(&self.directory, path, "snapshot")?;
        let position = [("snapshot_tick", now.to_string())];
        let file = SessionFile::create(
            &*self.disk,
            &path,
            &self.head,
            &position,
            self.views.clone(),
        );
        let mut file = file.map_err(|error| error.to_string())?;
        for message in memory.since(from) {
            file.put(message).map_err(|error| error.to_string())?;
        }
        let snapshot = Snapshot {
            id,
            file,
            last_tick: to,
            dropped_before: self.dropped(),
        };
        if to <= now {
            self.end_snapshot(snapshot);
        } else {
            self.snapshots.push(snapshot);
        }
        Ok(())
    }

    fn end_snapshot(&mut self, snapshot: Snapshot) {
        let Snapshot {
            id,
            file,
            dropped_before,
            ..
        } = snapshot;
        let (tick, dropped) = (file.last_tick, self.dropped() - dropped_before);
        match file.finish(dropped, true, &[]) {
            Ok(path) => self.tell(ArchiveNews::Done { id, tick, path }),
            Err(error) => self.tell(ArchiveNews::Refused {
                id,
                reason: error.to_string(),
            }),
        }
    }
}
