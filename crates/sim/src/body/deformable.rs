//! A deforming body: its constants, and what contact asks of it.
//!
//! A body has coordinates q, which move; nodes x = W q, which carry its law's forces; and a control
//! net, each point of which is a coordinate. Contact acts on coordinates of the net through the
//! compliance of one step: how far a force held through the step moves each coordinate, in columns
//! kept from the start.

mod queries;

use super::cells::CellQuality;
use super::columns;
use super::continuum::ContinuumError;
use super::explicit::Explicit;
use super::implicit::Implicit;
use super::law::Law;
use super::material::Plastic;
use super::node_map::NodeMap;
use super::plastic::Flow;
use super::state::{DeformableScratch, DeformableState};
use super::xpbd::Xpbd;
use palpate_geometry::math::{CholeskyError, Lane, Point3, Rows, Vector3};

/// How a body steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSettings {
    /// dt of the body, s.
    pub dt_s: f64,
    /// Which method.
    pub integrator: Integrator,
    /// A body in which no coordinate is faster, m/s, and which nothing touches, falls asleep; 0
    /// keeps it awake.
    pub sleep_m_s: f64,
}

/// Acceleration of a free point in the body's frame, which may be carried about: gravity less that
/// of the frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Field {
    /// At the frame's origin, m/s².
    pub at_origin: Vector3,
    /// ω of the frame, in it, rad/s.
    pub turning_rad_s: Vector3,
    /// dω/dt, rad/s².
    pub turning_rad_s2: Vector3,
}

impl Field {
    /// Of a frame that stands still.
    pub fn gravity(acceleration_m_s2: Vector3) -> Self {
        Self {
            at_origin: acceleration_m_s2,
            ..Self::default()
        }
    }

    /// g − a − dω/dt × r − ω × (ω × r) − 2 ω × v.
    #[inline]
    pub fn at(&self, place: &Point3, velocity: &Vector3) -> Vector3 {
        let (omega, zero) = (self.turning_rad_s, Vector3::zeros());
        if omega == zero && self.turning_rad_s2 == zero {
            return self.at_origin;
        }
        let inward = omega.cross(&(omega.cross(&place.coords) + velocity * 2.0));
        self.at_origin - self.turning_rad_s2.cross(&place.coords) - inward
    }
}

/// Time integration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// Backward Euler by a constant matrix, with this many iterations (≥ 1) a step.
    Implicit {
        /// Local–global iterations.
        iterations: usize,
    },
    /// Symplectic Euler, the thesis' eqs. 5.14–5.16, in as many substeps as stability needs, or
    /// more.
    Explicit {
        /// At least so many.
        substeps: usize,
    },
    /// Extended position-based dynamics (Macklin et al. 2019, small steps).
    Xpbd {
        /// Substeps, one iteration each.
        substeps: usize,
    },
}

