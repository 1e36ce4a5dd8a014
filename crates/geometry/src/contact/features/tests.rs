//! Closed forms: tools on a flat sheet and in a ball.

use super::*;
use crate::contact::dispatch::{Method, Narrow, Party};
use crate::contact::implicit::ImplicitShape;
use crate::contact::mesh::MeshTool;
use crate::contact::{Contact, Reach, ToolPoint, ToolShape};
use crate::math::{Pose, Random, Rotation, Vector3, rotation_by};
use crate::skin::{Skin, SkinSide, SkinSolver};
use crate::surface::{Surface, builtin};

const MARGIN_M: f64 = 1e-5;

fn solid(shape: &ImplicitShape) -> ToolShape {
    ToolShape::Implicit {
        tool: Box::new(shape.compile().unwrap()),
        reach_m: None,
    }
}

fn contacts(surface: &Surface, shape: &ToolShape, pose: &Pose) -> Vec<Contact> {
    let skin = &Skin::from(surface.clone());
    let mut solver = SkinSolver::new(skin);
    let mut narrow = Narrow::new(skin.into(), Party::Tool(shape), Method::Exact).unwrap();
    let solver = &mut solver;
    let reach = Reach {
        margin_m: MARGIN_M,
        below: false,
        closing_m: 0.0,
    };
    narrow.contacts(shape, pose, SkinSide { skin, solver }, reach);
    narrow.set.contacts().to_vec()
}

fn sheet() -> Surface {
    builtin("sheet", Some([7, 7]), Some(0.1)).unwrap()
}

fn at(x: f64, y: f64, z: f64, turn: Rotation) -> Pose {
    Pose::from_parts(Vector3::new(x, y, z).into(), turn)
}

/// Height of the lowest point of a tool turned so, below its reference point, m.
fn lowest(features: &Features, turn: &Rotation) -> f64 {
    let corners = features.corners.iter().map(|p| (turn * p).z);
    let edges = features.edges.iter().map(|edge| match *edge {
        Edge::Curve(_) => unreachable!("these are given by sizes"),
        Edge::Segment { ends, .. } => ends.map(|p| (turn * p).z).into_iter().fold(0.0, f64::min),
        Edge::Circle { z, radius_m } => {
            let axis = turn * Vector3::z();
            z * axis.z - radius_m * libm::hypot(axis.x, axis.y)
        }
    });
    corners.chain(edges).fold(f64::INFINITY, f64::min)
}

fn shapes() -> Vec<ImplicitShape> {
    vec![
        ImplicitShape::Cone {
            half_angle_rad: 0.785,
            height_m: 0.015,
        },
        ImplicitShape::Cone {
            half_angle_rad: 0.3,
            height_m: 0.02,
        },
        ImplicitShape::Cylinder {
            radius_m: 0.009,
            half_length_m: Some(0.012),
        },
        ImplicitShape::Box {
            half_extents_m: [0.011, 0.008, 0.006],
        },
    ]
}

// However a tool with edges is turned, also flush and nearly flush, what is deepest in a flat sheet is a corner or a
// point of an edge, as deep as that is, with the sheet's normal; no side of it is asked.
#[test]
fn edges_and_corners_are_as_deep_as_they_are_along_the_body_s_normal() {
    let (sheet, mut random) = (sheet(), Random(40));
    for shape in shapes() {
        let (tool, features) = (solid(&shape), shape.features());
        for case in 0..60 {
            let tilt = [0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-2, 0.3][case % 7];
            let flush = [Vector3::zeros(), Vector3::x() * std::f64::consts::FRAC_PI_2];
            let axis = random.vector().normalize();
            let turn = match case % 3 {
                0 => random.rotation(),
                k => rotation_by(&(axis * tilt)) * rotation_by(&flush[k - 1]),
            };
            let depth = random.float(1e-9, 1e-3);
            let (x, y) = (random.float(-0.02, 0.02), random.float(-0.02, 0.02));
            let pose = at(x, y, -lowest(&features, &turn) - depth, turn);
            let found = contacts(&sheet, &tool, &pose);
            let deepest = &found[0];
            let error = (deepest.depth_m - depth).abs();
            assert!(
                error < 1e-12,
                "{shape:?} {case}: {deepest:?} is not {depth}"
            );
            for contact in &found {
                let off = (contact.normal - Vector3::z()).norm();
                assert!(off < 1e-12, "{shape:?} {case}: {contact:?}");
                let gap = contact.on_body - contact.on_tool - contact.normal * contact.depth_m;
                assert!(gap.norm() < 1e-14, "{shape:?} {case}: {contact:?}");
            }
        }
    }
}

