//! One tick: pure, no clock, no I/O, no allocation, no lock, no error.

use super::record::{Command, TickInput, TickOutput};
use super::{
    RunState, SceneState, Scratch, admit, arrive, flags, invariants, iterate, motion, quality,
};
use crate::contact::{PairState, Search, find, grip, near, near_field};
use crate::party::{Around, Party as _};
use crate::report::explain::{self, Explanation};
use crate::report::{degraded, error, outputs};
use crate::rest;
use crate::scene::Scene;
use crate::tick::balance::Balance;
use palpate_geometry::math::{SavedState, StateError, state_hash};

/// Advances by one tick: [`render`], then [`deform`], then [`hash`]. The output is made anew, and
/// that is all that is allocated; loops fill one that is there with [`step_into`].
///
/// # Examples
/// ```
/// use palpate_sim::scene::{Scene, file};
/// use palpate_sim::tick::{record::TickInput, step};
/// use std::path::Path;
/// let text = r#"
///     [[body]]
///     id = "ball"
///     surface = { builtin = "sphere" }
///     [[tool]]
///     id = "pen"
///     shape = { point = {} }
///     pose = { position = [0.0, 0.0, 0.1] }
/// "#;
/// let loaded = file::parse(text, "scene.toml", Path::new("."))?;
/// let scene = Scene::build(&loaded.spec, Path::new("."))?;
/// let mut state = scene.initial_state();
/// let mut scratch = scene.scratch(&state);
/// let output = step(&scene, &mut state, &mut scratch, &TickInput::default());
/// assert_eq!(output.tick, 1);
/// assert!(output.fault.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn step(
    scene: &Scene,
    state: &mut SceneState,
    scratch: &mut Scratch,
    input: &TickInput,
) -> TickOutput {
    let mut output = TickOutput::for_tools(scene.tool_count());
    step_into(scene, state, scratch, input, &mut output);
    output
}

/// [`step`] into an output that is there already. Allocates nothing when `output` has room for the
/// scene's tools ([`TickOutput::for_tools`]).
pub fn step_into(
    scene: &Scene,
    state: &mut SceneState,
    scratch: &mut Scratch,
    input: &TickInput,
    output: &mut TickOutput,
) {
    render(scene, state, scratch, input, output);
    deform(scene, state, scratch, output);
    hash(state, output);
}

/// [`step_into`], with why its forces are what they are: to the same bits, but slower, and it allocates.
pub fn step_explained(
    scene: &Scene,
    state: &mut SceneState,
    scratch: &mut Scratch,
    input: &TickInput,
    output: &mut TickOutput,
) -> Explanation {
    render(scene, state, scratch, input, output);
    let mut explanation = explain::of_contact(&mut balance(scene, state, scratch), output);
    let steps = explain::steps(scene, &state.bodies, &scratch.bodies);
    deform(scene, state, scratch, output);
    explanation.bodies = explain::of_bodies(scene, &state.bodies, output.moving, steps);
    hash(state, output);
    explanation
}

/// [`Stage::Render`](super::stage::Stage): admits the poses, finds contacts and forces. What
/// `output` held before is gone; everything in it but `state_hash`, `net_revision` and a fault of
/// the bodies is final.
pub fn render(
    scene: &Scene,
    state: &mut SceneState,
    scratch: &mut Scratch,
    input: &TickInput,
    output: &mut TickOutput,
) {
    state.tick += 1;
    let moving = match &mut state.run {
        RunState::Running => true,
        RunState::Paused { steps: 0 } | RunState::Stopping => false,
        RunState::Paused { steps } => {
            *steps -= 1;
            true
        }
    };
    if moving {
        scratch.side_by_side.wake();
    }
    output.clear(scene.tool_count());
    (output.tick, output.moving, output.quality) = (state.tick, moving, state.quality);
    let wanted = state.run == RunState::Running;
    let SceneState { tools, pairs, .. } = state;
    admit::admit(scene, tools, pairs, input, wanted, output);
    predict(scene, state, scratch, moving);
    contacts(scene, state, scratch, moving);
    balance(scene, state, scratch).solve();
    if cfg!(debug_assertions) {
        invariants::of_motion(scene, &scratch.tools, &scratch.bodies);
        invariants::of_rows(scene, &state.tools, &scratch.rows);
        invariants::of_forces(&scratch.rows, &scratch.solver);
    }
    let Scratch { rows, solver, .. } = &*scratch;
    admit::release(scene, &mut state.tools, &rows.rows, solver, wanted, output);
    iterate::iterate(&mut balance(scene, state, scratch));
    let mut shares = std::mem::take(&mut scratch.shares);
    let mut side_by_side = std::mem::take(&mut scratch.side_by_side);
    let mut balance = balance(scene, state, scratch);
    arrive::arrive(&mut balance, &mut shares, &mut side_by_side);
    (scratch.shares, scratch.side_by_side) = (shares, side_by_side);
    estimate(scene, state, scratch);
    report(scene, state, scratch, output);
    if cfg!(debug_assertions) {
        invariants::of_output(scene, &state.tools, &scratch.tools, &state.warm, output);
    }
    if std::mem::take(&mut state.faulted) {
        let tools = output.tools.as_mut_slice().iter_mut();
        tools.for_each(|tool| tool.flags |= flags::FAULT);
    }
}

