//! A daemon killed at any moment: what its recording holds.

use super::processes::{Process, connect, free_port};
use super::session::TEARDROP;
use super::{Bar, Effort, Figure, Files, figure};
use palpate_client::pose_at;
use palpate_record::{Session, recover, replay};
use std::time::{Duration, Instant};

/// Kills, and between which times after the first force.
const FULL: usize = 100;
const QUICK: usize = 5;
const SPAN_MS: [u64; 2] = [50, 1_500];

/// What one kill left.
struct Left {
    /// Ticks that the file lacks of what had been seen.
    missing: u64,
    /// The recovered file is whole, and what it holds replays.
    sound: bool,
}

pub(super) fn run(effort: Effort, out: &mut dyn FnMut(Figure)) -> anyhow::Result<()> {
    let kills = if effort == Effort::Quick { QUICK } else { FULL };
    let files = Files::new("kill")?;
    let scene = files.write("scene.toml", TEARDROP)?;
    let (mut worst, mut sound, mut random) = (0, 0, 20_261_121_u64);
    for k in 0..kills {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let after = Duration::from_millis(SPAN_MS[0] + (random >> 33) % (SPAN_MS[1] - SPAN_MS[0]));
        let left = kill(&files, &scene, k, after)?;
        worst = worst.max(left.missing);
        sound += usize::from(left.sound);
    }
    let note = format!("worst of {kills} kills at random moments");
    out(figure(
        "kill/daemon",
        "ticks lost",
        worst as f64,
        "ms",
        Some(Bar::AtMost(250.0)),
        note,
    ));
    let note = format!(
        "of {kills} files: opened by the mcap library as they were, recovered, complete up to their end, replayed bit for bit"
    );
    out(figure(
        "kill/daemon",
        "files sound",
        sound as f64,
        "1",
        Some(Bar::AtLeast(kills as f64)),
        note,
    ));
    Ok(())
}

fn kill(files: &Files, scene: &str, k: usize, after: Duration) -> anyhow::Result<Left> {
    let endpoint = format!("tcp/127.0.0.1:{}", free_port()?);
    let file = files.path(&format!("{k}.mcap"));
    let path = file.to_string_lossy().into_owned();
    let daemon = Process::start(&[
        "serve", scene, "--listen", &endpoint, "--record", &path, "--no-rt",
    ])?;
    let palpate = connect(&endpoint)?;
    let mut tool = palpate.tool("ball")?;
    let started = Instant::now();
    let mut touched: Option<Instant> = None;
    while touched.is_none_or(|first| first.elapsed() < after) {
        let t = started.elapsed().as_secs_f64();
        tool.send(pose_at([0.05 - 0.015 * (4.0 * t).sin(), 0.003, 0.045]))?;
        if tool.force().is_some() {
            touched.get_or_insert_with(Instant::now);
        }
        anyhow::ensure!(
            started.elapsed() < Duration::from_secs(30),
            "the daemon gives no force"
        );
        std::thread::sleep(Duration::from_millis(1));
    }
    daemon.kill();
    let seen = tool.force().map_or(0, |force| force.tick);
    drop(tool);
    palpate.close();
    let part = files.path(&format!("{k}.mcap.part"));
    let bytes = std::fs::read(&part)?;
    // As any reader of streams takes it: message by message, until it ends.
    let options = mcap::read::Options::IgnoreEndMagic.into();
    let read = mcap::MessageStream::new_with_options(&bytes, options)?.map_while(Result::ok);
    let ticks = read
        .filter(|message| message.channel.topic == "/sim/tick")
        .count() as u64;
    let recovered = recover(&part, &file)?;
    let session = Session::open(&file)?;
    let report = replay(&session, 0, |_, _| {})?;
    let sound = ticks == recovered.ticks
        && session.gaps() == 0
        && report.first_difference.is_none()
        && report.ticks_matched == recovered.ticks;
    std::fs::remove_file(&file)?;
    std::fs::remove_file(&part)?;
    Ok(Left {
        missing: seen.saturating_sub(recovered.last_tick),
        sound,
    })
}
