//! The exact backward Euler step of a deforming body; with contact in [`contact`].
//!
//! Solves `M (x' − x − dt v) / dt² = f(x' + d (x' − x) / dt) + M g + F` for the free coordinates, f
//! the law's forces, d the damping time and F a load, by Newton's method with a line search on the
//! residual. Products with the tangent are central differences of f, which is all that is asked of
//! the body; the linear systems are solved by conjugate gradients behind the factor of a tangent from
//! before, or behind M where there is none. Starts from the correction of the step before. Used for
//! error figures and tests: it allocates, iterates to convergence, and its bits may differ between
//! machines.

mod band;
pub mod contact;
pub mod obstacle;
#[cfg(test)]
mod tests;

use band::{BandCholesky, dot};
use palpate_geometry::math::{Point3, Vector3};
use palpate_sim::body::{Deformable, DeformableScratch, DeformableState};

/// Residual over the largest force at which a step is solved.
pub const TOLERANCE: f64 = 1e-12;
/// Residual over the largest force that is rounding when Newton's method comes no further.
const ROUNDING: f64 = 1e-9;
/// Newton steps, and products with the tangent in one.
const NEWTON_STEPS: usize = 60;
const PRODUCTS: usize = 400;
/// Error of a direction over its right-hand side.
const INNER: f64 = 1e-5;
/// Directions that take more products than these pay for a new factor.
const SLOW: usize = 30;
/// Shares of its diagonal that a tangent gets more until it is definite.
const LEAST_SHIFT: f64 = 1e-3;
const MOST_SHIFT: f64 = 10.0;
/// How far differences reach, of the shortest distance between coordinates: the third derivative
/// and rounding both tell about 1e-10 there.
const REACH: f64 = 1e-5;

/// A step that did not converge.
#[derive(Default, Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "no exact step after {steps} Newton steps: {residual_n} N are left of {scale_n} N; take a smaller dt or load"
)]
pub struct Unsolved {
    /// Newton steps made.
    pub steps: usize,
    /// Largest force left on a coordinate, N.
    pub residual_n: f64,
    /// Largest force, N.
    pub scale_n: f64,
}

/// What a step took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Solved {
    /// Newton steps.
    pub steps: usize,
    /// Products with the tangent.
    pub products: usize,
    /// Largest force left on a coordinate over the largest force.
    pub residual: f64,
}

/// What a step starts from, by free coordinate.
struct Motion {
    /// Places, m.
    start: Vec<f64>,
    /// Weight and load, N.
    given: Vec<f64>,
    /// Where inertia alone would take it, m.
    coasting: Vec<f64>,
    /// Largest of these forces and of those of inertia, N.
    scale_n: f64,
}

/// Backward Euler of one body, to convergence.
#[derive(Debug)]
pub struct ExactStep<'a> {
    body: &'a Deformable,
    /// dt, s.
    pub dt_s: f64,
    /// d, s.
    pub damping_s: f64,
    /// g, m/s².
    pub gravity: Vector3,
    /// Residual over the largest force at which a step is solved.
    pub tolerance: f64,
    /// (free coordinates), along the longest side of the body.
    order: Vec<u32>,
    /// (3 × free coordinates), kg.
    masses: Vec<f64>,
    /// Half width of the tangent in that order.
    band: usize,
    reach_m: f64,
    /// Diagonal of the body at rest, m.
    size_m: f64,
    /// Largest change of a force over that of a coordinate, N/m.
    stiffest_n_m: f64,
    /// What rounding of the places makes of forces, N.
    rounding_n: f64,
    factor: Option<BandCholesky>,
    stale: bool,
    /// Of the inverse of the factored tangent, where a skin asked for them.
    columns: contact::Columns,
    /// x' − x − dt v of the step before.
    correction: Vec<f64>,
    /// Where forces are asked for.
    asked: DeformableState,
    scratch: DeformableScratch,
}

