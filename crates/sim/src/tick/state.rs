//! What a replay restores.

use super::frame::FrameState;
use super::quality;
use crate::contact::PairState;
use crate::contact::warm::Warm;
use crate::in_place::clone_in_place;
use crate::party::{BodyState, Party as _, ToolState};
use crate::scene::Scene;
use crate::solve::grip::{GRAB, GripState};
use palpate_geometry::math::{Coded, Point3, StateSize, state_size};
use palpate_geometry::stateful;

/// Whether bodies move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunState {
    /// Ticking.
    Running,
    /// Standing still, but for this many ticks.
    Paused {
        /// Ticks still to run.
        steps: u32,
    },
    /// Forces fade for good.
    Stopping,
}

/// All that a replay must restore. Hashed every tick.
#[derive(Debug, PartialEq)]
pub struct SceneState {
    /// Ticks done.
    pub tick: u64,
    /// Whether bodies move.
    pub run: RunState,
    /// 0 is full quality; see [`super::quality`].
    pub quality: u8,
    /// The last tick set a body back to rest: the next forces say so.
    pub faulted: bool,
    /// By body.
    pub bodies: Vec<BodyState>,
    /// By tool.
    pub tools: Vec<ToolState>,
    /// By pair of the plan.
    pub pairs: Vec<PairState>,
    /// How the frame of the bodies moves; saved only where a tool carries it.
    pub frame: FrameState,
    /// A tool carries the bodies.
    pub(crate) carried: bool,
    /// Contact forces of the last tick.
    pub warm: Warm,
}

impl Scene {
    /// The state at the start.
    pub fn initial_state(&self) -> SceneState {
        SceneState {
            tick: 0,
            run: RunState::Running,
            quality: 0,
            faulted: false,
            bodies: self.parties().map(|party| party.start()).collect(),
            tools: self.tool_parties().map(|party| party.start()).collect(),
            pairs: vec![PairState::default(); self.pairs.len()],
            frame: FrameState::default(),
            carried: self.frame.is_some(),
            warm: Warm::with_room(self.most_rows()),
        }
    }
}

clone_in_place!(SceneState {
    tick,
    run,
    quality,
    faulted,
    bodies,
    tools,
    pairs,
    frame,
    carried,
    warm,
});

impl SceneState {
    /// Net of a body now, u-major, m; of a part, corners around it. `out` is as long as the points of [`Scene::skin`].
    pub fn copy_net(&self, scene: &Scene, body: usize, out: &mut [Point3]) {
        debug_assert_eq!(
            out.len(),
            scene.skin(body).points().len(),
            "a point a control"
        );
        scene.party(body).net(&self.bodies[body], out);
    }

    /// Coordinates of a deforming body now, m: of its nodes, by [`Deformable::nodes`](crate::body::Deformable::nodes).
    pub fn coordinates(&self, body: usize) -> Option<&[Point3]> {
        let deformable = self.bodies[body].deformable.as_ref()?;
        Some(&deformable.positions)
    }

    /// Size of the largest state of this scene: contact rows and grips come and go.
    pub fn largest_size(&self) -> StateSize {
        let mut largest = self.clone();
        largest.warm.fill();
        for tool in &mut largest.tools {
            tool.link.pose.buttons |= GRAB;
            tool.grip = GripState::full();
        }
        state_size(&largest)
    }

    /// Grows with every change of that body's net.
    pub fn net_revision(&self, body: usize) -> u64 {
        self.bodies[body].revision
    }
}

impl Coded for RunState {
    /// The kind; the steps come after it.
    fn code(&self) -> u64 {
        match self {
            Self::Running => 0,
            Self::Paused { .. } => 1,
            Self::Stopping => 2,
        }
    }

    fn set_code(&mut self, code: u64) -> bool {
        *self = match code {
            0 => Self::Running,
            1 => Self::Paused { steps: 0 },
            2 => Self::Stopping,
            _ => return false,
        };
        true
    }
}

stateful!(SceneState, |this, walk| {
    let SceneState {
        tick,
        run,
        quality,
        faulted,
        bodies,
        tools,
        pairs,
        frame,
        carried,
        warm,
    } = this;
    walk.word(tick)?;
    walk.packed(
        "run state or quality",
        [(0, run), (32, quality), (40, faulted)],
    )?;
    walk.ensure(*quality <= quality::LOWEST, "quality", u64::from(*quality))?;
    if let RunState::Paused { steps } = run {
        walk.coded("step count", steps)?;
    } else {
        walk.nothing()?;
    }
    for body in bodies {
        walk.part(body)?;
    }
    for tool in tools {
        walk.part(tool)?;
    }
    for pair in pairs {
        walk.part(pair)?;
    }
    if *carried {
        walk.part(frame)?;
    }
    walk.part(warm)?;
    Ok(())
});
