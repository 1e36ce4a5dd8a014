//! What is kept of a session, and where: recordings on demand, the last seconds, parts, budgets,
//! and disks that fail.

use crate::live::{Live, SOFT, bits};
use crate::scenes::RIGID;
use palpate_drive::archive::{Archive, ArchiveNews, ArchiveRequest};
use palpate_drive::journal::keeping;
use palpate_record::{
    Contents, Disk, DiskFile, FileSystem, RecorderSettings, RecordingReport, Session, Split,
    WriteError, recover, replay,
};
use palpate_sim::tick::record::{Command, TickRecord};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Waits for news that fit.
pub fn news(archive: &mut Box<dyn Archive>, fits: impl Fn(&ArchiveNews) -> bool) -> ArchiveNews {
    let started = Instant::now();
    let mut seen = Vec::new();
    loop {
        match archive.news() {
            Some(news) if fits(&news) => return news,
            Some(news) => seen.push(news),
            None => std::thread::sleep(Duration::from_millis(2)),
        }
        assert!(
            started.elapsed() < Duration::from_secs(60),
            "no such news: {seen:?}"
        );
    }
}

/// The answer to a request.
pub fn answer(archive: &mut Box<dyn Archive>, wanted: u64) -> Result<(u64, PathBuf), String> {
    let [answer] = answers(archive, [wanted]);
    answer
}

/// The answers to requests, in whatever order they come.
pub fn answers<const N: usize>(
    archive: &mut Box<dyn Archive>,
    wanted: [u64; N],
) -> [Result<(u64, PathBuf), String>; N] {
    let mut answers = wanted.map(|_| None);
    while let Some(missing) = answers.iter().position(Option::is_none) {
        let own = |news: &ArchiveNews| match news {
            ArchiveNews::Done { id, .. } | ArchiveNews::Refused { id, .. } => wanted.contains(id),
            _ => false,
        };
        let (id, answer) = match news(archive, own) {
            ArchiveNews::Done { id, tick, path } => (id, Ok((tick, path))),
            ArchiveNews::Refused { id, reason } => (id, Err(reason)),
            other => panic!("{other:?}"),
        };
        let at = wanted.iter().position(|own| *own == id);
        answers[at.unwrap_or(missing)] = Some(answer);
    }
    answers.map(|answer| answer.unwrap())
}

pub fn ticks(live: &mut Live, count: usize) {
    (0..count).for_each(|_| live.tick());
}

/// A file holds exactly these ticks of what was simulated, and replays alone.
pub fn holds(path: &Path, records: &[TickRecord], from: u64, to: u64) {
    let session = Session::open(path).unwrap();
    let name = path.display();
    assert!(session.is_whole() && session.gaps() == 0, "{name}");
    assert_eq!(session.tick_range(), Some((from, to)), "{name}");
    let kept = Contents::of(&session).unwrap();
    assert_eq!(
        kept.keyframes[0].tick,
        from - 1,
        "{name} begins with a keyframe"
    );
    for is in &kept.ticks {
        assert!(
            bits(&records[is.output.tick as usize - 1]) == bits(is),
            "{name}, tick {}",
            is.output.tick
        );
    }
    let report = replay(&session, 0, |_, _| {}).unwrap();
    assert!(
        report.passed() && report.ticks_matched == to + 1 - from,
        "{name}: {report:?}"
    );
}

