//! A patch as the layout places it, its lines across the seam drawn so that all end on one curve.
//!
//! A fraction f across the seam, from the outer edge, is put at f · c(g) / c̄, where c is the curve and c̄ its mean: at f = c̄
//! every line ends on the curve. Without a curve nothing is moved.

use super::rim::{Graph, facing, facing_back};
use super::{Edge, Layout};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{Direction, Surface};

/// A turned patch.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    pub surface: Surface,
    /// Its edge at the seam, and the curve on which lines end instead.
    pub end: Option<(Edge, Graph)>,
}

impl Sheet {
    /// The patches, turned, without curves.
    pub(super) fn laid(surfaces: &[Surface], layout: &Layout) -> Vec<Self> {
        let turned = |place: &super::Placed| place.turn.of(&surfaces[place.patch]);
        layout.places.iter().map(turned).map(Self::whole).collect()
    }

    /// A patch that ends at its edges.
    pub(super) fn whole(surface: Surface) -> Self {
        Self { surface, end: None }
    }

    /// Control points in u and v.
    pub(super) fn counts(&self) -> [usize; 2] {
        [self.surface.net().rows(), self.surface.net().columns()]
    }

    /// Fractions of the domain at which the lines are, for fractions along them.
    fn moved(&self, at: [f64; 2], by: impl Fn(f64, &Graph) -> f64) -> [f64; 2] {
        match &self.end {
            None => at,
            Some((edge, graph)) => {
                let [f, g] = facing(*edge, at);
                facing_back(*edge, [f * by(g, graph), g])
            }
        }
    }

    /// The fractions along lines at which a place of the patch, in fractions of the domain, is.
    pub(super) fn along_lines(&self, at: [f64; 2]) -> [f64; 2] {
        self.moved(at, |g, graph| graph.mean / graph.at(g))
    }

    /// Parameters of the surface, for fractions along lines.
    pub(super) fn parameters(&self, at: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.moved(at, |g, graph| graph.at(g) / graph.mean);
        let of = |direction, fraction: f64| {
            let knots = self.surface.knots(direction);
            knots.domain().0 + knots.length() * fraction
        };
        [of(Direction::U, x), of(Direction::V, y)]
    }

    /// The point at fractions along lines.
    pub(super) fn point(&self, at: [f64; 2]) -> Point3 {
        let [u, v] = self.parameters(at);
        self.surface.point(u, v)
    }

    /// Derivative of the point by the fraction across the seam, m.
    pub(super) fn slope(&self, at: [f64; 2], across: Direction) -> Vector3 {
        let [u, v] = self.parameters(at);
        let frame = self.surface.frame(u, v);
        let by_parameter = if across == Direction::U {
            frame.du
        } else {
            frame.dv
        };
        let stretch = self.end.as_ref().map_or(1.0, |(edge, graph)| {
            graph.at(facing(*edge, at)[1]) / graph.mean
        });
        by_parameter * (self.surface.knots(across).length() * stretch)
    }
}
