//! A guard beside a CRTK driver: forces pass while they are fresh.
//!
//! Drivers such as sawSensablePhantom apply the last `servo_cf` for ever. The guard runs on the driver's
//! machine, takes forces from `NS/palpate/servo_cf` and hands them to the driver; when none comes for
//! 20 ms, whatever the reason, it sends zero and `free`.

use super::super::unix_ns;
use super::node::{Intake, RosNode};
use palpate_devices::Cap;
use palpate_devices::ros2::{Bool, Empty, Header, Qos, WrenchStamped};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

/// Without a force for so long the driver gets zero.
pub const FRESH: Duration = Duration::from_millis(20);
const QUEUE: usize = 256;

/// What a guard did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GuardReport {
    /// Forces passed on.
    pub passed: u64,
    /// Times that zero was sent because forces stopped.
    pub stopped: u64,
}

/// Guards until `stop` is set.
///
/// # Errors
/// Zenoh refused.
pub fn guard_crtk(
    session: &zenoh::Session,
    namespace: &str,
    cap: Cap,
    stop: &AtomicBool,
) -> zenoh::Result<GuardReport> {
    let name = namespace.trim_matches('/').replace('/', "_");
    let node = RosNode::new(session, 0, &format!("palpate_guard_{name}"))?;
    let topic = |name: &str| format!("{}/{name}", namespace.trim_end_matches('/'));
    let forces = node.publisher::<WrenchStamped>(&topic("body/servo_cf"), Qos::Newest)?;
    let free = node.publisher::<Empty>(&topic("free"), Qos::Reliable)?;
    let absolute =
        node.publisher::<Bool>(&topic("body/set_cf_orientation_absolute"), Qos::Reliable)?;
    let (queue, inputs) = sync_channel(QUEUE);
    let intake = Arc::new(Intake::default());
    let take = move |wrench: WrenchStamped, _| drop(queue.try_send(wrench));
    let _receiver = node.subscriber(&topic("palpate/servo_cf"), Qos::Newest, &intake, take)?;
    let mut report = GuardReport::default();
    let mut last: Option<(Instant, String)> = None;
    let rest = |frame: &str| {
        forces.put(&WrenchStamped {
            header: Header::new(unix_ns(), frame),
            force: [0.0; 3],
            torque: [0.0; 3],
        });
        free.put(&Empty::default());
    };
    while !stop.load(Ordering::Relaxed) {
        let left = last
            .as_ref()
            .map_or(FRESH, |(at, _)| FRESH.saturating_sub(at.elapsed()));
        match inputs.recv_timeout(left) {
            Ok(mut wrench) => {
                while let Ok(newer) = inputs.try_recv() {
                    wrench = newer;
                }
                if last.is_none() {
                    absolute.put(&Bool { data: true });
                }
                (wrench.force, wrench.torque) = cap.limit(wrench.force, wrench.torque);
                last = Some((Instant::now(), wrench.header.frame_id.clone()));
                forces.put(&wrench);
                report.passed += 1;
            }
            Err(RecvTimeoutError::Timeout) => {
                if let Some((_, frame)) = last.take() {
                    rest(&frame);
                    report.stopped += 1;
                    tracing::warn!(namespace, "forces stopped: the device is free");
                }
            }
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    if let Some((_, frame)) = last {
        rest(&frame);
    }
    Ok(report)
}
