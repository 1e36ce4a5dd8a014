//! What programs read from `serve`: where it listens, and how it ended.

use super::{Common, EndedSession};
use crate::transport::default_listen;
use anyhow::Context as _;
use palpate_record::{SelfCheckReport, stage_infos, write_stages};
use std::io::Write as _;
use std::net::{TcpListener, UdpSocket};

/// The endpoints to listen on, a free port instead of port 0.
///
/// # Errors
/// No port is free there.
pub fn resolved(common: &Common) -> anyhow::Result<Vec<String>> {
    let resolve = |endpoint: &String| -> anyhow::Result<String> {
        let free = endpoint.split_once('/').filter(|(protocol, address)| {
            ["tcp", "tls", "quic"].contains(protocol) && address.ends_with(":0")
        });
        let Some((protocol, address)) = free else {
            return Ok(endpoint.clone());
        };
        let bound = match protocol {
            "quic" => UdpSocket::bind(address).and_then(|socket| socket.local_addr()),
            _ => TcpListener::bind(address).and_then(|listener| listener.local_addr()),
        };
        let port = bound.with_context(|| endpoint.clone())?.port();
        let host = address.trim_end_matches(":0");
        Ok(format!("{protocol}/{host}:{port}"))
    };
    common.listen.iter().map(resolve).collect()
}

/// The line that says that clients can connect.
///
/// # Errors
/// The configuration file cannot be read.
pub fn line(common: &Common, page: Option<&str>) -> anyhow::Result<serde_json::Value> {
    let config = common.zenoh_config.as_deref();
    let secure = common.access.identity.is_some();
    let listen = default_listen(config, &common.listen, &common.connect, secure)?;
    Ok(serde_json::json!({
        "ready": true, "instance": common.instance, "listen": listen, "connect": common.connect, "page": page,
        "pid": std::process::id(),
    }))
}

/// The line that says that clients cannot connect, because the start failed.
pub fn failure(error: &str) -> serde_json::Value {
    serde_json::json!({ "ready": false, "error": error })
}

/// Writes a line to a file descriptor that whoever started this process left open.
///
/// # Errors
/// It is not open, or cannot be written.
pub fn write(fd: u32, line: &serde_json::Value) -> anyhow::Result<()> {
    let path = format!("/dev/fd/{fd}");
    let wrong = || format!("--ready-fd {fd}: it is not open for writing");
    let mut file = std::fs::OpenOptions::new()
        .write(true)
        .open(&path)
        .with_context(wrong)?;
    writeln!(file, "{line}").with_context(wrong)
}

/// The figures of a session.
pub fn report(served: &EndedSession) -> serde_json::Value {
    let report = &served.report;
    let us = |q: f64| report.lateness.quantile(q) as f64 * 1e-3;
    let files = served.recording.files.iter().map(|file| {
        serde_json::json!({
            "path": file.path, "ticks": file.ticks, "lost": file.dropped, "deleted": file.deleted,
            "session_hash": format!("{:016x}", file.session_hash),
        })
    });
    serde_json::json!({
        "ticks": report.ticks, "late": report.late, "skipped": report.skipped,
        "start_after_deadline_us": { "p50": us(0.5), "p99": us(0.99), "max": report.lateness.max() as f64 * 1e-3 },
        "self_check_differences": served.self_check.map(|check| check.differences),
        "recordings": files.collect::<Vec<_>>(),
        "recording_failure": served.recording.failure.as_ref().map(ToString::to_string),
    })
}

/// Prints the figures of a session.
pub fn summary(served: &EndedSession) {
    let report = &served.report;
    let us = |q: f64| report.lateness.quantile(q) as f64 * 1e-3;
    println!(
        "ticks {}, late {}, skipped {}",
        report.ticks, report.late, report.skipped
    );
    println!(
        "start after deadline: p50 {:.1} us, p99 {:.1} us, max {:.1} us",
        us(0.5),
        us(0.99),
        report.lateness.max() as f64 * 1e-3
    );
    let mut table = String::new();
    let _ = write_stages(&mut table, &stage_infos(&report.stages));
    print!("{table}");
    if let Some(SelfCheckReport {
        checks,
        ticks,
        unchecked,
        differences,
        ..
    }) = served.self_check
    {
        println!(
            "self-check: {ticks} ticks re-run in {checks} checks, {unchecked} unchecked, {differences} differences"
        );
    }
    let (deleted, kept): (Vec<_>, Vec<_>) =
        (served.recording.files.iter()).partition(|file| file.deleted);
    if let (Some(first), Some(last)) = (deleted.first(), deleted.last()) {
        println!(
            "deleted {} files with ticks {} to {}, to stay within --max-total",
            deleted.len(),
            first.first_tick,
            last.last_tick
        );
    }
    for recording in kept {
        println!(
            "recorded {} ({} ticks, {} lost), session hash {:016x}",
            recording.path.display(),
            recording.ticks,
            recording.dropped,
            recording.session_hash
        );
    }
}