// Where depth is level, corners and fixed points of edges carry it, the same in each query.
#[test]
fn a_flat_end_touches_with_the_same_points_in_each_query() {
    let sheet = sheet();
    for (shape, corners, round) in [(shapes().remove(2), 0, 8), (shapes().remove(3), 4, 0)] {
        let (tool, low) = (
            solid(&shape),
            lowest(&shape.features(), &Rotation::identity()),
        );
        let pose = at(0.003, 0.004, -low - 1e-3, Rotation::identity());
        let found = contacts(&sheet, &tool, &pose);
        let of = |point| found.iter().filter(|c| c.point == point).count();
        assert_eq!(
            (of(ToolPoint::Corner), of(ToolPoint::Round)),
            (corners, round),
            "{shape:?}"
        );
        assert_eq!(found.len(), corners + round, "{shape:?}");
        let pose = at(0.003 + 1e-7, 0.004, -low - 1e-3, Rotation::identity());
        let moved = contacts(&sheet, &tool, &pose);
        let place = |c: &Contact| c.on_tool;
        let mut both = [&found, &moved].map(|all| all.iter().map(place).collect::<Vec<_>>());
        both.iter_mut()
            .for_each(|all| all.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))));
        for (a, b) in both[0].iter().zip(&both[1]) {
            assert!(
                (b - a - Vector3::x() * 1e-7).norm() < 1e-12,
                "{shape:?}: {a} {b}"
            );
        }
    }
}

// A smooth side that is deeper than all edges is found as before; it counts by what it is deeper than the edge beside it.
#[test]
fn the_side_of_a_bar_on_a_ball_touches_between_its_edges() {
    let ball = builtin("sphere", None, Some(0.03)).unwrap();
    let bar = solid(&shapes()[2]);
    let turn = rotation_by(&(Vector3::x() * std::f64::consts::FRAC_PI_2));
    let found = contacts(&ball, &bar, &at(0.0, 0.0, 0.03 + 0.009 - 5e-4, turn));
    let deepest = &found[0];
    assert!((deepest.depth_m - 5e-4).abs() < 3e-6, "{deepest:?}");
    let ToolPoint::Deepest { by_m } = deepest.point else {
        panic!("{deepest:?}")
    };
    assert!(by_m > 1e-3, "{deepest:?}");
}

#[test]
fn a_mesh_has_the_edges_and_corners_of_what_it_stands_for() {
    let half = [0.011, 0.008, 0.006];
    let cuboid = ImplicitShape::Box {
        half_extents_m: half,
    };
    let known = cuboid.features();
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles: Vec<[u32; 3]> = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    let mesh = MeshTool::new(&known.corners, &triangles).unwrap();
    assert_eq!(
        (mesh.features().corners.len(), mesh.features().edges.len()),
        (8, 12)
    );
    let length = |features: &Features| features.edges.iter().map(Edge::length_m).sum::<f64>();
    assert!((length(mesh.features()) - length(&known)).abs() < 1e-15);
    // And touches as it does.
    let (sheet, mut random) = (sheet(), Random(7));
    let (mesh, cuboid) = (ToolShape::Mesh(Box::new(mesh)), solid(&cuboid));
    for _ in 0..30 {
        let turn = random.rotation();
        let pose = at(
            0.0,
            0.0,
            -lowest(&known, &turn) - random.float(0.0, 1e-3),
            turn,
        );
        let [a, b] = [&mesh, &cuboid].map(|tool| contacts(&sheet, tool, &pose)[0]);
        assert!(
            (a.depth_m - b.depth_m).abs() < 1e-12 && (a.on_tool - b.on_tool).norm() < 1e-9,
            "{a:?} {b:?}"
        );
    }
}

// Of many corners and edges, those that are looked at last are less deep than all that there is room for.
#[test]
fn of_more_features_than_there_is_room_for_the_deepest_are_found() {
    let mut random = Random(11);
    let ball = builtin("sphere", Some([8, 8]), Some(0.012)).unwrap();
    let mesh = ball.tessellated([4, 4]).unwrap();
    let tool = MeshTool::new(&mesh.points, &mesh.triangles).unwrap();
    let features = tool.features();
    for name in ["teardrop", "torus", "sphere"] {
        let skin = &Skin::from(builtin(name, None, None).unwrap());
        let mut solver = SkinSolver::new(skin);
        let mut search = FeatureSearch::new(skin, features);
        for k in 0..8 {
            let place = skin.point(random.float(0.0, 1.0), random.float(0.1, 0.9));
            let shift = Vector3::new(0.0, 0.0, 0.002 * f64::from(k));
            let pose = Pose::from_parts((place.coords + shift).into(), random.rotation());
            search.find(features, &pose, skin, &mut solver, &Reach::TOUCH);
            let found: Vec<f64> = search.found().iter().map(|c| c.depth_m).collect();
            let deepest = found[0];
            let mut depth = |p: &Point3| -solver.closest(skin, &(pose * p)).signed_distance;
            for p in &features.corners {
                let here = depth(p);
                let shallow = found.len() == crate::contact::MAX_CONTACTS && here <= found[31];
                assert!(
                    here < 0.0 || shallow || found.contains(&here),
                    "{name} {here}"
                );
            }
            for edge in features.edges.iter().step_by(7) {
                let along = (0..=8).map(|k| depth(&edge.at(f64::from(k) / 8.0).0));
                assert!(along.fold(0.0, f64::max) <= deepest + 1e-12, "{name}");
            }
        }
    }
}
