//! The commands that look at the bus, as people run them.

use super::{FREE, SCENE, bare};
use crate::daemon::{Daemon, PROGRAM};
use palpate_client::pose_at;
use serde_json::Value;
use std::process::{Command, Stdio};
use std::time::Duration;
use zenoh::Wait;

/// stdout, stderr, exit code.
fn palpate(arguments: &[&str]) -> (String, String, i32) {
    let output = Command::new(PROGRAM)
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (
        text(output.stdout),
        text(output.stderr),
        output.status.code().unwrap_or(-1),
    )
}

fn lines(text: &str) -> Vec<Value> {
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{line}: {e}")))
        .collect()
}

#[test]
fn echo_hz_ls_and_rpc_show_and_steer_a_running_daemon() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let at = ["-e", daemon.endpoint.as_str()];
    let run = |arguments: &[&str]| palpate(&[arguments, &at[..]].concat());

    let (out, err, code) = run(&["echo", "status", "--count", "2", "--json", "--for", "20s"]);
    assert_eq!(code, 0, "{err}");
    let seen = lines(&out);
    assert_eq!(seen.len(), 2);
    assert_eq!(seen[0]["type"], "palpate.LoopStatus.v4");
    assert_eq!(seen[0]["value"]["tools"][0]["bad_quaternion"], 0);
    assert_eq!(seen[0]["value"]["recorder"], "Off");
    let (out, _, _) = run(&["echo", "palpate/default/status", "--count", "1"]);
    assert!(
        out.starts_with("palpate/default/status palpate.LoopStatus.v4 {"),
        "{out}"
    );

    // What is not ours, or of another version, is shown as it came.
    let session = bare(&daemon.endpoint);
    let stop = std::sync::atomic::AtomicBool::new(false);
    let (out, code) = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !stop.load(std::sync::atomic::Ordering::Relaxed) {
                let encoding = zenoh::bytes::Encoding::APPLICATION_OCTET_STREAM
                    .with_schema("postcard;palpate.ToolPose.v9");
                session
                    .put("palpate/default/tool/ball/pose", [1u8, 2, 255])
                    .encoding(encoding)
                    .wait()
                    .unwrap();
                std::thread::sleep(Duration::from_millis(20));
            }
        });
        let (out, _, code) = run(&["echo", "pose", "--count", "1", "--json", "--for", "20s"]);
        stop.store(true, std::sync::atomic::Ordering::Relaxed);
        (out, code)
    });
    assert_eq!(code, 0);
    assert_eq!(lines(&out)[0]["hex"], "0102ff");
    assert!(
        lines(&out)[0]["encoding"]
            .as_str()
            .unwrap()
            .ends_with("palpate.ToolPose.v9"),
        "{out}"
    );

    let client = daemon.connect();
    let mut tool = client.tool("ball").unwrap();
    tool.send(pose_at(FREE)).unwrap();
    let (out, _, code) = run(&["hz", "force", "--for", "1s", "--json"]);
    assert_eq!(code, 0);
    let line = &lines(&out)[0];
    assert_eq!(line["key"], "palpate/default/tool/ball/force");
    assert!(
        line["rate_hz"].as_f64().unwrap() > 10.0 && line["lost"].is_u64(),
        "{line}"
    );
    let (out, _, _) = run(&["hz", "status", "--for", "500ms"]);
    assert!(
        out.contains("palpate/default/status: ")
            && out.contains(" Hz, period p50 ")
            && !out.contains("lost"),
        "{out}"
    );
    let (out, err, code) = run(&["hz", "nothing/here", "--for", "100ms"]);
    assert!(
        code == 0 && out.is_empty() && err.contains("no message arrived"),
        "{err}"
    );

    let (out, err, code) = run(&["ls", "--json"]);
    assert_eq!(code, 0, "{err}");
    let instance = &lines(&out)[0];
    assert_eq!(
        (&instance["instance"], &instance["bodies"][0]),
        (&"default".into(), &"drop".into())
    );
    assert_eq!(
        (&instance["tools"][0]["id"], &instance["tools"][0]["held"]),
        (&"ball".into(), &true.into())
    );
    assert_eq!(
        instance["publishes"]["palpate/default/body/drop/net"],
        "palpate.ControlNet.v1"
    );
    let (out, _, _) = run(&["ls"]);
    assert!(
        out.contains("tool ball: held") && out.contains("palpate/default/tool/ball/force"),
        "{out}"
    );

    let (out, _, code) = run(&["rpc", "pause"]);
    assert!(
        code == 0 && lines(&out)[0]["ok"] == true && lines(&out)[0]["tick"].is_u64(),
        "{out}"
    );
    assert_eq!(run(&["rpc", "step", "--ticks", "5"]).2, 0);
    assert_eq!(run(&["rpc", "step", "{\"ticks\": 5}"]).2, 0);
    for (arguments, words) in [
        (
            &["rpc", "step", "{\"tick\": 5}"][..],
            "step has no argument \"tick\"",
        ),
        (&["rpc", "record_stop"], "record_stop was refused"),
        (&["rpc", "seek", "{\"tick\": 1}"], "palpate play"),
        (&["rpc", "fly"], "possible values"),
    ] {
        let (_, err, code) = run(arguments);
        assert!(code == 2 && err.contains(words), "{arguments:?}: {err}");
    }
    drop(tool);
    let (out, _, code) = run(&["rpc", "shutdown"]);
    assert_eq!(code, 0, "{out}");
    assert_eq!(daemon.end().1, 0);
}

#[test]
fn nobody_there_is_said_and_manual_pages_are_written() {
    let port = std::net::TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .port();
    for command in ["ls", "echo", "hz"] {
        let endpoint = format!("tcp/127.0.0.1:{port}");
        let mut arguments = vec![command, "-e", &endpoint];
        arguments.extend((command != "ls").then_some("status"));
        let (_, err, code) = palpate(&arguments);
        assert!(
            code == 2 && err.contains("no daemon answers at"),
            "{command}: {err}"
        );
    }
    let directory = tempfile::tempdir().unwrap();
    let pages = directory.path().join("man1");
    let (out, err, code) = palpate(&["man", pages.to_str().unwrap()]);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("palpate.1"));
    let page = std::fs::read_to_string(pages.join("palpate-serve.1")).unwrap();
    assert!(
        page.contains("Scene file") && page.contains(".TH"),
        "{page}"
    );
    assert!(pages.join("palpate.1").exists() && pages.join("palpate-echo.1").exists());
}
