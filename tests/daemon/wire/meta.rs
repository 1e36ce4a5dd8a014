//! What a daemon tells about itself: layouts, counters, past events.

use super::{SCENE, until};
use crate::daemon::Daemon;
use palpate_client::proto::messages::EventKind;
use palpate_client::proto::rpc::Call;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// Reads postcard by a layout alone.
struct Walker<'b>(&'b [u8]);

impl Walker<'_> {
    fn byte(&mut self) -> u8 {
        let (first, rest) = self.0.split_first().expect("bytes end early");
        self.0 = rest;
        *first
    }

    fn varint(&mut self) -> u64 {
        let (mut value, mut shift) = (0, 0);
        loop {
            let byte = self.byte();
            value |= u64::from(byte & 0x7f) << shift;
            shift += 7;
            if byte < 0x80 {
                return value;
            }
        }
    }

    fn take(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.byte()).collect()
    }

    fn fields(&mut self, fields: &Value) -> Value {
        let fields = fields.as_array().unwrap();
        Value::Object(
            fields
                .iter()
                .map(|f| (f["name"].as_str().unwrap().to_owned(), self.read(&f["ty"])))
                .collect::<Map<_, _>>(),
        )
    }

    fn read(&mut self, named: &Value) -> Value {
        let ty = &named["ty"];
        if let Some(simple) = ty.as_str() {
            return match simple {
                "Bool" => json!(self.byte() == 1),
                "U8" => json!(self.byte()),
                "U16" | "U32" | "U64" => json!(self.varint()),
                "F64" => json!(f64::from_le_bytes(self.take(8).try_into().unwrap())),
                "String" => {
                    let count = self.varint() as usize;
                    json!(String::from_utf8(self.take(count)).unwrap())
                }
                other => panic!("no reader for {other}"),
            };
        }
        let (kind, inner) = ty.as_object().unwrap().iter().next().unwrap();
        match kind.as_str() {
            "Option" => {
                if self.byte() == 0 {
                    Value::Null
                } else {
                    self.read(inner)
                }
            }
            "Seq" => {
                let count = self.varint();
                (0..count).map(|_| self.read(inner)).collect()
            }
            "Tuple" => inner
                .as_array()
                .unwrap()
                .iter()
                .map(|item| self.read(item))
                .collect(),
            "Struct" => self.fields(inner),
            "Enum" => {
                let case = &inner[self.varint() as usize];
                match &case["ty"] {
                    Value::String(unit) if unit == "UnitVariant" => case["name"].clone(),
                    variant => {
                        json!({ case["name"].as_str().unwrap(): self.fields(&variant["StructVariant"]) })
                    }
                }
            }
            other => panic!("no reader for {other}"),
        }
    }
}

#[test]
fn golden_messages_are_read_by_the_layouts_alone() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let palpate = daemon.connect();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("proto/golden");
    let mut names = BTreeMap::new();
    for entry in std::fs::read_dir(golden).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let document: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        let name = document["type"].as_str().unwrap().to_owned();
        let schema = names.entry(name.clone()).or_insert_with(|| -> Value {
            serde_json::from_str(&palpate.schema(&name).unwrap()).unwrap()
        });
        assert_eq!(schema["type"], *name);
        let bytes = std::fs::read(path.with_extension("bin")).unwrap();
        assert!(bytes.len() as u64 <= schema["max_bytes"].as_u64().unwrap());
        let mut walker = Walker(&bytes);
        assert_eq!(
            walker.read(&schema["layout"]),
            document["value"],
            "{}",
            path.display()
        );
        assert!(
            walker.0.is_empty(),
            "{}: {} bytes are left",
            path.display(),
            walker.0.len()
        );
    }
    assert_eq!(names.len(), 10, "{:?}", names.keys());
    // All of them at once, each under its own key.
    let all = palpate
        .ask(
            "palpate/default/@meta/schema/*",
            std::time::Duration::from_secs(20),
        )
        .unwrap();
    let mut keys: Vec<_> = all
        .iter()
        .map(|seen| seen.key.rsplit('/').next().unwrap().to_owned())
        .collect();
    keys.sort();
    assert_eq!(keys, names.keys().cloned().collect::<Vec<_>>());
    // Recordings: descriptors that any Protobuf library reads.
    let selector = "palpate/default/@meta/schema/palpate.v1.Tick?format=proto";
    let answers = palpate
        .ask(selector, std::time::Duration::from_secs(20))
        .unwrap();
    // The file of the type, with what it imports: that of ticks imports nothing.
    let (set, all) = (
        &answers[0].bytes,
        palpate_client::proto::recording::DESCRIPTORS,
    );
    assert!(
        set.len() > 1_000 && all.windows(set.len()).any(|part| part == &set[..]),
        "{} of {} bytes",
        set.len(),
        all.len()
    );
    assert_eq!(answers[0].schema(), "google.protobuf.FileDescriptorSet");
}

