//! Contact, virtual couplings and bodies solved together.
//!
//! What a force on one row does to another is the sum over all that both act on: a coupling gives way by 1 / K' and
//! turns by C (r_j × f_j) × r_i, a deforming body answers by its surface, a free rigid one gives way by
//! dt² / m and turns by dt² (I⁻¹ (r_j × f_j)) × r_i. Each adds its blocks to the matrix, with the signs with which
//! normals push bodies. Of rows without friction only what their normals see of it counts.

use crate::contact::warm::{Warm, WarmRow};
use crate::contact::{bounce, near_field, stick};
use crate::party::{BodyScratch, BodyState, Party as _, Problem, ToolScratch, ToolState};
use crate::scene::Scene;
use crate::solve::direct::{Change, Coupled};
use crate::solve::friction::FrictionLaw;
use crate::solve::hold::{Barrier, hold};
use crate::solve::indentation::Indentation;
use crate::solve::rows::{Holder, Row, RowSet};
use crate::solve::sharing::{Share, share};
use crate::solve::solver::Solver;
use crate::tick::quality;
use palpate_geometry::math::Vector3;

/// Sweeps in a scene without tools.
const SWEEPS: usize = 50;
/// Sweeps in which rows of free rigid bodies find out which of them carry and which slip.
const FREE_SWEEPS: usize = 30;
/// Fewest sweeps under lower quality, where there are as many.
const LEAST_SWEEPS: usize = 10;
/// Weight of a row that carries, relative to the depth that its force means to the coupling.
const LEAST_WEIGHT: f64 = 1e-3;

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
    /// Solves for the force of every row, from those of the last tick on.
    pub(crate) fn solve(&mut self) {
        let scene = self.scene;
        self.solver.problem.clear();
        self.solver.touching.clear();
        self.solver.indentations.fill(Indentation::default());
        let rows = self.rows.rows.iter();
        let rows = rows.map(|row| (row.normal, row.law.acts_across()));
        self.solver.matrix.begin(rows);
        self.solver.motions.begin(self.rows.rows.len());
        if self.rows.rows.is_empty() {
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
        near_field::settle(self.rows, self.solver);
        let Solver {
            matrix, impacts, ..
        } = &mut *self.solver;
        bounce::part(scene, &mut self.rows.rows, matrix, impacts);
        self.weigh_groups();
        for i in 0..self.rows.rows.len() {
            let row = self.rows.rows[i];
            let old = self.warm.of_row(row.id).copied().unwrap_or_default();
            let (law, warm_n) = (self.law(&row, &old), (old.force_n, old.tangent_n));
            match row.tool() {
                Some(_) => self.solver.matrix.regularize(i, row.regularization),
                None => self.ease_of_bodies(i),
            }
            (self.solver.problem).push(&row.normal, row.law.acts_across(), law, warm_n);
        }
        self.solve_again();
    }

    /// Lets a row between bodies give way more, by a share of what the heaviest body of its group would: a light one does
    /// not sink in under it.
    fn ease_of_bodies(&mut self, i: usize) {
        let row = &self.rows.rows[i];
        let heaviest_kg = giving(self.scene, row).map(|party| self.solver.heaviest_kg[party]);
        let heaviest_kg = heaviest_kg.fold(0.0, f64::max);
        if row.regularization == 0.0 || heaviest_kg == 0.0 {
            return;
        }
        let of_heaviest_m_n = self.scene.dt_s * self.scene.dt_s / heaviest_kg;
        let share = of_heaviest_m_n / self.solver.matrix.along(i);
        let regularization = row.regularization * share.min(1.0);
        self.rows.rows[i].regularization = regularization;
        self.solver.matrix.regularize(i, regularization);
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

    /// Solves from the forces there are on, on the same compliance, after gaps have changed.
    pub(crate) fn solve_again(&mut self) {
        let scene = self.scene;
        self.solver.sticks.clear();
        for i in 0..self.rows.rows.len() {
            let row = self.rows.rows[i];
            let (slip, stuck) = match row.law.acts_across() {
                true => {
                    let parts = &*self.tool_parts;
                    let touch = &self.solver.touches[row.id.pair as usize];
                    let old = (self.warm.of_row(row.id), touch);
                    stick::slip(scene, parts, self.bodies, self.rows, &row, old)
                }
                false => Default::default(),
            };
            self.solver.sticks.push(stuck);
            self.solver.problem.set_free(i, row.gap_m, &slip);
        }
        let sweeps = self.sweeps();
        let Solver {
            problem,
            matrix,
            motions,
            direct,
            heaviest_kg,
            ..
        } = &mut *self.solver;
        let any_free = heaviest_kg.iter().any(|kg| *kg > 0.0);
        let first = if any_free {
            sweeps.min(FREE_SWEEPS)
        } else {
            sweeps
        };
        problem.solve(matrix, first);
        direct.skip();
        let change = |i: usize| {
            let row = &self.rows.rows[i];
            let moves = giving(scene, row).any(|party| heaviest_kg[party] > 0.0);
            let free = |party: usize| scene.bodies.get(party).is_some_and(|b| b.free().is_some());
            let own = match giving(scene, row).all(free) {
                true => row.regularization / (1.0 + row.regularization),
                false => 0.0,
            };
            match moves {
                true => Change::Free { own },
                false => Change::Fixed,
            }
        };
        let coupled = Coupled { matrix, motions };
        if any_free && !direct.end(problem, coupled, change) {
            problem.solve(matrix, sweeps);
        }
        stick::settle(&self.rows.rows, self.solver);
        for tool in 0..scene.tools.len() {
            self.hold_by_rigid(tool);
            self.share_among_rigid(tool);
        }
    }

    /// Weighs the groups of bodies that touch and give way, of those with a free rigid body among them: by party the mass
    /// of the heaviest, 0 of others.
    fn weigh_groups(&mut self) {
        let (scene, rows) = (self.scene, &self.rows.rows);
        let heaviest_kg = &mut self.solver.heaviest_kg;
        heaviest_kg.fill(0.0);
        let mut any = false;
        for row in rows {
            for party in giving(scene, row) {
                if let Some(free) = scene.bodies.get(party).and_then(|body| body.free()) {
                    (heaviest_kg[party], any) = (free.mass.mass_kg, true);
                }
            }
        }
        let mut more = any;
        while std::mem::take(&mut more) {
            for row in rows {
                let most_kg = giving(scene, row).map(|party| heaviest_kg[party]);
                let most_kg = most_kg.fold(0.0, f64::max);
                for party in giving(scene, row).filter(|_| most_kg > 0.0) {
                    let own_kg = &mut heaviest_kg[party];
                    if *own_kg == 0.0 {
                        let soft = scene.bodies.get(party).and_then(|body| body.deforming());
                        *own_kg = soft.map_or(0.0, |soft| soft.deformable.mass_kg());
                        more = true;
                    }
                    if *own_kg < most_kg {
                        (*own_kg, more) = (most_kg, true);
                    }
                }
            }
        }
    }

    /// A row's law in this tick; `old`: the row in the last one.
    fn law(&self, row: &Row, old: &WarmRow) -> FrictionLaw {
        // The drag that rows come with is their pair's.
        let FrictionLaw::Push {
            mu,
            drag_n_m: viscous_n_s_m,
        } = row.law
        else {
            return row.law;
        };
        let pair = &self.scene.pairs[row.id.pair as usize];
        let kinetic = pair.friction.filter(|_| old.slips);
        FrictionLaw::Push {
            mu: kinetic.map_or(mu, |friction| friction.mu_kinetic),
            drag_n_m: match viscous_n_s_m > 0.0 {
                true => viscous_n_s_m / self.scene.dt_s * self.share_of_drag(row, old.force_n),
                false => 0.0,
            },
        }
    }

    /// A tool that only translates and smoothly touches nothing that gives way is held exactly.
    fn hold_by_rigid(&mut self, tool: usize) {
        let scene = self.scene;
        let Self { rows, solver, .. } = self;
        let Solver {
            problem,
            matrix,
            barriers,
            ..
        } = &mut **solver;
        let coupling = scene.tools[tool].coupling_for(&self.tools[tool].bounds);
        let is_held = |row: &Row| is_firm(scene, row) && !row.law.acts_across();
        if coupling.turns() || !of_tool(&rows.rows, tool).all(|(_, row)| is_held(row)) {
            return;
        }
        barriers.clear();
        barriers.extend(of_tool(&rows.rows, tool).map(|(_, row)| Barrier {
            normal: row.normal,
            depth_m: -row.gap_m,
            part_m: 0.0,
        }));
        if barriers.len() < 2 || !hold(barriers) {
            return;
        }
        let compliance = coupling.compliance_m_n();
        for ((i, row), barrier) in of_tool(&rows.rows, tool).zip(barriers) {
            problem.set_force(matrix, i, &(row.normal * (barrier.part_m / compliance)));
        }
    }

    /// Part of its pair's drag that a row has: as much as it carried of the pair's force in the last
    /// tick.
    fn share_of_drag(&self, row: &Row, force_n: f64) -> f64 {
        let warm = self.warm.of_pair(row.id.pair as usize).iter();
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

    /// Rows of a tool on bodies that do not give way share their force by depth; balance does not say
    /// how. A grip counts as deep as its part of the force means to the coupling.
    fn share_among_rigid(&mut self, tool: usize) {
        let scene = self.scene;
        let Self { rows, solver, .. } = self;
        let Solver {
            problem,
            matrix,
            shares,
            ..
        } = &mut **solver;
        let coupling = scene.tools[tool].coupling_for(&self.tools[tool].bounds);
        if coupling.turns() {
            // Moments count: the solve has shared.
            return;
        }
        let rigid = || of_tool(&rows.rows, tool).filter(|(_, row)| is_firm(scene, row));
        let compliance = coupling.compliance_m_n();
        let total: Vector3 = rigid().map(|(i, _)| problem.force_n(i)).sum();
        let count = rigid().count();
        shares.clear();
        shares.extend(rigid().map(|(i, row)| {
            let (mut law, normal_n) = (problem.law(i), problem.normal_n(i));
            let weight_m = match &mut law {
                FrictionLaw::Push { mu, drag_n_m } => {
                    if *drag_n_m > 0.0 && normal_n > 0.0 {
                        // Drag goes beyond the cone; it is shared as if the cone held it.
                        *mu = mu.max(problem.tangent_n(i).norm() / normal_n);
                    }
                    // What carries has some weight, even where the device is not below that contact itself.
                    (-row.gap_m).clamp(0.0, row.counts_m) + LEAST_WEIGHT * compliance * normal_n
                }
                FrictionLaw::Grip { .. } => compliance * total.norm() / count as f64,
            };
            Share {
                normal: row.normal,
                law,
                weight_m,
                force_n: problem.force_n(i),
            }
        }));
        if count > 1 && share(shares) {
            for ((i, _), share) in rigid().zip(shares.iter()) {
                problem.set_force(matrix, i, &share.force_n);
            }
        }
    }
}

/// What of a row's parties gives way: bodies by their number, tools by theirs after all bodies.
fn giving(scene: &Scene, row: &Row) -> impl Iterator<Item = usize> + use<> {
    let body = row.body as usize;
    let holder = match row.holder {
        Holder::Body(other) => other as usize,
        Holder::Tool(tool) => scene.bodies.len() + tool as usize,
    };
    let gives = |party: usize| scene.bodies.get(party).is_none_or(|body| !body.is_firm());
    [body, holder]
        .map(|party| gives(party).then_some(party))
        .into_iter()
        .flatten()
}

/// Rows of a tool.
fn of_tool(rows: &[Row], tool: usize) -> impl Iterator<Item = (usize, &Row)> {
    let own = move |(_, row): &(usize, &Row)| row.tool() == Some(tool);
    rows.iter().enumerate().filter(own)
}

/// Its body does not give way.
fn is_firm(scene: &Scene, row: &Row) -> bool {
    scene.bodies[row.body as usize].is_firm()
}
