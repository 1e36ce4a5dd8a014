//! Keeping a session allocates nothing on the tick's thread, whatever is kept.

use crate::counting::allocations;
use crate::live::{Live, SOFT};
use palpate_drive::archive::ArchiveRequest;
use palpate_drive::journal::keeping;
use palpate_record::RecorderSettings;
use palpate_sim::tick::record::{Command, TickRecord};
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Presses, slides, is reset and paused; allocations of all ticks and of the commands between them.
/// The test's own list of records has room.
fn session(live: &mut Live) -> u64 {
    live.records.reserve(2_000);
    live.spare = vec![TickRecord::for_tools(2); 1_000];
    let mut count = 0;
    for k in 0..900 {
        match k {
            200 => count += allocations(|| live.command(Command::Reset)),
            400 => count += allocations(|| live.command(Command::Pause)),
            430 => count += allocations(|| live.command(Command::Resume)),
            _ => {}
        }
        count += allocations(|| live.tick());
    }
    count
}

#[test]
fn the_tick_allocates_nothing_for_a_recording_a_ring_or_none() {
    let directory = tempfile::tempdir().unwrap();
    let ring = Some(Duration::from_millis(300));
    let mut recorded = Live::with(SOFT, |settings| RecorderSettings {
        ring,
        ..settings.to(&directory.path().join("a.mcap"))
    });
    assert_eq!(session(&mut recorded), 0);
    let (summary, records) = recorded.finish();
    assert_eq!(
        (summary.ticks, summary.dropped, records.len()),
        (900, 0, 900)
    );
    let mut ring = Live::with(SOFT, |settings| RecorderSettings { ring, ..settings });
    assert_eq!(session(&mut ring), 0);
    let mut none = Live::with(SOFT, |settings| settings);
    assert_eq!(session(&mut none), 0);
}

#[test]
fn a_recording_that_begins_and_ends_meanwhile_costs_no_allocation() {
    let directory = tempfile::tempdir().unwrap();
    let mut live = Live::with(SOFT, |settings| RecorderSettings {
        directory: directory.path().into(),
        ..settings
    });
    let mut archive = live.recorder.archive().unwrap();
    live.tick();
    archive.ask(1, ArchiveRequest::Start { path: None });
    while live.recorder.gauges().state.load(Ordering::Relaxed) != keeping::RECORDING {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(session(&mut live), 0);
    archive.ask(2, ArchiveRequest::Stop);
    while live.recorder.gauges().state.load(Ordering::Relaxed) != keeping::OFF {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(session(&mut live), 0);
}
