//! A tool on its virtual coupling: free motion takes it to its device, contact holds it back.

use super::contract::{Around, Party, Problem};
use super::tool::{ToolScratch, ToolState};
use crate::haptics::{Coupling, DeviceBounds, Link, Port, RenderedForce, limit};
use crate::scene::{Scene, Tool};
use crate::solve::friction::FrictionLaw;
use crate::solve::grip::GripState;
use crate::solve::rows::{Row, RowSet};
use crate::solve::solver::Solver;
use crate::tick::record::TickFault;
use palpate_geometry::contact::dispatch::Method;
use palpate_geometry::math::{Matrix3, Point3, Pose, Vector3, rotation_by};

/// Enough for a corner of three planes: rows on rigid bodies are few.
const SWEEPS: usize = 50;
/// Rows of a tool that turns lean on each other through its arms.
const TURNING_SWEEPS: usize = 200;

/// A tool.
pub(crate) struct OnCoupling<'a> {
    pub scene: &'a Scene,
    pub index: usize,
    pub tool: &'a Tool,
}

impl Party for OnCoupling<'_> {
    type State = ToolState;
    type Scratch = ToolScratch;

    fn start(&self) -> ToolState {
        let mut link = Link::default();
        (link.pose.position, link.pose.orientation) = self.tool.start;
        let (proxy, orientation) = self.tool.start;
        ToolState {
            link,
            proxy,
            orientation,
            port: Port::default(),
            bounds: DeviceBounds::default(),
            grip: GripState::default(),
        }
    }

    fn scratch(&self) -> ToolScratch {
        ToolScratch::default()
    }

    fn predict(&self, _: &Around<'_>, state: &ToolState, scratch: &mut ToolScratch) {
        let (link, coupling) = (&state.link, self.coupling(state));
        scratch.free = coupling.free_position(&link.pose.position, &link.velocity(), &state.proxy);
        scratch.proxy = scratch.free;
        scratch.free_turn = coupling.free_orientation(
            &link.pose.orientation,
            &link.angular_velocity(),
            &state.orientation,
        );
    }

    fn respond(&self, state: &ToolState, _: &ToolScratch, problem: &mut Problem<'_>) {
        let Problem { rows, solver } = problem;
        let coupling = self.coupling(state);
        for (i, a) in self.own(rows) {
            for (j, b) in self.own(rows).take_while(|(j, _)| *j <= i) {
                let m_per_n = coupling.compliance_m_n();
                solver.matrix.add_isotropic(i, j, m_per_n);
                if coupling.turns() {
                    solver.matrix.add(i, j, &by_turn(&coupling, a, b));
                }
            }
        }
    }

    fn gives(&self, state: &ToolState, _: &ToolScratch, row: &Row, _: &mut Problem<'_>) -> f64 {
        if row.tool() != Some(self.index) {
            return 0.0;
        }
        let coupling = self.coupling(state);
        let turning = by_turn(&coupling, row, row) * row.normal;
        coupling.compliance_m_n() + row.normal.dot(&turning)
    }

    fn sweeps(&self, _: usize, _: &dyn Fn() -> bool) -> usize {
        match self.tool.coupling.turns() {
            true => TURNING_SWEEPS,
            false => SWEEPS,
        }
    }

    /// Where the forces that it [weighed](OnCoupling::weigh) hold it.
    fn apply(
        &self,
        _: &Around<'_>,
        state: &mut ToolState,
        scratch: &mut ToolScratch,
    ) -> Option<TickFault> {
        let coupling = self.coupling(state);
        scratch.held = scratch.free + scratch.force_n * coupling.compliance_m_n();
        let turn = scratch.torque_nm * coupling.turning_compliance_rad_nm();
        // A saturated coupling lets the device in further than the balance knows: a ball then stays
        // on the surface as it stands; other shapes see at the next tick how far they are in. A grip holds it
        // where it is whatever the device bears.
        let whole = scratch.borne == 1.0 || !self.is_guarded() || state.grip.holds();
        state.proxy = match whole && scratch.held.iter().all(|x| x.is_finite()) {
            true => scratch.held,
            false => scratch.proxy,
        };
        state.orientation = match coupling.turns() && turn.iter().all(|x| x.is_finite()) {
            true => rotation_by(&turn) * scratch.free_turn,
            false => scratch.free_turn,
        };
        let wrench = scratch.force_n.iter().chain(&scratch.torque_nm);
        let finite = wrench.into_iter().all(|x| x.is_finite());
        (!finite).then_some(TickFault::NotFinite)
    }

    fn net(&self, _: &ToolState, _: &mut [Point3]) {}
}