impl<'a> ExactStep<'a> {
    /// With the body's dt, and without damping, gravity or a factor.
    pub fn new(body: &'a Deformable) -> Self {
        let rest = body.rest_state().positions;
        let mut order: Vec<u32> = (0..rest.len() as u32)
            .filter(|&c| body.unknown(c as usize).is_some())
            .collect();
        let (mut low, mut high) = (rest[0], rest[0]);
        for p in &rest {
            (low, high) = (low.inf(p), high.sup(p));
        }
        let axis = (high - low).imax();
        order.sort_by(|&a, &b| {
            let [a, b] = [a, b].map(|c| (rest[c as usize][axis], c));
            a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
        });
        let mut shortest = f64::INFINITY;
        for (k, a) in rest.iter().enumerate() {
            for b in &rest[..k] {
                let length = (a - b).norm();
                if length > 0.0 {
                    shortest = shortest.min(length);
                }
            }
        }
        let mass = |&c: &u32| [body.masses()[c as usize]; 3];
        let mut this = Self {
            body,
            dt_s: body.dt_s(),
            damping_s: 0.0,
            gravity: Vector3::zeros(),
            tolerance: TOLERANCE,
            masses: order.iter().flat_map(mass).collect(),
            correction: vec![0.0; 3 * order.len()],
            order,
            band: 0,
            reach_m: REACH * shortest,
            size_m: (high - low).norm(),
            stiffest_n_m: 0.0,
            rounding_n: 0.0,
            factor: None,
            stale: true,
            columns: contact::Columns::new(),
            asked: body.rest_state(),
            scratch: body.scratch(),
        };
        this.stiffest_n_m = this.probe();
        this.rounding_n = 4.0 * f64::EPSILON * this.size_m * this.stiffest_n_m;
        this
    }

    /// Finds the half width of the tangent: the farthest that a force depends on a coordinate, in
    /// rows. Gives the largest change of a force over that of a coordinate, N/m.
    fn probe(&mut self) -> f64 {
        let rest = self.gather(&self.body.rest_state().positions);
        let mut places = rest.clone();
        let calm = self.forces(&places);
        let (mut band, mut most_n) = (2, 0.0f64);
        for k in 0..self.order.len() {
            for (axis, share) in [1.0, 0.7, -0.4].into_iter().enumerate() {
                places[3 * k + axis] += share * self.reach_m;
            }
            let moved = self.forces(&places);
            places[3 * k..3 * k + 3].copy_from_slice(&rest[3 * k..3 * k + 3]);
            for (other, (a, b)) in moved.chunks(3).zip(calm.chunks(3)).enumerate() {
                if a != b {
                    band = band.max(3 * k.abs_diff(other) + 2);
                    most_n = a
                        .iter()
                        .zip(b)
                        .map(|(a, b)| (a - b).abs())
                        .fold(most_n, f64::max);
                }
            }
        }
        self.band = band;
        most_n / self.reach_m
    }

    fn gather(&self, points: &[Point3]) -> Vec<f64> {
        let of = |&c: &u32| -> [f64; 3] { points[c as usize].coords.into() };
        self.order.iter().flat_map(of).collect()
    }

    /// f at places of the free coordinates.
    fn forces(&mut self, places: &[f64]) -> Vec<f64> {
        for (&c, place) in self.order.iter().zip(places.chunks(3)) {
            self.asked.positions[c as usize] = Point3::new(place[0], place[1], place[2]);
        }
        let forces = self.body.internal_forces(&self.asked, &mut self.scratch);
        let of = |&c: &u32| {
            let [x, y, z, _] = forces[c as usize];
            [x, y, z]
        };
        self.order.iter().flat_map(of).collect()
    }

    /// (K (1 + d / dt) + M / dt²) p, K the tangent of the law at `ahead`.
    fn product(&mut self, ahead: &[f64], p: &[f64]) -> Vec<f64> {
        let inverse = 1.0 / (self.dt_s * self.dt_s);
        let size = largest(p);
        let mut answer: Vec<f64> = self
            .masses
            .iter()
            .zip(p)
            .map(|(m, p)| m * inverse * p)
            .collect();
        if size == 0.0 {
            return answer;
        }
        let h = self.reach_m / size;
        let share = (1.0 + self.damping_s / self.dt_s) / (2.0 * h);
        let [there, back] = [h, -h].map(|h| {
            let moved: Vec<f64> = ahead.iter().zip(p).map(|(a, p)| a + h * p).collect();
            self.forces(&moved)
        });
        for (answer, (a, b)) in answer.iter_mut().zip(there.iter().zip(&back)) {
            *answer -= (a - b) * share;
        }
        answer
    }

