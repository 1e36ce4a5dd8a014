//! A shadow of the running loop: it goes back to a state of a moment ago, runs the same ticks
//! again, and must come to the same hashes. What a replay would find tomorrow, this finds now.
//!
//! ```text
//! tick thread ─▶ SelfCheckPort ─▶ the journal it wraps
//!                     └─ batch: a state, N ticks of poses, commands, hashes ═ring═▶ checking thread: restore, step, compare
//! ```
//! The tick thread neither waits nor allocates: batches go round between two rings. While none is
//! free, ticks go unchecked and are counted.

use super::rerun::Rerun;
use palpate_drive::journal::Journal;
use palpate_drive::nets::NetPool;
use palpate_geometry::math::SavedState;
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::Scene;
use palpate_sim::tick::SceneState;
use palpate_sim::tick::record::{Command, TickInput, TickRecord};
use serde::Serialize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// One is filled, one is checked, one waits.
const BATCHES: usize = 3;
/// More between the ends of a batch, and it is not checked.
const MAX_COMMANDS: usize = 256;
/// Differences that are logged; more say nothing new.
const MOST_TOLD: u64 = 5;

/// Where the second run parts from the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct SelfDifference {
    /// The state after this tick was gone back to.
    pub from: u64,
    /// First tick that parts.
    pub tick: u64,
    /// Hash of the state in the loop.
    pub first: u64,
    /// Hash of the state the second time.
    pub second: u64,
}

/// What was checked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SelfCheckReport {
    /// Times it went back.
    pub checks: u64,
    /// Ticks that were run again.
    pub ticks: u64,
    /// Ticks that were not, because the shadow was behind.
    pub unchecked: u64,
    /// Times that the runs parted.
    pub differences: u64,
    /// The first of them.
    pub first_difference: Option<SelfDifference>,
}

/// A state with what followed it.
struct Batch {
    saved: SavedState,
    tick: u64,
    hash: u64,
    /// (ticks × tools).
    poses: Vec<Option<DevicePose>>,
    /// (ticks): deadlines dropped before them.
    skipped: Vec<u32>,
    /// (ticks): of the states after them.
    hashes: Vec<u64>,
    commands: Vec<(u64, Command)>,
}

#[derive(Debug, Default)]
struct CheckerShare {
    unchecked: AtomicU64,
    stop: AtomicBool,
}

/// The tick thread's side: hands everything on to the journal it wraps.
pub struct SelfCheckPort {
    inner: Box<dyn Journal>,
    every: usize,
    tools: usize,
    filling: Option<Box<Batch>>,
    free: rtrb::Consumer<Box<Batch>>,
    full: rtrb::Producer<Box<Batch>>,
    shared: Arc<CheckerShare>,
}

/// A running shadow.
pub struct SelfCheck {
    shared: Arc<CheckerShare>,
    thread: JoinHandle<SelfCheckReport>,
}

/// An empty buffer that takes in any state of a scene without growing: contact rows and grips come
/// and go.
pub(super) fn room_for_states(scene: &Scene) -> SavedState {
    SavedState::with_capacity(scene.initial_state().largest_size())
}

impl SelfCheck {
    /// Starts the checking thread. `every`: length of a check, ticks.
    ///
    /// # Errors
    /// The system refuses a thread.
    pub fn start(
        scene: &Arc<Scene>,
        every: usize,
        inner: Box<dyn Journal>,
    ) -> std::io::Result<(Self, SelfCheckPort)> {
        let every = every.max(1);
        let tools = scene.tool_count();
        let (mut free_in, free) = rtrb::RingBuffer::new(BATCHES);
        let (full, full_out) = rtrb::RingBuffer::new(BATCHES);
        for _ in 0..BATCHES {
            let batch = Batch {
                saved: room_for_states(scene),
                tick: 0,
                hash: 0,
                poses: Vec::with_capacity(every * tools),
                skipped: Vec::with_capacity(every),
                hashes: Vec::with_capacity(every),
                commands: Vec::with_capacity(MAX_COMMANDS),
            };
            let fits = free_in.push(Box::new(batch)).is_ok();
            debug_assert!(fits, "the ring has room for all");
        }
        let shared = Arc::new(CheckerShare::default());
        let port = SelfCheckPort {
            inner,
            every,
            tools,
            filling: None,
            free,
            full,
            shared: shared.clone(),
        };
        let (theirs, scene) = (shared.clone(), scene.clone());
        let thread = std::thread::Builder::new()
            .name("palpate-check".into())
            .spawn(move || check_all(&scene, full_out, free_in, &theirs))?;
        Ok((Self { shared, thread }, port))
    }

    /// Checks what is left and says what was found. Call after the tick thread has ended.
    pub fn finish(self) -> SelfCheckReport {
        self.shared.stop.store(true, Ordering::Release);
        let report = self.thread.join().unwrap_or_else(|_| {
            tracing::error!("the thread of the self-check panicked");
            SelfCheckReport {
                differences: 1,
                ..SelfCheckReport::default()
            }
        });
        SelfCheckReport {
            unchecked: self.shared.unchecked.load(Ordering::Relaxed),
            ..report
        }
    }
}

