//! Random surfaces and a slow twin of the evaluator, for tests.

use super::{ControlNet, Surface};
use crate::basis::KnotKind;
use crate::basis::testing::{KINDS, Random, parameters, random_knots, twin_row};
use crate::math::{Point3, Vector3};

/// A bumpy sheet of some degree and kind, about 1 m across, knots repeated up to `most(degree)`
/// times.
pub(crate) fn random_surface(
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

/// Pairs of parameters: knots and ends against each other, and some random ones.
pub(crate) fn pairs(random: &mut Random, surface: &Surface, more: usize) -> Vec<(f64, f64)> {
    let (us, vs) = (
        parameters(random, surface.knots_u(), more),
        parameters(random, surface.knots_v(), more),
    );
    let mut pairs: Vec<(f64, f64)> = us
        .iter()
        .flat_map(|&u| vs.iter().map(move |&v| (u, v)))
        .collect();
    // A third of the grid is enough where it is large.
    if pairs.len() > 600 {
        pairs = pairs.into_iter().step_by(3).collect();
    }
    pairs
}

/// A^(k, l) and w^(k, l) from dense rows of the recursive basis.
fn twin_homogeneous(
    surface: &Surface,
    u: f64,
    v: f64,
    order_u: usize,
    order_v: usize,
) -> (Vector3, f64) {
    let wrapped =
        |knots: &crate::basis::KnotVector, u: f64| knots.confine_from(u, crate::basis::Side::Right);
    let row = twin_row(
        surface.knots_u(),
        wrapped(surface.knots_u(), u),
        false,
        order_u,
    );
    let column = twin_row(
        surface.knots_v(),
        wrapped(surface.knots_v(), v),
        false,
        order_v,
    );
    let (mut sum, mut weight) = (Vector3::zeros(), 0.0);
    for (i, n) in row.iter().enumerate() {
        for (j, m) in column.iter().enumerate() {
            let w = surface.weights().map_or(1.0, |w| w[i * column.len() + j]);
            sum += surface.net().at(i, j).coords * (n * m * w);
            weight += n * m * w;
        }
    }
    (sum, weight)
}

/// Derivative (k, l) by the recursive rule of a quotient: The NURBS Book, eq. 4.20, term by term.
pub(crate) fn twin_derivative(surface: &Surface, u: f64, v: f64, k: usize, l: usize) -> Vector3 {
    let binomial = |n: usize, r: usize| [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 2.0, 1.0]][n][r];
    let (mut sum, _) = twin_homogeneous(surface, u, v, k, l);
    let (_, weight) = twin_homogeneous(surface, u, v, 0, 0);
    if surface.weights().is_some() {
        for i in 0..=k {
            for j in 0..=l {
                if i + j > 0 {
                    let (_, w) = twin_homogeneous(surface, u, v, i, j);
                    sum -= twin_derivative(surface, u, v, k - i, l - j)
                        * (binomial(k, i) * binomial(l, j) * w);
                }
            }
        }
    }
    sum / weight
}

/// The surface as it is, and turned, moved and scaled so that nothing is aligned with an axis.
pub(crate) fn tilted(surface: &Surface) -> Surface {
    let rotation = crate::math::Rotation::from_euler_angles(0.3, -1.1, 2.0);
    surface.transformed(&crate::math::Pose::from_parts(
        Vector3::new(0.3, -0.2, 0.7).into(),
        rotation,
    ))
}
