//! Integrals over regions: Gauss's rules on rectangles, and on both sides of the curve in those that it crosses.
//!
//! Both sides of a column have the same abscissae across it, so that what is lost at a cut is won on its other side: the sum
//! over all regions is the integral over the surface, to rounding on polynomial surfaces.

use super::CutPlane;
use super::field::Field;
use super::graph::Graph;
use super::grid::{Grid, WHOLE};
use super::leaves::{Leaf, Leaves};
use super::regions::Regions;
use crate::math::{Point3, Vector3, gauss_legendre};
use crate::surface::Surface;
use std::ops::AddAssign;

/// Points of the rule on a whole span, on halves, and on what is smaller.
const POINTS: [usize; 3] = [16, 14, 14];
/// As [`POINTS`], for a rational surface.
const RATIONAL_POINTS: [usize; 3] = [24, 20, 16];

/// Integrals over a part of the surface, about a point x₀ of the plane; N = S_u × S_v.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Integrals {
    /// ∬ |N|, m².
    pub area_m2: f64,
    /// ∬ N, m².
    pub across_m2: Vector3,
    /// ⅓ ∬ (S − x₀) · N, m³.
    pub volume_m3: f64,
    /// ¼ ∬ (S − x₀) (S − x₀) · N, m⁴: the first moment, since div(x xᵢ) = 4 xᵢ and x · n is 0 on the plane.
    pub first_m4: Vector3,
    /// ∬ (S − x₀) |N|, m³.
    pub area_first_m3: Vector3,
}

impl AddAssign<&Self> for Integrals {
    fn add_assign(&mut self, other: &Self) {
        self.area_m2 += other.area_m2;
        self.across_m2 += other.across_m2;
        self.volume_m3 += other.volume_m3;
        self.first_m4 += other.first_m4;
        self.area_first_m3 += other.area_first_m3;
    }
}

struct Work<'a> {
    surface: &'a Surface,
    grid: &'a Grid,
    origin: Point3,
    rules: Vec<Vec<(f64, f64)>>,
}

/// By region.
pub(super) fn integrals(
    surface: &Surface,
    plane: &CutPlane,
    field: &Field,
    grid: &Grid,
    leaves: &Leaves,
    regions: &Regions,
) -> Vec<Integrals> {
    let degree = field.degree();
    // Of x (x · N): exact for polynomials.
    let exact = 2 * degree[0].max(degree[1]);
    let counts = match surface.weights() {
        Some(_) => RATIONAL_POINTS,
        None => POINTS,
    };
    let counts = counts.map(|count| count.max(exact));
    let work = Work {
        surface,
        grid,
        origin: plane.origin(),
        rules: counts.map(gauss_legendre).to_vec(),
    };
    let mut out = vec![Integrals::default(); regions.above.len()];
    for cell in &regions.cells {
        let sectors = cell.first..cell.first + cell.count;
        let region = |above: bool| {
            let found = (sectors.clone()).find(|&k| regions.sectors[k].above == above);
            regions.of[found.unwrap_or(cell.first)]
        };
        let arc = regions.sectors[cell.first].arc;
        for &k in &cell.leaves {
            let leaf = &leaves.all[k];
            let ends = arc.map(|arc| arc.map(|c| regions.crossings[c].uv));
            match ends.and_then(|ends| Graph::new(field, grid, leaf, ends)) {
                Some(graph) => {
                    let parts = work.divided(leaf, &graph);
                    out[region(true)] += &parts[0];
                    out[region(false)] += &parts[1];
                }
                None => {
                    let above = leaf.is_above_at_its_middle(degree);
                    out[region(above)] += &work.whole(leaf);
                }
            }
        }
    }
    out
}

impl Work<'_> {
    fn rule(&self, leaf: &Leaf) -> &[(f64, f64)] {
        let halvings = (WHOLE / leaf.size[0].max(leaf.size[1])).trailing_zeros() as usize;
        &self.rules[halvings.min(self.rules.len() - 1)]
    }

    /// Over a rectangle within a leaf.
    fn over(&self, leaf: &Leaf, u: [f64; 2], v: [f64; 2]) -> Integrals {
        let rule = self.rule(leaf);
        let mut sum = Integrals::default();
        let place = |[a, b]: [f64; 2], x: f64| a + (b - a) * 0.5 * (1.0 + x);
        for (x, wx) in rule {
            for (y, wy) in rule {
                let weight = 0.25 * wx * wy * (u[1] - u[0]) * (v[1] - v[0]);
                self.enter(&mut sum, leaf, [place(u, *x), place(v, *y)], weight);
            }
        }
        sum
    }

    fn whole(&self, leaf: &Leaf) -> Integrals {
        self.over(leaf, [0.0, 1.0], [0.0, 1.0])
    }

    /// Above and below the curve.
    fn divided(&self, leaf: &Leaf, graph: &Graph<'_>) -> [Integrals; 2] {
        let mut parts = [Integrals::default(); 2];
        let rule = self.rule(leaf);
        let [a, b] = graph.ends;
        for [from, to] in [[0.0, a], [b, 1.0]] {
            if to > from {
                let above = graph.is_above([0.5 * (from + to), 0.5]);
                let (u, v) = match graph.over {
                    0 => ([from, to], [0.0, 1.0]),
                    _ => ([0.0, 1.0], [from, to]),
                };
                parts[usize::from(!above)] += &self.over(leaf, u, v);
            }
        }
        for (x, wx) in rule {
            let at = a + (b - a) * 0.5 * (1.0 + x);
            let (height, rises) = graph.height(at);
            for ([low, high], above) in [([0.0, height], !rises), ([height, 1.0], rises)] {
                for (y, wy) in rule {
                    let weight = 0.25 * wx * wy * (b - a) * (high - low);
                    let place = graph.place(at, low + (high - low) * 0.5 * (1.0 + y));
                    self.enter(&mut parts[usize::from(!above)], leaf, place, weight);
                }
            }
        }
        parts
    }

    fn enter(&self, sum: &mut Integrals, leaf: &Leaf, local: [f64; 2], weight: f64) {
        let [u, v] = leaf.parameters(self.grid, local);
        let frame = self.surface.frame(u, v);
        let weight = weight * leaf.extent(self.grid);
        let across = frame.du.cross(&frame.dv) * weight;
        let x = frame.point - self.origin;
        let through = x.dot(&across);
        let area = across.norm();
        sum.area_m2 += area;
        sum.across_m2 += across;
        sum.volume_m3 += through / 3.0;
        sum.first_m4 += x * (0.25 * through);
        sum.area_first_m3 += x * area;
    }
}
