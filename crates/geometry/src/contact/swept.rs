//! When a moving tool first touches a surface that stands still, so that no speed takes it through
//! a thin body.
//!
//! Conservative advancement (Mirtich 1996): no point of the tool moves faster than a known bound,
//! so a clearance of d leaves it free for d / bound, before as well as after. So steps may be
//! longer than d, up to twice as long, as long as what is free before the new place reaches back to
//! what was free after the old one (Keinert et al., *Enhanced sphere tracing*, 2014). With s the
//! clearance lost per metre of path, a step leaves (1 − s)/(1 + s) of it; what grazes so flatly
//! that it has not arrived after [`STEPS`] of them is reported where it is, with its gap.

use super::{Contact, ToolPoint};
use crate::math::{Point3, Vector3};
use crate::surface::{ClosestSolver, Surface, WarmFoot};

/// Steps of one sweep.
pub const STEPS: usize = 256;
/// Touching means closer than this share of the surface's size.
const TOUCH: f64 = 1e-9;

/// A first touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstTouch {
    /// Share of the motion that is free, in [0, 1].
    pub fraction: f64,
    /// Clearance left there, m: at most 1e-9 of the size, unless the steps ran out along a graze.
    pub gap_m: f64,
}

/// First touch of anything: `clearance_m(t)` is a lower bound of its distance to the surface after
/// a share t of the motion, and no point of it moves farther than `path_m` during the whole of it.
/// `None`: free all the way, or a bound that is not a number. At most [`STEPS`] calls.
pub fn first_touch(
    path_m: f64,
    touch_m: f64,
    mut clearance_m: impl FnMut(f64) -> f64,
) -> Option<FirstTouch> {
    let (mut fraction, mut gap_m) = (0.0_f64, f64::INFINITY);
    // What is known to be free: up to here.
    let mut free = 0.0_f64;
    let mut ahead = 1.0;
    for _ in 0..STEPS {
        let at = (free + (ahead - 1.0) * (free - fraction)).min(1.0);
        let gap = clearance_m(at);
        if gap.is_nan() || path_m.is_nan() {
            return None;
        }
        let half = gap / path_m;
        if at > free && at - half > free {
            // Something may be between: back to what is sure.
            ahead = 1.0;
            continue;
        }
        if gap <= touch_m {
            return Some(FirstTouch {
                fraction: at,
                gap_m: gap,
            });
        }
        if at >= 1.0 || gap > path_m * (1.0 - at) {
            return None;
        }
        let lost = if at > fraction && gap_m.is_finite() {
            (gap_m - gap) / (path_m * (at - fraction))
        } else {
            1.0
        };
        // As far as both sides still meet if the clearance goes on as it did; a little less, for
        // its curvature.
        ahead = (1.98 / (1.0 + lost.clamp(0.0, 1.0))).max(1.0);
        (fraction, gap_m, free) = (at, gap, at + half);
    }
    Some(FirstTouch { fraction, gap_m })
}

/// First touch of a ball (radius 0: a point) that moves along a straight line, with the contact
/// there: depth is minus the gap left, the normal points to the centre. From either side of the
/// surface; one that starts in touch touches at 0.
pub fn ball(
    surface: &Surface,
    solver: &mut ClosestSolver,
    start: &Point3,
    end: &Point3,
    radius_m: f64,
) -> Option<(FirstTouch, Contact)> {
    let way = end - start;
    let path_m = way.norm();
    if !(path_m.is_finite()
        && start.iter().all(|x| x.is_finite())
        && radius_m.is_finite()
        && radius_m >= 0.0)
    {
        return None;
    }
    let touch_m = touch_m(surface, start, end);
    let mut warm = WarmFoot::default();
    let mut last = *start;
    let mut foot = None;
    let touch = first_touch(path_m, touch_m, |t| {
        let centre = start + way * t;
        let found =
            solver.closest_warm_moved(surface, &centre, (centre - last).norm(), 0.0, &mut warm);
        last = centre;
        foot = Some(found);
        found.distance - radius_m
    })?;
    let foot = foot?;
    let centre = start + way * touch.fraction;
    let side = if foot.signed_distance < 0.0 {
        -1.0
    } else {
        1.0
    };
    let normal = match (centre - foot.point).try_normalize(touch_m) {
        Some(n) => n,
        None => foot.normal * side,
    };
    let depth_m = -touch.gap_m;
    let on_tool = foot.point - normal * depth_m;
    Some((
        touch,
        Contact {
            u: foot.u,
            v: foot.v,
            on_body: foot.point,
            on_tool,
            normal,
            depth_m,
            tool_uv: None,
            point: ToolPoint::Found,
        },
    ))
}

