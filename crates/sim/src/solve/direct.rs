//! The end of a solve in few direct steps.
//!
//! Row by row a heavy body on light ones, or a high stack, takes thousands of sweeps. But which rows carry, and which
//! of them slip, is known after few. With that known the laws are linear: what sticks is not displaced, what slips is
//! not along its normal and carries across as much as its cone allows, in the direction in which it slips now. A step
//! solves that system (an active set, a semismooth Newton step: Alart & Curnier 1991); sweeps put right where what
//! carries or slips was guessed wrong. Rows of one face that stick are more than their body has ways to move: a
//! trace of their own compliance chooses the smallest change.

use super::friction::FrictionLaw;
use super::matrix::ContactMatrix;
use super::problem::ContactProblem;
use palpate_geometry::math::Vector3;

/// Most unknowns of a step: its work grows with their cube, 3 ms of it.
const MOST: usize = 192;
/// Of its own compliance that a row gives way more within a step.
const TRACE: f64 = 1e-10;
/// Steps of a solve.
const STEPS: usize = 5;
/// Sweeps after each.
const SWEEPS: usize = 3;
/// A solve is at its end when no force is wrong by more than this share of the largest.
const ENOUGH: f64 = 1e-9;

/// What a row is in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// Its force stays what it is.
    Keeps,
    /// It has none.
    Parts,
    /// Along its normal, or in all directions.
    Sticks,
    /// Along its normal, and across by this much of it.
    Slips(Vector3),
}

/// Buffers of direct steps.
#[derive(Clone, Debug)]
pub struct Direct {
    /// By row.
    ways: Vec<Way>,
    /// By unknown: its row and its direction there.
    unknowns: Vec<(u32, Vector3)>,
    /// Row by row: by how much each unknown moves an equation; then minus what is missed.
    system: Vec<f64>,
    /// Forces of the best step so far, N.
    best: Vec<f64>,
}

impl Direct {
    /// Buffers for `rows` rows of so many directions; none where nothing is solved so.
    pub fn new(rows: usize, directions: usize) -> Self {
        let most = directions.min(MOST);
        Self {
            ways: Vec::with_capacity(rows),
            unknowns: Vec::with_capacity(most),
            system: vec![0.0; most * (most + 1)],
            best: Vec::with_capacity(directions),
        }
    }

    /// Ends a solve. `concerns` says which rows it may change, with all that they move. False where they are too many.
    pub fn end(
        &mut self,
        problem: &mut ContactProblem,
        matrix: &ContactMatrix,
        concerns: impl Fn(usize) -> bool,
    ) -> bool {
        let mut missed = problem.missed();
        for _ in 0..STEPS {
            if missed <= ENOUGH {
                return true;
            }
            if !self.choose(problem, &concerns) {
                return false;
            }
            self.best.clear();
            self.best.extend_from_slice(problem.forces());
            self.step(problem, matrix);
            problem.solve(matrix, SWEEPS);
            let now = problem.missed();
            let better = now < missed;
            if !better {
                problem.restore(matrix, &self.best);
                return true;
            }
            missed = now;
        }
        true
    }

    /// Which rows carry and which slip; false where they are too many.
    fn choose(&mut self, problem: &ContactProblem, concerns: &impl Fn(usize) -> bool) -> bool {
        self.ways.clear();
        self.unknowns.clear();
        for i in 0..problem.rows() {
            let way = match concerns(i) {
                true => way(problem, i),
                false => Way::Keeps,
            };
            let row = i as u32;
            let normal = *problem.normal(i);
            let room = MOST.min(self.unknowns.capacity());
            let more = match way {
                Way::Keeps | Way::Parts => 0,
                Way::Sticks if problem.is_whole(i) => 3,
                _ => 1,
            };
            if self.unknowns.len() + more > room {
                return false;
            }
            match way {
                Way::Keeps | Way::Parts => {}
                Way::Sticks if more == 3 => {
                    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
                    self.unknowns.extend(axes.map(|axis| (row, axis)));
                }
                Way::Sticks => self.unknowns.push((row, normal)),
                Way::Slips(across) => self.unknowns.push((row, normal + across)),
            }
            self.ways.push(way);
        }
        true
    }

