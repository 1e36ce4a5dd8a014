//! Points of the surface at pairs of rows, computed when first asked for.
//!
//! A point stays until the net moves, so that the refinement pays for each once, and a rigid
//! surface pays once for all.

use super::grid::GridAxis;
use super::grid::wrap;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;

/// The net and the points made of it.
#[derive(Clone, Debug)]
pub(super) struct SpherePoints {
    /// (extended u × extended v): w x, w y, w z, w; what a period repeats is there twice.
    net: Vec<[f64; 4]>,
    columns: usize,
    rational: bool,
    flip: bool,
    /// (rows v × extended u): the net's rows blended in v. A point then takes a blend in u only.
    strips: Vec<[f64; 4]>,
    strip_stamps: Vec<u32>,
    /// (rows u × rows v), m; only where the stamp is that of now.
    points: Vec<(Point3, u32)>,
    now: u32,
    /// Points computed since last asked.
    pub computed: u32,
}

/// Squared sine, times the ratio of the tangents, below which two tangents give no normal.
const REGULAR: f64 = 1e-6;

impl SpherePoints {
    pub fn new(surface: &Surface, u: &GridAxis, v: &GridAxis) -> Self {
        let count = u.parameters.len() * v.parameters.len();
        let mut new = Self {
            net: vec![[0.0; 4]; u.columns[1] * v.columns[1]],
            columns: v.columns[1],
            rational: surface.weights().is_some(),
            flip: surface.flip_normal(),
            strips: vec![[0.0; 4]; v.parameters.len() * u.columns[1]],
            strip_stamps: vec![0; v.parameters.len()],
            points: vec![(Point3::origin(), 0); count],
            now: 0,
            computed: 0,
        };
        new.load(surface.net().points(), surface.weights(), u, v);
        new
    }

    /// Takes over control points; all points are to be computed anew.
    pub fn load(
        &mut self,
        control: &[Point3],
        weights: Option<&[f64]>,
        u: &GridAxis,
        v: &GridAxis,
    ) {
        for i in 0..u.columns[1] {
            let row = wrap(i, u.columns[0]) * v.columns[0];
            for j in 0..v.columns[1] {
                let k = row + wrap(j, v.columns[0]);
                let (p, w) = (control[k], weights.map_or(1.0, |w| w[k]));
                self.net[i * self.columns + j] = [p.x * w, p.y * w, p.z * w, w];
            }
        }
        self.forget();
    }

    fn forget(&mut self) {
        if self.now == u32::MAX {
            self.points.iter_mut().for_each(|point| point.1 = 0);
            self.strip_stamps.fill(0);
            self.now = 0;
        }
        self.now += 1;
    }

    /// The net, extended: w x, w y, w z, w.
    pub fn net(&self) -> &[[f64; 4]] {
        &self.net
    }

    /// True when the weights are not all one.
    pub fn is_rational(&self) -> bool {
        self.rational
    }

    /// The outward side is against S_u × S_v.
    pub fn is_flipped(&self) -> bool {
        self.flip
    }

    /// S at row `i` in u and `j` in v.
    #[inline(always)]
    pub fn at(&mut self, u: &GridAxis, v: &GridAxis, i: u32, j: u32) -> Point3 {
        let (point, stamp) = self.points[i as usize * v.parameters.len() + j as usize];
        if stamp == self.now {
            point
        } else {
            self.compute(u, v, i, j)
        }
    }

    #[inline(never)]
    fn compute(&mut self, u: &GridAxis, v: &GridAxis, i: u32, j: u32) -> Point3 {
        let rows = u.columns[1];
        let strip = &mut self.strips[j as usize * rows..][..rows];
        if self.strip_stamps[j as usize] != self.now {
            self.strip_stamps[j as usize] = self.now;
            let (column, m) = v.row(j, 0);
            for (line, sum) in self.net.chunks_exact(self.columns).zip(strip.iter_mut()) {
                *sum = blended(&line[column..], m);
            }
        }
        let (row, n) = u.row(i, 0);
        let [x, y, z, w] = blended(&strip[row..], n);
        let point = if self.rational {
            Point3::new(x / w, y / w, z / w)
        } else {
            Point3::new(x, y, z)
        };
        self.points[i as usize * v.parameters.len() + j as usize] = (point, self.now);
        self.computed += 1;
        point
    }

