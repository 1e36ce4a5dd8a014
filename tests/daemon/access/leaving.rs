//! Clients that come and go over TLS while the daemon writes to them.

use super::Secured;
use palpate::auth::Role;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};
use zenoh::Wait as _;

// Zenoh 1.10 as published lets one thread write to a TLS connection while another reads its end: of
// these departures, one in a few hundred ended the daemon with a segmentation fault.
#[test]
fn clients_that_leave_while_forces_flow_do_not_bring_a_daemon_down() {
    let mut secured = Secured::start();
    let ball = secured.identity(Role::tool("ball").unwrap());
    let viewer = secured.identity(Role::Viewer);
    let mut device = Command::new(crate::daemon::PROGRAM)
        .args([
            "device", "--tool", "ball", "--motion", "press", "--for", "60s",
        ])
        .args(["--connect", &secured.endpoint, "--identity"])
        .arg(&ball)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let all = &secured;
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| (0..60).for_each(|_| come_and_go(all, &viewer)));
        }
    });
    let ended = secured.child.try_wait().unwrap();
    device.kill().unwrap();
    device.wait().unwrap();
    assert!(ended.is_none(), "the daemon ended: {ended:?}");
}

/// Listens to forces for a tenth of a second, and leaves.
fn come_and_go(secured: &Secured, viewer: &std::path::Path) {
    let session = secured.session(viewer).expect("the daemon answers");
    let heard = Arc::new(AtomicU32::new(0));
    let count = Arc::clone(&heard);
    let subscriber = session
        .declare_subscriber("palpate/default/tool/ball/force")
        .callback(move |_| {
            count.fetch_add(1, Ordering::Relaxed);
        })
        .wait()
        .unwrap();
    let begun = Instant::now();
    while heard.load(Ordering::Relaxed) < 100 {
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "nothing is heard"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    drop(subscriber);
    session.close().wait().unwrap();
}
