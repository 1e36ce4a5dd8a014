//! How often a closed surface winds around a point: its crossings of a ray, those outwards less those inwards.
//!
//! Seen along the ray, a part of the surface that lies ahead of the point covers it as often as the part's
//! boundary runs around it: a whole number, for which no crossing need be found. A part whose Bézier points lie
//! on one side of the ray or behind the point counts nothing; what lies ahead as well as behind is quartered.

use crate::basis::MAX_DEGREE;
use crate::math::{Point3, Vector3};
use crate::surface::closest::{halve_u, halve_v};
use crate::surface::{BezierPieces, Bounds};

/// Halvings of a piece in both directions, and of a side: smaller parts are below the noise of their points.
const DEEPEST: usize = 32;
/// Parts looked at along one ray.
const MOST_PARTS: usize = 20_000;
/// How far rays are tilted against the direction they are given, along which symmetric shapes have sides of pieces.
const TILTS: [[f64; 2]; 4] = [[0.37, 0.23], [-0.31, 0.41], [0.17, -0.53], [-0.29, -0.19]];

/// Scratch of one surface.
#[derive(Clone, Debug)]
pub(super) struct Winding {
    /// Points of parts from the point of the ray, times their weights: row by row along u, each row first x, then y
    /// across and z along the ray.
    parts: Vec<f64>,
    /// (parts): halvings so far.
    levels: Vec<usize>,
    /// Points of a part in u and v.
    counts: [usize; 2],
}

/// Where a part lies.
enum Place {
    /// The ray misses it.
    Aside,
    /// Ahead of the point.
    Ahead,
    /// On both sides of the point, or on it.
    Across,
}

/// Two directions across a ray and the one along it, right-handed.
struct Ray {
    from: Point3,
    axes: [Vector3; 3],
}

impl Ray {
    /// Along a unit vector, tilted.
    fn new(from: &Point3, along: &Vector3, [a, b]: [f64; 2]) -> Self {
        let across = |along: &Vector3| {
            let mut aside = Vector3::zeros();
            aside[along.iamin()] = 1.0;
            let first = along.cross(&aside).normalize();
            (first, along.cross(&first))
        };
        let (first, second) = across(along);
        let along = (along + first * a + second * b).normalize();
        let (first, second) = across(&along);
        Self {
            from: *from,
            axes: [first, second, along],
        }
    }

    /// Nothing in a box is on it.
    fn misses(&self, bounds: &Bounds) -> bool {
        let middle = nalgebra::center(&bounds.min, &bounds.max) - self.from;
        let rounding =
            1e-12 * (self.from.coords.abs() + bounds.min.coords.abs() + bounds.max.coords.abs());
        let half = 0.5 * (bounds.max - bounds.min) + rounding;
        let [x, y, z] = self
            .axes
            .map(|axis| (axis.dot(&middle), axis.abs().dot(&half)));
        x.0.abs() > x.1 || y.0.abs() > y.1 || z.0 < -z.1
    }
}

impl Winding {
    /// Room for parts of such pieces.
    pub fn new(pieces: &BezierPieces) -> Self {
        let counts = [pieces.u.degree + 1, pieces.v.degree + 1];
        let most = 3 * DEEPEST + 1;
        Self {
            parts: Vec::with_capacity(most * 3 * counts[0] * counts[1]),
            levels: Vec::with_capacity(most),
            counts,
        }
    }

    /// How often pieces that close wind around a point, by their parameters' orientation; `along` is any unit
    /// vector, best the way to what is near. `None`: the point is on the surface.
    pub fn around(
        &mut self,
        pieces: &BezierPieces,
        point: &Point3,
        along: &Vector3,
    ) -> Option<i32> {
        let mut rays = TILTS.iter().map(|tilt| Ray::new(point, along, *tilt));
        rays.find_map(|ray| self.crossings(pieces, &ray))
    }

    /// `None`: a side of a part is on the ray.
    fn crossings(&mut self, pieces: &BezierPieces, ray: &Ray) -> Option<i32> {
        let (mut turned, mut looked_at) = (0.0, 0);
        self.parts.clear();
        self.levels.clear();
        for piece in 0..pieces.len() {
            if ray.misses(&pieces.bounds(piece)) {
                continue;
            }
            let noise = self.push(pieces.points(piece), ray);
            while let Some(level) = self.levels.pop() {
                looked_at += 1;
                let at = self.parts.len() - 3 * self.counts[0] * self.counts[1];
                match self.place(at, noise) {
                    Place::Aside => self.parts.truncate(at),
                    Place::Ahead => {
                        turned += self.around_ray(at, noise)?;
                        self.parts.truncate(at);
                    }
                    Place::Across if level == DEEPEST || looked_at > MOST_PARTS => return None,
                    Place::Across => self.quarter(at, level + 1),
                }
            }
        }
        Some((turned / std::f64::consts::TAU).round() as i32)
    }

