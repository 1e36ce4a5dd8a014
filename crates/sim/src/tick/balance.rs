//! Contact, virtual couplings and bodies solved together.
//!
//! Rows of one tool share the compliance of its coupling, rows on one body that of its surface:
//! `D_ij = n_i · n_j ([same tool] / K' + Σ_sides ±± N_iᵀ W N_j)`, the sum over the sides of both
//! rows on the same body, each with the sign with which its normal pushes it. A tool that may turn
//! adds `(r_i × n_i) · (r_j × n_j) / K'_r` for two of its rows with arms r.
//!
//! A free rigid body adds to two of its rows what it gives way in a tick: dt² / m times the bracket's
//! signs, and by its turn dt² I⁻¹ (r_j × f_j) × r_i. With friction its turns about the three principal axes
//! are modes.
//!
//! With friction or grips, forces have three components and rows move each other by the bracket
//! alone, without n_i · n_j.

use super::{Warm, WarmRow};
use super::{dent, quality, stick};
use crate::body::Deformable;
use crate::party::{BodyScratch, Gives, ToolScratch, ToolState};
use crate::scene::{Body, BodyModel, Scene};
use crate::solve::cones::{self, ConeShare};
use crate::solve::friction::{FrictionLaw, Lever};
use crate::solve::hold::{Barrier, hold};
use crate::solve::rows::{Holder, Row, RowSet};
use crate::solve::sharing::{Share, share};
use crate::solve::solver::{MANY_ROWS, Solver, TURNS};
use palpate_geometry::math::Vector3;

/// Enough for a corner of three planes: rows on rigid bodies are few.
const RIGID_SWEEPS: usize = 50;
/// Rows of a tool that turns lean on each other through its arms.
const TURNING_SWEEPS: usize = 200;
/// Rows of a free body lean on each other through its mass: three and more carry it where one would.
const FREE_SWEEPS: usize = 200;
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
pub(super) struct Balance<'a> {
    pub scene: &'a Scene,
    pub tools: &'a [ToolState],
    pub warm: &'a Warm,
    pub quality: u8,
    pub tool_parts: &'a mut [ToolScratch],
    pub bodies: &'a mut [BodyScratch],
    pub rows: &'a mut RowSet,
    pub solver: &'a mut Solver,
}

