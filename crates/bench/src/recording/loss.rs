//! What is lost while the disk stands still for a second, again and again.

use super::session::{FOUR_HANDS, Simulated};
use super::{Bar, Effort, Figure, Files, figure};
use palpate_drive::journal::Journal;
use palpate_drive::nets::NetPool;
use palpate_drive::pacer::{now_ns, sleep_until};
use palpate_record::{Disk, DiskFile, FileSystem, RecorderSettings};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time between two stalls.
const EVERY: Duration = Duration::from_secs(5);
const STALL: Duration = Duration::from_secs(1);

#[derive(Clone, Default)]
struct Stalling(Arc<AtomicU64>);

struct StallingFile {
    file: Box<dyn Write + Send>,
    stalls: Arc<AtomicU64>,
    last: Instant,
}

impl Disk for Stalling {
    fn create(&self, path: &Path) -> io::Result<DiskFile> {
        let DiskFile { bytes, sync } = FileSystem.create(path)?;
        let bytes = Box::new(StallingFile {
            file: bytes,
            stalls: self.0.clone(),
            last: Instant::now(),
        });
        Ok(DiskFile { bytes, sync })
    }
}

impl Write for StallingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.last.elapsed() >= EVERY {
            std::thread::sleep(STALL);
            self.stalls.fetch_add(1, Ordering::Relaxed);
            self.last = Instant::now();
        }
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

pub(super) fn run(effort: Effort, out: &mut dyn FnMut(Figure)) -> anyhow::Result<()> {
    let seconds = if effort == Effort::Quick { 15 } else { 600 };
    let files = Files::new("loss")?;
    let path = files.path("stalled.mcap");
    let mut simulated = Simulated::new(FOUR_HANDS, |_| {})?;
    let disk = Stalling::default();
    let stalls = disk.0.clone();
    let (recorder, mut port) = simulated.recorder(|settings| RecorderSettings {
        disk: Arc::new(disk),
        ..settings.to(&path)
    })?;
    let mut nets = NetPool::new(&simulated.scene, port.nets_held());
    let (mut next, mut late) = (now_ns(), 0_u64);
    for _ in 0..seconds * 1_000 {
        next += 1_000_000;
        late += u64::from(now_ns() > next);
        sleep_until(next);
        let record = simulated.tick();
        nets.begin();
        port.tick(&simulated.scene, &simulated.state, &record, &mut nets);
    }
    drop(port);
    let summary = recorder.finish().last()?;
    let note = format!(
        "{} ticks of four tools and three bodies, {late} of them behind time; the disk stood still {} times for 1 s",
        summary.ticks,
        stalls.load(Ordering::Relaxed)
    );
    out(figure(
        "loss/stall",
        "records lost",
        summary.dropped as f64,
        "1",
        Some(Bar::AtMost(0.0)),
        note,
    ));
    Ok(())
}
