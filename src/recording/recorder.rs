//! The recorder: a port for the tick thread, bounded rings, and a thread that writes.
//!
//! The tick thread never waits and never allocates here: what does not fit is counted and lost, and the file says so.

use super::writer::{BodyHead, Head, WriteError, Writer};
use crate::math::{Point3, SavedState};
use crate::scene::spec::SceneSpec;
use crate::scene::{Scene, SceneState, quality};
use crate::tick::journal::{Journal, JournalGauges};
use crate::tick::record::{Command, STAGE_COUNT, Stage, TickRecord};
use crate::tick::stats::Histogram;
use palpate_proto::recording as pb;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Ticks the ring holds: four seconds at 1 kHz, more than a disk stalls.
const RING_TICKS: usize = 4_096;
/// Keyframe buffers: one is filled while others are written.
const KEYFRAME_BUFFERS: usize = 6;
/// Net buffers a body.
const NET_BUFFERS: usize = 64;

/// What to record.
#[derive(Clone, Debug)]
pub struct RecorderSettings {
    /// Final name of the file.
    pub path: PathBuf,
    /// Scene file as the user wrote it.
    pub scene_text: String,
    /// Scene with its surfaces written out.
    pub effective: SceneSpec,
}

#[derive(Debug, Default)]
struct RecorderProgress {
    /// Message bytes written, and records lost because a ring was full or the disk failed.
    gauges: Arc<JournalGauges>,
    failed: AtomicBool,
    stop: AtomicBool,
}

/// What was recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordingSummary {
    /// File.
    pub path: PathBuf,
    /// Ticks in it.
    pub ticks: u64,
    /// Hash of the last state.
    pub final_hash: u64,
    /// Hash of all ticks.
    pub session_hash: u64,
    /// Records lost.
    pub dropped: u64,
    /// Message bytes.
    pub bytes: u64,
}

struct KeyframeBuffer {
    tick: u64,
    hash: u64,
    /// Commands after `tick` that the state holds already.
    commands: u32,
    saved: SavedState,
}

struct NetBuffer {
    tick: u64,
    revision: u64,
    body: usize,
    points: Vec<Point3>,
}

/// A command with the tick after which it acts.
type Applied = (u64, Command);

/// Buffers that travel full one way and empty back.
struct Pool<T> {
    free: rtrb::Consumer<Box<T>>,
    full: rtrb::Producer<Box<T>>,
}

struct PoolEnd<T> {
    free: rtrb::Producer<Box<T>>,
    full: rtrb::Consumer<Box<T>>,
}

fn pool<T>(buffers: impl ExactSizeIterator<Item = T>) -> (Pool<T>, PoolEnd<T>) {
    let count = buffers.len().max(1);
    let (mut free_in, free_out) = rtrb::RingBuffer::new(count);
    let (full_in, full_out) = rtrb::RingBuffer::new(count);
    for buffer in buffers {
        let fits = free_in.push(Box::new(buffer)).is_ok();
        debug_assert!(fits, "the ring has room for all");
    }
    (Pool { free: free_out, full: full_in }, PoolEnd { free: free_in, full: full_out })
}

/// The tick thread's side.
pub struct RecorderPort {
    ticks: rtrb::Producer<TickRecord>,
    commands: rtrb::Producer<Applied>,
    keyframes: Pool<KeyframeBuffer>,
    nets: Vec<Pool<NetBuffer>>,
    progress: Arc<RecorderProgress>,
    keyframe_every: u64,
    net_every: u64,
    /// By body: revision and tick of the last net sent.
    sent: Vec<(u64, u64)>,
    /// Tick after which the last commands acted, and how many.
    commanded: (u64, u32),
}

impl RecorderPort {
    fn lost(&self) {
        self.progress.gauges.dropped.fetch_add(1, Ordering::Relaxed);
    }
}

impl Journal for RecorderPort {
    fn tick(&mut self, scene: &Scene, state: &SceneState, record: &TickRecord) {
        if self.ticks.push(*record).is_err() {
            self.lost();
        }
        let tick = record.output.tick;
        let net_every = self.net_every * if state.quality < quality::RARE_NETS { 1 } else { 10 };
        for body in 0..self.nets.len() {
            let (revision, at) = self.sent[body];
            if state.net_revision(body) == revision || tick < at + net_every {
                continue;
            }
            let Ok(mut buffer) = self.nets[body].free.pop() else { continue };
            state.copy_net(scene, body, &mut buffer.points);
            (buffer.tick, buffer.revision) = (tick, state.net_revision(body));
            self.sent[body] = (buffer.revision, tick);
            let _ = self.nets[body].full.push(buffer);
        }
        if tick.is_multiple_of(self.keyframe_every) {
            self.keyframe(state, record.output.state_hash);
        }
    }

