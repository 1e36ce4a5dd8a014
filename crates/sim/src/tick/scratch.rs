//! Buffers of a step, made anew from the state.

use super::executor::{Executor, SideBySide};
use super::state::SceneState;
use crate::contact::bounce;
use crate::contact::near::Near;
use crate::party::{BodyScratch, Party as _, Pipeline, ToolScratch};
use crate::report::error::Errors;
use crate::rest::Rest;
use crate::scene::{Pair, Scene};
use crate::solve::delassus::Delassus;
use crate::solve::direct::Direct;
use crate::solve::impacts::Impacts;
use crate::solve::indentation::{Indentation, Touch};
use crate::solve::matrix::ContactMatrix;
use crate::solve::motions::Motions;
use crate::solve::problem::ContactProblem;
use crate::solve::rows::{MAX_ROWS_PER_PAIR, RowSet, SampleInTouch};
use crate::solve::solver::Solver;
use palpate_geometry::contact::ContactQuery;
use palpate_geometry::contact::dispatch::Narrow;
use palpate_geometry::skin::SkinSolver;
use palpate_geometry::surface::Surface;

/// Buffers of a step; nothing in it outlives a tick except what can be computed anew from the
/// state.
#[derive(Debug)]
pub struct Scratch {
    /// By tool.
    pub(super) tools: Vec<ToolScratch>,
    /// By body.
    pub(super) bodies: Vec<BodyScratch>,
    /// By pair.
    pub(super) pairs: Vec<Narrow>,
    pub(super) near: Near,
    pub(super) rest: Rest,
    pub(super) rows: RowSet,
    /// Samples of one pair in touch.
    pub(super) hits: Vec<SampleInTouch>,
    pub(super) solver: Solver,
    /// By body: the share of its motion that was taken.
    pub(super) shares: Vec<f64>,
    /// How far the forces may be off.
    pub(super) errors: Errors,
    /// By body: its step does less than the scene asks for.
    pub(super) degraded: Vec<bool>,
    /// Where bodies that take several ticks step; without it they step in the tick in which they
    /// are due.
    pub(super) pipeline: Option<Box<dyn Pipeline>>,
    /// Where the others step.
    pub(super) side_by_side: SideBySide,
    /// The state at the start, for a reset.
    pub(super) start: SceneState,
}

impl Scratch {
    /// Lets bodies that take several ticks step elsewhere.
    pub fn set_pipeline(&mut self, pipeline: Box<dyn Pipeline>) {
        self.pipeline = Some(pipeline);
    }

    /// Lets bodies of the scene that step every tick do so side by side: to the same bits.
    pub fn set_executor(&mut self, scene: &Scene, executor: Option<Box<dyn Executor>>) {
        self.side_by_side = SideBySide::new(scene, executor);
    }

    /// Takes that back.
    pub fn take_executor(&mut self) -> Option<Box<dyn Executor>> {
        std::mem::take(&mut self.side_by_side).into_executor()
    }

    /// Pieces of surfaces that searches for closest points gave up so far: where that grows, an answer
    /// was not certified.
    pub fn pieces_given_up(&self) -> u64 {
        let solvers = self.bodies.iter().map(|body| &body.solver);
        solvers.map(SkinSolver::pieces_given_up).sum()
    }

    /// What finds contacts where that is a method of who built the scene, by pair: holder, body, query.
    pub fn other_queries<'a>(
        &'a self,
        scene: &'a Scene,
    ) -> impl Iterator<Item = (&'a str, &'a str, &'a dyn ContactQuery)> {
        let pairs = scene.pairs.iter().zip(&self.pairs);
        pairs.filter_map(|(pair, scratch)| {
            Some((
                scene.holder_id(pair),
                scene.body_id(pair.body),
                scratch.other()?,
            ))
        })
    }
}

impl Scene {
    fn narrow(&self, pair: &Pair) -> Narrow {
        let party = pair.party(&self.tools, &self.bodies);
        let mut narrow = Narrow::new(self.bodies[pair.body].shape(), party, pair.method)
            .unwrap_or_else(|e| unreachable!("the scene was built with a pair that has none: {e}"));
        if bounce::are_rigid(self, pair.body, pair.holder) {
            narrow.spread();
        }
        narrow
    }

    /// Buffers for the steps of one simulation, prepared for `state`.
    pub fn scratch(&self, state: &SceneState) -> Scratch {
        let width_of =
            |surface: &Surface| (surface.knots_u().degree() + 1) * (surface.knots_v().degree() + 1);
        let most_rows = self.most_rows();
        let width = self
            .bodies
            .iter()
            .filter_map(|body| body.skin.surface().map(width_of))
            .max()
            .unwrap_or(1);
        let surface = self
            .bodies
            .iter()
            .map(|body| body.skin.points().len())
            .max()
            .unwrap_or(0);
        let frictional = self.pairs.iter().any(|pair| pair.friction.is_some());
        let grips = self.tools.iter().any(|tool| tool.grip_n > 0.0);
        let directions = most_rows * if frictional || grips { 3 } else { 1 };
        let free = (0..self.bodies.len()).filter(|body| self.is_free(*body));
        let free = free.count();
        let mut scratch = Scratch {
            tools: self.tool_parties().map(|tool| tool.scratch()).collect(),
            bodies: self.parties().map(|body| body.scratch()).collect(),
            pairs: self.pairs.iter().map(|pair| self.narrow(pair)).collect(),
            near: Near::new(self),
            rest: Rest::new(self),
            rows: RowSet::new(most_rows, width),
            hits: Vec::with_capacity(MAX_ROWS_PER_PAIR),
            solver: Solver {
                matrix: ContactMatrix::new(most_rows, directions),
                problem: ContactProblem::new(most_rows, directions),
                motions: Motions::new(most_rows, free),
                direct: Direct::new(most_rows, directions, free),
                heaviest_kg: vec![0.0; self.bodies.len() + self.tools.len()],
                impacts: Impacts::new(most_rows),
                sticks: Vec::with_capacity(most_rows),
                shares: Vec::with_capacity(most_rows),
                barriers: Vec::with_capacity(most_rows),
                delassus: Delassus::new(2 * most_rows, width, surface),
                touches: vec![Touch::default(); self.pairs.len()],
                indentations: vec![Indentation::default(); self.pairs.len()],
                touching: Vec::with_capacity(self.pairs.len()),
            },
            shares: vec![1.0; self.bodies.len()],
            errors: Errors::new(most_rows, directions, self.tools.len()),
            degraded: vec![false; self.bodies.len()],
            pipeline: None,
            side_by_side: SideBySide::default(),
            start: self.initial_state(),
        };
        self.prepare(state, &mut scratch);
        scratch
    }

    /// Brings buffers that have been through ticks in line with another state of the scene: what
    /// they compute from here on has the bits that new ones would compute. Allocates nothing.
    pub(super) fn reuse_scratch(&self, state: &SceneState, scratch: &mut Scratch) {
        scratch.rest.forget();
        for (body, parts) in self.parties().zip(&mut scratch.bodies) {
            body.forget(parts);
        }
        self.prepare(state, scratch);
        // Steps that were begun elsewhere belong to the state before.
        if let Some(pipeline) = &mut scratch.pipeline {
            pipeline.cancel();
        }
    }

    /// Brings the buffers of all bodies in line with their state: surface now, free motion of the next step, and
    /// its net.
    pub fn prepare(&self, state: &SceneState, scratch: &mut Scratch) {
        let field = self.field(&state.frame);
        for (b, body) in self.parties().enumerate() {
            body.prepare(field, &state.bodies[b], &mut scratch.bodies[b], false);
        }
    }
}
