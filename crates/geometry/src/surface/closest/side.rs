//! The normal at a foot, and so on which side of the surface a query lies.
//!
//! Where the surface is smooth the sign of (q − S)·n decides. At a crease, a seam or a pole several
//! normals meet; their mean, each weighted by the angle of its sector, decides rightly for any
//! closed surface (Bærentzen & Aanæs, *Signed distance computation using the angle weighted
//! pseudonormal*, 2005).

use super::newton::NewtonPlace;
use crate::basis::{KnotKind, KnotVector, Side};
use crate::math::{Point3, Vector3};
use crate::surface::bezier::{Joint, PieceDirection};
use crate::surface::joints::Joints;
use crate::surface::tensor::{Frame, Surface, wrap};

/// Points closer than this, relative to their coordinates, are one: the two ends of a closed
/// direction, a pole's row.
pub(super) const SAME: f64 = 1e-9;
/// Sectors of the fan around a pole, per span.
const RING: usize = 2;

/// How far into a span the two sheets of a cusp are compared.
const CUSP_STEP: f64 = 0.01;

/// A surface with the spans its places refer to.
pub(super) struct Site<'a> {
    pub surface: &'a Surface,
    pub u: &'a PieceDirection,
    pub v: &'a PieceDirection,
    /// Of a branching surface.
    pub joints: Option<&'a Joints>,
}

/// A tangent that is shorter than this, relative to how much it changes across its span, has no direction.
const SHORT: f64 = 1e-8;

