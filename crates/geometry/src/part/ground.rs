//! Faces, edges and corners of a part as searches over it walk on them.

use super::carrier::Carrier;
use super::fan::{fans, frame, same_places};
use super::part::{Edge, Part};
use crate::math::{Point3, Vector3};
use std::f64::consts::FRAC_PI_6;

/// Of the size: how far from a corner its neighbourhood is looked at.
const STEP: f64 = 1e-4;
/// Of the size: corners nearer to each other are one.
const SAME: f64 = 1e-9;
/// Directions around an apex.
const AROUND: usize = 8;
/// Of the size: a cell of a face is about as long; so many cells at least and at most in each direction.
const CELL: f64 = 1.0 / 12.0;
const CELLS: [f64; 2] = [3.0, 16.0];
/// Cells of each span of a B-spline, and most of them in each direction.
const CELLS_OF_SPAN: usize = 3;
const MOST_CELLS: usize = 48;
/// Looks along an end of a domain.
const LOOKS: usize = 16;

/// A face.
#[derive(Clone, Copy)]
pub(crate) struct FaceGround<'a> {
    part: &'a Part,
    face: u32,
}

impl FaceGround<'_> {
    /// A rectangle of parameters that holds the face: least and greatest u, least and greatest v.
    pub fn range(&self) -> [[f64; 2]; 2] {
        let trim = &self.part.faces[self.face as usize].trim;
        let mut range = trim.extent();
        let Some(domain) = trim.chart.domain else {
            return range;
        };
        // A face may go on to an end of the domain without an edge there: where it is a point, or closes.
        for d in 0..2 {
            for end in 0..2 {
                let [low, high] = domain[1 - d];
                let reached = (0..LOOKS).any(|k| {
                    let mut uv = [domain[d][end]; 2];
                    uv[1 - d] = low + (high - low) * (k as f64 + 0.5) / LOOKS as f64;
                    trim.contains(uv)
                });
                if reached || !range[d][end].is_finite() {
                    range[d][end] = domain[d][end];
                }
            }
        }
        range
    }

    /// u, or v, goes round and comes back.
    pub fn wraps(&self) -> [bool; 2] {
        let periods = self.part.faces[self.face as usize].carrier.periods();
        let range = self.range();
        std::array::from_fn(|k| {
            let [low, high] = range[k];
            periods[k] > 0.0 && high - low >= periods[k] * (1.0 - 1e-12)
        })
    }

    /// At the least and the greatest u, and v, all points are one.
    pub fn poles(&self) -> [[bool; 2]; 2] {
        let face = &self.part.faces[self.face as usize];
        let range = self.range();
        if let (Carrier::Spline(surface), Some(domain)) = (&face.carrier, face.trim.chart.domain) {
            let poles = surface.topology().poles;
            return [0, 1]
                .map(|d| [0, 1].map(|end| poles[d][end] && range[d][end] == domain[d][end]));
        }
        let poles = face.trim.chart.poles();
        [
            [false; 2],
            [0, 1].map(|end| poles[end] == Some(range[1][end])),
        ]
    }

    /// Into how many cells its rectangle is to be divided, so that a cell is bent by 30° at most.
    pub fn cells(&self) -> [usize; 2] {
        let [u, v] = self.range();
        if let Carrier::Spline(surface) = &self.part.faces[self.face as usize].carrier {
            let knots = [surface.knots_u(), surface.knots_v()];
            return knots.map(|knots| (CELLS_OF_SPAN * knots.spans().count()).min(MOST_CELLS));
        }
        let cell_m = CELL * self.part.size_m();
        let middle = |[a, b]: [f64; 2]| 0.5 * (a + b);
        let length = |along: usize| {
            let at = |t: f64| match along {
                0 => self.point([u[0] + t * (u[1] - u[0]), middle(v)]),
                _ => self.point([middle(u), v[0] + t * (v[1] - v[0])]),
            };
            let steps = (0..8).map(|k| (at((k + 1) as f64 / 8.0) - at(k as f64 / 8.0)).norm());
            steps.sum::<f64>()
        };
        let angles = match &self.part.faces[self.face as usize].carrier {
            Carrier::Plane(_) | Carrier::Spline(_) => [0.0; 2],
            Carrier::Cylinder { .. } | Carrier::Cone { .. } => [u[1] - u[0], 0.0],
            Carrier::Sphere { .. } | Carrier::Torus { .. } => [u[1] - u[0], v[1] - v[0]],
        };
        [0, 1].map(|k| {
            let long = (length(k) / cell_m).clamp(CELLS[0], CELLS[1]);
            long.max(angles[k] / FRAC_PI_6).ceil() as usize
        })
    }

    /// The point at parameters, m.
    pub fn point(&self, uv: [f64; 2]) -> Point3 {
        self.part.faces[self.face as usize].carrier.point(uv)
    }

    /// Parameters belong to the face.
    pub fn has(&self, uv: [f64; 2]) -> bool {
        self.part.faces[self.face as usize].trim.contains(uv)
    }
}

/// An edge, with places from 0 to the number of its segments.
#[derive(Clone, Copy)]
pub(crate) struct EdgeGround<'a> {
    part: &'a Part,
    edge: u32,
}