impl OnCoupling<'_> {
    fn coupling(&self, state: &ToolState) -> Coupling {
        self.tool.coupling_for(&state.bounds)
    }

    fn own<'r>(&self, rows: &'r RowSet) -> impl Iterator<Item = (usize, &'r Row)> + use<'r> {
        let index = self.index;
        let rows = rows.rows.iter().enumerate();
        rows.filter(move |(_, row)| row.tool() == Some(index))
    }

    /// A ball whose every pair keeps its proxy on the exact surface.
    fn is_guarded(&self) -> bool {
        let mut own = (self.scene.pairs.iter()).filter(|pair| pair.tool() == Some(self.index));
        self.tool.shape.ball_radius_m().is_some() && own.all(|pair| pair.method == Method::Exact)
    }

    /// Where the forces that it [weighed](OnCoupling::weigh) take it.
    pub(crate) fn pose_held(&self, state: &ToolState, scratch: &ToolScratch) -> Pose {
        let coupling = self.coupling(state);
        let held = scratch.free + scratch.force_n * coupling.compliance_m_n();
        let turn = scratch.torque_nm * coupling.turning_compliance_rad_nm();
        let rotation = match coupling.turns() {
            true => rotation_by(&turn) * scratch.free_turn,
            false => scratch.free_turn,
        };
        Pose::from_parts(held.coords.into(), rotation)
    }

    /// Sums its rows' forces, and finds what share of them its device bears.
    pub(crate) fn weigh(
        &self,
        state: &ToolState,
        scratch: &mut ToolScratch,
        rows: &RowSet,
        solver: &Solver,
    ) -> RenderedForce {
        (scratch.force_n, scratch.torque_nm) = self.wrench(state, &scratch.free, rows, solver);
        let limit_nm = torque_limit_nm(self.tool, state);
        let (rendered, borne) = limit(
            scratch.force_n,
            scratch.torque_nm,
            state.link.limit_n,
            limit_nm,
        );
        scratch.borne = borne;
        rendered
    }

    /// Force (N) and torque (N·m) of the rows about its reference point; `free`: where free motion takes it. Drag on a
    /// ball turns it about its centre; what presses it does not.
    fn wrench(
        &self,
        state: &ToolState,
        free: &Point3,
        rows: &RowSet,
        solver: &Solver,
    ) -> (Vector3, Vector3) {
        let force: Vector3 = self.own(rows).map(|(i, _)| solver.force_n(i)).sum();
        let coupling = self.coupling(state);
        if coupling.turns() {
            let torques = self
                .own(rows)
                .map(|(i, row)| row.arm.cross(&solver.force_n(i)));
            return (force, torques.sum());
        }
        let ball = self.tool.shape.ball_radius_m().is_some();
        let held: Point3 = free + force * coupling.compliance_m_n();
        let centre = if ball { held } else { *free };
        let turns = |i: usize, row: &Row| match row.law {
            FrictionLaw::Push { .. } if ball => solver.problem.tangent_n(i),
            _ => solver.force_n(i),
        };
        let torques = self
            .own(rows)
            .map(|(i, row)| (row.point - centre).cross(&turns(i, row)));
        (force, torques.sum())
    }
}

/// What a force at one row of a tool does at another by turning the tool: C (r_b × f) × r_a.
fn by_turn(coupling: &Coupling, a: &Row, b: &Row) -> Matrix3 {
    let outer = b.arm * a.arm.transpose();
    (Matrix3::from_diagonal_element(outer.trace()) - outer) * coupling.turning_compliance_rad_nm()
}

/// What torque the device bears now, N·m: it ramps as its force does.
pub(crate) fn torque_limit_nm(tool: &Tool, state: &ToolState) -> f64 {
    let force_max_n = tool.limits.force_max_n.min(state.bounds.force_max_n);
    let most = tool.device.torque_max_nm.min(state.bounds.torque_max_nm);
    // Infinity times zero is not a number.
    if state.link.limit_n >= force_max_n {
        most
    } else {
        most.min(f64::MAX) * (state.link.limit_n / force_max_n)
    }
}
