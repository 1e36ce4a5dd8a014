//! What a party of contact does in the stages of a tick.

use super::flight::RigidMotion;
use super::pipeline::Pipeline;
use super::tool::ToolState;
use crate::body::{DeformableState, FallBack, Field, Ledger};
use crate::solve::indentation::Resolution;
use crate::solve::rows::{Range, Row, RowSet};
use crate::solve::solver::Solver;
use crate::tick::record::TickFault;
use palpate_geometry::math::{Point3, Vector3};

/// What a tick is to all parties.
#[derive(Clone, Copy)]
pub(crate) struct Around<'a> {
    /// Tools may take bodies along.
    pub tools: &'a [ToolState],
    /// What free points feel.
    pub field: Field,
    /// Bodies move in this tick.
    pub moving: bool,
}

/// The contact problem of a tick, as parties see it.
pub(crate) struct Problem<'a> {
    pub rows: &'a RowSet,
    pub solver: &'a mut Solver,
}

/// What takes part in contact. The stages of a tick call these in their order, and name no kind of party.
pub(crate) trait Party {
    /// What a replay restores of it.
    type State;
    /// Its buffers, made anew from the state.
    type Scratch;

    /// The state at the start.
    fn start(&self) -> Self::State;

    /// Buffers for it.
    fn scratch(&self) -> Self::Scratch;

    /// Brings buffers in line with a state: where it is, and its next free motion unless that is there already.
    fn prepare(
        &self,
        _field: Field,
        _state: &Self::State,
        _scratch: &mut Self::Scratch,
        _predicted: bool,
    ) {
    }

    /// What the buffers remember of ticks before does not count any more.
    fn forget(&self, _scratch: &mut Self::Scratch) {}