impl EdgeGround<'_> {
    fn edge(&self) -> &Edge {
        &self.part.edges[self.edge as usize]
    }

    /// Where its places end.
    pub fn segments(&self) -> usize {
        self.edge().curve.segments()
    }

    /// It is straight.
    pub fn is_line(&self) -> bool {
        self.edge().curve.is_line()
    }

    fn at(&self, place: f64) -> (usize, f64) {
        let segment = (place.max(0.0) as usize).min(self.segments() - 1);
        (segment, place - segment as f64)
    }

    /// The point at a place, m.
    pub fn point(&self, place: f64) -> Point3 {
        self.edge().curve.point(self.at(place))
    }

    /// As a place of the part.
    pub fn place(&self, place: f64) -> [f64; 2] {
        let (face, uv) = self.part.beside_edge(self.edge, self.at(place));
        self.part.place(face, uv)
    }

    /// So many fixed places of a round edge.
    pub fn round(&self, count: usize) -> impl Iterator<Item = f64> + '_ {
        let curve = &self.edge().curve;
        curve.round(count).map(|(segment, t)| segment as f64 + t)
    }

    /// Unit vectors from a place into the faces beside it, in their tangent planes.
    pub fn inward(&self, place: f64) -> impl Iterator<Item = Vector3> + '_ {
        let at = self.at(place);
        let edge = self.edge();
        let tangent = edge.curve.slope(at).try_normalize(f64::MIN_POSITIVE);
        edge.sides.iter().filter_map(move |side| {
            let (_, _, inward) = frame(self.part, edge, side, at, &tangent?)?;
            Some(inward)
        })
    }

    /// The vertices at its ends; `None` of an edge that comes back.
    pub fn ends(&self) -> Option<[u32; 2]> {
        let ends = self.edge().ends;
        (ends[0] != ends[1]).then_some(ends)
    }
}

/// An edge, or a vertex that no edge reaches.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Wire {
    Edge(u32),
    Vertex(u32),
}

/// Where edges meet, or an apex.
#[derive(Clone, Debug)]
pub(crate) struct CornerGround {
    /// m.
    pub point: Point3,
    /// As a place of the part.
    pub place: [f64; 2],
    /// From it to points close by, on the faces and edges that end there, m.
    pub beside: Vec<Vector3>,
}

impl Part {
    pub(crate) fn face_ground(&self, face: u32) -> FaceGround<'_> {
        FaceGround { part: self, face }
    }

    /// Looks at faces whose boxes (least and greatest corner, m), and those around them, pass.
    pub(crate) fn passing_faces(
        &self,
        passes: impl Fn(&Point3, &Point3) -> bool,
        look: impl FnMut(u32),
    ) {
        self.skin.passing(|(low, high)| passes(low, high), look);
    }

    /// As [`Part::passing_faces`], of edges and of vertices that no edge reaches.
    pub(crate) fn passing_wires(
        &self,
        passes: impl Fn(&Point3, &Point3) -> bool,
        mut look: impl FnMut(Wire),
    ) {
        let edges = self.edges.len();
        self.wires.passing(
            |(low, high)| passes(low, high),
            |item| {
                look(match self.edges.get(item as usize) {
                    Some(_) => Wire::Edge(item),
                    None => Wire::Vertex(self.lone[item as usize - edges]),
                });
            },
        );
    }

    pub(crate) fn edge_ground(&self, edge: u32) -> EdgeGround<'_> {
        EdgeGround { part: self, edge }
    }

    /// By edge, whether it lies between faces, or at the rim of one: seams do not.
    pub(crate) fn edges(&self) -> impl Iterator<Item = bool> + '_ {
        self.edges.iter().map(|edge| !edge.sides.is_empty())
    }

    /// Its corners, of several at one place one; and by vertex which of them it is.
    pub(crate) fn corners(&self) -> (Vec<CornerGround>, Vec<Option<u32>>) {
        let size_m = self.size_m();
        let first = same_places(self, SAME * size_m);
        let fans = fans(self, &first, STEP * size_m);
        let mut corners = Vec::new();
        let mut of_vertex: Vec<Option<u32>> = Vec::with_capacity(fans.len());
        for (v, fan) in (0..).zip(&fans) {
            // No vertex comes before the first at its place.
            if first[v as usize] != v {
                of_vertex.push(of_vertex[first[v as usize] as usize]);
                continue;
            }
            let beside = match (&fan.apex, fan.beside.is_empty()) {
                (Some((axis, slopes)), true) => around(axis, *slopes, STEP * size_m),
                _ => fan.beside.clone(),
            };
            of_vertex.push((!beside.is_empty()).then_some(corners.len() as u32));
            if beside.is_empty() {
                continue;
            }
            let (face, uv) = match fan.corners.first() {
                Some(corner) => (corner.face, corner.uv),
                None => self.beside_vertex(v),
            };
            corners.push(CornerGround {
                point: self.vertices[v as usize].point,
                place: self.place(face, uv),
                beside,
            });
        }
        (corners, of_vertex)
    }
}

/// Steps from an apex down lines around an axis, of which the sine and the cosine of the angle to it are given.
fn around(axis: &Vector3, [sin, cos]: [f64; 2], step_m: f64) -> Vec<Vector3> {
    let across = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
    let beside = axis.cross(&across);
    let directions = (0..AROUND).map(|k| {
        let angle = std::f64::consts::TAU * k as f64 / AROUND as f64;
        let (s, c) = libm::sincos(angle);
        (axis * cos + (across * c + beside * s) * sin) * step_m
    });
    directions.collect()
}