/// First touch of the half-space below a plane that moves from one place to another: through
/// `points`, with outward unit `normals`, both going evenly (the normal over the shorter arc).
pub fn plane(
    surface: &Surface,
    solver: &mut ClosestSolver,
    points: [Point3; 2],
    normals: [Vector3; 2],
) -> Option<(FirstTouch, Contact)> {
    let [a, b] = normals.map(|n| {
        n.try_normalize(0.0)
            .filter(|n| n.iter().all(|x| x.is_finite()))
    });
    let (a, b) = (a?, b?);
    let way = points[1] - points[0];
    if !points.iter().flat_map(|p| p.iter()).all(|x| x.is_finite()) {
        return None;
    }
    let angle = libm::atan2(a.cross(&b).norm(), a.dot(&b));
    // A half turn has no shorter arc: any axis across the normal.
    let across = (b - a * a.dot(&b)).try_normalize(1e-12).unwrap_or_else(|| {
        let other = if a.x.abs() < 0.6 {
            Vector3::x()
        } else {
            Vector3::y()
        };
        a.cross(&other).normalize()
    });
    let at = |t: f64| {
        (
            points[0] + way * t,
            a * libm::cos(angle * t) + across * libm::sin(angle * t),
        )
    };
    // The farthest that a point of the body gets from the plane's own points; its turn moves
    // nothing nearer faster.
    let radius = surface
        .net()
        .points()
        .iter()
        .map(|p| (p - points[0]).norm().max((p - points[1]).norm()));
    let path_m = way.norm() + angle * radius.fold(0.0, f64::max);
    let touch_m = touch_m(surface, &points[0], &points[1]);
    let mut lowest = None;
    let touch = first_touch(path_m, touch_m, |t| {
        let (point, normal) = at(t);
        let (u, v, on_body) = solver.deepest_along(surface, &-normal);
        lowest = Some((u, v, on_body));
        (on_body - point).dot(&normal)
    })?;
    let (u, v, on_body) = lowest?;
    let (_, n) = at(touch.fraction);
    let depth_m = -touch.gap_m;
    let normal = -n.normalize();
    let on_tool = on_body - normal * depth_m;
    Some((
        touch,
        Contact {
            u,
            v,
            on_body,
            on_tool,
            normal,
            depth_m,
            tool_uv: None,
            point: ToolPoint::Found,
        },
    ))
}

