//! Signed depth below one surface, as a field over another.
//!
//! With foot y, outward normal n and signed distance d of a place x, the gradient of d is n, and
//! its Hessian along the surface is −Yᵀ g⁻¹ b (g − d b)⁻¹ Y, where Y holds the tangents at y and g,
//! b are its fundamental forms: a parallel surface's curvature. So Newton's method climbs the depth
//! without differences.

use super::cells::Cells;
use crate::math::{Point3, Vector3};
use crate::surface::closest::{Bottom, Foot, Jet};
use crate::surface::{ClosestSolver, Frame, Surface};
use std::cell::{Cell, RefCell};

/// The surface that depth is measured below.
pub(in crate::contact) struct Below<'a> {
    pub surface: &'a Surface,
    pub solver: &'a mut ClosestSolver,
    pub cells: &'a Cells,
    /// −1 for the lower side of a sheet.
    pub side: f64,
}

/// A place over a surface.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact) struct Sounding {
    /// Depth below the surface, m; negative outside.
    pub depth_m: f64,
    pub foot: Foot,
    /// Outward unit normal along which depth grows fastest downwards.
    pub normal: Vector3,
    /// It is one: the foot is smooth, or the way to it long enough to be measured.
    pub has_normal: bool,
}

/// A way shorter than this, relative to the size of the surface that it leads to, has no direction: feet at edges and
/// poles are found to some 1e-9 of the size along the surface.
const MEASURED: f64 = 1e-5;

impl Below<'_> {
    fn sound(&self, query: &Point3, foot: Foot) -> Sounding {
        let at = &foot.at;
        // Beyond an open edge the distance has no sign. Straight over or under the edge the foot is
        // smooth, and the sign is that of the surface.
        let beyond = !foot.smooth && self.cells.on_open_edge(at.u, at.v);
        let depth_m = if beyond {
            -at.distance
        } else {
            -self.side * at.signed_distance
        };
        let measured = at.distance > MEASURED * self.cells.whole.diagonal();
        let normal = match foot.smooth || !measured {
            true => at.normal * self.side,
            false => (query - at.point) * (-1.0 / depth_m),
        };
        Sounding {
            depth_m,
            foot,
            normal,
            has_normal: foot.smooth || measured,
        }
    }

    /// Depth to four digits, and where its foot is.
    pub fn rough(&mut self, query: &Point3) -> (f64, (f64, f64)) {
        let at = self.solver.rough(self.surface, query);
        let edge = self.cells.on_open_edge(at.u, at.v);
        (
            if edge {
                -at.distance
            } else {
                -self.side * at.signed_distance
            },
            (at.u, at.v),
        )
    }

    /// From a foot nearby.
    pub fn follow(&mut self, query: &Point3, u: f64, v: f64) -> Sounding {
        let foot = self.solver.near_from(self.surface, query, u, v);
        self.sound(query, foot)
    }

    /// Certified.
    pub fn certain(&mut self, query: &Point3) -> Sounding {
        let foot = self.solver.certain(self.surface, query);
        self.sound(query, foot)
    }

    /// Goes up to the next greatest depth over another surface, from (u, v) with a foot nearby.
    pub fn climb(
        &mut self,
        upper: &Surface,
        upper_solver: &mut ClosestSolver,
        u: f64,
        v: f64,
        from: (f64, f64),
    ) -> (Bottom, Sounding) {
        let foot = Cell::new(from);
        let here = RefCell::new(self);
        let bottom = upper_solver.descend_by(upper, u, v, |frame| {
            let mut below = here.borrow_mut();
            let (s, t) = foot.get();
            let sounding = below.follow(&frame.point, s, t);
            foot.set((sounding.foot.at.u, sounding.foot.at.v));
            jet(frame, &sounding)
        });
        let (s, t) = foot.get();
        let sounding = here.into_inner().follow(&bottom.frame.point, s, t);
        (bottom, sounding)
    }
}

/// Signed distance −depth and its derivatives by the parameters of the upper surface.
pub(in crate::contact) fn jet(x: &Frame, sounding: &Sounding) -> Jet {
    let (n, d) = (sounding.normal, -sounding.depth_m);
    let y = &sounding.foot.frame;
    let (mu, mv) = (x.du.norm_squared(), x.dv.norm_squared());
    let mut h = [n.dot(&x.duu), n.dot(&x.duv), n.dot(&x.dvv)];
    if sounding.foot.smooth {
        let bend = Bend::new(y, &n, d);
        let (p, q) = (
            [y.du.dot(&x.du), y.dv.dot(&x.du)],
            [y.du.dot(&x.dv), y.dv.dot(&x.dv)],
        );
        let (hp, hq) = (bend.turn(p), bend.turn(q));
        h[0] += p[0] * hp[0] + p[1] * hp[1];
        h[1] += p[0] * hq[0] + p[1] * hq[1];
        h[2] += q[0] * hq[0] + q[1] * hq[1];
    } else if d.abs() > 0.0 {
        // A corner: the distance to a point.
        let (a, b) = (n.dot(&x.du), n.dot(&x.dv));
        h[0] += (mu - a * a) / d;
        h[1] += (x.du.dot(&x.dv) - a * b) / d;
        h[2] += (mv - b * b) / d;
    }
    let size = x.point.coords.amax() + y.point.coords.amax();
    Jet {
        f: d,
        g: [n.dot(&x.du), n.dot(&x.dv)],
        h,
        metric: [mu, mv],
        noise: 8.0 * f64::EPSILON * size,
        slope_noise: 1e-14,
    }
}

