//! Facts about mesh tools: what is refused, distances by brute force, and contacts in closed form.

use super::tree::Near;
use super::{MeshError, MeshSolver, MeshTool};
use crate::basis::testing::Random;
use crate::contact::{ContactSet, Reach};
use crate::math::{Point3, Pose, Rotation, Vector3};
use crate::skin::{Skin, SkinSide, SkinSolver};
use crate::surface::{ClosestSolver, Surface, builtin};

const CUBE: [[u32; 3]; 12] = [
    [0, 2, 1],
    [0, 3, 2],
    [4, 5, 6],
    [4, 6, 7],
    [0, 1, 5],
    [0, 5, 4],
    [1, 2, 6],
    [1, 6, 5],
    [2, 3, 7],
    [2, 7, 6],
    [3, 0, 4],
    [3, 4, 7],
];

fn cube_points(half: f64) -> Vec<Point3> {
    let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    [-1.0, 1.0]
        .iter()
        .flat_map(|z| square.map(|(x, y)| Point3::new(x * half, y * half, z * half)))
        .collect()
}

fn cube(half: f64) -> MeshTool {
    MeshTool::new(&cube_points(half), &CUBE).unwrap()
}

/// A sphere of triangles between parallels.
fn ball(radius: f64, n: usize) -> (Vec<Point3>, Vec<[u32; 3]>) {
    let (mut points, mut triangles) = (vec![Point3::new(0.0, 0.0, -radius)], vec![]);
    for i in 1..n {
        let a = std::f64::consts::PI * i as f64 / n as f64;
        for j in 0..2 * n {
            let b = std::f64::consts::PI * j as f64 / n as f64;
            let (s, c) = (libm::sin(a), -libm::cos(a));
            points.push(Point3::new(s * libm::cos(b), s * libm::sin(b), c) * radius);
        }
    }
    points.push(Point3::new(0.0, 0.0, radius));
    let last = points.len() as u32 - 1;
    let at = |i: usize, j: usize| 1 + ((i - 1) * 2 * n + j % (2 * n)) as u32;
    for j in 0..2 * n {
        triangles.push([0, at(1, j + 1), at(1, j)]);
        triangles.push([last, at(n - 1, j), at(n - 1, j + 1)]);
        for i in 1..n - 1 {
            triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    (points, triangles)
}

fn vector(random: &mut Random) -> Vector3 {
    Vector3::new(
        random.float(-1.0, 1.0),
        random.float(-1.0, 1.0),
        random.float(-1.0, 1.0),
    )
}

#[test]
fn a_mesh_that_bounds_no_volume_is_refused_with_the_reason() {
    let points = cube_points(1.0);
    assert!(matches!(
        MeshTool::new(&points, &CUBE[..3]),
        Err(MeshError::Few { triangles: 3 })
    ));
    assert!(matches!(
        MeshTool::new(&points, &CUBE[1..]),
        Err(MeshError::Open { edges: 3, .. })
    ));
    let mut turned = CUBE;
    turned[4].swap(0, 1);
    assert!(matches!(
        MeshTool::new(&points, &turned),
        Err(MeshError::Orientation { .. })
    ));
    let mut wrong = CUBE;
    wrong[2][1] = 8;
    let error = MeshTool::new(&points, &wrong).unwrap_err();
    assert_eq!(
        error,
        MeshError::Index {
            triangle: 2,
            vertex: 8,
            vertices: 8
        }
    );
    let mut bad = points.clone();
    bad[3].y = f64::NAN;
    assert!(matches!(
        MeshTool::new(&bad, &CUBE),
        Err(MeshError::NotFinite { vertex: 3, .. })
    ));
    let flat: Vec<Point3> = points
        .iter()
        .map(|p| Point3::new(p.x, p.y, 1e-15 * p.z))
        .collect();
    assert!(matches!(
        MeshTool::new(&flat, &CUBE),
        Err(MeshError::Degenerate { .. } | MeshError::Flat { .. })
    ));
    let line: Vec<Point3> = points
        .iter()
        .map(|p| Point3::new(p.x + p.y * 0.3, 0.0, 0.0))
        .collect();
    assert!(MeshTool::new(&line, &CUBE).is_err());
    assert!(MeshTool::new(&[], &[]).is_err());
}

#[test]
fn triangles_without_shared_vertices_are_merged_and_an_inverted_mesh_is_turned() {
    let points = cube_points(1.0);
    let soup: Vec<Point3> = CUBE.iter().flatten().map(|&k| points[k as usize]).collect();
    let inward: Vec<[u32; 3]> = (0..12).map(|k| [3 * k, 3 * k + 2, 3 * k + 1]).collect();
    let tool = MeshTool::new(&soup, &inward).unwrap();
    assert_eq!(tool.vertices().len(), 8);
    assert!((tool.volume_m3() - 8.0).abs() < 1e-14);
    assert!((tool.signed_distance(&Point3::new(0.1, 0.0, 0.4)).0 + 0.6).abs() < 1e-15);
}

#[test]
fn signed_distances_are_those_of_brute_force() {
    let mut random = Random(31);
    let (points, triangles) = ball(0.5, 8);
    let tool = MeshTool::new(&points, &triangles).unwrap();
    for _ in 0..500 {
        let p = Point3::from(vector(&mut random) * 0.9);
        // Inside a convex mesh: below every face.
        let mut inside = true;
        let mut nearest = f64::INFINITY;
        for t in &triangles {
            let [a, b, c] = t.map(|k| points[k as usize]);
            inside &= (b - a).cross(&(c - a)).dot(&(p - a)) < 0.0;
            nearest = nearest.min(to_triangle(&p, &a, &b, &c));
        }
        let (d, out) = tool.signed_distance(&p);
        assert!((d.abs() - nearest).abs() <= 1e-14, "{p:?}: {d} {nearest}");
        assert_eq!(d < 0.0, inside, "{p:?}");
        assert!(
            (tool.signed_distance(&(p - out * d)).0).abs() <= 1e-13,
            "{p:?}: the way out misses"
        );
    }
}

/// Distance to a triangle: its plane's foot if inside, else the nearest edge.
fn to_triangle(p: &Point3, a: &Point3, b: &Point3, c: &Point3) -> f64 {
    let n = (b - a).cross(&(c - a));
    let within = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|(x, y)| n.cross(&(*y - *x)).dot(&(p - *x)) >= 0.0);
    if within {
        return (p - a).dot(&n).abs() / n.norm();
    }
    [(a, b), (b, c), (c, a)]
        .iter()
        .map(|(x, y)| {
            let e = *y - *x;
            let t = ((p - *x).dot(&e) / e.norm_squared()).clamp(0.0, 1.0);
            (p - (*x + e * t)).norm()
        })
        .fold(f64::INFINITY, f64::min)
}

fn touch(surface: &Surface, tool: &MeshTool, pose: &Pose, reach: &Reach) -> ContactSet {
    let skin = Skin::from(surface.clone());
    let mut solver = SkinSolver::new(&skin);
    let mut mesh = MeshSolver::new(&skin, tool);
    let mut out = ContactSet::new();
    mesh.contacts(
        SkinSide {
            skin: &skin,
            solver: &mut solver,
        },
        tool,
        pose,
        reach,
        &[],
        &mut out,
    );
    for c in out.contacts() {
        let scale = surface.size() + c.on_body.coords.amax();
        assert!(
            (surface.point(c.u, c.v) - c.on_body).norm() <= 1e-12 * scale,
            "{c:?}"
        );
        assert!(
            (c.on_body - c.on_tool - c.normal * c.depth_m).norm() <= 1e-12 * scale,
            "{c:?}"
        );
        assert!((c.normal.norm() - 1.0).abs() < 1e-9, "{c:?}");
    }
    out
}

// A cube balanced on a corner, pressed into a sheet: the corner is deepest, and stands for its
// region.
#[test]
fn a_corner_pressed_into_a_body_is_one_contact() {
    let body = builtin("sphere", None, Some(1.0)).unwrap();
    let tool = cube(0.2);
    let down = Rotation::rotation_between(&Vector3::new(-1.0, -1.0, -1.0), &-Vector3::z()).unwrap();
    let top = ClosestSolver::new(&body)
        .deepest_along(&body, &Vector3::z())
        .2;
    let tip = 0.2 * 3.0_f64.sqrt();
    let pose = Pose::from_parts((top.coords + Vector3::z() * (tip - 0.05)).into(), down);
    let set = touch(&body, &tool, &pose, &Reach::TOUCH);
    let c = set.deepest().unwrap();
    assert!(
        (c.depth_m - 0.05).abs() <= 1e-6 && c.normal.z > 0.999,
        "{set:?}"
    );
    assert_eq!(set.contacts().len(), 1, "{set:?}");
}

// A face larger than the body's bump: no vertex is inside, the surface's own highest point is the
// contact.
#[test]
fn a_face_on_a_round_body_is_touched_by_the_body() {
    let body = builtin("sphere", None, Some(0.5)).unwrap();
    let top = ClosestSolver::new(&body)
        .deepest_along(&body, &Vector3::z())
        .2;
    let tool = cube(2.0);
    let pose = Pose::translation(0.1, -0.2, top.z + 2.0 - 0.03);
    let set = touch(&body, &tool, &pose, &Reach::TOUCH);
    assert_eq!(set.contacts().len(), 1, "{set:?}");
    let c = set.deepest().unwrap();
    assert!(
        (c.depth_m - 0.03).abs() <= 1e-9 && (c.normal - Vector3::z()).norm() < 1e-9,
        "{c:?}"
    );
    // Lifted off, within the margin and without.
    let pose = Pose::translation(0.1, -0.2, top.z + 2.0 + 0.01);
    assert!(
        touch(&body, &tool, &pose, &Reach::TOUCH)
            .deepest()
            .is_none()
    );
    let set = touch(
        &body,
        &tool,
        &pose,
        &Reach {
            margin_m: 0.02,
            below: false,
            closing_m: 0.0,
        },
    );
    assert!(
        (set.deepest().unwrap().depth_m + 0.01).abs() <= 1e-9,
        "{set:?}"
    );
}

#[test]
fn tool_entirely_inside_and_body_entirely_inside() {
    let body = builtin("sphere", None, Some(0.5)).unwrap();
    let mut solver = ClosestSolver::new(&body);
    let pose = Pose::translation(0.1, 0.05, 0.02);
    let tool = cube(0.02);
    let set = touch(&body, &tool, &pose, &Reach::TOUCH);
    // The deepest vertex is the one farthest from the surface.
    let deepest = tool
        .vertices()
        .iter()
        .map(|p| -solver.closest(&body, &(pose * p)).signed_distance);
    let expected = deepest.fold(f64::NEG_INFINITY, f64::max);
    assert!(
        (set.deepest().unwrap().depth_m - expected).abs() <= 1e-12,
        "{set:?}"
    );
    let set = touch(&body, &cube(3.0), &Pose::identity(), &Reach::TOUCH);
    // Where the body is farthest from the six faces: at most 3 m less its least extent.
    assert!(
        set.overlap() && set.deepest().unwrap().depth_m > 2.0,
        "{set:?}"
    );
}

#[test]
fn two_feet_are_two_contacts_and_moving_all_changes_nothing() {
    let sheet = builtin("sheet", None, Some(1.0)).unwrap();
    // Two cubes in one mesh.
    let mut points: Vec<Point3> = cube_points(0.05)
        .iter()
        .map(|p| p + Vector3::x() * 0.2)
        .collect();
    points.extend(cube_points(0.05).iter().map(|p| p - Vector3::x() * 0.2));
    let mut triangles = CUBE.to_vec();
    triangles.extend(CUBE.map(|t| t.map(|k| k + 8)));
    let tool = MeshTool::new(&points, &triangles).unwrap();
    let tilt = Rotation::from_euler_angles(0.2, 0.0, 0.1);
    let pose = Pose::from_parts(Vector3::new(0.03, 0.02, 0.045).into(), tilt);
    let set = touch(&sheet, &tool, &pose, &Reach::TOUCH);
    let sides: Vec<bool> = set.contacts().iter().map(|c| c.on_body.x > 0.03).collect();
    assert!(sides.contains(&true) && sides.contains(&false), "{set:?}");
    let by = Pose::from_parts(
        Vector3::new(0.7, -0.3, 0.2).into(),
        Rotation::from_euler_angles(0.4, 1.0, -0.6),
    );
    let moved = touch(&sheet.transformed(&by), &tool, &(by * pose), &Reach::TOUCH);
    assert!(
        (set.deepest().unwrap().depth_m - moved.deepest().unwrap().depth_m).abs() <= 1e-9,
        "{set:?} {moved:?}"
    );
}

#[test]
fn poses_that_are_not_finite_touch_nothing() {
    let body = builtin("teardrop", None, None).unwrap();
    let tool = cube(0.05);
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(
            touch(
                &body,
                &tool,
                &Pose::translation(0.0, bad, 0.0),
                &Reach::TOUCH
            )
            .deepest()
            .is_none()
        );
    }
    assert_eq!(
        tool.signed_distance(&Point3::new(f64::NAN, 0.0, 0.0)).0,
        f64::INFINITY
    );
}

