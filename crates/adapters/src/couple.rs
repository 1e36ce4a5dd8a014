//! One device and one tool: the loop that every adapter runs.

use palpate_client::proto::messages::{DeviceInfo, ToolForce, ToolPose, force_flags};
use palpate_client::{ClientError, Tool};
use palpate_devices::{Command, Coupler, DeviceEnd, Rest, ToolAnswer, ToolMotion};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What a coupling needs beside its two ends.
pub struct Coupling<'a> {
    /// Frames, clutch, safety.
    pub coupler: Coupler,
    /// What the device can do; its rate is measured and reported again once it is known.
    pub info: DeviceInfo,
    /// Set to end.
    pub stop: &'a AtomicBool,
}

/// What a coupling saw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Readings of the device.
    pub readings: u64,
    /// Readings that could not be poses.
    pub refused: u64,
    /// Commands passed on.
    pub commands: u64,
    /// Greatest force passed on, N.
    pub peak_force_n: f64,
    /// Readings a second, over the last measurement; 0 before the first.
    pub rate_hz: f64,
}

/// Why a coupling ended by itself.
#[derive(Debug, thiserror::Error)]
pub enum CoupleError<E> {
    /// The device.
    #[error("{0}")]
    Device(E),
    /// The bus.
    #[error(transparent)]
    Bus(#[from] ClientError),
}

/// Between two looks at whether to stop, and between forces to a device that says nothing.
const TURN: Duration = Duration::from_millis(1);
/// In real time a pose waits this long for its force before the newest one counts.
const ANSWER: Duration = Duration::from_millis(2);
/// In lockstep, between two looks at whether to stop.
const LOCKSTEP_TURN: Duration = Duration::from_millis(100);
/// Time over which a rate is measured.
const MEASURED: Duration = Duration::from_millis(500);
/// A rate that changes by less is not reported.
const SAME_RATE: f64 = 0.1;
/// Slower devices are warned of.
const USUAL_HZ: f64 = 900.0;

/// Runs until `stop` is set or an end fails; the last command is zero in either case.
///
/// # Errors
/// The device or the bus is gone.
pub fn couple<D: DeviceEnd>(
    device: &mut D,
    tool: &mut Tool,
    coupling: Coupling<'_>,
) -> Result<Report, CoupleError<D::Error>> {
    let mut report = Report::default();
    let ended = turn_after_turn(device, tool, coupling, &mut report);
    let rest = Command::rest(Rest::Stopped, super::unix_ns());
    let applied = device.apply(&rest).map_err(CoupleError::Device);
    ended.and(applied).map(|()| report)
}

fn turn_after_turn<D: DeviceEnd>(
    device: &mut D,
    tool: &mut Tool,
    coupling: Coupling<'_>,
    report: &mut Report,
) -> Result<(), CoupleError<D::Error>> {
    let Coupling {
        mut coupler,
        info,
        stop,
    } = coupling;
    let lockstep = tool.is_lockstep();
    let mut rate = Rate::new(info);
    let mut last: Option<(u64, Command)> = None;
    let mut answered = 0;
    while !stop.load(Ordering::Relaxed) {
        let patience = if lockstep { LOCKSTEP_TURN } else { TURN };
        let reading = device.reading(patience).map_err(CoupleError::Device)?;
        if let Some(reading) = &reading {
            report.readings += 1;
            if let Some(motion) = coupler.motion(reading) {
                let seq = tool.send(pose_of(&motion))?;
                answered = wait_for_answer(tool, seq, lockstep, stop)?;
            }
            report.refused = coupler.refused();
            if !lockstep && let Some(info) = rate.reading() {
                report.rate_hz = info.rate_hz;
                tool.announce(info)?;
            }
        }
        let (newest, now) = (tool.newest(), Instant::now());
        let Some(force) = newest.felt(now) else {
            continue;
        };
        let command = coupler.command(&answer_of(&force, newest.gain(now) == 0.0));
        // In lockstep every pose has its answer, and nothing else is said. In real time the last force fades
        // when no other comes.
        let is_new = last.is_none_or(|(tick, reported)| {
            tick != force.tick || (!lockstep && reported != command)
        });
        if is_new && (!lockstep || answered > 0) {
            last = Some((force.tick, command));
            device.apply(&command).map_err(CoupleError::Device)?;
            report.commands += 1;
            let size = command.force.iter().map(|f| f * f).sum::<f64>().sqrt();
            report.peak_force_n = report.peak_force_n.max(size);
        }
    }
    Ok(())
}

/// Waits for the force of a pose: in lockstep until it is there, else not for long.
fn wait_for_answer(
    tool: &Tool,
    seq: u64,
    lockstep: bool,
    stop: &AtomicBool,
) -> Result<u64, ClientError> {
    if !lockstep {
        let force = tool.wait_force(seq, ANSWER);
        return Ok(force.map_or(0, |force| force.pose_seq));
    }
    while !stop.load(Ordering::Relaxed) {
        if let Some(force) = tool.wait_force(seq, LOCKSTEP_TURN) {
            return Ok(force.pose_seq);
        }
        tool.take_refusal()?;
    }
    Ok(0)
}

fn pose_of(motion: &ToolMotion) -> ToolPose {
    ToolPose {
        t_client_ns: motion.time_ns,
        orientation: motion.orientation,
        linear_velocity: motion.linear_velocity,
        angular_velocity: motion.angular_velocity,
        buttons: motion.buttons,
        ..palpate_client::pose_at(motion.position)
    }
}

fn answer_of(force: &ToolForce, silent: bool) -> ToolAnswer {
    let has = |flag: u32| force.flags & flag != 0;
    ToolAnswer {
        tick: force.tick,
        force: force.force,
        torque: force.torque,
        time_ns: force.t_server_ns,
        stale: has(force_flags::STALE),
        paused: has(force_flags::PAUSED),
        fault: has(force_flags::FAULT),
        silent,
    }
}

/// How often a device speaks. A coupling that is bounded by its device takes the period from it.
struct Rate {
    info: DeviceInfo,
    since: Instant,
    count: u32,
}

impl Rate {
    fn new(info: DeviceInfo) -> Self {
        Self {
            info,
            since: Instant::now(),
            count: 0,
        }
    }

    /// Another reading. Gives the description anew when the rate has become another one.
    fn reading(&mut self) -> Option<&DeviceInfo> {
        if self.count == 0 {
            self.since = Instant::now();
        }
        self.count += 1;
        let passed = self.since.elapsed();
        if passed < MEASURED {
            return None;
        }
        let rate_hz = f64::from(self.count - 1) / passed.as_secs_f64();
        self.count = 0;
        let known = self.info.rate_hz;
        if (rate_hz - known).abs() <= SAME_RATE * known {
            return None;
        }
        if rate_hz < USUAL_HZ {
            tracing::warn!(
                device = self.info.name,
                rate_hz = rate_hz.round(),
                "poses come more rarely than 1000 times a second: stiff contact can vibrate; set `bounded = true` in \
                 the tool's coupling, or raise the driver's rate"
            );
        }
        self.info.rate_hz = rate_hz;
        Some(&self.info)
    }
}
