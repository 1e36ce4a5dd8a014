//! What a STEP file says about a surface that is not taken over: trimming and other faces.

use super::StepError;
use super::surface::cartesian_point;
use super::syntax::{Exchange, Instance, Record, Value};
use super::units::Unit;
use crate::exchange::LeftOut;
use crate::math::Point3;
use crate::surface::{ClosestSolver, Surface};

/// A corner of a face is on the edge of its surface within this part of the domain, and on the
/// surface within this part of its size.
const ON_EDGE: f64 = 1e-4;

/// What of a file is left out when surface `id` alone is read, whole.
pub(super) fn left_out(
    exchange: &Exchange<'_>,
    id: u64,
    ids: &[u64],
    surface: &Surface,
    unit: &Unit,
) -> LeftOut {
    let mut left = LeftOut::default();
    for instance in exchange.instances() {
        let text = exchange.text(instance);
        if !(text.starts_with(b"ADVANCED_FACE") || text.starts_with(b"FACE_SURFACE")) {
            continue;
        }
        left.faces += 1;
        let Some(face) = record(exchange, instance) else {
            continue;
        };
        let [_, Value::List(bounds), Value::Reference(on), ..] = face.arguments.as_slice() else {
            continue;
        };
        left.other_faces += usize::from(!ids.contains(on));
        if *on == id && is_trimmed(exchange, bounds, surface, unit) {
            left.trimmed = true;
        }
    }
    left
}

fn record<'a>(exchange: &Exchange<'a>, instance: &Instance) -> Option<Record<'a>> {
    exchange.records(instance).ok()?.into_iter().next()
}

fn follow<'a>(exchange: &Exchange<'a>, value: &Value<'a>) -> Option<Record<'a>> {
    let Value::Reference(to) = value else {
        return None;
    };
    record(exchange, exchange.find(*to, *to).ok()?)
}

/// A face has a hole, or a corner that is not on the edge of its surface, or a straight edge whose
/// middle is not. Curved edges between corners on the edge of the surface are taken to run along it.
fn is_trimmed(
    exchange: &Exchange<'_>,
    bounds: &[Value<'_>],
    surface: &Surface,
    unit: &Unit,
) -> bool {
    if bounds.len() > 1 && !surface.topology().is_closed() {
        return true;
    }
    let mut solver = ClosestSolver::new(surface);
    let mut on_edge = |point: &Point3| {
        let foot = solver.closest(surface, point);
        // A corner off the surface says nothing.
        if foot.distance.abs() > ON_EDGE * surface.size() {
            return true;
        }
        [(foot.u, surface.knots_u()), (foot.v, surface.knots_v())]
            .iter()
            .any(|(parameter, knots)| {
                let (start, end) = knots.domain();
                let near = ON_EDGE * (end - start);
                parameter - start <= near || end - parameter <= near
            })
    };
    corners(exchange, bounds, unit).iter().any(|p| !on_edge(p))
}

/// The corners of a face, and the middles of its straight edges, m.
fn corners(exchange: &Exchange<'_>, bounds: &[Value<'_>], unit: &Unit) -> Vec<Point3> {
    let mut points = Vec::new();
    for bound in bounds {
        let edges = follow(exchange, bound)
            .and_then(|bound| follow(exchange, bound.arguments.get(1)?))
            .filter(|a| a.name == "EDGE_LOOP")
            .and_then(|a| a.arguments.into_iter().nth(1));
        let Some(Value::List(edges)) = edges else {
            continue;
        };
        for edge in &edges {
            let curve = follow(exchange, edge).and_then(|edge| {
                let known = edge.name == "ORIENTED_EDGE";
                follow(exchange, edge.arguments.get(3).filter(|_| known)?)
            });
            let Some(curve) = curve else { continue };
            let end = |k: usize| -> Option<Point3> {
                let vertex = follow(exchange, curve.arguments.get(k)?)?;
                let Value::Reference(point) = vertex.arguments.last()? else {
                    return None;
                };
                let read: Result<Point3, StepError> =
                    cartesian_point(exchange, *point, *point, unit);
                read.ok()
            };
            let ends = [end(1), end(2)];
            let straight = curve
                .arguments
                .get(3)
                .and_then(|form| follow(exchange, form))
                .is_some_and(|form| form.name == "LINE");
            if let ([Some(a), Some(b)], true) = (ends, straight) {
                points.push(nalgebra::center(&a, &b));
            }
            points.extend(ends.into_iter().flatten());
        }
    }
    points
}
