//! Disks that are slow to answer, or answer that they failed: what a recording keeps, and what it
//! says.

use crate::keeping::{answer, answers, holds, news, parts, ticks};
use crate::live::{Live, SOFT};
use crate::scenes::RIGID;
use palpate_drive::archive::{Archive, ArchiveNews, ArchiveRequest};
use palpate_drive::journal::{Journal as _, keeping};
use palpate_record::{
    Contents, Disk, DiskFile, DiskSync, DiskTask, FileSystem, RecorderSettings, Session, Split,
    WriteError, recover, replay,
};
use palpate_sim::tick::record::Command;
use std::collections::VecDeque;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// A disk that answers when it is let, and fails when it is told to.
#[derive(Clone, Default)]
struct Slow {
    answers: Arc<AtomicBool>,
    fails: Arc<AtomicBool>,
    /// Syncs that it was asked for.
    asked: Arc<AtomicU64>,
    /// Writes wait for as long as this is set; how many do.
    holds_writes: Arc<AtomicBool>,
    held: Arc<AtomicU64>,
}

struct SlowSync {
    of: Slow,
    waiting: VecDeque<DiskTask>,
    sync: Box<dyn DiskSync>,
}

struct SlowFile(Slow, Box<dyn Write + Send>);

impl Disk for Slow {
    fn create(&self, path: &Path) -> io::Result<DiskFile> {
        let DiskFile { bytes, sync } = FileSystem.create(path)?;
        Ok(DiskFile {
            bytes: Box::new(SlowFile(self.clone(), bytes)),
            sync: Box::new(SlowSync {
                of: self.clone(),
                waiting: VecDeque::new(),
                sync,
            }),
        })
    }
}

impl DiskSync for SlowSync {
    fn begin(&mut self, task: DiskTask) {
        self.of.asked.fetch_add(1, Ordering::Relaxed);
        self.waiting.push_back(task);
    }

    fn ended(&mut self, within: Duration) -> Option<io::Result<()>> {
        if self.of.fails.load(Ordering::Relaxed) {
            return Some(Err(io::Error::from_raw_os_error(5)));
        }
        if !self.of.answers.load(Ordering::Relaxed) {
            return None;
        }
        self.waiting
            .drain(..)
            .for_each(|task| self.sync.begin(task));
        self.sync.ended(within)
    }
}

impl Write for SlowFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.held.fetch_add(1, Ordering::Relaxed);
        while self.0.holds_writes.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(1));
        }
        self.0.held.fetch_sub(1, Ordering::Relaxed);
        self.1.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.1.flush()
    }
}

/// A simulation that records to `name` in a folder, on a disk that does not answer.
fn recording(text: &str, folder: &Path, name: &str, split: Split) -> (Live, Slow, PathBuf) {
    let (disk, path) = (Slow::default(), folder.join(name));
    let on = disk.clone();
    let live = Live::with(text, |settings| RecorderSettings {
        disk: Arc::new(on),
        directory: folder.to_owned(),
        split,
        ring: Some(Duration::from_secs(60)),
        ..settings.to(&path)
    });
    (live, disk, path)
}

fn wait_for(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < Duration::from_secs(60), "never: {what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn part_of(path: &Path) -> PathBuf {
    format!("{}.part", path.display()).into()
}

fn start(archive: &mut Box<dyn Archive>, id: u64, name: &str) {
    let path = Some(name.into());
    archive.ask(id, ArchiveRequest::Start { path });
}

// What a kill at any moment leaves is what the file has: the system keeps what was handed to it.
#[test]
fn ticks_reach_the_file_while_the_disk_answers_no_sync() {
    let folder = tempfile::tempdir().unwrap();
    let (mut live, disk, path) = recording(RIGID, folder.path(), "a.mcap", Split::default());
    wait_for("a sync under way", || {
        ticks(&mut live, 10);
        disk.asked.load(Ordering::Relaxed) > 0
    });
    for _ in 0..3 {
        ticks(&mut live, 100);
        let done = live.records.len() as u64;
        // A copy, as of that moment.
        let left = folder.path().join("left.part");
        wait_for("all ticks in the file", || {
            std::fs::copy(part_of(&path), &left).unwrap();
            Session::open(&left).unwrap().tick_range() == Some((1, done))
        });
    }
    assert_eq!(disk.asked.load(Ordering::Relaxed), 1, "it was asked again");
    disk.answers.store(true, Ordering::Relaxed);
    let (summary, records) = live.finish();
    assert_eq!((summary.ticks, summary.dropped), (records.len() as u64, 0));
    holds(&path, &records, 1, records.len() as u64);
}

