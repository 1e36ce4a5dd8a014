//! Triangles of simple solids, as viewers draw them: closed, counter-clockwise seen from outside, in
//! metres around the tool's reference point.

use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Mesh;
use std::f64::consts::PI;

/// Most triangles of a shape that is sampled.
pub(super) const MOST_TRIANGLES: usize = 5_000;
/// Corners of a circle: the chords of as many stay within 0.3 % of the radius.
const CORNERS: usize = 40;

/// No triangles.
pub(super) fn nothing() -> Mesh {
    Mesh {
        points: Vec::new(),
        normals: Vec::new(),
        triangles: Vec::new(),
    }
}

fn mesh(points: Vec<Point3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::from_triangles(points, triangles).unwrap_or_else(nothing)
}

/// Cosine and sine from −π/2 to π/2, both ends and the middle exact.
pub(super) fn half_circle() -> impl Iterator<Item = [f64; 2]> {
    (0..=CORNERS / 2).map(|k| match k {
        0 => [0.0, -1.0],
        k if 4 * k == CORNERS => [1.0, 0.0],
        k if 2 * k == CORNERS => [0.0, 1.0],
        k => {
            let (sine, cosine) = libm::sincos(2.0 * PI * k as f64 / CORNERS as f64 - 0.5 * PI);
            [cosine, sine]
        }
    })
}

/// An ellipsoid with semi-axes along x, y, z.
pub(super) fn ellipsoid([a, b, c]: [f64; 3]) -> Mesh {
    let unit = revolved(&half_circle().collect::<Vec<_>>());
    let scaled = unit
        .points
        .iter()
        .map(|p| Point3::new(a * p.x, b * p.y, c * p.z));
    mesh(scaled.collect(), unit.triangles)
}

/// A cuboid.
pub(super) fn cuboid(half: [f64; 3]) -> Mesh {
    let corner = |k: usize| {
        let side = |axis: usize| {
            if k >> axis & 1 == 0 {
                -half[axis]
            } else {
                half[axis]
            }
        };
        Point3::new(side(0), side(1), side(2))
    };
    let mut triangles = Vec::with_capacity(12);
    for axis in 0..3 {
        // x, y, z in this order or turned, so that the cross product of the next two is the axis.
        let (u, v, side) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3), 1 << axis);
        triangles.push([side, side | u, side | u | v]);
        triangles.push([side, side | u | v, side | v]);
        triangles.push([0, u | v, u]);
        triangles.push([0, v, u | v]);
    }
    mesh((0..8).map(corner).collect(), triangles)
}

/// The solid that a profile of radius and height bounds when it is turned around z. The profile goes
/// upwards along the outside and begins and ends on the axis.
pub(super) fn revolved(profile: &[[f64; 2]]) -> Mesh {
    revolve(profile, false)
}

/// A ring around z: the part of a tube that is not inside it.
pub(super) fn ring(major: f64, minor: f64) -> Mesh {
    let circle = |k: usize| {
        let (sine, cosine) = libm::sincos(2.0 * PI * k as f64 / CORNERS as f64);
        [major + minor * cosine, minor * sine]
    };
    if minor < major {
        return revolve(&(0..CORNERS).map(circle).collect::<Vec<_>>(), true);
    }
    // The tube meets itself on the axis, at ± this height.
    let height = (minor * minor - major * major).sqrt();
    let outside = (0..CORNERS)
        .map(|k| circle((k + CORNERS / 2) % CORNERS))
        .filter(|[r, _]| *r > 0.0);
    let ends = ([0.0, -height], [0.0, height]);
    let profile = std::iter::once(ends.0).chain(outside).chain([ends.1]);
    revolve(&profile.collect::<Vec<_>>(), false)
}

/// One ring of corners for each point of the profile, a single corner for one on the axis.
fn revolve(profile: &[[f64; 2]], closed: bool) -> Mesh {
    let mut points: Vec<Point3> = Vec::new();
    let mut rings: Vec<(u32, bool)> = Vec::with_capacity(profile.len());
    for &[r, z] in profile {
        let on_axis = r == 0.0;
        rings.push((points.len() as u32, on_axis));
        for k in 0..if on_axis { 1 } else { CORNERS } {
            let (sine, cosine) = libm::sincos(2.0 * PI * k as f64 / CORNERS as f64);
            points.push(Point3::from(Vector3::new(r * cosine, r * sine, z)));
        }
    }
    let corner = |(start, on_axis): (u32, bool), k: usize| {
        if on_axis {
            start
        } else {
            start + (k % CORNERS) as u32
        }
    };
    let mut triangles = Vec::new();
    let last = if closed { rings.len() } else { rings.len() - 1 };
    for i in 0..last {
        let (below, above) = (rings[i], rings[(i + 1) % rings.len()]);
        for k in 0..CORNERS {
            let [a, b] = [corner(below, k), corner(below, k + 1)];
            let [d, c] = [corner(above, k), corner(above, k + 1)];
            if a != b {
                triangles.push([a, b, c]);
            }
            if c != d {
                triangles.push([a, c, d]);
            }
        }
    }
    mesh(points, triangles)
}
