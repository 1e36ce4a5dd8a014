//! A spring lattice and its implicit step.
//!
//! Backward Euler by projective dynamics (Bouaziz et al. 2014) with one constant matrix
//! `A = M / dt² + (1 + d / dt) L`, `L = Σ k (e_a − e_b)(e_a − e_b)ᵀ`, factored at build. We solve for increments,
//! `A Δ = M (v / dt + g) + f(x)`, so that rest is rest to the last bit and an error is relative to the motion, not to the
//! position. Contact acts through the compliance `W = A⁻¹` of the surface's nodes, whose columns are kept.

use super::cells::{CellGrid, CellQuality};
use super::springs::{self, Spring};
use crate::math::{
    Cholesky, CholeskyError, Lane, Point3, StateError, StateSink, StateSource, SymmetricTriplets, Vector3, simd,
};

/// What a body is made of, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// E, Pa.
    pub young_pa: f64,
    /// ρ, kg/m³.
    pub density_kg_m3: f64,
    /// d, s: a strain rate adds the stress of a strain of `d` times itself.
    pub damping_s: f64,
}

/// How a body steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSettings {
    /// dt, s.
    pub dt_s: f64,
    /// Local–global iterations, ≥ 1.
    pub iterations: usize,
    /// m/s².
    pub gravity: Vector3,
}

/// Why a lattice could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LatticeError {
    /// A cell without volume.
    #[error("{count} of {total} cells have no volume; the surface is too thin there or folded")]
    FlatCells {
        /// How many.
        count: usize,
        /// Of how many.
        total: usize,
    },
    /// Every node is fixed.
    #[error("all {0} nodes are fixed: nothing can deform; use model = \"rigid\" or fix fewer nodes")]
    AllFixed(usize),
    /// The matrix of the step could not be factored.
    #[error("the matrix of the implicit step has no factor: {0}")]
    Factor(#[from] CholeskyError),
}

const FIXED: u32 = u32::MAX;

/// The constant of a lattice body.
#[derive(Debug)]
pub struct Lattice {
    settings: StepSettings,
    damping_s: f64,
    /// (node_count).
    rest: Vec<Point3>,
    /// (node_count), kg.
    masses: Vec<f64>,
    springs: SpringTable,
    /// (node_count): row of the factor, or FIXED.
    unknown: Vec<u32>,
    /// (unknown_count): node of each row.
    node_of_unknown: Vec<u32>,
    factor: Cholesky,
    /// (control points): node of each control point.
    node_of_control: Vec<u32>,
    /// (node_count): column of `compliance`, or FIXED.
    surface_index: Vec<u32>,
    /// (surface_count × unknown_count): A⁻¹ e_s, row by row, m/N within one tick.
    compliance: Vec<f64>,
    quality: CellQuality,
}

/// Springs by field, so that the pass over them runs along contiguous memory.
#[derive(Debug, Default)]
struct SpringTable {
    a: Vec<u32>,
    b: Vec<u32>,
    stiffness: Vec<f64>,
    rest_length: Vec<f64>,
}

impl SpringTable {
    /// In blocks: differences are gathered, forces computed side by side, then added in the springs' order.
    #[inline(always)]
    fn add_forces(&self, places: &[Lane], residual: &mut [Lane]) {
        const BLOCK: usize = 8;
        let count = self.a.len();
        let whole = count / BLOCK * BLOCK;
        for start in (0..whole).step_by(BLOCK) {
            self.add_block::<BLOCK>(start, places, residual);
        }
        for spring in whole..count {
            self.add_block::<1>(spring, places, residual);
        }
    }

    #[inline(always)]
    fn add_block<const N: usize>(&self, start: usize, places: &[Lane], residual: &mut [Lane]) {
        let (a, b) = (&self.a[start..start + N], &self.b[start..start + N]);
        let (k, rest) = (&self.stiffness[start..start + N], &self.rest_length[start..start + N]);
        let mut d = [[0.0; 4]; N];
        let mut squared = [0.0; N];
        for i in 0..N {
            let (from, to) = (&places[a[i] as usize], &places[b[i] as usize]);
            for c in 0..4 {
                d[i][c] = to[c] - from[c];
            }
            squared[i] = d[i][0] * d[i][0] + d[i][1] * d[i][1] + d[i][2] * d[i][2];
        }
        let mut pull = [0.0; N];
        for i in 0..N {
            let length = squared[i].sqrt();
            pull[i] = if length > 0.0 { k[i] * (1.0 - rest[i] / length) } else { 0.0 };
        }
        for i in 0..N {
            let force = d[i].map(|x| x * pull[i]);
            let near = &mut residual[a[i] as usize];
            for c in 0..4 {
                near[c] += force[c];
            }
            let far = &mut residual[b[i] as usize];
            for c in 0..4 {
                far[c] -= force[c];
            }
        }
    }
}