#[test]
fn who_ends_a_recording_is_told_when_the_disk_does_not_confirm_it() {
    let folder = tempfile::tempdir().unwrap();
    let (mut live, disk, path) = recording(SOFT, folder.path(), "a.mcap", Split::default());
    let mut archive = live.recorder.archive().unwrap();
    ticks(&mut live, 150);
    wait_for("all ticks in the file", || {
        Session::open(&part_of(&path)).unwrap().tick_count() == 150
    });
    let snapshot = folder.path().join("s.mcap");
    archive.ask(
        1,
        ArchiveRequest::Snapshot {
            before_s: 60.0,
            after_s: 0.0,
            path: Some("s.mcap".into()),
        },
    );
    archive.ask(2, ArchiveRequest::Stop);
    let refused = answers(&mut archive, [1, 2]).map(Result::unwrap_err);
    for (told, file) in refused.iter().zip([&snapshot, &path]) {
        let name = part_of(file).display().to_string();
        assert!(
            told.contains(&name) && told.contains("did not confirm it within 2 s"),
            "{told}"
        );
        assert!(!file.exists(), "it has its name before the disk has it");
    }
    // The name is taken until then.
    start(&mut archive, 3, "a.mcap");
    assert!(
        answer(&mut archive, 3)
            .unwrap_err()
            .contains("exists already")
    );
    disk.answers.store(true, Ordering::Relaxed);
    news(
        &mut archive,
        |news| matches!(news, ArchiveNews::Stopped { path: p } if *p == path),
    );
    wait_for("the snapshot's name", || snapshot.exists());
    let (report, records) = live.report();
    assert!(report.failure.is_none(), "{report:?}");
    holds(&path, &records, 1, 150);
    assert!(Session::open(&snapshot).unwrap().is_whole());
}

#[test]
fn a_recording_that_the_disk_never_confirms_is_reported_and_complete() {
    let folder = tempfile::tempdir().unwrap();
    let (mut live, _disk, path) = recording(RIGID, folder.path(), "a.mcap", Split::default());
    ticks(&mut live, 200);
    let (report, records) = live.report();
    let failure = report.failure.expect("a failure");
    assert!(
        matches!(&failure, WriteError::Unconfirmed { path: p, .. } if *p == part_of(&path)),
        "{failure}"
    );
    assert!(!path.exists() && report.files.is_empty());
    recover(&part_of(&path), &path).unwrap();
    holds(&path, &records, 1, 200);
}

#[test]
fn a_sync_that_fails_ends_the_recording_and_says_what_may_be_gone() {
    let folder = tempfile::tempdir().unwrap();
    let (mut live, disk, path) = recording(RIGID, folder.path(), "a.mcap", Split::default());
    let mut archive = live.recorder.archive().unwrap();
    let gauges = live.recorder.gauges();
    disk.answers.store(true, Ordering::Relaxed);
    wait_for("two syncs", || {
        ticks(&mut live, 10);
        disk.asked.load(Ordering::Relaxed) > 1
    });
    disk.fails.store(true, Ordering::Relaxed);
    // The disk may have confirmed all ticks before; never these.
    ticks(&mut live, 10);
    let reason = |archive: &mut Box<dyn Archive>| match news(archive, |news| {
        matches!(news, ArchiveNews::Failed { .. })
    }) {
        ArchiveNews::Failed { reason, .. } => reason,
        other => panic!("{other:?}"),
    };
    let told = reason(&mut archive);
    let after: u64 = (told.split("after tick ").nth(1))
        .and_then(|rest| rest.split(' ').next()?.parse().ok())
        .unwrap_or_else(|| panic!("no tick: {told}"));
    assert!(
        told.contains("may be gone") && after < live.records.len() as u64,
        "{told}"
    );
    assert_eq!(gauges.state.load(Ordering::Relaxed), keeping::FAILED);
    assert!(part_of(&path).exists() && !path.exists());

    // The same when only the end of a recording meets it.
    disk.fails.store(false, Ordering::Relaxed);
    start(&mut archive, 1, "b.mcap");
    news(&mut archive, |news| {
        matches!(news, ArchiveNews::Started { .. })
    });
    ticks(&mut live, 20);
    answer(&mut archive, 1).unwrap();
    disk.fails.store(true, Ordering::Relaxed);
    archive.ask(2, ArchiveRequest::Stop);
    assert!(answer(&mut archive, 2).unwrap_err().contains("may be gone"));
    assert!(reason(&mut archive).contains("b.mcap.part"));
    let (report, _) = live.report();
    assert!(
        matches!(report.failure, Some(WriteError::Sync { .. })),
        "{report:?}"
    );
}

