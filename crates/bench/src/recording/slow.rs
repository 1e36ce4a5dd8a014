//! A recorder killed at any moment while the disk takes seconds for each sync.

use super::session::{RIGID, Simulated};
use super::{Bar, Effort, Figure, Files, figure};
use crate::processes::spawn_below;
use palpate_drive::journal::Journal;
use palpate_drive::nets::NetPool;
use palpate_drive::pacer::{now_ns, sleep_until};
use palpate_record::{Disk, DiskFile, DiskSync, DiskTask, FileSystem, RecorderSettings, recover};
use std::collections::VecDeque;
use std::io::{self, BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// What a sync takes, s.
const SYNCS_S: [f64; 3] = [0.0, 1.0, 4.0];
/// Kills of each, and between which times after the start.
const FULL: u64 = 20;
const QUICK: u64 = 2;
const SPAN_MS: [u64; 2] = [5_000, 9_000];

/// The recorder that is killed.
#[derive(clap::Args, Debug)]
pub struct RecorderOptions {
    /// File to record to.
    path: PathBuf,
    /// What a sync takes at least, s.
    #[arg(long)]
    sync_s: f64,
}

struct Slow(Duration);

struct SlowSync {
    takes: Duration,
    /// When each task ends at the earliest.
    ends: VecDeque<Instant>,
    sync: Box<dyn DiskSync>,
}

impl Disk for Slow {
    fn create(&self, path: &Path) -> io::Result<DiskFile> {
        let DiskFile { bytes, sync } = FileSystem.create(path)?;
        let sync = Box::new(SlowSync {
            takes: self.0,
            ends: VecDeque::new(),
            sync,
        });
        Ok(DiskFile { bytes, sync })
    }
}

impl DiskSync for SlowSync {
    fn begin(&mut self, task: DiskTask) {
        let after = self
            .ends
            .back()
            .map_or(Instant::now(), |end| Instant::now().max(*end));
        self.ends.push_back(after + self.takes);
        self.sync.begin(task);
    }

    fn ended(&mut self, within: Duration) -> Option<io::Result<()>> {
        let left = self.ends.front()?.saturating_duration_since(Instant::now());
        if left > within {
            std::thread::sleep(within);
            return None;
        }
        std::thread::sleep(left);
        let ended = self.sync.ended(within - left)?;
        self.ends.pop_front();
        Some(ended)
    }
}

/// Records at 1 kHz until it is killed; says each tick that is done, and the records lost so far.
///
/// # Errors
/// The file cannot be made, or nobody listens any more.
pub fn record_until_killed(options: &RecorderOptions) -> anyhow::Result<()> {
    let mut simulated = Simulated::new(RIGID, |_| {})?;
    let disk = Arc::new(Slow(Duration::from_secs_f64(options.sync_s)));
    let (recorder, mut port) = simulated.recorder(|settings| RecorderSettings {
        disk,
        ..settings.to(&options.path)
    })?;
    let gauges = recorder.gauges();
    let mut nets = NetPool::new(&simulated.scene, port.nets_held());
    let (mut next, mut out) = (now_ns(), io::stdout().lock());
    loop {
        next = (next + 1_000_000).max(now_ns());
        sleep_until(next);
        let record = simulated.tick();
        nets.begin();
        port.tick(&simulated.scene, &simulated.state, &record, &mut nets);
        let dropped = gauges.dropped.load(Ordering::Relaxed);
        writeln!(out, "{} {dropped}", record.output.tick)?;
    }
}

pub(super) fn run(effort: Effort, out: &mut dyn FnMut(Figure)) -> anyhow::Result<()> {
    let kills = if effort == Effort::Quick { QUICK } else { FULL };
    let files = Files::new("slow")?;
    let mut random = 20_261_127_u64;
    for sync_s in SYNCS_S {
        let (mut worst, mut dropped) = (0, 0);
        for k in 0..kills {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let after = SPAN_MS[0] + (random >> 33) % (SPAN_MS[1] - SPAN_MS[0]);
            let file = files.path(&format!("{sync_s}-{k}.mcap"));
            let (missing, lost) = kill(&file, sync_s, Duration::from_millis(after))?;
            worst = worst.max(missing);
            dropped += lost;
        }
        let case = format!("kill/sync of {sync_s} s");
        let note = format!("worst of {kills} kills at random moments, syncs of {sync_s} s");
        out(figure(
            &case,
            "ticks lost",
            worst as f64,
            "ms",
            Some(Bar::AtMost(250.0)),
            note,
        ));
        let note = "by the recorder while it ran, in all of them".into();
        out(figure(
            &case,
            "records dropped",
            dropped as f64,
            "1",
            Some(Bar::AtMost(0.0)),
            note,
        ));
    }
    Ok(())
}

/// Ticks that the file lacks of those that were done, and records that were dropped before.
fn kill(file: &Path, sync_s: f64, after: Duration) -> anyhow::Result<(u64, u64)> {
    let mut command = Command::new(std::env::current_exe()?);
    command
        .arg("recorder")
        .arg(file)
        .args(["--sync-s", &sync_s.to_string()])
        .stdin(Stdio::null())
        .stdout(Stdio::piped());
    let mut child = spawn_below(&mut command)?;
    let said = child.stdout.take();
    let last = std::thread::spawn(move || {
        let lines = said
            .into_iter()
            .flat_map(|said| BufReader::new(said).lines());
        lines.map_while(Result::ok).last()
    });
    std::thread::sleep(after);
    child.kill()?;
    child.wait()?;
    let last = last.join().ok().flatten();
    let numbers = last.as_deref().and_then(|line| line.split_once(' '));
    let (done, dropped) = numbers.ok_or_else(|| anyhow::anyhow!("the recorder said nothing"))?;
    let part = format!("{}.part", file.display());
    let recovered = recover(Path::new(&part), file)?;
    std::fs::remove_file(file)?;
    std::fs::remove_file(part)?;
    let missing = done.parse::<u64>()?.saturating_sub(recovered.last_tick);
    Ok((missing, dropped.parse()?))
}
