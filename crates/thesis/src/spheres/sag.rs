//! How far the surface leaves the bilinear patch through the corners of a cell.
//!
//! A function with second derivative at most M leaves its chord over a length h by at most M h²/8;
//! once along u and once along v gives |S − bilinear| ≤ (h_u² max|S_uu| + h_v² max|S_vv|) / 8
//! (Filip, Magedson & Markot 1986, without the mixed term that triangles need). The maxima come
//! from second differences of the net, of which S_uu is a convex combination. A bilinear patch lies
//! in the hull of its corners: so their sphere, widened by this, holds the surface of the cell.

use super::grid::GridAxis;
use super::points::SpherePoints;
use palpate_geometry::basis::KnotVector;

/// Bounds of second derivatives for every pair of knot spans.
#[derive(Clone, Debug)]
pub(super) struct Sag {
    u: Differences,
    v: Differences,
    /// (spans u × spans v) bound of |S_uu| and of |S_vv|, m per squared parameter.
    bounds: [Vec<f64>; 2],
    /// (extended u × extended v) squared lengths of second differences, and their maxima along v.
    squares: Vec<f64>,
    rows: Vec<f64>,
}

/// Second derivatives of a B-spline are a B-spline again: (columns − 2) triples of factors, and p
/// times the inverse widths for the first derivative.
#[derive(Clone, Debug)]
struct Differences {
    degree: usize,
    second: Vec<[f64; 3]>,
    first: Vec<f64>,
}

impl Differences {
    fn new(knots: &KnotVector) -> Self {
        let (p, t, n) = (knots.degree(), knots.knots(), knots.basis_count());
        // Differences over no width belong to no span.
        let over = |factor: usize, width: f64| {
            if width > 0.0 {
                factor as f64 / width
            } else {
                0.0
            }
        };
        let first: Vec<f64> = (0..n - 1)
            .map(|i| over(p, t[i + p + 1] - t[i + 1]))
            .collect();
        let second = (0..n.saturating_sub(2))
            .map(|i| {
                let c = if p >= 2 {
                    over(p - 1, t[i + p + 1] - t[i + 2])
                } else {
                    0.0
                };
                [
                    c * first[i],
                    -c * (first[i] + first[i + 1]),
                    c * first[i + 1],
                ]
            })
            .collect();
        Self {
            degree: p,
            second,
            first,
        }
    }
}

impl Sag {
    pub fn new(knots_u: &KnotVector, knots_v: &KnotVector, u: &GridAxis, v: &GridAxis) -> Self {
        let (spans, size) = (
            u.span_first.len() * v.span_first.len(),
            u.columns[1] * v.columns[1],
        );
        Self {
            u: Differences::new(knots_u),
            v: Differences::new(knots_v),
            bounds: [vec![0.0; spans], vec![0.0; spans]],
            squares: vec![0.0; size],
            rows: vec![0.0; size],
        }
    }

    /// New bounds for a new net.
    pub fn refresh(&mut self, points: &SpherePoints, u: &GridAxis, v: &GridAxis) {
        if points.is_rational() {
            self.refresh_rational(points.net(), u, v);
        } else {
            self.refresh_direction(0, points.net(), u, v);
            self.refresh_direction(1, points.net(), u, v);
        }
    }

    fn refresh_direction(
        &mut self,
        direction: usize,
        net: &[[f64; 4]],
        u: &GridAxis,
        v: &GridAxis,
    ) {
        let (rows, columns) = (u.columns[1], v.columns[1]);
        let (factors, stride) = if direction == 0 {
            (&self.u, columns)
        } else {
            (&self.v, 1)
        };
        let (high_i, high_j) = if direction == 0 {
            (rows.saturating_sub(2), columns)
        } else {
            (rows, columns.saturating_sub(2))
        };
        for i in 0..high_i {
            for j in 0..high_j {
                let k = i * columns + j;
                self.squares[k] = square(
                    net,
                    factors.second[if direction == 0 { i } else { j }],
                    k,
                    stride,
                );
            }
        }
        // Of the differences that live on a span: degree − 1 along the direction, degree + 1
        // across.
        let counts = [u, v].map(|axis| axis.width);
        let live = |d: usize| {
            if d == direction {
                counts[d].saturating_sub(2)
            } else {
                counts[d]
            }
        };
        for i in 0..high_i {
            for (j, &first) in v.span_first.iter().enumerate() {
                let from = i * columns + first as usize;
                self.rows[i * columns + j] = greatest(self.squares[from..from + live(1)].iter());
            }
        }
        for (i, &first) in u.span_first.iter().enumerate() {
            for j in 0..v.span_first.len() {
                let from = first as usize * columns + j;
                let most = greatest(self.rows[from..].iter().step_by(columns).take(live(0)));
                self.bounds[direction][i * v.span_first.len() + j] = most.sqrt();
            }
        }
    }