/// The same code with 256-bit registers; no fused multiply-add, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_forces_avx2(springs: &SpringTable, places: &[Lane], residual: &mut [Lane]) {
    springs.add_forces(places, residual);
}

/// What a replay restores of a lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct LatticeState {
    /// (node_count), m.
    pub positions: Vec<Point3>,
    /// (node_count), m/s.
    pub velocities: Vec<Vector3>,
}

/// Buffers of a lattice's step.
#[derive(Clone, Debug)]
pub struct LatticeScratch {
    /// (node_count): x*, the next free motion, by [`Lattice::predict`].
    pub predicted: Vec<Point3>,
    /// (node_count): contact forces, by the caller, cleared by [`Lattice::advance`].
    forces: Vec<Vector3>,
    /// Surface nodes with a force, in the order they were given, and whether a node is among them.
    loaded: Vec<u32>,
    is_loaded: Vec<bool>,
    /// (node_count), x y z 0.
    places: Vec<Lane>,
    residual: Vec<Lane>,
    increment: Vec<Vector3>,
    /// (unknown_count).
    rhs: Vec<Vector3>,
    lanes: Vec<Lane>,
}

impl Lattice {
    /// Builds springs, masses, factor and compliance. `enclosed_volume_m3` is the surface's own volume (the control
    /// polyhedron is larger): it sets the mass. `fixed[node]` nodes never move.
    ///
    /// # Errors
    /// Cells without volume, no free node, or a matrix without factor.
    pub fn new(
        grid: &CellGrid,
        material: &Material,
        enclosed_volume_m3: f64,
        fixed: &[bool],
        settings: StepSettings,
    ) -> Result<Self, LatticeError> {
        let quality = grid.quality();
        let node_count = grid.nodes.len();
        let mean = quality.volume_m3 / grid.cells.len() as f64;
        let flat = grid.cells.iter().filter(|cell| grid.volume(cell) <= 1e-9 * mean).count();
        if flat > 0 {
            return Err(LatticeError::FlatCells { count: flat, total: grid.cells.len() });
        }
        let mut masses = vec![0.0; node_count];
        let scale = material.density_kg_m3 * enclosed_volume_m3 / quality.volume_m3;
        for cell in &grid.cells {
            let share = grid.volume(cell) * scale / 8.0;
            for &node in cell {
                masses[node as usize] += share;
            }
        }
        let springs = springs::from_cells(grid, material.young_pa);
        let mut unknown = vec![FIXED; node_count];
        let mut node_of_unknown = Vec::new();
        for node in 0..node_count {
            if !fixed[node] {
                unknown[node] = node_of_unknown.len() as u32;
                node_of_unknown.push(node as u32);
            }
        }
        if node_of_unknown.is_empty() {
            return Err(LatticeError::AllFixed(node_count));
        }
        let matrix = step_matrix(&masses, &springs, &unknown, &node_of_unknown, material, &settings);
        let factor = Cholesky::new(&matrix)?;
        let (surface_index, compliance) = compliance(&factor, &grid.node_of_control, &unknown, node_count);
        Ok(Self {
            settings,
            damping_s: material.damping_s,
            rest: grid.nodes.clone(),
            masses,
            springs: SpringTable {
                a: springs.iter().map(|s| s.a).collect(),
                b: springs.iter().map(|s| s.b).collect(),
                stiffness: springs.iter().map(|s| s.stiffness_n_m).collect(),
                rest_length: springs.iter().map(|s| s.rest_length_m).collect(),
            },
            unknown,
            node_of_unknown,
            factor,
            node_of_control: grid.node_of_control.clone(),
            surface_index,
            compliance,
            quality,
        })
    }

    /// Nodes.
    pub fn node_count(&self) -> usize {
        self.rest.len()
    }

    /// Nodes that can move.
    pub fn unknown_count(&self) -> usize {
        self.node_of_unknown.len()
    }

    /// Springs.
    pub fn spring_count(&self) -> usize {
        self.springs.a.len()
    }

    /// Non-zeros of the factor.
    pub fn factor_non_zeros(&self) -> usize {
        self.factor.non_zeros()
    }

    /// Bytes of the compliance columns.
    pub fn compliance_bytes(&self) -> usize {
        self.compliance.len() * size_of::<f64>()
    }

    /// Quality of the cells.
    pub fn quality(&self) -> &CellQuality {
        &self.quality
    }

    /// Total mass, kg.
    pub fn mass_kg(&self) -> f64 {
        self.masses.iter().sum()
    }

    /// Node of a control point (u-major index).
    pub fn node_of_control(&self, control: usize) -> usize {
        self.node_of_control[control] as usize
    }