/// Values by series, after checks of the text's form: each family is announced once, with a type,
/// before its samples.
fn parse_metrics(text: &str) -> BTreeMap<String, f64> {
    assert!(text.ends_with("# EOF\n"), "{text}");
    let mut kinds = BTreeMap::new();
    let mut values = BTreeMap::new();
    for line in text.lines().take_while(|line| *line != "# EOF") {
        if let Some(rest) = line.strip_prefix("# TYPE ") {
            let (name, kind) = rest.split_once(' ').unwrap();
            assert!(["counter", "gauge", "info"].contains(&kind), "{line}");
            assert!(
                kinds.insert(name.to_owned(), kind.to_owned()).is_none(),
                "{name} is announced twice"
            );
        } else if let Some(rest) = line.strip_prefix("# UNIT ") {
            let (name, unit) = rest.split_once(' ').unwrap();
            assert!(name.ends_with(&format!("_{unit}")), "{line}");
        } else if !line.starts_with("# HELP ") {
            let (series, value) = line.rsplit_once(' ').unwrap();
            let name = series.split('{').next().unwrap();
            let (family, kind) = kinds
                .iter()
                .find(|(family, kind)| {
                    let suffix = match kind.as_str() {
                        "counter" => "_total",
                        "info" => "_info",
                        _ => "",
                    };
                    format!("{family}{suffix}") == name
                })
                .unwrap_or_else(|| panic!("{line} belongs to no family"));
            assert!(!family.ends_with("_total"), "{family} is a {kind}");
            let value: f64 = value.parse().unwrap_or_else(|e| panic!("{line}: {e}"));
            assert!(kind != "counter" || value >= 0.0);
            assert!(
                values.insert(series.to_owned(), value).is_none(),
                "{series} comes twice"
            );
        }
    }
    values
}

#[test]
fn counters_are_openmetrics_and_grow() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("a.mcap");
    let daemon = Daemon::start(
        directory.path(),
        SCENE,
        &["--record", file.to_str().unwrap()],
    );
    let palpate = daemon.connect();
    let first = parse_metrics(&palpate.metrics().unwrap());
    let look = || parse_metrics(&palpate.metrics().unwrap());
    let ticks = "palpate_loop_ticks_total";
    let later = until("ticks are counted", look, |now| {
        now[ticks] > first[ticks] + 200.0
    });
    for series in [
        "palpate_loop_late_ticks_total",
        "palpate_loop_skipped_ticks_total",
        "palpate_loop_overruns_total{stage=\"deform\"}",
        "palpate_loop_overruns_total{stage=\"wake\"}",
        "palpate_loop_quality",
        "palpate_loop_step_seconds{quantile=\"0.5\"}",
        "palpate_loop_period_seconds{quantile=\"0.99\"}",
        "palpate_recorder_written_bytes_total",
        "palpate_recorder_drops_total",
        "palpate_tool_poses_received_total{tool=\"ball\"}",
        "palpate_tool_energy_joules{tool=\"ball\"}",
    ] {
        assert!(later.contains_key(series), "{series} is missing: {later:?}");
    }
    assert_eq!(
        (
            later["palpate_loop_rate_hertz"],
            later["palpate_recorder_state"]
        ),
        (1_000.0, 1.0)
    );
    let growing = |name: &String| name.ends_with("_total") || name.contains("_total{");
    for (series, value) in first.iter().filter(|(series, _)| growing(series)) {
        assert!(later[series] >= *value, "{series} fell");
    }
    // A token says that it records.
    let tokens = palpate
        .live(
            "palpate/default/@live/*/*",
            std::time::Duration::from_secs(20),
            |keys| keys.len() > 1,
        )
        .unwrap();
    assert!(
        tokens.iter().any(|key| key.contains("/@live/recorder/")),
        "{tokens:?}"
    );
    assert!(
        !tokens.iter().any(|key| key.contains("/@live/viewer/")),
        "{tokens:?}"
    );
}

fn get(port: u16, path: &str) -> (String, String) {
    use std::io::{Read as _, Write as _};
    let mut stream = std::net::TcpStream::connect(("127.0.0.1", port)).unwrap();
    write!(
        stream,
        "GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n"
    )
    .unwrap();
    let mut text = String::new();
    stream.read_to_string(&mut text).unwrap();
    let (head, body) = text.split_once("\r\n\r\n").unwrap();
    (head.to_owned(), body.to_owned())
}

#[test]
fn the_page_s_port_serves_counters_and_health() {
    let directory = tempfile::tempdir().unwrap();
    let port = std::net::TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .port();
    let daemon = Daemon::start(
        directory.path(),
        SCENE,
        &["--http", &format!("127.0.0.1:{port}")],
    );
    let palpate = daemon.connect();
    assert!(get(port, "/healthz").0.starts_with("HTTP/1.1 200"));
    until(
        "it is ready",
        || get(port, "/readyz"),
        |(head, body)| head.starts_with("HTTP/1.1 200") && body == "ready\n",
    );
    let (head, body) = get(port, "/metrics");
    assert!(
        head.contains("application/openmetrics-text; version=1.0.0"),
        "{head}"
    );
    assert!(parse_metrics(&body)["palpate_loop_ticks_total"] > 0.0);
    let tokens = palpate.live(
        "palpate/default/@live/viewer/*",
        std::time::Duration::from_secs(20),
        |keys| !keys.is_empty(),
    );
    assert_eq!(tokens.unwrap().len(), 1);
}

#[test]
fn past_events_are_asked_for_by_number() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let palpate = daemon.connect();
    for k in 0..150 {
        palpate
            .rpc(if k % 2 == 0 {
                Call::Pause
            } else {
                Call::Resume
            })
            .unwrap();
        palpate.rpc(Call::Reset).unwrap();
    }
    // Of three hundred and more the last 256 are kept.
    let events = palpate.past_events(0).unwrap();
    assert_eq!(events.len(), 256);
    assert!(
        events.windows(2).all(|pair| pair[1].seq == pair[0].seq + 1),
        "a gap in the history"
    );
    let newest = events.last().unwrap();
    assert!(newest.seq >= 300);
    assert!(events.iter().any(|event| event.kind == EventKind::Reset));
    let some = palpate.past_events(newest.seq - 3).unwrap();
    assert_eq!(some[..3], events[253..], "{some:?}");
    assert!(palpate.past_events(newest.seq + 1_000).unwrap().is_empty());
}
