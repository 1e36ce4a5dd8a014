//! What viewers draw of each shape is the shape: closed, outward, on its boundary, and not too much.

use super::outline::MOST_TRIANGLES;
use super::*;
use crate::scene::door::Door;
use palpate_geometry::math::{Point3, Pose};
use palpate_geometry::surface::Mesh;
use std::collections::BTreeMap;
use std::path::Path;

/// Size of the scene around the shapes, m.
const VIEW_M: f64 = 0.1;

fn built(text: &str) -> (ShapeSpec, ToolShape) {
    #[derive(Deserialize)]
    struct ToolFile {
        shape: ShapeSpec,
    }
    let tool: ToolFile = toml::from_str(&format!("shape = {{ {text} }}")).unwrap();
    let here = Path::new(".");
    let door = Door::new(&here);
    let shape = tool.shape.build(&door.top().key("shape"));
    (tool.shape, door.close(shape).unwrap())
}

/// Every edge comes as often in one direction as in the other.
fn assert_closed(mesh: &Mesh, what: &str) {
    let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for &[a, b, c] in &mesh.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            assert!(from != to, "{what}: a triangle without area");
            *edges.entry((from.min(to), from.max(to))).or_default() +=
                if from < to { 1 } else { -1 };
        }
    }
    assert!(edges.values().all(|&n| n == 0), "{what} is not closed");
}

fn volume_m3(mesh: &Mesh) -> f64 {
    let corner = |k: u32| mesh.points[k as usize].coords;
    let six = |&[a, b, c]: &[u32; 3]| corner(a).dot(&corner(b).cross(&corner(c)));
    mesh.triangles.iter().map(six).sum::<f64>() / 6.0
}

// The volume of what is drawn against the formula of the solid; a shape that is turned inside out
// has a negative one. Corners lie on the boundary to rounding, middles of triangles within a chord.
#[test]
fn every_solid_is_drawn_as_what_it_is() {
    use std::f64::consts::PI;
    let cone_base = 0.02 * libm::tan(0.3);
    let cases: [(&str, f64, f64); 12] = [
        ("sphere = { radius_m = 0.01 }", 4.0 / 3.0 * PI * 1e-6, 0.02),
        (
            "cylinder = { radius_m = 0.004, half_length_m = 0.03 }",
            PI * 0.004 * 0.004 * 0.06,
            0.02,
        ),
        (
            "cylinder = { radius_m = 0.004 }",
            PI * 0.004 * 0.004 * 2.0 * VIEW_M,
            0.02,
        ),
        (
            "capsule = { radius_m = 0.004, half_length_m = 0.02 }",
            PI * 0.004 * 0.004 * (0.04 + 4.0 / 3.0 * 0.004),
            0.02,
        ),
        (
            "cone = { half_angle_rad = 0.3, height_m = 0.02 }",
            PI * cone_base * cone_base * 0.02 / 3.0,
            0.02,
        ),
        (
            "ellipsoid = { semi_axes_m = [0.01, 0.005, 0.02] }",
            4.0 / 3.0 * PI * 1e-6,
            0.02,
        ),
        (
            "torus = { major_radius_m = 0.02, minor_radius_m = 0.005 }",
            2.0 * PI * PI * 0.02 * 0.005 * 0.005,
            0.02,
        ),
        (
            "box = { half_extents_m = [0.01, 0.02, 0.005] }",
            8.0 * 1e-6,
            1e-12,
        ),
        (
            "implicit = { f = \"x^2 + y^2 + 4*z^2 - 1e-4\", reach_m = 0.02 }",
            4.0 / 3.0 * PI * 0.5e-6,
            0.02,
        ),
        // Edges are cut off by up to a cell.
        (
            "implicit = { f = \"max(abs(x) - 0.01, abs(y) - 0.005, abs(z) - 0.02)\", reach_m = 0.03 }",
            8.0 * 1e-6,
            0.02,
        ),
        // Two balls.
        (
            "implicit = { f = \"min(hypot(hypot(x - 0.015, y), z), hypot(hypot(x + 0.015, y), z)) - 0.01\", reach_m = 0.03 }",
            2.0 * 4.0 / 3.0 * PI * 1e-6,
            0.03,
        ),
        // Without end, closed where the scene ends.
        (
            "implicit = { f = \"hypot(x, y) - 0.03\" }",
            PI * 9e-4 * 2.0 * VIEW_M,
            0.03,
        ),
    ];
    for (text, volume, tolerance) in cases {
        let (spec, shape) = built(text);
        let mesh = spec.shape().outline(&shape, VIEW_M);
        let count = mesh.triangles.len();
        println!(
            "{text}: {count} triangles, {:+.4} of the volume",
            volume_m3(&mesh) / volume - 1.0
        );
        assert!((8..=MOST_TRIANGLES).contains(&count), "{text}: {count}");
        assert_closed(&mesh, text);
        let off = volume_m3(&mesh) / volume - 1.0;
        assert!(off.abs() < tolerance, "{text}: volume off by {off}");
        if let ToolShape::Implicit { tool, .. } = &shape {
            // Where the drawing is cut off by the size of the scene, it does not follow the shape.
            let follows = |p: &Point3| p.coords.amax() < 0.99 * VIEW_M;
            for p in mesh.points.iter().filter(|p| follows(p)) {
                let Some((gap_m, _)) = tool.signed_gap(&Pose::identity(), p) else {
                    continue;
                };
                assert!(gap_m.abs() < 1e-7, "{text}: {p} is {gap_m} m off");
            }
        }
    }
}