/// Closer than this is touching, m: above the rounding of far coordinates.
fn touch_m(surface: &Surface, start: &Point3, end: &Point3) -> f64 {
    TOUCH * surface.size() + 16.0 * f64::EPSILON * (start.coords.amax() + end.coords.amax())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::testing::Random;
    use crate::surface::builtin;

    fn vector(random: &mut Random) -> Vector3 {
        Vector3::new(
            random.float(-1.0, 1.0),
            random.float(-1.0, 1.0),
            random.float(-1.0, 1.0),
        )
    }

    // A sheet has no thickness at all: what moves a metre in one tick must still stop at it.
    #[test]
    fn a_tool_that_jumps_through_a_thin_body_in_one_tick_is_stopped() {
        let sheet = builtin("sheet", None, None).unwrap();
        let mut solver = ClosestSolver::new(&sheet);
        for radius in [0.0, 1e-6, 5e-3] {
            for side in [1.0, -1.0] {
                let (start, end) = (
                    Point3::new(0.01, -0.02, 0.5 * side),
                    Point3::new(0.012, -0.02, -0.5 * side),
                );
                let (touch, contact) =
                    ball(&sheet, &mut solver, &start, &end, radius).expect("it cannot pass");
                let centre = start + (end - start) * touch.fraction;
                assert!(
                    (centre.z * side - radius).abs() <= 2e-9 * sheet.size(),
                    "{touch:?}"
                );
                assert!((contact.normal.z * side - 1.0).abs() < 1e-6, "{contact:?}");
            }
        }
        // Beside the sheet it is free.
        assert!(
            ball(
                &sheet,
                &mut solver,
                &Point3::new(0.06, 0.0, 0.5),
                &Point3::new(0.06, 0.0, -0.5),
                5e-3
            )
            .is_none()
        );
        let (p, n) = (
            [Point3::new(0.0, 0.0, 0.5), Point3::new(0.0, 0.0, -0.5)],
            [-Vector3::z(); 2],
        );
        let (touch, _) = plane(&sheet, &mut solver, p, n).expect("a plane cannot pass either");
        assert!((touch.fraction - 0.5).abs() < 1e-8, "{touch:?}");
    }

    #[test]
    fn nothing_touches_before_the_first_touch_and_something_does_there() {
        let mut random = Random(11);
        let body = builtin("teardrop", None, None).unwrap();
        let size = body.size();
        let mut solver = ClosestSolver::new(&body);
        let mut touched = 0;
        for _ in 0..if cfg!(debug_assertions) { 40 } else { 1_000 } {
            let middle = body.point(random.float(0.0, 1.0), random.float(0.0, 1.0));
            let way = vector(&mut random) * size;
            let (start, end) = (
                middle - way,
                middle + way + vector(&mut random) * 0.1 * size,
            );
            let radius = random.float(0.0, 0.1) * size;
            let swept = ball(&body, &mut solver, &start, &end, radius);
            let until = swept.map_or(1.0, |(t, _)| t.fraction);
            touched += usize::from(swept.is_some());
            for k in 0..=50 {
                let centre = start + (end - start) * (until * k as f64 / 50.0);
                let gap = solver.closest(&body, &centre).distance - radius;
                assert!(
                    gap >= -1e-12 * size || swept.is_some_and(|(t, _)| t.fraction == 0.0),
                    "{gap} at {k}"
                );
            }
            if let Some((t, c)) = swept {
                let gap = solver
                    .closest(&body, &(start + (end - start) * t.fraction))
                    .distance
                    - radius;
                // Clearance lost per metre of path: below a twentieth, 256 steps may not be enough.
                let lost = (end - start).normalize().dot(&c.normal).abs();
                let most = if lost > 0.05 { 2e-9 } else { 1e-4 };
                assert!(gap <= most * size, "{gap} {t:?} {c:?}");
            }
        }
        assert!(touched > 10, "{touched}");
    }

    // A plane that turns about a far axis sweeps the body: the first touch is where the lowest
    // clearance vanishes.
    #[test]
    fn a_turning_plane_stops_at_the_body() {
        let body = builtin("teardrop", None, None).unwrap();
        let mut solver = ClosestSolver::new(&body);
        let hinge = Point3::new(-0.2, 0.0, 0.05);
        // Its solid is below: from under the body, the other way round.
        let start = Vector3::z();
        let lowest = ClosestSolver::new(&body).deepest_along(&body, &-start).2;
        let hinge = Point3::new(hinge.x, hinge.y, lowest.z - 0.01);
        let end = Vector3::new(-1.0, 0.0, 0.2).normalize();
        let (touch, contact) =
            plane(&body, &mut solver, [hinge; 2], [start, end]).expect("the turn sweeps the body");
        assert!(touch.fraction > 0.0 && touch.fraction < 1.0, "{touch:?}");
        assert!(touch.gap_m.abs() <= 1e-8 * body.size(), "{touch:?}");
        assert!((body.point(contact.u, contact.v) - contact.on_body).norm() < 1e-12);
    }

    #[test]
    fn what_is_not_finite_touches_nothing() {
        let body = builtin("teardrop", None, None).unwrap();
        let mut solver = ClosestSolver::new(&body);
        let o = Point3::origin();
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(ball(&body, &mut solver, &Point3::new(bad, 0.0, 0.0), &o, 0.1).is_none());
            assert!(ball(&body, &mut solver, &o, &o, bad).is_none());
            assert!(
                plane(
                    &body,
                    &mut solver,
                    [o, Point3::new(bad, 0.0, 0.0)],
                    [Vector3::z(); 2]
                )
                .is_none()
            );
            assert!(
                plane(
                    &body,
                    &mut solver,
                    [o; 2],
                    [Vector3::z(), Vector3::new(bad, 0.0, 0.0)]
                )
                .is_none()
            );
        }
        assert!(first_touch(1.0, 0.0, |_| f64::NAN).is_none());
    }
}
