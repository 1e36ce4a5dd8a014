//! Control points of a surface from what its points do: the ones whose surface does so best, in the sense of least squares.
//!
//! With the values N of the basis at places, Nᵀ N u = Nᵀ g, line by line. Poles are as they are.

use super::node_map::SparseRows;
use palpate_geometry::basis::{Blending, KnotVector};
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::Surface;

/// Least pivot of a matrix that is used; cubics have 0.1 and more.
const LEAST_PIVOT: f64 = 1e-3;

/// Solves for control points, in place.
#[derive(Debug)]
pub(super) struct ThroughSkin {
    around: Lines,
    along: Lines,
}

/// Lines of control points in one direction, and the matrix that they have in common.
#[derive(Debug)]
struct Lines {
    /// By row: L without its ones, and U.
    factors: SparseRows,
    /// Coordinates, line after line.
    coordinates: Vec<u32>,
}

/// Places on a surface, and what control points see of them.
pub(super) struct Places {
    directions: [Direction; 2],
    /// By direction, and line of control points across it: they are all one.
    poles: [Vec<bool>; 2],
}

/// Places in one direction.
struct Direction {
    /// Parameters on the surface, of all places.
    at: Vec<f64>,
    /// By control point: Nᵀ; at both ends of a line that does not close, the end itself.
    seen: Vec<Vec<(usize, f64)>>,
}

impl Places {
    /// On a surface whose control points are these coordinates, u-major.
    pub fn new(surface: &Surface, of: &[u32]) -> Self {
        let columns = surface.net().columns();
        let one = |mut line: Box<dyn Iterator<Item = &u32> + '_>| {
            let first = line.next();
            line.all(|c| Some(c) == first)
        };
        let across_u = of.chunks(columns).map(|line| one(Box::new(line.iter())));
        let across_v = (0..columns).map(|j| one(Box::new(of.iter().skip(j).step_by(columns))));
        Self {
            directions: [surface.knots_u(), surface.knots_v()].map(Direction::new),
            poles: [across_u.collect(), across_v.collect()],
        }
    }

    /// Parameters of a place.
    pub fn at(&self, [a, b]: [usize; 2]) -> [f64; 2] {
        [self.directions[0].at[a], self.directions[1].at[b]]
    }

    /// What a control point sees, u-major: places and their weights.
    pub fn seen(&self, control: usize) -> impl Iterator<Item = ([usize; 2], f64)> + '_ {
        let [u, v] = &self.directions;
        let [i, j] = [control / v.seen.len(), control % v.seen.len()];
        // Along the line that is a pole, every place is the same.
        let all = |one: bool, seen: &[(usize, f64)]| match one {
            true => vec![(0, 1.0)],
            false => seen.to_vec(),
        };
        let around = all(self.poles[1][j], &u.seen[i]);
        let along = all(self.poles[0][i], &v.seen[j]);
        let pairs =
            (around.into_iter()).flat_map(move |a| along.clone().into_iter().map(move |b| (a, b)));
        pairs.map(|(a, b)| ([a.0, b.0], a.1 * b.1))
    }
}

impl Direction {
    /// Two a control point: its Greville abscissa, and halfway to the next.
    fn new(knots: &KnotVector) -> Self {
        let (count, degree) = (knots.count(), knots.degree());
        let mean = |i: usize| knots.knots()[i + 1..=i + degree].iter().sum::<f64>() / degree as f64;
        let mut at: Vec<f64> = (0..count).map(mean).collect();
        if knots.is_periodic() {
            at.push(at[0] + knots.length());
        }
        let between: Vec<f64> = at
            .windows(2)
            .map(|pair| 0.5 * (pair[0] + pair[1]))
            .collect();
        at.truncate(count);
        at.extend(between);
        at.iter_mut().for_each(|t| *t = knots.confine(*t));
        let blending = Blending::new(knots, &at);
        let mut seen = vec![Vec::new(); count];
        for place in 0..at.len() {
            for (k, value) in blending.entries(place, 0).filter(|entry| entry.1 != 0.0) {
                seen[k].push((place, value));
            }
        }
        if !knots.is_periodic() {
            for end in [0, count - 1] {
                seen[end] = vec![(end, 1.0)];
            }
        }
        Self { at, seen }
    }

    /// Nᵀ N.
    fn matrix(&self, knots: &KnotVector) -> Vec<Vec<f64>> {
        let blending = Blending::new(knots, &self.at);
        let row = |seen: &Vec<(usize, f64)>| {
            let mut row = vec![0.0; self.seen.len()];
            for &(place, weight) in seen {
                for (k, value) in blending.entries(place, 0) {
                    row[k] += weight * value;
                }
            }
            row
        };
        self.seen.iter().map(row).collect()
    }
}

impl ThroughSkin {
    /// Of a surface whose control points are these coordinates, u-major; `None` where it has weights, or where several control
    /// points of a line are the same coordinate, unless all of them are.
    pub fn new(surface: &Surface, of: &[u32]) -> Option<Self> {
        if surface.weights().is_some() {
            return None;
        }
        let [rows, columns] = [surface.net().rows(), surface.net().columns()];
        debug_assert_eq!(of.len(), rows * columns, "a coordinate a control point");
        let around = (0..columns).map(|j| (0..rows).map(|i| of[i * columns + j]).collect());
        let along = (0..rows).map(|i| of[i * columns..(i + 1) * columns].to_vec());
        Some(Self {
            around: Lines::new(surface.knots_u(), around)?,
            along: Lines::new(surface.knots_v(), along)?,
        })
    }