#[test]
fn a_ring_without_a_hole_is_drawn_from_outside() {
    let (spec, shape) = built("torus = { major_radius_m = 0.01, minor_radius_m = 0.015 }");
    let mesh = spec.shape().outline(&shape, VIEW_M);
    assert_closed(&mesh, "spindle");
    assert!(volume_m3(&mesh) > 0.0);
}

#[test]
fn what_has_no_size_takes_that_of_the_scene() {
    let extent = |mesh: &Mesh| {
        mesh.points
            .iter()
            .map(|p| p.coords.norm())
            .fold(0.0, f64::max)
    };
    let (spec, shape) = built("point = {}");
    let point = spec.shape().outline(&shape, VIEW_M);
    assert_closed(&point, "point");
    assert!((1e-3..5e-3).contains(&extent(&point)));
    for normal in ["[0, 0, 1]", "[0, 0, -2]", "[1, 2, 3]"] {
        let (spec, shape) = built(&format!("plane = {{ normal = {normal} }}"));
        let plate = spec.shape().outline(&shape, VIEW_M);
        assert_closed(&plate, normal);
        assert!(volume_m3(&plate) > 0.0);
        let ToolShape::Plane { normal } = shape else {
            panic!("a plane");
        };
        let above = |p: &Point3| p.coords.dot(&normal);
        assert!(plate.points.iter().all(|p| above(p) < 1e-12));
        assert!(plate.points.iter().any(|p| above(p) > -1e-12));
        assert!((0.05..0.08).contains(&extent(&plate)), "{}", extent(&plate));
    }
}

#[test]
fn meshes_and_surfaces_are_drawn_as_they_are() {
    let tetrahedron = "mesh = { inline = { vertices = [[0, 0, 0], [0.01, 0, 0], [0, 0.01, 0], [0, 0, 0.01]], \
                       triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] } }";
    let (spec, shape) = built(tetrahedron);
    let mesh = spec.shape().outline(&shape, VIEW_M);
    assert_eq!(mesh.triangles.len(), 4);
    assert_closed(&mesh, "tetrahedron");
    assert!((volume_m3(&mesh) / (1e-6 / 6.0) - 1.0).abs() < 1e-12);

    let (spec, shape) = built("surface = { builtin = \"torus\" }");
    let ToolShape::Surface(surface) = &shape else {
        panic!("a surface");
    };
    let mesh = spec.shape().outline(&shape, VIEW_M);
    assert!((1_000..=MOST_TRIANGLES).contains(&mesh.triangles.len()));
    let volume = surface.surface().volume();
    assert!((volume_m3(&mesh) / volume - 1.0).abs() < 0.02);
}

// Shapes and values as recordings keep them: what was written once must be read for ever.
#[test]
fn shapes_are_written_as_they_are_read() {
    for text in [
        "point = {}",
        "sphere = { radius_m = 0.01 }",
        "plane = { normal = [0.0, 0.0, 1.0] }",
        "cylinder = { radius_m = 0.004 }",
        "box = { half_extents_m = [0.01, 0.02, 0.005] }",
        "implicit = { f = \"x - 1\", reach_m = 2.0 }",
        "surface = { builtin = \"torus\" }",
    ] {
        let (spec, _) = built(text);
        let name = text.split(' ').next().unwrap();
        assert_eq!(spec.name(), name);
        let written = toml::to_string(&spec).unwrap();
        assert_eq!(
            toml::from_str::<ShapeSpec>(&written).unwrap(),
            spec,
            "{written}"
        );
    }
}
