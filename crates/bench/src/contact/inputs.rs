//! Bodies, tools and poses of the contact suite, the same in every run.

use crate::inputs::Random;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::contact::implicit::{ImplicitShape, ImplicitTool};
use palpate_geometry::math::{Point3, Pose, Rotation, Vector3};
use palpate_geometry::surface::{ClosestSolver, ControlNet, Direction, Surface, builtin};
use palpate_thesis::spheres::Solid;

/// Radius of the tool that is a surface, m.
pub(super) const TOOL_RADIUS_M: f64 = 0.02;
/// Side of the flat patch, m.
const SIDE_M: f64 = 0.1;

/// The teardrop in the nets it comes in, else a torus of about its size.
pub(super) fn body(count: usize) -> Surface {
    match count {
        8 | 12 | 20 => builtin("teardrop", Some([count; 2]), None),
        _ => builtin("torus", Some([count; 2]), None),
    }
    .expect("a builtin")
}

/// A ball with a net of at least that many control points: rational and biquadratic, so exact.
pub(super) fn tool(count: usize) -> Surface {
    builtin(
        "sphere",
        Some([count.max(8), count.max(5)]),
        Some(TOOL_RADIUS_M),
    )
    .expect("a builtin")
}

/// A square of 8 × 8 control points in z = 0.
pub(super) fn flat() -> Surface {
    builtin("sheet", Some([8, 8]), Some(SIDE_M)).expect("a builtin")
}

/// Centres of balls that are between 1 mm off the surface and 3 mm inside it; of points as deep.
pub(super) fn near(surface: &Surface, count: usize, radius_m: f64) -> Vec<Point3> {
    let mut random = Random(count as u64 + 1);
    (0..count)
        .map(|_| {
            let (u, v) = (random.unit(), 0.02 + 0.96 * random.unit());
            surface.point(u, v) + surface.normal(u, v) * (radius_m + 1e-3 - 4e-3 * random.unit())
        })
        .collect()
}

/// Half-spaces of all directions, up to 5 mm past the body's outermost point: (origin, unit
/// normal).
pub(super) fn planes(
    surface: &Surface,
    solver: &mut ClosestSolver,
    count: usize,
) -> Vec<(Point3, Vector3)> {
    let mut random = Random(count as u64 + 2);
    (0..count)
        .map(|_| {
            let normal = direction(&mut random);
            (
                solver.deepest_along(surface, &-normal).2 + normal * (5e-3 * random.unit()),
                normal,
            )
        })
        .collect()
}

fn direction(random: &mut Random) -> Vector3 {
    let z = 2.0 * random.unit() - 1.0;
    let (angle, rho) = (
        std::f64::consts::TAU * random.unit(),
        (1.0 - z * z).max(0.0).sqrt(),
    );
    Vector3::new(rho * libm::cos(angle), rho * libm::sin(angle), z)
}

/// Poses of the ball-shaped tool, turned anyhow, at most so deep.
pub(super) fn poses(surface: &Surface, count: usize, depth_m: f64) -> Vec<Pose> {
    let mut random = Random(count as u64 + 3);
    let centres: Vec<Point3> = (0..count)
        .map(|_| {
            let (u, v) = (random.unit(), 0.02 + 0.96 * random.unit());
            surface.point(u, v) + surface.normal(u, v) * (TOOL_RADIUS_M - depth_m * random.unit())
        })
        .collect();
    let turned = |centre: &Point3, random: &mut Random| {
        let turn = Rotation::from_scaled_axis(direction(random) * (3.0 * random.unit()));
        Pose::from_parts(centre.coords.into(), turn)
    };
    centres
        .iter()
        .map(|centre| turned(centre, &mut random))
        .collect()
}

/// Poses of the ball-shaped tool, once a millisecond: its outermost point wanders 3 mm lower than these, and it turns.
pub(super) fn slide(surface: &Surface, places: &[Point3]) -> Vec<Pose> {
    let mut solver = ClosestSolver::new(surface);
    let pose = |(tick, place): (usize, &Point3)| {
        let out = solver.closest(surface, place).normal;
        let centre = place + out * (TOOL_RADIUS_M - 3e-3);
        let turn = Rotation::from_scaled_axis(Vector3::new(1.0, 2.0, 3.0) * (1e-3 * tick as f64));
        Pose::from_parts(centre.coords.into(), turn)
    };
    places.iter().enumerate().map(pose).collect()
}

/// The pose at which a second patch covers that share of the first.
pub(super) fn covering(percent: u32) -> Pose {
    let share = (f64::from(percent) / 100.0).sqrt();
    Pose::translation(SIDE_M * (1.0 - share), SIDE_M * (1.0 - share), 0.0)
}

/// A ball whose section with z = 0 covers that share of the patch: (centre, radius). 2 mm deep; all
/// of the patch is inside where the section reaches its corners.
pub(super) fn ball_over(percent: u32) -> (Point3, f64) {
    let share = f64::from(percent) / 100.0;
    let section = if percent == 100 {
        SIDE_M * 0.75
    } else {
        SIDE_M * (share / std::f64::consts::PI).sqrt()
    };
    // A cap of height h over a circle of radius s: r = (s² + h²) / 2h.
    let depth = 2e-3;
    let radius = (section * section + depth * depth) / (2.0 * depth);
    (Point3::new(0.0, 0.0, radius - depth), radius)
}

