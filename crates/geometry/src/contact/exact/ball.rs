//! A ball, or a point, against a surface.
//!
//! From outside, every local minimum of the distance of its centre that is nearer than the radius
//! is a contact: each region of the surface inside the ball holds at least one, its deepest. From
//! inside a closed body only the global foot counts: there the way out is shortest. An open sheet
//! has no inside; a centre that came through is held by the global foot, as long as that is no
//! point of the rim.

use super::{ExactScratch, TANGENT};
use crate::contact::{Contact, ContactSet, Reach, ToolPoint};
use crate::math::{Point3, Vector3};
use crate::surface::{ClosestPoint, ClosestSolver, Surface};

/// Where the way to the centre turns from the surface's normal by more than this, the foot is on a
/// crease, a rim or a tip.
const TURNED: f64 = 1e-6;

/// Contacts of a ball of `radius_m` (0 for a point) around `centre`, deepest first. `out` is
/// cleared first; a query that is not finite touches nothing.
///
/// # Examples
/// ```
/// use palpate_geometry::contact::exact::{ExactScratch, ball};
/// use palpate_geometry::contact::{ContactSet, Reach};
/// use palpate_geometry::math::Point3;
/// use palpate_geometry::surface::{ClosestSolver, builtin};
/// let body = builtin("sphere", None, Some(0.02))?; // radius 20 mm
/// let mut solver = ClosestSolver::new(&body);
/// let mut scratch = ExactScratch::new(&body, &mut solver);
/// let mut found = ContactSet::new();
/// // A ball of radius 10 mm, 2 mm deep.
/// let centre = Point3::new(0.0, 0.0, 0.028);
/// ball::contacts(&body, &mut solver, &centre, 0.01, &Reach::TOUCH, &mut scratch, &mut found);
/// assert!((found.deepest().unwrap().depth_m - 0.002).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn contacts(
    surface: &Surface,
    solver: &mut ClosestSolver,
    centre: &Point3,
    radius_m: f64,
    reach: &Reach,
    scratch: &mut ExactScratch,
    out: &mut ContactSet,
) {
    out.clear();
    let far = radius_m + reach.margin_m;
    if !(far.is_finite() && far >= 0.0 && centre.iter().all(|x| x.is_finite())) {
        return;
    }
    let tolerance = TANGENT * (scratch.size_m + far) + 8.0 * f64::EPSILON * centre.coords.amax();
    if !solver.minima_within(surface, centre, far + tolerance, &mut scratch.feet) {
        out.note_dropped();
    }
    scratch.patches.report(solver.pieces_reached(), out);
    let side = reach.side();
    let closed = scratch.closed;
    // The nearest of all minima is the global one, so its side says where the centre is.
    let global = match scratch.feet.first() {
        Some(foot) => Some(*foot),
        None if within_bounds(surface, centre) => Some(solver.closest(surface, centre)),
        None => None,
    };
    let behind =
        global.filter(|foot| side * foot.signed_distance < 0.0 && foot.distance > tolerance);
    if let Some(foot) = behind
        && (closed || faces(&foot, centre))
    {
        push(&foot, centre, radius_m, -1.0, side, out);
    }
    for foot in &scratch.feet {
        let front = side * foot.signed_distance >= 0.0 || foot.distance <= tolerance;
        if (front || !closed && !faces(foot, centre)) && foot.distance <= far + tolerance {
            push(foot, centre, radius_m, 1.0, side, out);
        }
    }
}

/// The centre is straight above or below a foot, not beside a rim.
fn faces(foot: &ClosestPoint, centre: &Point3) -> bool {
    let along = (centre - foot.point).dot(&foot.normal).abs();
    along >= (1.0 - TURNED) * foot.distance
}

/// `front`: 1 for a centre on the tool's side of the surface, −1 for one that is behind it.
fn push(
    foot: &ClosestPoint,
    centre: &Point3,
    radius_m: f64,
    front: f64,
    side: f64,
    out: &mut ContactSet,
) {
    let own = foot.normal * side;
    let way = (centre - foot.point) * front;
    // Where the surface is smooth its normal is the better known; elsewhere the way to the centre
    // is the contact's.
    let normal = match way.try_normalize(0.0) {
        Some(n) if (n - own).norm() > TURNED && foot.distance > 1e-9 * foot.point.coords.amax() => {
            n
        }
        _ => own,
    };
    let depth_m = radius_m - front * foot.distance;
    let on_tool = foot.point - normal * depth_m;
    out.push(Contact {
        u: foot.u,
        v: foot.v,
        on_body: foot.point,
        on_tool,
        normal,
        depth_m,
        tool_uv: None,
        point: ToolPoint::Found,
    });
}

/// Inside the box of the net, hence possibly inside the body.
fn within_bounds(surface: &Surface, p: &Point3) -> bool {
    let mut low = Point3::from(Vector3::repeat(f64::INFINITY));
    let mut high = -low;
    for x in surface.net().points() {
        (low, high) = (low.inf(x), high.sup(x));
    }
    (0..3).all(|c| p[c] >= low[c] && p[c] <= high[c])
}

/// Gap of a surface point to the ball and the unit vector out of the body there, towards the ball's
/// matter.
pub fn signed_gap(centre: &Point3, radius_m: f64, point: &Point3) -> (f64, Vector3) {
    let way = centre - point;
    let distance = way.norm();
    (
        distance - radius_m,
        if distance > 0.0 {
            way / distance
        } else {
            Vector3::z()
        },
    )
}