    /// Unit outward normal by the tangents; `None` where they do not say, as at a pole.
    pub fn normal(&mut self, u: &GridAxis, v: &GridAxis, i: u32, j: u32) -> Option<Vector3> {
        let lengths =
            [u, v].map(|axis| axis.parameters[axis.parameters.len() - 1] - axis.parameters[0]);
        let (mut du, mut dv) = (
            self.blend(u, v, [i, j], [1, 0]),
            self.blend(u, v, [i, j], [0, 1]),
        );
        if self.rational {
            // Quotient rule, without the division by w that the direction does not need.
            let s = self.at(u, v, i, j);
            for c in 0..3 {
                du[c] -= s[c] * du[3];
                dv[c] -= s[c] * dv[3];
            }
        }
        let vector = |x: [f64; 4], length: f64| Vector3::new(x[0], x[1], x[2]) * length;
        let (du, dv) = (vector(du, lengths[0]), vector(dv, lengths[1]));
        let cross = du.cross(&dv);
        let longer = du.norm_squared().max(dv.norm_squared());
        let area = cross.norm_squared();
        // False for NaN and for no tangents at all.
        (area > REGULAR * longer * longer)
            .then(|| cross / if self.flip { -area.sqrt() } else { area.sqrt() })
    }

    fn blend(&self, u: &GridAxis, v: &GridAxis, [i, j]: [u32; 2], orders: [usize; 2]) -> [f64; 4] {
        let ((row, n), (column, m)) = (u.row(i, orders[0]), v.row(j, orders[1]));
        let mut sum = [0.0; 4];
        for (a, n) in n.iter().enumerate() {
            let along = blended(&self.net[(row + a) * self.columns + column..], m);
            for c in 0..4 {
                sum[c] += along[c] * n;
            }
        }
        sum
    }
}

/// Σ values × points.
#[inline(always)]
fn blended(points: &[[f64; 4]], values: &[f64]) -> [f64; 4] {
    let mut sum = [0.0; 4];
    // The degrees that scenes are made of get straight code.
    if let (Some(points), Ok(values)) = (points.first_chunk::<4>(), <&[f64; 4]>::try_from(values)) {
        for (point, value) in points.iter().zip(values) {
            for c in 0..4 {
                sum[c] += point[c] * value;
            }
        }
    } else {
        for (point, value) in points.iter().zip(values) {
            for c in 0..4 {
                sum[c] += point[c] * value;
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::fifty_surfaces;
    use palpate_geometry::surface::{Topology, builtin};

    #[test]
    fn points_and_normals_are_those_of_the_surface_before_and_after_it_moves() {
        let builtins =
            ["teardrop", "sphere", "torus", "sheet"].map(|name| builtin(name, None, None).unwrap());
        for mut surface in fifty_surfaces(7).into_iter().chain(builtins) {
            let Topology { torn, .. } = surface.topology();
            let (u, v) = (
                GridAxis::new(surface.knots_u(), 9, false),
                GridAxis::new(surface.knots_v(), 12, false),
            );
            let mut points = SpherePoints::new(&surface, &u, &v);
            for round in 0..2 {
                for (i, &x) in u.parameters.iter().enumerate() {
                    for (j, &y) in v.parameters.iter().enumerate() {
                        // At a disjoined knot two rows share a parameter, which names one side
                        // only.
                        if torn != [false, false]
                            && (i == 0 || j == 0 || x == u.parameters[i - 1] || round > 1)
                        {
                            continue;
                        }
                        let point = points.at(&u, &v, i as u32, j as u32);
                        let near = |x: f64, y: f64| (point - surface.point(x, y)).norm() < 1e-13;
                        let ends = near(x, y) || near(x.next_down(), y) || near(x, y.next_down());
                        assert!(ends || near(x.next_down(), y.next_down()), "({x}, {y})");
                        if let Some(normal) = points.normal(&u, &v, i as u32, j as u32) {
                            let inside = |axis: &GridAxis, k: usize, x: f64| {
                                k > 0
                                    && k + 1 < axis.parameters.len()
                                    && x != axis.parameters[k - 1]
                                    && x != axis.parameters[k + 1]
                            };
                            if inside(&u, i, x) && inside(&v, j, y) {
                                assert!(
                                    (normal - surface.normal(x, y)).norm() < 1e-7,
                                    "normal at ({x}, {y})"
                                );
                            }
                        }
                    }
                }
                for point in surface.net_mut().points_mut() {
                    point.x += 0.1 * libm::sin(point.y);
                }
                points.load(surface.net().points(), surface.weights(), &u, &v);
            }
        }
    }
}