#[test]
fn recordings_begin_and_end_on_demand_and_each_replays() {
    let directory = tempfile::tempdir().unwrap();
    let mut live = Live::with(SOFT, |settings| RecorderSettings {
        directory: directory.path().join("new/one"),
        ..settings
    });
    let mut archive = live.recorder.archive().unwrap();
    assert!(live.recorder.archive().is_none(), "there is one");
    let state = |live: &Live| live.recorder.gauges().state.load(Ordering::Relaxed);
    ticks(&mut live, 130);
    assert_eq!(state(&live), keeping::OFF);
    archive.ask(1, ArchiveRequest::Stop);
    assert!(
        answer(&mut archive, 1)
            .unwrap_err()
            .contains("nothing is being recorded")
    );

    archive.ask(
        2,
        ArchiveRequest::Start {
            path: Some("first.mcap".into()),
        },
    );
    news(&mut archive, |news| {
        matches!(news, ArchiveNews::Started { .. })
    });
    live.command(Command::Pause);
    ticks(&mut live, 1);
    let (first, path) = answer(&mut archive, 2).unwrap();
    assert_eq!(
        (first, &path),
        (132, &directory.path().join("new/one/first.mcap"))
    );
    assert_eq!(state(&live), keeping::RECORDING);
    live.command(Command::Resume);
    ticks(&mut live, 150);
    live.command(Command::Reset);
    ticks(&mut live, 50);
    archive.ask(3, ArchiveRequest::Start { path: None });
    assert!(
        answer(&mut archive, 3)
            .unwrap_err()
            .contains("first.mcap is being recorded")
    );
    // What is in the rings now is written before the end.
    let last = live.records.len() as u64;
    archive.event(last, "tool_joined", "ball");
    let started = Instant::now();
    while Session::open(&directory.path().join("new/one/first.mcap.part"))
        .unwrap()
        .tick_count()
        < 200
    {
        assert!(started.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(10));
    }
    archive.ask(4, ArchiveRequest::Stop);
    let (end, path) = answer(&mut archive, 4).unwrap();
    assert_eq!(end, last);
    assert_eq!(state(&live), keeping::OFF);
    holds(&path, &live.records, 132, last);
    let session = Contents::open(&path).unwrap();
    assert_eq!(
        session
            .events
            .iter()
            .map(|event| (event.tick, event.kind.as_str()))
            .collect::<Vec<_>>(),
        [(last, "tool_joined")]
    );

    // Not recorded in between; then again, under a name of its own.
    ticks(&mut live, 70);
    archive.ask(5, ArchiveRequest::Start { path: None });
    news(&mut archive, |news| {
        matches!(news, ArchiveNews::Started { .. })
    });
    ticks(&mut live, 90);
    let (first, path) = answer(&mut archive, 5).unwrap();
    assert_eq!(first, last + 72);
    let (report, records) = live.report();
    assert_eq!(report.files.len(), 2);
    assert!(report.failure.is_none() && report.dropped == 0);
    holds(&path, &records, first, last + 160);
}

#[test]
fn a_recording_that_ends_before_its_first_tick_is_answered() {
    let directory = tempfile::tempdir().unwrap();
    let mut live = Live::with(RIGID, |settings| RecorderSettings {
        directory: directory.path().into(),
        ..settings
    });
    let mut archive = live.recorder.archive().unwrap();
    archive.ask(
        1,
        ArchiveRequest::Start {
            path: Some("empty.mcap".into()),
        },
    );
    archive.ask(2, ArchiveRequest::Stop);
    assert!(
        answer(&mut archive, 1)
            .unwrap_err()
            .contains("before its first tick")
    );
    let (_, path) = answer(&mut archive, 2).unwrap();
    let session = Session::open(&path).unwrap();
    assert!(session.tick_count() == 0 && session.cut_short().is_none());
    ticks(&mut live, 3);
}

#[test]
fn a_client_names_a_file_but_no_place() {
    let directory = tempfile::tempdir().unwrap();
    let mut live = Live::with(RIGID, |settings| RecorderSettings {
        directory: directory.path().into(),
        ..settings
    });
    let mut archive = live.recorder.archive().unwrap();
    std::fs::write(directory.path().join("there.mcap"), b"precious").unwrap();
    std::fs::write(directory.path().join("half.mcap.part"), b"precious too").unwrap();
    let places = [
        "../x.mcap",
        "/tmp/x.mcap",
        "a/b.mcap",
        "a.mcap/",
        "x.txt",
        "x",
        "",
        "..",
        ".mcap/..",
        ".mcap",
        ".hidden.mcap",
        "-rf.mcap",
        "~.mcap",
        " a.mcap",
        "a .mcap",
        "a\\b.mcap",
        "a\n.mcap",
        "a\u{1b}[2J.mcap",
        "a\u{9b}2J.mcap",
        "a\u{202e}pacm.mcap",
        "a\u{2028}.mcap",
        "a\u{200b}.mcap",
        "there.mcap",
        "half.mcap",
    ];
    for (k, place) in places.iter().enumerate() {
        archive.ask(
            k as u64,
            ArchiveRequest::Start {
                path: Some(place.into()),
            },
        );
        let reason = answer(&mut archive, k as u64).expect_err(place);
        let expected = match *place {
            "there.mcap" => "exists already",
            "half.mcap" => "palpate recover",
            _ => "is not a valid file name",
        };
        assert!(reason.contains(expected), "{place}: {reason}");
    }
    assert_eq!(
        std::fs::read(directory.path().join("there.mcap")).unwrap(),
        b"precious"
    );
    assert_eq!(
        std::fs::read(directory.path().join("half.mcap.part")).unwrap(),
        b"precious too"
    );
    assert_eq!(
        std::fs::read_dir(directory.path()).unwrap().count(),
        2,
        "refusals leave nothing behind"
    );
    ticks(&mut live, 3);
}