/// A ball with bumps and hollows, from waves of its directions.
fn bumpy(radius: f64, n: usize, random: &mut Random) -> MeshTool {
    let (mut points, triangles) = ball(1.0, n);
    let waves: [Vector3; 3] = std::array::from_fn(|_| vector(random) * 6.0);
    for p in &mut points {
        let sum: f64 = waves.iter().map(|w| libm::sin(w.dot(&p.coords))).sum();
        *p *= radius * (1.0 + 0.2 * sum);
    }
    MeshTool::new(&points, &triangles).unwrap()
}

/// A box with three lengths.
fn cuboid(half: [f64; 3]) -> MeshTool {
    let points = cube_points(1.0);
    let scaled = |p: &Point3| Point3::from(p.coords.component_mul(&Vector3::from(half)));
    MeshTool::new(&points.iter().map(scaled).collect::<Vec<_>>(), &CUBE).unwrap()
}

/// Solids with hollows, needles and slivers, of this size.
fn solids(size: f64, random: &mut Random) -> Vec<MeshTool> {
    vec![
        bumpy(size, 9, random),
        bumpy(size, 40, random),
        cuboid([size, 0.9 * size, 1.2 * size]),
        cuboid([0.01 * size, 0.02 * size, 2.0 * size]),
        cuboid([size, size, 1e-4 * size]),
    ]
}

