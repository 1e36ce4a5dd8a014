//! Playback: a recording published as if it were live, through the same ports as a loop.
//!
//! ```text
//! FILE ─▶ Cursor (state, step) ─▶ Player (pace, requests) ─▶ TickPorts ═▶ bus
//! ```
//! The recorded inputs go through the same step, so that all contacts and every net are there
//! again; what was recorded wins where another build makes other forces. Poses and commands of
//! clients do not reach the state.

mod cursor;
mod deadlines;
mod remap;

pub use remap::played_scene;

use super::reader::{ReadError, Session};
use cursor::{Advance, Cursor};
use deadlines::Deadlines;
use palpate_drive::nets::NetPool;
use palpate_drive::pacer::{now_ns, sleep_until};
use palpate_drive::playback::{PlayNews, PlayPort, PlayRequest};
use palpate_drive::ports::{BUS_NETS, TickPorts};
use palpate_drive::stats::LATE_NS;
use palpate_sim::scene::{Scene, SceneError};
use palpate_sim::tick::record::{TickOutput, TickRecord};
use serde::Serialize;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;

/// Why a recording cannot be played.
#[derive(Debug, thiserror::Error)]
pub enum PlayError {
    /// The file.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Its scene.
    #[error("the recorded scene does not parse: {0}")]
    SceneText(String),
    /// Its scene.
    #[error("the recorded scene does not build: {0}")]
    Scene(#[from] SceneError),
    /// No ticks.
    #[error("{path}: the recording contains no ticks")]
    Empty {
        /// File.
        path: PathBuf,
    },
    /// Nothing between start and end.
    #[error("no tick lies between {start} and {end}: the recording has {first} to {last}")]
    Range {
        /// Wanted.
        start: u64,
        /// Wanted.
        end: u64,
        /// There is.
        first: u64,
        /// There is.
        last: u64,
    },
    /// Another name that cannot be.
    #[error("--remap {old}:={new}: {reason}")]
    Remap {
        /// Old id.
        old: String,
        /// New id.
        new: String,
        /// What is wrong.
        reason: String,
    },
    /// A tick that cannot be reached.
    #[error("tick {tick} cannot be reached: {reason}")]
    Seek {
        /// Wanted.
        tick: u64,
        /// Why.
        reason: String,
    },
    /// The state is of another scene.
    #[error("keyframe at tick {tick}: {source}")]
    State {
        /// Its tick.
        tick: u64,
        /// Cause.
        source: palpate_geometry::math::StateError,
    },
}

/// How to play.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaySettings {
    /// First tick; that of the file if left out.
    pub start: Option<u64>,
    /// Last tick; that of the file if left out.
    pub end: Option<u64>,
    /// Simulated over real time.
    pub rate: f64,
    /// Stand still at first.
    pub paused: bool,
    /// At the end go on from the start.
    pub looped: bool,
    /// At the end stand still instead of ending.
    pub stay: bool,
}

/// What was played.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PlayReport {
    /// Ticks published.
    pub ticks: u64,
    /// Newest tick.
    pub last_tick: u64,
    /// Wall time while it was going, s.
    pub wall_s: f64,
    /// Simulated over real time, achieved.
    pub rate: f64,
    /// Ticks published more than 100 µs late.
    pub late: u64,
    /// Gaps of the recording that were jumped.
    pub gaps: u64,
    /// Times that it began anew.
    pub loops: u64,
    /// First tick whose recorded force was published in place of ours.
    pub diverged: Option<u64>,
}

/// Plays a recording into the ports of a bus.
pub struct Player {
    cursor: Cursor,
    ports: TickPorts,
    nets: NetPool,
    port: PlayPort,
    settings: PlaySettings,
    dt_s: f64,
    paused: bool,
    deadlines: Deadlines,
    over: bool,
    reported: bool,
    report: PlayReport,
}

/// Requests are looked at this often while a tick is waited for.
const SLICE: Duration = Duration::from_millis(10);
/// While the bus has no room.
const BUS_NAP: Duration = Duration::from_micros(50);