/// Why a body could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DeformableError {
    /// A cell without volume.
    #[error("{count} of {total} cells have no volume; the surface is too thin there or folded")]
    FlatCells {
        /// How many.
        count: usize,
        /// Of how many.
        total: usize,
    },
    /// Every coordinate is fixed.
    #[error(
        "all {0} nodes are fixed: nothing can deform; use model = \"rigid\" or fix fewer nodes"
    )]
    AllFixed(usize),
    /// A coordinate without mass.
    #[error("{0} nodes have no mass; the surface is too thin there or folded")]
    NoMass(usize),
    /// The matrix of the step could not be factored.
    #[error("the matrix of the implicit step has no factor: {0}")]
    Factor(#[from] CholeskyError),
    /// Stability needs more substeps than anyone waits for.
    #[error(
        "the explicit step needs {needed} substeps a tick, more than {most}; use integrator = \"implicit\""
    )]
    Substeps {
        /// Required number.
        needed: usize,
        /// Largest allowed number.
        most: usize,
    },
    /// Cells that cannot carry a continuum energy.
    #[error(transparent)]
    Continuum(#[from] ContinuumError),
    /// A combination that is not there.
    #[error("{0}")]
    Unsupported(&'static str),
}

/// Marks a fixed coordinate where an index is expected.
pub(super) const FIXED: u32 = u32::MAX;
/// Steps in a row without motion after which a body sleeps.
pub(super) const STILL_STEPS: u32 = 100;

/// What a body is built from.
#[derive(Debug)]
pub struct Blueprint {
    /// (coordinates), m, at rest.
    pub coordinates: Vec<Point3>,
    /// Nodes from coordinates.
    pub map: NodeMap,
    /// (nodes), kg.
    pub masses: Vec<f64>,
    /// Forces between nodes.
    pub law: Law,
    /// (control points): coordinate of each.
    pub coordinate_of_control: Vec<u32>,
    /// (coordinates): never move.
    pub fixed: Vec<bool>,
    /// Figures of the cells.
    pub quality: CellQuality,
}

/// Constants of a body.
#[derive(Debug)]
pub struct Deformable {
    pub(super) settings: StepSettings,
    pub(super) damping_s: f64,
    pub(super) rest: Vec<Point3>,
    pub(super) map: NodeMap,
    pub(super) law: Law,
    /// (coordinates), kg.
    pub(super) masses: Vec<f64>,
    /// (coordinates): place among those that can move, or [`FIXED`].
    pub(super) unknown: Vec<u32>,
    /// (unknowns): coordinate.
    pub(super) coordinate_of_unknown: Vec<u32>,
    coordinate_of_control: Vec<u32>,
    stepper: Stepper,
    flow: Option<Flow>,
    /// (coordinates): column of `compliance`, or [`FIXED`].
    surface_index: Vec<u32>,
    /// (surface coordinates × unknowns), row by row, m/N within one step.
    compliance: Vec<f64>,
    quality: CellQuality,
}

#[derive(Debug)]
pub(super) enum Stepper {
    Implicit(Implicit),
    Explicit(Explicit),
    Xpbd(Xpbd),
}

impl Deformable {
    /// Builds the step and its compliance.
    ///
    /// # Errors
    /// No free coordinate, one without mass, a matrix without factor, or a combination that is not
    /// there.
    pub fn new(
        blueprint: Blueprint,
        damping_s: f64,
        plastic: Option<Plastic>,
        settings: StepSettings,
    ) -> Result<Self, DeformableError> {
        let Blueprint {
            coordinates: rest,
            map,
            masses,
            law,
            coordinate_of_control,
            fixed,
            quality,
        } = blueprint;
        let count = rest.len();
        let masses = map.lumped(&masses, count);
        let mut unknown = vec![FIXED; count];
        let mut coordinate_of_unknown = Vec::new();
        for coordinate in (0..count).filter(|&c| !fixed[c]) {
            unknown[coordinate] = coordinate_of_unknown.len() as u32;
            coordinate_of_unknown.push(coordinate as u32);
        }
        if coordinate_of_unknown.is_empty() {
            return Err(DeformableError::AllFixed(count));
        }
        let weightless = masses
            .iter()
            .filter(|&&m| !(m > 0.0 && m.is_finite()))
            .count();
        if weightless > 0 {
            return Err(DeformableError::NoMass(weightless));
        }
        if plastic.is_some() && law.continuum.is_some() {
            return Err(DeformableError::Unsupported(
                "only springs flow plastically; use model = \"lattice\"",
            ));
        }
        let flow = plastic.map(|law_of_flow| {
            Flow::new(law_of_flow, &law.springs, &map.nodes(&rest), settings.dt_s)
        });
        let mut body = Self {
            settings,
            damping_s,
            rest,
            map,
            law,
            masses,
            unknown,
            coordinate_of_unknown,
            coordinate_of_control,
            stepper: Stepper::Explicit(Explicit::none()),
            flow,
            surface_index: Vec::new(),
            compliance: Vec::new(),
            quality,
        };
        body.stepper = match settings.integrator {
            Integrator::Implicit { iterations } => {
                Stepper::Implicit(Implicit::new(&body, iterations)?)
            }
            Integrator::Explicit { substeps } => Stepper::Explicit(Explicit::new(&body, substeps)?),
            Integrator::Xpbd { substeps } => Stepper::Xpbd(Xpbd::new(&body, substeps)?),
        };
        body.keep_compliance();
        Ok(body)
    }

    /// Columns of the surface's coordinates.
    fn keep_compliance(&mut self) {
        let free = |&c: &u32| self.unknown[c as usize] != FIXED;
        let mut surface: Vec<u32> = self
            .coordinate_of_control
            .iter()
            .copied()
            .filter(free)
            .collect();
        surface.sort_unstable();
        surface.dedup();
        let mut index = vec![FIXED; self.rest.len()];
        for (column, &coordinate) in surface.iter().enumerate() {
            index[coordinate as usize] = column as u32;
        }
        self.compliance = match &self.stepper {
            Stepper::Implicit(implicit) => implicit.columns(self, &surface),
            Stepper::Explicit(_) | Stepper::Xpbd(_) => self.columns_by_trial(&surface),
        };
        self.surface_index = index;
    }

    /// Compliance of a step that has no matrix: what small forces do to the body at rest, made
    /// symmetric.
    fn columns_by_trial(&self, surface: &[u32]) -> Vec<f64> {
        let (n, state, mut scratch) = (self.unknown_count(), self.rest_state(), self.scratch());
        self.run(&state, &mut scratch);
        let free = scratch.predicted.clone();
        let size = self
            .rest
            .iter()
            .map(|p| (p - self.rest[0]).norm())
            .fold(0.0, f64::max);
        let mut columns = Vec::with_capacity(surface.len() * n);
        for &coordinate in surface {
            // Along z, which is as good as any; far above rounding and far below what bends the
            // law.
            let force_n =
                1e-7 * size * self.masses[coordinate as usize] / self.settings.dt_s.powi(2);
            scratch.forces[coordinate as usize] = Vector3::z() * force_n;
            self.run(&state, &mut scratch);
            scratch.forces[coordinate as usize] = Vector3::zeros();
            let moved = |&c: &u32| (scratch.predicted[c as usize].z - free[c as usize].z) / force_n;
            columns.extend(self.coordinate_of_unknown.iter().map(moved));
        }
        let row = |coordinate: u32| self.unknown[coordinate as usize] as usize;
        for (i, &a) in surface.iter().enumerate() {
            for (j, &b) in surface.iter().enumerate().take(i) {
                let (there, back) = (i * n + row(b), j * n + row(a));
                let mean = 0.5 * (columns[there] + columns[back]);
                (columns[there], columns[back]) = (mean, mean);
            }
        }
        columns
    }

    /// A step of a method without matrix, with the forces of the scratch, into its `predicted` and
    /// `speed`.
    fn run(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        match &self.stepper {
            Stepper::Implicit(_) => {}
            Stepper::Explicit(explicit) => explicit.run(self, state, scratch),
            Stepper::Xpbd(xpbd) => xpbd.run(self, state, scratch),
        }
    }

    /// Sets what free points feel from the next [`Deformable::predict`] on.
    pub fn set_field(&self, scratch: &mut DeformableScratch, field: Field) {
        scratch.field = field;
    }

    /// x*: where the coordinates go in one step without contact; of several iterations, after the
    /// first.
    pub fn predict(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        if self.asleep(state) {
            scratch.predicted.copy_from_slice(&state.positions);
            return;
        }
        match &self.stepper {
            Stepper::Implicit(implicit) => implicit.predict(self, state, scratch),
            Stepper::Explicit(_) | Stepper::Xpbd(_) => self.run(state, scratch),
        }
    }

    /// One more iteration of an implicit step, from where the contact forces of the scratch, which
    /// are used up, take the body: x* becomes what [`Deformable::advance`] with the same forces
    /// would end in the same place from.
    pub fn iterate(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        let Stepper::Implicit(implicit) = &self.stepper else {
            return self.drop_loads(scratch);
        };
        if scratch.loaded.is_empty() && self.asleep(state) {
            return;
        }
        self.respond(scratch);
        for (moved, &coordinate) in scratch.lanes.iter().zip(&self.coordinate_of_unknown) {
            scratch.predicted[coordinate as usize] += Vector3::new(moved[0], moved[1], moved[2]);
        }
        self.drop_loads(scratch);
        implicit.again(self, state, scratch);
    }

    /// The step with contact forces, which are used up. [`Deformable::predict`] came before, on the
    /// same state.
    pub fn advance(&self, state: &mut DeformableState, scratch: &mut DeformableScratch) {
        if scratch.loaded.is_empty() && self.asleep(state) {
            state.slept += 1;
            return;
        }
        let touched = !scratch.loaded.is_empty();
        match &self.stepper {
            Stepper::Implicit(_) => self.advance_on_compliance(state, scratch),
            Stepper::Explicit(_) | Stepper::Xpbd(_) => {
                // Again from the start: the prediction knew no contact.
                self.run(state, scratch);
                state.positions.copy_from_slice(&scratch.predicted);
                state.velocities.copy_from_slice(&scratch.speed);
            }
        }
        self.drop_loads(scratch);
        let flowed = self.flow(state, scratch);
        self.count_still(state, touched || flowed);
    }

    /// A⁻¹ Cᵀ λ, into the scratch's lanes.
    fn respond(&self, scratch: &mut DeformableScratch) {
        let n = self.unknown_count();
        let column_of = |coordinate: u32| {
            let column = self.surface_index[coordinate as usize] as usize;
            &self.compliance[column * n..(column + 1) * n]
        };
        scratch.lanes.fill([0.0; 4]);
        for four in scratch.loaded.chunks(4) {
            let mut columns: [&[f64]; 4] = [&[]; 4];
            let mut forces = [[0.0; 4]; 4];
            for (k, &coordinate) in four.iter().enumerate() {
                let force = scratch.forces[coordinate as usize];
                (columns[k], forces[k]) = (column_of(coordinate), [force.x, force.y, force.z, 0.0]);
            }
            columns::add(columns, four.len(), &forces, &mut scratch.lanes);
        }
    }

    /// x' = x* + A⁻¹ Cᵀ λ, v = (x' − x) / dt.
    fn advance_on_compliance(&self, state: &mut DeformableState, scratch: &mut DeformableScratch) {
        self.respond(scratch);
        let inverse_dt = 1.0 / self.settings.dt_s;
        for (moved, &coordinate) in scratch.lanes.iter().zip(&self.coordinate_of_unknown) {
            let coordinate = coordinate as usize;
            let position =
                scratch.predicted[coordinate] + Vector3::new(moved[0], moved[1], moved[2]);
            state.velocities[coordinate] = (position - state.positions[coordinate]) * inverse_dt;
            state.positions[coordinate] = position;
        }
    }

    fn flow(&self, state: &mut DeformableState, scratch: &mut DeformableScratch) -> bool {
        let Some(flow) = &self.flow else { return false };
        let DeformableScratch {
            coordinates,
            nodes,
            flow: changes,
            ..
        } = scratch;
        lanes(&state.positions, coordinates);
        let places: &[Lane] = match &self.map {
            NodeMap::Same => coordinates,
            NodeMap::Sparse(map) => {
                map.apply(coordinates, nodes);
                nodes
            }
        };
        flow.flow(
            &self.law.springs,
            places,
            &mut state.rest_lengths,
            &mut state.plastic_strain,
            changes,
        )
    }

    /// What moves no more for a while falls asleep; it wakes by a touch.
    fn count_still(&self, state: &mut DeformableState, busy: bool) {
        let limit = self.settings.sleep_m_s * self.settings.sleep_m_s;
        let still =
            !busy && limit > 0.0 && state.velocities.iter().all(|v| v.norm_squared() <= limit);
        state.still = if still {
            (state.still + 1).min(STILL_STEPS)
        } else {
            0
        };
        if state.still == STILL_STEPS {
            state.velocities.fill(Vector3::zeros());
        }
    }

    /// True when steps are skipped until something touches the body.
    pub fn asleep(&self, state: &DeformableState) -> bool {
        state.still >= STILL_STEPS
    }

    /// Adds a force (N) on a coordinate of the net for this step.
    pub fn push(&self, scratch: &mut DeformableScratch, coordinate: usize, force: Vector3) {
        if self.surface_index[coordinate] == FIXED {
            return;
        }
        if !scratch.is_loaded[coordinate] {
            scratch.is_loaded[coordinate] = true;
            scratch.loaded.push(coordinate as u32);
        }
        scratch.forces[coordinate] += force;
    }

    /// Moves the forces given so far into `loads` (coordinates).
    pub fn take_loads(&self, scratch: &mut DeformableScratch, loads: &mut [Vector3]) {
        loads.fill(Vector3::zeros());
        for coordinate in scratch.loaded.drain(..) {
            let coordinate = coordinate as usize;
            loads[coordinate] =
                std::mem::replace(&mut scratch.forces[coordinate], Vector3::zeros());
            scratch.is_loaded[coordinate] = false;
        }
    }

    /// Gives back what [`Deformable::take_loads`] took.
    pub fn give_loads(&self, scratch: &mut DeformableScratch, loads: &[Vector3]) {
        for (coordinate, load) in loads
            .iter()
            .enumerate()
            .filter(|(_, load)| **load != Vector3::zeros())
        {
            self.push(scratch, coordinate, *load);
        }
    }

    /// Forgets the forces given so far.
    pub fn drop_loads(&self, scratch: &mut DeformableScratch) {
        for coordinate in scratch.loaded.drain(..) {
            scratch.forces[coordinate as usize] = Vector3::zeros();
            scratch.is_loaded[coordinate as usize] = false;
        }
    }

    /// Displacements of all free coordinates for a unit force held on one of the net over one step,
    /// m/N, by [`Deformable::unknown`]; `None` for a fixed one.
    pub fn compliance_of(&self, coordinate: usize) -> Option<&[f64]> {
        let column = self.surface_index[coordinate];
        let n = self.unknown_count();
        (column != FIXED).then(|| &self.compliance[column as usize * n..(column as usize + 1) * n])
    }

    /// Place of a coordinate among the free ones; `None` if it is fixed.
    pub fn unknown(&self, coordinate: usize) -> Option<usize> {
        let row = self.unknown[coordinate];
        (row != FIXED).then_some(row as usize)
    }

    /// Coordinate of a control point (u-major index).
    pub fn coordinate_of_control(&self, control: usize) -> usize {
        self.coordinate_of_control[control] as usize
    }

    /// The state at rest.
    pub fn rest_state(&self) -> DeformableState {
        let mut state = DeformableState::default();
        self.set_to_rest(&mut state);
        state
    }

    /// Sets a state of this body back to rest; allocates nothing.
    pub fn set_to_rest(&self, state: &mut DeformableState) {
        let DeformableState {
            positions,
            velocities,
            rest_lengths,
            plastic_strain,
            still,
            slept,
        } = state;
        positions.clone_from(&self.rest);
        velocities.clear();
        velocities.resize(self.rest.len(), Vector3::zeros());
        let rest: &[Lane] = match &self.flow {
            Some(_) => self.law.springs.rest(),
            None => &[],
        };
        rest_lengths.clear();
        rest_lengths.extend_from_slice(rest);
        plastic_strain.clear();
        plastic_strain.resize(rest.len(), [0.0; 4]);
        (*still, *slept) = (0, 0);
    }

    /// Buffers; call [`Deformable::predict`] before the first step.
    pub fn scratch(&self) -> DeformableScratch {
        let count = self.rest.len();
        let nodes = match &self.map {
            NodeMap::Same => 0,
            NodeMap::Sparse(map) => map.rows(),
        };
        DeformableScratch {
            predicted: self.rest.clone(),
            forces: vec![Vector3::zeros(); count],
            loaded: Vec::with_capacity(self.coordinate_of_control.len()),
            is_loaded: vec![false; count],
            coordinates: Rows::zeros(count),
            nodes: Rows::zeros(nodes),
            residual: Rows::zeros(count),
            node_residual: Rows::zeros(nodes),
            springs: self.law.springs.buffers(),
            speed: vec![Vector3::zeros(); count],
            rhs: vec![Vector3::zeros(); self.unknown_count()],
            lanes: Rows::zeros(self.unknown_count()),
            limited: 0,
            field: Field::default(),
            flow: vec![
                [0.0; 4];
                if self.flow.is_some() {
                    self.law.springs.rest().len()
                } else {
                    0
                }
            ],
        }
    }

    /// Lengths of the springs without force.
    pub(super) fn rest_lengths<'a>(&'a self, state: &'a DeformableState) -> &'a [Lane] {
        if self.flow.is_some() {
            &state.rest_lengths
        } else {
            self.law.springs.rest()
        }
    }

    /// Adds Wᵀ of the law's forces at the coordinates of the scratch to its residual.
    pub(super) fn add_law_forces(&self, state: &DeformableState, scratch: &mut DeformableScratch) {
        let rest = self.rest_lengths(state);
        let DeformableScratch {
            coordinates,
            nodes,
            residual,
            node_residual,
            springs,
            limited,
            ..
        } = scratch;
        match &self.map {
            NodeMap::Same => *limited = self.law.add_forces(rest, coordinates, residual, springs),
            NodeMap::Sparse(map) => {
                map.apply(coordinates, nodes);
                node_residual.fill([0.0; 4]);
                *limited = self.law.add_forces(rest, nodes, node_residual, springs);
                map.add_transposed(node_residual, residual);
            }
        }
    }

    /// Entries of the step's matrix that come from the law, edges at nodes.
    pub(super) fn law_edges(&self) -> Vec<(u32, u32, f64)> {
        self.law.edges()
    }
}

/// Points as rows of registers.
pub(super) fn lanes(points: &[Point3], out: &mut [Lane]) {
    for (lane, p) in out.iter_mut().zip(points) {
        *lane = [p.x, p.y, p.z, 0.0];
    }
}
