//! The end of a solve in few direct steps.
//!
//! Row by row a heavy body on light ones, or a high stack, takes thousands of sweeps. The laws of all rows together are
//! equations f = Π(f − K u), with Π the projection on what a row may do and u = b + D f; all but a few sweeps from their
//! solution Newton's method solves them (Alart & Curnier 1991). Π has a kink where a row begins to carry or to slip;
//! within a step each row keeps its side of it.
//!
//! Of a row between rigid bodies D f is the motion of the bodies and what its own compliance C gives way: u = b + J v + C f.
//! So its force is known once the motions v are, (1 − S + S K C) δf = r − S K J δv with S the slope of Π, and M v = Jᵀ f
//! is all that is solved: six unknowns a body, in a band where bodies stand in a row. Rows on what is neither free nor firm
//! keep their forces as unknowns, as do rows without a compliance of their own.

use super::friction::FrictionLaw;
use super::matrix::{ContactMatrix, directions};
use super::motions::Motions;
use super::problem::ContactProblem;
use palpate_geometry::math::{Matrix3, Vector3};

/// Most unknowns of a step: its work grows with their cube.
const MOST: usize = 432;
/// Most steps of a solve.
const STEPS: usize = 40;
/// Most steps where there are more unknowns than `CHEAP`.
const DEAR_STEPS: usize = 12;
/// Up to this many unknowns a step takes little of a tick.
const CHEAP: usize = 160;
/// How often a step that makes nothing better is halved.
const HALVED: usize = 3;
/// A pivot smaller than this, relative to its column, is rounding.
const ROUNDING: f64 = 1e-13;
/// A solve is at its end when no force is wrong by more than this share of the largest.
const ENOUGH: f64 = 1e-9;

/// What a solve ends with beside its problem.
#[derive(Clone, Copy)]
pub struct Coupled<'a> {
    /// How rows move each other.
    pub matrix: &'a ContactMatrix,
    /// Bodies that move freely.
    pub motions: &'a Motions,
}

/// How a row may change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// With all that it moves. Where all that it is on is free and rigid or firm, `own` is the share of its compliance that
    /// is its own; else 0.
    Free {
        /// Share, 0 … 1.
        own: f64,
    },
    /// Not at all.
    Fixed,
}

/// Unknowns next to each other: of a vector, or of one along a direction.
#[derive(Clone, Copy, Debug)]
struct Place {
    start: usize,
    along: Option<Vector3>,
}

impl Place {
    /// Its unknowns and their directions.
    fn directions(self) -> impl Iterator<Item = (usize, Vector3)> {
        directions(&self.along.unwrap_or_default(), self.along.is_none())
            .enumerate()
            .map(move |(k, direction)| (self.start + k, direction))
    }
}

/// How the force of a row stands in the system.
#[derive(Clone, Copy, Debug)]
enum Carries {
    /// It is zero.
    Nothing,
    /// It is unknown.
    Unknown(Place),
    /// It follows from the motions: the inverse of 1 − S + S K C.
    Follows(Matrix3),
}

/// A row that may change.
#[derive(Clone, Copy, Debug)]
struct Active {
    row: usize,
    carries: Carries,
    /// 1 − S, S = ∂Π/∂w.
    eases: Matrix3,
    /// S K, N/m.
    against: Matrix3,
    /// Π(w), N.
    allowed: Vector3,
    /// Before the step, m.
    displaced: Vector3,
}

/// Buffers of direct steps.
#[derive(Clone, Debug)]
pub struct Direct {
    active: Vec<Active>,
    /// By body: its first unknown, if it has any.
    bodies: Vec<Option<usize>>,
    /// Row by row: by how much each unknown moves an equation; then minus what is missed.
    system: Vec<f64>,
    /// By equation, the unknowns behind which it has none.
    ends: Vec<usize>,
    /// By unknown, the most that it counts in an equation.
    scales: Vec<f64>,
    /// Forces before a step and after it, N.
    before: Vec<f64>,
    after: Vec<f64>,
    /// Those of the sweeps, and the best so far, N.
    swept: Vec<f64>,
    best: Vec<f64>,
    /// Most unknowns.
    room: usize,
    /// Steps of the last solve.
    steps: usize,
}

impl Direct {
    /// Buffers for `rows` rows of so many directions, on so many free rigid bodies; none where there are no such bodies.
    pub fn new(rows: usize, directions: usize, bodies: usize) -> Self {
        let room = match bodies {
            0 => 0,
            _ => (directions + 6 * bodies).min(MOST),
        };
        Self {
            bodies: Vec::with_capacity(bodies),
            active: Vec::with_capacity(rows),
            system: vec![0.0; room * (room + 1)],
            ends: vec![0; room],
            scales: vec![0.0; room],
            before: Vec::with_capacity(directions),
            after: Vec::with_capacity(directions),
            swept: Vec::with_capacity(directions),
            best: Vec::with_capacity(directions),
            room,
            steps: 0,
        }
    }