impl Player {
    /// Ready before the first tick; `scene` is that of [`played_scene`], whose ports these are.
    ///
    /// # Errors
    /// No ticks between start and end, or states of another scene.
    pub fn new(
        session: Session,
        scene: Arc<Scene>,
        ports: TickPorts,
        port: PlayPort,
        settings: PlaySettings,
    ) -> Result<Self, PlayError> {
        let dt_s = scene.dt_s;
        let cursor = Cursor::new(session, &scene, settings.start, settings.end)?;
        let deadlines = Deadlines::new(period_ns(dt_s, settings.rate), now_ns());
        let paused = settings.paused;
        let nets = NetPool::new(&scene, BUS_NETS);
        let report = PlayReport::default();
        Ok(Self {
            cursor,
            ports,
            nets,
            port,
            settings,
            dt_s,
            paused,
            deadlines,
            over: false,
            reported: false,
            report,
        })
    }

    /// Plays to the end, or until someone stops it.
    ///
    /// # Errors
    /// A state in the file that is of another scene.
    pub fn run(mut self, scene: &Scene) -> Result<PlayReport, PlayError> {
        let mut resumed_ns = now_ns();
        let mut played = 0;
        self.show(scene, None);
        if self.paused {
            self.tell(PlayNews::Paused(true));
        }
        while !self.over && !self.ports.stop_asked() {
            if self.paused {
                if let Ok((id, request)) = self.port.requests.recv_timeout(SLICE) {
                    self.handle(scene, id, request)?;
                }
                resumed_ns = now_ns();
                continue;
            }
            if let Some((id, request)) = self.request_before_the_deadline() {
                self.handle(scene, id, request)?;
                continue;
            }
            let before = self.report.ticks;
            self.tick(scene)?;
            let now = now_ns();
            self.report.wall_s += (now - resumed_ns) as f64 * 1e-9;
            resumed_ns = now;
            played += self.report.ticks - before;
        }
        self.report.last_tick = self.cursor.state().tick;
        self.report.rate = played as f64 * self.dt_s / self.report.wall_s.max(1e-9);
        Ok(self.report)
    }

    /// Waits for the next deadline, in slices: who plays slowly still listens.
    fn request_before_the_deadline(&mut self) -> Option<(u64, PlayRequest)> {
        loop {
            if let Ok(request) = self.port.requests.try_recv() {
                return Some(request);
            }
            let left = Duration::from_nanos(self.deadlines.next_ns().saturating_sub(now_ns()));
            if left <= SLICE {
                sleep_until(self.deadlines.next_ns());
                break;
            }
            match self.port.requests.recv_timeout(SLICE) {
                Ok(request) => return Some(request),
                Err(RecvTimeoutError::Timeout) => {}
                // No one can ask any more.
                Err(RecvTimeoutError::Disconnected) => std::thread::sleep(SLICE),
            }
            if self.ports.stop_asked() {
                break;
            }
        }
        self.report.late += u64::from(self.deadlines.pass(now_ns()) > LATE_NS);
        None
    }

    /// The next tick, published.
    fn tick(&mut self, scene: &Scene) -> Result<(), PlayError> {
        match self.cursor.advance()? {
            Advance::Tick(record) => {
                self.report.ticks += 1;
                self.publish(scene, &record);
                self.tell_divergence();
            }
            Advance::Gap { after, to } => {
                self.report.gaps += 1;
                tracing::warn!(
                    after,
                    to,
                    "ticks are missing in the recording: continuing at the next keyframe"
                );
                self.ports.rewind();
            }
            Advance::End if self.settings.looped => {
                self.report.loops += 1;
                self.cursor.rewind()?;
                self.show(scene, None);
                self.tell(PlayNews::Reset);
            }
            Advance::End if self.settings.stay => self.pause(scene, true),
            Advance::End => {
                self.show_net(scene);
                self.over = true;
            }
        }
        Ok(())
    }

    /// The bus is waited for: a player may, a loop may not.
    fn wait_for_room(&self) {
        while !self.ports.has_room() && !self.ports.stop_asked() {
            std::thread::sleep(BUS_NAP);
        }
    }

    fn publish(&mut self, scene: &Scene, record: &TickRecord) {
        self.wait_for_room();
        self.ports.publish(&record.output);
        self.nets.begin();
        self.ports
            .done(scene, self.cursor.state(), record, &mut self.nets);
    }

    /// Shows a state that was jumped to; `record` is that of its tick.
    fn show(&mut self, scene: &Scene, record: Option<TickRecord>) {
        self.ports.rewind();
        let tick = self.cursor.state().tick;
        let output = TickOutput {
            tick,
            ..TickOutput::default()
        };
        let mut record = record.unwrap_or(TickRecord {
            output,
            ..TickRecord::default()
        });
        // Its lateness was counted when it was played.
        (record.late_ns, record.input.skipped) = (0, 0);
        self.publish(scene, &record);
    }

