//! A half-space against a part: everything below a plane.
//!
//! Depth of a place of the part is its distance past the plane; each that is deeper than its neighbours is a contact. What is
//! straight and lies on the plane, to 0.02 rad, has all its corners as contacts, and a round edge or ring eight fixed points
//! and its deepest one, so that a part rests on a plane as it is and does not tilt from one corner to the next.

use super::{PartScratch, PartSide, TANGENT};
use crate::contact::{Contact, ContactSet, Reach, ToolPoint};
use crate::math::{Point3, Vector3};
use crate::part::{Mark, Support};

/// Of the size: how much deeper than a fixed point a deepest one is that counts beside it.
const DEEPER: f64 = 1e-9;

/// Contacts of the half-space below the plane through `place` with outward unit `normal` (both in the world), deepest first.
/// Contact normals are `−normal`: out of the part, towards the tool's matter. `out` is cleared first; arguments that are not
/// finite, or a normal without length, touch nothing. Both sides of a sheet are alike to a plane.
pub fn contacts(
    side: PartSide<'_>,
    place: &Point3,
    normal: &Vector3,
    reach: &Reach,
    scratch: &mut PartScratch,
    out: &mut ContactSet,
) {
    out.clear();
    let PartSide { part, pose, solver } = side;
    let Some(normal) = normal
        .try_normalize(0.0)
        .filter(|n| n.iter().all(|x| x.is_finite()))
    else {
        return;
    };
    // Towards the tool's matter.
    let down = -normal;
    let own_down = pose.inverse_transform_vector(&down);
    let own_place = pose.inverse_transform_point(place);
    let level_m = own_down.dot(&own_place.coords);
    if !(level_m.is_finite() && reach.margin_m.is_finite()) {
        return;
    }
    let rounding = 8.0 * f64::EPSILON * (place.coords.amax() + own_place.coords.amax());
    let within_m = reach.margin_m + TANGENT * scratch.size_m + rounding;
    (scratch.minima).lowest(part, solver, &own_down, level_m, within_m);
    if !scratch.minima.is_complete() {
        out.note_dropped();
    }
    let found = scratch.minima.found();
    for (foot, mark) in found {
        // The floor of a hollow is lower than what is beside it, and has matter below.
        if part.is_closed() && foot.normal.dot(&own_down) < 0.0 {
            continue;
        }
        let fixed = (found.iter()).filter(|(f, m)| *m == Mark::Round && f.support == foot.support);
        let fixed_m = fixed.map(|(f, _)| f.distance).reduce(f64::min);
        let point = match (mark, foot.support, fixed_m) {
            (Mark::Round, ..) => ToolPoint::Round,
            (Mark::Least, Support::Vertex(_), _) => ToolPoint::Corner,
            (Mark::Least, _, None) => ToolPoint::Found,
            (Mark::Least, _, Some(fixed_m)) => {
                let by_m = fixed_m - foot.distance;
                if by_m <= DEEPER * scratch.size_m {
                    continue;
                }
                ToolPoint::Deepest { by_m }
            }
        };
        let on_body = pose * foot.point;
        // From the difference: both heights may be large.
        let depth_m = down.dot(&(on_body - place));
        let [u, v] = foot.place;
        out.push(Contact {
            u,
            v,
            on_body,
            on_tool: on_body - down * depth_m,
            normal: down,
            depth_m,
            tool_uv: None,
            point,
        });
    }
}
