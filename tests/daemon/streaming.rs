//! Recordings read as a stream: from any tick on, by an index that is believed only as far as it is
//! true, with the figures that the recorder left and those computed from the ticks alike.

use crate::live::{SOFT, bits, record};
use crate::scenes::RIGID;
use mcap::records::op;
use palpate_record::{
    Contents, Follower, Happening, Info, Origin, Session, Topic, computed_info, info, recover,
    replay,
};
use palpate_sim::tick::record::Command;
use std::ops::Range;
use std::path::Path;

const COMMANDS: [(u64, Command); 5] = [
    (100, Command::Pause),
    (150, Command::Resume),
    (200, Command::Pause),
    (200, Command::Reset),
    (333, Command::Quality(1)),
];

/// Figures that the recorder left, after making sure that the ticks come to the same.
fn agreed(path: &Path) -> Info {
    let session = Session::open(path).unwrap();
    let (left, computed) = (info(&session).unwrap(), computed_info(&session).unwrap());
    assert_eq!(
        (left.figures_from, computed.figures_from),
        (Origin::Index, Origin::Chunks)
    );
    let same = Info {
        figures_from: Origin::Index,
        ..computed
    };
    assert_eq!(left, same);
    // To the last digit of the JSON as well.
    let text = |info: &Info| serde_json::to_string(info).unwrap();
    assert_eq!(text(&left), text(&same));
    left
}

#[test]
fn figures_left_by_the_recorder_are_those_of_the_ticks() {
    let directory = tempfile::tempdir().unwrap();
    for (name, text, ticks) in [("rigid", RIGID, 1_000), ("soft", SOFT, 500)] {
        let path = directory.path().join(format!("{name}.mcap"));
        record(&path, text, ticks, &COMMANDS);
        let left = agreed(&path);
        assert_eq!((left.ticks, left.gaps, left.clean), (ticks, 0, true));
        assert_eq!(left.commands, COMMANDS.len() as u64);
        // Five stages and the whole tick.
        assert_eq!(left.stages.len(), 6);
        assert!(left.tools[0].contact_ticks > 0);
        // What is recovered of it has figures of its own, and no index was needed for that.
        let bytes = std::fs::read(&path).unwrap();
        let (cut, mended) = (path.with_extension("part"), path.with_extension("mended"));
        std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
        let half = info(&Session::open(&cut).unwrap()).unwrap();
        assert!(half.figures_from == Origin::Chunks && half.cut_short.is_some());
        let recovered = recover(&cut, &mended).unwrap();
        let mended = agreed(&mended);
        assert_eq!((mended.ticks, mended.clean), (recovered.ticks, false));
        assert_eq!(
            (mended.session_hash.as_str(), &mended.tools, &mended.stages),
            (half.session_hash.as_str(), &half.tools, &half.stages)
        );
    }
}

#[test]
fn a_follower_gives_every_tick_of_its_range_and_no_other() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("soft.mcap");
    let (_, records) = record(&path, SOFT, 400, &COMMANDS);
    let session = Session::open(&path).unwrap();
    let whole = Contents::of(&session).unwrap();
    let small = whole.session().unwrap();
    let ticks = |follower: Follower| -> Vec<u64> {
        let ticks = follower.only(&[Topic::Tick]);
        ticks.map(|happening| happening.unwrap().tick()).collect()
    };
    for session in [&session, &small] {
        for (from, until) in [
            (0, u64::MAX),
            (1, 1),
            (57, 233),
            (399, 400),
            (400, 900),
            (401, 900),
        ] {
            let expected: Vec<u64> = (from.max(1)..=until.min(400)).collect();
            let found = ticks(Follower::between(session, from, until));
            assert_eq!(found, expected, "{from} to {until}");
        }
        // The order is that of the simulation: nothing of a tick comes before its record.
        let mut now = 0;
        for happening in Follower::new(session) {
            match happening.unwrap() {
                Happening::Tick(record) => {
                    assert_eq!(record.output.tick, now + 1);
                    assert!(bits(&record) == bits(&records[now as usize]));
                    now += 1;
                }
                Happening::Event(_) => {}
                other => assert_eq!(other.tick(), now, "{other:?}"),
            }
        }
        assert_eq!(now, 400);
        // From anywhere it goes on as it would have.
        let mut follower = Follower::new(session);
        let mut rest = Vec::new();
        for _ in 0..150 {
            rest.push((follower.place(), follower.next().unwrap().unwrap()));
        }
        follower.step_back();
        assert_eq!(follower.next().unwrap().unwrap(), rest[149].1);
        for (place, happening) in rest.iter().rev() {
            follower.go(*place);
            assert_eq!(&follower.next().unwrap().unwrap(), happening);
            let next = Follower::at(session, *place).next();
            assert_eq!(&next.unwrap().unwrap(), happening);
        }
    }
    assert_eq!(small.tick_count(), 400);
}

