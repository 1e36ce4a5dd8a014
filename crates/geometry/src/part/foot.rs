//! Places of a part that queries find: on which face, edge or vertex, and what is said of them.

use super::part::{Edge, Part};
use super::tree::Tree;
use crate::math::{Point3, Vector3};

/// On which the closest point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// Inside a face, by index.
    Face(u32),
    /// Between two faces, by index of the edge.
    Edge(u32),
    /// Where edges meet, or the apex of a cone, by index.
    Vertex(u32),
}

impl Support {
    /// `face`, `edge` or `vertex`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Face(_) => "face",
            Self::Edge(_) => "edge",
            Self::Vertex(_) => "vertex",
        }
    }

    /// Which one of them.
    pub fn index(self) -> u32 {
        match self {
            Self::Face(k) | Self::Edge(k) | Self::Vertex(k) => k,
        }
    }
}

/// The closest point of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartFoot {
    /// m.
    pub point: Point3,
    /// Unit normal of the face, out of the matter; the mean of those that meet at an edge or a vertex.
    pub normal: Vector3,
    /// From the query, m.
    pub distance: f64,
    /// Negative inside, m; `None` for parts without an inside. 0 at an edge or a vertex that is nearer than its own gap.
    pub signed_distance: Option<f64>,
    /// What it is on.
    pub support: Support,
    /// The face it is on, or one of those that meet there.
    pub face: u32,
    /// `point` as a place of the part: two numbers that [`Part::point`] takes.
    pub place: [f64; 2],
    /// No closer point can have been passed over.
    pub certified: bool,
}

/// The best so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Best {
    pub point: Point3,
    pub support: Support,
    pub at: At,
    /// From the query, m².
    pub squared: f64,
}

/// Where on its support.
#[derive(Clone, Copy, Debug)]
pub(super) enum At {
    Face([f64; 2]),
    /// The edge, its segment and the parameter there; of a vertex that it ends at as well.
    Edge(u32, (usize, f64)),
    Alone,
}

/// The nearest edge or lone vertex of a tree, if it is nearer than what is known.
pub(super) fn nearest_wire(part: &Part, q: &Point3, wires: &Tree, best: &mut Option<Best>) {
    let mut ceiling = best.map_or(f64::INFINITY, |best| best.squared);
    wires.nearest(q, &mut ceiling, |item, ceiling| {
        if let Some(found) = wire(part, q, item, *ceiling) {
            *ceiling = found.squared;
            *best = Some(found);
        }
    });
}

/// The closest point of an edge, or a lone vertex, where it is nearer than the root of `ceiling` (m²).
pub(super) fn wire(part: &Part, q: &Point3, item: u32, ceiling: f64) -> Option<Best> {
    let Some(edge) = part.edges.get(item as usize) else {
        let v = part.lone[item as usize - part.edges.len()];
        let point = part.vertices[v as usize].point;
        let squared = (q - point).norm_squared();
        return (squared < ceiling).then_some(Best {
            point,
            support: Support::Vertex(v),
            at: At::Alone,
            squared,
        });
    };
    if edge.sides.is_empty() {
        return None;
    }
    let on = edge.curve.closest(q, ceiling)?;
    Some(Best {
        point: on.point,
        support: support(edge, item, on.at),
        at: At::Edge(item, on.at),
        squared: on.squared,
    })
}

/// A place of an edge, or the vertex that it is.
fn support(edge: &Edge, item: u32, at: (usize, f64)) -> Support {
    match edge.curve.end(at) {
        Some(last) => Support::Vertex(edge.ends[usize::from(last)]),
        None => Support::Edge(item),
    }
}

pub(super) fn answer(part: &Part, q: &Point3, best: &Best, certified: bool) -> PartFoot {
    let distance = (q - best.point).norm();
    let (face, uv) = match best.at {
        At::Face(uv) => (best.support.index(), uv),
        At::Edge(k, at) => part.beside_edge(k, at),
        At::Alone => part.beside_vertex(best.support.index()),
    };
    let (normal, gap_m) = match (best.support, best.at) {
        (Support::Edge(k), At::Edge(_, at)) => {
            let edge = &part.edges[k as usize];
            (edge.normal(&part.faces, at), edge.gap_m)
        }
        (Support::Vertex(k), _) => {
            let vertex = &part.vertices[k as usize];
            (vertex.normal, vertex.gap_m)
        }
        _ => (part.faces[face as usize].normal(uv), 0.0),
    };
    let side = normal.dot(&(q - best.point));
    let signed = match distance < gap_m {
        true => 0.0,
        false => distance.copysign(side),
    };
    PartFoot {
        point: best.point,
        normal: normal
            .try_normalize(f64::MIN_POSITIVE)
            .unwrap_or_else(Vector3::z),
        distance,
        signed_distance: part.is_closed().then_some(signed),
        support: best.support,
        face,
        place: part.place(face, uv),
        certified,
    }
}
