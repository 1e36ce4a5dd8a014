//! parry's triangle mesh behind our types.
//!
//! Its tree is walked with a stack of 32 entries before it would allocate; what is kept there is
//! one sibling a level, so a tree of at most that depth never does. Signs come from its
//! angle-weighted normals of vertices and edges (Bærentzen & Aanæs 2005).

use parry3d_f64::glamx::DVec3;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::{TriMesh, TriMeshFlags};

use super::MeshError;
use crate::math::{Point3, Vector3};

/// Entries of parry's stack on the stack.
const DEPTH: u32 = 32;

#[derive(Clone)]
pub(super) struct Triangles(TriMesh);

fn there(p: &Point3) -> DVec3 {
    DVec3::new(p.x, p.y, p.z)
}

fn back(v: DVec3) -> Vector3 {
    Vector3::new(v.x, v.y, v.z)
}

impl Triangles {
    /// Of a checked mesh.
    pub fn new(vertices: &[Point3], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        let points = vertices.iter().map(there).collect();
        let mesh = TriMesh::with_flags(points, triangles.to_vec(), TriMeshFlags::ORIENTED)
            .map_err(|error| MeshError::Refused {
                reason: error.to_string(),
            })?;
        let depth = mesh.bvh().subtree_depth(0);
        if depth > DEPTH {
            return Err(MeshError::Refused {
                reason: format!("its tree of boxes is {depth} deep, above {DEPTH}"),
            });
        }
        Ok(Self(mesh))
    }

    /// Corners of each triangle.
    pub fn indices(&self) -> &[[u32; 3]] {
        self.0.indices()
    }

    /// The triangle that is nearest to a finite point.
    pub fn nearest(&self, p: &Point3) -> usize {
        let (_, (triangle, _)) = self.0.project_local_point_and_get_location(there(p), false);
        triangle as usize
    }

    /// Signed distance and way out; closer than `near_m` the way is the triangle's normal.
    pub fn signed_distance(&self, p: &Point3, near_m: f64) -> (f64, Vector3) {
        if !p.iter().all(|x| x.is_finite()) {
            return (f64::INFINITY, Vector3::z());
        }
        let (projection, (triangle, _)) =
            self.0.project_local_point_and_get_location(there(p), false);
        let way = p.coords - back(projection.point);
        let distance = way.norm();
        let sign = if projection.is_inside { -1.0 } else { 1.0 };
        let out = if distance > near_m {
            way * (sign / distance)
        } else {
            back(self.0.triangle(triangle).scaled_normal())
                .try_normalize(0.0)
                .unwrap_or_else(Vector3::z)
        };
        (sign * distance, out)
    }
}
