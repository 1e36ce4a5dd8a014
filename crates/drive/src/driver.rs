//! The tick thread: waits, latches, steps, hands over.

use super::journal::Journal;
use super::nets::NetPool;
use super::overload::Overload;
use super::pacer::{Privileges, Schedule, Wake, ask_privileges, now_ns, sleep_until};
use super::phase::Follower;
use super::ports::{BUS_NETS, Receipt, TickPorts};
use super::stats::{Histogram, LATE_NS, StageHistograms};
use super::threads::Threads;
use super::workers::Workers;
use palpate_geometry::math::state_hash;
use palpate_sim::scene::Scene;
use palpate_sim::scene::spec::Clock;
use palpate_sim::tick::record::{Command, TickRecord};
use palpate_sim::tick::stage::{Stage, StageTimes};
use palpate_sim::tick::{Pipeline, SceneState, Scratch};
use palpate_sim::tick::{apply, deform, hash, late_step, render};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;
use std::time::Duration;

/// How to drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriverSettings {
    /// What makes a tick due.
    pub clock: Clock,
    /// End after this many ticks.
    pub ticks: Option<u64>,
    /// Ask for FIFO scheduling and locked memory.
    pub privileged: bool,
    /// Move deadlines to where poses come; only in real time.
    pub follow: bool,
    /// Threads on which bodies step side by side, with that of the tick; at most as many as processors.
    pub threads: usize,
}

/// What a loop did.
#[derive(Clone, Debug)]
pub struct DriverReport {
    /// Ticks.
    pub ticks: u64,
    /// Ticks that began more than 100 µs late.
    pub late: u64,
    /// Deadlines dropped.
    pub skipped: u64,
    /// Lateness, ns.
    pub lateness: Histogram,
    /// Durations of stages and of whole ticks.
    pub stages: StageHistograms,
    /// What the operating system granted.
    pub privileges: Privileges,
}

/// Most ticks a stopping loop waits for its forces to fade.
const FADE_TICKS: u64 = 1_000;

/// Starts the tick thread. It owns the state; it ends after [`Command::Stop`], or after
/// `settings.ticks`.
///
/// # Errors
/// The thread could not be made.
pub fn start(
    scene: Arc<Scene>,
    ports: TickPorts,
    journal: Box<dyn Journal>,
    settings: DriverSettings,
) -> std::io::Result<JoinHandle<DriverReport>> {
    std::thread::Builder::new()
        .name("palpate-tick".into())
        .spawn(move || {
            let state = scene.initial_state();
            let mut scratch = scene.scratch(&state);
            match Workers::start(&scene) {
                Ok(Some(workers)) => scratch.set_pipeline(Box::new(workers)),
                Ok(None) => {}
                // Bodies then step in the tick in which they are due: the same bits, but late.
                Err(error) => tracing::warn!(
                    "could not start threads for bodies that step separately: {error}"
                ),
            }
            match Threads::start(settings.threads, settings.privileged) {
                Ok(Some(threads)) => scratch.set_executor(&scene, Some(Box::new(threads))),
                Ok(None) => {}
                Err(error) => tracing::warn!("could not start threads beside the tick's: {error}"),
            }
            let _ = ports.tick_thread.set(std::thread::current());
            let privileges = if settings.privileged {
                ask_privileges()
            } else {
                Privileges::default()
            };
            let mut driver = Driver::of(scene, state, scratch, ports, journal, settings, now_ns);
            driver.report.privileges = privileges;
            driver.run()
        })
}

/// A loop. [`start`] gives it a thread and the system's clock; who has a clock of their own steps it.
pub struct Driver {
    scene: Arc<Scene>,
    state: SceneState,
    scratch: Scratch,
    ports: TickPorts,
    nets: NetPool,
    journal: Box<dyn Journal>,
    /// Of the tick under way.
    record: TickRecord,
    settings: DriverSettings,
    report: DriverReport,
    overload: Overload,
    /// Tick at which stopping began.
    fading: Option<u64>,
    /// Hand-over of the tick before: a record leaves before its own is known.
    emit_ns: u32,
    /// What stages are timed by, ns.
    clock: fn() -> u64,
}

impl Driver {
    /// At the scene's start, with a clock for the durations of stages. Bodies that step separately do
    /// so in the tick in which they are due: the same bits.
    pub fn new(
        scene: Arc<Scene>,
        ports: TickPorts,
        journal: Box<dyn Journal>,
        settings: DriverSettings,
        clock: fn() -> u64,
    ) -> Self {
        let state = scene.initial_state();
        let scratch = scene.scratch(&state);
        let mut driver = Self::of(scene, state, scratch, ports, journal, settings, clock);
        driver.begin();
        driver
    }

