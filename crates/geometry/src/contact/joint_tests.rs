//! Contact on the joints of a branching surface, of every kind of tool.

use super::exact::{ExactScratch, ball, plane};
use super::implicit::{ImplicitShape, ImplicitSolver};
use super::pair::{PairSide, PairSolver};
use super::{ContactSet, Reach};
use crate::math::{Point3, Pose, Vector3};
use crate::skin::{Skin, SkinSide, SkinSolver};
use crate::surface::{ClosestSolver, Surface, builtin, file};

fn vessel() -> Surface {
    file::read(include_str!("../../../../scenes/vessel.json"))
        .unwrap()
        .with_exact_seams()
}

fn ball_on(surface: &Surface, centre: Point3, radius_m: f64) -> ContactSet {
    let mut solver = ClosestSolver::new(surface);
    let mut scratch = ExactScratch::new(surface, &mut solver);
    let mut out = ContactSet::new();
    ball::contacts(
        surface,
        &mut solver,
        &centre,
        radius_m,
        &Reach::TOUCH,
        &mut scratch,
        &mut out,
    );
    out
}

fn plane_on(surface: &Surface, point: Point3, normal: Vector3) -> ContactSet {
    let mut solver = ClosestSolver::new(surface);
    let mut scratch = ExactScratch::new(surface, &mut solver);
    let mut out = ContactSet::new();
    plane::contacts(
        surface,
        &mut solver,
        &point,
        &normal,
        &Reach::TOUCH,
        &mut scratch,
        &mut out,
    );
    out
}

fn function_on(surface: &Surface, shape: &ImplicitShape, pose: &Pose) -> ContactSet {
    let skin = Skin::from(surface.clone());
    let mut solver = SkinSolver::new(&skin);
    let mut implicit = ImplicitSolver::new(&skin);
    let mut out = ContactSet::new();
    implicit.contacts(
        SkinSide {
            skin: &skin,
            solver: &mut solver,
        },
        &shape.compile().unwrap(),
        pose,
        &Reach::TOUCH,
        &[],
        &mut out,
    );
    out
}

fn surfaces(body: &Surface, tool: &Surface) -> ContactSet {
    let (mut a, mut b) = (ClosestSolver::new(body), ClosestSolver::new(tool));
    let (body_side, tool_side) = (
        PairSide {
            surface: body,
            solver: &mut a,
        },
        PairSide {
            surface: tool,
            solver: &mut b,
        },
    );
    let mut out = ContactSet::new();
    PairSolver::new(body, tool).contacts(body_side, tool_side, Reach::TOUCH, &mut out);
    out
}

// Of a branching tube, whose edges are joined and whose stem is drawn twice: one contact on and
// beside every joint.
#[test]
fn a_ball_on_a_joint_touches_once() {
    let vessel = vessel();
    let (radius_m, depth_m) = (1e-3, 2e-4);
    let before = 1e-9;
    let joints = [
        (0.0, 8.3),
        (12.0 - before, 8.3),
        (6.0, 8.3),
        (0.0, 2.2),
        (6.0, 2.2),
        (18.0, 2.2),
        (12.0, 2.2),
    ];
    let across = [
        (2.2, 6.0 - before),
        (2.2, 6.0),
        (21.3, 6.0 - before),
        (9.6, 6.0),
        (9.6, 6.0 - before),
    ];
    let corners = [
        (0.0, 6.0 - before),
        (0.0, 6.0),
        (6.0, 6.0),
        (6.0, 6.0 - before),
        (18.0, 6.0 - before),
    ];
    for (u, v) in joints.into_iter().chain(across).chain(corners) {
        for step in [0.0, 1e-7, 1e-4, 0.05] {
            let inside = |x: f64, end: f64| if x + step <= end { x + step } else { x - step };
            let (u, v) = (inside(u, 24.0), inside(v, 11.0));
            let (point, normal) = (vessel.point(u, v), vessel.normal(u, v));
            let found = ball_on(&vessel, point + normal * (radius_m - depth_m), radius_m);
            assert_eq!(
                found.contacts().len(),
                1,
                "({u}, {v}): {:?}",
                found.contacts()
            );
            let contact = found.contacts()[0];
            assert!(
                (contact.depth_m - depth_m).abs() < 1e-8,
                "({u}, {v}): {contact:?}"
            );
            assert!(
                (contact.normal - normal).norm() < 1e-4,
                "({u}, {v}): {contact:?}"
            );
        }
    }
    // A plane on the stem's open end and on the branches: as deep as the lowest point, once each.
    let low = vessel
        .net()
        .points()
        .iter()
        .map(|p| p.z)
        .fold(f64::INFINITY, f64::min);
    let found = plane_on(&vessel, Point3::new(0.0, 0.0, low + 1e-3), Vector3::z());
    assert!(!found.contacts().is_empty());
    assert!((found.contacts()[0].depth_m - 1e-3).abs() < 1e-12);
}

// A ball as a function slides over the joints of a branching tube: one contact, as deep as the
// certified one.
#[test]
fn a_function_on_a_joint_touches_once() {
    let vessel = vessel();
    let (radius, depth_m, before) = (1e-3, 2e-4, 1e-9);
    let shape = ImplicitShape::Expression {
        text: format!("sqrt(x^2 + y^2 + z^2) - {radius}"),
    };
    let places = [
        (0.0, 8.3),
        (12.0 - before, 8.3),
        (11.96, 8.3),
        (6.0, 2.2),
        (18.03, 2.2),
        (2.2, 6.0),
        (2.2, 5.97),
        (9.6, 5.99),
    ];
    for (u, v) in places {
        let (point, normal) = (vessel.point(u, v), vessel.normal(u, v));
        let centre = point + normal * (radius - depth_m);
        let found = function_on(
            &vessel,
            &shape,
            &Pose::translation(centre.x, centre.y, centre.z),
        );
        assert_eq!(
            found.contacts().len(),
            1,
            "({u}, {v}): {:?}",
            found.contacts()
        );
        assert!(
            (found.contacts()[0].depth_m - depth_m).abs() < 1e-8,
            "({u}, {v}): {:?}",
            found.contacts()
        );
    }
}

// A small ball across the joints of a branching tube, an open sheet: as deep as it was put,
// wherever.
#[test]
fn a_ball_on_the_joints_of_a_branching_tube() {
    let vessel = vessel();
    let (radius_m, depth_m, before) = (2e-3, 2e-4, 1e-9);
    let ball = builtin("sphere", None, Some(radius_m)).unwrap();
    for (u, v) in [
        (0.0, 8.3),
        (11.96, 8.3),
        (6.02, 2.2),
        (2.2, 6.0 - before),
        (2.2, 6.02),
        (21.3, 5.98),
        (3.0, 8.3),
    ] {
        let (point, normal) = (vessel.point(u, v), vessel.normal(u, v));
        let shift = point.coords + normal * (radius_m - depth_m);
        let tool = ball.transformed(&Pose::translation(shift.x, shift.y, shift.z));
        let found = surfaces(&vessel, &tool);
        let depths: Vec<f64> = found.contacts().iter().map(|c| c.depth_m).collect();
        assert!(!depths.is_empty(), "({u}, {v})");
        assert!((depths[0] - depth_m).abs() < 1e-7, "({u}, {v}): {depths:?}");
        assert!(depths.len() <= 2, "({u}, {v}): {depths:?}");
    }
}