    /// Has what control points see of the places on their surface become those of control points. Nothing is allocated.
    pub fn solve<T>(&self, values: &mut [T], vector: impl Fn(&mut T) -> &mut Vector3) {
        self.around.solve(values, &vector);
        self.along.solve(values, &vector);
    }
}

impl Lines {
    fn new(knots: &KnotVector, lines: impl Iterator<Item = Vec<u32>>) -> Option<Self> {
        let mut coordinates = Vec::new();
        for line in lines {
            // A pole is as it is.
            if line.iter().all(|c| *c == line[0]) {
                continue;
            }
            let mut sorted = line.clone();
            sorted.sort_unstable();
            if sorted.windows(2).any(|pair| pair[0] == pair[1]) {
                return None;
            }
            coordinates.extend(line);
        }
        Some(Self {
            factors: factors(knots)?,
            coordinates,
        })
    }

    fn solve<T>(&self, values: &mut [T], vector: &impl Fn(&mut T) -> &mut Vector3) {
        let count = self.factors.rows();
        debug_assert_eq!(self.coordinates.len() % count, 0, "whole lines");
        for line in self.coordinates.chunks(count) {
            let mut reduce = |row: usize, before: bool| {
                let (columns, weights) = self.factors.row(row);
                let mut sum = *vector(&mut values[line[row] as usize]);
                let mut pivot = 1.0;
                for (&k, &weight) in columns.iter().zip(weights) {
                    let k = k as usize;
                    if k == row {
                        pivot = weight;
                    } else if (k < row) == before {
                        sum -= *vector(&mut values[line[k] as usize]) * weight;
                    }
                }
                let pivot = if before { 1.0 } else { pivot };
                *vector(&mut values[line[row] as usize]) = sum / pivot;
            };
            (0..count).for_each(|row| reduce(row, true));
            (0..count).rev().for_each(|row| reduce(row, false));
        }
    }
}

/// The factors L and U of Nᵀ N, in one; it needs no pivoting.
fn factors(knots: &KnotVector) -> Option<SparseRows> {
    let mut rows = Direction::new(knots).matrix(knots);
    let count = rows.len();
    for k in 0..count {
        let (above, below) = rows.split_at_mut(k + 1);
        let pivot = above[k][k];
        if pivot.is_nan() || pivot < LEAST_PIVOT {
            return None;
        }
        for row in below.iter_mut().filter(|row| row[k] != 0.0) {
            let share = row[k] / pivot;
            row[k] = share;
            (k + 1..count).for_each(|c| row[c] -= share * above[k][c]);
        }
    }
    let sparse = |row: Vec<f64>| {
        row.into_iter()
            .enumerate()
            .map(|(k, w)| (k as u32, w))
            .collect()
    };
    Some(SparseRows::new(rows.into_iter().map(sparse)))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::body::coordinates_of_controls;
    use palpate_geometry::math::Point3;
    use palpate_geometry::surface::ControlNet;

    /// An egg, closed around and with poles.
    pub fn egg() -> Surface {
        let (around, along) = (12, 9);
        let angle = |k: usize, count: usize| std::f64::consts::PI * k as f64 / count as f64;
        let point = |i: usize, j: usize| {
            let (turn, from_pole) = (angle(2 * i, around), angle(j, along - 1));
            let out = match j {
                0 | 8 => 0.0,
                _ => 0.02 * libm::sin(from_pole),
            };
            let z = -0.03 * libm::cos(from_pole);
            Point3::new(out * libm::cos(turn), out * libm::sin(turn) * 0.8, z)
        };
        let all = (0..around).flat_map(|i| (0..along).map(move |j| (i, j)));
        let points = all.map(|(i, j)| point(i, j)).collect();
        Surface::new(
            KnotVector::periodic_uniform(3, around).unwrap(),
            KnotVector::clamped_uniform(3, along).unwrap(),
            ControlNet::new(around, along, points).unwrap(),
            None,
        )
        .unwrap()
        .oriented_outward()
    }

    #[test]
    fn control_points_come_back_from_the_points_of_a_surface() {
        let surface = egg();
        let of = coordinates_of_controls(surface.net().points(), &[]);
        let through = ThroughSkin::new(&surface, &of).unwrap();
        let places = Places::new(&surface, &of);
        let mut values = vec![Vector3::zeros(); of.len()];
        for (k, &c) in of.iter().enumerate() {
            let point = |(place, weight): ([usize; 2], f64)| {
                let [u, v] = places.at(place);
                surface.point(u, v).coords * weight
            };
            values[c as usize] = places.seen(k).map(point).sum();
        }
        through.solve(&mut values, |value| value);
        for (k, &c) in of.iter().enumerate() {
            let off = (values[c as usize] - surface.net().points()[k].coords).norm();
            assert!(off < 1e-15, "control point {k} is {off:e} m off");
        }
    }
}