#[test]
fn a_snapshot_holds_the_seconds_before_and_after() {
    let directory = tempfile::tempdir().unwrap();
    let ring = Some(Duration::from_millis(500));
    let mut live = Live::with(SOFT, |settings| RecorderSettings {
        directory: directory.path().into(),
        ring,
        ..settings
    });
    let mut archive = live.recorder.archive().unwrap();
    let ask = |archive: &mut Box<dyn Archive>, id, before_s, after_s| {
        archive.ask(
            id,
            ArchiveRequest::Snapshot {
                before_s,
                after_s,
                path: None,
            },
        );
    };
    ticks(&mut live, 260);
    live.command(Command::Reset);
    ticks(&mut live, 790);
    // The recorder has seen them all once a snapshot of now has them.
    let started = Instant::now();
    let mut id = 0;
    let (last, path) = loop {
        id += 1;
        ask(&mut archive, id, 0.25, 0.0);
        let (last, path) = answer(&mut archive, id).unwrap();
        if last == 1_050 {
            break (last, path);
        }
        assert!(started.elapsed() < Duration::from_secs(60));
    };
    // Keyframes stand each 100 ticks: from the one before 800 on.
    holds(&path, &live.records, 801, last);
    ask(&mut archive, 100, 10.0, 0.2);
    ask(&mut archive, 101, 0.0, 0.05);
    while live.recorder.gauges().state.load(Ordering::Relaxed) != keeping::RING {
        std::thread::sleep(Duration::from_millis(1));
    }
    let begun = || {
        parts(directory.path())
            .iter()
            .filter(|path| path.extension().is_some_and(|kind| kind == "part"))
            .count()
    };
    while begun() < 2 {
        assert!(started.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(1));
    }
    ticks(&mut live, 300);
    let [short, long] = answers(&mut archive, [101, 100]).map(Result::unwrap);
    assert_eq!((short.0, long.0), (1_100, 1_250));
    // Ten seconds are more than there is: all that is held.
    holds(&long.1, &live.records, 501, 1_250);
    holds(&short.1, &live.records, 1_001, 1_100);
    for (before_s, after_s) in [
        (-1.0, 0.0),
        (0.0, f64::NAN),
        (f64::INFINITY, 0.0),
        (0.0, 1e9),
    ] {
        ask(&mut archive, 200, before_s, after_s);
        assert!(
            answer(&mut archive, 200)
                .unwrap_err()
                .contains("must be between 0 and 3600")
        );
    }
    drop(live);

    let mut without = Live::with(RIGID, |settings| settings);
    let mut archive = without.recorder.archive().unwrap();
    ask(&mut archive, 1, 1.0, 1.0);
    assert!(answer(&mut archive, 1).unwrap_err().contains("--ring"));
    ticks(&mut without, 1);
}

pub fn parts(directory: &Path) -> Vec<PathBuf> {
    let mut parts: Vec<_> = std::fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    parts.sort();
    parts
}