/// Free motion of all parties.
fn predict(scene: &Scene, state: &SceneState, scratch: &mut Scratch, moving: bool) {
    let around = Around {
        tools: &state.tools,
        field: scene.field(&state.frame),
        moving,
    };
    for (b, body) in scene.parties().enumerate() {
        body.predict(&around, &state.bodies[b], &mut scratch.bodies[b]);
    }
    for (t, tool) in scene.tool_parties().enumerate() {
        tool.predict(&around, &state.tools[t], &mut scratch.tools[t]);
    }
}

/// Rows of the contact problem.
fn contacts(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch, moving: bool) {
    let SceneState {
        bodies,
        tools,
        pairs,
        frame,
        warm,
        ..
    } = state;
    let Scratch {
        tools: tool_parts,
        bodies: parts,
        pairs: narrow,
        near,
        rest,
        rows,
        hits,
        solver,
        ..
    } = scratch;
    near::find(scene, tools, tool_parts, parts, near);
    grip::update(scene, tools, parts);
    let around = Around {
        tools,
        field: scene.field(frame),
        moving,
    };
    rest::settle(scene, &around, bodies, parts, near, rest);
    find::find(&mut Search {
        scene,
        tools,
        states: bodies,
        warm,
        near,
        pairs,
        tool_parts,
        bodies: parts,
        narrow,
        rest,
        rows,
        hits,
        touches: &mut solver.touches,
    });
    for (b, body) in scene.parties().enumerate() {
        body.take_back(&bodies[b], &mut parts[b], rows, solver);
    }
}

/// How far those forces may be off.
fn estimate(scene: &Scene, state: &SceneState, scratch: &mut Scratch) {
    let mut balance = Balance {
        scene,
        tools: &state.tools,
        states: &state.bodies,
        warm: &state.warm,
        quality: state.quality,
        tool_parts: &mut scratch.tools,
        bodies: &mut scratch.bodies,
        rows: &mut scratch.rows,
        solver: &mut scratch.solver,
    };
    error::estimate(&mut balance, &scratch.pairs, &mut scratch.errors);
}

/// Forces for the hands, and on the bodies.
fn report(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch, output: &mut TickOutput) {
    let Scratch {
        tools: tool_parts,
        bodies,
        rest,
        rows,
        solver,
        errors,
        degraded,
        ..
    } = scratch;
    let SceneState {
        tools, pairs, warm, ..
    } = state;
    outputs::write(scene, tools, tool_parts, rows, solver, rest, output);
    error::report(errors, tools, tool_parts, output);
    degraded::mark(scene, tools, bodies, &rows.rows, solver, degraded, output);
    outputs::remember(scene, warm, bodies, rows, solver, rest);
    near_field::remember(rows, solver, pairs);
}

fn balance<'a>(scene: &'a Scene, state: &'a SceneState, scratch: &'a mut Scratch) -> Balance<'a> {
    Balance {
        scene,
        tools: &state.tools,
        states: &state.bodies,
        warm: &state.warm,
        quality: state.quality,
        tool_parts: &mut scratch.tools,
        bodies: &mut scratch.bodies,
        rows: &mut scratch.rows,
        solver: &mut scratch.solver,
    }
}

