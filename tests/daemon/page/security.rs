//! Who may ask, and how much.

use super::TWO_BALLS;
use crate::page::{Page, get, get_with, serve, text};
use crate::session::Random;
use palpate_client::pose_at;
use palpate_client::proto::codec::encode;
use tungstenite::Message;

#[test]
fn the_page_comes_with_its_policy_and_only_under_numbers() {
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = serve(directory.path(), TWO_BALLS, &["--http-host", "lab-pc"]);
    for (path, kind) in [
        ("/", "text/html"),
        ("/app.js", "text/javascript"),
        ("/app.css", "text/css"),
        ("/session.json", "application/json"),
        ("/tools.json", "application/json"),
    ] {
        let answer = get(port, path);
        assert_eq!(answer.status, 200, "{path}");
        assert!(answer.head.contains(kind), "{path}: {}", answer.head);
        assert!(answer.head.contains("x-content-type-options: nosniff"));
        let policy =
            "content-security-policy: default-src 'none'; script-src 'self'; style-src 'self';";
        assert!(answer.head.contains(policy), "{}", answer.head);
    }
    assert!(!get(port, "/").text().contains("<script>"), "inline script");
    let host = |name: &str| get_with(port, "/session.json", &[("Host", name)]).status;
    assert_eq!((host("localhost"), host("lab-pc:99")), (200, 200));
    // By DNS rebinding a site is of our origin; its name is not ours.
    assert_eq!(host("evil.example"), 403);
    let origin = |origin: &str| {
        let answer = get_with(port, "/session.json", &[("Origin", origin)]);
        (answer.status, answer.text().contains("token"))
    };
    assert_eq!(origin("http://evil.example"), (403, false));
    assert_eq!(origin(&format!("http://127.0.0.1:{port}")), (200, true));
    assert_eq!(
        get_with(port, "/healthz", &[("Host", "evil.example")]).status,
        403
    );
}

#[test]
fn texts_are_compressed_for_who_takes_that_and_for_nobody_else() {
    use std::io::Read as _;
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    for path in ["/", "/app.js", "/app.css", "/tools.json"] {
        let plain = get(port, path);
        assert!(!plain.head.contains("content-encoding"), "{}", plain.head);
        assert!(
            plain.head.contains("vary: accept-encoding"),
            "{}",
            plain.head
        );
        // Twice: the second is kept from the first.
        for _ in 0..2 {
            let packed = get_with(port, path, &[("Accept-Encoding", "br, gzip;q=0.8")]);
            assert!(
                packed.head.contains("content-encoding: gzip"),
                "{}",
                packed.head
            );
            assert!(
                packed.head.contains("content-security-policy"),
                "{}",
                packed.head
            );
            let mut back = Vec::new();
            let mut decoder = flate2::read::GzDecoder::new(&packed.body[..]);
            decoder.read_to_end(&mut back).unwrap();
            assert_eq!(back, plain.body, "{path}");
            assert!(2 * packed.body.len() < plain.body.len(), "{path}");
        }
        let refused = get_with(port, path, &[("Accept-Encoding", "gzip;q=0")]);
        assert_eq!(refused.body, plain.body);
    }
    // What fits a packet is sent as it is.
    let short = get_with(port, "/healthz", &[("Accept-Encoding", "gzip")]);
    assert!(!short.head.contains("content-encoding"), "{}", short.head);
}

#[test]
fn another_site_cannot_open_the_socket() {
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    let own = format!("http://127.0.0.1:{port}");
    assert!(Page::try_watch(port, &[("Origin", &own)]).is_ok());
    for origin in ["http://evil.example", "null", "http://127.0.0.1:1"] {
        let refused = Page::try_watch(port, &[("Origin", origin)]);
        assert!(refused.is_err_and(|e| e.contains("403")), "{origin}");
    }
    // By DNS rebinding its origin is ours, and so is the host it asks for.
    let rebound = [("Host", "evil.example"), ("Origin", "http://evil.example")];
    let refused = Page::try_watch(port, &rebound);
    assert!(refused.is_err_and(|e| e.contains("403")), "rebound");
}

