//! Backward Euler, one or a few iterations of a quasi-Newton method with a constant matrix B, factored
//! at build.
//!
//! A step starts from the inertial prediction y = x + dt v and corrects it by
//! `B⁻¹ (M (g − (z − y) / dt²) + f(z) + F)`, F the contact forces so far. What is at rest stays at rest
//! to the last bit, and equilibrium does not depend on B. Linear analysis: stable while the tangent of
//! backward Euler is below 4/3 of B.
//!
//! B is the tangent of rest, turned with each coordinate's neighbourhood (stiffness warping), of a sheet
//! with as much tension as it has; or, where that is too large or too stiff for single precision, a
//! scalar matrix above every tangent: projective dynamics (Bouaziz et al. 2014). Contact answers by a
//! third matrix, that of [`MaterialLaw::edges`](super::elements::MaterialLaw::edges), whose
//! columns W are scalar; a sheet, by what B itself answers along the normals.
//! The contact forces of the step before stand in the correction from the start, and W answers for what
//! they change: x' = y + B⁻¹ (… + F₀) + W (F − F₀).

mod matrices;

use super::caution::{BOUNDING, Caution, ImplicitScratch};
use super::elements::continuum::TANGENT_REACH;
use super::frame::{Frame, IDENTITY, from_rest, into_rest};
use super::frames::Frames;
use super::look_ahead::LookAhead;
use super::matter::{FIXED, Matter, lanes};
use super::scalar_factor::ScalarFactor;
use super::settings::{DeformableError, FallBack, StepMatrix};
use super::soft_modes::SoftModes;
use super::state::{DeformableScratch, DeformableState};
use crate::body::elements::Weight;
use matrices::{bounding, is_too_stiff, places, scalar_matrix, tangent_of};
use palpate_geometry::math::{BlockCholesky, Cholesky, Lane, Rows, SymmetricTriplets, Vector3};

/// Most numbers of a factor in blocks for each second of a step: what a core reads in about that time.
const MOST_NUMBERS: f64 = 3e9;
/// Fewest numbers that are affordable, however short a step is.
const FEW_NUMBERS: usize = 3_000_000;
/// Most numbers of a factor that the scene asks for: half a gigabyte.
const MOST_ASKED_FOR: usize = 150_000_000;

/// The factors, and what further iterations need.
#[derive(Debug)]
pub(super) struct ImplicitStep {
    matrix: Matrix,
    iterations: usize,
    look_ahead: Option<LookAhead>,
}

#[derive(Debug)]
enum Matrix {
    Bounding(ScalarFactor),
    Tangent(Box<Tangent>),
}

#[derive(Debug)]
struct Tangent {
    /// Of a solid: the tangent of rest, and one that is firmer against turning, for strained bodies. Of
    /// a sheet: the tangent of rest, with the tension of each of [`TAUT`].
    factors: Vec<BlockCholesky>,
    sheet: bool,
    frames: Frames,
    /// For states whose tangent is beyond 4/3 of both.
    bounding: ScalarFactor,
    /// (unknowns), m: corrections below this are rounding; and those that are watched at once.
    watched_m: Vec<[f64; 2]>,
    /// Length of a correction that may be wild, m.
    wild_m: f64,
    /// Laplacian of what short edges carry beyond others, N/m: (unknown, unknown, value), the lower
    /// triangle.
    short: Vec<(u32, u32, f64)>,
}

/// How taut springs of a sheet are, 1 − rest length / length, up to which each of its factors follows.
const TAUT: [f64; 4] = [0.002, 0.01, 0.06, 0.3];

