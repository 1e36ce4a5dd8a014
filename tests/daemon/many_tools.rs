//! Sessions of as many tools as a scene may have.

use crate::common::many_tools;
use crate::session::{Script, record};
use palpate_proto::recording as pb;
use palpate_record::{Session, replay};
use prost::Message as _;
use std::path::Path;

/// Mean length of a tick's message, bytes, and the number of tools in it.
fn tick_bytes(path: &Path) -> (f64, usize) {
    let bytes = std::fs::read(path).unwrap();
    let (mut sum, mut count, mut tools) = (0, 0, 0);
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        if message.channel.topic == "/sim/tick" {
            (sum, count) = (sum + message.data.len(), count + 1);
            tools = pb::Tick::decode(&message.data[..]).unwrap().tools.len();
        }
    }
    (sum as f64 / f64::from(count), tools)
}

// Pauses, resets and devices that say what they bear are among what happens.
#[test]
fn a_session_of_1_8_or_64_tools_replays_bit_for_bit_and_grows_with_them() {
    const TICKS: u64 = 160;
    let directory = tempfile::tempdir().unwrap();
    let mut bytes = Vec::new();
    for count in [1, 8, 64] {
        let path = directory.path().join(format!("{count}.mcap"));
        let more = "friction = { mu = 0.4 }\ngrip = { force_max_n = 0.3 }";
        let text = many_tools(0..count, more);
        let summary = record(&path, &text, &Script::new(5, TICKS, true));
        assert_eq!((summary.ticks, summary.dropped), (TICKS, 0));
        let session = Session::open(&path).unwrap();
        let report = replay(&session, 0, |_, _| {}).unwrap();
        assert!(
            report.passed() && report.ticks_matched == TICKS,
            "{count} tools: {report:?}"
        );
        let (mean, tools) = tick_bytes(&path);
        assert_eq!(tools, count);
        eprintln!("{count} tools: {mean:.0} bytes a recorded tick");
        bytes.push(mean);
    }
    let [one, eight, most] = bytes[..] else {
        unreachable!("three counts")
    };
    let each = (most - one) / 63.0;
    assert!(
        (150.0..400.0).contains(&each) && eight < one + 8.0 * each && one < 2.0 * each,
        "{one}, {eight}, {most} bytes a tick of 1, 8, 64 tools"
    );
}
