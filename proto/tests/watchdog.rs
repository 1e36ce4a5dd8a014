//! The watchdog's arithmetic, kept: clients in C, Python and TypeScript read `golden/watchdog.csv` in
//! their tests. `BLESS=1 cargo test -p palpate-proto --test watchdog` writes it when it is missing.

use palpate_proto::Watchdog;
use std::fmt::Write as _;
use std::path::Path;
use std::time::{Duration, Instant};

/// What happens at a time: a force comes, or somebody looks.
enum At {
    Comes(u64),
    Look(u64),
}

/// Looks every three milliseconds while forces come at these times, ms.
fn run(comes: &[u64], until: u64) -> Vec<At> {
    let looks = (0..until)
        .step_by(3)
        .map(|ms| (ms * 1_000_000 + 300_000, false));
    let mut all: Vec<(u64, bool)> = comes.iter().map(|ms| (ms * 1_000_000, true)).collect();
    all.extend(looks.filter(|(ns, _)| {
        // Between forces that come every millisecond nothing changes.
        !comes.contains(&(ns / 1_000_000)) || ns / 1_000_000 % 20 == 0
    }));
    all.sort_unstable();
    let at = |(ns, comes)| if comes { At::Comes(ns) } else { At::Look(ns) };
    all.into_iter().map(at).collect()
}

fn table() -> String {
    let every = |from: u64, to: u64, step: usize| (from..to).step_by(step).collect::<Vec<_>>();
    let runs = [
        // Forces stop, and come again for good.
        (
            false,
            run(&[every(5, 40, 1), every(130, 245, 1)].concat(), 250),
        ),
        // They come again while the last one fades, and stop.
        (
            false,
            run(&[every(0, 3, 1), every(56, 80, 1)].concat(), 150),
        ),
        // Rarely: each is too late.
        (false, run(&every(0, 300, 61), 310)),
        // With a deadband.
        (
            true,
            run(&[every(0, 210, 50), every(400, 620, 50)].concat(), 720),
        ),
        // What had waited comes at once, and nothing follows.
        (
            false,
            (0..6)
                .map(|k| At::Comes(k * 1_000_000))
                .chain((0..8).map(|k| At::Comes(3_000_000_000 + k * 50_000)))
                .chain((0..9).map(|k| At::Look(3_000_000_000 + k * 8_000_000)))
                .collect(),
        ),
    ];
    let begun = Instant::now();
    let mut out = String::from("run,deadband,time_ns,comes,gain,silence_ns\n");
    for (number, (deadband, events)) in runs.into_iter().enumerate() {
        let mut dog = Watchdog::new(deadband);
        for event in events {
            let (At::Comes(ns) | At::Look(ns)) = event;
            let now = begun + Duration::from_nanos(ns);
            let comes = matches!(event, At::Comes(_));
            if comes {
                dog.heard(now);
            }
            let silence = (dog.silence(now)).map_or(String::new(), |s| s.as_nanos().to_string());
            let (gain, comes, deadband) = (dog.gain(now), u8::from(comes), u8::from(deadband));
            let _ = writeln!(out, "{number},{deadband},{ns},{comes},{gain:?},{silence}");
        }
    }
    out
}

#[test]
fn the_watchdog_keeps_its_arithmetic() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/watchdog.csv");
    if std::env::var_os("BLESS").is_some() && !path.exists() {
        std::fs::write(&path, table()).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap();
    for (number, (kept, now)) in kept.lines().zip(table().lines()).enumerate() {
        assert_eq!(kept, now, "line {}", number + 1);
    }
    assert_eq!(kept.lines().count(), table().lines().count());
    // Each part of the law is in it.
    let gains: Vec<f64> = (kept.lines().skip(1))
        .map(|line| line.split(',').nth(4).unwrap().parse().unwrap())
        .collect();
    let some = |range: std::ops::Range<f64>| gains.iter().any(|gain| range.contains(gain));
    assert!(gains.contains(&0.0) && gains.contains(&1.0) && some(0.001..0.5) && some(0.5..0.999));
}
