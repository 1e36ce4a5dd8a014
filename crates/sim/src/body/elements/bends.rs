//! Bending of membranes: three nodes in a row resist a change of how far the middle one stands off.
//!
//! v = α x₋ + β x₊ − (α + β) x, with α = 2 / (h₋ (h₋ + h₊)) and β = 2 / (h₊ (h₋ + h₊)), is the
//! second derivative along the row. Its energy ½ w (|v| − |v₀|)² has w = D A, the bending stiffness
//! D = E t³ / (12 (1 − ν²)) of a plate times the area that the row stands for. The direction of v
//! is free, so turning costs nothing (Bouaziz et al. 2014, sec. 5.3).
//!
//! A row that winds within the sheet, as one around a pole, has a v₀ there even where the sheet is
//! flat, and |v| would not tell what leaves the plane. So what v has in the plane at rest is taken
//! off as a first derivative: v − p (x₊ − x₋) − q (x_r − x_l), with the neighbours left and right of
//! the row. Around a flat pole that makes w′/r of the deflection w, the curvature around.

use super::law::{Edge, ForceLaw, Place};
use crate::body::sheet::Row;
use palpate_geometry::math::{Lane, Matrix3, Point3, Vector3};

/// Most nodes of a bend: one before, the middle, two after, left and right.
const MOST: usize = 6;

/// A v₀ in the plane below this, times the length of the row, is rounding.
const STRAIGHT: f64 = 1e-9;

/// One row of three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    nodes: [u32; MOST],
    /// 1/m²; they sum to zero.
    weights: [f64; MOST],
    count: usize,
    /// w, N·m³.
    stiffness: f64,
    /// |v₀|, 1/m.
    rest: f64,
}

impl Bend {
    /// A row of nodes at rest, of bending stiffness D (N·m) over an area (m²); `None` where nodes
    /// coincide.
    pub fn new(row: &Row, rest: &[Point3], plate_n_m: f64, area_m2: f64) -> Option<Self> {
        let at = |node: u32| rest[node as usize];
        let (a, b) = (at(row.before), at(row.middle));
        let c = at(row.after[0]) + (at(row.after[1]) - at(row.after[0])) * 0.5;
        let (before, after) = ((b - a).norm(), (c - b).norm());
        if !(before > 0.0 && after > 0.0) {
            return None;
        }
        let whole = before + after;
        let (mut alpha, mut beta) = (2.0 / (before * whole), 2.0 / (after * whole));
        let middle = -(alpha + beta);
        let mut v: Vector3 = a.coords * alpha + b.coords * middle + c.coords * beta;
        let mut across = 0.0;
        if let Some([left, right]) = row.across {
            let (along, aside) = (c - a, at(right) - at(left));
            let (p, q) = in_plane(&v, &along, &aside);
            if (along * p + aside * q).norm() * whole > STRAIGHT {
                (alpha, beta, across) = (alpha + p, beta - p, q);
                v -= along * p + aside * q;
            }
        }
        let mut bend = Self {
            nodes: [row.middle; MOST],
            weights: [0.0; MOST],
            count: 0,
            stiffness: plate_n_m * area_m2 * row.share,
            rest: v.norm(),
        };
        bend.add(row.before, alpha);
        bend.add(row.middle, middle);
        bend.add(row.after[0], 0.5 * beta);
        bend.add(row.after[1], 0.5 * beta);
        if let Some([left, right]) = row.across.filter(|_| across != 0.0) {
            bend.add(left, across);
            bend.add(right, -across);
        }
        Some(bend)
    }

    fn add(&mut self, node: u32, weight: f64) {
        let known = self.nodes[..self.count].iter().position(|&n| n == node);
        let place = known.unwrap_or(self.count);
        self.nodes[place] = node;
        self.weights[place] += weight;
        self.count = self.count.max(place + 1);
    }

    fn terms(&self) -> impl Iterator<Item = (u32, f64)> {
        let (nodes, weights) = (&self.nodes[..self.count], &self.weights[..self.count]);
        nodes.iter().copied().zip(weights.iter().copied())
    }

    /// w s sᵀ as edges (a, b, k) of a Laplacian: its rows sum to zero.
    fn edges(&self) -> Vec<Edge> {
        let mut edges = Vec::new();
        for (k, (i, s)) in self.terms().enumerate() {
            for (j, t) in self.terms().skip(k + 1) {
                edges.push((i.min(j), i.max(j), -self.stiffness * (s * t)));
            }
        }
        edges
    }

    /// Hands out blocks of w s sᵀ, each pair of nodes once.
    fn tangent(&self, out: &mut dyn FnMut(u32, u32, Matrix3)) {
        for (k, (i, s)) in self.terms().enumerate() {
            for (j, t) in self.terms().take(k + 1) {
                out(i, j, Matrix3::from_diagonal_element(self.stiffness * s * t));
            }
        }
    }

    fn second_derivative(&self, places: &[Lane]) -> Lane {
        let mut v = [0.0; 4];
        for (node, weight) in self.terms() {
            for c in 0..3 {
                v[c] += places[node as usize][c] * weight;
            }
        }
        v
    }

