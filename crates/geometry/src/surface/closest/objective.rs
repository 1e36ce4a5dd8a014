//! What is minimised over the surface: the squared distance to a point, or the height along a
//! direction.
//!
//! Both are a quotient A / W of Bernstein polynomials on every Bézier piece `N / w`: `|N − q w|² /
//! w²` of degree (2p, 2q), and `−d·N / w` of degree (p, q). So `A − β W ≥ 0` says that nothing on
//! the piece is better than β.

use super::bernstein::{binomial, greatest};
use crate::math::{Point3, Vector3};
use crate::surface::bezier::BezierPieces;
use crate::surface::tensor::{Frame, Surface};

/// Value and derivatives of an objective at one parameter pair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jet {
    pub f: f64,
    pub g: [f64; 2],
    /// uu, uv, vv.
    pub h: [f64; 3],
    /// |S_u|², |S_v|²: turns parameters into metres.
    pub metric: [f64; 2],
    /// How far rounding may have moved `f`.
    pub noise: f64,
    /// How far rounding may have moved the slope, objective per metre.
    pub slope_noise: f64,
}

/// Something to descend on.
pub(super) trait Smooth {
    /// Value and derivatives.
    fn jet(&self, frame: &Frame) -> Jet;
}

/// Something to minimise, with bounds.
pub(super) trait Objective: Smooth {
    /// Coefficients in each direction.
    fn orders(&self, p: usize, q: usize) -> (usize, usize);
    /// Value at a point.
    fn value(&self, x: f64, y: f64, z: f64) -> f64;
    /// Lower bound over a box (least and greatest corner).
    fn box_bound(&self, low: [f64; 3], high: [f64; 3]) -> f64;
    /// Coefficients of A, and of W when rational, for a piece; returns how far rounding may have
    /// moved those of A.
    fn form(
        &self,
        pieces: &BezierPieces,
        piece: usize,
        tables: &Tables,
        a: &mut [f64],
        w: &mut [f64],
    ) -> Noise;
    /// The value that counts as "better than `best` by more than `delta_m`".
    fn floor(&self, best: f64, delta_m: f64) -> f64;
}

/// What is minimised, over which surface.
pub(super) struct Problem<'a, O: Objective> {
    pub surface: &'a Surface,
    pub tables: &'a Tables,
    pub objective: &'a O,
    pub size_m: f64,
}

/// The coefficients of A on a piece: how many in each direction, and whether W goes with them.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Grid {
    pub nu: usize,
    pub nv: usize,
    pub rational: bool,
}

impl Grid {
    /// Squared distances to a bicubic piece without weights.
    pub const BICUBIC: Self = Self::polynomial(7);

    /// As many in both directions, without W.
    pub const fn polynomial(n: usize) -> Self {
        Self {
            nu: n,
            nv: n,
            rational: false,
        }
    }

    /// Of an objective on the pieces of a surface.
    #[inline(always)]
    pub fn of<O: Objective>(objective: &O, pieces: &BezierPieces) -> Self {
        let (nu, nv) = objective.orders(pieces.u.degree, pieces.v.degree);
        Self {
            nu,
            nv,
            rational: pieces.is_rational(),
        }
    }

    /// Coefficients in all.
    #[inline(always)]
    pub fn len(self) -> usize {
        self.nu * self.nv
    }
}

/// How far rounding may have moved the coefficients of A: one of the two is 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Noise {
    /// Any of them.
    pub absolute: f64,
    /// Each, as a share of that of W: where weights are unlike, rounding that is nothing beside the
    /// largest of them is more than all there is at the smallest.
    pub of_w: f64,
}

impl Noise {
    /// `share` of the greatest square (distance) or value (height) of the control points: `weighted`
    /// by its weight, or `plain` without.
    fn new(share: f64, weighted: f64, plain: f64, unlike: bool) -> Self {
        let noise = share * f64::EPSILON;
        match unlike {
            true => Self {
                absolute: 0.0,
                of_w: noise * plain,
            },
            false => Self {
                absolute: noise * weighted,
                of_w: 0.0,
            },
        }
    }

    /// On a part with these coefficients of W.
    #[inline(always)]
    pub fn on(&self, w: &[f64]) -> f64 {
        if self.of_w > 0.0 {
            self.of_w * greatest(w)
        } else {
            self.absolute
        }
    }
}

/// Weights of a piece that are as unlike as its rounding can still be judged by the largest.
const ALIKE: f64 = 8.0;

