//! Backward Euler, one or a few iterations of a quasi-Newton method with a constant matrix B, factored
//! at build.
//!
//! A step starts from the inertial prediction y = x + dt v. One iteration from a guess z, with the contact forces F so
//! far and, of a continuum, pressures q:
//!
//! ```text
//! r = M (g − (z − y) / dt²) + f(x + s (z − x), q) + F     s = 1 + d / dt, d the time of Voigt damping
//! c = J − 1 − q / λ                                       by cell
//! d = B⁻¹ (Rᵀ r − Σ G₀ λ c)                               in the frame of rest
//! z += R d,  q += λ (c + s G₀·d / V)
//! ```
//! and what forces change later moves the body by A = R B⁻¹ Rᵀ: contact is answered by the same operator that the step
//! takes. What is at rest stays at rest to the last bit, and equilibrium does not depend on B.
//!
//! B is the tangent of rest, turned with each coordinate's neighbourhood (stiffness warping); of a sheet with as much
//! tension as it has. Springs have no pressure to free: where their tangent cannot follow, a firmer one does, or a
//! scalar matrix above every tangent, as in projective dynamics (Bouaziz et al. 2014).

mod matrices;

use super::convergence::{BOUNDING, Convergence};
use super::core::{Core, Factor, Made};
use super::elements::Weight;
use super::follow;
use super::following::{Follows, Shape};
use super::frame::{Frame, IDENTITY, from_rest, into_rest};
use super::frames::Frames;
use super::guard::Limit;
use super::look_ahead::LookAhead;
use super::matter::{FIXED, Matter, lanes};
use super::missed::About;
use super::neighbours::{middle, shortest_edges};
use super::node_map::NodeMap;
use super::rigid_motion::Inertia;
use super::scratch::{DeformableScratch, ImplicitScratch};
use super::settings::{DeformableError, FallBack, StepMatrix};
use super::state::DeformableState;
use crate::solve::rigid_part::RigidPart;
use matrices::{bounding, tangents};
use palpate_geometry::math::{Lane, Rows, SymmetricTriplets, Vector3};
use std::sync::Arc;

/// Most numbers of a factor in blocks for each second of a step: what a core reads in about that time.
const MOST_NUMBERS: f64 = 3e9;
/// Fewest numbers that are affordable, however short a step is.
const FEW_NUMBERS: usize = 3_000_000;
/// Most numbers of a factor that the scene asks for: half a gigabyte.
const MOST_ASKED_FOR: usize = 150_000_000;

/// What a body is made of, as far as its matrix is concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Cells with pressures that are unknowns.
    Continuum,
    /// Springs between the nodes of cells.
    Lattice,
    /// Springs and bends: out of plane they are as stiff as they are drawn.
    Sheet,
}

impl Kind {
    fn of(matter: &Matter) -> Self {
        match (&matter.law.continuum, matter.law.is_solid()) {
            (Some(_), _) => Self::Continuum,
            (None, true) => Self::Lattice,
            (None, false) => Self::Sheet,
        }
    }
}

/// The cores, and what further iterations need.
#[derive(Debug)]
pub(super) struct ImplicitStep {
    kind: Kind,
    /// Of a continuum: the tangent of rest. Of a lattice: that, one that is firmer against turning for strained bodies,
    /// and the bounding matrix. Of a sheet: the tangent of rest with the stretch of each of [`STRETCHES`], and the bounding
    /// matrix. Or the bounding matrix alone.
    cores: Vec<Core>,
    frames: Frames,
    iterations: usize,
    limits: [Limit; 2],
    springs: Option<Springs>,
}

/// What watches over a matrix of springs.
#[derive(Debug)]
struct Springs {
    look_ahead: Option<LookAhead>,
    /// (unknowns), m: corrections below this are rounding; and those that are watched at once.
    watched_m: Vec<[f64; 2]>,
    /// Length of a correction that may be wild, m.
    wild_m: f64,
    /// Laplacian of what short edges carry beyond others, N/m: (unknown, unknown, value), the lower
    /// triangle.
    short: Vec<(u32, u32, f64)>,
}

