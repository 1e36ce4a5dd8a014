//! `palpate relay`: nets are thinned, forces are not, and behind a read-only one nobody writes.

use crate::access::request;
use crate::daemon::{Daemon, PROGRAM, device, free_port, side_by_side};
use crate::scenes::SOFT_DROP;
use palpate::auth::{Authority, Role};
use palpate::relay::{Relay, RelayError, RelaySettings};
use palpate_client::{ClientError, Connect, Palpate};
use std::process::{Command, Stdio};

/// stdout, stderr, exit code.
fn palpate(arguments: &[&str]) -> (String, String, i32) {
    let output = Command::new(PROGRAM)
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    let code = output.status.code().unwrap_or(-1);
    (text(output.stdout), text(output.stderr), code)
}

fn relay(from: &str, arguments: &[&str]) -> Daemon {
    let mut command = Command::new(PROGRAM);
    command
        .args(["relay", "--from", from, "--json"])
        .args(arguments);
    Daemon::spawn(free_port(), &mut command)
}

/// Messages by key, and how many of them were missing, while something is watched.
fn counts(watch: std::process::Child) -> std::collections::BTreeMap<String, (u64, f64)> {
    let output = watch.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    (text.lines())
        .map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap())
        .map(|line| {
            let key = line["key"].as_str().unwrap().to_owned();
            let rate_hz = line["rate_hz"].as_f64().unwrap_or(0.0);
            (key, (line["messages"].as_u64().unwrap(), rate_hz))
        })
        .collect()
}

/// Joins as observers do: in Zenoh's mode client, through whoever is at the endpoint.
fn look(endpoint: &str) -> Result<Palpate, ClientError> {
    Palpate::connect(&Connect {
        timeout: std::time::Duration::from_secs(5),
        onlooker: true,
        ..Connect::to(endpoint)
    })
}

fn watch(endpoint: &str) -> std::process::Child {
    Command::new(PROGRAM)
        .args(["hz", "all", "--for", "4s", "--json", "--connect", endpoint])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

#[test]
fn relays() {
    side_by_side![
        nets_are_thinned_forces_are_not_and_relays_chain,
        behind_a_read_only_relay_everything_can_be_seen_and_nothing_done,
        a_daemon_that_was_started_again_is_seen_again_and_still_read_only,
        a_relay_without_a_daemon_or_open_to_all_is_refused,
    ];
}

fn nets_are_thinned_forces_are_not_and_relays_chain() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SOFT_DROP, &[]);
    let first = relay(&daemon.endpoint, &["--net-hz", "10"]);
    let second = relay(&first.endpoint, &["--net-hz", "4"]);
    let watched = [&daemon, &first, &second].map(|end| watch(&end.endpoint));
    let (report, code) = device(&daemon.endpoint, &["--motion", "tap", "--for", "5s"]);
    assert_eq!(code, 0, "{report}");
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert!(report["peak_force_n"].as_f64().unwrap() > 0.05, "{report}");
    let [near, far, farther] = watched.map(counts);
    let (net, force) = (
        "palpate/default/body/drop/net",
        "palpate/default/tool/ball/force",
    );
    println!("nets: {:?} {:?} {:?}", near[net], far[net], farther[net]);
    println!(
        "forces: {:?} {:?} {:?}",
        near[force], far[force], farther[force]
    );
    // Each of the three watches for as long as the others. A loop that falls behind sends fewer nets
    // than there is room for.
    assert!(far[net].0 * 2 < near[net].0 || near[net].1 < 25.0);
    assert!(farther[net].0 < far[net].0 && farther[net].0 > 2);
    assert!(far[net].0 <= 4 * 10 + 12 && farther[net].0 <= 4 * 4 + 8);
    assert!(farther[force].0 * 10 > near[force].0 * 7);
}

