//! A fixed grid of parameters on surfaces with the same knots: points and normals out, nets back in.
//!
//! `M = A_u P A_vᵀ` and its inverse in the least-squares sense, a direction at a time. Everything is allocated at
//! construction.

use super::{ControlNet, Surface};
use crate::basis::{Blending, BlendingInverse};
use crate::math::{Point3, Vector3};

/// Parameters (u_i, v_j) for all surfaces with one pair of knot vectors.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleGrid {
    u: Blending,
    v: Blending,
}

/// Points and unit outward normals at a [`SampleGrid`], u-major, and the room to compute them.
#[derive(Clone, Debug)]
pub struct Samples {
    /// (rows × columns), m.
    pub points: Vec<Point3>,
    /// (rows × columns), unit, outward.
    pub normals: Vec<Vector3>,
    /// (net columns) homogeneous sums over u, for order 0 and order 1.
    lines: [Vec<(Vector3, f64)>; 2],
}

impl SampleGrid {
    /// The grid of all pairs of `us` and `vs` on surfaces with the knots of this one.
    pub fn new(surface: &Surface, us: &[f64], vs: &[f64]) -> Self {
        Self { u: Blending::new(surface.knots_u(), us), v: Blending::new(surface.knots_v(), vs) }
    }

    /// From blendings at hand, u and v.
    pub fn from_blendings(u: Blending, v: Blending) -> Self {
        Self { u, v }
    }

    /// Blending in u.
    pub fn u(&self) -> &Blending {
        &self.u
    }

    /// Blending in v.
    pub fn v(&self) -> &Blending {
        &self.v
    }

    /// Buffers of the right size, all zero.
    pub fn samples(&self) -> Samples {
        let count = self.u.rows() * self.v.rows();
        let line = vec![(Vector3::zeros(), 0.0); self.v.columns()];
        Samples {
            points: vec![Point3::origin(); count],
            normals: vec![Vector3::zeros(); count],
            lines: [line.clone(), line],
        }
    }

    /// Fills `out` from a surface with this grid's knots. Allocates nothing.
    pub fn evaluate_into(&self, surface: &Surface, out: &mut Samples) {
        let (columns, per_row) = (self.v.columns(), self.v.rows());
        debug_assert_eq!(
            (surface.net().rows(), surface.net().columns()),
            (self.u.columns(), columns),
            "the surface has another net than the grid was made for"
        );
        let points = surface.net().points();
        for i in 0..self.u.rows() {
            for (order, line) in out.lines.iter_mut().enumerate() {
                line.fill((Vector3::zeros(), 0.0));
                for (a, n) in self.u.entries(i, order) {
                    for (j, sum) in line.iter_mut().enumerate() {
                        let k = a * columns + j;
                        let share = n * surface.weights().map_or(1.0, |w| w[k]);
                        sum.0 += points[k].coords * share;
                        sum.1 += share;
                    }
                }
            }
            for j in 0..per_row {
                let (mut s, mut s_u, mut s_v) =
                    ((Vector3::zeros(), 0.0), (Vector3::zeros(), 0.0), (Vector3::zeros(), 0.0));
                let add = |sum: &mut (Vector3, f64), term: (Vector3, f64), m: f64| {
                    sum.0 += term.0 * m;
                    sum.1 += term.1 * m;
                };
                for ((b, m), (_, d)) in self.v.entries(j, 0).zip(self.v.entries(j, 1)) {
                    add(&mut s, out.lines[0][b], m);
                    add(&mut s_u, out.lines[1][b], m);
                    add(&mut s_v, out.lines[0][b], d);
                }
                let (point, du, dv) = if surface.weights().is_some() {
                    let point = s.0 / s.1;
                    (point, (s_u.0 - point * s_u.1) / s.1, (s_v.0 - point * s_v.1) / s.1)
                } else {
                    (s.0, s_u.0, s_v.0)
                };
                let k = i * per_row + j;
                out.points[k] = Point3::from(point);
                out.normals[k] = surface.normal_from(&du, &dv, self.u.parameters()[i], self.v.parameters()[j]);
            }
        }
    }
}

/// Fits nets to grids of points at the parameters of two blendings.
#[derive(Clone, Debug)]
pub struct GridFit {
    u: BlendingInverse,
    v: BlendingInverse,
    /// (rows × net columns): fitted in v, not yet in u.
    half: Vec<Vector3>,
    line: Vec<Vector3>,
    fitted: Vec<Vector3>,
    scratch: Vec<Vector3>,
}

