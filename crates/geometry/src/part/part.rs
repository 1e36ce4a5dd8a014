//! A part: edges with their gaps, faces with their loops, corners.

use super::carrier::Carrier;
use super::curve::{CurveProblem, EdgeCurve};
use super::pcurve::PCurve;
use super::senses::Senses;
use super::tree::{Corners, Tree};
use super::trim::{Trim, TrimProblem};
use crate::math::{Point3, Vector3};

/// Why a boundary makes no part.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PartError {
    /// No faces.
    #[error("the part has no faces")]
    Empty,
    /// An edge without extent, or too high a degree.
    #[error("edge #{id}: {source}")]
    Edge {
        /// In the file.
        id: u64,
        /// What is wrong.
        source: CurveProblem,
    },
    /// Farther off than the file may be.
    #[error(
        "edge #{edge} is {gap_m:.3e} m off face #{face}, more than the {most_m:.1e} m that an edge may be"
    )]
    OffSurface {
        /// In the file.
        edge: u64,
        /// In the file.
        face: u64,
        /// As measured, m.
        gap_m: f64,
        /// As allowed, m.
        most_m: f64,
    },
    /// Loops that bound nothing.
    #[error("face #{id}: {source}")]
    Face {
        /// In the file.
        id: u64,
        /// What is wrong.
        source: TrimProblem,
    },
}

/// One of the two uses of an edge.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Side {
    pub face: u32,
    /// Who walks from the edge's first vertex to its last, on the side of the face's normal, has the face on the left.
    pub forward: bool,
    /// On B-splines.
    pub pcurve: Option<PCurve>,
}

/// An edge between faces.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Edge {
    pub id: u64,
    pub curve: EdgeCurve,
    pub ends: [u32; 2],
    pub sides: Vec<Side>,
    pub gap_m: f64,
}

/// A trimmed piece of a carrier.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Face {
    pub id: u64,
    pub carrier: Carrier,
    pub same_sense: bool,
    pub trim: Trim,
    /// Outside which nothing of it is.
    pub range_u: [f64; 2],
    pub loops: usize,
    /// Where a B-spline ends, and is more than a pole: at the start and the end of u and of v.
    pub rims: [[bool; 2]; 2],
}

/// Where edges meet, or a cone ends.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Vertex {
    pub point: Point3,
    /// Σ αᵢ nᵢ over the faces that meet there.
    pub normal: Vector3,
    /// One of them.
    pub face: Option<u32>,
    /// No edge ends here: the apex of a cone.
    pub lone: bool,
    pub gap_m: f64,
}

/// What CAD systems write: trimmed faces that share edges; rigid, m.
#[derive(Clone, Debug)]
pub struct Part {
    pub(super) edges: Vec<Edge>,
    pub(super) faces: Vec<Face>,
    pub(super) vertices: Vec<Vertex>,
    /// Over edges, then lone vertices.
    pub(super) wires: Tree,
    pub(super) skin: Tree,
    /// Vertices of `wires` past the edges.
    pub(super) lone: Vec<u32>,
    pub(super) closed: bool,
    pub(super) bounds: Corners,
    pub(super) gap_m: f64,
    pub(super) senses: Senses,
}

/// What is said of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceInfo<'a> {
    /// `#id` in the file.
    pub id: u64,
    /// What it lies on.
    pub carrier: &'a Carrier,
    /// Loops of edges that bound it, seams left out.
    pub loops: usize,
}

impl Part {
    /// Its faces, in the order of the file's shells.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = FaceInfo<'_>> {
        self.faces.iter().map(|face| FaceInfo {
            id: face.id,
            carrier: &face.carrier,
            loops: face.loops,
        })
    }

    /// How many edges lie between its faces; seams are none.
    pub fn edge_count(&self) -> usize {
        self.edges
            .iter()
            .filter(|edge| !edge.sides.is_empty())
            .count()
    }

    /// Corners of a box around it, m.
    pub fn bounds(&self) -> (Point3, Point3) {
        self.bounds
    }

    /// Diagonal of that box, m.
    pub fn size_m(&self) -> f64 {
        (self.bounds.1 - self.bounds.0).norm()
    }

    /// The farthest that an edge is from its faces or its ends, m.
    pub fn gap_m(&self) -> f64 {
        self.gap_m
    }

    /// It has an inside: the file calls all its shells closed, and the faces at every edge go on into each other.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Faces whose sense or loops are not as the file says: there, they do not agree with the faces beside, or the shell is
    /// inside out.
    pub fn turned_faces(&self) -> usize {
        self.senses.turned.len()
    }

    /// Which faces are turned, and why there is no inside where the file says that there is one.
    pub fn senses(&self) -> &Senses {
        &self.senses
    }
}

impl Face {
    /// Unit normal of the face, out of the matter.
    pub fn normal(&self, uv: [f64; 2]) -> Vector3 {
        let normal = self.carrier.normal(uv);
        if self.same_sense { normal } else { -normal }
    }
}

impl Edge {
    /// Parameters of one of its faces at a place of the edge.
    pub fn on(&self, side: &Side, faces: &[Face], at: (usize, f64)) -> Option<[f64; 2]> {
        match &side.pcurve {
            Some(pcurve) => Some(pcurve.at(at)),
            None => faces[side.face as usize]
                .carrier
                .foot(&self.curve.point(at)),
        }
    }

    /// Normals of its faces at a place, added.
    pub fn normal(&self, faces: &[Face], at: (usize, f64)) -> Vector3 {
        let normals = self.sides.iter().filter_map(|side| {
            let uv = self.on(side, faces, at)?;
            let face = &faces[side.face as usize];
            Some(face.normal(face.trim.chart.confined(uv)))
        });
        normals.sum()
    }
}