    /// Steps that the last solve took; none where there were too many unknowns.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Says that a solve goes without direct steps.
    pub fn skip(&mut self) {
        self.steps = 0;
    }

    /// Ends a solve. `change` says of a row how it may. False where there are too many unknowns.
    pub fn end(
        &mut self,
        problem: &mut ContactProblem,
        coupled: Coupled<'_>,
        change: impl Fn(usize) -> Change,
    ) -> bool {
        let matrix = coupled.matrix;
        self.steps = 0;
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
            let Some(missed) = self.run(problem, coupled, &change, lies) else {
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
        coupled: Coupled<'_>,
        change: &impl Fn(usize) -> Change,
        lies: bool,
    ) -> Option<f64> {
        let matrix = coupled.matrix;
        let mut missed = problem.missed();
        for step in 0..STEPS {
            let first = lies && step == 0;
            let size = self.choose(problem, coupled, change, first)?;
            if size > CHEAP && step >= DEAR_STEPS {
                break;
            }
            self.before.clear();
            self.before.extend_from_slice(problem.forces());
            self.steps += 1;
            if !self.step(problem, coupled, size) {
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
        Coupled { matrix, motions }: Coupled<'_>,
        change: &impl Fn(usize) -> Change,
        sticks: bool,
    ) -> Option<usize> {
        self.active.clear();
        self.bodies.clear();
        self.bodies.resize(motions.bodies(), None);
        let mut size = 0;
        for row in 0..problem.rows() {
            let Change::Free { own } = change(row) else {
                continue;
            };
            let (wish, normal) = (problem.wish(row), problem.normal(row));
            let Some((mut allowed, mut slope)) = project(&problem.law(row), normal, &wish) else {
                continue;
            };
            if sticks && slope != Matrix3::zeros() {
                (allowed, slope) = (wish, Matrix3::identity());
            }
            let along = (!problem.is_whole(row)).then_some(*normal);
            let mut active = Active {
                row,
                carries: Carries::Nothing,
                eases: Matrix3::identity() - slope,
                against: slope * problem.stiffness(row),
                allowed,
                displaced: problem.displaced_m(row),
            };
            if slope != Matrix3::zeros() {
                let own = matrix.whole(row, row) * own;
                let gives = active.eases + active.against * own;
                let alone = own != Matrix3::zeros();
                let inverse = alone.then(|| inverse_along(&gives, along)).flatten();
                active.carries = match inverse {
                    Some(inverse) => {
                        (motions.of_row(row)).for_each(|lever| self.bodies[lever.body] = Some(0));
                        Carries::Follows(inverse)
                    }
                    None => {
                        let start = size;
                        size += along.map_or(3, |_| 1);
                        Carries::Unknown(Place { start, along })
                    }
                };
            }
            self.active.push(active);
        }
        for start in self.bodies.iter_mut().flatten() {
            *start = size;
            size += 6;
        }
        (size <= self.room).then_some(size)
    }

    /// One step of Newton's method; false where its matrix has no inverse.
    fn step(&mut self, problem: &mut ContactProblem, coupled: Coupled<'_>, size: usize) -> bool {
        let matrix = coupled.matrix;
        // What does not carry has no force, whatever the others do.
        for of in &self.active {
            if matches!(of.carries, Carries::Nothing) && problem.carries(of.row) {
                problem.set_force(matrix, of.row, &Vector3::zeros());
            }
        }
        let system = &mut self.system[..size * (size + 1)];
        system.fill(0.0);
        let mut system = System { rows: system, size };
        for (body, start) in self.bodies.iter().enumerate() {
            let Some(start) = *start else { continue };
            let (mass, inertia) = coupled.motions.inertia(body);
            let [along, about] = places(start);
            system.add(along, along, &Matrix3::from_diagonal_element(*mass));
            system.add(about, about, inertia);
        }
        let unknown = |of: &Active| match of.carries {
            Carries::Unknown(place) => Some((of.row, place)),
            _ => None,
        };
        let (active, bodies) = (&self.active, &self.bodies);
        for of in active {
            let moved = problem.displaced_m(of.row) - of.displaced;
            let missed = of.allowed - problem.force_n(of.row) - of.against * moved;
            let levers = || levers(coupled.motions, bodies, of.row);
            match of.carries {
                Carries::Nothing => (),
                Carries::Unknown(own) => {
                    system.add(own, own, &of.eases);
                    for (row, place) in active.iter().filter_map(unknown) {
                        let moves = matrix.whole(of.row, row);
                        if moves != Matrix3::zeros() {
                            system.add(own, place, &(of.against * moves));
                        }
                    }
                    levers().for_each(|(place, moves)| {
                        system.add(own, place, &(of.against * moves));
                    });
                    system.add_missed(own, &missed);
                }
                Carries::Follows(inverse) => {
                    let against = inverse * of.against;
                    for (load, by) in levers() {
                        let loads = by.transpose() * against;
                        for (place, moves) in levers() {
                            system.add(load, place, &(loads * moves));
                        }
                        for (row, place) in active.iter().filter_map(unknown) {
                            let moves = matrix.whole(of.row, row);
                            if moves != Matrix3::zeros() {
                                system.add(load, place, &(loads * moves));
                            }
                        }
                        system.add_missed(load, &(by.transpose() * (inverse * missed)));
                    }
                }
            }
        }
        let (ends, scales) = (&mut self.ends[..size], &mut self.scales[..size]);
        if !eliminate(system.rows, ends, scales) {
            return false;
        }
        self.after.clear();
        self.after.extend_from_slice(problem.forces());
        for of in active {
            let change = match of.carries {
                Carries::Nothing => continue,
                Carries::Unknown(place) => system.solution(place),
                Carries::Follows(inverse) => {
                    let mut moved = problem.displaced_m(of.row) - of.displaced;
                    for (place, moves) in levers(coupled.motions, bodies, of.row) {
                        moved += moves * system.solution(place);
                    }
                    for (row, place) in active.iter().filter_map(unknown) {
                        moved += matrix.whole(of.row, row) * system.solution(place);
                    }
                    let missed = of.allowed - problem.force_n(of.row);
                    inverse * (missed - of.against * moved)
                }
            };
            problem.add_to(&mut self.after, of.row, &change);
        }
        problem.restore(matrix, &self.after);
        true
    }
}

/// Where the six unknowns of a body that start here are.
fn places(start: usize) -> [Place; 2] {
    [start, start + 3].map(|start| Place { start, along: None })
}

/// Where the motions that move a row are among the unknowns, and by how much each does.
fn levers<'a>(
    motions: &'a Motions,
    bodies: &'a [Option<usize>],
    row: usize,
) -> impl Iterator<Item = (Place, Matrix3)> + 'a {
    let unknown = motions
        .of_row(row)
        .filter_map(|lever| Some((places(bodies[lever.body]?), lever.blocks())));
    unknown.flat_map(|(places, blocks)| places.into_iter().zip(blocks))
}

/// The inverse of what acts in all directions, or along one only; `None` where there is none.
fn inverse_along(block: &Matrix3, along: Option<Vector3>) -> Option<Matrix3> {
    let Some(along) = along else {
        return block.try_inverse();
    };
    let gives = along.dot(&(block * along));
    (gives != 0.0).then(|| along * along.transpose() / gives)
}

/// Equations, row by row: by how much each unknown counts, then what is missed.
struct System<'a> {
    rows: &'a mut [f64],
    size: usize,
}