/// Stretches of springs of a sheet, 1 − rest length / length, up to which each of its factors follows.
const STRETCHES: [f64; 4] = [0.002, 0.01, 0.06, 0.3];

/// A correction that turns over this often in a row without becoming smaller grows; a large one
/// need only do so twice.
const TURNS: [f64; 2] = [3.0, 2.0];
/// Of the shortest edge: corrections below are rounding, and those above are large.
const WATCHED: [f64; 2] = [1e-8, 1e-2];
/// Along a sheet friction and what answers it a tick later tremble by somewhat more, and no further.
const WATCHED_OF_SHEETS: [f64; 2] = [1e-5, 1e-2];
/// A correction that turns over grows wild where it is this often the last, and of the middle edge at
/// least this long: it would take the body apart before it has turned over again.
const WILD: f64 = 2.0;
const WILD_LENGTH: f64 = 0.05;
/// Of what short edges carry beyond others: how much of it damps. Motions with 0.005 of its stiffness
/// are then damped critically.
const CALM: f64 = 0.15;

impl ImplicitStep {
    pub(super) fn new(
        matter: &Matter,
        iterations: usize,
        wanted: StepMatrix,
    ) -> Result<Self, DeformableError> {
        let kind = Kind::of(matter);
        let affordable = (MOST_NUMBERS * matter.settings.dt_s) as usize;
        let tangents = match (kind, wanted) {
            (Kind::Continuum, _) | (_, StepMatrix::Tangent) => {
                tangents(matter, kind, MOST_ASKED_FOR)
            }
            (_, StepMatrix::Auto) => tangents(matter, kind, affordable.max(FEW_NUMBERS)),
            (_, StepMatrix::Bounding) => None,
        };
        let (mut cores, short) = match tangents {
            Some(tangents) => tangents,
            None if kind == Kind::Continuum => return Err(DeformableError::TooLarge),
            None => (Vec::new(), Vec::new()),
        };
        let mut springs = None;
        if kind != Kind::Continuum {
            springs = Some(Springs::new(matter, kind, short));
            cores.push(bounding(matter)?);
        }
        Ok(Self {
            kind,
            cores,
            frames: Frames::new(matter),
            iterations,
            limits: match &matter.law.continuum {
                Some(law) => {
                    let ahead = matter.voigt();
                    Limit::of_continuum(ahead, law.largest_poisson())
                }
                None => Limit::OF_SPRINGS,
            },
            springs,
        })
    }

    pub(super) fn iterations(&self) -> usize {
        self.iterations
    }

