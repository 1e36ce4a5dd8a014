//! How a tool stands over a surface around the place where it touches.

use crate::solve::indentation::{Profile, Resolution};
use palpate_geometry::contact::dispatch::Narrow;
use palpate_geometry::contact::{Contact, Edge, Facing, ToolShape};
use palpate_geometry::math::{Point3, Pose, Vector3};

/// A point, its normal, and how deep the tool is there, m: heights are looked at from below.
type Place<'a> = (&'a Point3, &'a Vector3, f64);

/// Of a tool at a pose over a place with a normal, where the body resolves so much; `None` of points, planes and beside
/// edges.
pub(super) fn of(
    shape: &ToolShape,
    narrow: &Narrow,
    pose: &Pose,
    place: Place<'_>,
    body: &Resolution,
) -> Option<Profile> {
    let found = match shape {
        // A half-space is a floor for most: what falls on it comes back as the net alone says.
        ToolShape::Point | ToolShape::Plane { .. } => None,
        ToolShape::Sphere { radius_m } => (*radius_m > 0.0).then(|| Profile::ball(*radius_m)),
        ToolShape::Surface(tool) => {
            let away = |c: &&Contact| (c.on_body - place.0).norm_squared();
            let contacts = narrow.set.contacts().iter();
            let nearest = contacts.min_by(|a, b| away(a).total_cmp(&away(b)))?;
            let [u, v] = nearest.tool_uv?;
            let bent = tool.surface().curvature(u, v)?;
            Some(Profile::round((bent.min * bent.max).max(0.0).sqrt()))
        }
        ToolShape::Implicit { .. } | ToolShape::Mesh(_) => over(place, body.patch_m, |x| {
            narrow.facing(shape, pose, x, f64::INFINITY)
        }),
    };
    let share = share_beside_edges(shape, &pose.inverse_transform_point(place.0), body.patch_m);
    found.map(|profile| profile.on(body.curvature_1_m).times(share))
}

/// How much of a profile counts at a place in the frame of the tool: near an edge, which side of it touches changes all.
fn share_beside_edges(shape: &ToolShape, at: &Point3, patch_m: f64) -> f64 {
    let edges = shape.features().map_or(&[][..], |features| &features.edges);
    let away_m = edges.iter().map(|edge| away_m(edge, at));
    let away_m = away_m.fold(f64::INFINITY, f64::min);
    ((away_m / patch_m - EDGES[0]) / (EDGES[1] - EDGES[0])).clamp(0.0, 1.0)
}

