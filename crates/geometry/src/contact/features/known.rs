//! The features of shapes that are given by sizes or triangles.

use super::{Edge, Features};
use crate::contact::implicit::ImplicitShape;
use crate::contact::mesh::MeshTool;
use crate::math::{Point3, Vector3};

/// Sides of a mesh that meet at less than this angle are one smooth side: the cosine of 1°.
const SHARP: f64 = 0.999_847_695_156_391_3;

impl ImplicitShape {
    /// Corners and edges; of an expression none are known.
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
    /// Edges that are sharper than 1° and stand out, and the vertices in which they end.
    pub(in crate::contact) fn sharp_features(
        vertices: &[Point3],
        triangles: &[[u32; 3]],
    ) -> Features {
        // Both sides of an edge, from its lower vertex to its higher.
        let mut sides: Vec<([u32; 2], Vector3, Point3)> = Vec::with_capacity(3 * triangles.len());
        for &[a, b, c] in triangles {
            let [p, q, r] = [a, b, c].map(|k| vertices[k as usize]);
            let normal = (q - p).cross(&(r - p)).normalize();
            for (from, to, across) in [(a, b, r), (b, c, p), (c, a, q)] {
                sides.push(([from.min(to), from.max(to)], normal, across));
            }
        }
        sides.sort_by_key(|side| side.0);
        let mut names = vec![usize::MAX; vertices.len()];
        let mut corners = Vec::new();
        let mut edges = Vec::new();
        for pair in sides.chunk_by(|a, b| a.0 == b.0) {
            let [(ends, normal, _), (_, other, across)] = pair else {
                continue;
            };
            let stands_out = (across - vertices[ends[0] as usize]).dot(normal) < 0.0;
            if normal.dot(other) >= SHARP || !stands_out {
                continue;
            }
            let ends = ends.map(|vertex| {
                let name = &mut names[vertex as usize];
                if *name == usize::MAX {
                    *name = corners.len();
                    corners.push(vertices[vertex as usize]);
                }
                *name
            });
            edges.push(segment(&corners, ends));
        }
        Features { corners, edges }
    }
}
