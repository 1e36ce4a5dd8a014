//! The eight ways to lay a patch: its parameters swapped and reversed.

use super::Edge;
use super::rim::facing;
use palpate_geometry::surface::{Direction, Surface};

/// Parameters swapped, then reversed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Turn {
    /// u and v exchanged, first.
    pub swap: bool,
    /// Then the new u the other way.
    pub reverse_u: bool,
    /// And the new v.
    pub reverse_v: bool,
}

impl Turn {
    /// All eight, as given first.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        (0..8).map(|k| Self {
            swap: k & 4 != 0,
            reverse_u: k & 1 != 0,
            reverse_v: k & 2 != 0,
        })
    }

    /// The surface laid so, clamped; every point stays where it is.
    pub fn of(self, surface: &Surface) -> Surface {
        let mut turned = surface.clamped();
        if self.swap {
            turned = turned.swap_uv();
        }
        if self.reverse_u {
            turned = turned.reversed(Direction::U);
        }
        if self.reverse_v {
            turned = turned.reversed(Direction::V);
        }
        turned
    }

    /// Where the turned surface's (u, v), as fractions of the domain, lie on the surface as given.
    pub fn back(self, [mut u, mut v]: [f64; 2]) -> [f64; 2] {
        if self.reverse_u {
            u = 1.0 - u;
        }
        if self.reverse_v {
            v = 1.0 - v;
        }
        if self.swap { [v, u] } else { [u, v] }
    }

    /// Which edge of the surface as given lies at an edge of the turned one.
    pub fn source(self, edge: Edge) -> Edge {
        let middle = match edge {
            Edge::U0 => [0.0, 0.5],
            Edge::U1 => [1.0, 0.5],
            Edge::V0 => [0.5, 0.0],
            Edge::V1 => [0.5, 1.0],
        };
        match self.back(middle) {
            [0.0, _] => Edge::U0,
            [1.0, _] => Edge::U1,
            [_, 0.0] => Edge::V0,
            _ => Edge::V1,
        }
    }

    /// Whether the other parameter of an edge of the turned surface runs backwards on the surface as given.
    pub(super) fn reverses_along(self, edge: Edge) -> bool {
        let along = match edge {
            Edge::U0 => [0.0, 1.0],
            Edge::U1 => [1.0, 1.0],
            Edge::V0 => [1.0, 0.0],
            Edge::V1 => [1.0, 1.0],
        };
        facing(self.source(edge), self.back(along))[1] < 0.5
    }

    /// The turned surface's direction in which a direction of the surface as given runs, and
    /// whether backwards.
    pub(super) fn direction(self, given: Direction) -> (Direction, bool) {
        match (given == Direction::U) != self.swap {
            true => (Direction::U, self.reverse_u),
            false => (Direction::V, self.reverse_v),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::surface::builtin;

    #[test]
    fn a_turned_surface_has_its_points_where_the_turn_says() {
        let sheet = builtin("sheet", None, None).unwrap();
        let at = |s: &Surface, [a, b]: [f64; 2]| {
            let along =
                |k: &palpate_geometry::basis::KnotVector, f: f64| k.domain().0 + f * k.length();
            s.point(along(s.knots_u(), a), along(s.knots_v(), b))
        };
        for turn in Turn::all() {
            let turned = turn.of(&sheet);
            for place in [[0.0, 0.3], [0.25, 1.0], [0.9, 0.1]] {
                let gap = (at(&turned, place) - at(&sheet, turn.back(place))).norm();
                assert!(
                    gap < 1e-15 + 1e-12 * sheet.size(),
                    "{turn:?} at {place:?}: {gap}"
                );
            }
            for edge in Edge::ALL {
                let (direction, backwards) = turn.direction(turn.source(edge).direction());
                assert_eq!(direction, edge.direction());
                assert_eq!(
                    backwards,
                    turn.source(edge).at_end() != edge.at_end(),
                    "{turn:?} {edge:?}"
                );
            }
        }
    }
}