    fn of(
        scene: Arc<Scene>,
        state: SceneState,
        scratch: Scratch,
        ports: TickPorts,
        journal: Box<dyn Journal>,
        settings: DriverSettings,
        clock: fn() -> u64,
    ) -> Self {
        let period_ns = (scene.dt_s * 1e9).round() as u64;
        let nets = NetPool::new(&scene, BUS_NETS + journal.nets_held());
        let record = TickRecord::for_tools(scene.tool_count());
        let report = DriverReport {
            ticks: 0,
            late: 0,
            skipped: 0,
            lateness: Histogram::default(),
            stages: StageHistograms::default(),
            privileges: Privileges::default(),
        };
        Self {
            scene,
            state,
            scratch,
            ports,
            nets,
            journal,
            record,
            settings,
            report,
            overload: Overload::new(period_ns),
            fading: None,
            emit_ns: 0,
            clock,
        }
    }

    /// Lets bodies that step separately step elsewhere.
    pub fn step_elsewhere(&mut self, pipeline: Box<dyn Pipeline>) {
        self.scratch.set_pipeline(pipeline);
    }

    /// One tick of a loop in real time, woken by whoever has the clock: commands and a next scene
    /// first. False: the loop is over.
    pub fn turn(&mut self, wake: Wake) -> bool {
        if self.is_over() {
            self.ports.counters.finished.store(true, Ordering::Release);
            return false;
        }
        self.take_commands();
        self.take_swap();
        self.tick(wake);
        true
    }

    /// Input and output of the newest tick.
    pub fn record(&self) -> &TickRecord {
        &self.record
    }

    /// The state after the newest tick.
    pub fn state(&self) -> &SceneState {
        &self.state
    }

    fn begin(&mut self) {
        self.journal.keyframe(&self.state, state_hash(&self.state));
    }

    fn run(mut self) -> DriverReport {
        self.begin();
        let period_ns = (self.scene.dt_s * 1e9).round() as u64;
        let mut schedule = Schedule::new(period_ns, now_ns());
        let mut follower = Follower::new(period_ns, self.scene.tool_count());
        while !self.is_over() {
            let wake = match self.settings.clock {
                Clock::Realtime => {
                    self.wait(schedule.next_ns(), &follower);
                    schedule.wake(now_ns())
                }
                Clock::Lockstep => {
                    if !self.ports.all_have_news()
                        && self.ports.commands.is_empty()
                        && self.ports.swaps.is_empty()
                    {
                        std::thread::park_timeout(Duration::from_millis(1));
                        continue;
                    }
                    Wake::default()
                }
            };
            self.take_commands();
            self.take_swap();
            if self.settings.clock == Clock::Lockstep && !self.ports.all_have_news() {
                continue;
            }
            self.tick(wake);
            if self.settings.follow {
                self.ports
                    .arrivals()
                    .for_each(|(tool, at_ns)| follower.saw(tool, at_ns));
                schedule.shift(follower.step(schedule.next_ns()));
                let followed = follower.followed().map_or(0, |tool| tool + 1);
                let counters = &self.ports.counters;
                counters.followed.store(followed, Ordering::Relaxed);
            }
        }
        self.ports.counters.finished.store(true, Ordering::Release);
        self.report
    }

    /// Until the deadline, or from shortly before it until the poses are there that it follows.
    fn wait(&self, deadline_ns: u64, follower: &Follower) {
        let opens_ns = deadline_ns - follower.early_ns();
        sleep_until(opens_ns);
        let missing =
            |tool: usize| follower.waits_for(tool) && !self.ports.has_come_since(tool, opens_ns);
        while (0..self.scene.tool_count()).any(missing) {
            let left_ns = deadline_ns.saturating_sub(now_ns());
            if left_ns == 0 {
                return;
            }
            std::thread::park_timeout(Duration::from_nanos(left_ns));
        }
    }

    fn is_over(&mut self) -> bool {
        let ticks = self.state.tick;
        let asked = self.ports.counters.stop.load(Ordering::Acquire);
        if (asked || self.settings.ticks.is_some_and(|most| ticks >= most)) && self.fading.is_none()
        {
            self.apply(Command::Stop);
        }
        let Some(since) = self.fading else {
            return false;
        };
        let faded = self.state.tools.iter().all(|tool| tool.link.limit_n == 0.0);
        self.settings.clock == Clock::Lockstep || faded || ticks >= since + FADE_TICKS
    }

    fn apply(&mut self, command: Command) {
        self.journal.command(self.state.tick, command);
        apply(&self.scene, &mut self.state, &mut self.scratch, command);
        match command {
            Command::Stop => self.fading = self.fading.or(Some(self.state.tick)),
            Command::Reset => self.journal.keyframe(&self.state, state_hash(&self.state)),
            Command::Pause
            | Command::Resume
            | Command::Step(_)
            | Command::Quality(_)
            | Command::PutOff { .. }
            | Command::Send { .. }
            | Command::Device { .. } => {}
        }
    }

    fn take_commands(&mut self) {
        while let Ok(request) = self.ports.commands.pop() {
            self.apply(request.command);
            let _ = self.ports.receipts.push(Receipt {
                id: request.id,
                tick: self.state.tick + 1,
            });
        }
    }