/// By pair of bodies: how deep they are in each other at the start, m; 0 of other pairs.
pub(crate) fn depths_at_start(scene: &Scene) -> Vec<f64> {
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    predict(scene, &state, &mut scratch, true);
    contacts(scene, &mut state, &mut scratch, true);
    let depth = |pair: &PairState| pair.proxy.deepest_m;
    state.pairs.iter().map(depth).collect()
}

/// [`Stage::Deform`](super::stage::Stage): moves the bodies and predicts their next free motion.
pub fn deform(
    scene: &Scene,
    state: &mut SceneState,
    scratch: &mut Scratch,
    output: &mut TickOutput,
) {
    if !output.moving {
        motion::stand_still(scene, &state.frame, &state.bodies, &mut scratch.bodies);
    } else if let Some(fault) = motion::advance(
        scene,
        &mut state.bodies,
        &state.tools,
        &mut state.frame,
        &mut scratch.bodies,
        (&mut scratch.side_by_side, &mut scratch.pipeline),
    ) {
        output.fault = Some(fault);
        // The forces of this tick are out already.
        state.faulted = true;
    }
    scratch.side_by_side.rest();
    if cfg!(debug_assertions) {
        state.check(scene);
    }
    output.net_revision = state.bodies.iter().map(|body| body.revision).sum();
}

/// [`Stage::Hash`](super::stage::Stage): hashes the state after the tick.
pub fn hash(state: &SceneState, output: &mut TickOutput) {
    output.state_hash = state_hash(state);
}

/// Applies a command between ticks. Allocates nothing: a reset writes the start into the state and
/// the scratch that are there.
pub fn apply(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch, command: Command) {
    match command {
        Command::Reset => {
            let start = &mut scratch.start;
            // Ticks are as long as before, devices what they were, and a loop that is paused or ends goes on
            // doing so: none is part of the start.
            (start.tick, start.quality) = (state.tick, state.quality);
            start.run = match state.run {
                RunState::Paused { .. } => RunState::Paused { steps: 0 },
                run => run,
            };
            for (start, tool) in start.tools.iter_mut().zip(&state.tools) {
                start.bounds = tool.bounds;
            }
            for (start, body) in start.bodies.iter_mut().zip(&state.bodies) {
                start.revision = body.revision + 1;
            }
            state.clone_from(start);
            scene.reuse_scratch(state, scratch);
        }
        Command::Pause => {
            if state.run == RunState::Running {
                state.run = RunState::Paused { steps: 0 };
            }
        }
        Command::Resume => {
            if matches!(state.run, RunState::Paused { .. }) {
                state.run = RunState::Running;
            }
        }
        Command::Step(more) => {
            if let RunState::Paused { steps } = &mut state.run {
                *steps = steps.saturating_add(more);
            }
        }
        Command::Stop => state.run = RunState::Stopping,
        Command::Device { tool, bounds } => {
            if let Some(tool) = state.tools.get_mut(tool as usize) {
                tool.bounds = bounds;
            }
        }
        Command::Quality(level) => state.quality = level.min(quality::LOWEST),
        Command::PutOff { body } => {
            if let Some(state) = state.bodies.get_mut(body as usize) {
                state.put_off = scene.steps_apart(body as usize);
                if let Some(nodes) = state.deformable.as_mut() {
                    nodes.following.put_off();
                }
            }
        }
        Command::Send {
            body,
            position,
            rotation,
            ticks,
        } => {
            let body = state.bodies.get_mut(body as usize);
            if let Some(rigid) = body.and_then(|body| body.rigid.as_mut()) {
                rigid.send((position, rotation), ticks, scene.dt_s);
            }
        }
    }
}

/// Restores a saved state and prepares the scratch for its next tick.
///
/// # Errors
/// The saved state is of another scene.
pub fn restore(
    scene: &Scene,
    state: &mut SceneState,
    scratch: &mut Scratch,
    saved: &SavedState,
) -> Result<(), StateError> {
    saved.restore_into(state)?;
    scene.reuse_scratch(state, scratch);
    Ok(())
}
