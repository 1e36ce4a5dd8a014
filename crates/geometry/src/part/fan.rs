//! What meets at the vertices of a part, and along its edges: tangents, normals, conormals.

use super::carrier::Carrier;
use super::part::{Edge, Face, Part, Side};
use super::pcurve::solved;
use crate::math::{Point3, Vector3};
use std::f64::consts::{PI, TAU};

/// Directions around an apex.
const AROUND: usize = 16;

/// An end of an edge at a vertex.
#[derive(Clone, Debug)]
pub(super) struct Tip {
    /// Unit vector along the edge, away from the vertex.
    pub tangent: Vector3,
    pub straight: bool,
}

/// A face at a vertex.
#[derive(Clone, Debug)]
pub(super) struct Corner {
    pub face: u32,
    pub uv: [f64; 2],
    /// Of the face, unit.
    pub normal: Vector3,
    /// Along which the face is straight: of cylinders and cones.
    pub ruling: Option<Vector3>,
    /// Conormals of the edges that leave the vertex and that come to it.
    pub inward: [Vector3; 2],
    /// Wider than half a turn.
    pub wide: bool,
    /// It has no tangent plane: an apex.
    pub sharp: bool,
}

/// What meets at a vertex, or at several at one place.
#[derive(Clone, Debug, Default)]
pub(super) struct Fan {
    pub tips: Vec<Tip>,
    pub corners: Vec<Corner>,
    /// From the vertex to places close by on what meets there, m.
    pub beside: Vec<Vector3>,
    /// Axis into a cone, sine and cosine to its lines: where no edge ends.
    pub apex: Option<(Vector3, [f64; 2])>,
    pub normal: Vector3,
    pub gap_m: f64,
    pub rim: bool,
}

/// Where a place of an edge is on a face, the face's normal there and its conormal.
pub(super) fn frame(
    part: &Part,
    edge: &Edge,
    side: &Side,
    at: (usize, f64),
    tangent: &Vector3,
) -> Option<([f64; 2], Vector3, Vector3)> {
    let face = &part.faces[side.face as usize];
    let uv = face.trim.chart.confined(edge.on(side, &part.faces, at)?);
    let normal = face.normal(uv);
    let left = normal.cross(tangent).try_normalize(1e-9)?;
    Some((uv, normal, if side.forward { left } else { -left }))
}

/// Along which a cylinder or a cone is straight.
pub(super) fn ruling(face: &Face, [u, _]: [f64; 2]) -> Option<Vector3> {
    match &face.carrier {
        Carrier::Cylinder { axes, .. } => Some(axes.z),
        Carrier::Cone {
            axes,
            half_angle_rad,
        } => {
            let ((sin_u, cos_u), (sin, cos)) = (libm::sincos(u), libm::sincos(*half_angle_rad));
            Some(axes.direction(&Vector3::new(sin * cos_u, sin * sin_u, cos)))
        }
        _ => None,
    }
}

/// From a place of a face's carrier to the one that a step in its tangent plane leads to.
pub(super) fn beside(face: &Face, uv: [f64; 2], step: &Vector3) -> Vector3 {
    let from = face.carrier.point(uv);
    match &face.carrier {
        Carrier::Spline(surface) => {
            let frame = surface.frame(uv[0], uv[1]);
            let [du, dv] = solved(&frame.du, &frame.dv, step);
            let to = face.trim.chart.confined([uv[0] + du, uv[1] + dv]);
            face.carrier.point(to) - from
        }
        carrier => (carrier.foot(&(from + step))).map_or(*step, |to| carrier.point(to) - from),
    }
}

/// Of each vertex: the first one at its place.
pub(super) fn same_places(part: &Part, within_m: f64) -> Vec<u32> {
    let at = |v: u32| part.vertices[v as usize].point;
    let mut order: Vec<u32> = (0..part.vertices.len() as u32).collect();
    order.sort_unstable_by(|&a, &b| at(a).x.total_cmp(&at(b).x).then(a.cmp(&b)));
    let mut first: Vec<u32> = (0..part.vertices.len() as u32).collect();
    let root = |first: &[u32], mut v: u32| {
        while first[v as usize] != v {
            v = first[v as usize];
        }
        v
    };
    for (k, &a) in order.iter().enumerate() {
        let beside = order[k + 1..].iter();
        for &b in beside.take_while(|&&b| at(b).x - at(a).x <= within_m) {
            if (at(a) - at(b)).norm() <= within_m {
                let (a, b) = (root(&first, a), root(&first, b));
                first[a.max(b) as usize] = a.min(b);
            }
        }
    }
    // No vertex comes before the first at its place.
    for v in 0..first.len() {
        first[v] = first[first[v] as usize];
    }
    first
}