impl System<'_> {
    /// Adds to the equations at one place by how much the unknowns at another count.
    fn add(&mut self, to: Place, by: Place, block: &Matrix3) {
        let width = self.size + 1;
        for (a, left) in to.directions() {
            for (b, right) in by.directions() {
                self.rows[a * width + b] += left.dot(&(block * right));
            }
        }
    }

    /// Adds what the equations at a place miss.
    fn add_missed(&mut self, to: Place, missed: &Vector3) {
        let width = self.size + 1;
        for (a, direction) in to.directions() {
            self.rows[a * width + self.size] += direction.dot(missed);
        }
    }

    /// The unknowns at a place, once they are known.
    fn solution(&self, at: Place) -> Vector3 {
        let known = |a: usize| self.rows[a * (self.size + 1) + self.size];
        at.directions()
            .map(|(a, direction)| direction * known(a))
            .sum()
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
fn eliminate(rows: &mut [f64], ends: &mut [usize], scales: &mut [f64]) -> bool {
    let size = ends.len();
    let width = size + 1;
    for (row, end) in rows.chunks_exact(width).zip(&mut *ends) {
        *end = row[..size].iter().rposition(|x| *x != 0.0).unwrap_or(0) + 1;
    }
    scales.fill(0.0);
    for row in rows.chunks_exact(width) {
        for (scale, entry) in scales.iter_mut().zip(row) {
            *scale = scale.max(entry.abs());
        }
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
        if pivot.abs() <= ROUNDING * scales[k] || !pivot.is_finite() {
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

#[cfg(test)]
mod tests;
