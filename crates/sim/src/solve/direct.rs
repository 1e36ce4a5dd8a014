//! The end of a solve in few direct steps.
//!
//! Row by row a heavy body on light ones, or a high stack, takes thousands of sweeps. The laws of all rows together are
//! equations f = Π(f − K u), with Π the projection on what a row may do and u = b + D f; all but a few sweeps from their
//! solution Newton's method solves them (Alart & Curnier 1991). Π has a kink where a row begins to carry or to slip;
//! within a step each row keeps its side of it. Rows beyond what bodies have ways to move need some compliance of their
//! own.

use super::friction::FrictionLaw;
use super::matrix::ContactMatrix;
use super::problem::ContactProblem;
use palpate_geometry::math::{Matrix3, Vector3};

/// Most unknowns of a step: its work grows with their cube.
const MOST: usize = 288;
/// Steps of a solve.
const STEPS: usize = 12;
/// How often a step that makes nothing better is halved.
const HALVED: usize = 3;
/// A solve is at its end when no force is wrong by more than this share of the largest.
const ENOUGH: f64 = 1e-9;

/// A row that may change.
#[derive(Clone, Copy, Debug)]
struct Active {
    row: usize,
    /// Its first unknown.
    start: usize,
    /// Three, or one along its normal, or none where it does not carry.
    unknowns: usize,
    /// ∂Π/∂w.
    slope: Matrix3,
    /// Π(w), N.
    allowed: Vector3,
    /// Before the step, m.
    displaced: Vector3,
}

/// Buffers of direct steps.
#[derive(Clone, Debug)]
pub struct Direct {
    active: Vec<Active>,
    /// Row by row: by how much each unknown moves an equation; then minus what is missed.
    system: Vec<f64>,
    /// By equation, the unknowns behind which it has none.
    ends: Vec<usize>,
    /// Forces before a step and after it, N.
    before: Vec<f64>,
    after: Vec<f64>,
    /// Those of the sweeps, and the best so far, N.
    swept: Vec<f64>,
    best: Vec<f64>,
    /// Most unknowns.
    room: usize,
}

impl Direct {
    /// Buffers for `rows` rows of so many directions; none where nothing is solved so.
    pub fn new(rows: usize, directions: usize) -> Self {
        let room = directions.min(MOST);
        Self {
            active: Vec::with_capacity(rows),
            system: vec![0.0; room * (room + 1)],
            ends: vec![0; room],
            before: Vec::with_capacity(directions),
            after: Vec::with_capacity(directions),
            swept: Vec::with_capacity(directions),
            best: Vec::with_capacity(directions),
            room,
        }
    }

    /// Ends a solve. `concerns` says which rows it may change, with all that they move. False where they are too many.
    pub fn end(
        &mut self,
        problem: &mut ContactProblem,
        matrix: &ContactMatrix,
        concerns: impl Fn(usize) -> bool,
    ) -> bool {
        let swept = problem.missed();
        self.swept.clear();
        self.swept.extend_from_slice(problem.forces());
        let mut least = swept;
        // Far off, which rows slip is not known: most often none of those that carry does.
        for lies in [false, true] {
            if least <= ENOUGH {
                break;
            }
            if lies {
                self.best.clear();
                self.best.extend_from_slice(problem.forces());
                problem.restore(matrix, &self.swept);
            }
            let Some(missed) = self.run(problem, matrix, &concerns, lies) else {
                return false;
            };
            if lies && missed >= least {
                problem.restore(matrix, &self.best);
            }
            least = missed.min(least);
        }
        if least < swept {
            // What is left may be at the edge of a law by rounding.
            problem.solve(matrix, 1);
        }
        true
    }

