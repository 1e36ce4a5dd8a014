//! Recordings that somebody made to do harm, and what changes without a checksum of MCAP's.

use crate::daemon::PROGRAM;
use crate::live::record;
use crate::scenes::RIGID;
use mcap::records::MessageHeader;
use palpate_record::{ReadError, Session};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout)
}

/// Runs the program with less address space than a file asks for.
fn within(megabytes: u32, arguments: &[&str]) -> Output {
    let script = format!("ulimit -v {}; exec \"$0\" \"$@\"", megabytes * 1024);
    let mut command = Command::new("sh");
    command.args(["-c", &script, PROGRAM]).args(arguments);
    command.output().unwrap()
}

/// The records of a file, outside chunks: operation code and body.
fn records(bytes: &[u8]) -> Vec<(u8, Vec<u8>)> {
    let (mut rest, mut records) = (&bytes[8..], Vec::new());
    while rest.len() > 8 {
        let len = u64::from_le_bytes(rest[1..9].try_into().unwrap()) as usize;
        records.push((rest[0], rest[9..9 + len].to_vec()));
        rest = &rest[9 + len..];
    }
    records
}

fn file_of<'a>(records: impl IntoIterator<Item = &'a (u8, Vec<u8>)>) -> Vec<u8> {
    let mut bytes = mcap::MAGIC.to_vec();
    for (op, body) in records {
        bytes.push(*op);
        bytes.extend((body.len() as u64).to_le_bytes());
        bytes.extend(body);
    }
    bytes
}

/// A session with a chunk behind its head that unpacks to messages of a topic.
fn with_messages(directory: &Path, count: usize, data: &[u8]) -> PathBuf {
    let whole = directory.join("whole.mcap");
    record(&whole, RIGID, 20, &[]);
    let bytes = std::fs::read(&whole).unwrap();
    let head = records(&bytes);
    let head = head.iter().take_while(|(op, _)| ![6, 7].contains(op));
    let head: Vec<_> = head.filter(|(op, _)| [1, 9, 12].contains(op)).collect();
    let mut writer = mcap::WriteOptions::new()
        .chunk_size(None)
        .compression(Some(mcap::Compression::Zstd))
        .create(std::io::Cursor::new(Vec::new()))
        .unwrap();
    let channel_id = writer
        .add_channel(0, "/sim/tick", "protobuf", &BTreeMap::new())
        .unwrap();
    for k in 0..count {
        let header = MessageHeader {
            channel_id,
            sequence: k as u32,
            log_time: k as u64,
            publish_time: 0,
        };
        writer.write_to_known_channel(&header, data).unwrap();
    }
    writer.finish().unwrap();
    let large = records(&writer.into_inner().into_inner());
    let chunk = large.iter().filter(|(op, _)| *op == 6);
    let path = directory.join("hostile.mcap");
    std::fs::write(&path, file_of(head.into_iter().chain(chunk))).unwrap();
    path
}

// Seen: a file of 266 kB took 7.4 GB.
#[test]
fn a_chunk_that_unpacks_to_a_gigabyte_is_damage_and_takes_no_gigabyte() {
    let directory = tempfile::tempdir().unwrap();
    let path = with_messages(directory.path(), 64, &vec![0; 16 << 20]);
    let size = std::fs::metadata(&path).unwrap().len();
    assert!(size < 4 << 20, "{size} bytes");
    for command in ["info", "replay"] {
        let output = within(700, &[command, path.to_str().unwrap()]);
        let text = words(&output);
        println!(
            "{size} bytes, {command}: {:?}, {text}",
            output.status.code()
        );
        assert!(
            matches!(output.status.code(), Some(0..=3)) && !text.contains("panicked"),
            "{text}"
        );
        if command == "info" {
            // Nothing of the chunk was taken.
            assert!(
                text.contains(" 0 ticks") && text.contains("cut short"),
                "{text}"
            );
        }
    }
}

// Seen: 24 MB of empty ticks took 8.7 GB.
#[test]
fn a_million_empty_ticks_take_no_gigabyte() {
    let directory = tempfile::tempdir().unwrap();
    let path = with_messages(directory.path(), 1_000_000, b"");
    let output = within(700, &["info", path.to_str().unwrap()]);
    let text = words(&output);
    assert!(
        matches!(output.status.code(), Some(0..=3)) && !text.contains("panicked"),
        "{:?} {text}",
        output.status
    );
}

// Metadata records carry no checksum of MCAP's: a letter of a tool's name, a digit of the rate.
#[test]
fn a_changed_letter_of_the_metadata_is_told() {
    let directory = tempfile::tempdir().unwrap();
    let whole = directory.path().join("whole.mcap");
    record(&whole, RIGID, 20, &[]);
    let bytes = std::fs::read(&whole).unwrap();
    assert_eq!(
        Session::parse(&whole, &bytes).unwrap().cut_short(),
        None,
        "as written"
    );
    let metadata: Vec<_> = records(&bytes)
        .into_iter()
        .filter(|(op, _)| *op == 12)
        .collect();
    assert_eq!(metadata.len(), 2);
    let (mut tried, mut refused) = (0, 0);
    for (_, body) in &metadata {
        let at = bytes.windows(body.len()).position(|w| w == body).unwrap();
        // Behind the record's own name; every seventh byte.
        for offset in (at + 24..at + body.len()).step_by(7) {
            let mut changed = bytes.clone();
            changed[offset] ^= 1;
            tried += 1;
            match Session::parse(&whole, &changed) {
                Err(_) => refused += 1,
                Ok(session) => assert!(
                    session.cut_short().is_some() && !session.is_whole(),
                    "byte {offset} changed, and nobody was told"
                ),
            }
        }
    }
    println!("{tried} bytes of metadata changed: all told, {refused} refused");
    assert!(tried > 50);
}

// Seen: "cut short … `palpate recover` makes a finished file" of a file that nothing was missing from.
#[test]
fn a_recording_compressed_in_another_way_is_refused_by_its_name() {
    let directory = tempfile::tempdir().unwrap();
    let whole = directory.path().join("whole.mcap");
    record(&whole, RIGID, 20, &[]);
    let mut all = records(&std::fs::read(&whole).unwrap());
    for (_, body) in all.iter_mut().filter(|(op, _)| *op == 6) {
        // Two times, a size, a checksum; then the name.
        assert_eq!(&body[28..36], b"\x04\0\0\0zstd");
        body.splice(28..36, *b"\x03\0\0\0lz4");
    }
    let body_end = all.iter().position(|(op, _)| *op == 15).unwrap();
    let error = Session::parse(&whole, &file_of(&all[..body_end])).unwrap_err();
    assert!(
        matches!(&error, ReadError::Compression { found, .. } if found == "lz4"),
        "{error}"
    );
    assert!(error.to_string().contains("mcap compress"), "{error}");
}
