//! Truncated bodies against closed forms, data of another program, and the definition itself.

mod definition;
mod refusals;
mod shapes;

use super::{TruncateSpec, Truncated, truncate};
use palpate_geometry::math::{Point3, Pose, Random, Vector3};
use palpate_geometry::part::{BrepFace, Carrier};
use palpate_geometry::surface::{Surface, builtin, file};

/// Reference computed by another program, mm: bodies, volumes, places of the wall with their depths.
pub(super) fn reference() -> serde_json::Value {
    serde_json::from_str(include_str!("tests/ellipsoids.json")).unwrap()
}

pub(super) fn ellipsoids() -> [Surface; 2] {
    let all = reference();
    ["a", "b"].map(|name| file::read(&all[name].to_string()).unwrap())
}

pub(super) fn mapped(mut surface: Surface, f: impl Fn(&Point3) -> Point3) -> Surface {
    let points = surface.net_mut().points_mut();
    points.iter_mut().for_each(|p| *p = f(p));
    surface
}

pub(super) fn moved(surface: &Surface, by: [f64; 3]) -> Surface {
    surface.transformed(&Pose::translation(by[0], by[1], by[2]))
}

/// Exact: a NURBS.
pub(super) fn sphere(radius_m: f64, at: [f64; 3]) -> Surface {
    moved(&builtin("sphere", None, Some(radius_m)).unwrap(), at)
}

/// Exact, radii in m.
pub(super) fn ellipsoid(radii: [f64; 3]) -> Surface {
    mapped(sphere(1.0, [0.0; 3]), |p| {
        Point3::new(p.x * radii[0], p.y * radii[1], p.z * radii[2])
    })
}

/// A cubic ellipsoid of 3 to 8 cm with waves in all directions, turned somehow.
pub(super) fn knobbly(random: &mut Random) -> Surface {
    let [plain, _] = ellipsoids();
    let radii = [0; 3].map(|_| random.float(0.8, 1.3));
    let waves: Vec<(Vector3, f64)> = (0..3)
        .map(|_| (random.vector() * 120.0, random.float(0.0, 6.0)))
        .collect();
    let turn = random.rotation();
    mapped(plain, |p| {
        let high = |(k, phase): &(Vector3, f64)| 0.04 * libm::sin(k.dot(&p.coords) + phase);
        let grown = 1.0 + waves.iter().map(high).sum::<f64>();
        turn * Point3::new(p.x * radii[0], p.y * radii[1], p.z * radii[2]) * grown
    })
}

pub(super) fn truncated(a: &Surface, b: &Surface) -> Truncated {
    truncate(a, b, &TruncateSpec::default())
        .unwrap_or_else(|e| panic!("{e}"))
        .expect("they overlap")
}

/// The pieces of the wall, as they are in A′.
pub(super) fn walls(two: &Truncated) -> Vec<&Surface> {
    let faces = &two.breps[0].faces;
    let last = faces.len() - two.walls.len();
    fn spline(face: &BrepFace) -> &Surface {
        match &face.carrier {
            Carrier::Spline(surface) => surface,
            other => panic!("{other:?}"),
        }
    }
    faces[last..].iter().map(spline).collect()
}

/// Places of a wall, with its edges.
pub(super) fn places(wall: &Surface) -> impl Iterator<Item = Point3> + '_ {
    let steps = |n: u32| (0..=n).map(move |k| f64::from(k) / f64::from(n));
    steps(37).flat_map(move |u| steps(23).map(move |v| wall.point(u, v)))
}

/// Both parts together are the union, to a share of it.
pub(super) fn assert_union(two: &Truncated, share: f64) {
    let sum: f64 = two.volumes_m3.iter().sum();
    let union = two.union_m3();
    assert!(
        (sum - union).abs() <= share * union,
        "{sum} {union}: {two:?}"
    );
}
