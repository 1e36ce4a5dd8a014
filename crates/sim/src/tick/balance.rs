//! Contact, virtual couplings and bodies solved together.
//!
//! What a force on one row does to another is the sum over all that both act on: a coupling gives way by 1 / K' and
//! turns by C (r_j × f_j) × r_i, a deforming body answers by its surface, a free rigid one gives way by
//! dt² / m and turns by dt² (I⁻¹ (r_j × f_j)) × r_i. Each adds its blocks to the matrix, with the signs with which
//! normals push bodies. Without friction and grips only what the normals see of them counts.

use crate::contact::warm::{Warm, WarmRow};
use crate::contact::{dent, stick};
use crate::party::{BodyScratch, BodyState, Party as _, Problem, ToolScratch, ToolState};
use crate::scene::Scene;
use crate::solve::cones::{self, ConeShare};
use crate::solve::friction::FrictionLaw;
use crate::solve::hold::{Barrier, hold};
use crate::solve::rows::{Row, RowSet};
use crate::solve::sharing::{Share, share};
use crate::solve::solver::Solver;
use crate::tick::quality;
use palpate_geometry::math::Vector3;

/// Sweeps in a scene without tools.
const SWEEPS: usize = 50;
/// Fewest sweeps under lower quality, where there are as many.
const LEAST_SWEEPS: usize = 10;
/// Weight of a row that carries, relative to the depth that its force means to the coupling.
const LEAST_WEIGHT: f64 = 1e-3;

/// Where a solve starts.
#[derive(Clone, Copy, PartialEq)]
enum Start {
    /// With the forces of the last tick.
    LastTick,
    /// With those there are.
    Here,
}

/// What the contact forces of a tick depend on.
pub(crate) struct Balance<'a> {
    pub scene: &'a Scene,
    pub tools: &'a [ToolState],
    pub states: &'a [BodyState],
    pub warm: &'a Warm,
    pub quality: u8,
    pub tool_parts: &'a mut [ToolScratch],
    pub bodies: &'a mut [BodyScratch],
    pub rows: &'a mut RowSet,
    pub solver: &'a mut Solver,
}

