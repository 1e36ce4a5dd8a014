//! Haply: the adapter against the simulated service, and the service against programs.

use crate::daemon::{Daemon, PROGRAM, free_port};
use palpate_devices::haply::{read_state, state_message};
use std::io::Write as _;
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket};

use crate::scenes::RIGID_TEARDROP as SCENE;
/// Into the drop and out again, within a second; a button is held for a while.
const MOTION: &str = "[[waypoint]]\ntime_s = 0\nposition = [0.036, 0.003, 0.045]\n\
                      [[waypoint]]\ntime_s = 0.3\nposition = [0.024, 0.003, 0.045]\n\
                      [[waypoint]]\ntime_s = 0.6\nposition = [0.024, 0.003, 0.05]\n\
                      [[waypoint]]\ntime_s = 0.9\nposition = [0.036, 0.003, 0.045]\n";

struct Service {
    child: Child,
    uri: String,
}

impl Service {
    fn start(arguments: &[&str]) -> Self {
        let port = free_port();
        let child = Command::new(PROGRAM)
            .args([
                "device",
                "--as",
                "haply",
                "--for",
                "120s",
                "--port",
                &port.to_string(),
            ])
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            assert!(begun.elapsed() < Duration::from_secs(60));
            std::thread::sleep(Duration::from_millis(20));
        }
        Self {
            child,
            uri: format!("ws://127.0.0.1:{port}"),
        }
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn connect(uri: &str) -> WebSocket<TcpStream> {
    let stream = TcpStream::connect(uri.strip_prefix("ws://").unwrap()).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_secs(30)))
        .unwrap();
    tungstenite::client::client(uri, stream).unwrap().0
}

fn text(socket: &mut WebSocket<TcpStream>) -> String {
    match socket.read().unwrap() {
        Message::Text(text) => text.to_string(),
        other => panic!("{other:?}"),
    }
}

/// Forces of all ticks of a recording, as text of the exact bits.
fn forces(recording: &std::path::Path) -> Vec<String> {
    let done = Command::new(PROGRAM)
        .args(["export", "--csv", "-"])
        .arg(recording)
        .output()
        .unwrap();
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let table = String::from_utf8(done.stdout).unwrap();
    let mut rows = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let heading = rows.next().unwrap();
    let first = heading
        .iter()
        .position(|name| *name == "ball.force_x_n")
        .unwrap();
    rows.map(|row| row[first..first + 3].join(" ")).collect()
}

pub fn over_the_simulated_service_the_forces_are_those_of_a_native_run_bit_for_bit() {
    let directory = tempfile::tempdir().unwrap();
    let motion = directory.path().join("motion.toml");
    std::fs::write(&motion, MOTION).unwrap();
    let motion = motion.to_str().unwrap();
    let mut recorded = Vec::new();
    for native in [true, false] {
        let file = directory.path().join(format!("{native}.mcap"));
        let arguments = ["--clock", "lockstep", "--record", file.to_str().unwrap()];
        let daemon = Daemon::start(directory.path(), SCENE, &arguments);
        // Velocities come from the encoder in both: the same device, hand, motion and seed.
        let hand = ["--device", "touch", "--hand", "light", "--motion", motion];
        let mut device = Command::new(PROGRAM);
        device.args(["device", "--tool", "ball", "--connect", &daemon.endpoint]);
        let service = (!native).then(|| Service::start(&[&["--per-message"][..], &hand].concat()));
        match &service {
            None => device.args(hand).args(["--for", "1s"]),
            Some(service) => {
                device.args(["--hardware", "haply", "--uri", &service.uri, "--for", "3s"])
            }
        };
        let done = device.stdin(Stdio::null()).output().unwrap();
        assert!(
            done.status.success(),
            "{}",
            String::from_utf8_lossy(&done.stderr)
        );
        drop(service);
        daemon
            .connect()
            .rpc(palpate_client::proto::rpc::Call::Shutdown)
            .unwrap();
        assert_eq!(daemon.end().1, 0);
        recorded.push(forces(&file));
    }
    let ticks = recorded[0].len().min(recorded[1].len());
    assert!(ticks >= 900, "{ticks} ticks in both");
    // The last tick of a run may be one of the fading forces at the end.
    for tick in 0..ticks - 100 {
        assert_eq!(recorded[0][tick], recorded[1][tick], "tick {}", tick + 1);
    }
    let pressed = recorded[0]
        .iter()
        .filter(|force| **force != "0.0 0.0 0.0")
        .count();
    assert!(pressed > 200, "{pressed} ticks with a force");
}