impl Balance<'_> {
    /// Solves for the force of every row.
    pub(super) fn solve(&mut self) {
        let scene = self.scene;
        let count = self.rows.rows.len();
        self.solver.problem.begin(count);
        self.solver.friction.clear();
        if count == 0 {
            return;
        }
        let whole = self.is_whole();
        for i in 0..count {
            let a = self.rows.rows[i];
            let Some(tool) = a.tool() else { continue };
            let coupling = scene.tools[tool].coupling_for(&self.tools[tool].bounds);
            let (compliance, turning) = (
                coupling.compliance_m_n(),
                coupling.turning_compliance_rad_nm(),
            );
            let twist = a.arm.cross(&a.normal) * turning;
            for j in 0..count {
                let b = &self.rows.rows[j];
                if a.holder == b.holder {
                    let mut moved = compliance * direction(&a, b, whole);
                    if turning > 0.0 && !whole {
                        moved += twist.dot(&b.arm.cross(&b.normal));
                    }
                    self.solver.problem.row_mut(i)[j] = moved;
                }
            }
        }
        for (b, body) in scene.bodies.iter().enumerate() {
            if let BodyModel::Deforming(model) = &body.model {
                self.add_body_compliance(b, &model.deformable, whole);
                if !whole {
                    self.add_soft_modes(b, &model.deformable);
                }
            }
            if let Some(gives) = self.bodies[b].gives().copied() {
                self.add_free_body(b, &gives, whole);
            }
        }
        dent::settle(self.rows, self.solver);
        if !whole {
            self.add_indentations();
        }
        for i in 0..count {
            let own = self.solver.problem.entry(i, i);
            self.solver.problem.row_mut(i)[i] = own + own * self.rows.rows[i].ease;
        }
        self.solve_rows(Start::LastTick);
    }

    /// Solves once more, on the same compliance, after gaps have changed.
    pub(super) fn solve_again(&mut self) {
        if !self.rows.rows.is_empty() {
            self.solve_rows(Start::Here);
        }
    }

    /// Some force has three components, or there are so many rows on bodies with soft modes that these
    /// are better kept apart than added to the matrix.
    fn is_whole(&self) -> bool {
        let scene = self.scene;
        let rows = &self.rows.rows;
        let modes = |body: &Body| match &body.model {
            BodyModel::Deforming(model) => model.deformable.mode_count(),
            BodyModel::Rigid => 0,
        };
        rows.iter().any(|row| row.law != FrictionLaw::SMOOTH)
            || (rows.len() > MANY_ROWS && scene.bodies.iter().any(|body| modes(body) > 0))
    }

    /// How often a solve goes over its rows. They start with the forces of the last tick: under lower
    /// quality, what few sweeps leave is settled over some ticks.
    fn sweeps(&self, rows: &[Row]) -> usize {
        let scene = self.scene;
        let turns = scene.tools.iter().any(|tool| tool.coupling.turns());
        let rigid = match (rows.len(), turns) {
            _ if rows.iter().any(|row| is_on_free(scene, row)) => FREE_SWEEPS,
            (1, false) => 1,
            (_, false) => RIGID_SWEEPS,
            (_, true) => TURNING_SWEEPS,
        };
        let of_bodies = scene.bodies.iter().filter_map(|body| match &body.model {
            BodyModel::Deforming(model) => Some(model.sweeps),
            BodyModel::Rigid => None,
        });
        let full = of_bodies.fold(rigid, usize::max);
        if self.quality < quality::FEWER_SWEEPS {
            full
        } else {
            full.min((full / 4).max(LEAST_SWEEPS))
        }
    }

    fn solve_rows(&mut self, start: Start) {
        let scene = self.scene;
        if self.is_whole() {
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
        self.solver.problem.solve(self.sweeps(&self.rows.rows));
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
                    self.solver.friction.push(
                        &row.normal,
                        &free,
                        law,
                        &(row.normal * force_n + tangent_n),
                    );
                    if let Some(tool) = row
                        .tool()
                        .filter(|&tool| scene.tools[tool].coupling.turns())
                    {
                        let compliance_rad_nm =
                            scene.tools[tool].coupling.turning_compliance_rad_nm();
                        self.solver.friction.set_lever(&Lever {
                            tool,
                            arm: row.arm,
                            compliance_rad_nm,
                        });
                    }
                    self.give_modes(&row);
                }
                Start::Here => self.solver.friction.set_free(i, &free),
            }
        }
        self.solver
            .friction
            .solve(self.solver.problem.matrix(), self.sweeps(&self.rows.rows));
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

    /// Adds what a body's surface gives way under its rows.
    fn add_body_compliance(&mut self, body: usize, deformable: &Deformable, whole: bool) {
        let Self {
            rows,
            solver,
            bodies,
            ..
        } = self;
        let Solver {
            problem, delassus, ..
        } = solver;
        let Some(deforming) = &bodies[body].deforming else {
            return;
        };
        delassus.clear();
        for (i, row) in rows.rows.iter().enumerate() {
            for (sign, side) in row.sides_on(body) {
                let (controls, weights) = rows.weights_in(side);
                let moving = controls
                    .iter()
                    .zip(weights)
                    .filter_map(|(&control, &weight)| {
                        let coordinate = deformable.coordinate_of_control(control as usize);
                        Some((deformable.unknown(coordinate)?, coordinate, weight))
                    });
                delassus.add(i, sign, moving);
            }
        }
        delassus.respond(|coordinate| deformable.compliance_of(&deforming.deformable, coordinate));
        delassus.each_pair(|pair| {
            let [i, j] = pair.rows;
            let entry = pair.compliance * direction(&rows.rows[i], &rows.rows[j], whole);
            problem.row_mut(i)[j] += entry;
            if !pair.same {
                problem.row_mut(j)[i] += entry;
            }
        });
    }

    /// Adds how far balls go in beyond what nets show; where forces have three components, that is a mode.
    fn add_indentations(&mut self) {
        let Self { rows, solver, .. } = self;
        let Solver {
            problem,
            indentations,
            ..
        } = solver;
        for (i, a) in rows.rows.iter().enumerate() {
            let dent = &indentations[a.id.pair as usize];
            if dent.slope_m_n == 0.0 {
                continue;
            }
            let along = dent.slope_m_n * a.normal.dot(&dent.normal);
            for (j, b) in rows.rows.iter().enumerate() {
                if a.id.pair == b.id.pair {
                    problem.row_mut(i)[j] += along * b.normal.dot(&dent.normal);
                }
            }
        }
    }

    /// Adds what a free rigid body gives way; with friction only what it shifts, its turns are modes.
    fn add_free_body(&mut self, body: usize, gives: &Gives, whole: bool) {
        let Self { rows, solver, .. } = self;
        let (rows, problem) = (&rows.rows, &mut solver.problem);
        for (i, a) in rows.iter().enumerate() {
            for (sign_a, _) in a.sides_on(body) {
                let turn = match whole {
                    true => Vector3::zeros(),
                    false => gives.turned(&gives.arm(a).cross(&a.normal)),
                };
                for (j, b) in rows.iter().enumerate().take(i + 1) {
                    for (sign_b, _) in b.sides_on(body) {
                        let mut entry = gives.shift_m_n * direction(a, b, whole);
                        if !whole {
                            entry += turn.dot(&gives.arm(b).cross(&b.normal));
                        }
                        entry *= sign_a * sign_b;
                        problem.row_mut(i)[j] += entry;
                        if i != j {
                            problem.row_mut(j)[i] += entry;
                        }
                    }
                }
            }
        }
    }

    /// How each soft mode of a body moves a row, into the scratch; false if none does.
    pub(super) fn modes_of_row(&mut self, body: usize, deformable: &Deformable, row: &Row) -> bool {
        let Self {
            bodies,
            rows,
            solver,
            ..
        } = self;
        let mode_moves = &mut solver.mode_moves;
        let Some(deforming) = &bodies[body].deforming else {
            return false;
        };
        let moves = &mut mode_moves[..deformable.mode_count()];
        moves.fill(Vector3::zeros());
        let mut any = false;
        for (sign, side) in row.sides_on(body) {
            any = true;
            let (controls, weights) = rows.weights_in(side);
            for (&control, &weight) in controls.iter().zip(weights) {
                let coordinate = deformable.coordinate_of_control(control as usize);
                deformable.add_modes(&deforming.deformable, coordinate, sign * weight, moves);
            }
        }
        any
    }

    /// Adds what soft modes of a body move rows along their normals.
    fn add_soft_modes(&mut self, body: usize, deformable: &Deformable) {
        let (modes, count) = (deformable.mode_count(), self.rows.rows.len());
        if modes == 0 {
            return;
        }
        for i in 0..count {
            let row = self.rows.rows[i];
            let moved = self.modes_of_row(body, deformable, &row);
            let along = &mut self.solver.modes_along[i * modes..(i + 1) * modes];
            for (along, moves) in along.iter_mut().zip(&self.solver.mode_moves) {
                *along = if moved { moves.dot(&row.normal) } else { 0.0 };
            }
        }
        let gains = deformable.mode_gains();
        for i in 0..count {
            let first = &self.solver.modes_along[i * modes..(i + 1) * modes];
            for j in 0..=i {
                let second = &self.solver.modes_along[j * modes..(j + 1) * modes];
                let mut entry = 0.0;
                for ((a, b), gain) in first.iter().zip(second).zip(gains) {
                    entry += a * b * gain;
                }
                self.solver.problem.row_mut(i)[j] += entry;
                if i != j {
                    self.solver.problem.row_mut(j)[i] += entry;
                }
            }
        }
    }

    /// Gives the row just added to the friction problem the soft modes of its bodies, and the turns of free
    /// ones.
    fn give_modes(&mut self, row: &Row) {
        let scene = self.scene;
        let mut first = 0;
        for (b, body) in scene.bodies.iter().enumerate() {
            let BodyModel::Deforming(model) = &body.model else {
                if let Some(gives) = self.bodies[b].gives() {
                    for (sign, _) in row.sides_on(b) {
                        let moves = gives.moves(&gives.arm(row));
                        for (k, (moves, gain)) in moves.iter().zip(gives.turn_rad_nm).enumerate() {
                            self.solver
                                .friction
                                .add_turn(first + k, gain, &(moves * sign));
                        }
                    }
                    first += TURNS;
                }
                continue;
            };
            let deformable = &model.deformable;
            if deformable.mode_count() > 0 && self.modes_of_row(b, deformable, row) {
                let moves = self.solver.mode_moves.iter().zip(deformable.mode_gains());
                for (k, (moves, gain)) in moves.enumerate() {
                    self.solver.friction.add_mode(first + k, *gain, moves);
                }
            }
            first += deformable.mode_count();
        }
        let pair = row.id.pair as usize;
        let dent = &self.solver.indentations[pair];
        if dent.slope_m_n > 0.0 && !row.id.key.is_anchor() {
            self.solver
                .friction
                .add_mode(first + pair, dent.slope_m_n, &dent.normal);
        }
        self.solver.friction.bound_turns();
    }
}

/// One of its parties is a free rigid body.
fn is_on_free(scene: &Scene, row: &Row) -> bool {
    let holder = match row.holder {
        Holder::Body(other) => Some(other),
        Holder::Tool(_) => None,
    };
    let mut bodies = std::iter::once(row.body).chain(holder);
    bodies.any(|body| scene.bodies[body as usize].free().is_some())
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

/// How much a force of one row moves another, in terms of what their places give way.
fn direction(a: &Row, b: &Row, whole: bool) -> f64 {
    if whole { 1.0 } else { a.normal.dot(&b.normal) }
}
