//! A daemon that runs its own ticks again: what it finds, and what it lets be.

use crate::common::{Laws as _, World};
use crate::daemon::{Daemon, device};
use crate::session::{RIGID, Script, scenes};
use palpate_drive::journal::{Journal, NoJournal};
use palpate_drive::nets::NetPool;
use palpate_geometry::math::state_hash;
use palpate_record::{SelfCheck, SelfCheckReport};
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::{Command, TickRecord};
use palpate_sim::tick::{apply, step};
use std::sync::Arc;

/// Runs a script under a self-check of so many ticks; `hand_over` may change what the journal is
/// told.
fn checked(
    text: &str,
    script: &Script,
    every: usize,
    mut hand_over: impl FnMut(&mut TickRecord),
) -> SelfCheckReport {
    let mut world = World::new(text);
    let scene: Arc<Scene> = World::new(text).scene;
    let (check, mut port) = SelfCheck::start(&scene, every, Box::new(NoJournal)).unwrap();
    port.keyframe(&world.state, state_hash(&world.state));
    let mut nets = NetPool::new(&scene, port.nets_held());
    for tick in 0..script.ticks {
        for command in script.commands_after(tick) {
            port.command(tick, command);
            apply(&world.scene, &mut world.state, &mut world.scratch, command);
            if command == Command::Reset {
                port.keyframe(&world.state, state_hash(&world.state));
            }
        }
        let input = script.input(tick + 1, &world.scene);
        let output = step(&world.scene, &mut world.state, &mut world.scratch, &input);
        let mut record = TickRecord {
            input,
            output,
            ..TickRecord::default()
        };
        hand_over(&mut record);
        nets.begin();
        port.tick(&world.scene, &world.state, &record, &mut nets);
        // A loop has a millisecond for a tick; a test leaves its shadow some time now and then.
        if tick % 50 == 0 {
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
    }
    drop(port);
    check.finish()
}

#[test]
fn a_self_check_runs_ticks_again_and_tells_the_first_that_parts() {
    for (name, text) in scenes() {
        let report = checked(&text, &Script::new(9, 210, true), 20, |_| {});
        assert_eq!(
            (report.differences, report.first_difference),
            (0, None),
            "{name}"
        );
        assert_eq!(report.ticks + report.unchecked, 210, "{name}: {report:?}");
        assert!(report.checks >= 3, "{name}: {report:?}");
    }
    // A hash that was not of the state: as if the loop had come to another state than the same
    // inputs do.
    let report = checked(RIGID, &Script::new(9, 100, true), 25, |record| {
        record.output.state_hash ^= u64::from(record.output.tick == 33);
    });
    let found = report
        .first_difference
        .expect("a forged hash went unnoticed");
    assert_eq!(
        (
            report.differences,
            found.from,
            found.tick,
            found.first ^ found.second
        ),
        (1, 25, 33, 1)
    );
}

#[test]
fn a_daemon_checks_itself_while_it_serves() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(
        directory.path(),
        RIGID,
        &["--clock", "lockstep", "--for", "1s", "--self-check", "50"],
    );
    let (report, code) = device(
        &daemon.endpoint,
        &["--motion", "press", "--for", "1s", "--seed", "5"],
    );
    assert_eq!(code, 0, "{report}");
    let (text, code) = daemon.end();
    assert_eq!(code, 0, "{text}");
    assert!(
        text.contains("self-check: ") && text.contains(" 0 differences"),
        "{text}"
    );
}
