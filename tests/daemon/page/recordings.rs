//! `palpate view`: a page of recordings.

use crate::daemon::PROGRAM;
use crate::page::{free_port, get, get_with};
use crate::session::{RIGID, Script, record};
use palpate_client::proto::codec::decode;
use palpate_client::proto::messages::SceneSnapshot;
use palpate_record::Session;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A page of recordings; ends when dropped.
struct View {
    child: Child,
    port: u16,
}

impl View {
    fn start(arguments: &[&str]) -> Self {
        let port = free_port();
        let child = Command::new(PROGRAM)
            .arg("view")
            .args(arguments)
            .args(["--no-open", "--http", &format!("127.0.0.1:{port}")])
            .stdin(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        while std::net::TcpStream::connect(("127.0.0.1", port)).is_err() {
            assert!(begun.elapsed() < Duration::from_secs(60), "nobody listens");
            std::thread::sleep(Duration::from_millis(20));
        }
        Self { child, port }
    }
}

impl Drop for View {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn recording(directory: &Path, name: &str, ticks: u64) -> PathBuf {
    let path = directory.join(name);
    record(&path, RIGID, &Script::new(3, ticks, false));
    path
}

#[test]
fn a_file_is_served_by_ranges_with_its_scene_and_tools() {
    let directory = tempfile::tempdir().unwrap();
    let path = recording(directory.path(), "one.mcap", 500);
    let view = View::start(&[path.to_str().unwrap()]);
    let whole = std::fs::read(&path).unwrap();
    let info = get(view.port, "/session.json").json();
    assert_eq!(info["mode"], "view");
    assert_eq!(info["token"], serde_json::Value::Null);
    let listed = &info["recordings"][0];
    assert_eq!(listed["name"], "one.mcap");
    assert_eq!(listed["bytes"], whole.len());
    let url = listed["url"].as_str().unwrap();
    let range = |range: &str| get_with(view.port, url, &[("Range", range)]);
    assert_eq!(get(view.port, url).body, whole);
    let head = range("bytes=0-7");
    assert_eq!((head.status, &head.body[..]), (206, &b"\x89MCAP0\r\n"[..]));
    let told = format!("content-range: bytes 0-7/{}", whole.len());
    assert!(head.head.contains(&told), "{}", head.head);
    assert_eq!(range("bytes=-8").body, whole[whole.len() - 8..]);
    assert_eq!(range("bytes=1000-1999").body, whole[1000..2000]);
    assert_eq!(range("bytes=99999999999-").status, 416);
    assert_eq!(get(view.port, "/recordings/7/file.mcap").status, 404);
    assert_eq!(get(view.port, "/recordings/../../etc/passwd").status, 404);
    let scene = get(view.port, listed["scene_url"].as_str().unwrap());
    let scene: SceneSnapshot = decode(&scene.body, "").unwrap();
    assert_eq!((scene.tick, scene.bodies[0].id.as_str()), (0, "drop"));
    assert!(!scene.bodies[0].knots[0].is_empty());
    let tools = get(view.port, listed["tools_url"].as_str().unwrap()).json();
    assert_eq!(tools[0]["id"], "ball");
    // There is nothing to listen to or to write.
    assert_eq!(get(view.port, "/live").status, 404);
}

#[test]
fn a_directory_lists_its_recordings_and_two_files_stand_side_by_side() {
    let directory = tempfile::tempdir().unwrap();
    let b = recording(directory.path(), "b.mcap", 20);
    let a = recording(directory.path(), "a.mcap", 20);
    std::fs::write(directory.path().join("notes.txt"), "").unwrap();
    let view = View::start(&[directory.path().to_str().unwrap()]);
    let listed = get(view.port, "/session.json").json()["recordings"].clone();
    let names: Vec<&str> = (listed.as_array().unwrap().iter())
        .map(|recording| recording["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["a.mcap", "b.mcap"]);
    let view = View::start(&[a.to_str().unwrap(), "--against", b.to_str().unwrap()]);
    let listed = get(view.port, "/session.json").json()["recordings"].clone();
    assert_eq!(listed[0]["against"], serde_json::Value::Null);
    assert_eq!(listed[1]["against"], true);
}

fn run(arguments: &[&str]) -> (String, String, i32) {
    let done = Command::new(PROGRAM).args(arguments).output().unwrap();
    (
        String::from_utf8_lossy(&done.stdout).into_owned(),
        String::from_utf8_lossy(&done.stderr).into_owned(),
        done.status.code().unwrap_or(-1),
    )
}

#[test]
fn what_cannot_be_viewed_is_said_at_once() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name).display().to_string();
    std::fs::write(path("text.mcap"), "hello").unwrap();
    for (arguments, words) in [
        (vec!["view".to_owned(), path("none.mcap")], "none.mcap"),
        (vec!["view".to_owned(), path("text.mcap")], "text.mcap"),
    ] {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let (_, stderr, code) = run(&arguments);
        assert!(code == 2 && stderr.contains(words), "{stderr}");
    }
    std::fs::remove_file(path("text.mcap")).unwrap();
    let (_, stderr, code) = run(&["view", directory.path().to_str().unwrap()]);
    assert!(code == 2 && stderr.contains("no recordings"), "{stderr}");
}

/// What an element of the page holds.
fn element<'t>(page: &'t str, id: &str) -> &'t str {
    let at = page.find(&format!("<script id=\"{id}\"")).unwrap();
    let rest = &page[at..];
    let rest = &rest[rest.find('>').unwrap() + 1..];
    &rest[..rest.find("</script>").unwrap()]
}

