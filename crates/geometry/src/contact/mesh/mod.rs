//! Tools given as a closed triangle mesh, or as a part: then triangles say where to look, and distances are those of the
//! part itself.
//!
//! ```text
//! check    merged, closed, oriented outwards, with a volume: or a reason why not
//! tree     distance to the triangles
//! solver   vertices inside the body and surface points inside the mesh, one contact of each region at least
//! ```

mod check;
mod solver;
#[cfg(test)]
mod tests;
mod tree;

use self::tree::{Near, Triangles};
use crate::contact::Features;
use crate::contact::balls::{Ball, BallTree, around};
use crate::contact::features::SHARP;
use crate::math::{Point3, Pose, Vector3};
use crate::part::{Part, PartMesh, TrianglesError};
use std::sync::Arc;

pub use check::MeshError;
pub use solver::MeshSolver;

/// Of the size of a part: how far its triangles are from it, and how many there are at most.
const TOLERANCE: f64 = 2e-4;
const MOST_TRIANGLES: usize = 200_000;

/// Vertices of one block, which are asked for after the balls around it.
const BLOCK: usize = 16;

/// A solid bounded by triangles, in the tool's frame.
#[derive(Clone)]
pub struct MeshTool {
    triangles: Triangles,
    /// Vertices, merged, in an order in which neighbours in the list are near each other, m.
    vertices: Vec<Point3>,
    /// Neighbours of vertex k: `neighbours[offsets[k]..offsets[k + 1]]`.
    offsets: Vec<u32>,
    neighbours: Vec<u32>,
    /// Around blocks of vertices.
    blocks: BallTree,
    features: Features,
    /// (triangles, or faces of a part): normal and its distance from the origin, m; of those whose sides all are sharp or level.
    planes: Vec<Option<(Vector3, f64)>>,
    volume_m3: f64,
    size_m: f64,
    /// What the triangles stand for.
    part: Option<Arc<Part>>,
    /// How far its triangles are from it, m.
    off_m: f64,
}

impl std::fmt::Debug for MeshTool {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MeshTool")
            .field("vertices", &self.vertices.len())
            .field("volume_m3", &self.volume_m3)
            .field("size_m", &self.size_m)
            .finish_non_exhaustive()
    }
}

impl MeshTool {
    /// Takes vertices (m, tool frame) and triangles over them. Vertices at the same place are
    /// merged, unused ones and triangles with a repeated corner left out; a mesh whose triangles
    /// all face inwards is turned.
    ///
    /// # Errors
    /// A mesh that bounds no volume, with what is wrong and where.
    pub fn new(vertices: &[Point3], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        let sound = check::check(vertices, triangles)?;
        let mut pairs: Vec<(u32, u32)> = sound
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
            .collect();
        // Closed: each edge comes once in each direction, so these are all neighbours of all
        // vertices.
        pairs.sort_unstable();
        let mut offsets = vec![0_u32; sound.vertices.len() + 1];
        pairs
            .iter()
            .for_each(|&(a, _)| offsets[a as usize + 1] += 1);
        for k in 1..offsets.len() {
            offsets[k] += offsets[k - 1];
        }
        let blocks = (sound.vertices.chunks(BLOCK))
            .map(|block| around(&block.iter().map(|p| (*p, 0.0)).collect::<Vec<_>>()));
        let blocks = BallTree::new(blocks);
        let (features, planes) = Self::sharp_features(&sound.vertices, &sound.triangles);
        Ok(Self {
            features,
            planes,
            triangles: Triangles::new(&sound.vertices, &sound.triangles, sound.size_m),
            offsets,
            neighbours: pairs.into_iter().map(|(_, b)| b).collect(),
            blocks,
            vertices: sound.vertices,
            volume_m3: sound.volume_m3,
            size_m: sound.size_m,
            part: None,
            off_m: 0.0,
        })
    }

    /// A closed part (m, in the tool's frame). Its triangles, within a 1/5000 of its size, are where contacts are looked
    /// for; how deep they are the part says.
    ///
    /// # Errors
    /// A part without an inside, or one whose triangles bound no volume.
    pub fn of_part(part: Arc<Part>) -> Result<Self, MeshError> {
        if !part.is_closed() {
            return Err(MeshError::OpenPart);
        }
        let refused = |e: TrianglesError| MeshError::Refused {
            reason: e.to_string(),
        };
        let tolerance_m = TOLERANCE * part.size_m();
        let PartMesh {
            mesh, deviation_m, ..
        } = part
            .triangles(tolerance_m, MOST_TRIANGLES)
            .or_else(|_| part.triangles(16.0 * tolerance_m, MOST_TRIANGLES))
            .map_err(refused)?;
        let mut tool = Self::new(&mesh.points, &mesh.triangles)?;
        tool.features = Features::of_part(&part);
        tool.planes = part.planes(SHARP);
        // It is measured in the middle of triangles and of their sides.
        tool.off_m = 2.0 * deviation_m + part.gap_m();
        tool.part = Some(part);
        Ok(tool)
    }

    /// The part, if it is one.
    pub fn part(&self) -> Option<&Part> {
        self.part.as_deref()
    }

    /// Volume, m³.
    pub fn volume_m3(&self) -> f64 {
        self.volume_m3
    }

    /// Distance from the reference point that holds all of the mesh, m.
    pub fn reach_m(&self) -> f64 {
        self.vertices
            .iter()
            .map(|p| p.coords.norm())
            .fold(0.0, f64::max)
    }

    /// Diagonal of the box of the vertices, m.
    pub fn size_m(&self) -> f64 {
        self.size_m
    }

    /// Vertices after merging, m, tool frame.
    pub fn vertices(&self) -> &[Point3] {
        &self.vertices
    }

    /// Triangles over [`MeshTool::vertices`], counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.triangles.indices()
    }

    /// Signed distance of a point of the tool's frame to the triangles, m, negative inside, and the unit
    /// way out of the mesh there. A point that is not finite is infinitely far.
    pub fn signed_distance(&self, p: &Point3) -> (f64, Vector3) {
        if !p.iter().all(|x| x.is_finite()) {
            return (f64::INFINITY, Vector3::z());
        }
        let foot = self.triangles.foot(p, &mut Near::default());
        (foot.gap_m, foot.out)
    }

    /// Gap of a world point to the mesh at a pose, m, and the unit vector towards the mesh's
    /// matter.
    pub fn signed_gap(&self, pose: &Pose, point: &Point3) -> (f64, Vector3) {
        let (gap_m, out) = self.signed_distance(&pose.inverse_transform_point(point));
        (gap_m, -(pose.rotation * out))
    }

    /// Edges sharper than 1° that stand out, and their ends.
    pub fn features(&self) -> &Features {
        &self.features
    }

    /// A ball around all of it.
    fn ball(&self) -> Ball {
        let root = self.blocks.root().map(|root| self.blocks.ball(root));
        root.unwrap_or((Point3::origin(), f64::INFINITY))
    }

    /// A vertex is outside by more than the margin, or one beside it is deeper, as two points tell from their gaps, m, one
    /// out of the body and one into it.
    fn is_passed(&self, vertex: usize, [out, into]: [(Point3, f64); 2], margin_m: f64) -> bool {
        let p = &self.vertices[vertex];
        let least_m = out.1 - (p - out.0).norm() - 1e-12 * self.size_m;
        let most_m = |&k: &u32| into.1 + (self.vertices[k as usize] - into.0).norm();
        least_m > margin_m || self.neighbours(vertex).iter().any(|k| most_m(k) < least_m)
    }

    fn neighbours(&self, vertex: usize) -> &[u32] {
        &self.neighbours[self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize]
    }
}
