//! Messages of any content, in any order, to a loop in lockstep: what a fuzzer drives.

use super::check::LoopCheck;
use super::plan::SCENES;
use super::{set_now, world};
use palpate::transport::loop_command;
use palpate_client::proto::codec;
use palpate_client::proto::messages::{DeviceInfo, ToolPose};
use palpate_client::proto::rpc::{Call, METHODS};
use palpate_drive::driver::{Driver, DriverSettings};
use palpate_drive::journal::NoJournal;
use palpate_drive::pacer::Wake;
use palpate_drive::ports::{BusPorts, CommandRequest, SenderId, ports};
use palpate_sim::haptics::DeviceBounds;
use palpate_sim::scene::Scene;
use palpate_sim::scene::spec::Clock;
use palpate_sim::tick::record::Command;
use palpate_wire as wire;
use std::sync::Arc;

/// Most ticks of one sequence: a fuzzer learns more from many short ones.
const MOST_TICKS: u64 = 400;
/// Bytes of what a sequence says of a message before its content: what, and how long.
const HEAD: usize = 2;
/// A tick, ns.
const TICK_NS: u64 = 1_000_000;

/// What became of a sequence of messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Ticks.
    pub ticks: u64,
    /// Messages that the loop took.
    pub taken: u64,
    /// Messages that were dropped.
    pub dropped: u64,
    /// Of the last tick.
    pub state_hash: u64,
}

/// Reads bytes as messages to one tool, and steps the loop after each.
///
/// The first byte chooses a scene. Then, message after message, one byte whose low half says what and
/// whose high half by whom and for how many ticks, one byte with the length of the content, and the
/// content: a pose or a device description as on the wire, a short pose (three offsets in units of
/// 0.5 mm from where the tool stands), the arguments of a command with its number before them, or
/// nothing for a holder who leaves and for time that passes.
///
/// # Errors
/// What must not happen at any tick: a fault, a force beyond its limit or after its time, a point of a
/// body far from the scene.
pub fn messages(bytes: &[u8]) -> Result<Counts, String> {
    set_now(0);
    let (first, mut rest) = bytes.split_first().unwrap_or((&0, &[]));
    let (_, scene) = world::scene(usize::from(*first) % SCENES.len())?;
    let mut stepped = Stepped::new(scene);
    while let [head, length, content @ ..] = rest {
        let length = usize::from(*length).min(content.len());
        let (content, after) = content.split_at(length);
        rest = after;
        let (what, who, ticks) = (head & 7, (head >> 3) & 3, 1 << (head >> 5));
        match stepped.message(what, who, content) {
            true => stepped.counts.taken += 1,
            false => stepped.counts.dropped += 1,
        }
        if !stepped.ticks(ticks)? || stepped.counts.ticks >= MOST_TICKS {
            break;
        }
    }
    Ok(stepped.counts)
}

/// A sequence for [`messages`], of what each message is, who sends it, how long the loop runs after it
/// (ticks, a power of two up to 128) and its content.
pub fn sequence(scene: u8, messages: &[(u8, u8, u8, &[u8])]) -> Vec<u8> {
    let mut bytes = vec![scene];
    for (what, who, ticks, content) in messages {
        let ticks = ticks.max(&1).ilog2() as u8;
        let length = content.len().min(usize::from(u8::MAX));
        bytes.extend([what & 7 | (who & 3) << 3 | ticks << 5, length as u8]);
        bytes.extend(&content[..length]);
    }
    debug_assert!(bytes.len() > HEAD || messages.is_empty());
    bytes
}

struct Stepped {
    scene: Arc<Scene>,
    driver: Driver,
    bus: BusPorts,
    check: LoopCheck,
    seq: u64,
    counts: Counts,
}

impl Stepped {
    fn new(scene: Arc<Scene>) -> Self {
        let (tick_ports, bus) = ports(&scene);
        let settings = DriverSettings {
            clock: Clock::Lockstep,
            ticks: None,
            privileged: false,
            follow: false,
            threads: 1,
        };
        let journal = Box::new(NoJournal);
        Self {
            driver: Driver::new(scene.clone(), tick_ports, journal, settings, super::now_ns),
            check: LoopCheck::new(&scene),
            bus,
            scene,
            seq: 0,
            counts: Counts::default(),
        }
    }

    /// True if it was taken.
    fn message(&mut self, what: u8, who: u8, content: &[u8]) -> bool {
        let sender = SenderId::of(Some(&[who]));
        match what {
            0 => {
                let read = codec::decode::<ToolPose>(content, "");
                let pose = read.ok().and_then(|pose| pose.validated().ok());
                pose.is_some_and(|pose| self.pose(&pose, sender))
            }
            1 => {
                let Ok(info) = codec::decode::<DeviceInfo>(content, "") else {
                    return false;
                };
                let bounds = info.validated().ok();
                let bounds = bounds.map(|info| wire::device_bounds(&self.scene, 0, &info));
                bounds.is_some_and(|bounds| self.bind(bounds))
            }
            2 => content.split_first().is_some_and(|(method, arguments)| {
                let method = METHODS[usize::from(*method) % METHODS.len()];
                let call = Call::parse(method, arguments).ok();
                let command = call.and_then(|call| loop_command(&call, &self.scene));
                command.is_some_and(|command| command.is_ok_and(|command| self.command(command)))
            }),
            3 => {
                self.bus.poses[0].forget_sender();
                self.bind(DeviceBounds::default())
            }
            4 => true,
            _ => {
                let offset = |axis: usize| content.get(axis).map_or(0, |byte| *byte as i8);
                let start = self.scene.spec.tools[0].pose.position;
                let at = [0, 1, 2].map(|axis| start[axis] + 5e-4 * f64::from(offset(axis)));
                self.seq += 1;
                let pose = ToolPose {
                    seq: self.seq,
                    ..palpate_client::pose_at(at)
                };
                self.pose(&pose, sender)
            }
        }
    }

    fn pose(&mut self, pose: &ToolPose, sender: SenderId) -> bool {
        let offered = self.bus.poses[0].offer_at(wire::device_pose(pose), sender, super::now_ns());
        offered == palpate_drive::ports::Offered::Taken
    }

    fn bind(&mut self, bounds: DeviceBounds) -> bool {
        self.check.bounds(bounds);
        self.command(Command::Device { tool: 0, bounds })
    }

    fn command(&mut self, command: Command) -> bool {
        let request = CommandRequest { id: 0, command };
        self.bus.commands.push(request).is_ok()
    }

    /// False: the loop was asked to stop.
    fn ticks(&mut self, count: u64) -> Result<bool, String> {
        for _ in 0..count {
            set_now(super::now_ns() + TICK_NS);
            if !self.driver.turn(Wake::default()) {
                return Ok(false);
            }
            let record = self.driver.record();
            self.counts.ticks += 1;
            self.counts.state_hash = record.output.state_hash;
            self.check.tick(&self.scene, self.driver.state(), record)?;
            while self.bus.outputs.pop().is_ok() {}
            while self.bus.records.pop().is_ok() {}
            while self.bus.receipts.pop().is_ok() {}
            for net in &mut self.bus.nets {
                net.newest();
            }
        }
        Ok(true)
    }
}
