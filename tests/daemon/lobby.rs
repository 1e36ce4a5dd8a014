//! `palpate lobby`: who asks for a scene gets a daemon of its own, and nothing else.

use crate::daemon::{PROGRAM, device, side_by_side};
use crate::page::Answer;
use crate::session::Random;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A rigid drop and a ball beside it.
const SCENE: &str = crate::session::RIGID;

struct Lobby {
    child: Child,
    port: u16,
}

impl Drop for Lobby {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Lobby {
    fn start(arguments: &[&str]) -> Self {
        let mut child = Command::new(PROGRAM)
            .args(["lobby", "--http", "127.0.0.1:0", "--json"])
            .args(arguments)
            .args(["--", "--no-rt"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let stdout = child.stdout.take().unwrap();
        BufReader::new(stdout).read_line(&mut line).unwrap();
        let ready: serde_json::Value = serde_json::from_str(&line).unwrap();
        assert_eq!(ready["ready"], true, "{line}");
        let url = ready["http"].as_str().unwrap().trim_end_matches('/');
        let port = url.rsplit_once(':').unwrap().1.parse().unwrap();
        Self { child, port }
    }

    /// Sends bytes as they are; gives what comes back.
    fn send(&self, bytes: &[u8]) -> Answer {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        // Whoever is refused half way may find the connection closed.
        let _ = stream.write_all(bytes);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let head = answer.windows(4).position(|bytes| bytes == b"\r\n\r\n");
        let (head, body) = answer.split_at(head.map_or(answer.len(), |at| at + 4));
        let head = String::from_utf8_lossy(head).to_lowercase();
        let status = head
            .split(' ')
            .nth(1)
            .and_then(|status| status.parse().ok());
        Answer {
            status: status.unwrap_or(0),
            head,
            body: body.to_vec(),
        }
    }

    fn ask_with(&self, request: &str, headers: &str, body: &str) -> Answer {
        let host = match headers.contains("Host:") {
            true => String::new(),
            false => format!("Host: 127.0.0.1:{}\r\n", self.port),
        };
        let length = body.len();
        self.send(
            format!(
                "{request} HTTP/1.1\r\n{host}{headers}Content-Length: {length}\r\nConnection: close\r\n\r\n{body}"
            )
            .as_bytes(),
        )
    }

    fn ask(&self, request: &str, body: &str) -> Answer {
        self.ask_with(request, "", body)
    }

    fn start_session(&self, scene: &str) -> Answer {
        let body = serde_json::json!({ "scene": scene }).to_string();
        self.ask("POST /sessions", &body)
    }

    /// Starts a session that must start.
    fn session(&self, scene: &str) -> serde_json::Value {
        let answer = self.start_session(scene);
        assert_eq!(answer.status, 201, "{} {}", answer.head, answer.text());
        answer.json()
    }

    fn sessions(&self) -> Vec<serde_json::Value> {
        let answer = self.ask("GET /sessions", "");
        assert_eq!(answer.status, 200, "{}", answer.head);
        answer.json().as_array().unwrap().clone()
    }
}

fn text(value: &serde_json::Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("{value}"))
}

/// The process is there, and not only waits to be noticed.
fn runs(pid: u64) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    let state = stat
        .rsplit_once(") ")
        .and_then(|(_, rest)| rest.chars().next());
    state.is_some_and(|state| !"ZX".contains(state))
}

fn wait_until(what: &str, mut done: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !done() {
        assert!(begun.elapsed() < Duration::from_secs(60), "{what}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn signal(pid: u64, signal: rustix::process::Signal) {
    let pid = rustix::process::Pid::from_raw(i32::try_from(pid).unwrap()).unwrap();
    rustix::process::kill_process(pid, signal).unwrap();
}

fn folder(directory: &Path) -> String {
    let folder = directory.join("scenes");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("drop.toml"), format!("# A rigid drop\n{SCENE}")).unwrap();
    std::fs::write(folder.join("broken.toml"), "[[body]]\nid = 3\n").unwrap();
    std::fs::write(directory.join("secret.toml"), SCENE).unwrap();
    folder.display().to_string()
}

#[test]
fn sessions_of_a_lobby_begin_and_end() {
    side_by_side![
        a_device_presses_in_a_scene_that_it_got_from_the_lobby,
        a_full_lobby_says_when_to_come_again_and_lets_in_who_comes_after_an_end,
        garbage_is_refused_and_the_lobby_goes_on,
    ];
}

fn a_device_presses_in_a_scene_that_it_got_from_the_lobby() {
    let directory = tempfile::tempdir().unwrap();
    let lobby = Lobby::start(&["--max", "2", "--scenes", &folder(directory.path())]);
    let scenes = lobby.ask("GET /scenes", "").json();
    let find = |name: &str| {
        let mut all = scenes.as_array().unwrap().iter();
        all.find(|offer| offer["name"] == name).cloned()
    };
    assert_eq!(find("drop").unwrap()["description"], "A rigid drop");
    assert!(
        find("builtin:teardrop").is_some() && find("secret").is_none(),
        "{scenes}"
    );
    // Of the folder and of the program, each a daemon of its own.
    let first = lobby.session("drop");
    let second = lobby.session("builtin:rigid-teardrop");
    assert_ne!(first["endpoint"], second["endpoint"]);
    assert_ne!(first["instance"], second["instance"]);
    for session in [&first, &second] {
        let instance = text(&session["instance"]);
        let arguments = [
            "--instance",
            instance,
            "--motion",
            "press",
            "--depth",
            "0.01",
            "--for",
            "2s",
        ];
        // A loop of a busy machine may be too slow for any force, for a while.
        wait_until("no force of a session", || {
            let (report, code) = device(text(&session["endpoint"]), &arguments);
            println!("exit code {code}: {report}");
            let report: Option<serde_json::Value> = serde_json::from_str(&report).ok();
            let peak_n = report.and_then(|report| report["peak_force_n"].as_f64());
            code == 0 && peak_n.is_some_and(|newtons| newtons > 0.5)
        });
        let page = text(&session["page"]).trim_start_matches("http://127.0.0.1:");
        let port = page.trim_end_matches('/').parse().unwrap();
        wait_until("a session is never ready", || {
            crate::page::get(port, "/readyz").status == 200
        });
    }
    // One is ended: its process is gone, and there is a place for another.
    let id = text(&first["id"]);
    let one = lobby.ask(&format!("GET /sessions/{id}"), "").json();
    assert_eq!(
        (&one["state"], &one["scene"]),
        (&"ready".into(), &"drop".into())
    );
    assert_eq!(lobby.ask(&format!("DELETE /sessions/{id}"), "").status, 204);
    assert!(!runs(first["pid"].as_u64().unwrap()));
    let left = lobby.sessions();
    assert_eq!(left.len(), 1, "{left:?}");
    assert_eq!(left[0]["id"], second["id"]);
    assert_eq!(lobby.ask(&format!("DELETE /sessions/{id}"), "").status, 404);
    lobby.session("drop");
}

fn a_full_lobby_says_when_to_come_again_and_lets_in_who_comes_after_an_end() {
    let lobby = Lobby::start(&["--max", "1", "--idle-timeout", "2s"]);
    let first = lobby.session("builtin:rigid-teardrop");
    let full = lobby.start_session("builtin:rigid-teardrop");
    assert_eq!(full.status, 503, "{}", full.text());
    assert!(
        full.head.contains("\r\nretry-after: 2\r\n"),
        "{}",
        full.head
    );
    assert!(
        text(&full.json()["error"]).contains("--max 1"),
        "{}",
        full.text()
    );
    // Nobody holds its tool: it ends by itself, and is let go of.
    wait_until("an idle session stays", || lobby.sessions().is_empty());
    assert!(!runs(first["pid"].as_u64().unwrap()));
    lobby.session("builtin:rigid-teardrop");
}

#[test]
fn only_scenes_of_the_list_are_started() {
    let directory = tempfile::tempdir().unwrap();
    let folder = folder(directory.path());
    let lobby = Lobby::start(&["--scenes", &folder]);
    let absolute = format!("{folder}/drop");
    for unknown in [
        "../secret",
        "secret",
        "drop.toml",
        "./drop",
        "/etc/passwd",
        &absolute,
        "builtin:../secret",
        "builtin:",
        "",
        "drop\0",
        "--help",
    ] {
        let answer = lobby.start_session(unknown);
        assert_eq!(answer.status, 404, "{unknown:?}: {}", answer.text());
        let scenes = answer.json()["scenes"].clone();
        assert!(
            scenes.as_array().unwrap().contains(&"drop".into()),
            "{scenes}"
        );
    }
    for path in [
        "/../secret.toml",
        "/scenes/drop.toml",
        "/sessions/../scenes",
        "/%2e%2e/secret",
    ] {
        assert_eq!(lobby.ask(&format!("GET {path}"), "").status, 404, "{path}");
    }
    // A file that is no scene is told with the daemon's own words, and takes no place.
    let broken = lobby.start_session("broken");
    assert_eq!(broken.status, 500, "{}", broken.text());
    assert!(broken.text().contains("broken.toml"), "{}", broken.text());
    assert!(lobby.sessions().is_empty());
}

fn garbage_is_refused_and_the_lobby_goes_on() {
    let lobby = Lobby::start(&[]);
    let long = format!(r#"{{"scene": "{}"}}"#, "x".repeat(5_000));
    for (body, status) in [
        ("", 400),
        ("{}", 400),
        ("[]", 400),
        (r#"{"scene": 3}"#, 400),
        (
            r#"{"scene": "builtin:teardrop", "listen": "tcp/0.0.0.0:1"}"#,
            400,
        ),
        ("\u{1F980}", 400),
        (&*long, 413),
    ] {
        let answer = lobby.ask("POST /sessions", body);
        assert_eq!(answer.status, status, "{body:.40}: {}", answer.text());
        assert!(answer.json()["error"].is_string());
    }
    for request in [
        "PUT /sessions",
        "POST /scenes",
        "DELETE /sessions",
        "PATCH /healthz",
    ] {
        assert_eq!(lobby.ask(request, "{}").status, 405, "{request}");
    }
    // Another site's page, a rebound name, and whoever is no browser and says so.
    let body = r#"{"scene": "builtin:rigid-teardrop"}"#;
    for headers in ["Origin: http://evil.example\r\n", "Host: evil.example\r\n"] {
        let answer = lobby.ask_with("POST /sessions", headers, body);
        assert_eq!(answer.status, 403, "{headers}: {}", answer.text());
    }
    let mut random = Random(11);
    for _ in 0..300 {
        let length = random.below(600);
        let mut bytes: Vec<u8> = (0..length).map(|_| random.below(256) as u8).collect();
        if random.below(2) == 0 {
            let head = format!(
                "POST /sessions HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
            );
            bytes.splice(0..0, head.into_bytes());
        } else {
            bytes.extend(b"\r\n\r\n");
        }
        let status = lobby.send(&bytes).status;
        assert!(
            [0, 400, 413, 414, 431, 505].contains(&status),
            "{status}: {bytes:?}"
        );
    }
    assert!(lobby.sessions().is_empty());
    assert_eq!(lobby.ask("GET /healthz", "").text(), "ok\n");
}

// It goes through the same door as a daemon's page.
#[test]
fn a_lobby_is_found_healthy_through_those_who_only_wait() {
    let lobby = Lobby::start(&[]);
    let crowd = || {
        let mut stream = TcpStream::connect(("127.0.0.1", lobby.port)).unwrap();
        let _ = stream.write_all(b"POST /sessions HTTP/1.1\r\nX");
        stream
    };
    let _crowd: Vec<TcpStream> = (0..150).map(|_| crowd()).collect();
    let mut stream = TcpStream::connect(("127.0.0.1", lobby.port)).unwrap();
    let patience = Some(Duration::from_secs(3));
    stream.set_read_timeout(patience).unwrap();
    write!(stream, "GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n").unwrap();
    let mut status = [0; 12];
    stream.read_exact(&mut status).unwrap();
    assert_eq!(&status[9..], b"200");
}

#[test]
fn a_daemon_that_was_killed_is_noticed_and_its_place_is_free() {
    let lobby = Lobby::start(&["--max", "1"]);
    let first = lobby.session("builtin:rigid-teardrop");
    signal(
        first["pid"].as_u64().unwrap(),
        rustix::process::Signal::KILL,
    );
    wait_until("a killed daemon stays", || lobby.sessions().is_empty());
    let second = lobby.session("builtin:rigid-teardrop");
    assert_ne!(first["id"], second["id"]);
}

#[test]
fn nothing_stays_after_the_lobby_is_killed_or_ends() {
    for how in [rustix::process::Signal::KILL, rustix::process::Signal::TERM] {
        let mut lobby = Lobby::start(&["--max", "3"]);
        let mut pids: Vec<u64> = ["builtin:rigid-teardrop", "builtin:rigid-teardrop"]
            .map(|scene| lobby.session(scene)["pid"].as_u64().unwrap())
            .into();
        // A third that still builds its scene.
        let mut late = TcpStream::connect(("127.0.0.1", lobby.port)).unwrap();
        let body = r#"{"scene": "builtin:teardrop"}"#;
        let request = format!(
            "POST /sessions HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: {}\r\n\r\n{body}",
            body.len()
        );
        late.write_all(request.as_bytes()).unwrap();
        wait_until("the third does not begin", || lobby.sessions().len() == 3);
        let third = lobby.sessions().pop().unwrap();
        pids.push(third["pid"].as_u64().unwrap());
        signal(lobby.child.id().into(), how);
        let status = lobby.child.wait().unwrap();
        assert_eq!(status.success(), how == rustix::process::Signal::TERM);
        for pid in pids {
            wait_until("a daemon outlives its lobby", || !runs(pid));
        }
    }
}

#[test]
fn a_lobby_that_everybody_could_use_is_refused() {
    for (arguments, word) in [
        (&["--http", "0.0.0.0:0"][..], "--insecure"),
        (&["--listen", "tcp/0.0.0.0:0"], "--insecure"),
        (&["--listen", "tls/0.0.0.0:0"], "--identity"),
        (&["--listen", "tcp/127.0.0.1:7447"], ":0"),
        (&["--listen", "nonsense"], ":0"),
        (&["--max", "0"], "--max"),
        (&["--scenes", "/nonexistent"], "/nonexistent"),
    ] {
        let done = Command::new(PROGRAM)
            .args(["lobby", "--for", "1s"])
            .args(arguments)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let err = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{arguments:?}: {err}");
        assert!(err.contains(word), "{arguments:?}: {err}");
    }
}
