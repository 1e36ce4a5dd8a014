//! A page as a program: the socket's frames, without a browser.
#![allow(dead_code)]

use super::daemon::Daemon;
pub use super::daemon::free_port;
use palpate_client::proto::codec::{decode, encode};
use palpate_client::proto::messages::{DeviceInfo, Message, ToolPose};
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::time::{Duration, Instant};
use tungstenite::WebSocket;
use tungstenite::client::IntoClientRequest as _;

/// A daemon with a page.
pub fn serve(directory: &Path, text: &str, arguments: &[&str]) -> (Daemon, u16) {
    let port = free_port();
    let address = format!("127.0.0.1:{port}");
    let arguments: Vec<&str> = [&["--http", &address, "--no-open"], arguments].concat();
    let daemon = Daemon::start(directory, text, &arguments);
    wait_for(port);
    (daemon, port)
}

/// Waits until somebody listens.
pub fn wait_for(port: u16) {
    let begun = Instant::now();
    while TcpStream::connect(("127.0.0.1", port)).is_err() {
        assert!(begun.elapsed() < Duration::from_secs(60), "no page");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Status, headers in lower case, and body of an answer.
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.body).unwrap()
    }

    pub fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.body).unwrap()
    }
}

/// `GET` with further headers; `Host` among them replaces the usual one.
pub fn get_with(port: u16, path: &str, headers: &[(&str, &str)]) -> Answer {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    let mut request = format!("GET {path} HTTP/1.1\r\nConnection: close\r\n");
    if !headers.iter().any(|(name, _)| *name == "Host") {
        request += &format!("Host: 127.0.0.1:{port}\r\n");
    }
    for (name, value) in headers {
        request += &format!("{name}: {value}\r\n");
    }
    write!(stream, "{request}\r\n").unwrap();
    let mut bytes = Vec::new();
    stream.read_to_end(&mut bytes).unwrap();
    let end = bytes.windows(4).position(|w| w == b"\r\n\r\n").unwrap();
    let head = String::from_utf8_lossy(&bytes[..end]).to_ascii_lowercase();
    Answer {
        status: head[9..12].parse().unwrap(),
        head,
        body: bytes[end + 4..].to_vec(),
    }
}

pub fn get(port: u16, path: &str) -> Answer {
    get_with(port, path, &[])
}

/// A page's socket.
pub struct Page {
    socket: WebSocket<TcpStream>,
    calls: u64,
    /// Frames that came while another was awaited.
    pub seen: Vec<(String, Vec<u8>)>,
}

impl Page {
    /// Opens the socket, without the token.
    pub fn watch(port: u16) -> Self {
        Self::try_watch(port, &[]).unwrap_or_else(|e| panic!("{e}"))
    }