    /// Factors the tangent at `ahead`, or what is definite near it.
    fn refactor(&mut self, ahead: &[f64]) {
        self.stale = false;
        let (n, band) = (ahead.len(), self.band);
        let (width, step) = (band + 1, 2 * band + 1);
        let mut rows = vec![0.0; n * width];
        // Columns so far apart that no force depends on two of them, at once.
        for first in 0..step.min(n) {
            let mut columns = vec![0.0; n];
            columns
                .iter_mut()
                .skip(first)
                .step_by(step)
                .for_each(|column| *column = 1.0);
            let answer = self.product(ahead, &columns);
            for column in (first..n).step_by(step) {
                for row in column..n.min(column + width) {
                    rows[row * width + column + band - row] = answer[row];
                }
            }
        }
        // One that is not definite gets as much more on its diagonal as it needs.
        let mut more = 0.0;
        while more < MOST_SHIFT {
            let mut shifted = rows.clone();
            for row in 0..n {
                shifted[row * width + band] *= 1.0 + more;
            }
            if let Some(factor) = BandCholesky::new(n, band, shifted) {
                self.factor = Some(factor);
                return;
            }
            more = (4.0 * more).max(LEAST_SHIFT);
        }
    }

    fn precondition(&self, r: &[f64]) -> Vec<f64> {
        let mut z = r.to_vec();
        match &self.factor {
            Some(factor) => factor.solve(&mut z),
            None => z.iter_mut().zip(&self.masses).for_each(|(z, m)| *z /= m),
        }
        z
    }

