//! parry3d-f64: a triangle mesh of 82 × 82 samples with a tree of boxes. Exact for the mesh, not
//! for the surface.

use super::Peer;
use crate::inputs::spread;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{SampleGrid, Samples, Surface};
use parry3d_f64::glamx::DVec3;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::TriMesh;

const COUNT: usize = 82;

pub(super) struct Parry {
    grid: SampleGrid,
    samples: Samples,
    vertices: Vec<DVec3>,
    mesh: TriMesh,
}

impl Parry {
    pub fn new(surface: &Surface) -> Self {
        let domains = (surface.knots_u().domain(), surface.knots_v().domain());
        let grid = SampleGrid::new(
            surface,
            &spread(domains.0, COUNT),
            &spread(domains.1, COUNT),
        );
        let mut samples = grid.samples();
        grid.points_into(surface, &mut samples);
        let vertices: Vec<DVec3> = samples
            .points
            .iter()
            .map(|p| DVec3::new(p.x, p.y, p.z))
            .collect();
        let at = |i: usize, j: usize| (i * COUNT + j) as u32;
        let mut triangles = Vec::new();
        for i in 0..COUNT - 1 {
            for j in 0..COUNT - 1 {
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        let mesh = TriMesh::new(vertices.clone(), triangles).expect("a grid has triangles");
        Self {
            grid,
            samples,
            vertices,
            mesh,
        }
    }
}

impl Peer for Parry {
    fn name(&self) -> &'static str {
        "parry3d-f64, mesh 82 × 82"
    }

    fn closest(&mut self, q: &Point3, _: bool) -> Option<Point3> {
        let foot = self
            .mesh
            .project_local_point(DVec3::new(q.x, q.y, q.z), false)
            .point;
        Some(Point3::new(foot.x, foot.y, foot.z))
    }

    fn moved(&mut self, surface: &Surface) {
        self.grid.points_into(surface, &mut self.samples);
        for (vertex, p) in self.vertices.iter_mut().zip(&self.samples.points) {
            *vertex = DVec3::new(p.x, p.y, p.z);
        }
        self.mesh.set_vertices(&self.vertices);
    }

    fn grid(&mut self, _: &[f64], _: &[f64], _: &mut [Point3], _: &mut [Vector3]) -> bool {
        false
    }
}