/// What meets at each vertex.
pub(super) fn fans(part: &Part, first: &[u32], step_m: f64) -> Vec<Fan> {
    let mut fans = vec![Fan::default(); part.vertices.len()];
    for (vertex, &v) in part.vertices.iter().zip(first) {
        let fan = &mut fans[v as usize];
        fan.normal += vertex.normal;
        fan.gap_m = fan.gap_m.max(vertex.gap_m);
    }
    // Uses of faces at each vertex: face, leaves it (not: comes to it), along the edge away from the vertex, place.
    let mut uses: Vec<(u32, u32, bool, Vector3, [f64; 2])> = Vec::new();
    for edge in part.edges.iter().filter(|edge| !edge.sides.is_empty()) {
        for last in [false, true] {
            let v = first[edge.ends[usize::from(last)] as usize];
            let fan = &mut fans[v as usize];
            let along = edge.curve.tangent_at_end(last);
            let tangent = if last { -along } else { along };
            fan.tips.push(Tip {
                tangent,
                straight: edge.curve.is_line(),
            });
            fan.rim |= edge.sides.len() == 1;
            fan.gap_m = fan.gap_m.max(edge.gap_m);
            let end = match last {
                true => (edge.curve.segments() - 1, 1.0),
                false => (0, 0.0),
            };
            let length_m = edge.curve.slope(end).norm().max(f64::MIN_POSITIVE);
            let t = (step_m / length_m).min(0.25);
            let near = (end.0, if last { 1.0 - t } else { t });
            fan.beside
                .push(edge.curve.point(near) - edge.curve.point(end));
            for side in &edge.sides {
                if let Some(uv) = edge.on(side, &part.faces, end) {
                    uses.push((v, side.face, side.forward != last, tangent, uv));
                }
            }
        }
    }
    uses.sort_by_key(|one| (one.0, one.1));
    for group in uses.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        for (v, face, _, out, uv) in group.iter().filter(|one| one.2) {
            let owner = &part.faces[*face as usize];
            let uv = owner.trim.chart.confined(*uv);
            let normal = owner.normal(uv);
            let turn = |back: &Vector3| {
                let angle = libm::atan2(normal.dot(&out.cross(back)), out.dot(back));
                if angle <= 0.0 { angle + TAU } else { angle }
            };
            let backs = group.iter().filter(|one| !one.2).map(|one| one.3);
            let Some(back) = backs.min_by(|a, b| turn(a).total_cmp(&turn(b))) else {
                continue;
            };
            let angle = turn(&back);
            let apex = owner.carrier.apexes().into_iter();
            let point = part.vertices[*v as usize].point;
            let apex = (apex.map(|(place, _, v)| ((place - point).norm(), v)))
                .find(|(away_m, _)| *away_m <= 1e-2 * step_m);
            let fan = &mut fans[*v as usize];
            if let Some((_, height)) = apex {
                fan.around(owner, height, step_m);
            } else {
                let (sin, cos) = libm::sincos(0.5 * angle);
                let middle = out * cos + normal.cross(out) * sin;
                fan.beside.push(beside(owner, uv, &(middle * step_m)));
            }
            fan.corners.push(Corner {
                face: *face,
                uv,
                normal,
                ruling: ruling(owner, uv),
                inward: [normal.cross(out), back.cross(&normal)],
                wide: angle > PI,
                sharp: apex.is_some(),
            });
        }
    }
    for &v in &part.lone {
        let vertex = &part.vertices[v as usize];
        let owner = vertex.face.map(|face| &part.faces[face as usize]);
        fans[v as usize].apex = owner.and_then(|face| lines_of(face, &vertex.point));
    }
    for fan in &mut fans {
        fan.normal = (fan.normal.try_normalize(f64::MIN_POSITIVE)).unwrap_or_else(Vector3::z);
    }
    fans
}

impl Fan {
    /// Places of a face around the apex of its carrier.
    fn around(&mut self, face: &Face, height: f64, step_m: f64) {
        let apex = face.carrier.point([0.0, height]);
        for k in 0..AROUND {
            let u = TAU * (k as f64 + 0.5) / AROUND as f64;
            let v = match &face.carrier {
                Carrier::Torus { minor_m, .. } => height - (step_m / minor_m).copysign(height),
                _ => height + step_m,
            };
            if face.trim.contains([u, v]) {
                self.beside.push(face.carrier.point([u, v]) - apex);
            }
        }
    }
}

/// The lines that lead away from the apex of a carrier: around which axis, and the sine and cosine of their angle to it.
fn lines_of(face: &Face, apex: &Point3) -> Option<(Vector3, [f64; 2])> {
    match &face.carrier {
        Carrier::Cone {
            axes,
            half_angle_rad,
        } => {
            let (sin, cos) = libm::sincos(*half_angle_rad);
            Some((axes.z, [sin, cos]))
        }
        Carrier::Torus {
            axes,
            major_m,
            minor_m,
        } => {
            let (sin, cos) = libm::sincos(libm::acos(-major_m / minor_m));
            let up = axes.z.dot(&(apex - axes.origin));
            Some((if up < 0.0 { -axes.z } else { axes.z }, [sin, -cos]))
        }
        _ => None,
    }
}
