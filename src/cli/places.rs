//! Where things of a scene stand when it starts: tools in bodies, bodies in each other.

use palpate_geometry::math::Point3;
use palpate_geometry::surface::ClosestSolver;
use palpate_modeling::isolate::{IsolateSpec, isolate};
use palpate_sim::scene::Scene;

/// How far from a body a tool is told to start, relative to the size of the body.
const CLEARANCE: f64 = 0.02;

/// Soft bodies may stand in each other by this share of the smaller one.
const MOST_OVERLAP: f64 = 0.05;

/// Tools that begin in the solid of a body: a device that takes one feels that at once.
pub fn starting_inside(scene: &Scene) -> Vec<String> {
    let mut inside = Vec::new();
    for (t, tool) in scene.spec.tools.iter().enumerate() {
        let at = Point3::from(tool.pose.position);
        if scene.spec.gravity.frame.as_ref() == Some(&tool.id) || scene.shape_name(t) == "plane" {
            continue;
        }
        for b in 0..scene.body_count() {
            let surface = scene.rest_surface(b);
            if !surface.topology().is_closed() {
                continue;
            }
            let foot = ClosestSolver::new(surface).closest(surface, &at);
            let depth_m = scene.tool_shape(t).ball_radius_m().unwrap_or(0.0) - foot.signed_distance;
            if depth_m > 0.0 {
                let [x, y, z] = (at + foot.normal * (depth_m + CLEARANCE * surface.size())).into();
                inside.push(format!(
                    "tool {}: it starts {:.1} mm inside body {}; move its pose out of it, for example to position = \
                     [{x:.4}, {y:.4}, {z:.4}]",
                    tool.id,
                    depth_m * 1e3,
                    scene.body_id(b)
                ));
            }
        }
    }
    inside
}

/// Soft bodies that stand in each other: contact would press them apart in one tick, with a force that no
/// material bears.
pub fn overlaps(scene: &Scene) -> Vec<String> {
    let plan = scene.plan();
    let soft: Vec<usize> = (0..scene.body_count())
        .filter(|body| plan.bodies[*body].deformable.is_some())
        .collect();
    let mut found = Vec::new();
    for (k, &a) in soft.iter().enumerate() {
        for &b in &soft[k + 1..] {
            let surfaces = [a, b].map(|body| scene.rest_surface(body));
            let boxes = surfaces.map(|surface| bounds(surface.net().points()));
            if !meet(&boxes[0], &boxes[1]) {
                continue;
            }
            let least_m = surfaces
                .map(|surface| surface.size())
                .into_iter()
                .fold(f64::MAX, f64::min);
            // Open surfaces have no inside, and are not asked about.
            let Ok(apart) = isolate(surfaces[0], surfaces[1], &IsolateSpec::default()) else {
                continue;
            };
            let by = apart.translation_m;
            if by.norm() > MOST_OVERLAP * least_m {
                found.push(format!(
                    "bodies {} and {} stand {:.1} mm in each other: they would be pressed apart in one tick; move {} by \
                     [{:.4}, {:.4}, {:.4}] m",
                    scene.body_id(a),
                    scene.body_id(b),
                    by.norm() * 1e3,
                    scene.body_id(a),
                    by.x,
                    by.y,
                    by.z
                ));
            }
        }
    }
    found
}

/// The corners of the points' box.
fn bounds(points: &[Point3]) -> (Point3, Point3) {
    let first = points.first().copied().unwrap_or_default();
    let grown = |(low, high): (Point3, Point3), p: &Point3| (low.inf(p), high.sup(p));
    points.iter().fold((first, first), grown)
}

/// Whether two boxes have a volume in common.
fn meet(a: &(Point3, Point3), b: &(Point3, Point3)) -> bool {
    (0..3).all(|axis| a.0[axis] < b.1[axis] && b.0[axis] < a.1[axis])
}