#[test]
fn every_part_of_a_split_session_replays_alone_and_none_is_missing() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("long.mcap");
    let split = Split {
        duration: Some(Duration::from_millis(250)),
        ..Split::default()
    };
    let mut live = Live::with(SOFT, |settings| RecorderSettings {
        split,
        ..settings.to(&path)
    });
    ticks(&mut live, 300);
    // A reset's keyframe begins a part as well as any, with the commands it holds on its near side.
    live.command(Command::Pause);
    live.command(Command::Reset);
    live.command(Command::Resume);
    ticks(&mut live, 650);
    let (report, records) = live.report();
    let files = parts(directory.path());
    assert_eq!(files.len(), report.files.len());
    assert!(
        files.len() >= 3 && files[0].ends_with("long-0001.mcap"),
        "{files:?}"
    );
    let mut next = 1;
    for (k, (path, summary)) in files.iter().zip(&report.files).enumerate() {
        assert_eq!(path, &summary.path);
        assert_eq!(summary.first_tick, next);
        holds(path, &records, next, summary.last_tick);
        next = summary.last_tick + 1;
        let header = Session::open(path).unwrap().header;
        assert_eq!(header.run["part"], (k + 1).to_string());
        assert_eq!(header.end.contains_key("next_part"), k + 1 < files.len());
    }
    assert_eq!(next, 951);
}

#[test]
fn a_disk_budget_keeps_the_newest_parts() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("rolling.mcap");
    // Each part begins with some 60 kB about its scene.
    let total = 800_000;
    let split = Split {
        bytes: Some(60_000),
        total_bytes: Some(total),
        ..Split::default()
    };
    let mut live = Live::with(RIGID, |settings| RecorderSettings {
        split,
        ..settings.to(&path)
    });
    let mut most = 0;
    for _ in 0..40 {
        ticks(&mut live, 100);
        std::thread::sleep(Duration::from_millis(5));
        // What is still there when all are measured was there at one time, and has not shrunk.
        let size = |path: &PathBuf| std::fs::metadata(path).map_or(0, |data| data.len());
        let measured: Vec<_> = (parts(directory.path()).into_iter())
            .map(|path| (size(&path), path))
            .collect();
        let still = parts(directory.path());
        let kept = measured.iter().filter(|(_, path)| still.contains(path));
        most = most.max(kept.map(|(bytes, _)| bytes).sum::<u64>());
    }
    let (report, records) = live.report();
    let files = parts(directory.path());
    assert!(
        report.files.len() > files.len() + 3 && files.len() > 2,
        "{} of {}",
        files.len(),
        report.files.len()
    );
    assert!(most <= total, "{most} bytes at one time");
    let kept = &report.files[report.files.len() - files.len()..];
    for (path, summary) in files.iter().zip(kept) {
        assert_eq!(path, &summary.path, "the newest are kept");
        holds(path, &records, summary.first_tick, summary.last_tick);
    }
    assert_eq!(kept.last().unwrap().last_tick, 4_000);
}

/// A disk that stands still once, or takes only so much.
#[derive(Clone, Default)]
struct Poor {
    written: Arc<AtomicU64>,
    /// Bytes it takes; 0: as many as there are.
    room: Arc<AtomicU64>,
    /// Byte at which it stands still, and for how long.
    stall: Option<(u64, Duration)>,
    stalled: Arc<AtomicU64>,
}

struct PoorFile(Poor, Box<dyn Write + Send>);

impl Disk for Poor {
    fn create(&self, path: &Path) -> io::Result<DiskFile> {
        let DiskFile { bytes, sync } = FileSystem.create(path)?;
        let bytes = Box::new(PoorFile(self.clone(), bytes));
        Ok(DiskFile { bytes, sync })
    }
}

impl Write for PoorFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let before = self
            .0
            .written
            .fetch_add(bytes.len() as u64, Ordering::Relaxed);
        let after = before + bytes.len() as u64;
        if let Some((_, pause)) = self.0.stall.filter(|(at, _)| (before..after).contains(at)) {
            self.0.stalled.fetch_add(1, Ordering::Relaxed);
            std::thread::sleep(pause);
        }
        let room = self.0.room.load(Ordering::Relaxed);
        if room > 0 && after > room {
            return Err(io::Error::from(io::ErrorKind::StorageFull));
        }
        self.1.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.1.flush()
    }
}