impl Site<'_> {
    /// Outward unit normal at a foot: never NaN; the surface's own where it has one, else the way
    /// to the query.
    pub fn normal(&self, place: NewtonPlace, frame: &Frame, to_query: &Vector3) -> Vector3 {
        let (a, b) = (&self.u.spans[place.i], &self.v.spans[place.j]);
        let at_knot =
            place.u <= a.start || place.u >= a.end || place.v <= b.start || place.v >= b.end;
        let pole = at_knot.then(|| self.pole(place, frame)).flatten();
        let pole = pole.or_else(|| self.beside_pole(place, frame));
        let found = pole.or_else(|| at_knot.then(|| self.corner(place, frame)).flatten());
        let outward = if self.surface.flip_normal() {
            -1.0
        } else {
            1.0
        };
        found
            .or_else(|| self.near(place, frame))
            .map(|n| n * outward)
            .or_else(|| to_query.try_normalize(0.0))
            .unwrap_or_else(Vector3::z)
    }

    /// The normal of a pole beside it, where a tangent is as short as its rounding.
    fn beside_pole(&self, place: NewtonPlace, frame: &Frame) -> Option<Vector3> {
        let (a, b) = (&self.u.spans[place.i], &self.v.spans[place.j]);
        let short =
            |tangent: &Vector3, width: f64| tangent.norm() <= SHORT * width * frame.duv.norm();
        let nearer = |x: f64, start: f64, end: f64| if end - x < x - start { end } else { start };
        let (mut u, mut v) = (place.u, place.v);
        if short(&frame.du, b.end - b.start) {
            v = nearer(v, b.start, b.end);
        } else if short(&frame.dv, a.end - a.start) {
            u = nearer(u, a.start, a.end);
        } else {
            return None;
        }
        let pole = NewtonPlace { u, v, ..place };
        self.pole(pole, &self.frame(pole))
    }

    /// The frame of a place as its own piece sees it.
    pub fn frame(&self, NewtonPlace { i, j, u, v }: NewtonPlace) -> Frame {
        let side = |x: f64, d: &PieceDirection, k: usize| {
            if x >= d.spans[k].end {
                Side::Left
            } else {
                Side::Right
            }
        };
        self.surface
            .frame_from(u, v, side(u, self.u, i), side(v, self.v, j))
    }

    /// The normal of a place as its own piece sees it, from a little farther inside where the
    /// tangents vanish.
    fn near(&self, place: NewtonPlace, frame: &Frame) -> Option<Vector3> {
        smooth_normal(frame).or_else(|| {
            let (a, b) = (&self.u.spans[place.i], &self.v.spans[place.j]);
            let (cu, cv) = (0.5 * (a.start + a.end), 0.5 * (b.start + b.end));
            [1e-6, 1e-4, 1e-2, 0.3].into_iter().find_map(|inward| {
                let (u, v) = (
                    place.u + inward * (cu - place.u),
                    place.v + inward * (cv - place.v),
                );
                smooth_normal(&self.frame(NewtonPlace { u, v, ..place }))
            })
        })
    }

    /// Mean normal where creases or coinciding ends meet; `None` where the foot is smooth.
    fn corner(&self, place: NewtonPlace, frame: &Frame) -> Option<Vector3> {
        if let Some(joints) = self.joints {
            return self.meeting(joints, place);
        }
        let tolerance = SAME * frame.point.coords.amax();
        let same = |p: Point3| (p - frame.point).norm() <= tolerance;
        let us = sides(self.u, place.i, place.u, |i, u| {
            same(self.frame(NewtonPlace { i, u, ..place }).point)
        });
        let vs = sides(self.v, place.j, place.v, |j, v| {
            same(self.frame(NewtonPlace { j, v, ..place }).point)
        });
        let corner = us[1].is_some() && vs[1].is_some();
        if us[1].is_none() && vs[1].is_none() {
            return None;
        }
        let mut sum = Vector3::zeros();
        let mut sheets = [None; 4];
        for &(i, u, into_u) in us.iter().flatten() {
            for &(j, v, into_v) in vs.iter().flatten() {
                let place = NewtonPlace { i, j, u, v };
                let frame = self.frame(place);
                if let Some(n) = self.near(place, &frame) {
                    // On an edge both sectors are half turns; at a corner each is the angle between
                    // its tangents.
                    let weight = if corner {
                        angle(&(frame.du * into_u), &(frame.dv * into_v))
                    } else {
                        1.0
                    };
                    sum += n * weight;
                    if let Some(slot) = sheets.iter_mut().find(|s| s.is_none()) {
                        *slot = Some((place, n, [into_u, into_v]));
                    }
                }
            }
        }
        sum.try_normalize(1e-9).or_else(|| self.cusp(&sheets))
    }

    /// Mean normal of the patches that edges join at a place; `None` where there is but one.
    fn meeting(&self, joints: &Joints, place: NewtonPlace) -> Option<Vector3> {
        let meeting = joints.meeting(place.into());
        if meeting.spots().len() < 2 {
            return None;
        }
        let mut sum = Vector3::zeros();
        for spot in meeting.spots() {
            let frame = self.frame(NewtonPlace::from(*spot));
            let Some(n) = self.near(NewtonPlace::from(*spot), &frame) else {
                continue;
            };
            let [u0, u1, v0, v1] = joints.edges_at(*spot);
            let into = |low: bool, high: bool| if high && !low { -1.0 } else { 1.0 };
            let corner = (u0 || u1) && (v0 || v1);
            // At a corner each sector weighs its angle; along an edge both are half turns.
            let weight = if corner {
                angle(&(frame.du * into(u0, u1)), &(frame.dv * into(v0, v1)))
            } else {
                std::f64::consts::PI
            };
            sum += n * weight;
        }
        sum.try_normalize(1e-9)
    }

    /// Where two sheets leave an edge the same way their normals cancel. Between the sheets is the
    /// solid, and then the edge points out of it; or a crack, and then the edge points into the
    /// solid.
    fn cusp(&self, sheets: &[Option<(NewtonPlace, Vector3, [f64; 2])>; 4]) -> Option<Vector3> {
        let (a, normal, into) = sheets[0]?;
        let (b, _, other) = sheets
            .iter()
            .flatten()
            .find(|(_, n, _)| n.dot(&normal) < -0.99)?;
        let inside = |p: NewtonPlace, [into_u, into_v]: [f64; 2]| {
            let (wide_u, wide_v) = (
                self.u.spans[p.i].end - self.u.spans[p.i].start,
                self.v.spans[p.j].end - self.v.spans[p.j].start,
            );
            // Along the parameter in which the sheets differ.
            let [du, dv] = if a.i == b.i && a.u == b.u {
                [0.0, into_v * wide_v]
            } else {
                [into_u * wide_u, 0.0]
            };
            self.frame(NewtonPlace {
                u: p.u + CUSP_STEP * du,
                v: p.v + CUSP_STEP * dv,
                ..p
            })
            .point
        };
        let (first, second) = (inside(a, into), inside(*b, *other));
        let away = self.frame(a).point - nalgebra::center(&first, &second);
        let solid = (first - second).dot(&normal) >= 0.0;
        away.try_normalize(0.0).map(|n| if solid { n } else { -n })
    }

    /// Mean normal around a collapsed edge, when the foot lies on one.
    fn pole(&self, place: NewtonPlace, frame: &Frame) -> Option<Vector3> {
        let net = self.surface.net();
        let (rows, columns) = (net.rows(), net.columns());
        let tolerance = SAME * frame.point.coords.amax();
        let same = |p: &Point3| (p - frame.point).norm() <= tolerance;
        let end = |d: &PieceDirection, kind: KnotKind, x: f64, count: usize| match kind {
            KnotKind::Clamped if x <= d.domain.0 => Some(0),
            KnotKind::Clamped if x >= d.domain.1 => Some(count - 1),
            _ => None,
        };
        let row = end(self.u, self.surface.knots_u().kind(), place.u, rows);
        let column = end(self.v, self.surface.knots_v().kind(), place.v, columns);
        if row.is_some_and(|i| (0..columns).all(|j| same(net.at(i, j)))) {
            let (next, turn) = if row == Some(0) {
                (1, 1.0)
            } else {
                (rows - 2, -1.0)
            };
            let leave = |j: usize| self.leaving(next, j, frame);
            fan(self.surface.knots_v(), leave).map(|n| n * turn)
        } else if column.is_some_and(|j| (0..rows).all(|i| same(net.at(i, j)))) {
            let (next, turn) = if column == Some(0) {
                (1, -1.0)
            } else {
                (columns - 2, 1.0)
            };
            let leave = |i: usize| self.leaving(i, next, frame);
            fan(self.surface.knots_u(), leave).map(|n| n * turn)
        } else {
            None
        }
    }

    /// Weighted way from a pole to a control point of the next row: their blend is the tangent out
    /// of the pole.
    fn leaving(&self, row: usize, column: usize, pole: &Frame) -> Vector3 {
        let net = self.surface.net();
        let weight = self
            .surface
            .weights()
            .map_or(1.0, |w| w[row * net.columns() + column]);
        (net.at(row, column) - pole.point) * weight
    }
}