    /// Solves for the forces of the rows that carry.
    fn step(&mut self, problem: &mut ContactProblem, matrix: &ContactMatrix) {
        // What slips starts from the edge of its cone.
        for (i, way) in self.ways.iter().enumerate() {
            match way {
                Way::Slips(across) => {
                    let force = (problem.normal(i) + across) * problem.normal_n(i);
                    problem.set_force(matrix, i, &force);
                }
                Way::Parts if problem.carries(i) => {
                    problem.set_force(matrix, i, &Vector3::zeros());
                }
                _ => {}
            }
        }
        let (size, width) = (self.unknowns.len(), self.unknowns.len() + 1);
        for (a, (row, direction)) in self.unknowns.iter().enumerate() {
            let i = *row as usize;
            // An equation for each direction that may not be displaced: all where it sticks, the normal where it slips.
            let along = match self.ways[i] {
                Way::Slips(_) => problem.normal(i),
                _ => direction,
            };
            for (b, (other, by)) in self.unknowns.iter().enumerate() {
                self.system[a * width + b] = matrix.between((i, along), (*other as usize, by));
            }
            self.system[a * width + a] *= 1.0 + TRACE;
            self.system[a * width + size] = -problem.displaced_m(i).dot(along);
        }
        if !eliminate(&mut self.system[..size * width], size) {
            return;
        }
        let (mut at, mut first) = (0, 0);
        while at < size {
            let i = self.unknowns[at].0 as usize;
            let mut force = problem.force_n(i);
            while at < size && self.unknowns[at].0 as usize == i {
                force += self.unknowns[at].1 * self.system[at * width + size];
                at += 1;
            }
            debug_assert!(at > first, "a row without unknowns");
            first = at;
            problem.set_force(matrix, i, &force);
        }
    }
}

/// What a row is, by where it goes next.
fn way(problem: &ContactProblem, i: usize) -> Way {
    let wish = problem.wish(i);
    match problem.law(i) {
        FrictionLaw::Push { mu, drag_n_m } => {
            let normal = problem.normal(i);
            let along = wish.dot(normal);
            let carries = along > 0.0;
            if drag_n_m > 0.0 {
                return Way::Keeps;
            }
            if !carries {
                return Way::Parts;
            }
            let across = wish - normal * along;
            let size = across.norm();
            match problem.is_whole(i) && size > mu * along {
                true => Way::Slips(across * (mu / size)),
                false => Way::Sticks,
            }
        }
        FrictionLaw::Grip { limit_n } => match wish.norm() <= limit_n {
            true => Way::Sticks,
            false => Way::Keeps,
        },
    }
}

/// Gaussian elimination of `size` rows of `size` + 1 numbers, with the largest pivot of each column; the last column
/// becomes the solution. False for a matrix without an inverse.
fn eliminate(rows: &mut [f64], size: usize) -> bool {
    let width = size + 1;
    for k in 0..size {
        let largest = (k..size).max_by(|&a, &b| {
            let at = |row: usize| rows[row * width + k].abs();
            at(a).total_cmp(&at(b)).then(b.cmp(&a))
        });
        let pivot_row = largest.unwrap_or(k);
        if pivot_row != k {
            for column in k..width {
                rows.swap(k * width + column, pivot_row * width + column);
            }
        }
        let pivot = rows[k * width + k];
        if pivot == 0.0 || !pivot.is_finite() {
            return false;
        }
        let (above, below) = rows.split_at_mut((k + 1) * width);
        let own = &above[k * width + k + 1..];
        for row in below.chunks_exact_mut(width) {
            let share = row[k] / pivot;
            if share != 0.0 {
                for (to, from) in row[k + 1..].iter_mut().zip(own) {
                    *to -= share * from;
                }
            }
        }
    }
    for k in (0..size).rev() {
        let mut sum = rows[k * width + size];
        for column in k + 1..size {
            sum -= rows[k * width + column] * rows[column * width + size];
        }
        rows[k * width + size] = sum / rows[k * width + k];
    }
    rows.iter().all(|value| value.is_finite())
}