#[test]
fn parts_that_wait_for_the_disk_are_few_and_none_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let split = Split {
        duration: Some(Duration::from_millis(200)),
        ..Split::default()
    };
    let (mut live, disk, _) = recording(RIGID, folder.path(), "long.mcap", split);
    ticks(&mut live, 4_000);
    // The one that is written, and those that wait.
    wait_for("parts that wait", || parts(folder.path()).len() == 9);
    disk.answers.store(true, Ordering::Relaxed);
    let (report, records) = live.report();
    assert!(
        report.failure.is_none() && report.dropped == 0,
        "{report:?}"
    );
    let files = parts(folder.path());
    assert_eq!(files.len(), report.files.len());
    let mut next = 1;
    for (file, summary) in files.iter().zip(&report.files) {
        assert_eq!((file, summary.first_tick), (&summary.path, next));
        holds(file, &records, next, summary.last_tick);
        next = summary.last_tick + 1;
    }
    assert_eq!(next, 4_001);
}

// The rings hold eight seconds at 1 kHz.
#[test]
fn what_writes_that_stand_still_lose_is_counted_told_and_replayable() {
    let folder = tempfile::tempdir().unwrap();
    let (mut live, disk, path) = recording(RIGID, folder.path(), "a.mcap", Split::default());
    disk.answers.store(true, Ordering::Relaxed);
    ticks(&mut live, 300);
    disk.holds_writes.store(true, Ordering::Relaxed);
    live.keeps_pace = false;
    wait_for("a write that stands still", || {
        ticks(&mut live, 10);
        disk.held.load(Ordering::Relaxed) > 0
    });
    ticks(&mut live, 9_000);
    let gauges = live.recorder.gauges();
    assert!(gauges.dropped.load(Ordering::Relaxed) > 100);
    disk.holds_writes.store(false, Ordering::Relaxed);
    live.keeps_pace = true;
    ticks(&mut live, 300);
    let (report, records) = live.report();
    assert!(report.failure.is_none(), "{report:?}");
    let lost = report.dropped;
    let session = Session::open(&path).unwrap();
    assert_eq!(session.tick_count() + lost, records.len() as u64);
    assert!(session.gaps() == lost && !session.is_clean());
    let events = Contents::of(&session).unwrap().events;
    let told = events.iter().filter(|event| event.kind == "records_lost");
    let told = told.filter_map(|event| event.detail.split(' ').next()?.parse::<u64>().ok());
    assert_eq!(told.sum::<u64>(), lost, "{events:?}");
    let replayed = replay(&session, 0, |_, _| {}).unwrap();
    assert!(replayed.first_difference.is_none(), "{replayed:?}");
    // One tick comes before the keyframe that follows a loss.
    let reached = session.tick_count() - replayed.ticks_unreached;
    assert!(replayed.ticks_matched == reached && replayed.ticks_unreached <= 10);
}

#[test]
fn ticks_after_a_command_that_was_lost_are_lost_too_until_the_next_keyframe() {
    let folder = tempfile::tempdir().unwrap();
    let (mut live, disk, path) = recording(RIGID, folder.path(), "a.mcap", Split::default());
    disk.answers.store(true, Ordering::Relaxed);
    ticks(&mut live, 150);
    disk.holds_writes.store(true, Ordering::Relaxed);
    live.keeps_pace = false;
    wait_for("a write that stands still", || {
        ticks(&mut live, 1);
        disk.held.load(Ordering::Relaxed) > 0
    });
    let gauges = live.recorder.gauges();
    let before = gauges.dropped.load(Ordering::Relaxed);
    while gauges.dropped.load(Ordering::Relaxed) == before {
        live.port.command(live.state.tick, Command::Resume);
    }
    // It changes what comes next, and no reader of the file can know.
    live.command(Command::Pause);
    ticks(&mut live, 50);
    live.command(Command::Resume);
    disk.holds_writes.store(false, Ordering::Relaxed);
    live.keeps_pace = true;
    ticks(&mut live, 300);
    let (report, records) = live.report();
    assert!(report.dropped > 0 && report.failure.is_none(), "{report:?}");
    let session = Session::open(&path).unwrap();
    assert!(session.tick_count() < records.len() as u64);
    let replayed = replay(&session, 0, |_, _| {}).unwrap();
    assert!(replayed.first_difference.is_none(), "{replayed:?}");
    assert_eq!(replayed.ticks_matched, session.tick_count());
}
