//! Raw round trip of the bus: what no haptic loop on it can beat.

use crate::ClientError;
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};
use zenoh::Wait;
use zenoh::qos::{CongestionControl, Priority};

/// Round trips, ns, sorted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PingReport {
    /// All round trips, ns, in ascending order.
    pub round_trips_ns: Vec<u64>,
}

impl PingReport {
    /// A quantile (0 ..= 1), ns; 0 when nothing came back.
    pub fn quantile(&self, q: f64) -> u64 {
        let last = self.round_trips_ns.len().saturating_sub(1);
        self.round_trips_ns
            .get((q * last as f64).round() as usize)
            .copied()
            .unwrap_or(0)
    }
}

/// Sends `count` payloads of 120 bytes, `interval` apart, between two fresh sessions over a
/// loopback port, and back.
///
/// # Errors
/// Zenoh refused.
pub fn raw_ping(port: u16, count: usize, interval: Duration) -> Result<PingReport, ClientError> {
    let open = |key: &str| {
        let mut config = crate::configuration(None, "peer").map_err(ClientError::zenoh)?;
        let endpoint = format!("[\"tcp/127.0.0.1:{port}\"]");
        config
            .insert_json5(&format!("{key}/endpoints"), &endpoint)
            .map_err(ClientError::zenoh)?;
        crate::links::open(config, false).map_err(ClientError::zenoh)
    };
    let (near, far) = (open("listen")?, open("connect")?);
    let publisher = |session: &zenoh::Session, key: &'static str| {
        session
            .declare_publisher(key)
            .priority(Priority::RealTime)
            .congestion_control(CongestionControl::Drop)
            .express(true)
            .wait()
            .map_err(ClientError::zenoh)
    };
    let (pong_in, pongs) = channel();
    let _pong = near
        .declare_subscriber("palpate-ping/pong")
        .callback(move |_| {
            let _ = pong_in.send(());
        })
        .wait()
        .map_err(ClientError::zenoh)?;
    // As a daemon does it: the receive thread hands over, another thread answers.
    let (ping_in, pings) = channel();
    let _ping = far
        .declare_subscriber("palpate-ping/ping")
        .callback(move |sample| {
            let _ = ping_in.send(sample.payload().clone());
        })
        .wait()
        .map_err(ClientError::zenoh)?;
    let answer = publisher(&far, "palpate-ping/pong")?;
    let echo = std::thread::spawn(move || {
        for payload in pings {
            let _ = answer.put(payload).wait();
        }
    });
    let ask = publisher(&near, "palpate-ping/ping")?;
    let mut report = PingReport::default();
    let warm_up = Instant::now();
    while warm_up.elapsed() < Duration::from_secs(2) {
        let _ = ask.put(vec![0u8; 120]).wait();
        if pongs.recv_timeout(Duration::from_millis(50)).is_ok() {
            break;
        }
    }
    for _ in 0..count {
        std::thread::sleep(interval);
        while pongs.try_recv().is_ok() {}
        let sent = Instant::now();
        let _ = ask.put(vec![0u8; 120]).wait();
        if pongs.recv_timeout(Duration::from_millis(100)).is_ok() {
            report.round_trips_ns.push(sent.elapsed().as_nanos() as u64);
        }
    }
    report.round_trips_ns.sort_unstable();
    drop((_ping, _pong));
    let _ = near.close().wait();
    let _ = far.close().wait();
    let _ = echo.join();
    Ok(report)
}