fn are_unlike(points: &[[f64; 4]]) -> bool {
    let (low, high) = (points.iter()).fold((f64::INFINITY, 0.0_f64), |(low, high), x| {
        (low.min(x[3]), high.max(x[3]))
    });
    high > ALIKE * low
}

/// Binomial factors of the products.
#[derive(Clone, Debug)]
pub(super) struct Tables {
    /// C(p, i) C(q, j), ((p + 1)(q + 1)).
    factors: Vec<f64>,
    /// 1 / (C(2p, i) C(2q, j)), ((2p + 1)(2q + 1)).
    inverse: Vec<f64>,
}

impl Tables {
    pub fn new(p: usize, q: usize) -> Self {
        let grid = |p: usize, q: usize| -> Vec<f64> {
            (0..=p)
                .flat_map(|i| (0..=q).map(move |j| binomial(p, i) * binomial(q, j)))
                .collect()
        };
        Self {
            factors: grid(p, q),
            inverse: grid(2 * p, 2 * q).into_iter().map(|x| 1.0 / x).collect(),
        }
    }
}

/// Squared distance to a point.
pub(super) struct Distance {
    pub q: Point3,
}

impl Smooth for Distance {
    #[inline]
    fn jet(&self, x: &Frame) -> Jet {
        let r = x.point - self.q;
        let (uu, vv) = (x.du.norm_squared(), x.dv.norm_squared());
        let f = r.norm_squared();
        let size = x.point.coords.amax() + self.q.coords.amax();
        Jet {
            f,
            g: [2.0 * r.dot(&x.du), 2.0 * r.dot(&x.dv)],
            h: [
                2.0 * (uu + r.dot(&x.duu)),
                2.0 * (x.du.dot(&x.dv) + r.dot(&x.duv)),
                2.0 * (vv + r.dot(&x.dvv)),
            ],
            metric: [uu, vv],
            noise: 4.0 * f64::EPSILON * (f + f.sqrt() * size),
            slope_noise: 4.0 * f64::EPSILON * size,
        }
    }
}

impl Objective for Distance {
    fn orders(&self, p: usize, q: usize) -> (usize, usize) {
        (2 * p + 1, 2 * q + 1)
    }

    #[inline]
    fn value(&self, x: f64, y: f64, z: f64) -> f64 {
        let (x, y, z) = (x - self.q.x, y - self.q.y, z - self.q.z);
        x * x + y * y + z * z
    }

    #[inline]
    fn box_bound(&self, low: [f64; 3], high: [f64; 3]) -> f64 {
        let mut sum = 0.0;
        for c in 0..3 {
            let (below, above) = (low[c] - self.q[c], self.q[c] - high[c]);
            let out = if below > above { below } else { above };
            let out = if out > 0.0 { out } else { 0.0 };
            sum += out * out;
        }
        sum
    }

    #[inline(always)]
    fn form(
        &self,
        pieces: &BezierPieces,
        piece: usize,
        tables: &Tables,
        a: &mut [f64],
        w: &mut [f64],
    ) -> Noise {
        let points = pieces.points(piece);
        match Grid::of(self, pieces) {
            Grid::BICUBIC => square(&self.q, points, tables, Grid::BICUBIC, a, w),
            grid => square(&self.q, points, tables, grid, a, w),
        }
    }

    fn floor(&self, best: f64, delta_m: f64) -> f64 {
        let d = (best.max(0.0).sqrt() - delta_m).max(0.0);
        d * d
    }
}

/// Coefficients of |N − q w|² and w².
#[inline(always)]
fn square(
    query: &Point3,
    points: &[[f64; 4]],
    tables: &Tables,
    grid: Grid,
    a: &mut [f64],
    w: &mut [f64],
) -> Noise {
    const MOST: usize = (crate::basis::MAX_DEGREE + 1) * (crate::basis::MAX_DEGREE + 1);
    if grid.nu.div_ceil(2) * grid.nv.div_ceil(2) <= 16 {
        let mut d = [[0.0; 16]; 4];
        return square_with(&mut d, query, points, tables, grid, a, w);
    }
    let mut d = [[0.0; MOST]; 4];
    square_with(&mut d, query, points, tables, grid, a, w)
}

