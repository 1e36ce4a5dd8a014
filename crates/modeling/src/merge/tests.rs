//! Merging as a whole.

mod refusals;
mod trimmed;
mod whole;

use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::Point3;
use palpate_geometry::math::Random;
use palpate_geometry::surface::{ControlNet, Direction, Surface};

/// A wavy sheet about 0.1 m wide with random knots and net.
pub(super) fn wavy(random: &mut Random, degrees: [usize; 2]) -> Surface {
    let counts = degrees.map(|k| random.integer(k + 2, k + 6));
    let knots = [0, 1].map(|d| {
        let n = counts[d] - degrees[d] - 1;
        let inner: Vec<f64> = (1..=n)
            .map(|k| (k as f64 + random.float(-0.3, 0.3)) / (n + 1) as f64)
            .collect();
        let ends = |t: f64| std::iter::repeat_n(t, degrees[d] + 1);
        KnotVector::new(
            degrees[d],
            ends(0.0).chain(inner).chain(ends(1.0)).collect(),
        )
        .unwrap()
    });
    let (u, v) = (knots[0].greville(), knots[1].greville());
    let mut points = Vec::new();
    for x in &u {
        for y in &v {
            points.push(Point3::new(0.1 * x, 0.08 * y, random.float(-0.005, 0.005)));
        }
    }
    let [knots_u, knots_v] = knots;
    let net = ControlNet::new(u.len(), v.len(), points).unwrap();
    Surface::new(knots_u, knots_v, net, None).unwrap()
}

/// Its halves, cut at random.
pub(super) fn halves(random: &mut Random, whole: &Surface, direction: Direction) -> [Surface; 2] {
    whole.split(direction, random.float(0.3, 0.7)).unwrap()
}
