//! A whole recording from the inputs of another one, as this build steps them.

use super::super::port::RecorderPort;
use super::super::reader::{Session, recorded_spec};
use super::super::recorder::{RecorderSettings, SteppedRecorder};
use super::super::replay::ReplayError;
use super::super::report::RecordingSummary;
use super::error::{InputsError, RunError};
use super::{Input, InputRun};
use palpate_drive::journal::Journal as _;
use palpate_drive::nets::NetPool;
use palpate_sim::tick::record::{Command, TickRecord};
use std::path::Path;

/// Runs the inputs of a session and records what comes of them to `target`, with everything that a
/// recording has: outputs, nets, keyframes, views. Times of ticks are not known and are zero.
///
/// # Errors
/// A session that cannot be run from its start, or a file that exists or cannot be written.
pub fn record_again(
    session: &Session,
    target: &Path,
    mut progress: impl FnMut(u64, u64),
) -> Result<RecordingSummary, InputsError> {
    let run = InputRun::of(session)?;
    let header = &session.header;
    let spec = recorded_spec(&header.effective_scene);
    let spec = spec.map_err(|reason| RunError::from(ReplayError::SceneText(reason)))?;
    let mut settings = RecorderSettings::new(&header.scene_text, &spec).to(target);
    let name = session.path.file_name().unwrap_or_default();
    let name = name.to_string_lossy().into_owned();
    settings.extra.insert("recorded_again_from".into(), name);
    let (mut recorder, mut port) = SteppedRecorder::new(settings, &run.scene)?;
    let ran = step_all(run, &mut port, &mut recorder, |ticks| {
        progress(ticks, session.tick_count());
    });
    drop(port);
    let summary = recorder.finish().last()?;
    ran.inspect_err(|_| drop(std::fs::remove_file(target)))?;
    Ok(summary)
}

fn step_all(
    mut run: InputRun,
    port: &mut RecorderPort,
    recorder: &mut SteppedRecorder,
    mut progress: impl FnMut(u64),
) -> Result<(), RunError> {
    let scene = run.scene.clone();
    let mut nets = NetPool::new(&scene, port.nets_held());
    let mut ticks = 0_u64;
    port.keyframe(run.rerun.state(), run.rerun.hash());
    while let Some(input) = run.next() {
        match input? {
            Input::Tick(_, input) => {
                let output = run.rerun.tick(&input);
                let record = TickRecord {
                    input,
                    output,
                    ..TickRecord::default()
                };
                nets.begin();
                port.tick(&scene, run.rerun.state(), &record, &mut nets);
                ticks += 1;
                if ticks.is_multiple_of(100) {
                    progress(ticks);
                }
            }
            Input::Command(after_tick, command) => {
                port.command(after_tick, command);
                run.rerun.command(command);
                if command == Command::Reset {
                    port.keyframe(run.rerun.state(), run.rerun.hash());
                }
            }
        }
        recorder.turn();
    }
    Ok(())
}
