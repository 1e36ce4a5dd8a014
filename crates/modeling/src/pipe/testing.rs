//! Spines for tests.

use super::piece::Piece;
use palpate_geometry::math::Random;
use palpate_geometry::math::Vector3;

/// Control points in a cube, weights from 0.3 to 3.
pub fn random_piece(random: &mut Random, degree: usize) -> Piece {
    let points = (0..=degree)
        .map(|_| {
            Vector3::new(
                random.float(-0.5, 0.5),
                random.float(-0.5, 0.5),
                random.float(-0.5, 0.5),
            )
        })
        .collect();
    let weights = (0..=degree).map(|_| random.float(0.3, 3.0)).collect();
    Piece {
        start: 0.0,
        end: 1.0,
        points,
        weights,
    }
}
