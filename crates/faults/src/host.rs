//! The daemon: loop, recorder, and what the bus thread does with forces, stepped by virtual time.

use super::check::LoopCheck;
use super::disk::{FaultyDisk, Health};
use super::{now, now_ns};
use palpate::transport::RateWatch;
use palpate_client::device::DeviceModel;
use palpate_drive::driver::{Driver, DriverSettings};
use palpate_drive::pacer::Schedule;
use palpate_drive::ports::{BusPorts, CommandRequest, SenderId, ports};
use palpate_proto::messages::{ToolForce, ToolPose};
use palpate_record::{RecorderSettings, SteppedRecorder, WriteError};
use palpate_sim::haptics::DeviceBounds;
use palpate_sim::scene::file::Loaded;
use palpate_sim::scene::spec::Clock;
use palpate_sim::scene::{Scene, inline_files};
use palpate_sim::tick::record::Command;
use palpate_wire as wire;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// What a daemon leaves behind.
pub(super) struct Session {
    pub file: PathBuf,
    /// State hash of each tick from 1, as the loop had it.
    pub hashes: Vec<u64>,
    pub ended: Ended,
    /// Ticks that had run when the recorder last had its turn before the disk refused.
    pub disk_refused: Option<u64>,
    /// All is written, but the disk did not answer in time: the file has no name.
    pub unconfirmed: bool,
}

/// How a daemon ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ended {
    Cleanly,
    /// Killed; ticks whose records may not have been written: those since the disk or the recorder
    /// last had their turn.
    Killed {
        behind: u64,
    },
}

/// A running daemon.
pub(super) struct Host {
    scene: Arc<Scene>,
    driver: Driver,
    bus: BusPorts,
    recorder: SteppedRecorder,
    schedule: Schedule,
    rate: RateWatch,
    pub health: Arc<Health>,
    file: PathBuf,
    hashes: Vec<u64>,
    check: LoopCheck,
    disk_refused: Option<u64>,
    /// Ticks when the recorder last had its turn.
    taken: u64,
}

impl Host {
    /// Starts; records to a file from the first tick on.
    pub fn start(loaded: &Loaded, scene: &Arc<Scene>, file: &Path) -> Result<Self, String> {
        let health = Arc::new(Health::default());
        let effective =
            inline_files(&loaded.spec, &loaded.directory).map_err(|error| error.to_string())?;
        let settings = RecorderSettings {
            disk: Arc::new(FaultyDisk {
                health: health.clone(),
            }),
            ..RecorderSettings::new(&loaded.text, &effective).to(file)
        };
        let (recorder, port) =
            SteppedRecorder::new(settings, scene).map_err(|error| error.to_string())?;
        let (tick_ports, bus) = ports(scene);
        let settings = DriverSettings {
            clock: Clock::Realtime,
            ticks: None,
            privileged: false,
            follow: false,
            threads: 1,
        };
        let driver = Driver::new(scene.clone(), tick_ports, Box::new(port), settings, now_ns);
        let period_ns = (scene.dt_s * 1e9).round() as u64;
        Ok(Self {
            driver,
            bus,
            recorder,
            schedule: Schedule::new(period_ns, now_ns()),
            rate: RateWatch::new(1.0 / scene.dt_s),
            health,
            file: file.to_owned(),
            hashes: Vec::new(),
            check: LoopCheck::new(scene),
            disk_refused: None,
            taken: 0,
            scene: scene.clone(),
        })
    }

    /// When the next tick is due, ns.
    pub fn due_ns(&self) -> u64 {
        self.schedule.next_ns()
    }

    /// A tick, now; its state hash.
    pub fn tick(&mut self) -> Result<u64, String> {
        let wake = self.schedule.wake(now_ns());
        self.driver.turn(wake);
        let record = self.driver.record();
        self.hashes.push(record.output.state_hash);
        self.check.tick(&self.scene, self.driver.state(), record)?;
        Ok(record.output.state_hash)
    }

    /// What the bus thread does in a turn: the newest force, if there is one.
    pub fn bus(&mut self) -> Option<ToolForce> {
        let mut newest = None;
        while let Ok(published) = self.bus.outputs.pop() {
            self.rate.tick(now());
            newest = Some(published);
        }
        while self.bus.records.pop().is_ok() {}
        while self.bus.receipts.pop().is_ok() {}
        for net in &mut self.bus.nets {
            net.newest();
        }
        let _ = self.rate.look(now());
        let newest = newest?;
        let output = &newest.output;
        let out = &output.tools[0];
        if out.pose_seq == 0 {
            return None;
        }
        let gain = self.rate.gain();
        let mut force = wire::tool_force(output.tick, 0, out);
        force.force = force.force.map(|f| f * gain);
        force.torque = force.torque.map(|t| t * gain);
        Some(force)
    }

    /// The recorder's turn.
    pub fn record(&mut self) {
        self.recorder.turn();
        self.look_at_disk();
        self.taken = self.hashes.len() as u64;
    }

    fn look_at_disk(&mut self) {
        let failed = palpate_drive::journal::keeping::FAILED;
        let state = self.recorder.gauges().state.load(Ordering::Relaxed);
        if state == failed && self.disk_refused.is_none() {
            self.disk_refused = Some(self.taken);
        }
    }

    /// A pose arrives.
    pub fn pose(&mut self, pose: &ToolPose, sender: SenderId) {
        self.bus.poses[0].offer_at(wire::device_pose(pose), sender, now_ns());
    }

    /// A device describes itself.
    pub fn described(&mut self, model: &DeviceModel) {
        let bounds = wire::device_bounds(&self.scene, 0, &model.info(0.0));
        self.bind(bounds);
    }

    /// The tool's holder is gone.
    pub fn gone(&mut self) {
        self.bus.poses[0].forget_sender();
        self.bind(DeviceBounds::default());
    }

    fn bind(&mut self, bounds: DeviceBounds) {
        self.check.bounds(bounds);
        self.command(Command::Device { tool: 0, bounds });
    }

    /// A command of someone.
    pub fn command(&mut self, command: Command) {
        let _ = self.bus.commands.push(CommandRequest { id: 0, command });
    }

    /// Killed: what it did not hand over is gone.
    pub fn kill(self) -> Session {
        let ticks = self.hashes.len() as u64;
        Session {
            file: self.file,
            hashes: self.hashes,
            ended: Ended::Killed {
                behind: ticks - self.taken,
            },
            disk_refused: self.disk_refused,
            unconfirmed: false,
        }
    }

    /// Asked to end.
    pub fn end(mut self) -> Session {
        self.look_at_disk();
        drop(self.driver);
        let report = self.recorder.finish();
        let unconfirmed = matches!(report.failure, Some(WriteError::Unconfirmed { .. }));
        if report.failure.is_some() && !unconfirmed {
            self.disk_refused = self.disk_refused.or(Some(self.taken));
        }
        Session {
            file: self.file,
            hashes: self.hashes,
            ended: Ended::Cleanly,
            disk_refused: self.disk_refused,
            unconfirmed,
        }
    }
}
