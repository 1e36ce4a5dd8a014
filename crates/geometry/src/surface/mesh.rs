//! A plain triangle mesh: what drawing, printing and other programs take.

use crate::math::{Point3, Vector3, first_outside};

/// Triangles over shared corners.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// (corner count), m.
    pub points: Vec<Point3>,
    /// (corner count) unit outward normals; corners of a crease are doubled, one for each side.
    pub normals: Vec<Vector3>,
    /// Indices into `points`; counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A mesh whose normals are the means of those of its triangles, weighted with their areas;
    /// zero at a corner that only triangles without area have. `None` when a triangle names a
    /// corner that does not exist, or a coordinate is not within ±[`MOST_COORDINATE_M`](crate::math::MOST_COORDINATE_M).
    pub fn from_triangles(points: Vec<Point3>, triangles: Vec<[u32; 3]>) -> Option<Self> {
        if first_outside(&points).is_some() {
            return None;
        }
        let mut normals = vec![Vector3::zeros(); points.len()];
        for triangle in &triangles {
            let [a, b, c] = triangle.map(|k| points.get(k as usize));
            let (a, b, c) = (a?, b?, c?);
            let twice_area = (b - a).cross(&(c - a));
            triangle
                .iter()
                .for_each(|&k| normals[k as usize] += twice_area);
        }
        for normal in &mut normals {
            *normal = normal.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        }
        Some(Self {
            points,
            normals,
            triangles,
        })
    }
}