fn number(bytes: &[u8], at: usize, len: usize) -> usize {
    let digits = bytes[at..at + len].iter().rev();
    digits.fold(0, |n, byte| n << 8 | usize::from(*byte))
}

/// By hand from the layout of MCAP: the records of a range, with their operation code and body.
fn records(bytes: &[u8], range: Range<usize>) -> Vec<(u8, Range<usize>)> {
    let (mut at, mut found) = (range.start, Vec::new());
    while at + 9 <= range.end {
        let body = at + 9..at + 9 + number(bytes, at + 1, 8);
        at = body.end;
        found.push((bytes[body.start - 9], body));
    }
    found
}

/// The chunk indexes of a finished file.
fn chunk_indexes(bytes: &[u8]) -> Vec<Range<usize>> {
    let footer = bytes.len() - 8 - 20;
    let summary = number(bytes, footer, 8);
    let records = records(bytes, summary..footer - 9).into_iter();
    records
        .filter(|(op, _)| *op == op::CHUNK_INDEX)
        .map(|(_, body)| body)
        .collect()
}

/// Times, place and length of a chunk, in the body of its index.
const FROM: usize = 0;
const AT: usize = 16;
const LEN: usize = 24;

fn set(bytes: &mut [u8], at: usize, value: u64) {
    bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
}

/// The checksum of the index is left out, as writers may.
fn unchecked(bytes: &mut [u8]) {
    let end = bytes.len() - 8;
    bytes[end - 4..end].fill(0);
}

type Lie = fn(&mut [u8], &[Range<usize>]);

#[test]
fn an_index_that_lies_is_not_believed_and_the_file_says_so() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("soft.mcap");
    let (_, was) = record(&path, SOFT, 400, &COMMANDS);
    let whole = std::fs::read(&path).unwrap();
    let indexes = chunk_indexes(&whole);
    assert!(indexes.len() > 2, "{}", indexes.len());
    let lies: [(&str, bool, Lie); 8] = [
        ("a flipped bit", false, |bytes, at| {
            bytes[at[1].start + AT] ^= 1
        }),
        ("beyond the end", true, |bytes, at| {
            let end = bytes.len() as u64;
            set(bytes, at[1].start + AT, end + 5);
        }),
        ("at the end of all numbers", true, |bytes, at| {
            set(bytes, at[1].start + AT, u64::MAX);
        }),
        ("one twice", true, |bytes, at| {
            let first = number(bytes, at[0].start + AT, 8) as u64;
            set(bytes, at[1].start + AT, first);
        }),
        ("over the next", true, |bytes, at| {
            let len = number(bytes, at[0].start + LEN, 8) as u64;
            set(bytes, at[0].start + LEN, len + 40);
        }),
        ("no length", true, |bytes, at| {
            set(bytes, at[0].start + LEN, 0)
        }),
        ("the summary begins elsewhere", true, |bytes, at| {
            let footer = bytes.len() - 8 - 20;
            let middle = at[1].start as u64 - 9;
            set(bytes, footer, middle);
        }),
        ("all of the summary in the data", true, |bytes, _| {
            let footer = bytes.len() - 8 - 20;
            set(bytes, footer, 9);
        }),
    ];
    for (name, unchecked_too, lie) in lies {
        let mut bytes = whole.clone();
        lie(&mut bytes, &indexes);
        if unchecked_too {
            unchecked(&mut bytes);
        }
        let session = Session::parse(Path::new(name), &bytes).unwrap();
        let why = session.cut_short().unwrap_or_default().to_owned();
        assert!(why.contains("the index"), "{name}: {why:?}");
        assert!(!session.has_index() && !session.is_whole(), "{name}");
        // Read without it, all is there.
        let report = replay(&session, 0, |_, _| {}).unwrap();
        assert!(
            report.first_difference.is_none() && !report.passed(),
            "{name}: {report:?}"
        );
        assert_eq!(report.ticks_matched, 400, "{name}");
        let ticks = Contents::of(&session).unwrap().ticks;
        assert!(was.iter().zip(&ticks).all(|(a, b)| bits(a) == bits(b)));
    }
    // Without its checksum and without a lie it is followed.
    let mut bytes = whole.clone();
    unchecked(&mut bytes);
    let session = Session::parse(Path::new("unchecked"), &bytes).unwrap();
    assert!(session.has_index() && session.is_whole());
}