    /// Steps until one makes nothing better, and answers with what is missed then. `lies`: in the first one no row slips
    /// that carries, and all are taken whatever they do.
    fn run(
        &mut self,
        problem: &mut ContactProblem,
        matrix: &ContactMatrix,
        concerns: &impl Fn(usize) -> bool,
        lies: bool,
    ) -> Option<f64> {
        let mut missed = problem.missed();
        for step in 0..STEPS {
            let first = lies && step == 0;
            let size = self.choose(problem, concerns, first)?;
            self.before.clear();
            self.before.extend_from_slice(problem.forces());
            if !self.step(problem, matrix, size) {
                problem.restore(matrix, &self.before);
                break;
            }
            let mut now = problem.missed();
            for _ in 0..HALVED {
                if lies || now < missed {
                    break;
                }
                let shorter = self.after.iter_mut().zip(&self.before);
                shorter.for_each(|(after, before)| *after = 0.5 * (*after + before));
                problem.restore(matrix, &self.after);
                now = problem.missed();
            }
            let better = lies || now < missed;
            if !better {
                problem.restore(matrix, &self.before);
                break;
            }
            missed = now;
            if missed <= ENOUGH {
                break;
            }
        }
        Some(missed)
    }

    /// Takes the rows that may change, and answers with the number of unknowns; `None` for too many. `sticks`: those that
    /// carry do not slip.
    fn choose(
        &mut self,
        problem: &ContactProblem,
        concerns: &impl Fn(usize) -> bool,
        sticks: bool,
    ) -> Option<usize> {
        self.active.clear();
        let mut start = 0;
        for row in (0..problem.rows()).filter(|&row| concerns(row)) {
            let wish = problem.wish(row);
            let projected = project(&problem.law(row), problem.normal(row), &wish);
            let Some((mut allowed, mut slope)) = projected else {
                continue;
            };
            if sticks && slope != Matrix3::zeros() {
                (allowed, slope) = (wish, Matrix3::identity());
            }
            let unknowns = match (slope == Matrix3::zeros(), problem.is_whole(row)) {
                (true, _) => 0,
                (false, true) => 3,
                (false, false) => 1,
            };
            self.active.push(Active {
                row,
                start,
                unknowns,
                slope,
                allowed,
                displaced: problem.displaced_m(row),
            });
            start += unknowns;
        }
        (start <= self.room).then_some(start)
    }

    /// One step of Newton's method; false where its matrix has no inverse.
    fn step(&mut self, problem: &mut ContactProblem, matrix: &ContactMatrix, size: usize) -> bool {
        // What does not carry has no force, whatever the others do.
        for of in self.active.iter().filter(|of| of.unknowns == 0) {
            if problem.carries(of.row) {
                problem.set_force(matrix, of.row, &Vector3::zeros());
            }
        }
        let width = size + 1;
        for of in self.active.iter().filter(|of| of.unknowns > 0) {
            let against = of.slope * problem.stiffness(of.row);
            let moved = problem.displaced_m(of.row) - of.displaced;
            let missed = of.allowed - problem.force_n(of.row) - against * moved;
            let normal = problem.normal(of.row);
            let equations = &mut self.system[of.start * width..];
            for other in self.active.iter().filter(|other| other.unknowns > 0) {
                let moves = matrix.whole(of.row, other.row);
                let mut block = match moves == Matrix3::zeros() {
                    true => moves,
                    false => against * moves,
                };
                if other.row == of.row {
                    block += Matrix3::identity() - of.slope;
                }
                let by = problem.normal(other.row);
                for a in 0..of.unknowns {
                    let row = match of.unknowns {
                        1 => normal.transpose() * block,
                        _ => block.row(a).into_owned(),
                    };
                    let to = &mut equations[a * width + other.start..];
                    match other.unknowns {
                        1 => to[0] = (row * by).x,
                        _ => to[..3].copy_from_slice(row.transpose().as_slice()),
                    }
                }
            }
            for a in 0..of.unknowns {
                equations[a * width + size] = match of.unknowns {
                    1 => missed.dot(normal),
                    _ => missed[a],
                };
            }
        }
        if !eliminate(&mut self.system[..size * width], &mut self.ends[..size]) {
            return false;
        }
        for of in self.active.iter().filter(|of| of.unknowns > 0) {
            let change = |a: usize| self.system[(of.start + a) * width + size];
            let change = match of.unknowns {
                1 => problem.normal(of.row) * change(0),
                _ => Vector3::new(change(0), change(1), change(2)),
            };
            let force = problem.force_n(of.row) + change;
            problem.set_force(matrix, of.row, &force);
        }
        self.after.clear();
        self.after.extend_from_slice(problem.forces());
        true
    }
}

