//! Four devices in four processes hold contact with rigid and soft bodies for ten minutes: nothing
//! drifts, nothing grows.
//!
//! In lockstep: ten minutes of the devices' time, whatever else the machine does.

use super::processes::{Files, Process, connect, free_port};
use super::{Bar, Figure};
use crate::Effort;
use std::time::{Duration, Instant};

const SCENE: &str = include_str!("../../../../scenes/four-hands.toml");

/// Tool, device, hand, from where, to where it presses.
type Part = (&'static str, &'static str, &'static str, [f64; 3], [f64; 3]);

/// Devices with much dry friction come to rest anywhere within it, and their tremor brings them on
/// for minutes: the falcon is held fast by its own, the others have little or none.
const PARTS: [Part; 4] = [
    (
        "tip",
        "touch-x",
        "relaxed",
        [0.3, 0.0, 0.06],
        [0.302, 0.001, 0.037],
    ),
    (
        "ring",
        "ideal",
        "firm",
        [0.38, 0.0, 0.0],
        [0.3585, 0.001, 0.002],
    ),
    (
        "ball",
        "ideal",
        "relaxed",
        [0.06, 0.003, 0.045],
        [0.026, 0.003, 0.045],
    ),
    (
        "plate",
        "falcon",
        "relaxed",
        [0.06, 0.2, 0.045],
        [0.0135, 0.2, 0.045],
    ),
];
/// Until everything presses.
const SETTLE_S: f64 = 5.0;

/// Means over a part of the time.
#[derive(Clone, Copy, Default)]
struct Moments {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        self.sum += value;
        self.squares += value * value;
    }

    fn mean(&self) -> f64 {
        self.sum / self.count.max(1.0)
    }

    fn deviation(&self) -> f64 {
        (self.squares / self.count.max(1.0) - self.mean() * self.mean())
            .max(0.0)
            .sqrt()
    }
}

pub(super) fn run(effort: Effort, out: &mut dyn FnMut(Figure), failed: &mut Vec<String>) {
    let seconds = if effort == Effort::Quick { 30.0 } else { 600.0 };
    match hold(seconds) {
        Ok(figures) => figures.into_iter().for_each(out),
        Err(error) => failed.push(format!("soak: {error:#}")),
    }
}

fn hold(seconds: f64) -> anyhow::Result<Vec<Figure>> {
    let files = Files::new("soak")?;
    let scene = files.write("four-hands.toml", SCENE)?;
    let endpoint = format!("tcp/127.0.0.1:{}", free_port()?);
    let daemon = Process::start(&[
        "serve", &scene, "--clock", "lockstep", "--listen", &endpoint,
    ])?;
    let palpate = connect(&endpoint)?;
    let mut devices = Vec::new();
    for (k, (tool, device, hand, from, to)) in PARTS.iter().enumerate() {
        let waypoint =
            |t: f64, p: &[f64; 3]| format!("[[waypoint]]\ntime_s = {t:?}\nposition = {p:?}\n");
        let motion = files.write(
            &format!("{tool}.toml"),
            &(waypoint(0.0, from) + &waypoint(3.0, to)),
        )?;
        let (seed, length) = ((k + 1).to_string(), format!("{}s", seconds + 30.0));
        devices.push(Process::start(&[
            "device",
            "--tool",
            tool,
            "--device",
            device,
            "--hand",
            hand,
            "--motion",
            &motion,
            "--tremor",
            "2e-4",
            "--seed",
            &seed,
            "--for",
            &length,
            "--connect",
            &endpoint,
        ])?);
    }
    let watched = PARTS
        .iter()
        .map(|part| palpate.forces(part.0))
        .collect::<Result<Vec<_>, _>>()?;
    let mut tenths = [[Moments::default(); 10]; PARTS.len()];
    let mut least_j = [0.0f64; PARTS.len()];
    let mut told = [0; PARTS.len()];
    let statuses = palpate.statuses()?;
    let (mut ticks, mut moved) = (0, Instant::now());
    while (ticks as f64) < (SETTLE_S + seconds) * 1e3 {
        std::thread::sleep(Duration::from_millis(3));
        for (tool, forces) in watched.iter().enumerate() {
            let newest = forces.newest();
            let is_new = std::mem::replace(&mut told[tool], newest.received) != newest.received;
            let Some(force) = newest.force.filter(|_| is_new) else {
                continue;
            };
            (ticks, moved) = (force.tick.max(ticks), Instant::now());
            let share = (force.tick as f64 * 1e-3 - SETTLE_S) / seconds;
            if (0.0..1.0).contains(&share) {
                let size = force.force.iter().map(|f| f * f).sum::<f64>().sqrt();
                tenths[tool][(share * 10.0) as usize].add(size);
            }
        }
        anyhow::ensure!(
            moved.elapsed() < Duration::from_secs(20),
            "no tick since tick {ticks}"
        );
        if let Some(status) = statuses.take() {
            for (least, link) in least_j.iter_mut().zip(&status.tools) {
                *least = least.min(link.energy_j);
            }
        }
    }
    let status = palpate.status()?;
    drop((devices, watched, statuses));
    palpate.close();
    drop(daemon);
    anyhow::ensure!(
        (tenths.iter()).all(|part| part[0].count > 0.0 && part[9].count > 0.0),
        "a tool told no forces"
    );
    let mut figures = Vec::new();
    for (k, part) in PARTS.iter().enumerate() {
        let (first, last) = (&tenths[k][0], &tenths[k][9]);
        let made = status
            .tools
            .iter()
            .position(|link| link.tool == part.0)
            .map_or(0.0, |at| least_j[at]);
        let figure = |case: &str, value, reference, reference_is, bar, note| Figure {
            suite: "haptics",
            case: case.to_owned(),
            method: format!("{} on {}", part.0, part.1),
            value,
            unit: "1",
            reference,
            reference_is,
            bar: Some(bar),
            note,
        };
        let whole = format!(
            "{:.3} N, after {:.0} s {:.3} N; {:.0} samples; least energy {made:.1e} J; {} ticks",
            first.mean(),
            seconds,
            last.mean(),
            tenths[k].iter().map(|tenth| tenth.count).sum::<f64>(),
            status.tick,
        );
        let drift = (last.mean() / first.mean() - 1.0).abs();
        figures.push(figure(
            "soak/drift",
            drift,
            0.0,
            "steady",
            Bar::AtMost(0.01),
            whole,
        ));
        let growth = (last.deviation() - first.deviation()) / first.mean();
        let note = format!(
            "tremor of {:.3} N, after {:.0} s {:.3} N",
            first.deviation(),
            seconds,
            last.deviation()
        );
        figures.push(figure(
            "soak/growth",
            growth,
            0.0,
            "steady",
            Bar::AtMost(0.02),
            note,
        ));
    }
    Ok(figures)
}