#[test]
fn a_disk_that_stands_still_for_a_second_costs_no_record() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("stalled.mcap");
    let disk = Poor {
        stall: Some((60_000, Duration::from_secs(1))),
        ..Poor::default()
    };
    let shared = disk.clone();
    let mut live = Live::with(SOFT, |settings| RecorderSettings {
        disk: Arc::new(disk),
        ..settings.to(&path)
    });
    // As fast as this machine can, which is faster than 1 kHz or not; the ring has room for eight
    // thousand.
    ticks(&mut live, 2_500);
    let (summary, records) = live.finish();
    assert_eq!(
        shared.stalled.load(Ordering::Relaxed),
        1,
        "the disk never stood still"
    );
    assert_eq!((summary.ticks, summary.dropped), (2_500, 0));
    let session = Session::open(&path).unwrap();
    let kept = Contents::of(&session).unwrap();
    assert!(
        kept.ticks
            .iter()
            .zip(&records)
            .all(|(is, was)| bits(is) == bits(was))
    );
    assert!(replay(&session, 0, |_, _| {}).unwrap().passed());
}

#[test]
fn a_full_disk_ends_the_recording_and_nothing_else() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("full.mcap");
    let disk = Poor {
        room: Arc::new(AtomicU64::new(1_000_000)),
        ..Poor::default()
    };
    let room = disk.room.clone();
    let mut live = Live::with(SOFT, |settings| RecorderSettings {
        disk: Arc::new(disk),
        directory: directory.path().into(),
        ..settings.to(&path)
    });
    let mut archive = live.recorder.archive().unwrap();
    let gauges = live.recorder.gauges();
    let started = Instant::now();
    while gauges.state.load(Ordering::Relaxed) != keeping::FAILED {
        ticks(&mut live, 100);
        assert!(
            started.elapsed() < Duration::from_secs(120),
            "the disk never filled up"
        );
    }
    let failed = news(&mut archive, |news| {
        matches!(news, ArchiveNews::Failed { .. })
    });
    assert!(
        matches!(&failed, ArchiveNews::Failed { path: p, .. } if *p == path),
        "{failed:?}"
    );
    // The loop goes on; what is lost is counted.
    ticks(&mut live, 200);
    while gauges.dropped.load(Ordering::Relaxed) < 200 {
        assert!(
            started.elapsed() < Duration::from_secs(120),
            "losses are not counted"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    let part = directory.path().join("full.mcap.part");
    let whole = Session::open(&part).unwrap();
    assert!(
        whole.tick_count() > 100 && whole.gaps() == 0 && whole.cut_short().is_some(),
        "{} ticks, {} gaps, {:?}",
        whole.tick_count(),
        whole.gaps(),
        whole.cut_short()
    );
    recover(&part, &directory.path().join("mended.mcap")).unwrap();
    let mended = replay(
        &Session::open(&directory.path().join("mended.mcap")).unwrap(),
        0,
        |_, _| {},
    )
    .unwrap();
    assert!(mended.first_difference.is_none() && mended.ticks_matched == whole.tick_count());

    // With room again, a new recording is as good as any.
    room.store(0, Ordering::Relaxed);
    archive.ask(
        9,
        ArchiveRequest::Start {
            path: Some("after.mcap".into()),
        },
    );
    news(&mut archive, |news| {
        matches!(news, ArchiveNews::Started { .. })
    });
    ticks(&mut live, 120);
    let (first, after) = answer(&mut archive, 9).unwrap();
    let (report, records) = live.report();
    let RecordingReport {
        files,
        failure,
        dropped,
    } = &report;
    assert!(
        failure.is_none() && files.len() == 1 && *dropped >= 200,
        "{report:?}"
    );
    holds(&after, &records, first, records.len() as u64);
}

/// Why a recording cannot begin.
fn refused(path: &Path, split: Split) -> WriteError {
    let loaded = palpate_sim::scene::file::parse(RIGID, "test.toml", Path::new(".")).unwrap();
    let scene = palpate_sim::scene::Scene::build(&loaded.spec, Path::new(".")).unwrap();
    let settings = RecorderSettings {
        split,
        ..RecorderSettings::new(RIGID, &loaded.spec).to(path)
    };
    palpate_record::Recorder::start(settings, &scene)
        .map(|_| ())
        .expect_err("started")
}

#[test]
fn a_disk_budget_that_its_parts_exceed_is_refused_with_the_numbers() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.mcap");
    let split = |bytes, total| Split {
        bytes,
        total_bytes: Some(total),
        ..Split::default()
    };
    let error = refused(&path, split(Some(500_000_000), 100_000_000));
    assert!(
        matches!(error, WriteError::PartAboveTotal { part_bytes: 500_000_000, total_bytes } if total_bytes == 100_000_000),
        "{error}"
    );
    let error = refused(&path, split(None, 50_000)).to_string();
    let numbers: Vec<u64> = (error.split(' ').filter_map(|word| word.parse().ok())).collect();
    let [50_000, head, least] = numbers[..] else {
        panic!("{error}");
    };
    assert!((10_000..200_000).contains(&head) && least > head, "{error}");
    assert!(parts(directory.path()).is_empty());
    // What it asks for is enough.
    Live::with(RIGID, |settings| RecorderSettings {
        split: split(None, least),
        ..settings.to(&path)
    })
    .finish();
}