/// The force that a law allows in place of a wish, and its slope; `None` for rows that drag, whose forces stay.
fn project(law: &FrictionLaw, normal: &Vector3, wish: &Vector3) -> Option<(Vector3, Matrix3)> {
    let aside = |size: f64, across: Vector3| {
        let way = across / size;
        (way, Matrix3::identity() - way * way.transpose())
    };
    match *law {
        FrictionLaw::Push { drag_n_m, .. } if drag_n_m > 0.0 => None,
        FrictionLaw::Push { mu, .. } => {
            let along = wish.dot(normal);
            let pushes = along > 0.0;
            if !pushes {
                return Some((Vector3::zeros(), Matrix3::zeros()));
            }
            let across = wish - normal * along;
            let (size, most) = (across.norm(), mu * along);
            if size <= most {
                return Some((*wish, Matrix3::identity()));
            }
            let (way, turns) = aside(size, across);
            let out = normal * normal.transpose();
            let slope = (normal + way * mu) * normal.transpose() + (turns - out) * (most / size);
            Some((normal * along + way * most, slope))
        }
        FrictionLaw::Grip { limit_n } => {
            let size = wish.norm();
            if size <= limit_n {
                return Some((*wish, Matrix3::identity()));
            }
            let (way, turns) = aside(size, *wish);
            Some((way * limit_n, turns * (limit_n / size)))
        }
    }
}

/// Gaussian elimination of as many rows of one number more as there are `ends`, with the largest pivot of each column; the
/// last column becomes the solution. False for a matrix without an inverse. Bodies in a row make a band of it: `ends` takes
/// where each row is zero from on, but for its last number.
fn eliminate(rows: &mut [f64], ends: &mut [usize]) -> bool {
    let size = ends.len();
    let width = size + 1;
    for (row, end) in rows.chunks_exact(width).zip(&mut *ends) {
        *end = row[..size].iter().rposition(|x| *x != 0.0).unwrap_or(0) + 1;
    }
    for k in 0..size {
        let mut largest = k;
        for row in k + 1..size {
            if rows[row * width + k].abs() > rows[largest * width + k].abs() {
                largest = row;
            }
        }
        if largest != k {
            let (above, below) = rows.split_at_mut(largest * width);
            above[k * width..][..width].swap_with_slice(&mut below[..width]);
            ends.swap(k, largest);
        }
        let pivot = rows[k * width + k];
        if pivot == 0.0 || !pivot.is_finite() {
            return false;
        }
        let end = ends[k];
        let (above, below) = rows.split_at_mut((k + 1) * width);
        let own = &above[k * width..];
        for (row, other_end) in below.chunks_exact_mut(width).zip(&mut ends[k + 1..]) {
            let share = row[k] / pivot;
            if share != 0.0 {
                for (to, from) in row[k + 1..end].iter_mut().zip(&own[k + 1..end]) {
                    *to -= share * from;
                }
                row[size] -= share * own[size];
                *other_end = end.max(*other_end);
            }
        }
    }
    for k in (0..size).rev() {
        let mut sum = rows[k * width + size];
        for column in k + 1..ends[k] {
            sum -= rows[k * width + column] * rows[column * width + size];
        }
        rows[k * width + size] = sum / rows[k * width + k];
    }
    (0..size).all(|k| rows[k * width + size].is_finite())
}