    /// Predict: free motion of the tick that begins, without contact.
    fn predict(&self, _around: &Around<'_>, _state: &Self::State, _scratch: &mut Self::Scratch) {}

    /// Contacts: takes from the gaps of its rows what the contact forces of the last tick, with which its motion was
    /// predicted, move them.
    fn take_back(
        &self,
        _state: &Self::State,
        _scratch: &mut Self::Scratch,
        _rows: &mut RowSet,
        _solver: &mut Solver,
    ) {
    }

    /// Solve: adds to the matrix how forces on its rows move them.
    fn respond(&self, _state: &Self::State, _scratch: &Self::Scratch, _problem: &mut Problem<'_>) {}

    /// How far it gives way along a row's normal under a force of that row alone, m/N: from the party alone, beside
    /// the matrix.
    fn gives(
        &self,
        _state: &Self::State,
        _scratch: &Self::Scratch,
        _row: &Row,
        _problem: &mut Problem<'_>,
    ) -> f64 {
        0.0
    }

    /// Sweeps over the rows that it asks for, if more than `so_far`; `touched`: by one of them.
    fn sweeps(&self, _so_far: usize, _touched: &dyn Fn() -> bool) -> usize {
        0
    }

    /// Iterations of its step.
    fn iterations(&self) -> usize {
        1
    }

    /// Apply: takes the force of a row on the row's holder (N), if its step has more iterations than `iteration`.
    fn take(
        &self,
        _scratch: &mut Self::Scratch,
        _rows: &RowSet,
        _row: &Row,
        _push_n: Vector3,
        _iteration: usize,
    ) {
    }

    /// One more iteration of its step under what it took; its rows follow.
    fn correct(&self, _state: &Self::State, _scratch: &mut Self::Scratch, _rows: &mut RowSet) {}

    /// Goes where what it took leads, short of the end of its step; answers with the share of that motion that it can
    /// follow, at most 1.
    fn arrive(&self, _state: &Self::State, _scratch: &mut Self::Scratch) -> f64 {
        1.0
    }

    /// Asserts that it went where its response said.
    fn check_arrival(&self, _scratch: &Self::Scratch, _rows: &RowSet, _solver: &mut Solver) {}

    /// Where that takes a side of a row on it (its weights), m; `None` of what knows no such place.
    fn side_at(&self, _scratch: &Self::Scratch, _rows: &RowSet, _side: Range) -> Option<Point3> {
        None
    }

    /// Adds to `off`, by row, how far what that motion leaves of its own equation would move the row, m. `turned`: by
    /// row, what its force on the holder lacks, N.
    fn miss(
        &self,
        _state: &Self::State,
        _scratch: &mut Self::Scratch,
        _rows: &RowSet,
        _solver: &mut Solver,
        _turned: &[Vector3],
        _off: &mut [Vector3],
    ) {
    }

    /// Takes no more than a share of that motion, and of the forces.
    fn shorten(&self, _state: &Self::State, _scratch: &mut Self::Scratch, _share: f64) {}

    /// Deform: begins a step that is done elsewhere, or takes over one that was.
    fn hand_over(
        &self,
        _around: &Around<'_>,
        _state: &mut Self::State,
        _scratch: &mut Self::Scratch,
        _pipeline: &mut Option<Box<dyn Pipeline>>,
    ) {
    }

    /// Moves it under what it took. Where that led beyond reason it is set back, and says so.
    fn apply(
        &self,
        around: &Around<'_>,
        state: &mut Self::State,
        scratch: &mut Self::Scratch,
    ) -> Option<TickFault>;

    /// Has made elsewhere what its next steps need, and takes over what was.
    fn follow(
        &self,
        _state: &mut Self::State,
        _scratch: &mut Self::Scratch,
        _pipeline: &mut Option<Box<dyn Pipeline>>,
    ) {
    }

    /// Its free motion from where it is now.
    fn look_ahead(&self, _around: &Around<'_>, _state: &Self::State, _scratch: &mut Self::Scratch) {
    }

    /// A tick in which bodies do not move: what pressed it is forgotten.
    fn stand_still(&self, _field: Field, _state: &Self::State, _scratch: &mut Self::Scratch) {}

    /// It can sleep when it has been slow for a while.
    fn may_rest(&self) -> bool {
        false
    }

    /// Lets it sleep, or wakes it.
    fn leave_alone(
        &self,
        _around: &Around<'_>,
        _state: &mut Self::State,
        _scratch: &mut Self::Scratch,
        _leave: bool,
    ) {
    }

    /// Its net now, m.
    fn net(&self, state: &Self::State, out: &mut [Point3]);

    /// A point of it at rest, where it is now, m; of what deforms, as it was.
    fn carry(&self, _state: &Self::State, rest: &Point3) -> Point3 {
        *rest
    }

    /// Greatest speed of any of its points, m/s.
    fn speed_m_s(&self, _state: &Self::State) -> f64 {
        0.0
    }

    /// Its motion, momentum and energy, when it moves as a whole.
    fn motion(&self, _state: &Self::State) -> Option<RigidMotion> {
        None
    }

    /// By control point, how finely it resolves what presses it; empty where that is exact.
    fn resolution(&self) -> &[Resolution] {
        &[]
    }

    /// Its step does less than the scene asks for at this level of quality.
    fn is_degraded(&self, _level: u8, _scratch: &Self::Scratch) -> bool {
        false
    }

    /// Its step before it is taken, when it solves an equation of its own.
    fn begun(&self, _state: &Self::State, _scratch: &Self::Scratch) -> Option<Begun> {
        None
    }

    /// What that step left of its equation; `moved`: bodies moved in the tick.
    fn balance(&self, _begun: &Begun, _state: &Self::State, _moved: bool) -> Option<Ended> {
        None
    }

    /// Its step is being done elsewhere, is due, and is neither done nor put off.
    fn is_late(&self, _state: &Self::State, _pipeline: &mut dyn Pipeline) -> bool {
        false
    }
}

/// A body's step before it is taken.
pub(crate) struct Begun {
    /// The state before.
    pub before: DeformableState,
    /// What free points feel.
    pub field: Field,
    /// Name of its matrix, if it has one.
    pub matrix: Option<&'static str>,
    /// The fall-back that acts, if one does.
    pub fall_back: Option<FallBack>,
}

/// How it ended.
pub(crate) struct Ended {
    /// Norm of what is left of its equation, N; none where the tick ended no step.
    pub residual_n: Option<f64>,
    /// Norm of the contact forces, N.
    pub contact_n: f64,
    /// Where its energy went; none where the tick ended no step.
    pub energy: Option<Ledger>,
}