    /// Adds −∂E/∂x.
    fn add_force(&self, places: &[Lane], residual: &mut [Lane]) {
        let v = self.second_derivative(places);
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        let share = if length > 0.0 {
            1.0 - self.rest / length
        } else {
            0.0
        };
        for (node, weight) in self.terms() {
            for c in 0..3 {
                residual[node as usize][c] -= self.stiffness * share * weight * v[c];
            }
        }
    }

    /// Elastic energy, J.
    fn energy_j(&self, places: &[Lane]) -> f64 {
        let v = self.second_derivative(places);
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        0.5 * self.stiffness * (length - self.rest).powi(2)
    }
}

impl ForceLaw for Vec<Bend> {
    fn add_forces(&self, places: &[Lane], residual: &mut [Lane]) {
        self.iter()
            .for_each(|bend| bend.add_force(places, residual));
    }

    fn parts(&self) -> Vec<Vec<u32>> {
        let nodes = |bend: &Bend| bend.terms().map(|(node, _)| node).collect();
        self.iter().map(nodes).collect()
    }

    fn part_count(&self) -> usize {
        self.len()
    }

    fn add_forces_of_parts(
        &self,
        (parts, first): (&[u32], u32),
        places: &[Lane],
        residual: &mut [Lane],
    ) {
        for part in parts {
            self[(part - first) as usize].add_force(places, residual);
        }
    }

    fn energy_j(&self, places: &[Lane]) -> f64 {
        self.iter().map(|bend| bend.energy_j(places)).sum()
    }

    fn edges(&self) -> Vec<Edge> {
        self.iter().flat_map(Bend::edges).collect()
    }

    fn tangent_at(&self, _: &Place<'_>, out: &mut dyn FnMut(u32, u32, Matrix3)) {
        self.iter().for_each(|bend| bend.tangent(out));
    }

    fn is_of_sheets(&self) -> bool {
        !self.is_empty()
    }

    fn is_safeguard(&self) -> bool {
        self.is_empty()
    }
}

/// The part of a vector in the plane of two others, as multiples of them.
fn in_plane(v: &Vector3, along: &Vector3, aside: &Vector3) -> (f64, f64) {
    let (aa, ab, bb) = (along.dot(along), along.dot(aside), aside.dot(aside));
    let (va, vb) = (v.dot(along), v.dot(aside));
    let determinant = aa * bb - ab * ab;
    // Neighbours in one line, or in one point, span no plane.
    if determinant > 1e-6 * aa * bb {
        (
            (va * bb - vb * ab) / determinant,
            (vb * aa - va * ab) / determinant,
        )
    } else {
        (0.0, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lanes(points: &[Point3]) -> Vec<Lane> {
        points.iter().map(|p| [p.x, p.y, p.z, 0.0]).collect()
    }

    // ∫ ½ D κ² of an arc of radius r.
    #[test]
    fn a_bent_row_has_the_energy_of_an_arc() {
        let (h, r, plate) = (1e-3, 0.2, 7.0);
        let flat: Vec<Point3> = (0..3)
            .map(|k| Point3::new(h * k as f64, 0.0, 0.0))
            .collect();
        let bend = Bend::new(&Row::of([0, 1, 2]), &flat, plate, h * h).unwrap();
        let arc: Vec<Point3> = (0..3)
            .map(|k| {
                let angle = h * (k as f64 - 1.0) / r;
                Point3::new(r * angle.sin(), 0.0, r * (1.0 - angle.cos()))
            })
            .collect();
        let exact = 0.5 * plate * h * h / (r * r);
        // (h / r)² / 12 and the chord's share: 1e-5.
        assert!((bend.energy_j(&lanes(&arc)) / exact - 1.0).abs() < 1e-4);
        assert_eq!(bend.energy_j(&lanes(&flat)), 0.0);
    }

    #[test]
    fn forces_are_the_falling_slope_and_edges_are_the_tangent_of_a_flat_row() {
        let flat: Vec<Point3> = [0.0, 1.0, 2.5]
            .iter()
            .map(|&x| Point3::new(x, 0.0, 0.0))
            .collect();
        let bend = Bend::new(&Row::of([0, 1, 2]), &flat, 2.0, 0.5).unwrap();
        let places = lanes(&[
            Point3::new(0.1, 0.2, 0.0),
            Point3::new(1.0, -0.1, 0.3),
            Point3::new(2.4, 0.5, 0.1),
        ]);
        let mut forces = vec![[0.0; 4]; 3];
        bend.add_force(&places, &mut forces);
        for node in 0..3 {
            for c in 0..3 {
                let (mut above, mut below) = (places.clone(), places.clone());
                above[node][c] += 1e-6;
                below[node][c] -= 1e-6;
                let slope = (bend.energy_j(&above) - bend.energy_j(&below)) / 2e-6;
                assert!((forces[node][c] + slope).abs() < 1e-8);
            }
        }
        // Flat at rest: the energy is ½ w |s·x|², whose matrix the edges spell out.
        let x: [f64; 3] = [0.3, -0.7, 0.9];
        let by_edges: f64 = bend
            .edges()
            .iter()
            .map(|&(a, b, k)| k * (x[a as usize] - x[b as usize]).powi(2))
            .sum();
        let s: f64 = bend.terms().map(|(k, w)| x[k as usize] * w).sum();
        assert!((by_edges - bend.stiffness * s * s).abs() < 1e-12);
    }
}
