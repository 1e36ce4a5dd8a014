//! Ticks of one simulation, as the daemon runs them, without a clock.

use palpate_proto::messages::ToolPose;
use palpate_sim::tick::explain::Explanation;
use palpate_sim::tick::record::{TickInput, TickOutput};
use palpate_sim::tick::{SceneState, Scratch, step_explained, step_into};
use palpate_wire::device_pose;
use pyo3::prelude::*;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Signals are looked for this often while ticks run.
const INTERRUPTS: Duration = Duration::from_millis(20);

/// State of a simulation and what its ticks need.
pub struct Loop {
    pub scene: Arc<palpate_sim::scene::Scene>,
    pub state: SceneState,
    pub scratch: Scratch,
    pub input: TickInput,
    pub output: TickOutput,
    /// By tool: the pose that it sends each tick.
    pub held: Vec<Option<ToolPose>>,
    /// By tool: number of its last pose.
    pub seqs: Vec<u64>,
}

impl Loop {
    /// At the start.
    pub fn new(scene: &Arc<palpate_sim::scene::Scene>) -> Self {
        let state = scene.initial_state();
        let tools = scene.tool_count();
        Self {
            scratch: scene.scratch(&state),
            state,
            scene: scene.clone(),
            input: TickInput::for_tools(tools),
            output: TickOutput::for_tools(tools),
            held: vec![None; tools],
            seqs: vec![0; tools],
        }
    }

    fn take_poses(&mut self) {
        for (tool, held) in self.held.iter().enumerate() {
            self.input.poses[tool] = held.as_ref().and_then(|pose| {
                let seq = self.seqs[tool] + 1;
                // Checked when it came in; this brings the quaternion to unit length as the daemon does.
                let pose = ToolPose { seq, ..*pose }.validated().ok()?;
                self.seqs[tool] = seq;
                Some(device_pose(&pose))
            });
        }
    }

    /// One tick with the poses held.
    pub fn tick(&mut self) {
        self.take_poses();
        step_into(
            &self.scene,
            &mut self.state,
            &mut self.scratch,
            &self.input,
            &mut self.output,
        );
    }

    /// One tick with the poses held, and why its forces are what they are.
    pub fn explained(&mut self) -> Explanation {
        self.take_poses();
        let Self {
            scene,
            state,
            scratch,
            input,
            output,
            ..
        } = self;
        step_explained(scene, state, scratch, input, output)
    }

    /// Back to where [`Loop::new`] is.
    pub fn restart(&mut self) {
        self.held.fill(None);
        self.seqs.fill(0);
        self.state = self.scene.initial_state();
        self.scratch = self.scene.scratch(&self.state);
        self.output = TickOutput::for_tools(self.scene.tool_count());
    }
}

/// Runs `tick` this many times without the GIL; a signal (Ctrl-C) ends it between two ticks.
pub fn interruptible(
    py: Python<'_>,
    ticks: usize,
    mut tick: impl FnMut(usize) + Send,
) -> PyResult<()> {
    let mut done = 0;
    while done < ticks {
        done = py.detach(|| {
            if ticks == 1 {
                tick(0);
                return 1;
            }
            let begun = Instant::now();
            let mut at = done;
            while at < ticks && (at == done || begun.elapsed() < INTERRUPTS) {
                tick(at);
                at += 1;
            }
            at
        });
        if ticks > 1 {
            py.check_signals()?;
        }
    }
    Ok(())
}

/// So many ticks of all copies, on this thread and `workers` − 1 others.
pub fn advance(copies: &mut [Loop], workers: usize, ticks: usize) {
    let run = |copies: &mut [Loop]| {
        copies
            .iter_mut()
            .for_each(|copy| (0..ticks).for_each(|_| copy.tick()))
    };
    if workers == 1 {
        return run(copies);
    }
    // Small blocks: copies take unequal times. Which thread takes one does not matter to its bits.
    let block = copies.len().div_ceil(workers * 8).max(1);
    let queue = Mutex::new(copies.chunks_mut(block));
    std::thread::scope(|scope| {
        let work = || {
            loop {
                let next = queue.lock().ok().and_then(|mut queue| queue.next());
                let Some(copies) = next else { return };
                run(copies);
            }
        };
        (1..workers).for_each(|_| drop(scope.spawn(work)));
        work();
    });
}
