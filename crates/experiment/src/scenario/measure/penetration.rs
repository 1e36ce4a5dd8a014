//! How deep a closed body lies behind an open surface.

use super::super::surfaces::grid;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ClosestSolver, Surface};

/// A foot is straight below its point when the way between them turns from the normal by less than
/// this cosine; else the foot is on the rim and the point beside it.
const STRAIGHT: f64 = 1.0 - 1e-6;

/// Greatest depth of any of `count` × `count` points of a body's surface behind an open surface, m:
/// behind is the side on which the body's middle is not. 0 where none is.
pub fn deepest_m(body: &Surface, sheet: &Surface, count: usize) -> f64 {
    let mut solver = ClosestSolver::new(sheet);
    let middle: Vector3 = {
        let points = body.net().points();
        points.iter().map(|p| p.coords).sum::<Vector3>() / points.len() as f64
    };
    let side = (solver.closest(sheet, &Point3::from(middle)).signed_distance).signum();
    let mut deepest: f64 = 0.0;
    for (_, _, point) in grid(body, [count; 2]) {
        let foot = solver.closest(sheet, &point);
        let along = (point - foot.point).dot(&foot.normal);
        let straight = along.abs() >= STRAIGHT * foot.distance;
        if straight && side * foot.signed_distance < 0.0 {
            deepest = deepest.max(foot.distance);
        }
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::surface::builtin;

    #[test]
    fn a_ball_through_a_sheet_is_as_deep_as_it_goes() {
        let sheet = builtin("sheet", None, Some(0.2)).unwrap();
        for (height, expected) in [(0.009, 1e-3), (0.0101, 0.0), (-0.0085, 1.5e-3)] {
            let mut ball = builtin("sphere", None, Some(0.01)).unwrap();
            for point in ball.net_mut().points_mut() {
                point.z += height;
            }
            let found = deepest_m(&ball, &sheet, 81);
            assert!((found - expected).abs() < 2e-6, "{height}: {found}");
        }
    }
}
