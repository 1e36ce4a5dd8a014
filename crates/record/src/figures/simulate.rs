//! A session run anew: its figures, and hashes of all that came of it.

use super::super::inputs::{Input, InputRun, RunError, Start};
use super::super::reader::Session;
use super::hashes::{Hasher, Hashes};
use super::{Figures, Sum};

/// What a session came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// Figures, without hashes.
    pub figures: Figures,
    /// Of states, outputs and nets.
    pub hashes: Hashes,
    /// Where it began.
    pub start: Start,
}

/// Runs a session with its recorded inputs and sums up what comes out. `progress` is called now and
/// then with the ticks done and all.
///
/// # Errors
/// A session with ticks missing, one that does not begin at tick 0 and whose first keyframe this
/// version cannot read, or a scene that does not build.
pub fn simulate(
    session: &Session,
    mut progress: impl FnMut(u64, u64),
) -> Result<Simulation, RunError> {
    let mut run = InputRun::of(session)?;
    let scene = run.scene.clone();
    let mut sum = Sum::new(&scene);
    let mut hasher = Hasher::new(scene.tool_count(), session.tick_count());
    while let Some(input) = run.next() {
        match input? {
            Input::Tick(tick, input) => {
                hasher.input(tick, &input);
                let output = run.rerun.tick(&input);
                sum.push(&output, run.rerun.state());
                hasher.output(&output);
                hasher.nets(&run.rerun, false);
                if sum.ticks.is_multiple_of(100) {
                    progress(sum.ticks, session.tick_count());
                }
            }
            Input::Command(after_tick, command) => {
                hasher.command(after_tick, command);
                run.rerun.command(command);
            }
        }
    }
    hasher.nets(&run.rerun, true);
    Ok(Simulation {
        figures: sum.finish(),
        hashes: hasher.finish(),
        start: run.start,
    })
}

/// [`simulate`], for the figures alone.
///
/// # Errors
/// As there.
pub fn simulate_figures(
    session: &Session,
    progress: impl FnMut(u64, u64),
) -> Result<(Figures, Start), RunError> {
    simulate(session, progress).map(|found| (found.figures, found.start))
}
