//! A guard beside a CRTK driver: forces pass while they are fresh.
//!
//! Drivers such as sawSensablePhantom apply the last `servo_cf` for ever. The guard runs on the driver's
//! machine, takes forces from `NS/palpate/servo_cf` and hands them to the driver; when none comes, whatever
//! the reason, it fades the last one as every client does ([`Watchdog`]), and sends zero and `free`.

use super::super::unix_ns;
use super::node::{Intake, RosNode};
use palpate_client::Watchdog;
use palpate_devices::Cap;
use palpate_devices::ros2::{Bool, Empty, Header, Qos, WrenchStamped};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

/// Between two looks at how old the last force is.
const TURN: Duration = Duration::from_millis(1);
const QUEUE: usize = 256;
/// Zero is sent again after each of so many such times: a force may be lost on the way, and the driver would keep the
/// one before.
const REPEATS: u32 = 10;
const REPEAT: Duration = Duration::from_millis(20);

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
    let take = move |wrench: WrenchStamped, _| drop(queue.try_send((Instant::now(), wrench)));
    let _receiver = node.subscriber(&topic("palpate/servo_cf"), Qos::Newest, &intake, take)?;
    let mut report = GuardReport::default();
    let zero = |frame: &str| {
        forces.put(&WrenchStamped {
            header: Header::new(unix_ns(), frame),
            force: [0.0; 3],
            torque: [0.0; 3],
        });
    };
    let rest = |frame: &str| {
        zero(frame);
        free.put(&Empty::default());
    };
    // A guard that was started again comes to a force that acts already.
    let mut watchdog = Watchdog::new(false).from_nothing();
    let mut newest: Option<WrenchStamped> = None;
    let (mut resting, mut reported) = (true, 0.0);
    // How often zero is still to be sent, and when it was last.
    let mut again = (0, Instant::now());
    while !stop.load(Ordering::Relaxed) {
        let mut came = false;
        match inputs.recv_timeout(TURN) {
            Ok(first) => {
                for (at, mut wrench) in std::iter::once(first).chain(inputs.try_iter()) {
                    watchdog.heard(at);
                    (wrench.force, wrench.torque) = cap.limit(wrench.force, wrench.torque);
                    newest = Some(wrench);
                    came = true;
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        let Some(wrench) = &newest else {
            continue;
        };
        let gain = watchdog.gain(Instant::now());
        if gain == 0.0 {
            if !resting {
                rest(&wrench.header.frame_id);
                again = (REPEATS, Instant::now());
                report.stopped += 1;
                tracing::warn!(namespace, "forces stopped: the device is free");
            } else if again.0 > 0 && again.1.elapsed() >= REPEAT {
                zero(&wrench.header.frame_id);
                again = (again.0 - 1, Instant::now());
            }
            resting = true;
        } else if came || gain != reported {
            if resting {
                absolute.put(&Bool { data: true });
            }
            resting = false;
            let mut felt = wrench.clone();
            if gain < 1.0 {
                felt.force = felt.force.map(|f| f * gain);
                felt.torque = felt.torque.map(|t| t * gain);
            }
            forces.put(&felt);
            report.passed += u64::from(came);
        }
        reported = gain;
    }
    if let Some(wrench) = newest.filter(|_| !resting) {
        rest(&wrench.header.frame_id);
    }
    Ok(report)
}