impl GridFit {
    /// Factors both directions and allocates what fits need.
    pub fn new(grid: &SampleGrid) -> Self {
        let (u, v) = (&grid.u, &grid.v);
        let longest = u.rows().max(v.rows()).max(u.columns()).max(v.columns());
        Self {
            half: vec![Vector3::zeros(); u.rows() * v.columns()],
            line: vec![Vector3::zeros(); longest],
            fitted: vec![Vector3::zeros(); longest],
            scratch: vec![Vector3::zeros(); 2 * longest],
            u: BlendingInverse::new(u.clone()),
            v: BlendingInverse::new(v.clone()),
        }
    }

    /// The net, without weights, whose points at the grid miss `points` (u-major) least in the sum of squares.
    pub fn fit_into(&mut self, points: &[Point3], net: &mut ControlNet) {
        let (rows, per_row) = (self.u.blending().rows(), self.v.blending().rows());
        let (net_rows, net_columns) = (self.u.blending().columns(), self.v.blending().columns());
        debug_assert_eq!(points.len(), rows * per_row, "points and grid disagree");
        debug_assert_eq!((net.rows(), net.columns()), (net_rows, net_columns), "net and grid disagree");
        for i in 0..rows {
            for (j, sample) in self.line[..per_row].iter_mut().enumerate() {
                *sample = points[i * per_row + j].coords;
            }
            let fitted = &mut self.half[i * net_columns..(i + 1) * net_columns];
            self.v.fit(&self.line[..per_row], fitted, &mut self.scratch);
        }
        for j in 0..net_columns {
            for (i, sample) in self.line[..rows].iter_mut().enumerate() {
                *sample = self.half[i * net_columns + j];
            }
            self.u.fit(&self.line[..rows], &mut self.fitted[..net_rows], &mut self.scratch);
            for (i, fitted) in self.fitted[..net_rows].iter().enumerate() {
                net.points_mut()[i * net_columns + j] = Point3::from(*fitted);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::builtin::builtin;
    use super::super::testing::fifty_surfaces;
    use super::*;
    use crate::basis::testing::{Random, parameters};
    use crate::basis::{KnotKind, KnotVector};

    #[test]
    fn samples_are_the_points_and_normals_of_the_surface() {
        let mut random = Random(81);
        let builtins = ["teardrop", "sphere", "torus", "sheet"].map(|name| builtin(name, None, None).unwrap());
        for surface in fifty_surfaces(81).into_iter().chain(builtins) {
            let us = parameters(&mut random, surface.knots_u(), 5);
            let vs = parameters(&mut random, surface.knots_v(), 5);
            let grid = SampleGrid::new(&surface, &us, &vs);
            let mut samples = grid.samples();
            grid.evaluate_into(&surface, &mut samples);
            for (i, &u) in us.iter().enumerate() {
                for (j, &v) in vs.iter().enumerate() {
                    let k = i * vs.len() + j;
                    let (point, normal) = (surface.point(u, v), surface.normal(u, v));
                    assert!((samples.points[k] - point).norm() < 1e-14, "({u}, {v}) of {surface:?}");
                    assert!((samples.normals[k] - normal).norm() < 1e-8, "({u}, {v}) of {surface:?}");
                }
            }
        }
    }

    #[test]
    fn a_fit_to_its_own_samples_recovers_the_net() {
        for surface in fifty_surfaces(82).into_iter().filter(|s| s.weights().is_none()) {
            let spread = |knots: &KnotVector| -> Vec<f64> {
                let (t, count) = (knots.knots(), knots.degree() + 2);
                let at = |i: usize, k: usize| t[i] + (t[i + 1] - t[i]) * (k as f64 + 0.5) / count as f64;
                knots.spans().flat_map(|i| (0..count).map(move |k| at(i, k))).collect()
            };
            let grid = SampleGrid::new(&surface, &spread(surface.knots_u()), &spread(surface.knots_v()));
            let mut samples = grid.samples();
            grid.evaluate_into(&surface, &mut samples);
            let mut net = surface.net().clone();
            net.points_mut().fill(Point3::origin());
            GridFit::new(&grid).fit_into(&samples.points, &mut net);
            // The outermost control points of an open vector reach the domain with 1/p! at most: from degree 6 on the
            // samples' own rounding is worth more than the bar there.
            let faint = [surface.knots_u(), surface.knots_v()]
                .iter()
                .any(|knots| knots.kind() == KnotKind::Open && knots.degree() >= 6);
            let tolerance = if faint { 1e-8 } else { 1e-10 } * surface.size();
            for (a, b) in net.points().iter().zip(surface.net().points()) {
                assert!((a - b).norm() < tolerance, "{a} is not {b} in {surface:?}");
            }
        }
    }
}