#[inline(always)]
fn square_with<const K: usize>(
    d: &mut [[f64; K]; 4],
    query: &Point3,
    points: &[[f64; 4]],
    tables: &Tables,
    grid: Grid,
    a: &mut [f64],
    w: &mut [f64],
) -> Noise {
    let Grid { nu, nv, rational } = grid;
    // Orders are 2p + 1 and 2q + 1.
    let (n, m) = (nu.div_ceil(2), nv.div_ceil(2));
    let (points, factors, inverse) = (
        &points[..n * m],
        &tables.factors[..n * m],
        &tables.inverse[..nu * nv],
    );
    let unlike = rational && are_unlike(points);
    let (mut largest, mut farthest) = (0.0_f64, 0.0_f64);
    for k in 0..n * m {
        let x = &points[k];
        let r = [
            x[0] - query.x * x[3],
            x[1] - query.y * x[3],
            x[2] - query.z * x[3],
        ];
        let square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
        largest = if square > largest { square } else { largest };
        if unlike {
            farthest = farthest.max(square / (x[3] * x[3]));
        }
        for c in 0..3 {
            d[c][k] = factors[k] * r[c];
        }
        d[3][k] = factors[k] * x[3];
    }
    let a = &mut a[..nu * nv];
    a.fill(0.0);
    for i in 0..n {
        for ii in i..n {
            let twice = if i == ii { 1.0 } else { 2.0 };
            let row = &mut a[(i + ii) * nv..(i + ii + 1) * nv];
            for j in 0..m {
                let (x, y, z) = (
                    twice * d[0][i * m + j],
                    twice * d[1][i * m + j],
                    twice * d[2][i * m + j],
                );
                for jj in 0..m {
                    let k = ii * m + jj;
                    row[j + jj] += x * d[0][k] + y * d[1][k] + z * d[2][k];
                }
            }
        }
    }
    for (x, s) in a.iter_mut().zip(inverse) {
        *x *= s;
    }
    if rational {
        let w = &mut w[..nu * nv];
        w.fill(0.0);
        for i in 0..n {
            for ii in 0..n {
                for j in 0..m {
                    let x = d[3][i * m + j];
                    for jj in 0..m {
                        w[(i + ii) * nv + j + jj] += x * d[3][ii * m + jj];
                    }
                }
            }
        }
        for (x, s) in w.iter_mut().zip(inverse) {
            *x *= s;
        }
    }
    Noise::new(4.0, largest, farthest, unlike)
}

/// Minus the height along a unit direction.
pub(super) struct Along {
    pub d: Vector3,
}

impl Smooth for Along {
    #[inline]
    fn jet(&self, x: &Frame) -> Jet {
        let d = -self.d;
        Jet {
            f: d.dot(&x.point.coords),
            g: [d.dot(&x.du), d.dot(&x.dv)],
            h: [d.dot(&x.duu), d.dot(&x.duv), d.dot(&x.dvv)],
            metric: [x.du.norm_squared(), x.dv.norm_squared()],
            noise: 4.0 * f64::EPSILON * x.point.coords.amax(),
            slope_noise: 4.0 * f64::EPSILON,
        }
    }
}

impl Objective for Along {
    fn orders(&self, p: usize, q: usize) -> (usize, usize) {
        (p + 1, q + 1)
    }

    #[inline]
    fn value(&self, x: f64, y: f64, z: f64) -> f64 {
        -(self.d.x * x + self.d.y * y + self.d.z * z)
    }

    #[inline]
    fn box_bound(&self, low: [f64; 3], high: [f64; 3]) -> f64 {
        let mut sum = 0.0;
        for c in 0..3 {
            sum -= (self.d[c] * low[c]).max(self.d[c] * high[c]);
        }
        sum
    }

    #[inline(always)]
    fn form(
        &self,
        pieces: &BezierPieces,
        piece: usize,
        _: &Tables,
        a: &mut [f64],
        w: &mut [f64],
    ) -> Noise {
        let points = pieces.points(piece);
        let unlike = pieces.is_rational() && are_unlike(points);
        let (mut largest, mut farthest) = (0.0_f64, 0.0_f64);
        for (a, x) in a.iter_mut().zip(points) {
            *a = self.value(x[0], x[1], x[2]);
            largest = if a.abs() > largest { a.abs() } else { largest };
            if unlike {
                farthest = farthest.max(a.abs() / x[3]);
            }
        }
        if pieces.is_rational() {
            w.iter_mut().zip(points).for_each(|(w, x)| *w = x[3]);
        }
        Noise::new(8.0, largest, farthest, unlike)
    }

    fn floor(&self, best: f64, delta_m: f64) -> f64 {
        best - delta_m
    }
}
