//! Where a free rigid body lies on another rigid one.
//!
//! A ring that lies flat touches along a circle, and a query answers with few points of it. With those
//! rows alone it would tip over them, to be found elsewhere in the next tick: it would rock for ever. So
//! the points of the free body, the pair's holder, that touched are remembered in its principal axes, and
//! each is looked up again where the body now is, by descent from its last foot. A point of a body may
//! never be inside of another, so such a row is right wherever the body has rolled to meanwhile.

use super::bounce::is_between_rigid;
use super::feet::margin_m;
use super::warm::WarmRow;
use crate::party::{BodyScratch, Gives};
use crate::scene::Scene;
use crate::solve::rows::{Holder, Row};
use palpate_geometry::contact::{Contact, ToolPoint};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::ClosestPoint;

/// A foot this far aside from straight below its point, relative to the size of its body, is on a rim.
const ASIDE: f64 = 1e-6;

/// Nearer than this a contact is remembered, m.
pub(crate) fn near_m(scene: &Scene, row: &Row) -> f64 {
    let size = |body: u32| scene.bodies[body as usize].size_m;
    let own = size(row.body);
    let other = match row.holder {
        Holder::Body(other) => size(other),
        Holder::Tool(_) => own,
    };
    margin_m(0.0, own.min(other))
}

/// Where a row touches a free holder, from its centre of mass in its principal axes, m.
pub(crate) fn on_holder(scene: &Scene, bodies: &[BodyScratch], row: &Row) -> Option<Vector3> {
    let Holder::Body(other) = row.holder else {
        return None;
    };
    let gives = bodies[other as usize].gives()?;
    is_between_rigid(scene, row).then(|| gives.to_body(&(row.point + row.normal * row.now_m)))
}

/// The contact of a point of a rigid holder that touched in the last tick, where it now is; `side` is −1 below a sheet.
pub(crate) fn again(
    remembered: &WarmRow,
    holder: &Gives,
    on: &BodyScratch,
    size_m: f64,
    side: f64,
) -> Option<Contact> {
    let point = holder.to_world(&remembered.on_tool);
    let below = below(&point, on, remembered.uv, side, size_m)?;
    Some(Contact {
        u: below.foot.u,
        v: below.foot.v,
        on_body: below.foot.point,
        on_tool: point,
        normal: below.normal,
        depth_m: -below.gap_m,
        tool_uv: Some([0.0; 2]),
        point: ToolPoint::Found,
    })
}

/// The contact of a remembered point where a body or its holder deforms, where it now is. The point is one of the surface
/// that deforms. `sides`: −1 for each of the two that is touched from below a sheet.
pub(crate) fn on_soft(
    remembered: &WarmRow,
    holder_deforms: bool,
    [body, holder]: [&BodyScratch; 2],
    size_m: f64,
    sides: [f64; 2],
) -> Option<Contact> {
    let (uv, st) = (remembered.uv, [remembered.on_tool.x, remembered.on_tool.y]);
    let (on_body, on_tool, normal, gap_m, [u, v], st) = match holder_deforms {
        true => {
            let point = holder.skin.point(st[0], st[1]);
            let Below {
                foot,
                normal,
                gap_m,
            } = below(&point, body, uv, sides[0], size_m)?;
            (foot.point, point, normal, gap_m, [foot.u, foot.v], st)
        }
        false => {
            let point = body.skin.point(uv[0], uv[1]);
            let Below {
                foot,
                normal,
                gap_m,
            } = below(&point, holder, st, sides[1], size_m)?;
            (point, foot.point, -normal, gap_m, uv, [foot.u, foot.v])
        }
    };
    Some(Contact {
        u,
        v,
        on_body,
        on_tool,
        normal,
        depth_m: -gap_m,
        tool_uv: Some(st),
        point: ToolPoint::Found,
    })
}

/// What a point sees of a surface straight below it.
struct Below {
    foot: ClosestPoint,
    normal: Vector3,
    gap_m: f64,
}

/// `start`: where on the surface it was last; none beside a rim, far off, or where a number is none.
fn below(
    point: &Point3,
    on: &BodyScratch,
    [u, v]: [f64; 2],
    side: f64,
    size_m: f64,
) -> Option<Below> {
    let foot = on.solver.local(&on.skin, point, u, v)?;
    let normal = foot.normal * side;
    let away = point - foot.point;
    let gap_m = away.dot(&normal);
    let aside = (away - normal * gap_m).norm();
    let faces = aside < ASIDE * size_m && gap_m.abs() < size_m;
    faces.then_some(Below {
        foot,
        normal,
        gap_m,
    })
}
