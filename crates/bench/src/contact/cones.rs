//! The solver of contact forces on problems of many rows with friction, by what it leaves.
//!
//! As in FCLIB (V. Acary et al., 2014) an answer is measured by the natural map of the cone: for each row the force, less that of
//! its projection on the cone after a step along u + μ |u_t| n, over the largest force. It is zero where Signorini's
//! and Coulomb's laws hold. Walls and heaps have more rows than their bodies can tell apart, as FCLIB's have.

use super::Suite;
use crate::Row;
use crate::measure::{clocked, time};
use palpate_geometry::math::{Matrix3, Random, Vector3};
use palpate_sim::solve::friction::FrictionLaw;
use palpate_sim::solve::matrix::ContactMatrix;
use palpate_sim::solve::problem::ContactProblem;
use std::time::Duration;

const DT_S: f64 = 1e-3;
const GRAVITY_M_S2: f64 = 9.81;
/// Sweeps: as many as a tool's rows, those of free bodies and five times those have.
const SWEEPS: [usize; 3] = [50, 200, 1_000];
/// Ticks of a problem that stays, each from the forces of the last.
const TICKS: usize = 100;

/// Rows that ask for forces.
struct Cones {
    normals: Vec<Vector3>,
    mu: f64,
    matrix: ContactMatrix,
    /// Where rows go without forces, m.
    free: Vec<Vector3>,
}

/// A body of a wall or a heap.
struct Block {
    place: Vector3,
    mass_kg: f64,
    /// Along the axes, kg m².
    inertia: Vector3,
}

/// Two bodies, the second of them the floor where there is none, and where they touch.
struct Touch {
    on: usize,
    under: Option<usize>,
    point: Vector3,
    /// Out of the second.
    normal: Vector3,
}

impl Suite<'_> {
    /// Rows of problems that are wanted.
    pub(super) fn cones(&mut self, wanted: &dyn Fn(&str) -> bool) {
        let mut random = Random(14);
        let problems = [
            ("cones/stack/5", stack(5, &mut random)),
            ("cones/wall/5x5", wall(5, &mut random)),
            ("cones/heap/35", heap(5, &mut random)),
            ("cones/face/16", face(4, &mut random)),
            ("cones/face/64", face(8, &mut random)),
        ];
        for (case, cones) in problems {
            if !wanted(case) {
                continue;
            }
            for sweeps in SWEEPS {
                let (times, left) = cones.solved(sweeps, self.count(50));
                let note = format!("{} rows, μ {}", cones.normals.len(), cones.mu);
                let method = format!("{sweeps} sweeps");
                let row = Row::new("contact", case, method).timed(times).saying(note);
                (self.out)(row.off_by(left, "of the force"));
            }
            let left = cones.held();
            let method = format!("{} sweeps, {TICKS} ticks", SWEEPS[0]);
            let row = Row::new("contact", case, method).off_by(left, "of the force");
            (self.out)(row);
        }
    }
}

impl Cones {
    /// What one newton on a row moves another, by bodies, and what gravity and pushes do in a tick.
    fn of(blocks: &[Block], touches: &[Touch], pushes_n: &[Vector3], mu: f64) -> Self {
        let count = touches.len();
        let mut matrix = ContactMatrix::new(count, 3 * count);
        matrix.begin(touches.iter().map(|touch| (touch.normal, true)));
        // Of a row: bodies, their sign and how they move its point.
        let sides = |touch: &Touch| [(Some(touch.on), 1.0), (touch.under, -1.0)];
        let arm = |touch: &Touch, b: usize| (touch.point - blocks[b].place).cross_matrix();
        for (i, one) in touches.iter().enumerate() {
            for (j, other) in touches[..=i].iter().enumerate() {
                let mut block = Matrix3::zeros();
                for (b, sign) in sides(one) {
                    let same = |(c, other)| (c == b).then_some(other);
                    let theirs = sides(other).into_iter().find_map(same);
                    let (Some(b), Some(theirs)) = (b, theirs) else {
                        continue;
                    };
                    let body = &blocks[b];
                    let turned = body.inertia.map(|i| 1.0 / i);
                    let turn = arm(one, b) * Matrix3::from_diagonal(&turned) * arm(other, b);
                    let whole = Matrix3::identity() / body.mass_kg - turn;
                    block += whole * (sign * theirs * DT_S * DT_S);
                }
                matrix.add(i, j, &block);
            }
        }
        let falls = |b: usize| {
            let pull = Vector3::new(0.0, 0.0, -GRAVITY_M_S2) + pushes_n[b] / blocks[b].mass_kg;
            pull * (DT_S * DT_S)
        };
        let under = |touch: &Touch| touch.under.map_or(Vector3::zeros(), falls);
        let free = touches.iter().map(|touch| falls(touch.on) - under(touch));
        Self {
            free: free.collect(),
            normals: touches.iter().map(|touch| touch.normal).collect(),
            mu,
            matrix,
        }
    }

