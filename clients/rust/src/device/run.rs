//! A simulated device on the bus: in real time at its own rate, or one pose a tick in lockstep.

use super::servo::Servo;
use super::{DeviceError, Motion, Network, PassivitySettings, SimulatedDevice};
use crate::tool::now_ns;
use crate::{ClientError, Tool};
use palpate_proto::messages::force_flags;
use palpate_proto::watchdog::Silences;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What a run saw.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunReport {
    /// Name of the device.
    #[serde(default)]
    pub device: String,
    /// Poses sent.
    pub poses: u64,
    /// Forces received.
    pub forces: u64,
    /// Largest force received, N.
    pub peak_force_n: f64,
    /// Largest force that acted, N, and its root mean square over the run (what the motors warm up
    /// by).
    #[serde(default)]
    pub applied_force_n: [f64; 2],
    /// Deepest penetration, m.
    pub peak_depth_m: f64,
    /// Extent of the way gone in each axis, m.
    #[serde(default)]
    pub range_m: [f64; 3],
    /// Pose sent to its force received, real time only, without the network of the settings: p50,
    /// p99, max, µs.
    pub round_trip_us: [f64; 3],
    /// Age of the newest force when it is applied, by the daemon's clock and this machine's, real time
    /// only: p50, p99, max, µs. Of use where both clocks are one.
    #[serde(default)]
    pub force_age_us: [f64; 3],
    /// Energy the device gave to the loop by the end, J. Negative: the loop made some.
    #[serde(default)]
    pub loop_j: f64,
    /// Most that the loop had made at any time, J.
    #[serde(default)]
    pub made_j: f64,
    /// What the passivity controller took, J.
    #[serde(default)]
    pub dissipated_j: f64,
    /// Poses and forces lost on the network of the settings.
    #[serde(default)]
    pub lost: [u64; 2],
    /// Forces that arrived after a newer one, and were left.
    #[serde(default)]
    pub late: u64,
    /// Times that no force came, in real time: the device was let go meanwhile.
    #[serde(default)]
    pub silences: Silences,
    /// Forces that were withheld: the tool was seated inside a body, and was not out of it once yet.
    #[serde(default)]
    pub withheld: u64,
    /// The daemon stopped answering.
    pub gave_up: bool,
}

/// How to run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunSettings {
    /// Poses a second.
    pub rate_hz: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// What lies between device and daemon, besides the real one: this each way.
    pub network: Network,
    /// Keep the device's port passive.
    pub passivity: bool,
    /// How long the daemon may be silent before the run is given up. The device is let go meanwhile.
    pub patience: Duration,
}

impl RunSettings {
    /// At a rate for a time, with no network of its own and no control.
    pub fn plain(rate_hz: f64, duration_s: f64) -> Self {
        Self {
            rate_hz,
            duration_s,
            network: Network::default(),
            passivity: false,
            patience: PATIENCE,
        }
    }
}