/// A half-space that holds the part x > x₀ of the patch, 1 mm deep at x = side / 2: (origin, unit
/// normal).
pub(super) fn plane_over(percent: u32) -> (Point3, Vector3) {
    let width = SIDE_M * f64::from(percent) / 100.0;
    let angle = libm::asin((1e-3 / width).min(1.0));
    (
        Point3::new(0.5 * SIDE_M - width, 0.0, 0.0),
        Vector3::new(-libm::sin(angle), 0.0, libm::cos(angle)),
    )
}

/// A torus without net, at some place and turn.
pub(super) struct SolidTorus {
    /// The same for the certified solver.
    pub tool: ImplicitTool,
    pub pose: Pose,
    great_m: f64,
    small_m: f64,
}

/// A torus lying on the body somewhere, up to 3 mm deep.
pub(super) fn solid_torus(surface: &Surface, random: &mut Random) -> SolidTorus {
    let (u, v) = (random.unit(), 0.05 + 0.9 * random.unit());
    let (great_m, small_m) = (0.015, 0.005);
    let turn = Rotation::from_scaled_axis(direction(random) * (3.0 * random.unit()));
    // The outermost point of its ring in the direction of the body.
    let inward = turn.inverse() * -surface.normal(u, v);
    let ring = Vector3::new(inward.x, inward.y, 0.0)
        .try_normalize(0.0)
        .unwrap_or_else(Vector3::x)
        * great_m;
    let deepest = turn * (ring + inward * (small_m - 3e-3 * random.unit()));
    let shape = ImplicitShape::Torus {
        major_radius_m: great_m,
        minor_radius_m: small_m,
    };
    let tool = shape.compile().expect("a torus");
    SolidTorus {
        tool,
        pose: Pose::from_parts((surface.point(u, v).coords - deepest).into(), turn),
        great_m,
        small_m,
    }
}

impl Solid for SolidTorus {
    fn signed_gap(&self, point: &Point3) -> (f64, Vector3) {
        let p = self.pose.inverse_transform_point(point);
        let rho = (p.x * p.x + p.y * p.y).sqrt();
        let ring = if rho > 0.0 {
            Vector3::new(p.x / rho, p.y / rho, 0.0)
        } else {
            Vector3::x()
        };
        let away = p.coords - ring * self.great_m;
        let distance = away.norm();
        let normal = away.try_normalize(0.0).unwrap_or_else(Vector3::z);
        (distance - self.small_m, self.pose.rotation * normal)
    }

    fn bounded_gap(&self, point: &Point3) -> Option<f64> {
        Some(self.signed_gap(point).0)
    }

    fn may_meet_box(&self, low: &Point3, high: &Point3, margin_m: f64) -> bool {
        let reach = self.great_m + self.small_m + margin_m;
        let centre = self.pose.translation.vector;
        (0..3).all(|c| low[c] <= centre[c] + reach && high[c] >= centre[c] - reach)
    }
}

/// A sausage folded to a hairpin, legs along y, whose bellies pass through each other at the mirror
/// plane x = 0; and how deep it is in itself, m.
pub(super) fn sausage(belly_m: f64) -> (Surface, f64) {
    const BELLY: [f64; 9] = [0.0, 0.0, 0.2, 0.7, 1.0, 0.7, 0.2, 0.0, 0.0];
    let (around, bend) = (12, 5);
    let mut centres = Vec::new();
    let leg = |k: usize, side: f64| {
        (
            Vector3::new(0.015 * side, 0.01 * k as f64, 0.0),
            Vector3::x() * side,
            BELLY[k],
        )
    };
    centres.extend((0..BELLY.len()).map(|k| leg(k, 1.0)));
    for k in 1..=bend {
        let angle = std::f64::consts::PI * k as f64 / (bend + 1) as f64;
        let out = Vector3::new(libm::cos(angle), libm::sin(angle), 0.0);
        centres.push((Vector3::new(0.0, 0.08, 0.0) + out * 0.015, out, 0.0));
    }
    centres.extend((0..BELLY.len()).rev().map(|k| leg(k, -1.0)));
    let columns = centres.len();
    let mut points = Vec::with_capacity(around * columns);
    for i in 0..around {
        let angle = std::f64::consts::TAU * i as f64 / around as f64;
        for (j, (centre, out, belly)) in centres.iter().enumerate() {
            let radius = if j == 0 || j + 1 == columns {
                0.0
            } else {
                0.01
            } + belly_m * belly;
            let way = out * libm::cos(angle) + Vector3::z() * libm::sin(angle);
            points.push(Point3::from(centre + way * radius));
        }
    }
    let u = KnotVector::periodic_uniform(3, around).expect("twelve around");
    let v = KnotVector::clamped_uniform(3, columns).expect("many along");
    let net = ControlNet::new(around, columns, points).expect("a full net");
    let surface = Surface::new(u, v, net, None)
        .expect("a sausage")
        .oriented_outward();
    // The legs mirror each other: one is in the other by twice its own passage of the mirror plane.
    let leg = surface.part(Direction::V, 0.05, 0.35).expect("a leg");
    let passage_m = super::oracle::Sampled::new(&leg).greatest(&leg, |p| -p.x);
    (surface, 2.0 * passage_m)
}