/// Unit normal of a frame, unless the tangents are too short or too nearly parallel to say.
fn smooth_normal(frame: &Frame) -> Option<Vector3> {
    let n = frame.du.cross(&frame.dv);
    let length = n.norm();
    (length > 1e-9 * frame.du.norm() * frame.dv.norm() && length > 0.0).then(|| n / length)
}

fn angle(a: &Vector3, b: &Vector3) -> f64 {
    libm::atan2(a.cross(b).norm(), a.dot(b))
}

/// The spans that meet at a parameter: (span, parameter, direction into the span). `coincide` says
/// whether a place at the other end of the domain is the same point.
pub(super) fn sides(
    d: &PieceDirection,
    span: usize,
    x: f64,
    coincide: impl FnOnce(usize, f64) -> bool,
) -> [Option<(usize, f64, f64)>; 2] {
    let n = d.spans.len();
    let here = &d.spans[span];
    let at_start = x <= here.start;
    let own = Some((span, x, if x >= here.end { -1.0 } else { 1.0 }));
    if !at_start && x < here.end {
        return [own, None];
    }
    let (joint, other, into) = if at_start {
        (here.before, (span + n - 1) % n, -1.0)
    } else {
        (here.after, (span + 1) % n, 1.0)
    };
    let y = if at_start {
        d.spans[other].end
    } else {
        d.spans[other].start
    };
    let at_end = if at_start { span == 0 } else { span + 1 == n };
    let meets = match joint {
        Joint::Smooth => false,
        Joint::Crease => true,
        Joint::Apart => at_end && coincide(other, y),
    };
    [own, meets.then_some((other, y, into))]
}

/// Angle-weighted mean of the normals `out × ∂out` around a pole, whose tangents out of it are the
/// blends of `leave`.
fn fan(along: &KnotVector, leave: impl Fn(usize) -> Vector3) -> Option<Vector3> {
    let out = |x: f64, side: Side| {
        let window = along.window_from(x, side);
        let mut sum = Vector3::zeros();
        for (k, share) in window.values().iter().enumerate() {
            sum += leave(wrap(window.first + k, along.count())) * *share;
        }
        sum
    };
    let t = along.knots();
    let mut sum = Vector3::zeros();
    for k in along.spans() {
        let (start, end) = (t[k], t[k + 1]);
        let mut last = out(start, Side::Right);
        for m in 1..=RING {
            let x = if m == RING {
                end
            } else {
                start + (end - start) * m as f64 / RING as f64
            };
            let next = out(x, Side::Left);
            let across = last.cross(&next);
            if let Some(n) = across.try_normalize(1e-12 * last.norm() * next.norm()) {
                sum += n * angle(&last, &next);
            }
            last = next;
        }
    }
    sum.try_normalize(1e-9)
}

/// The other end of a clamped or open direction, when a parameter is at one.
pub(super) fn other_end(d: &PieceDirection, x: f64) -> Option<(usize, f64)> {
    if d.periodic {
        None
    } else if x <= d.domain.0 {
        Some((d.spans.len() - 1, d.domain.1))
    } else if x >= d.domain.1 {
        Some((0, d.domain.0))
    } else {
        None
    }
}