fn base64(text: &str) -> Vec<u8> {
    let value = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let digits: Vec<u8> = text.bytes().filter(|c| *c != b'=').map(value).collect();
    let mut bytes = Vec::new();
    for four in digits.chunks(4) {
        let bits = four.iter().fold(0u32, |bits, d| bits << 6 | u32::from(*d));
        let bits = bits << (6 * (4 - four.len()));
        bytes.extend_from_slice(&bits.to_be_bytes()[1..four.len()]);
    }
    bytes
}

#[test]
fn one_page_holds_the_whole_recording_or_says_that_it_was_thinned() {
    let directory = tempfile::tempdir().unwrap();
    let path = recording(directory.path(), "a<b>.mcap", 3_000);
    let out = directory.path().join("page.html");
    let (stdout, stderr, code) = run(&[
        "view",
        path.to_str().unwrap(),
        "--html",
        out.to_str().unwrap(),
    ]);
    assert_eq!(code, 0, "{stderr}");
    assert!(!stdout.contains("thinned"), "{stdout}");
    let page = std::fs::read_to_string(&out).unwrap();
    let whole = std::fs::read(&path).unwrap();
    assert!(base64(element(&page, "palpate-recording")) == whole);
    assert!(page.contains("data-name=\"a&lt;b&gt;.mcap\""));
    let scene: SceneSnapshot = decode(&base64(element(&page, "palpate-scene")), "").unwrap();
    assert_eq!(scene.tools[0].id, "ball");
    let tools: serde_json::Value = serde_json::from_str(element(&page, "palpate-tools")).unwrap();
    assert_eq!(tools[0]["id"], "ball");
    // All of it is in the page, and the page is small beside the data.
    assert!(!page.contains("app.js\"") && !page.contains("app.css\""));
    assert!(page.len() < 3_000_000 + whole.len() * 3 / 2);
    let (stdout, stderr, code) = run(&[
        "view",
        path.to_str().unwrap(),
        "--html",
        out.to_str().unwrap(),
        "--max-data",
        "100kB",
    ]);
    assert_eq!(code, 0, "{stderr}");
    assert!(stdout.contains("thinned: one tick in"), "{stdout}");
    let page = std::fs::read_to_string(&out).unwrap();
    let part = base64(element(&page, "palpate-recording"));
    assert!(part.len() <= 100_000, "{} bytes", part.len());
    let session = Session::parse(Path::new("part.mcap"), &part).unwrap();
    let (first, last) = session.tick_range().unwrap();
    assert!(first < 100 && last > 2_900, "{first} to {last}");
    assert_ne!(session.header.run["thinned_every"], "1");
}