    fn command(&mut self, after_tick: u64, command: Command) {
        if self.commands.push((after_tick, command)).is_err() {
            self.lost();
            return;
        }
        let before = if self.commanded.0 == after_tick { self.commanded.1 } else { 0 };
        self.commanded = (after_tick, before + 1);
    }

    fn keyframe(&mut self, state: &SceneState, state_hash: u64) {
        // Without a free buffer the next keyframe will do: a replay starts from any of them.
        let Ok(mut buffer) = self.keyframes.free.pop() else {
            if state.tick == 0 {
                self.lost();
            }
            return;
        };
        (buffer.tick, buffer.hash) = (state.tick, state_hash);
        buffer.commands = if self.commanded.0 == state.tick { self.commanded.1 } else { 0 };
        buffer.saved.save_from(state);
        let _ = self.keyframes.full.push(buffer);
    }
}

/// A running recorder.
pub struct Recorder {
    progress: Arc<RecorderProgress>,
    thread: JoinHandle<Result<RecordingSummary, WriteError>>,
}

struct Inbox {
    ticks: rtrb::Consumer<TickRecord>,
    commands: rtrb::Consumer<Applied>,
    keyframes: PoolEnd<KeyframeBuffer>,
    nets: Vec<PoolEnd<NetBuffer>>,
}

impl Recorder {
    /// Creates the file and starts the thread.
    ///
    /// # Errors
    /// A file that cannot be created, a disk that is full, or a scene without a text form.
    pub fn start(settings: RecorderSettings, scene: &Scene) -> Result<(Self, RecorderPort), WriteError> {
        let effective_scene = toml::to_string(&settings.effective)
            .map_err(|e| WriteError::Scene { path: settings.path.clone(), reason: e.to_string() })?;
        let bodies = (0..scene.body_count()).map(|body| {
            let surface = scene.rest_surface(body);
            BodyHead {
                id: scene.body_id(body).to_owned(),
                degree: [surface.knots_u().degree(), surface.knots_v().degree()],
                count: [surface.net().rows(), surface.net().columns()],
            }
        });
        let head = Head {
            scene: scene.name.clone(),
            scene_text: settings.scene_text,
            effective_scene,
            dt_ns: (scene.dt_s * 1e9).round() as u64,
            tools: (0..scene.tool_count()).map(|tool| scene.tool_id(tool).to_owned()).collect(),
            bodies: bodies.collect(),
            extra: Default::default(),
        };
        let writer = Writer::create(&settings.path, head)?;
        let (ticks, ticks_out) = rtrb::RingBuffer::new(RING_TICKS);
        let (commands, commands_out) = rtrb::RingBuffer::new(256);
        let mut sample = SavedState::default();
        sample.save_from(&scene.initial_state());
        // Contact rows come and go: leave room for all of them.
        let buffers = (0..KEYFRAME_BUFFERS).map(|_| {
            let words = Vec::with_capacity(sample.words.len() + 4 * crate::contact::rows::MAX_ROWS);
            let floats = Vec::with_capacity(sample.floats.len() + 2 * crate::contact::rows::MAX_ROWS);
            KeyframeBuffer { tick: 0, hash: 0, commands: 0, saved: SavedState { words, floats } }
        });
        let (keyframes, keyframes_end) = pool(buffers);
        let (nets, net_ends) = (0..scene.body_count())
            .map(|body| {
                let points = scene.rest_surface(body).net().points().to_vec();
                let count = if scene.deforms(body) { NET_BUFFERS } else { 0 };
                pool((0..count).map(move |_| NetBuffer { tick: 0, revision: 0, body, points: points.clone() }))
            })
            .unzip();
        let progress = Arc::new(RecorderProgress::default());
        let rate = 1.0 / scene.dt_s;
        let port = RecorderPort {
            ticks,
            commands,
            keyframes,
            nets,
            progress: progress.clone(),
            keyframe_every: ((settings.effective.record.keyframe_s * rate).round() as u64).max(1),
            net_every: ((rate / settings.effective.record.net_hz).round() as u64).max(1),
            sent: vec![(0, 0); scene.body_count()],
            commanded: (0, 0),
        };
        let inbox = Inbox { ticks: ticks_out, commands: commands_out, keyframes: keyframes_end, nets: net_ends };
        let shared = progress.clone();
        let thread = std::thread::Builder::new()
            .name("palpate-recorder".into())
            .spawn(move || run(writer, inbox, &shared))
            .map_err(|source| WriteError::Io { path: settings.path, source })?;
        Ok((Self { progress, thread }, port))
    }

    /// Bytes and losses, live.
    pub fn gauges(&self) -> Arc<JournalGauges> {
        self.progress.gauges.clone()
    }

    /// True once the disk refused.
    pub fn failed(&self) -> bool {
        self.progress.failed.load(Ordering::Relaxed)
    }

