//! Arcs that meet: their common point is a false root that no factor takes away.
//!
//! The cone rule: where every two hodograph coefficients of an arc, or of two consecutive arcs,
//! have a positive scalar product, all tangents are within 90° of each other, so chord · tangent >
//! 0 for every chord between points of it: no stationary pair. Consecutive arcs that break the rule
//! are halved towards their common point until the rest keeps it.

use super::forms::Forms;
use super::piece::Piece;
use palpate_geometry::math::Vector3;

/// Halvings towards a common point: only a corner of more than 90° needs them all.
const DEPTH: usize = 24;

/// A part of a spine with what its equations are made of.
#[derive(Clone, Debug)]
pub(super) struct Arc {
    pub piece: Piece,
    pub forms: Forms,
}

impl Arc {
    fn new(piece: Piece) -> Self {
        let forms = Forms::new(&piece);
        Self { piece, forms }
    }
}

/// True when all tangents of the arcs are within 90° of each other, those of an arc among
/// themselves too.
pub(super) fn within_a_right_angle(arcs: &[&Forms]) -> bool {
    let directions: Vec<Direction> = arcs.iter().flat_map(|forms| directions(forms)).collect();
    directions.iter().enumerate().all(|(k, a)| {
        directions[k..]
            .iter()
            .all(|b| a.vector.dot(&b.vector) > a.doubt(b))
    })
}

/// A coefficient of a hodograph, and how far from it the exact one may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Direction {
    pub vector: Vector3,
    pub error: f64,
}

impl Direction {
    /// Scalar products below this may be of the other sign.
    fn doubt(&self, other: &Self) -> f64 {
        let (a, b) = (self.vector.norm(), other.vector.norm());
        1e-14 * a * b + a * other.error + b * self.error + self.error * other.error
    }
}

/// The coefficients of the hodograph: a cone around all tangents.
pub(super) fn directions(forms: &Forms) -> impl Iterator<Item = Direction> + '_ {
    let [x, y, z] = &forms.hodograph;
    let (x, y, z) = (x.coefficients(), y.coefficients(), z.coefficients());
    (0..x.len()).map(|k| Direction {
        vector: Vector3::new(x[k].mid(), y[k].mid(), z[k].mid()),
        error: x[k].radius() + y[k].radius() + z[k].radius(),
    })
}

/// The pairs of sub-arcs of two consecutive pieces, `first` ending where `second` starts, that may
/// hold stationary pairs.
pub(super) fn pairs_to_solve(first: &Arc, second: &Arc, mut visit: impl FnMut(&Arc, &Arc)) {
    let (mut a, mut b) = (first.clone(), second.clone());
    for _ in 0..DEPTH {
        if within_a_right_angle(&[&a.forms, &b.forms]) {
            return;
        }
        let (a0, a1) = a.piece.split(0.5);
        let (b0, b1) = b.piece.split(0.5);
        let [a0, a1, b0, b1] = [a0, a1, b0, b1].map(Arc::new);
        visit(&a0, &b0);
        visit(&a0, &b1);
        visit(&a1, &b1);
        (a, b) = (a1, b0);
    }
}