    fn tell(&self, news: PlayNews) {
        // Without a bus no one listens.
        let _ = self.port.news.send(news);
    }

    fn tell_divergence(&mut self) {
        if let Some(tick) = self.cursor.diverged.filter(|_| !self.reported) {
            self.reported = true;
            self.report.diverged = Some(tick);
            tracing::warn!(
                tick,
                "this build diverges from the recording: publishing the recorded forces"
            );
        }
    }

    /// The net of the newest tick, which otherwise waits until it is due.
    fn show_net(&mut self, scene: &Scene) {
        self.wait_for_room();
        self.ports.rewind();
        self.nets.begin();
        let state = self.cursor.state();
        self.ports
            .hand_over_nets(scene, state, state.tick, &mut self.nets);
    }

    fn pause(&mut self, scene: &Scene, paused: bool) {
        if self.paused != paused {
            self.paused = paused;
            self.show_net(scene);
            self.tell(PlayNews::Paused(paused));
        }
        self.restart_clock();
    }

    fn set_rate(&mut self, rate: f64) {
        self.settings.rate = rate.clamp(1e-3, 1e4);
        self.restart_clock();
    }

    fn restart_clock(&mut self) {
        self.deadlines = Deadlines::new(period_ns(self.dt_s, self.settings.rate), now_ns());
    }

    fn handle(&mut self, scene: &Scene, id: u64, request: PlayRequest) -> Result<(), PlayError> {
        let mut done = Ok(());
        match request {
            PlayRequest::Pause => self.pause(scene, true),
            PlayRequest::Resume => self.pause(scene, false),
            PlayRequest::Toggle => self.pause(scene, !self.paused),
            PlayRequest::Rate(rate) => self.set_rate(rate),
            PlayRequest::Scale(factor) => {
                self.set_rate(self.settings.rate * factor);
                tracing::info!(rate = self.settings.rate, "playback rate changed");
            }
            PlayRequest::Step(ticks) if self.paused => self.step(scene, ticks)?,
            PlayRequest::Step(_) => {
                done = Err("step works only while playback is paused; pause it first".into())
            }
            PlayRequest::Seek(tick) => done = self.seek(scene, tick)?,
            PlayRequest::Back => match self.cursor.keyframe_before()? {
                Some(tick) => done = self.seek(scene, tick)?,
                None => done = Err("it is at its first state".into()),
            },
            PlayRequest::Reset => {
                self.cursor.rewind()?;
                self.show(scene, None);
                self.tell(PlayNews::Reset);
                self.restart_clock();
            }
            PlayRequest::Stop => self.over = true,
        }
        match done {
            Ok(()) => self.tell(PlayNews::Done {
                id,
                tick: self.cursor.state().tick,
            }),
            Err(reason) => self.tell(PlayNews::Refused { id, reason }),
        }
        Ok(())
    }

    /// So many ticks at once, fewer when the end comes before.
    fn step(&mut self, scene: &Scene, ticks: u32) -> Result<(), PlayError> {
        let until = self.report.ticks + u64::from(ticks);
        let ends = (
            std::mem::replace(&mut self.settings.looped, false),
            std::mem::replace(&mut self.settings.stay, true),
        );
        while self.report.ticks < until && !self.ports.stop_asked() {
            let before = (self.report.ticks, self.report.gaps);
            self.tick(scene)?;
            if before == (self.report.ticks, self.report.gaps) {
                break;
            }
        }
        (self.settings.looped, self.settings.stay) = ends;
        self.show_net(scene);
        Ok(())
    }

    fn seek(&mut self, scene: &Scene, tick: u64) -> Result<Result<(), String>, PlayError> {
        match self.cursor.seek(tick) {
            Ok(record) => {
                self.show(scene, record);
                self.tell_divergence();
                self.restart_clock();
                Ok(Ok(()))
            }
            Err(error @ PlayError::Seek { .. }) => Ok(Err(error.to_string())),
            Err(error) => Err(error),
        }
    }

    /// Ticks to play: first and last.
    pub fn range(&self) -> (u64, u64) {
        self.cursor.range()
    }
}

fn period_ns(dt_s: f64, rate: f64) -> u64 {
    ((dt_s * 1e9 / rate).round() as u64).max(1)
}
