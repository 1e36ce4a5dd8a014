//! The bytes of every message, kept. `golden/*.bin` is the payload, `golden/*.json` the type and
//! the value; clients in other languages read the same files in their tests. A published message
//! never changes, so neither does a file; a new message gets new ones: `BLESS=1 cargo test -p
//! palpate-proto --test golden` writes those that are missing.

mod common;

use std::fmt::Debug;
use std::path::PathBuf;

use palpate_proto::codec::{decode, encode, encoding_schema};
use palpate_proto::messages::{EventKind, Message, SimEvent};

fn check<M: Message + PartialEq + Debug>(file: &str, value: &M) {
    let stem = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("golden")
        .join(file);
    let (bin, json) = (stem.with_extension("bin"), stem.with_extension("json"));
    if std::env::var_os("BLESS").is_some() && !bin.exists() {
        let document = serde_json::json!({ "type": M::NAME, "schema": encoding_schema::<M>(), "value": value });
        std::fs::write(&bin, encode(value)).unwrap();
        std::fs::write(
            &json,
            serde_json::to_string_pretty(&document).unwrap() + "\n",
        )
        .unwrap();
    }
    let bytes = std::fs::read(&bin)
        .unwrap_or_else(|e| panic!("{}: {e}; BLESS=1 writes missing files", bin.display()));
    let document: serde_json::Value =
        serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    let from_json: M = serde_json::from_value(document["value"].clone()).unwrap();
    assert_eq!(document["type"], M::NAME, "{file}");
    assert_eq!(document["schema"], encoding_schema::<M>(), "{file}");
    assert_eq!(&from_json, value, "{file}.json is not the value");
    assert_eq!(
        encode(&from_json),
        bytes,
        "{file}: the value no longer has these bytes"
    );
    assert_eq!(
        &decode::<M>(&bytes, &encoding_schema::<M>()).unwrap(),
        value,
        "{file}: the bytes no longer have this value"
    );
}

#[test]
fn every_message_keeps_its_bytes() {
    check("tool_pose", &common::tool_pose());
    check("tool_force", &common::tool_force());
    check("tool_force_v2", &common::tool_force_v2());
    check("tool_contact", &common::tool_contact());
    check("device_info", &common::device_info());
    check("control_net", &common::control_net());
    check("control_net_polynomial", &common::control_net_polynomial());
    check("contact_set", &common::contact_set());
    check("loop_status", &common::loop_status());
    check("scene_snapshot", &common::scene_snapshot());
    for (name, event) in common::events() {
        check(&format!("sim_event_{name}"), &event);
    }
}

/// An independent reading of the layout, so that the files do not only agree with the library that
/// wrote them.
#[test]
fn a_pose_read_by_hand_is_the_pose() {
    let pose = common::tool_pose();
    let mut expected = vec![0xac, 0x02]; // 300 = 2 * 128 + 44, low seven bits first
    let mut t = pose.t_client_ns;
    while t >= 0x80 {
        expected.push((t as u8) | 0x80);
        t >>= 7;
    }
    expected.push(t as u8);
    let numbers = pose
        .position
        .iter()
        .chain(&pose.orientation)
        .chain(&pose.linear_velocity);
    for x in numbers.chain(&pose.angular_velocity) {
        expected.extend_from_slice(&x.to_le_bytes());
    }
    expected.extend_from_slice(&[1, 0]);
    assert_eq!(encode(&pose), expected);
}

/// The same for a description of a device: a string, bytes and numbers.
#[test]
fn a_device_read_by_hand_is_the_device() {
    let device = common::device_info();
    let mut expected = vec![device.name.len() as u8];
    expected.extend_from_slice(device.name.as_bytes());
    expected.extend_from_slice(&[device.dof_force, device.dof_torque]);
    let numbers = [
        device.force_max,
        device.force_continuous,
        device.torque_max,
        device.mass,
        device.damping,
        device.coulomb_friction,
        device.encoder_resolution,
        device.rate_hz,
        device.delay_s,
        device.deadband,
    ];
    for x in device.workspace.iter().chain(&numbers) {
        expected.extend_from_slice(&x.to_le_bytes());
    }
    assert_eq!(encode(&device), expected);
}

/// A case of an event keeps its number; new ones follow.
#[test]
fn events_keep_the_numbers_of_the_table() {
    let document =
        std::fs::read_to_string(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../docs/wire.md"))
            .unwrap();
    let section = document
        .split("### `palpate.SimEvent.v1`")
        .nth(1)
        .and_then(|rest| rest.split("###").next())
        .unwrap();
    for (name, event) in common::events() {
        let start = SimEvent {
            kind: EventKind::Reset,
            ..event.clone()
        };
        // What comes before the kind is as long for all: the last byte of an event without fields
        // is its number.
        let number = encode(&event)[encode(&start).len() - 1];
        let entry = format!("{number} {}", name.replace('_', " "));
        assert!(
            section
                .split_whitespace()
                .collect::<Vec<_>>()
                .join(" ")
                .contains(&entry),
            "no {entry:?} in the table"
        );
    }
}

/// The worked example of docs/wire.md is the golden pose.
#[test]
fn the_documented_hexdump_is_the_golden_pose() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let document = std::fs::read_to_string(root.join("../docs/wire.md")).unwrap();
    let dump = document
        .split("```hex")
        .nth(1)
        .and_then(|rest| rest.split("```").next())
        .unwrap();
    let bytes: Vec<u8> = dump
        .lines()
        .flat_map(|line| line.split('#').next().unwrap_or("").split_whitespace())
        .map(|byte| u8::from_str_radix(byte, 16).unwrap())
        .collect();
    assert_eq!(
        bytes,
        std::fs::read(root.join("golden/tool_pose.bin")).unwrap()
    );
}