/// What forces held on the net through one step move.
#[derive(Debug, Default)]
pub(super) struct Response {
    /// (coordinates of the net × unknowns), row by row, m/N: of each way in which a step may answer,
    /// the last that of steps that take the bounding matrix.
    pub columns: Vec<Vec<f64>>,
    /// Motions for which the columns are too stiff, but for those of the bounding matrix.
    pub modes: SoftModes,
}

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
        let affordable = (MOST_NUMBERS * matter.settings.dt_s) as usize;
        let tangent = match wanted {
            StepMatrix::Bounding => None,
            StepMatrix::Auto => tangent_of(matter, affordable.max(FEW_NUMBERS)),
            StepMatrix::Tangent => tangent_of(matter, MOST_ASKED_FOR),
        };
        let matrix = match tangent {
            Some(tangent) => Matrix::Tangent(Box::new(tangent)),
            None => Matrix::Bounding(bounding(matter)?),
        };
        Ok(Self {
            matrix,
            iterations,
            look_ahead: LookAhead::new(matter),
        })
    }

    /// Keeps the scalar factor of a large body in single precision from here on, where that is good:
    /// after [`ImplicitStep::response`], whose columns are of the exact one.
    pub(super) fn round(&mut self, matter: &Matter) {
        let mut stiffest = vec![0.0; matter.unknown_count()];
        for (i, j, value) in scalar_matrix(matter, &matter.law.edges(Weight::Bounding)).entries {
            if i == j {
                stiffest[i as usize] += value;
            }
        }
        if !is_too_stiff(matter, &stiffest) {
            match &mut self.matrix {
                Matrix::Bounding(factor) => factor.round(),
                Matrix::Tangent(tangent) => tangent.bounding.round(),
            }
        }
    }

    pub(super) fn iterations(&self) -> usize {
        self.iterations
    }

    /// `tangent` or `bounding`.
    pub(super) fn matrix_name(&self) -> &'static str {
        match &self.matrix {
            Matrix::Bounding(_) => "bounding",
            Matrix::Tangent(_) => "tangent",
        }
    }

    /// Numbers in the factor.
    pub(super) fn factor_non_zeros(&self) -> usize {
        match &self.matrix {
            Matrix::Bounding(factor) => factor.non_zeros(),
            Matrix::Tangent(tangent) => tangent.factors[0].non_zeros(),
        }
    }

    /// Bits of most of those numbers.
    pub(super) fn factor_bits(&self) -> u32 {
        match &self.matrix {
            Matrix::Bounding(ScalarFactor::Double(_)) => 64,
            Matrix::Bounding(ScalarFactor::Single(_)) => 32,
            Matrix::Tangent(tangent) => tangent.factors[0].bits(),
        }
    }

    pub(super) fn scratch(&self, matter: &Matter) -> ImplicitScratch {
        let n = matter.unknown_count();
        match &self.matrix {
            Matrix::Bounding(factor) => ImplicitScratch {
                rhs: vec![Vector3::zeros(); n],
                scalar: factor.work(n),
                ..ImplicitScratch::default()
            },
            Matrix::Tangent(tangent) => ImplicitScratch {
                frames: vec![Frame::default(); n],
                work: tangent.factors[0].work(),
                blocks: Rows::zeros(n),
                rhs: vec![Vector3::zeros(); n],
                scalar: tangent.bounding.work(n),
                caution: self.caution(matter),
                last_m2: f64::INFINITY,
                normals: match tangent.sheet {
                    true => vec![Vector3::zeros(); n],
                    false => Vec::new(),
                },
                taut: 0,
                answer: 0,
                answers_bounding: false,
            },
        }
    }

    /// That of a body at rest.
    pub(super) fn caution(&self, matter: &Matter) -> Caution {
        match &self.matrix {
            Matrix::Bounding(_) => Caution::default(),
            Matrix::Tangent(_) => {
                let mut caution = Caution {
                    corrections: vec![[0.0; 4]; matter.unknown_count()],
                    ..Caution::default()
                };
                caution.set_to_rest();
                caution
            }
        }
    }

    /// Hands the caution of the step over to the state.
    pub(super) fn end(&self, state: &mut DeformableState, scratch: &DeformableScratch) {
        state.caution.clone_from(&scratch.implicit.caution);
    }

    /// What contact forces move in the step in which they change: W e of each of the given
    /// coordinates, and the motions that W is too stiff for.
    pub(super) fn response(
        &self,
        matter: &Matter,
        surface: &[u32],
    ) -> Result<Response, DeformableError> {
        let columns = |factor: &Cholesky| {
            let n = matter.unknown_count();
            let mut columns = Vec::with_capacity(surface.len() * n);
            for &coordinate in surface {
                let start = columns.len();
                columns.resize(start + n, 0.0);
                columns[start + matter.unknown[coordinate as usize] as usize] = 1.0;
                factor.solve_one(&mut columns[start..]);
            }
            columns
        };
        let of = |edges: &[(u32, u32, f64)]| {
            let matrix = scalar_matrix(matter, edges);
            let factor = Cholesky::placed(&matrix, &places(matter))?;
            Ok::<_, DeformableError>((columns(&factor), matrix))
        };
        let of_bounding = |factor: &ScalarFactor| match factor {
            ScalarFactor::Double(factor) => Ok(columns(factor)),
            ScalarFactor::Single(_) => {
                of(&matter.law.edges(Weight::Bounding)).map(|(columns, _)| columns)
            }
        };
        let tangent = match &self.matrix {
            Matrix::Bounding(factor) => {
                return Ok(Response {
                    columns: vec![of_bounding(factor)?],
                    modes: SoftModes::default(),
                });
            }
            Matrix::Tangent(tangent) => tangent,
        };
        let (mut all, mut modes) = (Vec::new(), SoftModes::default());
        if tangent.sheet {
            all.extend(tangent.across_sheet(matter, surface));
        } else {
            let (columns, matrix) = of(&matter.law.edges(Weight::Response))?;
            all.push(columns);
            modes = SoftModes::new(&tangent.factors[0], &matrix);
        }
        all.push(of_bounding(&tangent.bounding)?);
        Ok(Response {
            columns: all,
            modes,
        })
    }

    /// True where the step starts from the inertial prediction; else from the last positions, in which
    /// case its matrix need only be half of the tangent, and what is far softer than the matrix creeps
    /// instead of flying on. Sheets by the bounding matrix do: out of plane they are much softer.
    pub(super) fn starts_ahead(&self, matter: &Matter, state: &DeformableState) -> bool {
        let follows = match &self.matrix {
            Matrix::Bounding(_) => matter.law.is_solid(),
            Matrix::Tangent(tangent) => !tangent.sheet || state.caution.level < BOUNDING,
        };
        follows && !state.caution.held
    }

    /// What belongs to the whole step: the frames of the neighbourhoods.
    pub(super) fn begin(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        scratch.implicit.caution.clone_from(&state.caution);
        if let Matrix::Tangent(tangent) = &self.matrix {
            lanes(&scratch.reached, &mut scratch.coordinates);
            let ImplicitScratch {
                frames,
                caution,
                normals,
                taut,
                ..
            } = &mut scratch.implicit;
            tangent.frames.fit(&scratch.coordinates, frames);
            tangent.frames.turn_normals(frames, normals);
            caution.step();
            if caution.held {
                caution.level = BOUNDING;
            }
            if tangent.sheet {
                let now = tautness(matter, state, &mut scratch.coordinates);
                let follows = TAUT.iter().position(|&most| now <= most);
                *taut = follows.unwrap_or(TAUT.len() - 1);
                if follows.is_none() {
                    caution.level = BOUNDING;
                }
            }
            // Until the first correction says otherwise; a scratch that only follows asks no further.
            self.settle_response(scratch);
        }
    }

    /// The matrix that the step takes instead of its own, if it does.
    pub(super) fn fall_back(&self, scratch: &ImplicitScratch) -> Option<FallBack> {
        match scratch.caution.level {
            0 => None,
            level if level < BOUNDING => Some(FallBack::Firmer),
            _ => Some(FallBack::Bounding),
        }
    }

    /// Settles by which response contact answers in this step: after the first correction.
    pub(super) fn settle_response(&self, scratch: &mut DeformableScratch) {
        let Matrix::Tangent(tangent) = &self.matrix else {
            return;
        };
        let implicit = &mut scratch.implicit;
        implicit.answers_bounding = implicit.caution.level >= BOUNDING;
        implicit.answer = match (implicit.answers_bounding, tangent.sheet) {
            (false, false) => 0,
            (true, false) => 1,
            (true, true) => TAUT.len(),
            (false, true) if implicit.caution.level > 0 => TAUT.len() - 1,
            (false, true) => implicit.taut,
        };
    }

    /// Adds B⁻¹ of the residual of backward Euler, with the contact forces in `scratch.carried`, to
    /// the guess in `scratch.reached`.
    pub(super) fn correct(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
        first: bool,
    ) {
        self.weigh_motion(matter, state, scratch);
        if first {
            self.calm_short(matter, state, scratch);
        }
        let follows = matches!(self.matrix, Matrix::Tangent(_));
        scratch.farther = match follows && scratch.implicit.caution.level < BOUNDING {
            true => TANGENT_REACH,
            false => 1.0,
        };
        self.weigh_law(matter, state, scratch);
        let DeformableScratch {
            implicit,
            residual,
            reached,
            limited,
            ..
        } = scratch;
        if first {
            implicit.caution.held = *limited > 0;
        }
        match &self.matrix {
            Matrix::Bounding(factor) => implicit.solve_scalar(factor, matter, residual),
            Matrix::Tangent(tangent) => loop {
                match tangent.factor(implicit.caution.level, implicit.taut) {
                    Some(factor) => implicit.solve_blocks(factor, matter, residual),
                    None => {
                        implicit.solve_scalar(&tangent.bounding, matter, residual);
                        break;
                    }
                }
                let next = match first {
                    true => implicit.turns_over(tangent),
                    // Of a sheet the response is too soft in plane: what it moves there is taken back.
                    false if !tangent.sheet && implicit.diverges(tangent) => {
                        implicit.caution.level + 1
                    }
                    false => implicit.caution.level,
                };
                if next == implicit.caution.level {
                    break;
                }
                implicit.caution.raise(next);
            },
        }
        for (moved, &c) in implicit.rhs.iter().zip(&matter.coordinate_of_unknown) {
            reached[c as usize] += *moved;
        }
    }

    /// Residual of backward Euler at the guess in `scratch.reached`, with the contact forces in
    /// `scratch.carried`, into `scratch.residual`; cells are followed as far as `scratch.farther` says.
    pub(super) fn weigh(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        self.weigh_motion(matter, state, scratch);
        self.weigh_law(matter, state, scratch);
    }

    /// The part of inertia, field and contact.
    fn weigh_motion(
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
    }

    /// The part of the law, ahead of the guess by what damping looks ahead.
    fn weigh_law(&self, matter: &Matter, state: &DeformableState, scratch: &mut DeformableScratch) {
        lanes(&scratch.reached, &mut scratch.coordinates);
        self.look_ahead(matter, state, scratch);
        matter.add_law_forces(state, scratch);
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
        let Matrix::Tangent(tangent) = &self.matrix else {
            return;
        };
        let moved = |c: usize| (scratch.reached[c] - state.positions[c]) * CALM;
        for &(i, j, value) in &tangent.short {
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

    /// Moves the coordinates at which the law is asked ahead by d ẋ, without that of rigid motion.
    fn look_ahead(
        &self,
        matter: &Matter,
        state: &DeformableState,
        scratch: &mut DeformableScratch,
    ) {
        let Some(look_ahead) = &self.look_ahead else {
            return;
        };
        let share = matter.damping_s / matter.settings.dt_s;
        let turning = scratch.turning;
        let moved = scratch.reached.iter().zip(&state.positions);
        for ((z, x), ahead) in moved.zip(&mut scratch.ahead) {
            *ahead = (z - x) * share;
            if let Some(turning) = &turning {
                let middle = nalgebra::center(x, z) - turning.linear * (0.5 * matter.settings.dt_s);
                *ahead -= turning.velocity(&middle) * matter.damping_s;
            }
        }
        look_ahead.add(&scratch.ahead, &mut scratch.coordinates);
    }
}

impl Tangent {
    /// Of each factor: the columns of a scalar response that moves a sheet across itself as the factor
    /// does, `n_iᵀ B⁻¹ n_j` times `n_i·n_j`. The columns meet forces and answer with motions along the
    /// normals n, so that the sign is right where two sides of a shell face each other.
    fn across_sheet(&self, matter: &Matter, surface: &[u32]) -> Vec<Vec<f64>> {
        let n = matter.unknown_count();
        let mut normals = vec![Vector3::zeros(); n];
        self.frames.turn_normals(&vec![IDENTITY; n], &mut normals);
        let rows: Vec<usize> = (surface.iter())
            .map(|&c| matter.unknown[c as usize] as usize)
            .collect();
        let of_factor = |factor: &BlockCholesky| {
            let mut work = factor.work();
            let mut columns = Vec::with_capacity(rows.len() * n);
            for &row in &rows {
                let here = normals[row];
                let mut moved = Rows::zeros(n);
                moved[row] = [here.x, here.y, here.z, 0.0];
                factor.solve(&mut moved, &mut work);
                columns.extend(moved.iter().zip(&normals).map(|(&[x, y, z, _], normal)| {
                    Vector3::new(x, y, z).dot(normal) * here.dot(normal)
                }));
            }
            // Rounding of the factor is not symmetric.
            for (i, &a) in rows.iter().enumerate() {
                for (j, &b) in rows.iter().enumerate().take(i) {
                    let (there, back) = (i * n + b, j * n + a);
                    let mean = 0.5 * (columns[there] + columns[back]);
                    (columns[there], columns[back]) = (mean, mean);
                }
            }
            columns
        };
        self.factors.iter().map(of_factor).collect()
    }

    /// `None` where the bounding matrix is meant.
    fn factor(&self, level: u32, taut: usize) -> Option<&BlockCholesky> {
        match level {
            0 => self.factors.get(taut),
            level if level < BOUNDING => self.factors.last(),
            _ => None,
        }
    }
}

/// How taut a sheet is, or will be where damping looks.
fn tautness(matter: &Matter, state: &DeformableState, places: &mut [Lane]) -> f64 {
    let rest = matter.rest_lengths(state);
    lanes(&state.positions, places);
    let now = matter.law.tautness(rest, places);
    let ahead_s = matter.settings.dt_s + matter.damping_s;
    for (lane, v) in places.iter_mut().zip(&state.velocities) {
        for (value, part) in lane.iter_mut().zip(v.iter()) {
            *value += part * ahead_s;
        }
    }
    now.max(matter.law.tautness(rest, places))
}

impl ImplicitScratch {
    /// A⁻¹ r into `rhs`.
    fn solve_scalar(&mut self, factor: &ScalarFactor, matter: &Matter, residual: &[Lane]) {
        for (rhs, &c) in self.rhs.iter_mut().zip(&matter.coordinate_of_unknown) {
            let [x, y, z, _] = residual[c as usize];
            *rhs = Vector3::new(x, y, z);
        }
        factor.solve(&mut self.rhs, &mut self.scalar);
    }

    /// R B⁻¹ Rᵀ r into `rhs`.
    fn solve_blocks(&mut self, factor: &BlockCholesky, matter: &Matter, residual: &[Lane]) {
        let coordinates = matter.coordinate_of_unknown.iter();
        for ((block, frame), &c) in self.blocks.iter_mut().zip(&self.frames).zip(coordinates) {
            *block = into_rest(frame, &residual[c as usize]);
        }
        factor.solve(&mut self.blocks, &mut self.work);
        for ((block, frame), rhs) in self.blocks.iter().zip(&self.frames).zip(&mut self.rhs) {
            let [x, y, z, _] = from_rest(frame, block);
            *rhs = Vector3::new(x, y, z);
        }
    }

    /// True when the correction in `rhs` is larger than that of the iteration before.
    fn diverges(&mut self, tangent: &Tangent) -> bool {
        let size_m2: f64 = self.rhs.iter().map(Vector3::norm_squared).sum();
        let rounding_m2: f64 = tangent.watched_m.iter().map(|m| m[0] * m[0]).sum();
        let larger = size_m2 > self.last_m2 && size_m2 > rounding_m2;
        self.last_m2 = size_m2;
        larger
    }

    /// Remembers the corrections in `rhs`; answers with the level of the matrix that can follow. One
    /// that turns over against the last without becoming smaller needs a firmer matrix, sooner if it is
    /// large; one that is wild, the bounding matrix at once.
    fn turns_over(&mut self, tangent: &Tangent) -> u32 {
        let (mut any, mut wild) = (false, false);
        let wild_m2 = tangent.wild_m * tangent.wild_m;
        let all = self.caution.corrections.iter_mut().zip(&self.rhs);
        for ((last, now), &[rounding_m, large_m]) in all.zip(&tangent.watched_m) {
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
            (_, true) => self.caution.level + 1,
            _ => self.caution.level,
        }
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
