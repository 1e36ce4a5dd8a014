//! The daemon and its client under faults, on a virtual clock: a few dozen seeds of the thousands that
//! `palpate-bench faults` runs.

use palpate_faults::{Plan, Report, run};
use std::collections::BTreeSet;

/// In memory where there is such a folder: thousands of small files.
fn folder() -> tempfile::TempDir {
    let memory = std::path::Path::new("/dev/shm");
    match memory.is_dir() {
        true => tempfile::tempdir_in(memory)
            .or_else(|_| tempfile::tempdir())
            .unwrap(),
        false => tempfile::tempdir().unwrap(),
    }
}

fn seed(seed: u64) -> Report {
    run(seed, folder().path())
        .unwrap_or_else(|violation| panic!("{violation}: {:?}", Plan::of(seed)))
}

#[test]
fn no_fault_leads_to_what_must_not_happen() {
    let mut most = Report::default();
    let mut kinds = BTreeSet::new();
    // More of them by PALPATE_FAULT_SEEDS=1000..2000.
    let asked = std::env::var("PALPATE_FAULT_SEEDS").unwrap_or_default();
    let range = asked.split_once("..").map(|(a, b)| (a.parse(), b.parse()));
    let (from, to) = match range {
        Some((Ok(from), Ok(to))) => (from, to),
        _ => (0, 48),
    };
    let mut wrong = Vec::new();
    for number in from..to {
        let report = match run(number, folder().path()) {
            Ok(report) => report,
            Err(violation) => {
                wrong.push(format!("{violation}: {:?}", Plan::of(number)));
                continue;
            }
        };
        for (_, fault) in &Plan::of(number).faults {
            kinds.insert(format!("{fault:?}").split('(').next().unwrap().to_owned());
        }
        most.ticks += report.ticks;
        most.recorded += report.recorded;
        most.packets[0] += report.packets[0];
        most.most_lost = most.most_lost.max(report.most_lost);
        most.peak_force_n = most.peak_force_n.max(report.peak_force_n);
        most.least_own_j = most.least_own_j.min(report.least_own_j);
    }
    println!("{from}..{to}: {most:?}");
    assert!(
        wrong.is_empty(),
        "{} seeds:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    // The simulation is worth something: hands are pressed, daemons killed, packets lost.
    assert_eq!(kinds.len(), 17, "{kinds:?}");
    assert!(
        most.peak_force_n > 1.0 && most.packets[0] > 1_000 && most.most_lost > 0,
        "{most:?}"
    );
    assert!(most.recorded > most.ticks / 2, "{most:?}");
}

#[test]
fn a_seed_repeats_bit_for_bit() {
    for number in [3, 17, 1 << 40] {
        assert_eq!(seed(number), seed(number));
    }
    assert_ne!(seed(3).trace, seed(4).trace);
}
