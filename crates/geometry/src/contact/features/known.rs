//! The features of shapes that are given by sizes or triangles.

use super::{Edge, Features, SHARP};
use crate::contact::implicit::ImplicitShape;
use crate::contact::mesh::MeshTool;
use crate::math::{Point3, Vector3};

/// The sine of an angle that is none.
const LEVEL: f64 = 1e-9;

impl ImplicitShape {
    /// Corners and edges; those of a function are found by [`ImplicitTool::with_edges_found`](crate::contact::implicit::ImplicitTool::with_edges_found).
    pub fn features(&self) -> Features {
        match *self {
            Self::Cylinder {
                radius_m,
                half_length_m: Some(half),
            } => Features {
                corners: Vec::new(),
                edges: [half, -half].map(|z| Edge::Circle { z, radius_m }).into(),
            },
            Self::Cone {
                half_angle_rad,
                height_m,
            } => Features {
                corners: vec![Point3::origin()],
                edges: vec![Edge::Circle {
                    z: height_m,
                    radius_m: height_m * libm::tan(half_angle_rad),
                }],
            },
            // No edges, but the rings on which it lies.
            Self::Torus {
                major_radius_m,
                minor_radius_m,
            } => Features {
                corners: Vec::new(),
                edges: [minor_radius_m, -minor_radius_m]
                    .map(|z| Edge::Circle {
                        z,
                        radius_m: major_radius_m,
                    })
                    .into(),
            },
            Self::Box { half_extents_m } => cuboid(&half_extents_m),
            Self::Sphere { .. }
            | Self::Cylinder { .. }
            | Self::Ellipsoid { .. }
            | Self::Expression { .. } => Features::default(),
        }
    }
}

fn cuboid(half_m: &[f64; 3]) -> Features {
    let sign = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
    let corner = |k| Point3::from(std::array::from_fn(|axis| sign(k, axis) * half_m[axis]));
    let corners: Vec<Point3> = (0..8).map(corner).collect();
    let along = |axis: usize| {
        (0..8)
            .filter(move |k| k >> axis & 1 == 0)
            .map(move |k| [k, k | 1 << axis])
    };
    let edges = (0..3)
        .flat_map(along)
        .map(|ends| segment(&corners, ends))
        .collect();
    Features { corners, edges }
}

fn segment(corners: &[Point3], ends: [usize; 2]) -> Edge {
    Edge::Segment {
        ends: ends.map(|k| corners[k]),
        corners: ends,
    }
}

impl MeshTool {
    /// Edges that are sharper than 1° and stand out with the vertices in which they end, and the planes of triangles
    /// that end in sharp edges or go on level: normal and its distance from the origin, m.
    pub(in crate::contact) fn sharp_features(
        vertices: &[Point3],
        triangles: &[[u32; 3]],
    ) -> (Features, Vec<Option<(Vector3, f64)>>) {
        // Both sides of an edge, from its lower vertex to its higher.
        let mut sides = Vec::with_capacity(3 * triangles.len());
        let mut planes = Vec::with_capacity(triangles.len());
        for (t, &[a, b, c]) in triangles.iter().enumerate() {
            let [p, q, r] = [a, b, c].map(|k| vertices[k as usize]);
            let normal = (q - p).cross(&(r - p)).normalize();
            planes.push(Some((normal, normal.dot(&p.coords))));
            for (from, to, across) in [(a, b, r), (b, c, p), (c, a, q)] {
                let ends = [from.min(to), from.max(to)];
                sides.push(MeshSide {
                    ends,
                    triangle: t,
                    normal,
                    across,
                });
            }
        }
        sides.sort_by_key(|side| side.ends);
        let mut names = vec![usize::MAX; vertices.len()];
        let mut corners = Vec::new();
        let mut edges = Vec::new();
        for pair in sides.chunk_by(|a, b| a.ends == b.ends) {
            let [one, other] = pair else {
                continue;
            };
            let cosine = one.normal.dot(&other.normal);
            if cosine >= SHARP {
                if one.normal.cross(&other.normal).norm() > LEVEL {
                    planes[one.triangle] = None;
                    planes[other.triangle] = None;
                }
                continue;
            }
            let start = vertices[one.ends[0] as usize];
            if (other.across - start).dot(&one.normal) >= 0.0 {
                continue;
            }
            let ends = one.ends.map(|vertex| {
                let name = &mut names[vertex as usize];
                if *name == usize::MAX {
                    *name = corners.len();
                    corners.push(vertices[vertex as usize]);
                }
                *name
            });
            edges.push(segment(&corners, ends));
        }
        (Features { corners, edges }, planes)
    }
}

/// An edge as one of its two triangles has it.
struct MeshSide {
    /// Vertices, the lower first.
    ends: [u32; 2],
    triangle: usize,
    /// Of the triangle, outwards.
    normal: Vector3,
    /// Its third vertex, m.
    across: Point3,
}