    /// `tangent` or `bounding`.
    pub(super) fn matrix_name(&self) -> &'static str {
        match &self.cores[0].factor {
            Factor::Blocks(_) => "tangent",
            Factor::Scalar(_) => "bounding",
        }
    }

    /// The factor at rest.
    pub(super) fn factor(&self) -> &Factor {
        &self.cores[0].factor
    }

    /// Bytes of what answers contact.
    pub(super) fn surface_bytes(&self) -> usize {
        self.cores.iter().map(|core| core.surface.bytes()).sum()
    }

    /// Lanes of pressures in a state.
    pub(super) fn pressure_lanes(&self, matter: &Matter) -> usize {
        match self.kind {
            Kind::Continuum => matter.law.pressure_lanes(),
            Kind::Lattice | Kind::Sheet => 0,
        }
    }

    pub(super) fn scratch(&self, matter: &Matter) -> ImplicitScratch {
        let n = matter.unknown_count();
        let factors = self.cores.iter().map(|core| &core.factor);
        let pressures = self.pressure_lanes(matter);
        ImplicitScratch {
            frames: vec![IDENTITY; n],
            work: Factor::work(factors, n),
            rows: Rows::zeros(n),
            loads: Rows::zeros(if self.iterations > 1 { n } else { 0 }),
            merit_j: 0.0,
            moved: vec![Vector3::zeros(); n],
            convergence: self.convergence(matter),
            last_m2: f64::INFINITY,
            pressures: vec![[0.0; 4]; pressures],
            gaps: vec![[0.0; 4]; pressures],
            core: 0,
            by_stretch: 0,
            starts: matter.rest.clone(),
            inertia: None,
            rigid: RigidPart::for_places(if matter.is_free() {
                matter.surface.len()
            } else {
                0
            }),
            followed: None,
        }
    }

    /// That of a body at rest.
    pub(super) fn convergence(&self, matter: &Matter) -> Convergence {
        let mut convergence = Convergence::default();
        if self.has_fall_back() {
            convergence.corrections = vec![[0.0; 4]; matter.unknown_count()];
            convergence.set_to_rest();
        }
        convergence
    }

    /// How much the body may strain in a step, by itself and then with its contacts.
    pub(super) fn limits(&self) -> [Limit; 2] {
        self.limits
    }

    /// Springs have a tangent, and something to fall back on where it cannot follow them.
    fn has_fall_back(&self) -> bool {
        self.kind != Kind::Continuum && self.cores.len() > 1
    }

    /// Hands over to the state what the step ends with.
    pub(super) fn end(&self, state: &mut DeformableState, scratch: &DeformableScratch) {
        state.convergence.clone_from(&scratch.implicit.convergence);
        state.pressures.copy_from_slice(&scratch.implicit.pressures);
    }

    /// True where the step starts from the inertial prediction; else from the last positions, in which
    /// case its matrix need only be half of the tangent, and what is far softer than the matrix creeps
    /// instead of flying on. Sheets by the bounding matrix do: out of plane they are much softer.
    pub(super) fn starts_ahead(&self, state: &DeformableState) -> bool {
        match self.has_fall_back() {
            _ if self.kind != Kind::Sheet => true,
            false => false,
            true => state.convergence.level < BOUNDING,
        }
    }

    /// What belongs to the whole step: the core, and the frames of the neighbourhoods.
    pub(super) fn begin(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        lanes(&scratch.reached, &mut scratch.coordinates);
        let implicit = &mut scratch.implicit;
        implicit.convergence.clone_from(&state.convergence);
        implicit.pressures.copy_from_slice(&state.pressures);
        implicit.inertia = (matter.is_free()).then(|| Inertia::of(matter, &scratch.reached));
        implicit.starts.copy_from_slice(&scratch.reached);
        implicit.last_m2 = f64::INFINITY;
        if self.has_fall_back() {
            implicit.convergence.step();
            if self.kind == Kind::Sheet {
                let now = greatest_stretch(matter, state, &mut scratch.coordinates);
                let follows = STRETCHES.iter().position(|&most| now <= most);
                implicit.by_stretch = follows.unwrap_or(STRETCHES.len() - 1);
                if follows.is_none() {
                    implicit.convergence.level = BOUNDING;
                }
                lanes(&scratch.reached, &mut scratch.coordinates);
            }
        }
        self.choose_core(scratch);
    }

    /// Takes the core that the corrections so far ask for, and its frames.
    fn choose_core(&self, scratch: &mut DeformableScratch) {
        let DeformableScratch {
            implicit,
            coordinates,
            ..
        } = scratch;
        let bounding = self.cores.len() - 1;
        implicit.core = match (self.kind, implicit.convergence.level) {
            (Kind::Continuum, _) => 0,
            (_, BOUNDING..) => bounding,
            _ if !self.has_fall_back() => bounding,
            (Kind::Lattice, level) => level as usize,
            (Kind::Sheet, 0) => implicit.by_stretch,
            (Kind::Sheet, _) => STRETCHES.len() - 1,
        };
        let ImplicitScratch {
            frames, followed, ..
        } = implicit;
        let core = (followed.as_ref()).map_or(&self.cores[implicit.core], |made| &*made.0);
        match &core.factor {
            Factor::Blocks(_) => self.frames.fit(coordinates, frames),
            Factor::Scalar(_) => frames.fill(IDENTITY),
        }
        for (frame, made_in) in frames.iter_mut().zip(&core.made_in) {
            *frame = since(frame, made_in);
        }
    }

    /// The core of this step.
    pub(super) fn core<'a>(&'a self, scratch: &'a ImplicitScratch) -> &'a Core {
        let own = &self.cores[scratch.core];
        (scratch.followed.as_ref()).map_or(own, |made| &*made.0)
    }

    /// After a step: whether its matrix can go on following the body. One that is to be made is
    /// [`Following::next`](super::following::Following::next).
    pub(super) fn look(
        &self,
        matter: &Matter,
        state: &mut DeformableState,
        scratch: &mut DeformableScratch,
    ) -> Follows {
        if self.kind != Kind::Continuum {
            return Follows::On;
        }
        let DeformableScratch {
            implicit,
            coordinates,
            nodes,
            ..
        } = scratch;
        let cores = (self.core(implicit), &self.cores[0]);
        let follows = follow::look(matter, cores, state, (coordinates, nodes));
        if follows == Follows::AtRest {
            implicit.followed = None;
        }
        follows
    }

    /// Makes a core where a body is to take one over; `None` where that has no factor, and the one there is goes on.
    pub(super) fn make(&self, matter: &Matter, shape: &Shape) -> Option<Made> {
        matrices::core_of(matter, &self.frames, shape).map(|core| Made(Arc::new(core)))
    }

    /// The matrix that the step takes instead of its own, if it does.
    pub(super) fn fall_back(&self, scratch: &ImplicitScratch) -> Option<FallBack> {
        match scratch.convergence.level {
            0 => None,
            level if level < BOUNDING => Some(FallBack::Firmer),
            _ => Some(FallBack::Bounding),
        }
    }

    /// A of the residual of backward Euler at the guess in `scratch.reached`, with the contact forces in
    /// `scratch.carried`, into `scratch.implicit.moved` (unknowns). Where that has grown, the guess goes half back first.
    pub(super) fn correct(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
        first: bool,
    ) {
        self.weigh(matter, state, scratch);
        if let Some(springs) = &self.springs
            && first
        {
            springs.calm_short(matter, state, scratch);
        }
        let last_j = scratch.implicit.merit_j;
        self.correct_by_core(matter, scratch, first);
        if self.iterations > 1 {
            if !first && scratch.implicit.merit_j > last_j {
                // Half of the last correction, and another look from there.
                let (before, mut look) = scratch.look();
                before.go_half_back(&mut look);
                self.weigh(matter, state, scratch);
                self.correct_by_core(matter, scratch, first);
            }
            let (before, look) = scratch.look();
            before.keep(&look);
        }
    }

    /// The correction of the residual, by a core that can follow it.
    fn correct_by_core(&self, matter: &Matter, scratch: &mut DeformableScratch, first: bool) {
        loop {
            self.answer(matter, scratch, true);
            let Some(springs) = &self.springs else { break };
            let implicit = &mut scratch.implicit;
            if !self.has_fall_back() || implicit.convergence.level >= BOUNDING {
                break;
            }
            let next = match first {
                true => implicit.turns_over(springs),
                false if implicit.diverges(springs) => implicit.convergence.level + 1,
                false => implicit.convergence.level,
            };
            if next == implicit.convergence.level {
                break;
            }
            implicit.convergence.raise(next);
            if !first {
                // From the next step on: the response of this one is settled.
                break;
            }
            lanes(&scratch.reached, &mut scratch.coordinates);
            self.choose_core(scratch);
        }
    }

    /// How the loads in `scratch.residual` (coordinates, N) move the body, into `scratch.implicit.moved` (unknowns, m);
    /// pressures follow. `with_gaps`: these are a residual, and pressures are to close their gaps.
    pub(super) fn answer(&self, matter: &Matter, scratch: &mut DeformableScratch, with_gaps: bool) {
        let DeformableScratch {
            implicit,
            residual,
            pull,
            nodes,
            node_residual,
            ..
        } = scratch;
        let own = &self.cores[implicit.core];
        let followed = implicit.followed.clone();
        let core = followed.as_ref().map_or(own, |made| &*made.0);
        let pressed = matter
            .law
            .continuum
            .as_ref()
            .filter(|_| !core.growth.is_empty());
        let rigid = (implicit.inertia.as_ref())
            .map(|inertia| inertia.take_rigid(matter, &implicit.starts, residual));
        let solid = pressed.filter(|_| with_gaps);
        if let Some(solid) = solid {
            pull.fill([0.0; 4]);
            match &matter.map {
                NodeMap::Same => solid.condense(&core.growth, &implicit.gaps, pull),
                NodeMap::Sparse(map) => {
                    node_residual.fill([0.0; 4]);
                    solid.condense(&core.growth, &implicit.gaps, node_residual);
                    map.add_transposed(node_residual, pull);
                }
            }
        }
        let unknowns = implicit.rows.iter_mut().zip(&implicit.frames);
        for ((row, frame), &c) in unknowns.zip(&matter.coordinate_of_unknown) {
            *row = into_rest(frame, &residual[c as usize]);
            if solid.is_some() {
                for (value, part) in row.iter_mut().zip(&pull[c as usize]) {
                    *value += part;
                }
            }
        }
        if self.iterations > 1 {
            implicit.loads.copy_from_slice(&implicit.rows);
        }
        core.factor.solve(&mut implicit.rows, &mut implicit.work);
        if self.iterations > 1 && with_gaps {
            let each = implicit.loads.as_flattened().iter();
            let each = each.zip(implicit.rows.as_flattened());
            implicit.merit_j = each.map(|(load, moved)| load * moved).sum();
        }
        if let Some(solid) = pressed {
            pull.fill([0.0; 4]);
            for (row, &c) in implicit.rows.iter().zip(&matter.coordinate_of_unknown) {
                pull[c as usize] = *row;
            }
            let moved = matter.nodes_of(pull, nodes);
            let share = matter.voigt();
            let gaps = with_gaps.then_some(&implicit.gaps[..]);
            solid.press(&core.growth, moved, share, gaps, &mut implicit.pressures);
        }
        let rows = implicit.rows.iter().zip(&implicit.frames);
        for ((row, frame), moved) in rows.zip(&mut implicit.moved) {
            let [x, y, z, _] = from_rest(frame, row);
            *moved = Vector3::new(x, y, z);
        }
        if let (Some(inertia), Some(rigid)) = (&implicit.inertia, rigid) {
            inertia.set_rigid(matter, &implicit.starts, &rigid, &mut implicit.moved);
        }
    }

    /// Finds how the rigid motions of a free body answer in this step: H = R B⁻¹ Rᵀ M T on the net, and Tᵀ M H.
    pub(super) fn find_rigid_part(&self, matter: &Matter, scratch: &mut DeformableScratch) {
        let ImplicitScratch {
            starts: from,
            inertia,
            rigid,
            rows,
            frames,
            work,
            followed,
            core,
            ..
        } = &mut scratch.implicit;
        let Some(inertia) = inertia else { return };
        let own = &self.cores[*core];
        let core = followed.as_ref().map_or(own, |made| &*made.0);
        let dt = matter.settings.dt_s;
        rigid.inverse = (1.0 / inertia.mass_kg, inertia.inverse);
        rigid.square_s2 = dt * dt;
        for (arm, &c) in rigid.arms.iter_mut().zip(&matter.surface) {
            *arm = from[c as usize] - inertia.centre;
        }
        for k in 0..6 {
            let motion = inertia.unit(k);
            // Nothing holds the body: unknowns are its coordinates.
            let each = rows.iter_mut().zip(frames.iter());
            for ((row, frame), (x, m)) in each.zip(from.iter().zip(&matter.masses)) {
                let load = motion.velocity(x) * *m;
                *row = into_rest(frame, &[load.x, load.y, load.z, 0.0]);
            }
            core.factor.solve(rows, work);
            let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
            let each = rows.iter_mut().zip(frames.iter());
            for ((row, frame), (x, m)) in each.zip(from.iter().zip(&matter.masses)) {
                *row = from_rest(frame, row);
                let moved = Vector3::new(row[0], row[1], row[2]) * *m;
                linear += moved;
                angular += (x - inertia.centre).cross(&moved);
            }
            rigid.whole[k] = [linear, angular];
            for (answer, &c) in rigid.answers.iter_mut().zip(&matter.surface) {
                let [x, y, z, _] = rows[c as usize];
                answer[k] = Vector3::new(x, y, z);
            }
        }
    }

    /// [`About::look`], where damping looks ahead as it does in the step.
    pub(super) fn miss(
        &self,
        matter: &Matter,
        about: &About,
        column: &[u32],
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        let springs = self.springs.as_ref();
        let look_ahead = springs.and_then(|springs| springs.look_ahead.as_ref());
        about.look(matter, look_ahead, state, scratch, |c| column[c as usize]);
    }

    /// Residual of backward Euler at the guess in `scratch.reached`, with the contact forces in
    /// `scratch.carried` and the pressures in `scratch.implicit`, into `scratch.residual`, and the gaps of those.
    pub(super) fn weigh(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        let inverse_dt = 1.0 / matter.settings.dt_s;
        for c in 0..state.positions.len() {
            let moved = scratch.reached[c] - state.positions[c];
            let due = (state.velocities[c] - moved * inverse_dt) * inverse_dt
                + scratch.field.at(&state.positions[c], &state.velocities[c]);
            let load = due * matter.masses[c];
            scratch.residual[c] = [load.x, load.y, load.z, 0.0];
        }
        for &(coordinate, force) in &scratch.carried {
            let lane = &mut scratch.residual[coordinate as usize];
            for (value, part) in lane.iter_mut().zip(force.iter()) {
                *value += part;
            }
        }
        if self.iterations > 1 {
            scratch.looked.copy_from_slice(&scratch.implicit.pressures);
        }
        match self
            .springs
            .as_ref()
            .and_then(|springs| springs.look_ahead.as_ref())
        {
            Some(look_ahead) => matter.look_ahead_short(look_ahead, state, scratch),
            None => matter.look_ahead(state, scratch),
        }
        matter.add_step_forces(state, scratch);
    }
}

