//! Bending of membranes: three nodes in a row resist a change of how far the middle one stands off.
//!
//! v = α x₋ + β x₊ − (α + β) x, with α = 2 / (h₋ (h₋ + h₊)) and β = 2 / (h₊ (h₋ + h₊)), is the
//! second derivative along the row. Its energy ½ w (|v| − |v₀|)² has w = D A, the bending stiffness
//! D = E t³ / (12 (1 − ν²)) of a plate times the area that the row stands for. The direction of v
//! is free, so turning costs nothing (Bouaziz et al. 2014, sec. 5.3).

use palpate_geometry::math::{Lane, Point3, Vector3};

/// One row of three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// Nodes: before, middle, after.
    pub nodes: [u32; 3],
    /// (α, −(α + β), β), 1/m².
    pub weights: [f64; 3],
    /// w, N·m³.
    pub stiffness: f64,
    /// |v₀|, 1/m.
    pub rest: f64,
}

impl Bend {
    /// A row of nodes at rest, of bending stiffness D (N·m) over an area (m²); `None` where nodes
    /// coincide.
    pub fn new(nodes: [u32; 3], rest: &[Point3], plate_n_m: f64, area_m2: f64) -> Option<Self> {
        let [a, b, c] = nodes.map(|k| rest[k as usize]);
        let (before, after) = ((b - a).norm(), (c - b).norm());
        if !(before > 0.0 && after > 0.0) {
            return None;
        }
        let whole = before + after;
        let (alpha, beta) = (2.0 / (before * whole), 2.0 / (after * whole));
        let weights = [alpha, -(alpha + beta), beta];
        let v: Vector3 = a.coords * weights[0] + b.coords * weights[1] + c.coords * weights[2];
        Some(Self {
            nodes,
            weights,
            stiffness: plate_n_m * area_m2,
            rest: v.norm(),
        })
    }

    /// w s sᵀ as edges (a, b, k) of a Laplacian: its rows sum to zero.
    pub fn edges(&self) -> [(u32, u32, f64); 3] {
        let [a, b, c] = self.nodes;
        let [s, t, u] = self.weights;
        let edge = |i: u32, j: u32, product: f64| (i.min(j), i.max(j), -self.stiffness * product);
        [edge(a, b, s * t), edge(b, c, t * u), edge(a, c, s * u)]
    }

    fn second_derivative(&self, places: &[Lane]) -> Lane {
        let mut v = [0.0; 4];
        for (&node, weight) in self.nodes.iter().zip(self.weights) {
            for c in 0..3 {
                v[c] += places[node as usize][c] * weight;
            }
        }
        v
    }

    /// Adds −∂E/∂x.
    pub(super) fn add_force(&self, places: &[Lane], residual: &mut [Lane]) {
        let v = self.second_derivative(places);
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        let share = if length > 0.0 {
            1.0 - self.rest / length
        } else {
            0.0
        };
        for (&node, weight) in self.nodes.iter().zip(self.weights) {
            for c in 0..3 {
                residual[node as usize][c] -= self.stiffness * share * weight * v[c];
            }
        }
    }

    /// Elastic energy, J.
    pub(super) fn energy_j(&self, places: &[Lane]) -> f64 {
        let v = self.second_derivative(places);
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        0.5 * self.stiffness * (length - self.rest).powi(2)
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
        let bend = Bend::new([0, 1, 2], &flat, plate, h * h).unwrap();
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
        let bend = Bend::new([0, 1, 2], &flat, 2.0, 0.5).unwrap();
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
        let s: f64 = x.iter().zip(bend.weights).map(|(x, w)| x * w).sum();
        assert!((by_edges - bend.stiffness * s * s).abs() < 1e-12);
    }
}
