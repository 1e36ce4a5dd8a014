//! A half-space against a surface: everything below a plane.
//!
//! Depth of a surface point is its distance past the plane; each local maximum of it over the
//! surface is a contact.

use super::{ExactScratch, TANGENT};
use crate::contact::{Contact, ContactSet, Reach, ToolPoint};
use crate::math::{Point3, Vector3};
use crate::surface::{ClosestSolver, Surface};

/// Contacts of the half-space below the plane through `point` with outward unit `normal`, deepest
/// first. Contact normals are `−normal`: out of the body, towards the tool's matter. `out` is
/// cleared first; arguments that are not finite, or a normal without length, touch nothing. Both
/// sides of an open sheet are alike to a plane.
pub fn contacts(
    surface: &Surface,
    solver: &mut ClosestSolver,
    point: &Point3,
    normal: &Vector3,
    reach: &Reach,
    scratch: &mut ExactScratch,
    out: &mut ContactSet,
) {
    out.clear();
    let margin_m = reach.margin_m;
    let Some(normal) = normal
        .try_normalize(0.0)
        .filter(|n| n.iter().all(|x| x.is_finite()))
    else {
        return;
    };
    // Towards the tool's matter: down.
    let down = -normal;
    let level_m = down.dot(&point.coords);
    let tolerance = TANGENT * scratch.size_m + 8.0 * f64::EPSILON * point.coords.amax();
    if !(level_m.is_finite() && margin_m.is_finite()) {
        return;
    }
    if !solver.summits_along(
        surface,
        &down,
        level_m - margin_m - tolerance,
        &mut scratch.summits,
    ) {
        out.note_dropped();
    }
    scratch.patches.report(solver.pieces_reached(), out);
    for summit in &scratch.summits {
        // From the difference: both heights may be large.
        let depth_m = down.dot(&(summit.point - point));
        out.push(Contact {
            u: summit.u,
            v: summit.v,
            on_body: summit.point,
            on_tool: summit.point - down * depth_m,
            normal: down,
            depth_m,
            tool_uv: None,
            point: ToolPoint::Found,
        });
    }
}

/// Gap of a surface point to the half-space, and the unit vector towards its matter.
pub fn signed_gap(point_of_plane: &Point3, normal: &Vector3, point: &Point3) -> (f64, Vector3) {
    ((point - point_of_plane).dot(normal), -normal)
}