#[test]
fn a_disk_budget_holds_whatever_else_ends_a_part() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("rolling.mcap");
    // Keyframes of its own come too late.
    let text = RIGID.replace("keyframe_s = 0.2", "keyframe_s = 60.0");
    let total = 600_000;
    let split = Split {
        duration: Some(Duration::from_secs(600)),
        total_bytes: Some(total),
        ..Split::default()
    };
    let mut live = Live::with(&text, |settings| RecorderSettings {
        split,
        ..settings.to(&path)
    });
    let mut archive = live.recorder.archive().unwrap();
    let mut most = 0;
    for round in 0..80 {
        ticks(&mut live, 100);
        // Between the answers to two requests the recorder has had a turn.
        for id in [2 * round, 2 * round + 1] {
            archive.ask(id, ArchiveRequest::Start { path: None });
            assert!(answer(&mut archive, id).is_err());
        }
        // A part may be renamed or deleted between being listed and being measured.
        let size = |path: PathBuf| std::fs::metadata(path).map_or(0, |data| data.len());
        most = most.max(parts(directory.path()).into_iter().map(size).sum::<u64>());
    }
    let (report, records) = live.report();
    assert!(most <= total, "{most} bytes at one time");
    let files = parts(directory.path());
    let (deleted, kept): (Vec<_>, Vec<_>) = report.files.iter().partition(|file| file.deleted);
    assert!(!deleted.is_empty() && kept.len() >= 2, "{report:?}");
    assert!(kept.iter().map(|file| &file.path).eq(&files), "{report:?}");
    for summary in &kept {
        holds(
            &summary.path,
            &records,
            summary.first_tick,
            summary.last_tick,
        );
    }
}

#[test]
fn a_recording_with_a_name_that_is_not_shown_as_it_is_does_not_begin() {
    let directory = tempfile::tempdir().unwrap();
    for name in ["a\u{7}.mcap", "a\u{202e}pacm.mcap"] {
        let error = refused(&directory.path().join(name), Split::default());
        assert!(matches!(error, WriteError::Name { .. }), "{error}");
        let said = error.to_string();
        assert!(!said.contains(['\u{7}', '\u{202e}']), "{said:?}");
    }
    assert!(parts(directory.path()).is_empty());
}

#[test]
fn nothing_is_overwritten() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("there.mcap");
    std::fs::write(&path, b"precious").unwrap();
    let start = |path: &Path| refused(path, Split::default());
    assert!(matches!(start(&path), WriteError::Exists { .. }));
    std::fs::rename(&path, directory.path().join("there.mcap.part")).unwrap();
    let error = start(&path);
    assert!(error.to_string().contains("palpate recover"), "{error}");
    assert_eq!(
        std::fs::read(directory.path().join("there.mcap.part")).unwrap(),
        b"precious"
    );
}