/// Distance of a point to an edge, m; to a curved one that of its nearest of many points.
fn away_m(edge: &Edge, p: &Point3) -> f64 {
    match edge {
        Edge::Segment { ends: [a, b], .. } => {
            let way = b - a;
            let t = ((p - a).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
            (a + way * t - p).norm()
        }
        Edge::Circle { z, radius_m } => libm::hypot(libm::hypot(p.x, p.y) - radius_m, p.z - z),
        Edge::Curve(_) => {
            let away = |k: usize| (edge.at(k as f64 / ALONG as f64).0 - p).norm();
            (0..=ALONG).map(away).fold(f64::INFINITY, f64::min)
        }
    }
}

/// Points along a curved edge.
const ALONG: usize = 64;

/// Where heights are taken, relative to the patch: on circles of these radii.
const RADII: [f64; 3] = [0.25, 0.5, 1.0];
/// Cosines and sines of the directions; heights of opposite ones are taken together, so that a tilt is none.
const DIRECTIONS: [(f64, f64); 4] = {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    [(1.0, 0.0), (half, half), (0.0, 1.0), (-half, half)]
};
/// Steepest ascent that counts: a wall is one.
const STEEPEST: f64 = 8.0;
/// Times by which heights may grow more from one circle to the next than to that: beside a tool is a wall that says
/// nothing of how it is rounded.
const STEEPER: f64 = 1.5;
/// Least cosine between the tool's normal and the surface's: beside it, what is above is a wall.
const UPRIGHT: f64 = 0.1;
/// Looks along a normal: distances of tools are of first order.
const LOOKS: usize = 3;
/// Half the length of a place, relative to the patch: what is longer has several.
const LONGEST: f64 = 2.0;
/// 4 √(c₁ c₂) / (√c₁ + √c₂)² of the slimmest ellipsoid that counts as one.
const SLIM: f64 = 0.64;
/// Distances of edges, relative to the patch, between which a profile comes to what it is without them: a tool that
/// slides has no step of its force where an edge comes near.
const EDGES: [f64; 2] = [1.0, 2.0];
/// Lower than this, relative to the patch, is flat.
const FLAT: f64 = 1e-6;

/// Heights over the tangent plane at a place, with a normal that leads to the tool, on a patch of this
/// radius; `None` where the tool is not there.
///
/// The axisymmetric profile has level lines that hold the same areas: at each radius, those of the ellipse
/// through the heights.
fn over(
    (place, normal, deep_m): Place<'_>,
    patch_m: f64,
    look: impl Fn(&Point3) -> Option<Facing>,
) -> Option<Profile> {
    // Beside a wall there is none.
    let height_m = |from: Point3| -> Option<f64> {
        let mut up_m = -deep_m;
        for _ in 0..LOOKS {
            let seen = look(&(from + normal * up_m))?;
            let cos = seen.normal.dot(normal);
            if cos < UPRIGHT {
                return None;
            }
            up_m += seen.gap_m / cos;
        }
        Some(up_m)
    };
    let lowest_m = height_m(*place)?;
    if lowest_m.is_nan() || lowest_m >= RADII[0] * patch_m {
        return None;
    }
    let (x, y) = across(normal);
    let mut points = [(0.0, 0.0); RADII.len()];
    let mut last_m = FLAT * patch_m;
    let mut growth = f64::INFINITY;
    for (point, share) in points.iter_mut().zip(RADII) {
        let r = share * patch_m;
        let most_m = lowest_m + STEEPEST * r;
        let mut heights = [0.0; DIRECTIONS.len()];
        for (height, (cos, sin)) in heights.iter_mut().zip(DIRECTIONS) {
            let way = (x * cos + y * sin) * r;
            let [there, back] = [place + way, place - way].map(height_m);
            let [there, back] = [there, back].map(|up_m| up_m.unwrap_or(most_m).min(most_m));
            *height = (0.5 * (there + back) - lowest_m).max(0.0);
        }
        let mean = 0.25 * heights.iter().sum::<f64>();
        let more = 0.5 * libm::hypot(heights[0] - heights[2], heights[1] - heights[3]);
        let narrow = (share / LONGEST).powi(4);
        let high = mean + more;
        let low = (mean - more).max(high * narrow);
        // Of ellipsoids it has Hertz' forces within 0.5 % up to radii of 16 : 1.
        let area = (high * low).sqrt();
        let long = 4.0 * area / (high.sqrt() + low.sqrt()).powi(2).max(f64::MIN_POSITIVE);
        let long = long.max(SLIM);
        let level_m = (area * libm::cbrt(long * long)).clamp(last_m, STEEPER * growth * last_m);
        *point = (r, level_m);
        growth = if share > RADII[0] {
            level_m / last_m
        } else {
            growth
        };
        last_m = level_m;
    }
    Some(Profile::through(&points))
}

/// Two directions across a normal, which turn with it but where it is −z.
pub(super) fn across(n: &Vector3) -> (Vector3, Vector3) {
    let s = if n.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (s + n.z);
    let b = n.x * n.y * a;
    (
        Vector3::new(1.0 + s * n.x * n.x * a, s * b, -s * n.x),
        Vector3::new(b, s + n.y * n.y * a, -n.y),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::contact::exact::ball::signed_gap;

    const PATCH_M: f64 = 3e-3;

    fn near(found: f64, expected: f64, share: f64, what: &str) {
        assert!(
            (found / expected - 1.0).abs() < share,
            "{what}: {found}, not {expected}"
        );
    }

    // Up to terms of r⁶, which are (r / R)⁴ of the first.
    #[test]
    fn a_ball_has_its_own_wherever_it_is_seen_from() {
        for (aside, deep_m) in [(0.0, 0.0), (3e-4, 0.0), (0.0, 2e-3), (5e-4, 1e-3)] {
            let centre = Point3::new(aside, 0.0, 0.01 - deep_m);
            let look = |x: &Point3| {
                let (gap_m, normal) = signed_gap(&centre, 0.01, x);
                Some(Facing {
                    gap_m,
                    normal,
                    uv: [0.0; 2],
                })
            };
            let found = over((&Point3::origin(), &Vector3::z(), deep_m), PATCH_M, look).unwrap();
            near(found.bend_1_m, 50.0, 0.02, "half the curvature");
            assert!(found.slope < 1e-3, "{found:?}");
        }
    }

    #[test]
    fn a_cone_has_its_slope_and_a_slim_paraboloid_the_force_of_hertz() {
        // Planes and paraboloids over z = 0, exact in their normals.
        let seen = |height_m: f64, slope: Vector3| {
            let normal = (Vector3::z() - slope).normalize();
            Some(Facing {
                gap_m: height_m * normal.z,
                normal,
                uv: [0.0; 2],
            })
        };
        let at = (&Point3::origin(), &Vector3::z(), 0.0);
        let cone = |x: &Point3| {
            let r = libm::hypot(x.x, x.y);
            let out = Vector3::new(x.x, x.y, 0.0) / r.max(1e-12);
            seen(0.5 * r - x.z, out * 0.5)
        };
        near(over(at, PATCH_M, cone).unwrap().slope, 0.5, 1e-6, "slope");
        let slim = |x: &Point3| {
            let [a, b] = [12.5, 200.0];
            seen(
                a * x.x * x.x + b * x.y * x.y - x.z,
                Vector3::new(2.0 * a * x.x, 2.0 * b * x.y, 0.0),
            )
        };
        // Radii of 40 and 2.5 mm: 1.158 times the force of a ball of 10 mm.
        near(
            over(at, PATCH_M, slim).unwrap().bend_1_m,
            50.0 / (1.158 * 1.158),
            0.01,
            "slim",
        );
    }

    #[test]
    fn what_is_not_there_has_none() {
        let away = |_: &Point3| {
            Some(Facing {
                gap_m: 1.0,
                normal: Vector3::z(),
                uv: [0.0; 2],
            })
        };
        let at = (&Point3::origin(), &Vector3::z(), 0.0);
        assert_eq!(over(at, PATCH_M, away), None);
        assert_eq!(over(at, PATCH_M, |_: &Point3| None), None);
    }
}