impl SelfCheckPort {
    fn begin(&mut self, state: &SceneState, hash: u64) {
        let Ok(mut batch) = self.free.pop() else {
            return;
        };
        batch.saved.save_from(state);
        (batch.tick, batch.hash) = (state.tick, hash);
        batch.poses.clear();
        batch.skipped.clear();
        batch.hashes.clear();
        batch.commands.clear();
        self.filling = Some(batch);
    }
}

impl Journal for SelfCheckPort {
    fn tick(&mut self, scene: &Scene, state: &SceneState, record: &TickRecord, nets: &mut NetPool) {
        self.inner.tick(scene, state, record, nets);
        match &mut self.filling {
            None => drop(self.shared.unchecked.fetch_add(1, Ordering::Relaxed)),
            Some(batch) => {
                batch.poses.extend(record.input.poses.first(self.tools));
                batch.skipped.push(record.input.skipped);
                batch.hashes.push(record.output.state_hash);
                if batch.hashes.len() == self.every
                    && let Some(batch) = self.filling.take()
                {
                    let _ = self.full.push(batch);
                }
            }
        }
        if self.filling.is_none() {
            self.begin(state, record.output.state_hash);
        }
    }

    fn command(&mut self, after_tick: u64, command: Command) {
        self.inner.command(after_tick, command);
        if let Some(batch) = &mut self.filling {
            if batch.commands.len() < MAX_COMMANDS {
                batch.commands.push((after_tick, command));
            } else if let Some(batch) = self.filling.take() {
                // Too many to keep: these ticks are not checked, and the empty batch goes the
                // round.
                self.shared
                    .unchecked
                    .fetch_add(batch.hashes.len() as u64, Ordering::Relaxed);
                self.give_back(batch);
            }
        }
    }

    fn keyframe(&mut self, state: &SceneState, state_hash: u64) {
        self.inner.keyframe(state, state_hash);
        if self.filling.is_none() {
            self.begin(state, state_hash);
        }
    }

    fn nets_held(&self) -> usize {
        self.inner.nets_held()
    }
}

impl SelfCheckPort {
    fn give_back(&mut self, mut batch: Box<Batch>) {
        batch.hashes.clear();
        batch.poses.clear();
        batch.skipped.clear();
        batch.commands.clear();
        let _ = self.full.push(batch);
    }
}

impl Drop for SelfCheckPort {
    /// The ticks since the last whole batch are checked as well.
    fn drop(&mut self) {
        if let Some(batch) = self.filling.take() {
            let _ = self.full.push(batch);
        }
    }
}

fn check_all(
    scene: &Arc<Scene>,
    mut full: rtrb::Consumer<Box<Batch>>,
    mut free: rtrb::Producer<Box<Batch>>,
    shared: &CheckerShare,
) -> SelfCheckReport {
    let mut rerun = Rerun::new(scene);
    let mut report = SelfCheckReport::default();
    loop {
        let stop = shared.stop.load(Ordering::Acquire);
        while let Ok(batch) = full.pop() {
            report.checks += u64::from(!batch.hashes.is_empty());
            report.ticks += batch.hashes.len() as u64;
            if let Some(difference) = check(&mut rerun, &batch) {
                report.differences += 1;
                report.first_difference.get_or_insert(difference);
                if report.differences <= MOST_TOLD {
                    let SelfDifference {
                        from,
                        tick,
                        first,
                        second,
                    } = difference;
                    tracing::error!(
                        from, tick, first = %format_args!("{first:016x}"), second = %format_args!("{second:016x}"),
                        "self-check: re-running the same inputs gave a different state"
                    );
                }
            }
            let _ = free.push(batch);
        }
        if stop {
            return report;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn check(rerun: &mut Rerun, batch: &Batch) -> Option<SelfDifference> {
    if batch.hashes.is_empty() {
        return None;
    }
    let parted = |tick, first, second| {
        Some(SelfDifference {
            from: batch.tick,
            tick,
            first,
            second,
        })
    };
    // A state that the scene does not take back has no hash.
    let hash = rerun.seat(&batch.saved).unwrap_or(0);
    if hash != batch.hash {
        return parted(batch.tick, batch.hash, hash);
    }
    let tools = rerun.scene().tool_count();
    let mut commands = &batch.commands[..];
    for (k, &hash) in batch.hashes.iter().enumerate() {
        let tick = batch.tick + 1 + k as u64;
        while let Some(((_, command), rest)) = commands
            .split_first()
            .filter(|((after, _), _)| *after < tick)
        {
            rerun.command(*command);
            commands = rest;
        }
        let mut input = TickInput {
            skipped: batch.skipped[k],
            ..TickInput::default()
        };
        input.poses.set(&batch.poses[k * tools..(k + 1) * tools]);
        let output = rerun.tick(&input);
        if output.state_hash != hash {
            return parted(tick, hash, output.state_hash);
        }
    }
    None
}