    fn problem(&self) -> ContactProblem {
        let count = self.normals.len();
        let mut problem = ContactProblem::new(count, 3 * count);
        for (i, (normal, free)) in self.normals.iter().zip(&self.free).enumerate() {
            let law = FrictionLaw::coulomb(self.mu);
            problem.push(normal, true, law, (0.0, Vector3::zeros()));
            problem.set_free(i, free.dot(normal), free);
        }
        problem
    }

    /// Times of solves from no forces, and what they leave.
    fn solved(&self, sweeps: usize, times: usize) -> (crate::measure::Times, f64) {
        let mut left = 0.0;
        let times = time(times, Duration::from_secs(2), |_| {
            let mut problem = self.problem();
            let (took, ()) = clocked(|| problem.solve(&self.matrix, sweeps));
            left = self.left(&problem);
            took
        });
        (times, left)
    }

    /// What is left after ticks.
    fn held(&self) -> f64 {
        let mut problem = self.problem();
        for _ in 0..TICKS {
            problem.solve(&self.matrix, SWEEPS[0]);
        }
        self.left(&problem)
    }

    /// How far forces are from the laws, over the largest.
    fn left(&self, problem: &ContactProblem) -> f64 {
        let (mut left, mut largest) = (0.0f64, 0.0f64);
        for (i, n) in self.normals.iter().enumerate() {
            let (force, moved) = (problem.force_n(i), problem.displaced_m(i));
            let step_n_m = 3.0 / self.matrix.block(i, i).trace();
            let slip_m = (moved - n * moved.dot(n)).norm();
            let wish = force - (moved + n * (self.mu * slip_m)) * step_n_m;
            left = left.max((force - projected(&wish, n, self.mu)).norm());
            largest = largest.max(force.norm());
        }
        left / largest
    }
}

/// The nearest point of a cone.
fn projected(force: &Vector3, n: &Vector3, mu: f64) -> Vector3 {
    let along = force.dot(n);
    let across = force - n * along;
    let wide = across.norm();
    if wide <= mu * along {
        *force
    } else if mu * wide <= -along {
        Vector3::zeros()
    } else {
        let height = (along + mu * wide) / (1.0 + mu * mu);
        n * height + across * (mu * height / wide)
    }
}

/// A brick of 20 × 20 × 10 mm and of some mass.
fn brick(place: [f64; 3], random: &mut Random) -> Block {
    let mass_kg = random.float(0.01, 0.05);
    Block {
        place: place.into(),
        mass_kg,
        inertia: Vector3::new(5e-4, 5e-4, 8e-4) * (mass_kg / 12.0),
    }
}

/// The corners of a face between two bricks, the upper one at a place along x.
fn corners(on: usize, under: Option<usize>, (low, high): (f64, f64), z: f64) -> Vec<Touch> {
    let corner = |(x, y): (f64, f64)| Touch {
        on,
        under,
        point: Vector3::new(x, y, z),
        normal: Vector3::z(),
    };
    let at = [(low, -0.01), (high, -0.01), (low, 0.01), (high, 0.01)];
    at.into_iter().map(corner).collect()
}

/// Bricks on each other, pushed aside by less than friction holds.
fn stack(count: usize, random: &mut Random) -> Cones {
    let z = |k: usize| 0.005 + 0.01 * k as f64;
    let blocks: Vec<Block> = (0..count)
        .map(|k| brick([0.0, 0.0, z(k)], random))
        .collect();
    let touches = |k: usize| corners(k, k.checked_sub(1), (-0.01, 0.01), z(k) - 0.005);
    let touches: Vec<Touch> = (0..count).flat_map(touches).collect();
    let pushes = pushes(&blocks, 0.1, random);
    Cones::of(&blocks, &touches, &pushes, 0.5)
}

/// A wall of courses, each brick on halves of two.
fn wall(count: usize, random: &mut Random) -> Cones {
    let (mut blocks, mut touches) = (Vec::new(), Vec::new());
    for course in 0..count {
        let (shift, z) = (0.01 * (course % 2) as f64, 0.01 * course as f64);
        for k in 0..count {
            let x = 0.02 * k as f64 + shift;
            let on = blocks.len();
            blocks.push(brick([x, 0.0, z + 0.005], random));
            if course == 0 {
                touches.extend(corners(on, None, (x - 0.01, x + 0.01), z));
                continue;
            }
            let below = (course - 1) * count;
            for under in below..below + count {
                let (low, high) = (x - 0.01, x + 0.01);
                let place: f64 = blocks[under].place.x;
                let (low, high) = (low.max(place - 0.01), high.min(place + 0.01));
                if high - low > 1e-6 {
                    touches.extend(corners(on, Some(under), (low, high), z));
                }
            }
        }
    }
    let pushes = pushes(&blocks, 0.05, random);
    Cones::of(&blocks, &touches, &pushes, 0.6)
}

