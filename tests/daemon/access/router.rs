//! A daemon on one machine, a router and a device on another, with TLS on every link. The router is killed
//! and started again. Machines are network namespaces: needs `ip netns` (root); skipped with a line
//! where that is missing.

use super::namespaces::{Cable, Ended, words};
use super::{SCENE, request};
use palpate::auth::{Authority, Request, Role};
use std::io::{BufRead as _, BufReader};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// Forces that acted on the device, N, by servo period; with the time of each, s.
fn applied(csv: &str) -> Vec<(f64, f64)> {
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let force = ["applied_x_n", "applied_y_n", "applied_z_n"].map(column);
    let time = column("time_s");
    let period = |line: &str| {
        let values: Vec<f64> = line.split(',').map(|text| text.parse().unwrap()).collect();
        let square = force.map(|column| values[column] * values[column]);
        (values[time], square.iter().sum::<f64>().sqrt())
    };
    lines.map(period).collect()
}

/// Goes to the drop within half a second, stays pressed against it for 7.5 s, comes out and presses again: a hand that
/// is inside when a lost connection comes back feels nothing until it has been out.
const STAYS: &str = "[[waypoint]]\ntime_s = 0\nposition = [0.06, 0.003, 0.045]\n\
                     [[waypoint]]\ntime_s = 0.5\nposition = [0.022, 0.003, 0.045]\n\
                     [[waypoint]]\ntime_s = 8.0\nposition = [0.022, 0.003, 0.045]\n\
                     [[waypoint]]\ntime_s = 8.5\nposition = [0.06, 0.003, 0.045]\n\
                     [[waypoint]]\ntime_s = 9.0\nposition = [0.022, 0.003, 0.045]\n\
                     [[waypoint]]\ntime_s = 100\nposition = [0.022, 0.003, 0.045]\n";

/// Waits until a program says `word` on its first line.
pub(super) fn wait_for(child: &mut Child, word: &str) {
    let stdout = child.stdout.as_mut().unwrap();
    let mut line = String::new();
    BufReader::new(stdout).read_line(&mut line).unwrap();
    assert!(line.contains(word), "{line:?}");
}

pub(super) fn a_router_with_tls_between_two_machines_goes_and_comes_back_and_the_force_with_it() {
    let Some(cable) = Cable::lay() else {
        println!("skipped: `ip netns` does not work here");
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name).display().to_string();
    std::fs::write(at("scene.toml"), SCENE).unwrap();
    let authority = Authority::create(&directory.path().join("ca")).unwrap();
    let hosts = [1, 2].map(|end| format!("10.77.{}.{end}", cable.net));
    let issue = |name: &str, role: Role, hosts: &[String]| {
        let request = Request {
            hosts: hosts.to_vec(),
            ..request(role)
        };
        let path = directory.path().join(name);
        authority.issue(&request, Some(&path)).unwrap();
    };
    issue("daemon.json5", Role::Daemon, &hosts[..1]);
    issue("router.json5", Role::Daemon, &hosts[1..]);
    issue("ball.json5", Role::tool("ball").unwrap(), &[]);
    issue("viewer.json5", Role::Viewer, &[]);
    let rules = std::process::Command::new(crate::daemon::PROGRAM)
        .args(["auth", "rules", &at("scene.toml")])
        .output()
        .unwrap();
    assert!(rules.status.success(), "{}", words(&rules));
    std::fs::write(at("rules.json5"), rules.stdout).unwrap();
    let daemon_at = format!("tls/{}:7447", hosts[0]);
    let router_at = format!("tls/{}:7447", hosts[1]);
    let start = |end: &str, arguments: &[&str]| {
        let mut child = cable
            .at(end, arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        wait_for(&mut child, "\"ready\":true");
        Ended(child)
    };
    let (scene, identity) = (at("scene.toml"), at("daemon.json5"));
    let serve = [
        "serve",
        &scene,
        "--no-rt",
        "--json",
        "--listen",
        &daemon_at,
        "--identity",
        &identity,
    ];
    let _daemon = start("a", &serve);
    let (identity, rules) = (at("router.json5"), at("rules.json5"));
    let relay = [
        "relay",
        "--json",
        "--from",
        &daemon_at,
        "--listen",
        &router_at,
        "--identity",
        &identity,
        "--zenoh-config",
        &rules,
    ];
    let router = start("b", &relay);
    // Behind the router roles hold as before it.
    let viewer = at("viewer.json5");
    let ask = |arguments: &[&str]| {
        let more = ["--connect", &router_at, "--zenoh-config", &viewer];
        let mut asking = cable.at("b", &[arguments, &more[..]].concat());
        let asking = asking.stdout(Stdio::piped()).stderr(Stdio::piped());
        asking.spawn().unwrap()
    };
    let listed = ask(&["ls"]).wait_with_output().unwrap();
    assert!(words(&listed).contains("ball"), "{}", words(&listed));
    let stays = at("stays.toml");
    std::fs::write(&stays, STAYS).unwrap();
    let (csv, ball) = (at("ball.csv"), at("ball.json5"));
    // A session in mode client, as those behind routers are: the identity says so.
    let device = [
        "device",
        "--tool",
        "ball",
        "--motion",
        &stays,
        "--for",
        "12s",
        "--wait",
        "60s",
        "--connect",
        &router_at,
        "--zenoh-config",
        &ball,
        "--csv",
        &csv,
        "--json",
    ];
    let device = cable
        .at("b", &device)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let paused = ask(&["rpc", "pause"]);
    std::thread::sleep(Duration::from_secs(3));
    // Dropped is killed: no word of farewell.
    drop(router);
    std::thread::sleep(Duration::from_secs(2));
    let begun = Instant::now();
    let _router = start("b", &relay);
    println!(
        "the router is back after {:.1} s more",
        begun.elapsed().as_secs_f64()
    );
    let paused = paused.wait_with_output().unwrap();
    assert!(!paused.status.success(), "{}", words(&paused));
    let output = device.wait_with_output().unwrap();
    // A silence of more than a second is told by the exit code.
    assert_eq!(output.status.code(), Some(3), "{}", words(&output));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["gave_up"], false, "{report}");
    let longest_s = report["silences"]["longest_s"].as_f64().unwrap();
    assert!(longest_s > 1.5, "{report}");
    let applied = applied(&std::fs::read_to_string(&csv).unwrap());
    // Held, then for a while nothing at all, then held again.
    let mut quiet = (0, 0);
    let touched = applied
        .iter()
        .position(|(_, force)| *force > 0.5)
        .expect("it was never held");
    let mut from = touched;
    for k in touched..=applied.len() {
        if k == applied.len() || applied[k].1 > 0.0 {
            if k - from > quiet.1 - quiet.0 {
                quiet = (from, k);
            }
            from = k + 1;
        }
    }
    let (begin, end) = quiet;
    let felt = |range: std::ops::Range<usize>| {
        applied[range]
            .iter()
            .map(|(_, force)| *force)
            .fold(0.0, f64::max)
    };
    let (before, after) = (felt(touched..begin), felt(end..applied.len()));
    let quiet_s = applied[end - 1].0 - applied[begin].0;
    println!(
        "{before:.2} N before, none for {quiet_s:.2} s of {longest_s:.2} s without news, {after:.2} N after"
    );
    // The device is let go soon after the last news, and held again when it comes from outside.
    assert!(quiet_s > 0.5 * longest_s, "{report}");
    assert!(before > 0.5 && after > 0.5, "{report}");
}
