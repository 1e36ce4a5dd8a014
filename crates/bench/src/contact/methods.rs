//! parry3d-f64 with a mesh of 82 × 82 vertices, refitted to the net before each query.

use crate::inputs::spread;
use palpate_geometry::contact::mesh::MeshTool;
use palpate_geometry::math::{Point3, Pose, Vector3};
use palpate_geometry::surface::{SampleGrid, Samples, Surface};
use palpate_thesis::spheres::Solid;
use parry3d_f64::glamx::{DPose3, DQuat, DVec3};
use parry3d_f64::query;
use parry3d_f64::shape::{Ball, HalfSpace, TriMesh, TriMeshFlags};

const COUNT: usize = 82;
/// Between two meshes parry has the depth of one triangle in another, which says nothing of solids:
/// its error shows that.
pub(super) const PARRY: &str = "parry mesh 82";

pub(super) struct Mesh {
    grid: SampleGrid,
    samples: Samples,
    vertices: Vec<DVec3>,
    mesh: TriMesh,
}

fn dvec(p: &Point3) -> DVec3 {
    DVec3::new(p.x, p.y, p.z)
}

fn posed(pose: &Pose) -> DPose3 {
    let (t, q) = (pose.translation.vector, pose.rotation.coords);
    DPose3::from_parts(
        DVec3::new(t.x, t.y, t.z),
        DQuat::from_xyzw(q.x, q.y, q.z, q.w),
    )
}

impl Mesh {
    pub fn new(surface: &Surface) -> Self {
        let domains = (surface.knots_u().domain(), surface.knots_v().domain());
        let grid = SampleGrid::new(
            surface,
            &spread(domains.0, COUNT),
            &spread(domains.1, COUNT),
        );
        let mut samples = grid.samples();
        grid.points_into(surface, &mut samples);
        let vertices: Vec<DVec3> = samples.points.iter().map(dvec).collect();
        let at = |i: usize, j: usize| (i * COUNT + j) as u32;
        let mut triangles = Vec::new();
        for i in 0..COUNT - 1 {
            for j in 0..COUNT - 1 {
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        if surface.flip_normal() {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let mesh = TriMesh::with_flags(vertices.clone(), triangles, TriMeshFlags::ORIENTED)
            .expect("a grid has triangles");
        Self {
            grid,
            samples,
            vertices,
            mesh,
        }
    }

    pub fn load(&mut self, surface: &Surface) {
        self.grid.points_into(surface, &mut self.samples);
        for (vertex, p) in self.vertices.iter_mut().zip(&self.samples.points) {
            *vertex = dvec(p);
        }
        self.mesh.set_vertices(&self.vertices);
    }

    pub fn ball(&self, centre: &Point3, radius_m: f64) -> Option<f64> {
        let contact = query::contact(
            &DPose3::IDENTITY,
            &self.mesh,
            &DPose3::from_translation(dvec(centre)),
            &Ball::new(radius_m),
            0.0,
        );
        contact.ok().flatten().map(|contact| -contact.dist)
    }

    pub fn plane(&self, origin: &Point3, normal: &Vector3) -> Option<f64> {
        let half = HalfSpace::new(DVec3::new(normal.x, normal.y, normal.z));
        let contact = query::contact(
            &DPose3::IDENTITY,
            &self.mesh,
            &DPose3::from_translation(dvec(origin)),
            &half,
            0.0,
        );
        contact.ok().flatten().map(|contact| -contact.dist)
    }

    pub fn other(&self, other: &Self, pose: &Pose) -> Option<f64> {
        let contact = query::contact(
            &DPose3::IDENTITY,
            &self.mesh,
            &posed(pose),
            &other.mesh,
            0.0,
        );
        contact.ok().flatten().map(|contact| -contact.dist)
    }
}

/// A mesh that is a tool, for both narrow phases.
pub(super) struct ToolMesh {
    pub tool: MeshTool,
}

/// The ball-shaped tool in triangles, so many cells a piece.
pub(super) fn ball_mesh(cells: [usize; 2]) -> ToolMesh {
    let mesh = super::inputs::tool(8)
        .tessellated(cells)
        .expect("a ball has triangles");
    ToolMesh {
        tool: MeshTool::new(&mesh.points, &mesh.triangles).expect("a ball is closed"),
    }
}

impl ToolMesh {
    /// The mesh at a pose.
    pub fn at<'a>(&'a self, pose: &'a Pose) -> Placed<'a> {
        Placed {
            tool: &self.tool,
            pose,
        }
    }
}

pub(super) struct Placed<'a> {
    tool: &'a MeshTool,
    pose: &'a Pose,
}

impl Solid for Placed<'_> {
    fn signed_gap(&self, point: &Point3) -> (f64, Vector3) {
        // There the unit vector leads into the matter, here out of it.
        let (gap_m, inward) = self.tool.signed_gap(self.pose, point);
        (gap_m, -inward)
    }

    fn bounded_gap(&self, point: &Point3) -> Option<f64> {
        Some(self.tool.signed_gap(self.pose, point).0)
    }

    fn may_meet_box(&self, low: &Point3, high: &Point3, margin_m: f64) -> bool {
        let (centre, reach) = (
            self.pose.translation.vector,
            super::inputs::TOOL_RADIUS_M + margin_m,
        );
        (0..3).all(|c| low[c] <= centre[c] + reach && high[c] >= centre[c] - reach)
    }
}
