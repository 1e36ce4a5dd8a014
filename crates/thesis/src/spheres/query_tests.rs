//! The method through the table of queries that a scene's pairs go through.

use super::{SPHERES, counters_of};
use palpate_geometry::contact::dispatch::{Method, Narrow, Party};
use palpate_geometry::contact::implicit::ImplicitShape;
use palpate_geometry::contact::{Reach, SurfaceShape, ToolShape};
use palpate_geometry::math::{Pose, Vector3};
use palpate_geometry::skin::SkinSide;
use palpate_geometry::skin::{Skin, SkinSolver};
use palpate_geometry::surface::builtin;

const METHODS: [Method; 2] = [Method::Exact, Method::Other(&SPHERES, [20, 20])];

/// A ball tool as each shape, the sheet z = 0 as the body: what touches is found by every query
/// of the table.
#[test]
fn every_tool_shape_touches_by_both_methods() {
    let sheet = Skin::from(builtin("sheet", Some([7, 7]), Some(0.1)).unwrap());
    let radius_m = 0.01;
    let implicit = ImplicitShape::Sphere { radius_m };
    let globe = builtin("sphere", None, Some(2.0 * radius_m)).unwrap();
    let parameters = |k: i32| (f64::from(k % 50) / 50.0, f64::from(k / 50) / 50.0);
    let heights = (0..2500).map(parameters).map(|(u, v)| globe.point(u, v).z);
    let globe_low_m = -heights.fold(0.0, f64::min);
    let shapes = [
        ToolShape::Sphere { radius_m },
        ToolShape::Plane {
            normal: -Vector3::z(),
        },
        ToolShape::Implicit {
            tool: Box::new(implicit.compile().unwrap()),
            reach_m: Some(radius_m),
        },
        ToolShape::Surface(Box::new(SurfaceShape::new(globe))),
    ];
    for shape in shapes {
        let low_m = match &shape {
            ToolShape::Plane { .. } => 0.0,
            ToolShape::Surface(_) => globe_low_m,
            _ => radius_m,
        };
        let pose = Pose::translation(0.003, 0.001, low_m - 1e-3);
        for method in METHODS {
            let mut narrow = Narrow::new((&sheet).into(), Party::Tool(&shape), method).unwrap();
            let body = SkinSide {
                skin: &sheet,
                solver: &mut SkinSolver::new(&sheet),
            };
            let reach = Reach {
                margin_m: 1e-4,
                below: false,
                closing_m: 0.0,
            };
            narrow.contacts(&shape, &pose, body, reach);
            let depth = narrow.set.deepest().map(|contact| contact.depth_m);
            assert!(
                depth.is_some_and(|depth| (depth - 1e-3).abs() < 3e-4),
                "{} {}: {depth:?}",
                shape.name(),
                method.name()
            );
            assert_eq!(
                narrow.other().and_then(counters_of).is_some(),
                method != Method::Exact,
                "{}",
                shape.name()
            );
        }
    }
}

#[test]
fn a_body_against_itself_on_points_is_refused_by_name() {
    let sheet = Skin::from(builtin("sheet", None, None).unwrap());
    let refused = Narrow::new((&sheet).into(), Party::Itself, METHODS[1]).unwrap_err();
    assert_eq!((refused.party, refused.method), ("itself", "spheres"));
    assert!(refused.to_string().contains("use method = \"exact\""));
    assert!(Narrow::new((&sheet).into(), Party::Itself, METHODS[0]).is_ok());
}
