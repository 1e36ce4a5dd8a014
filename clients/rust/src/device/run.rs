//! A simulated device on the bus: in real time at its own rate, or one pose a tick in lockstep.

use super::{Motion, SimulatedDevice};
use crate::tool::now_ns;
use crate::{ClientError, Tool};
use palpate_proto::messages::ToolPose;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What a run saw.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunReport {
    /// Poses sent.
    pub poses: u64,
    /// Forces received.
    pub forces: u64,
    /// Largest force, N.
    pub peak_force_n: f64,
    /// Deepest penetration, m.
    pub peak_depth_m: f64,
    /// Pose sent to its force received, real time only: p50, p99, max, µs.
    pub round_trip_us: [f64; 3],
    /// Lockstep only: the daemon stopped answering.
    pub gave_up: bool,
}

/// How to run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunSettings {
    /// Poses a second.
    pub rate_hz: f64,
    /// s.
    pub duration_s: f64,
}

/// In lockstep: how long the daemon may take for a tick before we give up.
const PATIENCE: Duration = Duration::from_secs(5);

/// Runs a device until its time is over, or `stop` is set.
///
/// # Errors
/// Zenoh refused a pose.
pub fn run(
    tool: &mut Tool,
    device: &mut SimulatedDevice,
    motion: &Motion,
    settings: &RunSettings,
    stop: &AtomicBool,
) -> Result<RunReport, ClientError> {
    let count = (settings.duration_s * settings.rate_hz).round() as u64;
    let dt = 1.0 / settings.rate_hz;
    let mut report = RunReport::default();
    let mut round_trips: Vec<u64> = Vec::new();
    let mut last_tick = 0;
    let mut held = [0.0; 3];
    let started = Instant::now();
    for k in 1..=count {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        device.advance(motion.goal(device.time_s() + 0.5 * dt), held, dt);
        let seq = tool.send(ToolPose { buttons: motion.buttons(device.time_s()), ..device.pose() })?;
        report.poses += 1;
        let force = if tool.is_lockstep() {
            let force = tool.wait_force(seq, PATIENCE);
            if force.is_none() {
                report.gave_up = true;
                break;
            }
            force
        } else {
            // The answer to this pose usually comes while we wait for the next; what is newest is felt.
            let due = Duration::from_secs_f64(k as f64 * dt);
            let left = due.saturating_sub(started.elapsed());
            let answer = tool.wait_force(seq, left.min(Duration::from_millis(100)));
            if let Some(force) = answer.filter(|force| force.pose_seq == seq) {
                round_trips.push(now_ns().saturating_sub(force.t_client_ns));
            }
            std::thread::sleep(due.saturating_sub(started.elapsed()));
            tool.force()
        };
        if let Some(force) = force.filter(|force| force.tick > last_tick) {
            last_tick = force.tick;
            held = force.force;
            let size = force.force.iter().map(|f| f * f).sum::<f64>().sqrt();
            report.peak_force_n = report.peak_force_n.max(size);
            report.peak_depth_m = report.peak_depth_m.max(force.depth);
        }
    }
    report.forces = tool.received();
    round_trips.sort_unstable();
    let quantile = |q: f64| {
        let last = round_trips.len().saturating_sub(1);
        round_trips.get((q * last as f64).round() as usize).map_or(0.0, |&ns| ns as f64 * 1e-3)
    };
    report.round_trip_us = [quantile(0.5), quantile(0.99), quantile(1.0)];
    Ok(report)
}