    /// Conjugate gradients for `J p = b`; ends early where the tangent is not definite. Gives p and
    /// the products made.
    fn direction(&mut self, ahead: &[f64], b: &[f64]) -> (Vec<f64>, usize) {
        let mut x = vec![0.0; b.len()];
        let mut r = b.to_vec();
        let mut z = self.precondition(&r);
        let mut p = z.clone();
        let mut rz = dot(&r, &z);
        let goal = INNER * dot(b, b).sqrt();
        for k in 0..PRODUCTS {
            let q = self.product(ahead, &p);
            let curvature = dot(&p, &q);
            if curvature <= 0.0 {
                return (if k == 0 { p } else { x }, k + 1);
            }
            let alpha = rz / curvature;
            for i in 0..x.len() {
                x[i] += alpha * p[i];
                r[i] -= alpha * q[i];
            }
            if dot(&r, &r).sqrt() <= goal {
                return (x, k + 1);
            }
            z = self.precondition(&r);
            let next = dot(&r, &z);
            let beta = next / rz;
            rz = next;
            p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + beta * *p);
        }
        (x, PRODUCTS)
    }

    /// One step of a state, with a load on each coordinate, N. Only places and velocities of the
    /// state are read and written; rest lengths of the body's own rest state are in force.
    ///
    /// # Errors
    /// No convergence.
    pub fn step(
        &mut self,
        state: &mut DeformableState,
        load_n: &[Vector3],
    ) -> Result<Solved, Unsolved> {
        let motion = self.motion(state, load_n);
        let coasting = &motion.coasting;
        let mut places: Vec<f64> = coasting
            .iter()
            .zip(&self.correction)
            .map(|(y, c)| y + c)
            .collect();
        let (mut residual, mut law_n) = self.missing(&motion, &places);
        let from_coasting = self.missing(&motion, coasting);
        let [warm, cold] = [&residual, &from_coasting.0].map(|r| dot(r, r));
        if warm.is_nan() || warm >= cold {
            places.clone_from(coasting);
            (residual, law_n) = from_coasting;
        }
        let mut solved = Solved::default();
        let mut stuck = false;
        loop {
            let (left, scale) = (
                largest(&residual),
                motion.scale_n.max(law_n).max(f64::MIN_POSITIVE),
            );
            solved.residual = left / scale;
            let rounded = solved.residual <= ROUNDING || left <= self.rounding_n;
            let done = solved.residual <= self.tolerance;
            if done || (stuck && rounded) {
                break;
            }
            if stuck || solved.steps == NEWTON_STEPS || !left.is_finite() {
                return Err(Unsolved {
                    steps: solved.steps,
                    residual_n: left,
                    scale_n: scale,
                });
            }
            let there = self.ahead(&motion, &places);
            if self.stale {
                self.refactor(&there);
            }
            let (direction, products) = self.direction(&there, &residual);
            self.stale = products > SLOW;
            solved.steps += 1;
            solved.products += products;
            let before = dot(&residual, &residual);
            let mut length = 1.0;
            stuck = true;
            while length > 1e-6 {
                let moved: Vec<f64> = places
                    .iter()
                    .zip(&direction)
                    .map(|(x, d)| x + length * d)
                    .collect();
                let (now, law) = self.missing(&motion, &moved);
                let after = dot(&now, &now);
                if after < before * (1.0 - 1e-4 * length) {
                    // Near rounding, small gains are no way on.
                    stuck = after > 0.25 * before && rounded;
                    (places, residual, law_n) = (moved, now, law);
                    break;
                }
                length *= 0.5;
            }
        }
        self.finish(state, &motion, &places);
        Ok(solved)
    }

    /// What a step starts from. Fixed coordinates stay where the state has them.
    fn motion(&mut self, state: &DeformableState, load_n: &[Vector3]) -> Motion {
        let dt = self.dt_s;
        self.asked.positions.clone_from(&state.positions);
        let start = self.gather(&state.positions);
        let speed: Vec<f64> = self
            .order
            .iter()
            .flat_map(|&c| -> [f64; 3] { state.velocities[c as usize].into() })
            .collect();
        let given: Vec<f64> = self
            .order
            .iter()
            .flat_map(|&c| -> [f64; 3] {
                let weight = self.gravity * self.body.masses()[c as usize];
                (weight + load_n[c as usize]).into()
            })
            .collect();
        let mut scale_n = largest(&given);
        for (m, v) in self.masses.iter().zip(&speed) {
            scale_n = scale_n.max(m * v.abs() / dt);
        }
        let coasting = start.iter().zip(&speed).map(|(x, v)| x + dt * v).collect();
        Motion {
            start,
            given,
            coasting,
            scale_n,
        }
    }

    /// Where the law is asked for its forces: damping looks ahead.
    fn ahead(&self, motion: &Motion, places: &[f64]) -> Vec<f64> {
        let share = self.damping_s / self.dt_s;
        let both = places.iter().zip(&motion.start);
        both.map(|(z, x)| z + share * (z - x)).collect()
    }

    /// What is missing on each coordinate, N, and the largest of the law's forces.
    fn missing(&mut self, motion: &Motion, places: &[f64]) -> (Vec<f64>, f64) {
        let mut forces = self.forces(&self.ahead(motion, places));
        let (law_n, inverse) = (largest(&forces), 1.0 / (self.dt_s * self.dt_s));
        for k in 0..forces.len() {
            let inertia = self.masses[k] * inverse * (places[k] - motion.coasting[k]);
            forces[k] += motion.given[k] - inertia;
        }
        (forces, law_n)
    }

    /// The state at the end of a step.
    fn finish(&mut self, state: &mut DeformableState, motion: &Motion, places: &[f64]) {
        for (k, &c) in self.order.iter().enumerate() {
            let c = c as usize;
            for axis in 0..3 {
                let (at, from) = (places[3 * k + axis], motion.start[3 * k + axis]);
                self.correction[3 * k + axis] = at - motion.coasting[3 * k + axis];
                state.positions[c][axis] = at;
                state.velocities[c][axis] = (at - from) / self.dt_s;
            }
        }
    }

    /// Where a held body is at rest under a load, which is given in `parts`; speeds become zero.
    ///
    /// # Errors
    /// No convergence: more parts help.
    pub fn settle(
        &mut self,
        state: &mut DeformableState,
        load_n: &[Vector3],
        parts: usize,
    ) -> Result<(), Unsolved> {
        // So long that inertia is nothing beside what holds the body.
        let dt_s = std::mem::replace(&mut self.dt_s, 1e4);
        self.stale = true;
        let mut done = Ok(());
        for part in 1..=parts {
            let share = part as f64 / parts as f64;
            let loads: Vec<Vector3> = load_n.iter().map(|load| load * share).collect();
            state.velocities.fill(Vector3::zeros());
            self.correction.fill(0.0);
            if let Err(unsolved) = self.step(state, &loads) {
                done = Err(unsolved);
                break;
            }
        }
        state.velocities.fill(Vector3::zeros());
        self.correction.fill(0.0);
        self.dt_s = dt_s;
        self.stale = true;
        done
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, value| {
        if value.is_nan() {
            f64::NAN
        } else {
            most.max(value.abs())
        }
    })
}