    /// The state at rest.
    pub fn rest_state(&self) -> LatticeState {
        LatticeState { positions: self.rest.clone(), velocities: vec![Vector3::zeros(); self.rest.len()] }
    }

    /// Buffers; call [`Lattice::predict`] before the first tick.
    pub fn scratch(&self) -> LatticeScratch {
        let zeros = vec![Vector3::zeros(); self.node_count()];
        LatticeScratch {
            predicted: self.rest.clone(),
            forces: zeros.clone(),
            loaded: Vec::with_capacity(self.node_of_control.len()),
            is_loaded: vec![false; self.node_count()],
            places: vec![[0.0; 4]; self.node_count()],
            residual: vec![[0.0; 4]; self.node_count()],
            increment: zeros,
            rhs: vec![Vector3::zeros(); self.unknown_count()],
            lanes: vec![[0.0; 4]; self.unknown_count()],
        }
    }

    /// x*: where the nodes go in one tick without contact.
    pub fn predict(&self, state: &LatticeState, scratch: &mut LatticeScratch) {
        let inverse_dt = 1.0 / self.settings.dt_s;
        scratch.predicted.copy_from_slice(&state.positions);
        for iteration in 0..self.settings.iterations {
            // Residual of backward Euler at the current guess.
            for node in 0..self.node_count() {
                let (guess, now) = (&scratch.predicted[node], &state.positions[node]);
                let moved = guess - now;
                let due = (state.velocities[node] - moved * inverse_dt) * inverse_dt + self.settings.gravity;
                let load = due * self.masses[node];
                scratch.increment[node] = moved;
                scratch.places[node] = [guess.x, guess.y, guess.z, 0.0];
                scratch.residual[node] = [load.x, load.y, load.z, 0.0];
            }
            self.add_spring_forces(&scratch.places, &mut scratch.residual);
            if iteration > 0 {
                self.add_damping_forces(&scratch.increment, &mut scratch.residual);
            }
            self.solve(scratch);
            for (row, &node) in self.node_of_unknown.iter().enumerate() {
                scratch.predicted[node as usize] += scratch.rhs[row];
            }
        }
    }

    fn solve(&self, scratch: &mut LatticeScratch) {
        for (row, &node) in self.node_of_unknown.iter().enumerate() {
            let [x, y, z, _] = scratch.residual[node as usize];
            scratch.rhs[row] = Vector3::new(x, y, z);
        }
        self.factor.solve(&mut scratch.rhs, &mut scratch.lanes);
    }

    /// g_i = Σ k (|d| − L) / |d| d, eqs. 5.8–5.16 of the thesis. A spring without length has no direction and no force.
    fn add_spring_forces(&self, places: &[Lane], residual: &mut [Lane]) {
        #[cfg(target_arch = "x86_64")]
        if simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { add_forces_avx2(&self.springs, places, residual) };
        }
        self.springs.add_forces(places, residual);
    }

    fn add_damping_forces(&self, moved: &[Vector3], residual: &mut [Lane]) {
        let rate = self.damping_s / self.settings.dt_s;
        let table = &self.springs;
        for s in 0..table.a.len() {
            let (a, b) = (table.a[s] as usize, table.b[s] as usize);
            let force = (moved[b] - moved[a]) * (table.stiffness[s] * rate);
            for c in 0..3 {
                residual[a][c] += force[c];
                residual[b][c] -= force[c];
            }
        }
    }

    /// Displacements of all free nodes for a unit force held on a surface node over one tick, m/N, by
    /// [`Lattice::unknown`]; `None` for a fixed node.
    pub fn compliance_of(&self, node: usize) -> Option<&[f64]> {
        let column = self.surface_index[node];
        let n = self.unknown_count();
        (column != FIXED).then(|| &self.compliance[column as usize * n..(column as usize + 1) * n])
    }

    /// Place of a node among the free ones; `None` if it is fixed.
    pub fn unknown(&self, node: usize) -> Option<usize> {
        let row = self.unknown[node];
        (row != FIXED).then_some(row as usize)
    }

    /// Adds a force (N) on a surface node for this tick.
    pub fn push(&self, scratch: &mut LatticeScratch, node: usize, force: Vector3) {
        if self.surface_index[node] == FIXED {
            return;
        }
        if !scratch.is_loaded[node] {
            scratch.is_loaded[node] = true;
            scratch.loaded.push(node as u32);
        }
        scratch.forces[node] += force;
    }

    /// x' = x* + A⁻¹ Cᵀ λ, v = (x' − x) / dt. Forces are used up.
    pub fn advance(&self, state: &mut LatticeState, scratch: &mut LatticeScratch) {
        let n = self.unknown_count();
        scratch.rhs.fill(Vector3::zeros());
        for &node in &scratch.loaded {
            let force = std::mem::replace(&mut scratch.forces[node as usize], Vector3::zeros());
            scratch.is_loaded[node as usize] = false;
            let column = self.surface_index[node as usize] as usize;
            for (moved, w) in scratch.rhs.iter_mut().zip(&self.compliance[column * n..(column + 1) * n]) {
                *moved += force * *w;
            }
        }
        scratch.loaded.clear();
        let inverse_dt = 1.0 / self.settings.dt_s;
        for (row, &node) in self.node_of_unknown.iter().enumerate() {
            let node = node as usize;
            let position = scratch.predicted[node] + scratch.rhs[row];
            state.velocities[node] = (position - state.positions[node]) * inverse_dt;
            state.positions[node] = position;
        }
    }

    /// Kinetic plus spring energy, J.
    pub fn energy_j(&self, state: &LatticeState) -> f64 {
        let kinetic: f64 = self.masses.iter().zip(&state.velocities).map(|(m, v)| 0.5 * m * v.norm_squared()).sum();
        let table = &self.springs;
        let elastic: f64 = (0..table.a.len())
            .map(|s| {
                let d = state.positions[table.b[s] as usize] - state.positions[table.a[s] as usize];
                0.5 * table.stiffness[s] * (d.norm() - table.rest_length[s]).powi(2)
            })
            .sum();
        kinetic + elastic
    }

    /// Sum of the spring forces on the fixed nodes, N: the reaction of the base.
    pub fn base_reaction_n(&self, state: &LatticeState) -> Vector3 {
        let mut residual = vec![[0.0; 4]; self.node_count()];
        let places: Vec<Lane> = state.positions.iter().map(|p| [p.x, p.y, p.z, 0.0]).collect();
        self.add_spring_forces(&places, &mut residual);
        let fixed = (0..self.node_count()).filter(|&node| self.unknown[node] == FIXED);
        fixed.map(|node| Vector3::new(residual[node][0], residual[node][1], residual[node][2])).sum()
    }
}