impl Springs {
    fn new(matter: &Matter, kind: Kind, short: Vec<(u32, u32, f64)>) -> Self {
        let edges = shortest_edges(matter);
        let least = match kind {
            Kind::Sheet => WATCHED_OF_SHEETS,
            Kind::Continuum | Kind::Lattice => WATCHED,
        };
        let watched = |&c: &u32| least.map(|share| share * edges[c as usize]);
        Self {
            look_ahead: LookAhead::new(matter),
            watched_m: matter.coordinate_of_unknown.iter().map(watched).collect(),
            wild_m: WILD_LENGTH * middle(&edges),
            short,
        }
    }

    /// Damps what is as heavy as the matrix says only because its edges are short: it would swing on
    /// for seconds, slower than it should. Rigid translation is not damped; further iterations do
    /// without, and end where the step of the law alone does.
    fn calm_short(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        let moved = |c: usize| (scratch.reached[c] - state.positions[c]) * CALM;
        for &(i, j, value) in &self.short {
            let [a, b] = [i, j].map(|k| matter.coordinate_of_unknown[k as usize] as usize);
            let (by_a, by_b) = (moved(a) * value, moved(b) * value);
            for (lane, part) in scratch.residual[a].iter_mut().zip(by_b.iter()) {
                *lane -= part;
            }
            if a != b {
                for (lane, part) in scratch.residual[b].iter_mut().zip(by_a.iter()) {
                    *lane -= part;
                }
            }
        }
    }
}