    /// Goes on with another scene, if there is one and room for the one that is left.
    fn take_swap(&mut self) {
        if self.ports.retired.slots() == 0 || self.fading.is_some() {
            return;
        }
        let Ok(mut swap) = self.ports.swaps.pop() else {
            return;
        };
        swap.exchange(&mut self.scene, &mut self.state, &mut self.scratch);
        std::mem::swap(&mut self.nets, &mut swap.nets);
        std::mem::swap(&mut self.ports.nets, &mut swap.net_port);
        std::mem::swap(&mut self.journal, &mut swap.journal);
        self.journal.keyframe(&self.state, state_hash(&self.state));
        // Before the receipt: who asks for the next change then is asked about bodies as they stand, not at rest.
        self.nets.begin();
        self.ports.rewind();
        self.ports
            .hand_over_nets(&self.scene, &self.state, self.state.tick, &mut self.nets);
        let _ = self.ports.receipts.push(Receipt {
            id: swap.id,
            tick: self.state.tick + 1,
        });
        // Dropped where time does not matter.
        let _ = self.ports.retired.push(swap);
    }

    /// Puts off the steps that the next tick would wait for: the stall of a late worker must not be that
    /// of the hand.
    fn put_off_late_steps(&mut self) {
        while let Some(body) = late_step(&self.scene, &self.state, &mut self.scratch) {
            self.ports.counters.late_steps.count(body);
            self.apply(Command::PutOff { body });
        }
    }

    fn tick(&mut self, wake: Wake) {
        if self.settings.clock == Clock::Realtime {
            self.put_off_late_steps();
        }
        let mut laps = Laps::start(self.clock);
        let Self {
            scene,
            state,
            scratch,
            ports,
            nets,
            journal,
            record,
            ..
        } = self;
        for tool in 0..scene.tool_count() {
            record.input.poses[tool] = ports.latch(tool);
        }
        record.input.skipped = wake.skipped;
        laps.end(Stage::Latch);
        let waited_ns = |(_, at_ns): (usize, u64)| laps.since_ns.saturating_sub(at_ns);
        record.wait_ns = ports.arrivals().map(waited_ns).max();
        render(scene, state, scratch, &record.input, &mut record.output);
        ports.publish(&record.output);
        laps.end(Stage::Render);
        deform(scene, state, scratch, &mut record.output);
        laps.end(Stage::Deform);
        hash(state, &mut record.output);
        laps.end(Stage::Hash);
        (record.late_ns, record.shift_ns) = (wake.late_ns, wake.shift_ns);
        record.stage_ns = laps.times;
        record.stage_ns[Stage::Emit] = self.emit_ns;
        nets.begin();
        journal.tick(scene, state, record, nets);
        ports.done(scene, state, record, nets);
        laps.end(Stage::Emit);
        self.emit_ns = laps.times[Stage::Emit];
        self.count();
        if self.settings.clock == Clock::Realtime {
            self.watch(wake, &laps.times);
        }
    }

    /// Counts an overrun; changes the quality of the next tick when there are too many, or none any
    /// more.
    fn watch(&mut self, wake: Wake, stage_ns: &StageTimes) {
        let verdict = self.overload.tick(wake.late_ns, wake.skipped, stage_ns);
        if let Some(overrun) = verdict.overrun {
            let overruns = &self.ports.counters.overruns[overrun.cause];
            overruns.count.fetch_add(1, Ordering::Relaxed);
            overruns.worst_ns.fetch_max(overrun.ns, Ordering::Relaxed);
        }
        if let Some(change) = verdict.change {
            self.ports
                .counters
                .quality_cause
                .store(change.cause, Ordering::Relaxed);
            self.apply(Command::Quality(change.level));
        }
    }

    fn count(&mut self) {
        let Self { report, record, .. } = self;
        report.ticks += 1;
        report.late += u64::from(record.late_ns > LATE_NS);
        report.skipped += u64::from(record.input.skipped);
        report.lateness.add(record.late_ns);
        report.stages.add(&record.stage_ns);
    }
}

/// Times the stages of a tick as they end, one after the other.
struct Laps {
    times: StageTimes,
    ended: Option<Stage>,
    since_ns: u64,
    clock: fn() -> u64,
}

impl Laps {
    fn start(clock: fn() -> u64) -> Self {
        Self {
            times: StageTimes::default(),
            ended: None,
            since_ns: clock(),
            clock,
        }
    }

    fn end(&mut self, stage: Stage) {
        debug_assert_eq!(
            stage as usize,
            self.ended.map_or(0, |last| last as usize + 1),
            "stages out of order"
        );
        let now_ns = (self.clock)();
        self.times[stage] = (now_ns - self.since_ns).min(u64::from(u32::MAX)) as u32;
        (self.ended, self.since_ns) = (Some(stage), now_ns);
    }
}
