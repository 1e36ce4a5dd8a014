//! Damage of recordings, in process: it is told, losses are counted, and what is left is used.

use crate::live::{Live, SOFT, bits, record};
use crate::scenes::RIGID;
use mcap::records::{MessageHeader, Record};
use palpate_drive::journal::Journal;
use palpate_proto::recording as pb;
use palpate_record::{
    Contents, ReadError, Recorder, RecorderSettings, RecoverError, Session, WriteError, info,
    recover, replay,
};
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::{Command, TickRecord};
use prost::Message as _;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Copies an MCAP file message by message, each through `edit`; checksums are made anew.
fn rewrite(source: &Path, target: &Path, mut edit: impl FnMut(&str, &mut Vec<u8>)) {
    let bytes = std::fs::read(source).unwrap();
    let mut out = mcap::Writer::new(std::fs::File::create(target).unwrap()).unwrap();
    let mut channels = BTreeMap::new();
    for record in mcap::read::ChunkFlattener::new(&bytes).unwrap() {
        match record.unwrap() {
            Record::Channel(channel) => {
                let id = out
                    .add_channel(0, &channel.topic, "protobuf", &BTreeMap::new())
                    .unwrap();
                channels.insert(channel.id, (id, channel.topic));
            }
            Record::Message { header, data } => {
                let (channel_id, topic) = &channels[&header.channel_id];
                let mut data = data.into_owned();
                edit(topic, &mut data);
                let header = MessageHeader {
                    channel_id: *channel_id,
                    ..header
                };
                out.write_to_known_channel(&header, &data).unwrap();
            }
            Record::Metadata(metadata) => out.write_metadata(&metadata).unwrap(),
            Record::Attachment { header, data, .. } => {
                let (log_time, create_time) = (header.log_time, header.create_time);
                let (name, media_type) = (header.name, header.media_type);
                out.attach(&mcap::Attachment {
                    log_time,
                    create_time,
                    name,
                    media_type,
                    data,
                })
                .unwrap();
            }
            _ => {}
        }
    }
    out.finish().unwrap();
}

fn find(haystack: &[u8], needle: &[u8]) -> usize {
    haystack
        .windows(needle.len())
        .position(|window| window == needle)
        .unwrap()
}

#[test]
fn one_changed_byte_of_an_applied_pose_in_the_file_is_found_with_its_tick_and_field() {
    let directory = tempfile::tempdir().unwrap();
    let (whole, forged) = (
        directory.path().join("whole.mcap"),
        directory.path().join("forged.mcap"),
    );
    let (_, records) = record(&whole, RIGID, 400, &[]);
    let record = &records[249];
    assert!(record.output.tools[0].contact.is_some());
    let x = record.input.poses[0].unwrap().position.x;
    let mut changed = 0;
    rewrite(&whole, &forged, |topic, data| {
        if topic == "/sim/tick" && pb::Tick::decode(&data[..]).unwrap().tick == 250 {
            let at = find(data, &x.to_le_bytes());
            data[at] ^= 1;
            changed += 1;
        }
    });
    assert_eq!(changed, 1);
    let report = replay(&Session::open(&forged).unwrap(), 0, |_, _| {}).unwrap();
    assert!(!report.passed());
    assert_eq!(report.ticks_matched, 249);
    let difference = report
        .first_difference
        .expect("a forged byte went unnoticed");
    assert_eq!(
        (difference.tick, difference.field.as_str()),
        (250, "tools[0].force_n.x")
    );
    assert_eq!(
        difference.recorded,
        format!("{:e}", record.output.tools[0].force_n.x)
    );
    assert!(
        difference.recorded != difference.replayed && difference.ulps.is_some_and(|ulps| ulps > 0)
    );

    // The same through a copy that changes nothing: it is the byte that was found, not the copying.
    rewrite(&whole, &forged, |_, _| {});
    assert!(
        replay(&Session::open(&forged).unwrap(), 0, |_, _| {})
            .unwrap()
            .passed()
    );
}

