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
mod search;
#[cfg(test)]
mod tests;

pub use edge::{Curve, Edge};
pub use search::FeatureSearch;

use crate::math::Point3;

/// Corners and edges of a solid, in its own frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features {
    /// Tips and corners, m.
    pub corners: Vec<Point3>,
    /// Edges; straight ones end in corners.
    pub edges: Vec<Edge>,
}

impl Features {
    /// The point of an edge, or the corner, next to a point, m.
    fn nearest(&self, p: &Point3) -> Point3 {
        let away = |q: &Point3| (q - p).norm_squared();
        let edges = self.edges.iter().map(|edge| edge.nearest(p));
        let all = edges.chain(self.corners.iter().copied());
        all.min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(*p)
    }

    /// It is smooth everywhere, or nothing is known of its edges.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty() && self.edges.is_empty()
    }
}