fn behind_a_read_only_relay_everything_can_be_seen_and_nothing_done() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SOFT_DROP, &[]);
    let relay = relay(&daemon.endpoint, &["--read-only"]);
    let viewer = look(&relay.endpoint).unwrap();
    let direct = daemon.connect();
    // What there is can be asked for, and what comes is seen.
    assert_eq!(
        viewer.scene().unwrap().scene_hash,
        direct.scene().unwrap().scene_hash
    );
    assert!(viewer.metrics().unwrap().contains("# EOF"));
    assert!(viewer.status().is_ok() && viewer.info().is_ok());
    assert!(viewer.past_events(0).is_ok());
    let statuses = viewer.statuses().unwrap();
    let begun = std::time::Instant::now();
    while statuses.get().is_none() {
        assert!(begun.elapsed().as_secs() < 20, "no status comes through");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    // Poses and descriptions of devices do not arrive, commands are not carried out.
    // At the same time: who gets no answer waits for it.
    std::thread::scope(|scope| {
        for method in ["pause", "reset", "shutdown", "record_start"] {
            let arguments = ["rpc", method, "--connect", &relay.endpoint];
            scope.spawn(move || {
                let (out, err, code) = palpate(&arguments);
                assert_eq!(code, 2, "{method}: {out} {err}");
            });
        }
        let (report, code) = device(&relay.endpoint, &["--for", "1s"]);
        assert_ne!(code, 0, "{report}");
    });
    let status = direct.status().unwrap();
    assert_eq!(
        (status.tools[0].received, status.state as u8),
        (0, 0),
        "{status:?}"
    );
    let info: serde_json::Value = serde_json::from_str(&direct.info().unwrap()).unwrap();
    assert!(info["devices"]["ball"]["info"].is_null(), "{info}");
    // A forged force of a viewer reaches nobody: not another viewer, not a device at the daemon.
    let forged = palpate_client::proto::messages::ToolForce {
        tick: u64::MAX,
        pose_seq: 1,
        t_client_ns: 0,
        t_server_ns: u64::MAX,
        force: [9.0, 0.0, 0.0],
        torque: [0.0; 3],
        proxy_position: [0.0; 3],
        proxy_orientation: [0.0, 0.0, 0.0, 1.0],
        depth: 0.0,
        contact_count: 1,
        flags: 0,
    };
    let seen = [look(&relay.endpoint).unwrap(), daemon.connect()];
    let latest = seen.each_ref().map(|end| end.forces("ball").unwrap());
    std::thread::sleep(std::time::Duration::from_millis(500));
    let bytes = palpate_client::proto::codec::encode(&forged);
    use zenoh::Wait as _;
    let forger = palpate::transport::open(&palpate::transport::SessionSettings {
        connect: vec![relay.endpoint.clone()],
        role: palpate::transport::Role::Client,
        ..Default::default()
    })
    .unwrap();
    for _ in 0..20 {
        let key = viewer.keys().tool_force("ball");
        forger.put(key, bytes.clone()).wait().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    std::thread::sleep(std::time::Duration::from_millis(300));
    assert!(latest.iter().all(|latest| latest.get().is_none()));
    // The one at the daemon can still do all of it.
    let (report, code) = device(&daemon.endpoint, &["--for", "1s"]);
    assert_eq!(code, 0, "{report}");
}

fn a_daemon_that_was_started_again_is_seen_again_and_still_read_only() {
    let directory = tempfile::tempdir().unwrap();
    let port = free_port();
    let daemon = Daemon::start_at(port, directory.path(), SOFT_DROP, &[]);
    let relay = relay(&daemon.endpoint, &["--read-only"]);
    let before = look(&relay.endpoint).unwrap().scene().unwrap();
    drop(daemon);
    let daemon = Daemon::start_at(port, directory.path(), SOFT_DROP, &[]);
    let begun = std::time::Instant::now();
    loop {
        let scene = look(&relay.endpoint).and_then(|end| end.scene());
        if scene.is_ok_and(|scene| scene.scene_hash == before.scene_hash) {
            break;
        }
        assert!(begun.elapsed().as_secs() < 60, "it does not come back");
    }
    let (_, _, code) = palpate(&["rpc", "pause", "--connect", &relay.endpoint]);
    assert_eq!(code, 2);
    assert_eq!(daemon.connect().status().unwrap().state as u8, 0);
}

fn a_relay_without_a_daemon_or_open_to_all_is_refused() {
    let settings = |from: &str, listen: &str| RelaySettings {
        from: from.into(),
        listen: vec![listen.into()],
        net_hz: Some(10.0),
        read_only: true,
        insecure: false,
        identity: None,
        config: None,
    };
    let nobody = format!("tcp/127.0.0.1:{}", free_port());
    let error = |settings| Relay::open(settings).err().unwrap();
    for open in ["tcp/0.0.0.0:7447", "tcp/[::]:7447", "tcp/192.168.1.4:7447"] {
        let error = error(settings(&nobody, open));
        assert!(
            matches!(error, RelayError::Exposed { .. }),
            "{open}: {error}"
        );
    }
    let out = error(settings("tcp/10.0.0.2:7447", "tcp/127.0.0.1:0"));
    assert!(matches!(out, RelayError::Exposed { .. }), "{out}");
    // With certificates, but without a word of what their roles may do.
    let directory = tempfile::tempdir().unwrap();
    let authority = Authority::create(directory.path()).unwrap();
    let identity = authority.issue(&request(Role::Daemon), None).unwrap();
    let encrypted = RelaySettings {
        read_only: false,
        identity: Some(identity),
        ..settings(&nobody, "tls/0.0.0.0:7447")
    };
    let no_rules = error(encrypted.clone()).to_string();
    assert!(no_rules.contains("palpate auth rules"), "{no_rules}");
    assert!(no_rules.contains("--read-only"), "{no_rules}");
    let guarded = RelaySettings {
        read_only: true,
        ..encrypted
    };
    // At the same time: a daemon is waited for.
    std::thread::scope(|scope| {
        for settings in [guarded, settings(&nobody, "tcp/127.0.0.1:0")] {
            scope.spawn(move || {
                let error = error(settings);
                assert!(matches!(error, RelayError::Unreachable { .. }), "{error}");
            });
        }
    });
    let slow = RelaySettings {
        net_hz: Some(f64::NAN),
        ..settings(&nobody, "tcp/127.0.0.1:0")
    };
    assert!(matches!(error(slow), RelayError::Rate(_)));
}