/// A pyramid of balls.
fn heap(layers: usize, random: &mut Random) -> Cones {
    const RADIUS_M: f64 = 0.01;
    let (rise_m, row_m) = (
        2.0 * RADIUS_M * (2.0f64 / 3.0).sqrt(),
        RADIUS_M * 3.0f64.sqrt(),
    );
    let mut blocks = Vec::new();
    for layer in 0..layers {
        for row in 0..layers - layer {
            for k in 0..layers - layer - row {
                let x = 2.0 * RADIUS_M * k as f64 + RADIUS_M * (row + layer) as f64;
                let y = row_m * row as f64 + row_m / 3.0 * layer as f64;
                let z = RADIUS_M + rise_m * layer as f64;
                let mass_kg = random.float(0.01, 0.05);
                let inertia = Vector3::repeat(0.4 * mass_kg * RADIUS_M * RADIUS_M);
                let place = Vector3::new(x, y, z);
                blocks.push(Block {
                    place,
                    mass_kg,
                    inertia,
                });
            }
        }
    }
    let mut touches = Vec::new();
    for (on, ball) in blocks.iter().enumerate() {
        if ball.place.z < 1.5 * RADIUS_M {
            touches.push(Touch {
                on,
                under: None,
                point: ball.place - Vector3::z() * RADIUS_M,
                normal: Vector3::z(),
            });
        }
        for (under, other) in blocks[..on].iter().enumerate() {
            let way = ball.place - other.place;
            if way.norm() < 2.0 * RADIUS_M * 1.001 {
                touches.push(Touch {
                    on,
                    under: Some(under),
                    point: other.place + way * 0.5,
                    normal: way.normalize(),
                });
            }
        }
    }
    let pushes = pushes(&blocks, 0.05, random);
    Cones::of(&blocks, &touches, &pushes, 0.5)
}

/// A rigid face that rubs on an elastic half-space of 20 kPa.
fn face(side: usize, random: &mut Random) -> Cones {
    let (plane_pa, width_m) = (20e3 / 0.91, 0.02);
    let step_m = width_m / side as f64;
    let places: Vec<[f64; 2]> = (0..side * side)
        .map(|k| [k % side, k / side].map(|k| step_m * k as f64))
        .collect();
    let count = places.len();
    let mut matrix = ContactMatrix::new(count, 3 * count);
    matrix.begin(places.iter().map(|_| (Vector3::z(), true)));
    for (i, a) in places.iter().enumerate() {
        for (j, b) in places[..=i].iter().enumerate() {
            let far_m = libm::hypot(a[0] - b[0], a[1] - b[1]);
            // Boussinesq's, of a patch as wide as a step.
            let gives = 1.0 / (std::f64::consts::PI * plane_pa * libm::hypot(far_m, 0.3 * step_m));
            matrix.add_isotropic(i, j, gives);
        }
    }
    // All of it presses, and some of it sticks.
    let mut free = |_: &[f64; 2]| {
        let x = 2e-4 * random.unit();
        Vector3::new(x, 0.5 * x, -1e-3 * random.float(0.95, 1.0))
    };
    Cones {
        normals: vec![Vector3::z(); count],
        free: places.iter().map(&mut free).collect(),
        mu: 0.4,
        matrix,
    }
}

/// Pushes aside of up to this share of weights, N.
fn pushes(blocks: &[Block], share: f64, random: &mut Random) -> Vec<Vector3> {
    let push = |block: &Block| {
        let most_n = share * block.mass_kg * GRAVITY_M_S2;
        Vector3::new(most_n * random.signed(), most_n * random.signed(), 0.0)
    };
    blocks.iter().map(push).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_brick_alone_bears_its_weight_and_what_pushes_it() {
        let cones = stack(1, &mut Random(3));
        let mut problem = cones.problem();
        problem.solve(&cones.matrix, 10_000);
        assert!(cones.left(&problem) < 1e-9, "{}", cones.left(&problem));
        let random = &mut Random(3);
        let block = brick([0.0; 3], random);
        let push = pushes(std::slice::from_ref(&block), 0.1, random)[0];
        let sum: Vector3 = (0..4).map(|i| problem.force_n(i)).sum();
        let bears = Vector3::new(0.0, 0.0, GRAVITY_M_S2 * block.mass_kg) - push;
        assert!(
            (sum - bears).norm() < 1e-9 * bears.norm(),
            "{sum} for {bears}"
        );
    }

    #[test]
    fn wrong_forces_leave_something() {
        let cones = heap(3, &mut Random(4));
        let mut problem = cones.problem();
        problem.solve(&cones.matrix, 20_000);
        let left = cones.left(&problem);
        assert!(left < 1e-6, "{left}");
        let more = problem.force_n(0) * 1.01;
        problem.set_force(&cones.matrix, 0, &more);
        assert!(cones.left(&problem) > 1e-4);
    }
}