/// One period of a run, at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Device time, s.
    pub time_s: f64,
    /// Where it is, m.
    pub true_position: [f64; 3],
    /// Reported position, m.
    pub reported_position: [f64; 3],
    /// Newest force received before the period, N.
    pub received_n: [f64; 3],
    /// What acted over it, N.
    pub applied_n: [f64; 3],
    /// Given to the loop so far, J.
    pub loop_j: f64,
}

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// Another client holds the tool, or Zenoh refused a pose.
    #[error(transparent)]
    Client(#[from] ClientError),
    /// A figure of the network.
    #[error(transparent)]
    Network(#[from] DeviceError),
}

/// How long a daemon is usually waited for that has fallen silent.
pub const PATIENCE: Duration = Duration::from_secs(5);

/// Forces come at least every 50 ms.
const SILENCE: Duration = Duration::from_secs(1);

/// Runs a device until its time is over, or `stop` is set. `watch` sees every period.
///
/// # Errors
/// Another client holds the tool, Zenoh refused a pose, or the network of the settings cannot be.
pub fn run(
    tool: &mut Tool,
    device: &mut SimulatedDevice,
    motion: &Motion,
    settings: &RunSettings,
    stop: &AtomicBool,
    watch: &mut dyn FnMut(&Sample),
) -> Result<RunReport, RunError> {
    let count = (settings.duration_s * settings.rate_hz).round() as u64;
    let dt = 1.0 / settings.rate_hz;
    let lockstep = tool.is_lockstep();
    let passivity = (settings.passivity).then(|| PassivitySettings::of(device.model()));
    let mut servo = Servo::new(settings.network, passivity)?;
    let mut report = RunReport {
        device: device.model().name.clone(),
        ..RunReport::default()
    };
    let mut round_trips: Vec<u64> = Vec::new();
    let mut ages: Vec<u64> = Vec::new();
    let mut bounds = [device.true_position(); 2];
    let mut squares = 0.0;
    let started = Instant::now();
    let mut heard = started;
    for k in 1..=count {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        if let Some(force) = servo.held().filter(|_| !lockstep) {
            ages.push(now_ns().saturating_sub(force.t_server_ns));
        }
        let gain = (!lockstep).then(|| tool.newest().gain(Instant::now()));
        let period = servo.period(device, motion, dt, gain);
        let now_s = device.time_s();
        watch(&period.sample);
        squares += note(&mut report, &mut bounds, device);
        let mut seq = None;
        for pose in period.poses {
            seq = Some(tool.send(pose)?);
            report.poses += 1;
        }
        let force = match (lockstep, seq) {
            (true, Some(seq)) => {
                let force = tool.wait_force(seq, settings.patience);
                if force.is_none() {
                    tool.take_refusal()?;
                    report.gave_up = true;
                    break;
                }
                force
            }
            _ => {
                // The answer to this pose usually comes while we wait for the next; what is newest
                // is felt.
                let due = Duration::from_secs_f64(k as f64 * dt);
                let left = due.saturating_sub(started.elapsed());
                let answer =
                    seq.and_then(|seq| tool.wait_force(seq, left.min(Duration::from_millis(100))));
                if let Some(force) = answer.filter(|force| Some(force.pose_seq) == seq) {
                    round_trips.push(now_ns().saturating_sub(force.t_client_ns));
                }
                std::thread::sleep(due.saturating_sub(started.elapsed()));
                // As it came: it fades where it acts, after the network of the settings.
                tool.newest().force
            }
        };
        if let Some(force) = force.filter(|force| servo.hear(now_s, *force)) {
            let size = force.force.iter().map(|f| f * f).sum::<f64>().sqrt();
            report.peak_force_n = report.peak_force_n.max(size);
            report.withheld += u64::from(force.flags & force_flags::WITHHELD != 0);
            if force.flags & force_flags::STALE == 0 {
                report.peak_depth_m = report.peak_depth_m.max(force.depth);
            }
            heard = Instant::now();
        }
        if !lockstep && servo.has_heard() && heard.elapsed() > settings.patience {
            report.gave_up = true;
            break;
        }
        servo.collect(now_s);
    }
    // A daemon that went away in the last moments of a run.
    let silent = heard.elapsed() > SILENCE && count as f64 * dt > SILENCE.as_secs_f64();
    report.gave_up |= !lockstep && servo.has_heard() && silent;
    report.silences = tool.newest().silences(Instant::now());
    report.forces = tool.received();
    report.applied_force_n[1] = (squares * dt / device.time_s().max(dt)).sqrt();
    report.range_m = [0, 1, 2].map(|c| bounds[1][c] - bounds[0][c]);
    report.loop_j = device.energy().loop_j;
    report.dissipated_j = servo.dissipated_j();
    report.lost = servo.lost();
    report.late = servo.late();
    report.round_trip_us = quantiles(&mut round_trips);
    report.force_age_us = quantiles(&mut ages);
    Ok(report)
}

/// Notes a period; gives the square of the force that acted.
fn note(report: &mut RunReport, bounds: &mut [[f64; 3]; 2], device: &SimulatedDevice) -> f64 {
    let square = device.applied_n().iter().map(|f| f * f).sum::<f64>();
    report.applied_force_n[0] = report.applied_force_n[0].max(square.sqrt());
    report.made_j = report.made_j.max(-device.energy().loop_j);
    for (c, x) in device.true_position().into_iter().enumerate() {
        bounds[0][c] = bounds[0][c].min(x);
        bounds[1][c] = bounds[1][c].max(x);
    }
    square
}

/// p50, p99 and max of round trips, µs.
fn quantiles(round_trips_ns: &mut [u64]) -> [f64; 3] {
    round_trips_ns.sort_unstable();
    [0.5, 0.99, 1.0].map(|q: f64| {
        let last = round_trips_ns.len().saturating_sub(1);
        round_trips_ns
            .get((q * last as f64).round() as usize)
            .map_or(0.0, |&ns| ns as f64 * 1e-3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_of_the_sorted_times() {
        let mut times: Vec<u64> = (1..=101).rev().map(|k| k * 1_000).collect();
        assert_eq!(quantiles(&mut times), [51.0, 100.0, 101.0]);
        assert_eq!(quantiles(&mut []), [0.0; 3]);
    }
}
