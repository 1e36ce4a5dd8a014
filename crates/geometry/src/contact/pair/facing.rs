//! Pairs of places that face each other: each in the direction of the other's normal.
//!
//! Newton's method in four unknowns on n_B·A_u = n_B·A_v = 0 and (B − A)·B_s = (B − A)·B_t = 0,
//! which say that the signed distance to B is stationary over A. Normals, not the difference of the
//! places, stand in the first two: they do not vanish where the surfaces cross or touch.

use crate::math::{Point3, Vector3};
use crate::surface::bezier::PieceDirection;
use crate::surface::{BezierPieces, Frame, Surface};

/// Steps of Newton's method; it arrives in five or never.
const STEPS: usize = 12;
/// Where one surface turns against the other by less than this across a part, rad, they are flat on each other.
pub(super) const FLAT: f64 = 1e-9;

/// A stationary pair.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact) struct StationaryPair {
    /// (u, v) on the first surface, (s, t) on the second.
    pub at: [f64; 4],
    /// Both are flat there: one place of many.
    pub flat: bool,
}

/// One of two surfaces, its pieces up to date.
#[derive(Clone, Copy)]
pub(in crate::contact) struct Half<'a> {
    pub surface: &'a Surface,
    pub pieces: &'a BezierPieces,
}

impl Half<'_> {
    fn confine(&self, x: [f64; 2]) -> [f64; 2] {
        [confine(&self.pieces.u, x[0]), confine(&self.pieces.v, x[1])]
    }
}

fn confine(d: &PieceDirection, x: f64) -> f64 {
    let (start, end) = d.domain;
    if d.periodic && (x < start || x > end) {
        let period = end - start;
        return (x - period * ((x - start) / period).floor()).clamp(start, end);
    }
    x.clamp(start, end)
}

/// From the middles of two parts and their widths: the pair in or beside them, if Newton goes
/// there.
pub(in crate::contact) fn face(
    a: Half<'_>,
    b: Half<'_>,
    start: [[f64; 2]; 2],
    widths: [[f64; 2]; 2],
) -> Option<StationaryPair> {
    // Unwrapped, so that leaving is noticed.
    let mut x = start;
    for step in 0..STEPS {
        let (at, bt) = (a.confine(x[0]), b.confine(x[1]));
        let (fa, fb) = (a.pieces.frame_at(at), b.pieces.frame_at(bt));
        let flip = if b.surface.flip_normal() { -1.0 } else { 1.0 };
        let (da, db) = match newton(&fa, &fb, flip, widths[0])? {
            Way::Step(da, db) => (da, db),
            Way::Flat => return over(a, b, [fa, fb], [at, bt], widths),
        };
        let mut short = true;
        for k in 0..2 {
            let (mut d, w, held) = (
                if k == 0 { da } else { db },
                widths[k],
                if k == 0 { at } else { bt },
            );
            let most = (d[0].abs() / w[0]).max(d[1].abs() / w[1]);
            if most > 1.0 {
                d = [d[0] / most, d[1] / most];
            }
            short &= most < 1e-10;
            let half = if k == 0 { a } else { b };
            for c in 0..2 {
                x[k][c] += d[c];
                // Another pair of parts holds what is farther away.
                let out = (x[k][c] - start[k][c]).abs() / w[c];
                if out > 1.5 + 0.25 * step as f64 || !out.is_finite() {
                    return None;
                }
            }
            // At an end that does not wrap, the parameter stays there.
            let y = half.confine(x[k]);
            for (c, direction) in [&half.pieces.u, &half.pieces.v].into_iter().enumerate() {
                if !direction.periodic {
                    x[k][c] = y[c];
                }
                short |= !direction.periodic
                    && step > 3
                    && y[c] == held[c]
                    && d[c] != 0.0
                    && most < 1e-3;
            }
        }
        if short {
            let (at, bt) = (a.confine(x[0]), b.confine(x[1]));
            return Some(StationaryPair {
                at: [at[0], at[1], bt[0], bt[1]],
                flat: false,
            });
        }
    }
    None
}

