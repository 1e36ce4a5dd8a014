//! Arcs that meet: their common point is a false root that no factor takes away.
//!
//! The cone rule: where every two hodograph coefficients of an arc, or of two consecutive arcs, have a positive scalar
//! product, all tangents are within 90° of each other, so chord · tangent > 0 for every chord between points of it: no
//! stationary pair. Consecutive arcs that break the rule are halved towards their common point until the rest keeps it.

use super::forms::Forms;
use super::piece::Piece;
use crate::math::Vector3;

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

/// True when all tangents of the arcs are within 90° of each other, those of an arc among themselves too.
pub(super) fn within_a_right_angle(arcs: &[&Forms]) -> bool {
    let directions: Vec<Vector3> = arcs.iter().flat_map(|forms| directions(forms)).collect();
    directions.iter().enumerate().all(|(k, a)| {
        directions[k..].iter().all(|b| {
            // More than the rounding of the coefficients.
            a.dot(b) > 1e-12 * a.norm() * b.norm()
        })
    })
}

fn directions(forms: &Forms) -> impl Iterator<Item = Vector3> + '_ {
    let [x, y, z] = &forms.hodograph;
    let (x, y, z) = (x.coefficients(), y.coefficients(), z.coefficients());
    (0..x.len()).map(|k| Vector3::new(x[k].mid(), y[k].mid(), z[k].mid()))
}

/// The pairs of sub-arcs of two consecutive pieces, `first` ending where `second` starts, that may hold stationary pairs.
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