#[test]
fn the_simulated_service_sends_all_at_first_and_then_a_state_for_each_message() {
    let service = Service::start(&[]);
    let mut socket = connect(&service.uri);
    let first: serde_json::Value = serde_json::from_str(&text(&mut socket)).unwrap();
    for key in ["config", "state", "status", "device_id"] {
        assert!(!first["inverse3"][0][key].is_null(), "{key}");
    }
    assert!(!first["wireless_verse_grip"][0]["state"]["orientation"].is_null());
    let id = first["inverse3"][0]["device_id"]
        .as_str()
        .unwrap()
        .to_owned();
    for (k, word) in ["vector", "values", "vector"].into_iter().enumerate() {
        let force = format!(
            r#"{{"inverse3":[{{"device_id":"{id}","commands":{{"set_cursor_force":{{"{word}":{{"x":0.0,"y":0.0,"z":{k}.5}}}}}}}}]}}"#
        );
        socket.send(Message::text(force)).unwrap();
        let state: serde_json::Value = serde_json::from_str(&text(&mut socket)).unwrap();
        let z = state["inverse3"][0]["state"]["current_cursor_force"]["z"]
            .as_f64()
            .unwrap();
        assert_eq!(z, k as f64 + 0.5);
        assert!(state["inverse3"][0]["config"].is_null());
    }
    // What is not understood has its state too; another device's force moves nothing here.
    for odd in [
        "{",
        "{}",
        r#"{"inverse3":[{"device_id":"FFFF","commands":{"set_cursor_force":{"vector":{"x":9,"y":0,"z":0}}}}]}"#,
    ] {
        socket.send(Message::text(odd)).unwrap();
        let state: serde_json::Value = serde_json::from_str(&text(&mut socket)).unwrap();
        assert_ne!(
            state["inverse3"][0]["state"]["current_cursor_force"]["x"],
            9.0
        );
    }
    socket
        .get_mut()
        .set_read_timeout(Some(Duration::from_millis(100)))
        .unwrap();
    assert!(socket.read().is_err(), "nothing comes unasked");
}

/// A service that says what it is told to, and then what `end` does.
fn pretend(first: String, end: impl FnOnce(WebSocket<TcpStream>) + Send + 'static) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let uri = format!("ws://{}", listener.local_addr().unwrap());
    std::thread::spawn(move || {
        let (stream, _) = listener.accept().unwrap();
        let mut socket = tungstenite::accept(stream).unwrap();
        socket.send(Message::text(first)).unwrap();
        end(socket);
    });
    uri
}

fn state(ids: &[&str]) -> String {
    let states: Vec<_> = ids
        .iter()
        .map(|id| palpate_devices::haply::DeviceState {
            device_id: (*id).to_owned(),
            grip_id: "1".into(),
            position: [0.036, 0.003, 0.045],
            velocity: [0.0; 3],
            orientation: [0.0, 0.0, 0.0, 1.0],
            buttons: Default::default(),
            force: [0.0; 3],
        })
        .collect();
    state_message(&states, Some(1))
}

/// What the adapter says to a service, and its exit code.
fn adapter(daemon: &Daemon, uri: &str, more: &[&str]) -> (String, i32) {
    let done = Command::new(PROGRAM)
        .args([
            "device",
            "--tool",
            "ball",
            "--hardware",
            "haply",
            "--for",
            "20s",
        ])
        .args(["--connect", &daemon.endpoint, "--uri", uri])
        .args(more)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&done.stderr).into_owned();
    (words, done.status.code().unwrap_or(-1))
}

#[test]
fn a_service_that_closes_or_sends_half_a_frame_ends_the_adapter_with_a_word() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let closing = pretend(state(&["049D"]), |mut socket| {
        let _ = socket.read();
        let _ = socket.close(None);
        let _ = socket.flush();
        let _ = socket.read();
    });
    let (words, code) = adapter(&daemon, &closing, &[]);
    assert!(words.contains("is gone") && code == 3, "{code}: {words}");
    let halving = pretend(state(&["049D"]), |mut socket| {
        let _ = socket.read();
        // A text frame of 100 bytes of which ten come.
        let _ = socket
            .get_mut()
            .write_all(&[0x81, 100, b'{', b'"', b'i', b'n', b'v', b'e', b'r', b's']);
        std::thread::sleep(Duration::from_millis(200));
    });
    let (words, code) = adapter(&daemon, &halving, &[]);
    assert!(words.contains("is gone") && code == 3, "{code}: {words}");
    let broken = pretend(state(&["049D"]), |mut socket| {
        let _ = socket.read();
        let _ = socket.send(Message::text("{\"inverse3\":[{\"dev"));
        let _ = socket.read();
    });
    let (words, code) = adapter(&daemon, &broken, &[]);
    assert!(
        words.contains("no message of the Inverse Service") && code == 3,
        "{code}: {words}"
    );
}