// A byte of an exponent makes a pose huge or NaN; one of an unused velocity shows in nothing but
// the state.
#[test]
fn every_byte_of_a_pose_counts() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("rigid.mcap");
    record(&path, RIGID, 300, &[]);
    let mut session = Contents::open(&path).unwrap();
    session.ticks.truncate(252);
    let whole = session.ticks[249].input.poses[0].unwrap();
    for k in 0..13 {
        for byte in 0..8 {
            let mut forged = session.clone();
            let pose = forged.ticks[249].input.poses[0].as_mut().unwrap();
            let slot = match k {
                0..3 => &mut pose.position[k],
                3..7 => &mut pose.orientation.as_mut_unchecked().coords[k - 3],
                7..10 => &mut pose.linear_velocity[k - 7],
                _ => &mut pose.angular_velocity[k - 10],
            };
            *slot = f64::from_bits(slot.to_bits() ^ 0x7f << (8 * byte));
            assert_ne!(format!("{whole:?}"), format!("{pose:?}"));
            let report = replay(&forged.session().unwrap(), 200, |_, _| {}).unwrap();
            let difference = report
                .first_difference
                .unwrap_or_else(|| panic!("value {k}, byte {byte} unnoticed"));
            assert_eq!(
                difference.tick, 250,
                "value {k}, byte {byte}: {difference:?}"
            );
        }
    }
}

/// By hand from the layout of MCAP, as an oracle: for each chunk with its message indexes, where it
/// is and how many messages of a channel it and those before it hold.
fn chunks(bytes: &[u8], channel: u16) -> Vec<(Range<usize>, usize)> {
    let number = |at: usize, len: usize| {
        bytes[at..at + len]
            .iter()
            .rev()
            .fold(0, |n, byte| n << 8 | usize::from(*byte))
    };
    let (mut at, mut chunk, mut count, mut chunks) = (8, 0..0, 0, Vec::new());
    while at + 9 < bytes.len() {
        let (op, len) = (bytes[at], number(at + 1, 8));
        match op {
            // Chunk: its messages are readable once it is whole; how many it has, its message
            // indexes tell.
            0x06 => chunk = at..at + 9 + len,
            0x07 if number(at + 9, 2) == usize::from(channel) => {
                count += number(at + 11, 4) / 16;
                chunks.push((chunk.clone(), count));
            }
            _ => {}
        }
        at += 9 + len;
    }
    chunks
}

fn tick_channel(bytes: &[u8]) -> u16 {
    let summary = mcap::Summary::read(bytes).unwrap().unwrap();
    summary
        .channels
        .values()
        .find(|channel| channel.topic == "/sim/tick")
        .unwrap()
        .id
}

/// xorshift64*, for places in files.
struct Places(u64);

impl Places {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % end
    }
}

#[test]
fn a_file_cut_anywhere_recovers_every_tick_of_every_whole_chunk() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("whole.mcap");
    let commands = [
        (300, Command::Pause),
        (320, Command::Resume),
        (450, Command::Reset),
    ];
    let (_, records) = record(&path, SOFT, 700, &commands);
    let bytes = std::fs::read(&path).unwrap();
    let chunks = chunks(&bytes, tick_channel(&bytes));
    assert_eq!(
        chunks.last().unwrap().1,
        700,
        "the oracle counts every tick"
    );
    // How many depends on how fast ticks come: chunks end by size or by time.
    assert!(chunks.len() > 4, "only {} chunks", chunks.len());

    let (cut_file, mended) = (
        directory.path().join("cut.mcap.part"),
        directory.path().join("mended.mcap"),
    );
    let was: Vec<String> = records.iter().map(bits).collect();
    // One in each of as many parts of the file.
    const CUTS: usize = 24;
    let (mut places, mut recovered_files) = (Places(20260), 0);
    for round in 0..CUTS {
        let cut = (round * bytes.len() + places.below(bytes.len())) / CUTS;
        let _ = std::fs::remove_file(&mended);
        std::fs::write(&cut_file, &bytes[..cut]).unwrap();
        let flushed = chunks
            .iter()
            .rev()
            .find(|(chunk, _)| chunk.end <= cut)
            .map_or(0, |(_, count)| *count);
        let recovered = match recover(&cut_file, &mended) {
            Ok(recovered) => recovered,
            Err(error) => {
                assert!(
                    matches!(error, RecoverError::Read(_)),
                    "cut at {cut}: {error}"
                );
                assert_eq!(flushed, 0, "cut at {cut}: {error}");
                continue;
            }
        };
        recovered_files += 1;
        assert!(
            recovered.cut_short.is_some() && recovered.ticks >= flushed as u64,
            "cut at {cut}: {recovered:?}"
        );
        let session = Session::open(&mended).unwrap();
        let kept = Contents::of(&session).unwrap();
        assert!(
            session.cut_short().is_none() && !session.is_clean() && session.gaps() == 0,
            "cut at {cut}"
        );
        assert_eq!(session.tick_count(), recovered.ticks);
        assert_eq!(kept.ticks.len() as u64, recovered.ticks);
        assert!(
            was.iter()
                .zip(&kept.ticks)
                .all(|(was, is)| *was == bits(is)),
            "cut at {cut}"
        );
        if round % 10 == 0 && !kept.keyframes.is_empty() {
            let report = replay(&session, 0, |_, _| {}).unwrap();
            assert!(
                report.first_difference.is_none() && !report.passed(),
                "cut at {cut}: {report:?}"
            );
            assert_eq!(report.ticks_matched, recovered.ticks);
        }
    }
    assert!(
        recovered_files > CUTS * 3 / 4,
        "only {recovered_files} pieces could be read"
    );
}

