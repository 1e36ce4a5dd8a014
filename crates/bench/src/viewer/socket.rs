//! A page's WebSocket that only reads and counts.

use anyhow::{Context as _, ensure};
use std::io::{BufReader, Read, Write as _};
use std::net::{Shutdown, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Reads in a thread of its own until it is dropped.
pub(super) struct Socket {
    stream: TcpStream,
    counts: Arc<Counts>,
}

#[derive(Default)]
struct Counts {
    nets: AtomicU64,
    bytes: AtomicU64,
}

impl Socket {
    pub(super) fn open(port: u16) -> anyhow::Result<Self> {
        let mut stream = TcpStream::connect(("127.0.0.1", port)).context("the page's port")?;
        write!(
            stream,
            "GET /live HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
        )?;
        let mut reader = BufReader::new(stream.try_clone()?);
        let mut head = Vec::new();
        while !head.ends_with(b"\r\n\r\n") {
            ensure!(head.len() < 4_096, "the answer has no end");
            let mut byte = [0];
            reader.read_exact(&mut byte)?;
            head.push(byte[0]);
        }
        ensure!(
            head.starts_with(b"HTTP/1.1 101"),
            "{}",
            String::from_utf8_lossy(&head)
        );
        let counts = Arc::new(Counts::default());
        let shared = counts.clone();
        std::thread::spawn(move || while read(&mut reader, &shared).is_ok() {});
        Ok(Self { stream, counts })
    }

    /// Nets and bytes so far.
    pub(super) fn counts(&self) -> (u64, u64) {
        let get = |count: &AtomicU64| count.load(Ordering::Relaxed);
        (get(&self.counts.nets), get(&self.counts.bytes))
    }

    pub(super) fn wait_for_net(&self) -> anyhow::Result<()> {
        let begun = Instant::now();
        while self.counts().0 == 0 {
            ensure!(begun.elapsed() < Duration::from_secs(10), "no net came");
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(())
    }
}

impl Drop for Socket {
    fn drop(&mut self) {
        let _ = self.stream.shutdown(Shutdown::Both);
    }
}

/// One frame of a server: opcode, length, payload.
fn read(reader: &mut impl Read, counts: &Counts) -> std::io::Result<()> {
    let mut head = [0; 2];
    reader.read_exact(&mut head)?;
    let length = match head[1] & 0x7f {
        126 => {
            let mut bytes = [0; 2];
            reader.read_exact(&mut bytes)?;
            u64::from(u16::from_be_bytes(bytes))
        }
        127 => {
            let mut bytes = [0; 8];
            reader.read_exact(&mut bytes)?;
            u64::from_be_bytes(bytes)
        }
        short => u64::from(short),
    };
    let mut payload = vec![0; length.min(1 << 26) as usize];
    reader.read_exact(&mut payload)?;
    counts.bytes.fetch_add(length, Ordering::Relaxed);
    // A key that short has its length in one byte.
    if payload.get(1..6) == Some(&b"body/"[..]) {
        counts.nets.fetch_add(1, Ordering::Relaxed);
    }
    Ok(())
}