    /// The same with further headers.
    pub fn try_watch(port: u16, headers: &[(&'static str, &str)]) -> Result<Self, String> {
        let url = format!("ws://127.0.0.1:{port}/live");
        let mut request = url.into_client_request().unwrap();
        for (name, value) in headers {
            request.headers_mut().insert(*name, value.parse().unwrap());
        }
        let stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        let (socket, _) = tungstenite::client(request, stream).map_err(|e| e.to_string())?;
        socket
            .get_ref()
            .set_read_timeout(Some(Duration::from_secs(30)))
            .unwrap();
        Ok(Self {
            socket,
            calls: 0,
            seen: Vec::new(),
        })
    }

    /// Opens the socket and sends the token.
    pub fn open(port: u16) -> Self {
        let mut page = Self::watch(port);
        let token = get(port, "/session.json").json()["token"].clone();
        page.send("token", &text(token.as_str().unwrap()));
        page
    }

    pub fn send(&mut self, key: &str, payload: &[u8]) {
        let frame = [&text(key)[..], payload].concat();
        let _ = self.socket.send(tungstenite::Message::Binary(frame.into()));
    }

    pub fn send_raw(&mut self, message: tungstenite::Message) {
        let _ = self.socket.send(message);
    }

    /// The next frame; `None` when the socket was closed.
    pub fn next(&mut self) -> Option<(String, Vec<u8>)> {
        loop {
            match self.socket.read() {
                Ok(tungstenite::Message::Binary(frame)) => {
                    let (key, payload) = take_text(&frame);
                    return Some((key, payload.to_vec()));
                }
                Ok(tungstenite::Message::Close(_)) => return None,
                Ok(_) => {}
                Err(_) => return None,
            }
        }
    }

    /// The next frame that `take` takes.
    pub fn until<T>(&mut self, what: &str, mut take: impl FnMut(&str, &[u8]) -> Option<T>) -> T {
        let begun = Instant::now();
        while begun.elapsed() < Duration::from_secs(60) {
            let (key, payload) = (self.next()).unwrap_or_else(|| panic!("closed before {what}"));
            if let Some(taken) = take(&key, &payload) {
                return taken;
            }
            self.seen.push((key, payload));
        }
        let keys: std::collections::BTreeSet<&String> =
            self.seen.iter().map(|(key, _)| key).collect();
        panic!("never saw {what}, but {keys:?}");
    }

    /// The first frame from place `from` of those seen on that `take` takes: what a command changes may come before its
    /// answer.
    pub fn until_from<T>(
        &mut self,
        from: usize,
        what: &str,
        mut take: impl FnMut(&str, &[u8]) -> Option<T>,
    ) -> T {
        let early = self.seen[from..].iter();
        let early = early.map(|(key, payload)| take(key, payload));
        match early.flatten().next() {
            Some(taken) => taken,
            None => self.until(what, take),
        }
    }

    /// The next message of a key.
    pub fn message<M: Message>(&mut self, key: &str) -> M {
        self.until(key, |got, payload| {
            (got == key).then(|| decode::<M>(payload, "").unwrap())
        })
    }

    /// Why the next write was refused.
    pub fn refusal(&mut self) -> serde_json::Value {
        self.until("a refusal", |key, payload| {
            (key == "refused").then(|| serde_json::from_str(&take_text(payload).0).unwrap())
        })
    }

    /// Waits until a tool is held by whom `who` likes.
    pub fn holder(&mut self, tool: &str, who: impl Fn(Option<&str>) -> bool) {
        self.until("a holder", |key, payload| {
            if key != "holders" {
                return None;
            }
            let holders: serde_json::Value = serde_json::from_str(&take_text(payload).0).unwrap();
            who(holders[tool].as_str()).then_some(())
        });
    }

    /// Carries out a command.
    pub fn call(&mut self, method: &str, arguments: &str) -> serde_json::Value {
        self.calls += 1;
        let id = self.calls;
        let payload = [postcard(&id), text(arguments)].concat();
        self.send(&format!("rpc/{method}"), &payload);
        self.until("an answer", |key, payload| {
            if key != "rpc" {
                return None;
            }
            let (number, rest) = postcard::take_from_bytes::<u64>(payload).unwrap();
            (number == id).then(|| serde_json::from_str(&take_text(rest).0).unwrap())
        })
    }

    pub fn claim(&mut self, tool: &str, name: &str) {
        self.send(&format!("tool/{tool}/device"), &encode(&mouse(name)));
    }

    /// Takes a tool with a device that pushes nobody.
    pub fn claim_without_motors(&mut self, tool: &str, name: &str) {
        let info = DeviceInfo {
            dof_force: 0,
            ..mouse(name)
        };
        self.send(&format!("tool/{tool}/device"), &encode(&info));
    }

    pub fn pose(&mut self, tool: &str, pose: &ToolPose) {
        self.send(&format!("tool/{tool}/pose"), &encode(pose));
    }
}

/// A device of a page that can push, unlike its mouse.
pub fn mouse(name: &str) -> DeviceInfo {
    DeviceInfo {
        name: name.into(),
        dof_force: 3,
        dof_torque: 0,
        workspace: [0.2; 3],
        force_max: 5.0,
        force_continuous: 5.0,
        torque_max: 0.0,
        mass: 0.1,
        damping: 1.0,
        coulomb_friction: 0.0,
        encoder_resolution: 1e-4,
        rate_hz: 60.0,
        delay_s: 0.0,
        deadband: 0.0,
    }
}

fn postcard(value: &u64) -> Vec<u8> {
    postcard::to_allocvec(value).unwrap()
}

/// A postcard string.
pub fn text(words: &str) -> Vec<u8> {
    postcard::to_allocvec(words).unwrap()
}

/// A postcard string, and what follows it.
pub fn take_text(bytes: &[u8]) -> (String, &[u8]) {
    postcard::take_from_bytes::<String>(bytes).unwrap()
}