impl Balance<'_> {
    /// Solves for the force of every row.
    pub(crate) fn solve(&mut self) {
        let scene = self.scene;
        let count = self.rows.rows.len();
        let whole = self.is_whole();
        self.solver.problem.begin(count);
        self.solver.friction.clear();
        let normals = self.rows.rows.iter().map(|row| row.normal);
        self.solver.matrix.begin(normals, whole);
        if count == 0 {
            return;
        }
        let Self {
            rows,
            solver,
            tool_parts,
            bodies,
            ..
        } = self;
        let problem = &mut Problem { rows, solver };
        for (t, tool) in scene.tool_parties().enumerate() {
            tool.respond(&self.tools[t], &tool_parts[t], problem);
        }
        for (b, body) in scene.parties().enumerate() {
            body.respond(&self.states[b], &bodies[b], problem);
        }
        dent::settle(self.rows, self.solver);
        for (i, row) in self.rows.rows.iter().enumerate() {
            self.solver.matrix.ease(i, row.ease);
        }
        self.solve_rows(Start::LastTick);
    }

    /// Solves once more, on the same compliance, after gaps have changed.
    pub(crate) fn solve_again(&mut self) {
        if !self.rows.rows.is_empty() {
            self.solve_rows(Start::Here);
        }
    }

    /// Some force has three components.
    fn is_whole(&self) -> bool {
        let mut rows = self.rows.rows.iter();
        rows.any(|row| row.law != FrictionLaw::SMOOTH)
    }

    /// How often a solve goes over its rows. They start with the forces of the last tick: under lower
    /// quality, what few sweeps leave is settled over some ticks.
    fn sweeps(&self) -> usize {
        let (scene, rows) = (self.scene, &self.rows.rows);
        let touched = |b: usize| rows.iter().any(|row| row.sides_on(b).next().is_some());
        let alone = rows.len() == 1 && !scene.tools.iter().any(|tool| tool.coupling.turns());
        let of_tools = scene.tool_parties().map(|tool| tool.sweeps(0, &|| true));
        let of_tools = of_tools.max().unwrap_or(SWEEPS);
        let mut full = if alone { 1 } else { of_tools };
        for (b, body) in scene.parties().enumerate() {
            full = full.max(body.sweeps(full, &|| touched(b)));
        }
        if self.quality < quality::FEWER_SWEEPS {
            full
        } else {
            full.min((full / 4).max(LEAST_SWEEPS))
        }
    }

    fn solve_rows(&mut self, start: Start) {
        let scene = self.scene;
        if self.solver.is_whole() {
            return self.solve_whole(start);
        }
        let mut warm = self.warm.rows().iter().peekable();
        for (i, row) in self.rows.rows.iter().enumerate() {
            // Both lists are ordered by it.
            while warm.next_if(|old| old.id < row.id).is_some() {}
            let old = warm.next_if(|old| old.id == row.id);
            let force = match start {
                Start::LastTick => old.map_or(0.0, |old| old.force_n),
                Start::Here => self.solver.problem.forces()[i],
            };
            self.solver.problem.set(i, row.gap_m, force);
        }
        let sweeps = self.sweeps();
        let Solver {
            problem, matrix, ..
        } = &mut *self.solver;
        problem.solve(matrix, sweeps);
        for tool in 0..scene.tools.len() {
            self.hold_by_rigid(tool);
            self.share_among_rigid(tool);
        }
    }

    /// A tool that only translates and touches nothing that gives way is held exactly.
    fn hold_by_rigid(&mut self, tool: usize) {
        let scene = self.scene;
        let Self { rows, solver, .. } = self;
        let Solver {
            problem, barriers, ..
        } = solver;
        let coupling = scene.tools[tool].coupling_for(&self.tools[tool].bounds);
        let own = |row: &&Row| row.tool() == Some(tool);
        let is_firm = |row: &Row| scene.bodies[row.body as usize].is_firm();
        if coupling.turns() || !rows.rows.iter().filter(own).all(is_firm) {
            return;
        }
        barriers.clear();
        barriers.extend(rows.rows.iter().filter(own).map(|row| Barrier {
            normal: row.normal,
            depth_m: -row.gap_m,
            part_m: 0.0,
        }));
        if barriers.len() < 2 || !hold(barriers) {
            return;
        }
        let compliance = coupling.compliance_m_n();
        let indices = (0..rows.rows.len()).filter(|&i| own(&&rows.rows[i]));
        for (i, barrier) in indices.zip(barriers.iter()) {
            problem.set_force(i, barrier.part_m / compliance);
        }
    }

    /// Solves for forces of three components.
    fn solve_whole(&mut self, start: Start) {
        let scene = self.scene;
        let count = self.rows.rows.len();
        self.solver.sticks.clear();
        let mut warm = self.warm.rows().iter().peekable();
        for i in 0..count {
            let row = self.rows.rows[i];
            // Both lists are ordered by it.
            while warm.next_if(|old| old.id < row.id).is_some() {}
            let old = warm.next_if(|old| old.id == row.id);
            let WarmRow {
                force_n,
                tangent_n,
                slips,
                ..
            } = old.copied().unwrap_or_default();
            let (slip, stuck) =
                stick::slip(scene, self.tool_parts, self.bodies, self.rows, &row, old);
            self.solver.sticks.push(stuck);
            let (law, free) = match row.law {
                FrictionLaw::Push {
                    mu,
                    drag_n_m: viscous_n_s_m,
                } => {
                    let pair = scene.pairs[row.id.pair as usize].friction.filter(|_| slips);
                    let free = slip + row.normal * (row.gap_m - slip.dot(&row.normal));
                    let drag_n_m = match viscous_n_s_m > 0.0 {
                        true => viscous_n_s_m / scene.dt_s * self.share_of_drag(&row, force_n),
                        false => 0.0,
                    };
                    (
                        FrictionLaw::Push {
                            mu: pair.map_or(mu, |friction| friction.mu_kinetic),
                            drag_n_m,
                        },
                        free,
                    )
                }
                grip => (grip, row.slip),
            };
            match start {
                Start::LastTick => {
                    let warm_n = row.normal * force_n + tangent_n;
                    self.solver.friction.push(&row.normal, &free, law, &warm_n);
                }
                Start::Here => self.solver.friction.set_free(i, &free),
            }
        }
        let sweeps = self.sweeps();
        let Solver {
            friction, matrix, ..
        } = &mut *self.solver;
        friction.solve(matrix, sweeps);
        for tool in 0..scene.tools.len() {
            self.share_whole_among_rigid(tool);
        }
        for i in 0..count {
            self.solver
                .problem
                .set_force(i, self.solver.friction.normal_n(i));
        }
    }

    /// Part of its pair's drag that a row has: as much as it carried of the pair's force in the last
    /// tick.
    fn share_of_drag(&self, row: &Row, force_n: f64) -> f64 {
        let warm = self.warm.of_pair(row.id.pair as usize);
        let whole: f64 = warm.map(|old| old.force_n.max(0.0)).sum();
        if whole > 0.0 {
            return force_n.max(0.0) / whole;
        }
        // It has just come to touch.
        1.0 / self
            .rows
            .rows
            .iter()
            .filter(|other| other.id.pair == row.id.pair)
            .count() as f64
    }

    /// [`share_among_rigid`] with friction and grips. A grip counts as deep as its part of the force
    /// means to the coupling.
    fn share_whole_among_rigid(&mut self, tool: usize) {
        let scene = self.scene;
        let Self { rows, solver, .. } = self;
        let Solver {
            friction, cones, ..
        } = solver;
        let coupling = scene.tools[tool].coupling_for(&self.tools[tool].bounds);
        if coupling.turns() {
            return;
        }
        let compliance = coupling.compliance_m_n();
        cones.clear();
        let total: Vector3 = rigid_rows(scene, &rows.rows, tool)
            .map(|(i, _)| friction.force_n(i))
            .sum();
        let count = rigid_rows(scene, &rows.rows, tool).count() as f64;
        for (i, row) in rigid_rows(scene, &rows.rows, tool) {
            let (mut law, force_n) = (friction.law(i), friction.force_n(i));
            if let FrictionLaw::Push { mu, drag_n_m } = &mut law
                && *drag_n_m > 0.0
                && friction.normal_n(i) > 0.0
            {
                // Drag goes beyond the cone; it is shared as if the cone held it.
                *mu = mu.max(friction.tangent_n(i).norm() / friction.normal_n(i));
            }
            let weight_m = match law {
                FrictionLaw::Push { .. } => {
                    (-row.gap_m).clamp(0.0, row.counts_m)
                        + LEAST_WEIGHT * compliance * friction.normal_n(i)
                }
                FrictionLaw::Grip { .. } => compliance * total.norm() / count,
            };
            cones.push(ConeShare {
                normal: row.normal,
                law,
                weight_m,
                force_n,
            });
        }
        if cones.len() > 1 && cones::share(cones) {
            for ((i, _), share) in rigid_rows(scene, &rows.rows, tool).zip(cones.iter()) {
                friction.set_force(i, &share.force_n);
            }
        }
    }

    /// Rows of a tool on bodies that do not give way share their force by depth; balance does not say
    /// how.
    fn share_among_rigid(&mut self, tool: usize) {
        let scene = self.scene;
        let Self { rows, solver, .. } = self;
        let Solver {
            problem, shares, ..
        } = solver;
        let coupling = scene.tools[tool].coupling_for(&self.tools[tool].bounds);
        if coupling.turns() {
            // Moments count: the solve has shared.
            return;
        }
        let compliance = coupling.compliance_m_n();
        let rigid =
            |row: &Row| row.tool() == Some(tool) && scene.bodies[row.body as usize].is_firm();
        shares.clear();
        for (i, row) in rows.rows.iter().enumerate().filter(|(_, row)| rigid(row)) {
            let force_n = problem.forces()[i];
            // What carries has some weight, even where the device is not below that contact itself.
            let weight_m =
                (-row.gap_m).clamp(0.0, row.counts_m) + LEAST_WEIGHT * compliance * force_n;
            shares.push(Share {
                normal: row.normal,
                weight_m,
                force_n,
            });
        }
        if shares.len() > 1 && share(shares) {
            let indices = rows
                .rows
                .iter()
                .enumerate()
                .filter(|(_, row)| rigid(row))
                .map(|(i, _)| i);
            for (i, share) in indices.zip(shares.iter()) {
                problem.set_force(i, share.force_n);
            }
        }
    }
}

/// Rows of a tool on bodies that do not give way.
fn rigid_rows<'a>(
    scene: &'a Scene,
    rows: &'a [Row],
    tool: usize,
) -> impl Iterator<Item = (usize, &'a Row)> {
    let rigid = |row: &Row| scene.bodies[row.body as usize].is_firm();
    rows.iter()
        .enumerate()
        .filter(move |(_, row)| row.tool() == Some(tool) && rigid(row))
}