#[test]
fn without_the_token_nothing_is_written() {
    let directory = tempfile::tempdir().unwrap();
    let (daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    let mut page = Page::watch(port);
    page.send("token", &text("00000000000000000000000000000000"));
    assert_eq!(page.refusal()["key"], "token");
    page.claim("ball", "mouse");
    assert_eq!(page.refusal()["key"], "tool/ball/device");
    page.pose("ball", &pose_at([0.0; 3]));
    assert_eq!(page.refusal()["key"], "tool/ball/pose");
    page.send("rpc/pause", &[1, 2, b'{', b'}']);
    let refusal = page.refusal();
    assert_eq!(refusal["key"], "rpc/pause");
    assert!(refusal["error"].as_str().unwrap().contains("token"));
    let status = daemon.connect().status().unwrap();
    assert_eq!(status.tools[0].received, 0);
}

#[test]
fn an_audience_may_only_look() {
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = serve(directory.path(), TWO_BALLS, &["--http-view-only"]);
    let info = get(port, "/session.json").json();
    assert_eq!(info["token"], serde_json::Value::Null);
    let mut page = Page::watch(port);
    page.send("token", &text(""));
    assert_eq!(page.refusal()["key"], "token");
    page.send("rpc/shutdown", &[1, 0]);
    let refusal = page.refusal();
    assert!(
        refusal["error"].as_str().unwrap().contains("view"),
        "{refusal}"
    );
}

#[test]
fn nonsense_and_long_frames_close_the_socket_and_nothing_else() {
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    let mut other = Page::open(port);
    let ends = |message: Message| {
        let mut page = Page::open(port);
        page.send_raw(message);
        let begun = std::time::Instant::now();
        while page.next().is_some() {
            assert!(begun.elapsed().as_secs() < 30, "it stays open");
        }
    };
    ends(Message::Binary(vec![0xff; 12].into()));
    ends(Message::Binary(vec![200].into()));
    ends(Message::Text("{}".into()));
    let long = [text("rpc/pause"), vec![1], vec![b'x'; 70_000]].concat();
    ends(Message::Binary(long.into()));
    // A key that no page writes is refused, not fatal.
    other.send("body/drop/net", &encode(&pose_at([0.0; 3])));
    assert_eq!(other.refusal()["key"], "body/drop/net");
    assert_eq!(other.call("pause", "{}")["ok"], true);
}

#[test]
fn pages_are_bounded_in_number() {
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    let mut pages: Vec<Page> = (0..16).map(|_| Page::watch(port)).collect();
    let refused = Page::try_watch(port, &[]);
    assert!(refused.is_err_and(|e| e.contains("503")));
    drop(pages.pop());
    let begun = std::time::Instant::now();
    while Page::try_watch(port, &[]).is_err() {
        assert!(begun.elapsed().as_secs() < 30, "no room after one left");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
}

// Whatever a page with the token sends, the loop goes on, other pages go on, and at most its own
// socket ends.
#[test]
fn random_frames_harm_nobody() {
    let directory = tempfile::tempdir().unwrap();
    let (daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    let mut other = Page::open(port);
    let mut random = Random(11);
    let keys = [
        "token",
        "tool/ball/device",
        "tool/ball/pose",
        "tool/ball/release",
        "tool//pose",
        "tool/ball",
        "rpc/step",
        "rpc/",
        "rpc/../pause",
        "speed",
        "",
        "scene",
        "tool/ball/pose/pose",
    ];
    let mut page = Page::open(port);
    for k in 0..400 {
        if k % 25 == 0 {
            page = Page::open(port);
            page.claim("ball", "mouse");
        }
        let bytes = crate::wire::any_bytes(&mut random, 300);
        match random.below(5) {
            0 => page.send_raw(Message::Binary(bytes.into())),
            _ => page.send(keys[random.below(keys.len())], &bytes),
        }
    }
    drop(page);
    assert_eq!(other.call("pause", "{}")["ok"], true);
    assert_eq!(other.call("resume", "{}")["ok"], true);
    other.claim("ball", "another mouse");
    other.holder("ball", |who| who == Some("another mouse"));
    assert!(daemon.connect().status().unwrap().tick > 0);
}

// Seen: half a request, or a header now and then, stayed for ever and kept others out.
pub fn a_connection_whose_request_does_not_end_is_closed() {
    use std::io::{Read as _, Write as _};
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    let mut half = std::net::TcpStream::connect(("127.0.0.1", port)).unwrap();
    write!(half, "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ").unwrap();
    let mut slow = std::net::TcpStream::connect(("127.0.0.1", port)).unwrap();
    let begun = std::time::Instant::now();
    while slow.write_all(b"G").is_ok() {
        assert!(begun.elapsed().as_secs() < 60, "it goes on byte by byte");
        std::thread::sleep(std::time::Duration::from_millis(200));
    }
    let wait = Some(std::time::Duration::from_secs(60));
    half.set_read_timeout(wait).unwrap();
    let mut rest = Vec::new();
    // Closed, perhaps after a word about it or by a reset; not still open after a minute.
    if let Err(error) = half.read_to_end(&mut rest) {
        assert_eq!(error.kind(), std::io::ErrorKind::ConnectionReset, "{error}");
    }
    let text = String::from_utf8_lossy(&rest);
    assert!(
        text.is_empty() || text.starts_with("HTTP/1.1 408"),
        "{text}"
    );
    assert_eq!(get(port, "/healthz").status, 200);
}
