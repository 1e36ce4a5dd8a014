//! A ball, or a point, against a part.
//!
//! From outside, every local minimum of the distance of its centre that is nearer than the radius is a contact. From inside a
//! closed part only the closest point counts: there the way out is shortest. A sheet has no inside; a centre that came
//! through is held by the closest point, as long as that is not on a rim that the centre is beside.

use super::{PartScratch, PartSide, TANGENT};
use crate::contact::{Contact, ContactSet, Reach, ToolPoint};
use crate::math::{Point3, Pose};
use crate::part::PartFoot;

/// Where the way to the centre turns from the part's normal by more than this, the foot is on an edge or a vertex.
const TURNED: f64 = 1e-6;

/// Contacts of a ball of `radius_m` (0 for a point) around `centre` (in the world), deepest first. `out` is cleared first; a
/// query that is not finite touches nothing.
pub fn contacts(
    side: PartSide<'_>,
    centre: &Point3,
    radius_m: f64,
    reach: &Reach,
    scratch: &mut PartScratch,
    out: &mut ContactSet,
) {
    out.clear();
    let PartSide { part, pose, solver } = side;
    let far = radius_m + reach.margin_m;
    let q = pose.inverse_transform_point(centre);
    if !(far.is_finite() && far >= 0.0 && q.iter().all(|x| x.is_finite())) {
        return;
    }
    let rounding = 8.0 * f64::EPSILON * (centre.coords.amax() + q.coords.amax());
    let tolerance = TANGENT * (scratch.size_m + far) + rounding;
    let minima = &mut scratch.minima;
    let closest = minima.within(part, solver, &q, far + tolerance);
    if !minima.is_complete() {
        out.note_dropped();
    }
    let Some(closest) = closest else {
        return;
    };
    let ball = Ball {
        q,
        radius_m,
        pose,
        side: reach.side(),
        tolerance,
    };
    let closed = part.is_closed();
    let (low, high) = part.bounds();
    let may_be_inside = (0..3).all(|k| q[k] >= low[k] && q[k] <= high[k]);
    let beside_rim = |foot: &PartFoot| {
        !closed && scratch.minima.is_rim(part, foot.support) && !ball.is_straight(foot)
    };
    let near = closest.distance <= far + tolerance || may_be_inside;
    if near && ball.is_behind(&closest) && !beside_rim(&closest) {
        ball.push(&closest, -1.0, out);
    }
    for (foot, _) in scratch.minima.found() {
        if !ball.is_behind(foot) || beside_rim(foot) {
            ball.push(foot, 1.0, out);
        }
    }
}

struct Ball<'a> {
    /// The centre in the part's frame, m.
    q: Point3,
    radius_m: f64,
    pose: &'a Pose,
    side: f64,
    tolerance: f64,
}

impl Ball<'_> {
    fn signed_distance(&self, foot: &PartFoot) -> f64 {
        let along = || foot.normal.dot(&(self.q - foot.point));
        let signed = foot.signed_distance;
        self.side * signed.unwrap_or_else(|| foot.distance.copysign(along()))
    }

    fn is_behind(&self, foot: &PartFoot) -> bool {
        self.signed_distance(foot) < 0.0 && foot.distance > self.tolerance
    }

    /// The centre is straight above or below a foot, not beside a rim.
    fn is_straight(&self, foot: &PartFoot) -> bool {
        let along = (self.q - foot.point).dot(&foot.normal).abs();
        along >= (1.0 - TURNED) * foot.distance
    }

    /// `front`: 1 for a centre on the tool's side of the part, −1 for one that is behind it.
    fn push(&self, foot: &PartFoot, front: f64, out: &mut ContactSet) {
        let own = foot.normal * self.side;
        let way = (self.q - foot.point) * front;
        // On faces the normal is the better known; so it is nearer to an edge than the edge is to its faces, where the signed
        // distance is 0.
        let known =
            foot.distance > 1e-9 * foot.point.coords.amax() && self.signed_distance(foot) != 0.0;
        let normal = match way.try_normalize(0.0) {
            Some(n) if known && (n - own).norm() > TURNED => n,
            _ => own,
        };
        let (on_body, normal) = (self.pose * foot.point, self.pose * normal);
        let depth_m = self.radius_m - front * foot.distance;
        let [u, v] = foot.place;
        out.push(Contact {
            u,
            v,
            on_body,
            on_tool: on_body - normal * depth_m,
            normal,
            depth_m,
            tool_uv: None,
            point: ToolPoint::Found,
        });
    }
}
