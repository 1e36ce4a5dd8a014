//! The curve within one rectangle, as a graph over one of its directions.

use super::field::{Field, restricted, root, value};
use super::grid::Grid;
use super::leaves::{Kind, Leaf};

/// Places of a rectangle are numbers from 0 to 1 in both directions.
pub(super) struct Graph<'a> {
    leaf: &'a Leaf,
    degree: [usize; 2],
    /// The direction over which it is a graph.
    pub over: usize,
    /// The ends of the curve, ascending over that direction.
    pub ends: [f64; 2],
}

impl<'a> Graph<'a> {
    /// Between two places of a rectangle where it is a graph.
    pub fn new(field: &Field, grid: &Grid, leaf: &'a Leaf, ends: [[f64; 2]; 2]) -> Option<Self> {
        let Kind::Graph(over) = leaf.kind else {
            return None;
        };
        let [a, b] = ends.map(|uv| leaf.local(grid, uv)[over]);
        Some(Self {
            leaf,
            degree: field.degree(),
            over,
            ends: [a.min(b), a.max(b)],
        })
    }

    /// How high it is, and whether the field is above 0 beyond it.
    pub fn height(&self, x: f64) -> (f64, bool) {
        let line = restricted(&self.leaf.points, self.degree, self.over, x);
        let ends = [line[0], line[line.len() - 1]];
        let rises = ends[1] > ends[0];
        // Rounding at the ends of the curve: no farther than the side.
        let y = match (ends[0] > 0.0) == (ends[1] > 0.0) {
            true if ends[0].abs() < ends[1].abs() => 0.0,
            true => 1.0,
            false => root(&line, [0.0, 1.0], ends[0] > 0.0),
        };
        (y, rises)
    }

    /// The field is above 0 at a place of the rectangle.
    pub fn is_above(&self, [x, y]: [f64; 2]) -> bool {
        value(&restricted(&self.leaf.points, self.degree, self.over, x), y) > 0.0
    }

    /// A place over x at height y, in the order of the parameters.
    pub fn place(&self, x: f64, y: f64) -> [f64; 2] {
        if self.over == 0 { [x, y] } else { [y, x] }
    }
}