impl LatticeState {
    /// All of it, in order.
    pub fn save(&self, sink: &mut impl StateSink) {
        save_triples(&self.positions, |p| &p.coords, sink);
        save_triples(&self.velocities, |v| v, sink);
    }

    /// In the order of [`LatticeState::save`].
    ///
    /// # Errors
    /// The source is too short.
    pub fn restore(&mut self, source: &mut impl StateSource) -> Result<(), StateError> {
        for p in &mut self.positions {
            source.floats(p.coords.as_mut_slice())?;
        }
        for v in &mut self.velocities {
            source.floats(v.as_mut_slice())?;
        }
        Ok(())
    }
}

/// In blocks: a hash of thousands of short slices would cost more than the step's force pass.
fn save_triples<T>(items: &[T], triple: impl Fn(&T) -> &Vector3, sink: &mut impl StateSink) {
    const BLOCK: usize = 64;
    let mut block = [0.0; 3 * BLOCK];
    for items in items.chunks(BLOCK) {
        for (slot, item) in block.chunks_exact_mut(3).zip(items) {
            slot.copy_from_slice(triple(item).as_slice());
        }
        sink.floats(&block[..3 * items.len()]);
    }
}

fn step_matrix(
    masses: &[f64],
    springs: &[Spring],
    unknown: &[u32],
    node_of_unknown: &[u32],
    material: &Material,
    settings: &StepSettings,
) -> SymmetricTriplets {
    let dt = settings.dt_s;
    let mut matrix = SymmetricTriplets::new(node_of_unknown.len());
    for (row, &node) in node_of_unknown.iter().enumerate() {
        matrix.add(row, row, masses[node as usize] / (dt * dt));
    }
    for spring in springs {
        let k = spring.stiffness_n_m * (1.0 + material.damping_s / dt);
        let (a, b) = (unknown[spring.a as usize], unknown[spring.b as usize]);
        for row in [a, b] {
            if row != FIXED {
                matrix.add(row as usize, row as usize, k);
            }
        }
        if a != FIXED && b != FIXED {
            matrix.add(a as usize, b as usize, -k);
        }
    }
    matrix
}

fn compliance(factor: &Cholesky, node_of_control: &[u32], unknown: &[u32], node_count: usize) -> (Vec<u32>, Vec<f64>) {
    let mut surface: Vec<u32> =
        node_of_control.iter().copied().filter(|&node| unknown[node as usize] != FIXED).collect();
    surface.sort_unstable();
    surface.dedup();
    let mut index = vec![FIXED; node_count];
    let mut columns = Vec::with_capacity(surface.len() * factor.n());
    for (column, &node) in surface.iter().enumerate() {
        index[node as usize] = column as u32;
        let mut unit = vec![0.0; factor.n()];
        unit[unknown[node as usize] as usize] = 1.0;
        factor.solve_one(&mut unit);
        columns.extend(unit);
    }
    (index, columns)
}