/// R R₀ᵀ: how a neighbourhood has turned since it was in a frame.
fn since(frame: &Frame, made_in: &Frame) -> Frame {
    frame.map(|row| {
        let along = |k: usize| (0..3).map(|c| row[c] * made_in[k][c]).sum();
        [along(0), along(1), along(2)]
    })
}

/// The greatest stretch of a sheet now, or where damping looks.
fn greatest_stretch(matter: &Matter, state: &DeformableState, places: &mut [Lane]) -> f64 {
    let rest = matter.rest_lengths(state);
    lanes(&state.positions, places);
    let now = matter.law.greatest_stretch(rest, places);
    let ahead_s = matter.settings.dt_s + matter.damping_s;
    for (lane, v) in places.iter_mut().zip(&state.velocities) {
        for (value, part) in lane.iter_mut().zip(v.iter()) {
            *value += part * ahead_s;
        }
    }
    now.max(matter.law.greatest_stretch(rest, places))
}

impl ImplicitScratch {
    /// True when the correction in `moved` is larger than that of the iteration before.
    fn diverges(&mut self, springs: &Springs) -> bool {
        let size_m2: f64 = self.moved.iter().map(Vector3::norm_squared).sum();
        let rounding_m2: f64 = springs.watched_m.iter().map(|m| m[0] * m[0]).sum();
        let larger = size_m2 > self.last_m2 && size_m2 > rounding_m2;
        self.last_m2 = size_m2;
        larger
    }