// A wait with a timeout is interrupted when the process that waits is stopped and goes on; it was taken for the end of
// the connection.
#[test]
fn an_adapter_that_is_stopped_and_goes_on_still_drives_its_device() {
    use rustix::process::{Pid, Signal, kill_process};
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let (asked, heard) = std::sync::mpsc::channel();
    let waiting = pretend(state(&["049D"]), move |mut socket| {
        let _ = socket.read();
        let _ = asked.send(());
        // It lets the adapter wait.
        let _ = socket.read();
    });
    let mut adapter = Command::new(PROGRAM)
        .args([
            "device",
            "--tool",
            "ball",
            "--hardware",
            "haply",
            "--uri",
            &waiting,
        ])
        .args(["--connect", &daemon.endpoint, "--for", "60s"])
        .stdin(Stdio::null())
        .spawn()
        .unwrap();
    heard.recv_timeout(Duration::from_secs(60)).unwrap();
    // Less than the five seconds after which it gives a service up.
    std::thread::sleep(Duration::from_millis(300));
    for _ in 0..30 {
        for signal in [Signal::STOP, Signal::CONT] {
            kill_process(Pid::from_child(&adapter), signal).unwrap();
            std::thread::sleep(Duration::from_millis(5));
        }
    }
    let ended = adapter.try_wait().unwrap();
    let _ = adapter.kill();
    let _ = adapter.wait();
    assert_eq!(ended, None);
}

#[test]
fn of_two_devices_one_must_be_named_and_unknown_ones_and_dead_services_are_told() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let two = || pretend(state(&["049D", "04A0"]), |_| {});
    let (words, code) = adapter(&daemon, &two(), &[]);
    assert!(
        words.contains("049D, 04A0") && words.contains("--device-id") && code == 2,
        "{words}"
    );
    let (words, code) = adapter(&daemon, &two(), &["--device-id", "FFFF"]);
    assert!(
        words.contains("no device \"FFFF\"; it has 049D, 04A0") && code == 2,
        "{words}"
    );
    let (words, code) = adapter(&daemon, &format!("ws://127.0.0.1:{}", free_port()), &[]);
    assert!(
        words.contains("no Inverse Service answers") && code == 2,
        "{words}"
    );
    let (words, code) = adapter(&daemon, "localhost", &[]);
    assert!(
        words.contains("no address of an Inverse Service") && code == 2,
        "{words}"
    );
    assert!(read_state(&state(&["049D"]), None, 0).is_ok());
}

pub fn in_real_time_the_adapter_and_the_simulated_service_press_the_drop() {
    let directory = tempfile::tempdir().unwrap();
    let motion = directory.path().join("motion.toml");
    std::fs::write(&motion, format!("repeat = true\n{MOTION}")).unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let service = Service::start(&["--motion", motion.to_str().unwrap(), "--device", "touch"]);
    let done = Command::new(PROGRAM)
        .args([
            "device",
            "--tool",
            "ball",
            "--hardware",
            "haply",
            "--for",
            "3s",
            "--json",
        ])
        .args(["--connect", &daemon.endpoint, "--uri", &service.uri])
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let report = String::from_utf8_lossy(&done.stdout).into_owned();
    println!("{report}");
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert!(report["peak_force_n"].as_f64().unwrap() > 0.5);
    assert!(report["poses"].as_u64().unwrap() > 300);
}

// Seen: sixteen connections that say nothing, or one byte every few seconds, and no program got in.
#[test]
fn a_program_gets_in_past_those_who_say_nothing() {
    let service = Service::start(&[]);
    let address = service.uri.strip_prefix("ws://").unwrap();
    let _silent: Vec<TcpStream> = (0..20)
        .map(|_| TcpStream::connect(address).unwrap())
        .collect();
    let mut socket = connect(&service.uri);
    read_state(&text(&mut socket), None, 0).unwrap();
}

#[test]
fn pages_of_other_sites_do_not_reach_the_simulated_service() {
    use tungstenite::client::IntoClientRequest as _;
    let service = Service::start(&[]);
    let try_from = |origin: Option<&str>| {
        let mut request = service.uri.as_str().into_client_request().unwrap();
        if let Some(origin) = origin {
            request
                .headers_mut()
                .insert("origin", origin.parse().unwrap());
        }
        let stream = TcpStream::connect(service.uri.strip_prefix("ws://").unwrap()).unwrap();
        tungstenite::client(request, stream)
            .map(drop)
            .map_err(|e| e.to_string())
    };
    for own in [
        None,
        Some("http://localhost:3000"),
        Some("http://127.0.0.1"),
        Some("http://[::1]:80"),
    ] {
        try_from(own).unwrap_or_else(|e| panic!("{own:?}: {e}"));
    }
    for foreign in [
        "http://evil.example",
        "https://127.0.0.1.evil.example",
        "null",
        "file://",
    ] {
        let refused = try_from(Some(foreign));
        assert!(refused.is_err_and(|e| e.contains("403")), "{foreign}");
    }
}