// Times are believed until the chunk is read: a seek may miss what they hide, but who reads the
// chunk finds out, and the ticks are there.
#[test]
fn an_index_with_false_times_is_found_out_when_its_chunks_are_read() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("soft.mcap");
    record(&path, SOFT, 400, &COMMANDS);
    let mut bytes = std::fs::read(&path).unwrap();
    let indexes = chunk_indexes(&bytes);
    let middle = indexes[indexes.len() / 2].start;
    set(&mut bytes, middle + FROM, u64::MAX);
    unchecked(&mut bytes);
    let session = Session::parse(Path::new("times"), &bytes).unwrap();
    assert!(session.has_index());
    let found = computed_info(&session).unwrap();
    assert_eq!((found.ticks, found.gaps), (400, 0));
    let why = found.cut_short.unwrap();
    assert!(why.contains("times of a chunk"), "{why}");
}

#[test]
fn a_damaged_chunk_of_a_file_with_an_index_costs_its_own_ticks() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("rigid.mcap");
    record(&path, RIGID, 1_000, &[]);
    let whole = std::fs::read(&path).unwrap();
    let chunks = records(&whole, 8..whole.len() - 8).into_iter();
    let chunks: Vec<_> = chunks.filter(|(op, _)| *op == op::CHUNK).collect();
    let hit = chunks[chunks.len() / 2].1.clone();
    // In the data; in the checksum; in its length before compression: too long, then endless.
    type Damage = fn(&mut [u8], &Range<usize>);
    let damages: [Damage; 5] = [
        |bytes, hit| bytes[(hit.start + hit.end) / 2] ^= 4,
        |bytes, hit| bytes[hit.start + 24] ^= 1,
        |bytes, hit| set(bytes, hit.start + 16, 1 << 33),
        |bytes, hit| {
            set(bytes, hit.start + 16, u64::MAX);
            bytes[hit.start + 24..hit.start + 28].fill(0);
        },
        |bytes, hit| bytes[hit.start - 9] = 0x41,
    ];
    for (k, damage) in damages.into_iter().enumerate() {
        let mut bytes = whole.clone();
        damage(&mut bytes, &hit);
        let session = Session::parse(Path::new("damaged"), &bytes).unwrap();
        assert!(session.has_index() && session.cut_short().is_none(), "{k}");
        let found = computed_info(&session).unwrap();
        let why = found.cut_short.clone().unwrap_or_default();
        assert!(why.contains("a damaged chunk"), "{k}: {why:?}");
        assert!(
            !found.clean && found.ticks < 1_000 && found.ticks > 300,
            "{k}: {found}"
        );
        assert_eq!(
            (found.ticks + found.gaps, session.is_whole()),
            (1_000, false),
            "{k}"
        );
        // The figures that were left are of all ticks: they stand until the chunk is read.
        assert_eq!(info(&session).unwrap().ticks, 1_000);
        for session in [session, Session::parse(Path::new("new"), &bytes).unwrap()] {
            let report = replay(&session, 0, |_, _| {}).unwrap();
            assert!(report.first_difference.is_none() && !report.clean, "{k}");
            assert_eq!(report.gaps, found.gaps, "{k}");
            assert_eq!(
                report.ticks_matched + report.ticks_unreached,
                found.ticks,
                "{k}"
            );
        }
    }
}