    /// S = A / w, seen from the middle of the points that shape a span, of which none is farther
    /// than r:
    /// |S_u| ≤ (|A_u| + |w_u| r) / w and |S_uu| ≤ (|A_uu| + 2 |w_u| |S_u| + |w_uu| r) / w.
    fn refresh_rational(&mut self, net: &[[f64; 4]], u: &GridAxis, v: &GridAxis) {
        let columns = v.columns[1];
        for (i, &first_u) in u.span_first.iter().enumerate() {
            for (j, &first_v) in v.span_first.iter().enumerate() {
                let from = first_u as usize * columns + first_v as usize;
                let (mut centre, mut least) = ([0.0; 3], f64::INFINITY);
                let all = || {
                    (0..u.width)
                        .flat_map(move |a| (0..v.width).map(move |b| from + a * columns + b))
                };
                for k in all() {
                    for c in 0..3 {
                        centre[c] += net[k][c] / net[k][3] / (u.width * v.width) as f64;
                    }
                    least = if net[k][3] < least { net[k][3] } else { least };
                }
                let seen = |k: usize| -> [f64; 4] {
                    let [x, y, z, w] = net[k];
                    [x - centre[0] * w, y - centre[1] * w, z - centre[2] * w, w]
                };
                let length = |x: [f64; 4]| (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt();
                let r = all()
                    .map(|k| length(seen(k)) / net[k][3])
                    .fold(0.0, f64::max);
                for (d, stride, factors, first) in
                    [(0, columns, &self.u, first_u), (1, 1, &self.v, first_v)]
                {
                    let (along, across) = if d == 0 {
                        (u.width, v.width)
                    } else {
                        (v.width, u.width)
                    };
                    let other = if d == 0 { 1 } else { columns };
                    let mut most = [0.0_f64; 4];
                    for b in 0..across {
                        for a in 0..along - 1 {
                            let (k, at) = (from + a * stride + b * other, first as usize + a);
                            let (x, y) = (seen(k), seen(k + stride));
                            let q: [f64; 4] =
                                std::array::from_fn(|c| (y[c] - x[c]) * factors.first[at]);
                            most[0] = most[0].max(length(q));
                            most[1] = most[1].max(q[3].abs());
                            if a + 2 < along && factors.degree >= 2 {
                                let (z, [f, g, h]) = (seen(k + 2 * stride), factors.second[at]);
                                let q: [f64; 4] =
                                    std::array::from_fn(|c| x[c] * f + y[c] * g + z[c] * h);
                                most[2] = most[2].max(length(q));
                                most[3] = most[3].max(q[3].abs());
                            }
                        }
                    }
                    let slope = (most[0] + most[1] * r) / least;
                    let bound = (most[2] + 2.0 * most[1] * slope + most[3] * r) / least;
                    self.bounds[d][i * v.span_first.len() + j] = bound;
                }
            }
        }
    }

    /// How far the surface is from the bilinear patch of a cell, at most, m.
    #[inline]
    pub fn of(&self, u: &super::grid::GridCell, v: &super::grid::GridCell, spans_v: usize) -> f64 {
        let (mut along_u, mut along_v) = (0.0, 0.0);
        for i in u.spans[0]..u.spans[1] {
            for j in v.spans[0]..v.spans[1] {
                let k = i as usize * spans_v + j as usize;
                along_u = if self.bounds[0][k] > along_u {
                    self.bounds[0][k]
                } else {
                    along_u
                };
                along_v = if self.bounds[1][k] > along_v {
                    self.bounds[1][k]
                } else {
                    along_v
                };
            }
        }
        // A little more, for rounding.
        (u.eighth * along_u + v.eighth * along_v) * (1.0 + 1e-9)
    }
}

#[inline(always)]
fn square(net: &[[f64; 4]], [f, g, h]: [f64; 3], k: usize, stride: usize) -> f64 {
    let (x, y, z) = (&net[k], &net[k + stride], &net[k + 2 * stride]);
    let of = |c: usize| x[c] * f + y[c] * g + z[c] * h;
    of(0) * of(0) + of(1) * of(1) + of(2) * of(2)
}

#[inline(always)]
fn greatest<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    values.fold(0.0, |most, &x| if x > most { x } else { most })
}