    /// Remembers the corrections in `moved`; answers with the level of the matrix that can follow. One
    /// that turns over against the last without becoming smaller needs a firmer matrix, sooner if it is
    /// large; one that is wild, the bounding matrix at once.
    fn turns_over(&mut self, springs: &Springs) -> u32 {
        let (mut any, mut wild) = (false, false);
        let wild_m2 = springs.wild_m * springs.wild_m;
        let all = self.convergence.corrections.iter_mut().zip(&self.moved);
        for ((last, now), &[rounding_m, large_m]) in all.zip(&springs.watched_m) {
            let before = Vector3::new(last[0], last[1], last[2]);
            let (along, old, new) = (before.dot(now), before.norm_squared(), now.norm_squared());
            let turned = along < 0.0
                && along * along > 0.25 * old * new
                && new > 0.8 * old
                && new > rounding_m * rounding_m;
            let turns = if turned { last[3] + 1.0 } else { 0.0 };
            let large = new > large_m * large_m;
            wild |= turned && new > WILD * WILD * old && new > wild_m2;
            any |= turns >= TURNS[usize::from(large)];
            *last = [now.x, now.y, now.z, turns];
        }
        // What the second iteration moves answers contact too: nothing to compare it with.
        self.last_m2 = f64::INFINITY;
        match (wild, any) {
            (true, _) => BOUNDING,
            (_, true) => self.convergence.level + 1,
            _ => self.convergence.level,
        }
    }

    /// The frame of an unknown.
    pub(super) fn frame(&self, unknown: usize) -> &Frame {
        &self.frames[unknown]
    }
}

/// Greatest squared frequency that a body can have, 1/s²: Gershgorin's bound of M⁻¹ L over
/// coordinates.
pub(super) fn greatest_frequency_squared(matter: &Matter) -> f64 {
    let mut sums = vec![0.0; matter.unknown_count()];
    let mut matrix = SymmetricTriplets::new(matter.unknown_count());
    matter.map.add_edges(
        &matter.law.edges(Weight::Steepest),
        |c| matter.unknown(c as usize),
        &mut matrix,
    );
    // Entries may be given in parts; their sizes then only grow the bound.
    for &(i, j, value) in &matrix.entries {
        sums[i as usize] += value.abs();
        if i != j {
            sums[j as usize] += value.abs();
        }
    }
    let mass = |row: usize| matter.masses[matter.coordinate_of_unknown[row] as usize];
    debug_assert!(matter.unknown.iter().filter(|&&u| u != FIXED).count() == sums.len());
    sums.iter()
        .enumerate()
        .map(|(row, sum)| sum / mass(row))
        .fold(0.0, f64::max)
}