#[test]
fn a_file_with_any_byte_changed_is_read_in_part_or_refused_but_never_trusted() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("whole.mcap");
    let (_, records) = record(&path, RIGID, 300, &[]);
    let bytes = std::fs::read(&path).unwrap();
    let channel = tick_channel(&bytes);
    let chunks = chunks(&bytes, channel);
    let last = chunks.last().unwrap().0.end;
    let was: Vec<String> = records.iter().map(bits).collect();
    let mut places = Places(7);
    let (mut noticed, mut skipped) = (0, 0);
    for _ in 0..300 {
        let (at, bit) = (places.below(last), places.below(8));
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << bit;
        let Ok(session) = Contents::parse(Path::new("damaged"), &damaged) else {
            noticed += 1;
            continue;
        };
        noticed += u32::from(session.cut_short.is_some());
        for is in &session.ticks {
            assert!(
                was[is.output.tick as usize - 1] == bits(is),
                "bit {bit} of byte {at} went through to tick {}",
                is.output.tick
            );
        }
        // A damaged chunk takes its own ticks along, not those after it.
        if session
            .cut_short
            .as_ref()
            .is_some_and(|why| why.contains("damaged chunk"))
        {
            // The first chunk may hold channels only; they are repeated at the end of the file.
            let hit = chunks.iter().position(|(chunk, _)| chunk.contains(&at));
            let up_to = |k: usize| if k == 0 { 0 } else { chunks[k - 1].1 };
            let within = hit.map_or(0, |k| up_to(k + 1) - up_to(k));
            assert_eq!(session.ticks.len(), 300 - within, "bit {bit} of byte {at}");
            skipped += 1;
        }
    }
    assert!(
        noticed > 100 && skipped > 50,
        "only {noticed} of 300 flips were noticed, {skipped} chunks skipped"
    );
}

#[test]
fn a_recording_under_way_is_readable_up_to_its_last_flush() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("live.mcap");
    let part = directory.path().join("live.mcap.part");
    let mut live = Live::start(&path, SOFT);
    // Readable from the first moment on, with nothing in it.
    assert_eq!(Session::open(&part).unwrap().tick_count(), 0);
    (0..500).for_each(|_| live.tick());
    let (copy, mended) = (
        directory.path().join("copy.part"),
        directory.path().join("mended.mcap"),
    );
    let started = Instant::now();
    let session = loop {
        // What a kill at this moment would leave.
        std::fs::copy(&part, &copy).unwrap();
        let session = Session::open(&copy).unwrap();
        if session.tick_count() == 500 {
            break session;
        }
        assert!(
            started.elapsed() < Duration::from_secs(60),
            "{} of 500 ticks after a minute",
            session.tick_count()
        );
        std::thread::sleep(Duration::from_millis(20));
    };
    assert!(session.cut_short().is_some() && !session.is_clean());
    assert_eq!(recover(&copy, &mended).unwrap().ticks, 500);
    let report = replay(&Session::open(&mended).unwrap(), 0, |_, _| {}).unwrap();
    assert!(
        report.first_difference.is_none() && report.ticks_matched == 500 && !report.clean,
        "{report:?}"
    );
    let (summary, _) = live.finish();
    assert_eq!(summary.ticks, 500);
    assert!(
        replay(&Session::open(&path).unwrap(), 0, |_, _| {})
            .unwrap()
            .passed()
    );
    // Recovering a whole file gives it again, clean; recovering it onto itself would destroy it.
    assert!(matches!(
        recover(&path, &mended),
        Err(RecoverError::Write(WriteError::Exists { .. }))
    ));
    std::fs::remove_file(&mended).unwrap();
    recover(&path, &mended).unwrap();
    assert!(
        replay(&Session::open(&mended).unwrap(), 0, |_, _| {})
            .unwrap()
            .passed()
    );
    assert!(matches!(
        recover(&path, &path),
        Err(RecoverError::SameFile(_))
    ));
}

