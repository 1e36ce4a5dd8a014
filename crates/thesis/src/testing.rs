//! Random surfaces for tests, those of the crate `palpate-geometry`.

use palpate_geometry::basis::{KnotKind, KnotVector};
use palpate_geometry::math::{Point3, Random};
use palpate_geometry::surface::{ControlNet, Surface};

/// Every kind.
const KINDS: [KnotKind; 3] = [KnotKind::Clamped, KnotKind::Open, KnotKind::Periodic];

/// A knot vector of some kind with uneven spans and now and then a repeated knot, up to `most`
/// times.
fn random_knots(random: &mut Random, degree: usize, kind: KnotKind, most: usize) -> KnotVector {
    let mut at = random.float(-1.0, 1.0);
    let mut next = |random: &mut Random| {
        at += random.float(0.3, 1.0);
        at
    };
    let mut inner = Vec::new();
    for _ in 0..random.integer(1, 4) {
        let knot = next(random);
        let times = if random.integer(0, 2) == 0 {
            random.integer(1, most)
        } else {
            1
        };
        inner.extend(std::iter::repeat_n(knot, times));
    }
    match kind {
        KnotKind::Clamped => {
            let (start, end) = (inner[0] - 0.7, next(random));
            let mut knots = vec![start; degree + 1];
            knots.extend(inner);
            knots.extend(std::iter::repeat_n(end, degree + 1));
            KnotVector::new(degree, knots).unwrap()
        }
        KnotKind::Open => {
            let start = inner[0];
            let mut knots: Vec<f64> = (0..=degree)
                .map(|k| start - 0.4 * (degree + 1 - k) as f64)
                .collect();
            knots.extend(inner);
            knots.extend((0..=degree).map(|_| next(random)));
            KnotVector::new(degree, knots).unwrap()
        }
        KnotKind::Periodic => {
            let mut knots = vec![inner[0] - 0.5];
            knots.extend(inner);
            while knots.len() < degree + 2 + random.integer(0, 2) {
                knots.push(next(random));
            }
            KnotVector::periodic(degree, knots).unwrap()
        }
    }
}

/// A bumpy sheet of some degree and kind, about 1 m across, knots repeated up to `most(degree)`
/// times.
fn random_surface(
    random: &mut Random,
    degrees: [usize; 2],
    most: fn(usize) -> usize,
    rational: bool,
) -> Surface {
    let kind = |random: &mut Random| KINDS[random.integer(0, 2)];
    let kinds: [KnotKind; 2] = [kind(random), kind(random)];
    let u = random_knots(random, degrees[0], kinds[0], most(degrees[0]));
    let v = random_knots(random, degrees[1], kinds[1], most(degrees[1]));
    let (rows, columns) = (u.count(), v.count());
    let points = (0..rows * columns)
        .map(|k| {
            let (i, j) = (k / columns, k % columns);
            let mut jitter = || random.float(-0.1, 0.1);
            Point3::new(
                i as f64 / rows as f64 + jitter(),
                j as f64 / columns as f64 + jitter(),
                jitter(),
            )
        })
        .collect();
    let weights = rational.then(|| {
        (0..rows * columns)
            .map(|_| random.float(0.5, 2.0))
            .collect()
    });
    Surface::new(
        u,
        v,
        ControlNet::new(rows, columns, points).unwrap(),
        weights,
    )
    .unwrap()
}

/// Fifty surfaces of degrees 1 to 7, every other one rational, with every multiplicity up to degree
/// + 1.
pub(crate) fn fifty_surfaces(seed: u64) -> Vec<Surface> {
    let mut random = Random(seed);
    (0..50)
        .map(|k| {
            let degrees = [random.integer(1, 7), random.integer(1, 7)];
            random_surface(&mut random, degrees, |degree| degree + 1, k % 2 == 1)
        })
        .collect()
}