    /// Adds a whole piece, and returns to how much its coordinates are known.
    fn push(&mut self, points: &[[f64; 4]], ray: &Ray) -> f64 {
        let mut most = 0.0_f64;
        for row in points.chunks_exact(self.counts[1]) {
            for axis in &ray.axes {
                self.parts.extend(row.iter().map(|&[x, y, z, w]| {
                    let (point, from) = (Vector3::new(x, y, z), ray.from.coords * w);
                    most = most.max(point.amax() + from.amax());
                    axis.dot(&(point - from))
                }));
            }
        }
        self.levels.push(0);
        64.0 * f64::EPSILON * most
    }

    fn place(&self, at: usize, noise: f64) -> Place {
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for row in self.parts[at..].chunks_exact(3 * self.counts[1]) {
            for (range, row) in range.iter_mut().zip(row.chunks_exact(self.counts[1])) {
                for &x in row {
                    *range = [range[0].min(x), range[1].max(x)];
                }
            }
        }
        let aside = |[least, most]: [f64; 2]| least > noise || most < -noise;
        if aside(range[0]) || aside(range[1]) || range[2][1] < -noise {
            Place::Aside
        } else if range[2][0] > noise {
            Place::Ahead
        } else {
            Place::Across
        }
    }

    /// A part becomes its four quarters.
    fn quarter(&mut self, at: usize, level: usize) {
        let [n, m] = self.counts;
        let size = 3 * n * m;
        self.parts.resize(at + 4 * size, 0.0);
        let (a, rest) = self.parts[at..].split_at_mut(size);
        let (b, rest) = rest.split_at_mut(size);
        let (c, d) = rest.split_at_mut(size);
        halve_u(a, c, n, 3 * m);
        halve_v(a, b, 3 * n, m);
        halve_v(c, d, 3 * n, m);
        self.levels.extend([level; 4]);
    }

    /// By how much the boundary of a part turns around the ray, rad.
    fn around_ray(&self, at: usize, noise: f64) -> Option<f64> {
        let [n, m] = self.counts;
        let point = |i: usize, j: usize| [0, 1].map(|c| self.parts[at + (3 * i + c) * m + j]);
        let mut side = [[0.0; 2]; MAX_DEGREE + 1];
        let mut sum = 0.0;
        for (i, j, along_u, forth) in [
            (0, 0, true, true),
            (n - 1, 0, false, true),
            (0, m - 1, true, false),
            (0, 0, false, false),
        ] {
            let side = &mut side[..if along_u { n } else { m }];
            for (k, x) in side.iter_mut().enumerate() {
                *x = if along_u { point(k, j) } else { point(i, k) };
            }
            let turn = turn(side, noise, DEEPEST)?;
            sum += if forth { turn } else { -turn };
        }
        Some(sum)
    }
}

/// By how much a Bézier curve in the plane turns around the origin, rad; `None`: it passes through it.
fn turn(curve: &mut [[f64; 2]], noise: f64, halvings: usize) -> Option<f64> {
    let aside = |a: f64, b: f64| {
        let mut along = curve.iter().map(|x| a * x[0] + b * x[1]);
        let noise = 2.0 * noise;
        along.clone().all(|x| x > noise) || along.all(|x| x < -noise)
    };
    if aside(1.0, 0.0) || aside(0.0, 1.0) || aside(1.0, 1.0) || aside(1.0, -1.0) {
        let ([a, b], [c, d]) = (curve[0], curve[curve.len() - 1]);
        return Some(libm::atan2(a * d - b * c, a * c + b * d));
    }
    let halvings = halvings.checked_sub(1)?;
    let count = curve.len();
    let mut low = [[0.0; 2]; MAX_DEGREE + 1];
    let low = &mut low[..count];
    halve_u(curve.as_flattened_mut(), low.as_flattened_mut(), count, 2);
    Some(turn(low, noise, halvings)? + turn(curve, noise, halvings)?)
}