/// The Hessian of the distance, in terms of dot products with the tangents at the foot.
pub(in crate::contact) struct Bend {
    /// −g⁻¹ b (g − d b)⁻¹, symmetric: uu, uv, vv.
    w: [f64; 3],
}

impl Bend {
    pub fn new(y: &Frame, n: &Vector3, d: f64) -> Self {
        let (e, f, g) = (y.du.norm_squared(), y.du.dot(&y.dv), y.dv.norm_squared());
        let (l, m, k) = (n.dot(&y.duu), n.dot(&y.duv), n.dot(&y.dvv));
        let det_g = e * g - f * f;
        let (a, b, c) = (e - d * l, f - d * m, g - d * k);
        let det_m = a * c - b * b;
        // A pole, or a centre of curvature.
        if !(det_g > 1e-14 * e * g && det_m.abs() > 1e-9 * det_g) {
            return Self { w: [0.0; 3] };
        }
        let inverse = [g / det_g, -f / det_g, e / det_g];
        // K = g⁻¹ b, row by row.
        let kk = [
            inverse[0] * l + inverse[1] * m,
            inverse[0] * m + inverse[1] * k,
            inverse[1] * l + inverse[2] * m,
            inverse[1] * m + inverse[2] * k,
        ];
        let z = [c / det_m, -b / det_m, a / det_m];
        Self {
            w: [
                -(kk[0] * z[0] + kk[1] * z[1]),
                -0.5 * (kk[0] * z[1] + kk[1] * z[2] + kk[2] * z[0] + kk[3] * z[1]),
                -(kk[2] * z[1] + kk[3] * z[2]),
            ],
        }
    }

    #[inline]
    fn turn(&self, p: [f64; 2]) -> [f64; 2] {
        [
            self.w[0] * p[0] + self.w[1] * p[1],
            self.w[1] * p[0] + self.w[2] * p[1],
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::builtin;

    // The closed form against differences of certified distances.
    #[test]
    fn derivatives_of_depth_are_its_differences() {
        let (mut lower, upper) = (
            builtin("teardrop", None, None).unwrap(),
            builtin("torus", None, None).unwrap(),
        );
        for p in lower.net_mut().points_mut() {
            *p += Vector3::new(0.03, 0.01, -0.04);
        }
        let mut solver = ClosestSolver::new(&lower);
        let cells = Cells::new(&lower, solver.pieces(&lower));
        let mut below = Below {
            surface: &lower,
            solver: &mut solver,
            cells: &cells,
            side: 1.0,
        };
        let mut tried = 0;
        for k in 0..200 {
            let (u, v) = (
                f64::from(k) * 0.618_033 % 1.0,
                f64::from(k) * 0.414_213 % 1.0,
            );
            let h = 1e-4;
            let mut at = |a: f64, b: f64| below.certain(&upper.point(u + a * h, v + b * h));
            let middle = at(0.0, 0.0);
            let feet = [at(1.0, 1.0), at(-1.0, -1.0), at(1.0, -1.0), at(-1.0, 1.0)];
            // Not where the foot jumps, or a knot lies between.
            let far = feet
                .iter()
                .any(|f| (f.foot.at.point - middle.foot.at.point).norm() > 1e-4);
            if far
                || !middle.foot.smooth
                || !(0.05..0.95).contains(&u)
                || !(0.05..0.95).contains(&v)
            {
                continue;
            }
            let d = |a: f64, b: f64, below: &mut Below<'_>| {
                -below.certain(&upper.point(u + a * h, v + b * h)).depth_m
            };
            let (c, e, w) = (
                -middle.depth_m,
                d(1.0, 0.0, &mut below),
                d(-1.0, 0.0, &mut below),
            );
            let (n, s) = (d(0.0, 1.0, &mut below), d(0.0, -1.0, &mut below));
            let cross = -(feet[0].depth_m + feet[1].depth_m - feet[2].depth_m - feet[3].depth_m)
                / (4.0 * h * h);
            let frame = upper.frame(u, v);
            let jet = jet(&frame, &middle);
            let first = [(e - w) / (2.0 * h), (n - s) / (2.0 * h)];
            let second = [
                (e - 2.0 * c + w) / (h * h),
                cross,
                (n - 2.0 * c + s) / (h * h),
            ];
            let (mu, mv) = (jet.metric[0].sqrt(), jet.metric[1].sqrt());
            for (k, scale) in [mu, mv].into_iter().enumerate() {
                assert!(
                    (first[k] - jet.g[k]).abs() < 1e-5 * scale,
                    "({u}, {v}): {first:?} for {:?}",
                    jet.g
                );
            }
            // Curvatures are up to 100 a metre; third derivatives and jumps of them at knots leave
            // a few in a thousand.
            for (k, scale) in [mu * mu, mu * mv, mv * mv].into_iter().enumerate() {
                assert!(
                    (second[k] - jet.h[k]).abs() < 0.5 * scale,
                    "({u}, {v}) {k}: {second:?} for {:?}",
                    jet.h
                );
            }
            tried += 1;
        }
        assert!(tried > 80, "only {tried} places were smooth");
    }
}