#[test]
fn files_of_other_kinds_are_told_apart() {
    let directory = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| -> PathBuf {
        let path = directory.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let open = |path: &Path| Contents::open(path).expect_err("read as a session");
    for (name, content) in [
        ("empty", &b""[..]),
        ("text", b"tick,force\n1,0.5\n"),
        ("half a magic", &mcap::MAGIC[..5]),
    ] {
        let error = open(&write(name, content));
        assert!(
            matches!(error, ReadError::NotMcap { .. }),
            "{name}: {error}"
        );
        assert!(
            error.to_string().contains("not an MCAP file"),
            "{name}: {error}"
        );
    }
    let error = open(&write("magic only", mcap::MAGIC));
    assert!(matches!(error, ReadError::Foreign { .. }), "{error}");
    assert!(matches!(
        open(&directory.path().join("none")),
        ReadError::Io { .. }
    ));
    assert!(matches!(open(directory.path()), ReadError::Io { .. }));

    // Somebody else's MCAP, with a topic of ours even.
    let foreign = directory.path().join("foreign.mcap");
    let mut writer = mcap::Writer::new(std::fs::File::create(&foreign).unwrap()).unwrap();
    let channel_id = writer
        .add_channel(0, "/sim/keyframe", "json", &BTreeMap::new())
        .unwrap();
    let header = MessageHeader {
        channel_id,
        sequence: 0,
        log_time: 0,
        publish_time: 0,
    };
    writer.write_to_known_channel(&header, b"{}").unwrap();
    writer.finish().unwrap();
    let error = open(&foreign);
    assert!(
        matches!(error, ReadError::Foreign { .. } | ReadError::Message { .. }),
        "{error}"
    );
    assert!(
        error.to_string().contains("not a Palpate recording"),
        "{error}"
    );
    let target = directory.path().join("x");
    assert!(matches!(
        recover(&foreign, &target),
        Err(RecoverError::Read(_))
    ));
    assert!(
        !target.exists() && !directory.path().join("x.part").exists(),
        "a refused file leaves nothing behind"
    );

    // Ours, but from the future; and ours with a message that breaks its promise.
    let (whole, other) = (
        directory.path().join("whole.mcap"),
        directory.path().join("other.mcap"),
    );
    record(&whole, RIGID, 20, &[]);
    let bytes = std::fs::read(&whole).unwrap();
    let mut future = bytes.clone();
    let at = find(&future, b"\x06\0\0\0format\x01\0\0\0") + 14;
    future[at] = b'9';
    // Metadata records carry no checksum of their own.
    let error = Session::parse(Path::new("future"), &future).unwrap_err();
    assert!(
        matches!(&error, ReadError::Format { found, .. } if found == "9"),
        "{error}"
    );
    rewrite(&whole, &other, |topic, data| {
        if topic == "/sim/tick" {
            let mut tick = pb::Tick::decode(&data[..]).unwrap();
            // Recordings without errors of forces have one value less.
            let values = &mut tick.tools[0].values;
            values.truncate(values.len() - 2);
            *data = tick.encode_to_vec();
        }
    });
    let error = open(&other);
    assert!(matches!(error, ReadError::Message { .. }), "{error}");
    assert!(error.to_string().contains("20 values, not 21"), "{error}");
}

// Numbers no recorder writes: tick 0, the last tick there is, ticks twice, a tick of 200 years.
#[test]
fn impossible_numbers_in_a_file_are_no_reason_to_panic() {
    let directory = tempfile::tempdir().unwrap();
    let (whole, odd) = (
        directory.path().join("whole.mcap"),
        directory.path().join("odd.mcap"),
    );
    record(&whole, RIGID, 20, &[(4, Command::Pause)]);
    for number in [0, 5, 1 << 40, u64::MAX] {
        rewrite(&whole, &odd, |topic, data| match topic {
            "/sim/tick" => {
                let mut tick = pb::Tick::decode(&data[..]).unwrap();
                if tick.tick == 10 {
                    tick.tick = number;
                    *data = tick.encode_to_vec();
                }
            }
            "/sim/command" => {
                *data = pb::Command {
                    after_tick: number,
                    ..pb::Command::decode(&data[..]).unwrap()
                }
                .encode_to_vec()
            }
            _ => {}
        });
        let session = Session::open(&odd).unwrap();
        let figures = info(&session).unwrap();
        assert_eq!(figures.ticks, 20, "{figures}");
        assert!(!replay(&session, 0, |_, _| {}).unwrap().passed());
        assert_eq!(
            recover(
                &odd,
                &directory.path().join(format!("mended-{number}.mcap"))
            )
            .unwrap()
            .ticks,
            20
        );
    }
    let mut foreign_state = Contents::open(&whole).unwrap();
    foreign_state.keyframes[0].saved.floats.pop();
    assert!(
        replay(&foreign_state.session().unwrap(), 0, |_, _| {})
            .unwrap_err()
            .to_string()
            .contains("does not fit this scene")
    );
    foreign_state.keyframes.clear();
    assert!(
        replay(&foreign_state.session().unwrap(), 0, |_, _| {})
            .unwrap_err()
            .to_string()
            .contains("no keyframe")
    );
}

#[test]
fn what_a_full_ring_loses_is_counted_and_the_file_says_so() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("flood.mcap");
    let Live {
        scene,
        mut state,
        recorder,
        mut port,
        mut nets,
        ..
    } = Live::start(&path, RIGID);
    let gauges = recorder.gauges();
    let (mut pushed, mut record) = (0, TickRecord::for_tools(1));
    // Far faster than any writer: the ring is full within milliseconds.
    while gauges.dropped.load(Ordering::Relaxed) < 100 && pushed < 20_000_000 {
        for _ in 0..5_000 {
            pushed += 1;
            state.tick = pushed;
            record.output.tick = pushed;
            nets.begin();
            port.tick(&scene, &state, &record, &mut nets);
        }
    }
    drop(port);
    let summary = recorder.finish().last().unwrap();
    assert!(
        summary.dropped >= 100,
        "{pushed} ticks in no time, and all were written"
    );
    assert_eq!(
        summary.ticks + summary.dropped,
        pushed,
        "every tick is written or counted"
    );
    let session = Session::open(&path).unwrap();
    let figures = info(&session).unwrap();
    assert_eq!(
        (figures.dropped_records, figures.ticks),
        (summary.dropped, summary.ticks)
    );
    // Ticks lost at the very end leave no gap between others.
    assert!(
        figures.gaps <= summary.dropped && !figures.clean,
        "{figures}"
    );
    let report = replay(&session, 0, |_, _| {}).unwrap();
    assert!(!report.clean && !report.passed(), "{report:?}");
    assert!(report.ticks_recorded == summary.ticks);
}