#[test]
fn distances_do_not_depend_on_what_was_asked_before() {
    let mut random = Random(77);
    for tool in solids(0.3, &mut random) {
        let mut near = Near::default();
        let mut p = Point3::origin();
        for k in 0..2_000 {
            // Strides from far to rounding.
            p += vector(&mut random) * libm::pow(10.0, -f64::from(k % 17)) - p.coords * 0.05;
            let (gap_m, out) = tool.signed_distance(&p);
            let foot = tool.triangles.foot(&p, &mut near);
            assert_eq!((foot.gap_m, foot.out), (gap_m, out), "{p:?}");
            let brute = tool.triangles().iter().map(|t| {
                let [a, b, c] = t.map(|k| tool.vertices()[k as usize]);
                to_triangle(&p, &a, &b, &c)
            });
            let brute = brute.fold(f64::INFINITY, f64::min);
            assert!((gap_m.abs() - brute).abs() <= 1e-15, "{gap_m} {brute}");
        }
    }
}

#[test]
fn vertices_found_are_all_that_are_deeper_than_those_beside_them() {
    let mut random = Random(78);
    let reach = Reach {
        margin_m: 1e-3,
        ..Reach::TOUCH
    };
    for (name, net) in [("teardrop", 8), ("sphere", 8), ("torus", 20), ("sheet", 4)] {
        let body = Skin::from(builtin(name, Some([net; 2]), None).unwrap());
        let size = body.size_m();
        let mut solver = SkinSolver::new(&body);
        let tools = [0.05, 0.8].map(|share| solids(share * size, &mut random));
        for tool in tools.iter().flatten() {
            let mut mesh = MeshSolver::new(&body, tool);
            for _ in 0..4 {
                let place = body.point(random.float(0.0, 1.0), random.float(0.0, 1.0));
                let shift = vector(&mut random) * (0.3 * tool.size_m());
                let pose = Pose::from_parts((place.coords + shift).into(), random.rotation());
                let solver = &mut solver;
                let depths: Vec<f64> = (tool.vertices().iter())
                    .map(|p| -solver.closest(&body, &(pose * p)).signed_distance)
                    .collect();
                let skin = &body;
                let mut set = ContactSet::new();
                mesh.contacts(
                    SkinSide { skin, solver },
                    tool,
                    &pose,
                    &reach,
                    &[],
                    &mut set,
                );
                let found: Vec<f64> = mesh.corners.iter().map(|c| c.depth_m).collect();
                let mut known: Vec<f64> = (0..depths.len())
                    .filter(|&k| depths[k] >= -reach.margin_m)
                    .filter(|&k| {
                        tool.neighbours(k)
                            .iter()
                            .all(|&n| depths[n as usize] < depths[k])
                    })
                    .map(|k| depths[k])
                    .collect();
                known.sort_by(|a, b| b.total_cmp(a));
                // Behind a sheet only those straight below it count.
                known.retain(|depth| body.is_closed() || *depth <= 0.0 || found.contains(depth));
                known.truncate(crate::contact::MAX_CONTACTS);
                assert_eq!(found, known, "{name} {tool:?}");
            }
        }
    }
}