/// Of two places where surfaces are flat on each other: one of them with its foot on the other, in or beside its part.
fn over(
    a: Half<'_>,
    b: Half<'_>,
    [fa, fb]: [Frame; 2],
    [at, bt]: [[f64; 2]; 2],
    widths: [[f64; 2]; 2],
) -> Option<StationaryPair> {
    let below = |point: &Point3, on: &Frame, from: [f64; 2], widths: [f64; 2]| {
        let (e, f, g) = (
            on.du.norm_squared(),
            on.du.dot(&on.dv),
            on.dv.norm_squared(),
        );
        let way = point - on.point;
        let (x, y) = (on.du.dot(&way), on.dv.dot(&way));
        let det = e * g - f * f;
        let step = [(g * x - f * y) / det, (e * y - f * x) / det];
        let near = (0..2).all(|c| step[c].abs() <= 1.5 * widths[c]);
        near.then(|| [from[0] + step[0], from[1] + step[1]])
    };
    let [at, bt] = match below(&fa.point, &fb, bt, widths[1]) {
        Some(foot) => [at, b.confine(foot)],
        None => [a.confine(below(&fb.point, &fa, at, widths[0])?), bt],
    };
    Some(StationaryPair {
        at: [at[0], at[1], bt[0], bt[1]],
        flat: true,
    })
}

/// Where to go from a pair of places.
enum Way {
    /// Steps of both.
    Step([f64; 2], [f64; 2]),
    /// The surfaces are flat on each other.
    Flat,
}

/// The step of both places; `widths` of the part of the first.
#[inline]
fn newton(a: &Frame, b: &Frame, flip: f64, widths: [f64; 2]) -> Option<Way> {
    let across = b.du.cross(&b.dv);
    let (e, f, g) = (b.du.norm_squared(), b.du.dot(&b.dv), b.dv.norm_squared());
    let det_g = e * g - f * f;
    // Comparisons that NaN fails.
    let regular = det_g > 1e-14 * e * g;
    if !regular {
        return None;
    }
    let n: Vector3 = across * (flip / det_g.sqrt());
    let r = b.point - a.point;
    let (l, m, k) = (n.dot(&b.duu), n.dot(&b.duv), n.dot(&b.dvv));
    // M = g + r·B_ij, by what (B − A)·B_i changes with B's parameters.
    let (ma, mb, mc) = (e + r.dot(&b.duu), f + r.dot(&b.duv), g + r.dot(&b.dvv));
    let det_m = ma * mc - mb * mb;
    let regular = det_m.abs() > 1e-9 * det_g;
    if !regular {
        return None;
    }
    let solve_m = |x: [f64; 2]| {
        [
            (mc * x[0] - mb * x[1]) / det_m,
            (ma * x[1] - mb * x[0]) / det_m,
        ]
    };
    // n_k = −b_kl g^lm B_m; so C x = −(b g⁻¹ P)ᵀ x.
    let turn = |x: [f64; 2], p: [f64; 2]| {
        let y = [(g * p[0] - f * p[1]) / det_g, (e * p[1] - f * p[0]) / det_g];
        -(x[0] * (l * y[0] + m * y[1]) + x[1] * (m * y[0] + k * y[1]))
    };
    let (pu, pv) = (
        [b.du.dot(&a.du), b.dv.dot(&a.du)],
        [b.du.dot(&a.dv), b.dv.dot(&a.dv)],
    );
    let rb = [r.dot(&b.du), r.dot(&b.dv)];
    let (su, sv, sr) = (solve_m(pu), solve_m(pv), solve_m(rb));
    let huu = n.dot(&a.duu) + turn(su, pu);
    let huv = n.dot(&a.duv) + turn(sv, pu);
    let hvu = n.dot(&a.duv) + turn(su, pv);
    let hvv = n.dot(&a.dvv) + turn(sv, pv);
    // How far a slope turns across the part.
    let turns = [huu, huv, hvu, hvv].map(f64::abs);
    let [wu, wv] = widths;
    let (du, dv) = (a.du.norm(), a.dv.norm());
    if turns[0].max(turns[1] * wv / wu) * wu < FLAT * du
        && turns[3].max(turns[2] * wu / wv) * wv < FLAT * dv
    {
        return Some(Way::Flat);
    }
    let right = [-n.dot(&a.du) + turn(sr, pu), -n.dot(&a.dv) + turn(sr, pv)];
    let det = huu * hvv - huv * hvu;
    let scale = (huu.abs() + huv.abs()) * (hvv.abs() + hvu.abs());
    let regular = det.abs() > 1e-9 * scale;
    if !regular {
        return None;
    }
    let da = [
        (right[0] * hvv - right[1] * huv) / det,
        (right[1] * huu - right[0] * hvu) / det,
    ];
    let db = [
        su[0] * da[0] + sv[0] * da[1] - sr[0],
        su[1] * da[0] + sv[1] * da[1] - sr[1],
    ];
    Some(Way::Step(da, db))
}