// Losses are no differences: what is there is compared, from the next keyframe after each gap on.
#[test]
fn ticks_missing_in_the_middle_are_gaps_and_the_rest_is_still_compared() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("whole.mcap");
    record(&path, SOFT, 500, &[(250, Command::Reset)]);
    let mut session = Contents::open(&path).unwrap();
    session
        .ticks
        .retain(|record| !(120..=130).contains(&record.output.tick));
    let report = replay(&session.session().unwrap(), 0, |_, _| {}).unwrap();
    assert_eq!(report.first_difference, None);
    assert!(report.gaps == 11 && !report.passed());
    // 1 ..= 119, then from the keyframe of tick 200 on.
    assert_eq!(report.ticks_matched, 119 + 300);
}

#[test]
fn a_place_that_cannot_be_written_is_an_error_at_the_start() {
    let directory = tempfile::tempdir().unwrap();
    let blocker = directory.path().join("file");
    std::fs::write(&blocker, b"").unwrap();
    let loaded = file::parse(RIGID, "test.toml", Path::new(".")).unwrap();
    let scene = Scene::build(&loaded.spec, Path::new(".")).unwrap();
    let start = |path: PathBuf| {
        let settings = RecorderSettings::new(RIGID, &loaded.spec).to(&path);
        Recorder::start(settings, &scene)
            .map(|_| ())
            .expect_err("started")
    };
    let error = start(blocker.join("below/a/file.mcap"));
    assert!(
        matches!(&error, WriteError::Io { .. }) && error.to_string().contains("file.mcap"),
        "{error}"
    );
    #[cfg(target_os = "linux")]
    {
        std::os::unix::fs::symlink("/dev/full", directory.path().join("full.mcap.part")).unwrap();
        let error = start(directory.path().join("full.mcap"));
        assert!(error.to_string().contains("full.mcap.part"), "{error}");
    }
}