    /// Writes what is left, ends the file and gives it its name. Call after the tick thread has ended.
    ///
    /// # Errors
    /// The disk refused; what was flushed stays readable in the `.part` file.
    pub fn finish(self) -> Result<RecordingSummary, WriteError> {
        self.progress.stop.store(true, Ordering::Release);
        self.thread.join().unwrap_or_else(|_| {
            Err(WriteError::Io { path: PathBuf::new(), source: std::io::Error::other("the recorder thread panicked") })
        })
    }
}

fn run(mut writer: Writer, mut inbox: Inbox, progress: &RecorderProgress) -> Result<RecordingSummary, WriteError> {
    let mut stages: Vec<Histogram> = (0..=STAGE_COUNT).map(|_| Histogram::default()).collect();
    let mut late = 0;
    let mut failure = None;
    loop {
        let stop = progress.stop.load(Ordering::Acquire);
        let worked = drain(&mut writer, &mut inbox, progress, &mut stages, &mut late);
        let flushed = worked.and_then(|()| writer.flush_if_due());
        progress.gauges.bytes.store(writer.bytes, Ordering::Relaxed);
        if let Err(error) = flushed {
            // The loop goes on without us; what was flushed stays readable.
            tracing::error!(%error, "recording failed");
            progress.failed.store(true, Ordering::Relaxed);
            failure = Some(error);
            break;
        }
        if stop {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    if let Some(error) = failure {
        while !progress.stop.load(Ordering::Acquire) {
            discard(&mut inbox, progress);
            std::thread::sleep(Duration::from_millis(5));
        }
        return Err(error);
    }
    let dropped = progress.gauges.dropped.load(Ordering::Relaxed);
    writer.stats(&stats(&writer, &stages, late, dropped))?;
    let (ticks, final_hash, session_hash, bytes) = (writer.ticks, writer.last_hash, writer.session.0, writer.bytes);
    let path = writer.finish(dropped, true)?;
    Ok(RecordingSummary { path, ticks, final_hash, session_hash, dropped, bytes })
}

fn discard(inbox: &mut Inbox, progress: &RecorderProgress) {
    while inbox.ticks.pop().is_ok() {
        progress.gauges.dropped.fetch_add(1, Ordering::Relaxed);
    }
    while inbox.commands.pop().is_ok() {
        progress.gauges.dropped.fetch_add(1, Ordering::Relaxed);
    }
}

fn drain(
    writer: &mut Writer,
    inbox: &mut Inbox,
    progress: &RecorderProgress,
    stages: &mut [Histogram],
    late: &mut u64,
) -> Result<(), WriteError> {
    // A tick is written after every command before it: of what arrives meanwhile, commands may come, ticks wait.
    let ticks = inbox.ticks.slots();
    while let Ok(buffer) = inbox.keyframes.full.pop() {
        let done = writer.keyframe(buffer.tick, buffer.hash, buffer.commands, &buffer.saved);
        let _ = inbox.keyframes.free.push(buffer);
        done?;
    }
    while let Ok((after_tick, command)) = inbox.commands.pop() {
        writer.command(after_tick, command)?;
    }
    for _ in 0..ticks {
        let Ok(record) = inbox.ticks.pop() else { break };
        writer.tick(&record)?;
        let mut whole = 0;
        for (histogram, ns) in stages.iter_mut().zip(record.stage_ns) {
            histogram.add(u64::from(ns));
            whole += u64::from(ns);
        }
        stages[STAGE_COUNT].add(whole);
        *late += u64::from(record.late_ns > crate::tick::stats::LATE_NS);
        if record.output.fault.is_some() {
            writer.event(record.output.tick, "fault", "a state was not finite; the body was set back to rest")?;
        }
        if record.output.tick.is_multiple_of(100) {
            let dropped = progress.gauges.dropped.load(Ordering::Relaxed);
            writer.stats(&stats(writer, stages, *late, dropped))?;
        }
    }
    for net in &mut inbox.nets {
        while let Ok(buffer) = net.full.pop() {
            let done = writer.net(buffer.tick, buffer.revision, buffer.body, &buffer.points);
            let _ = net.free.push(buffer);
            done?;
        }
    }
    Ok(())
}

fn stats(writer: &Writer, stages: &[Histogram], late_ticks: u64, dropped_records: u64) -> pb::Stats {
    debug_assert_eq!(stages.len(), Stage::Emit as usize + 2, "stages and the whole tick");
    pb::Stats {
        tick: writer.last_tick,
        late_ticks,
        skipped_ticks: writer.skipped,
        stage_ns: stages.iter().flat_map(|h| [h.quantile(0.5), h.quantile(0.99), h.max()]).collect(),
        dropped_records,
    }
}

/// Where a recording goes when nobody said.
pub fn default_path(directory: &Path, stem: &str) -> PathBuf {
    let seconds = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0, |t| t.as_secs());
    directory.join(format!("{stem}-{seconds}.mcap"))
}
