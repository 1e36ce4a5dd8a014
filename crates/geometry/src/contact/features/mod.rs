//! What a tool touches with where it has no normal of its own: corners and edges.
//!
//! At an edge rounding decides which side is deepest, and a gradient there is the normal of either. So an edge
//! touches as what it is, a set of points of the tool in the signed distance of the body, with the body's normal:
//!
//! ```text
//! corners                       each
//! points of round edges         eight, the same in each query
//! edges                         where the distance along them is least
//! ```
//! None of the tool's points may be inside of the body, so all of these are right whatever else touches. Those that
//! stay the same carry a flat contact: where depth is level no point of it is found twice.

mod edge;
mod known;
mod part;
mod search;
mod surface;
#[cfg(test)]
mod surface_tests;
#[cfg(test)]
mod tests;

pub use edge::{Curve, Edge};
pub use search::FeatureSearch;

use crate::math::{Point3, Vector3};

/// Sides that meet at less than this angle are one smooth side: the cosine of 1°.
pub(in crate::contact) const SHARP: f64 = 0.999_847_695_156_391_3;
/// Corners nearer than this, of the size, are one.
const SAME: f64 = 1e-7;
/// An edge is straight within this, of the size.
const STRAIGHT: f64 = 1e-10;

/// Corners and edges of a solid, in its own frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features {
    /// Tips and corners, m.
    pub corners: Vec<Point3>,
    /// Edges; straight ones end in corners.
    pub edges: Vec<Edge>,
}

impl Features {
    /// The number of the corner at a point of a solid of this size, m; a new one where there is none yet.
    pub(super) fn corner(&mut self, p: Point3, size_m: f64) -> usize {
        let near = |q: &Point3| (q - p).norm() <= SAME * size_m;
        self.corners.iter().position(near).unwrap_or_else(|| {
            self.corners.push(p);
            self.corners.len() - 1
        })
    }

    /// An edge between two corners through places; a straight one where they lie on a line.
    pub(super) fn open_edge(&mut self, places: Vec<(Point3, Vector3)>, size_m: f64) -> Edge {
        let (first, last) = (places[0].0, places[places.len() - 1].0);
        let corners = [first, last].map(|p| self.corner(p, size_m));
        let along = (last - first).normalize();
        let aside_m = |p: &Point3| (p - first - along * along.dot(&(p - first))).norm();
        if places.iter().all(|(p, _)| aside_m(p) <= STRAIGHT * size_m) {
            let ends = corners.map(|corner| self.corners[corner]);
            return Edge::Segment { ends, corners };
        }
        Edge::Curve(Curve::new(places, Some(corners)))
    }

    /// It is smooth everywhere, or nothing is known of its edges.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty() && self.edges.is_empty()
    }
}
