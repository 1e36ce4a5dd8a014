//! Edges and tips of parts.

use super::{Curve, Edge, Features, SHARP};
use crate::part::{Part, SharpEdge};

impl Features {
    /// Those of a part: edges that stand out sharper than 1° or at which flat faces end, and apexes.
    pub fn of_part(part: &Part) -> Self {
        let (edges, tips) = part.sharp_edges(SHARP);
        let size_m = part.size_m();
        let mut features = Self::default();
        for SharpEdge { places, closed } in edges {
            let edge = match closed {
                true => Edge::Curve(Curve::new(places, None)),
                false => features.open_edge(places, size_m),
            };
            features.edges.push(edge);
        }
        for tip in tips {
            features.corner(tip, size_m);
        }
        features
    }
}
