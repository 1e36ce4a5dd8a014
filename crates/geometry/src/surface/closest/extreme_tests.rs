//! Surfaces at the edge of what numbers hold, against samples of their Bézier pieces that are dense
//! where weights put the surface, taken in coordinates that lose no digit near either end.

use super::super::{BezierPieces, ClosestSolver, ControlNet, MOST_WEIGHTS, Surface, SurfaceError};
use super::tests::Random;
use crate::basis::KnotVector;
use crate::math::{Point3, Vector3};

/// s and 1 − s of a coordinate that runs from −∞ to ∞.
fn shares(x: f64) -> [f64; 2] {
    match x {
        x if x > 90.0 => [1.0, 0.0],
        x if x < -90.0 => [0.0, 1.0],
        x => [1.0 / (1.0 + (-x).exp()), 1.0 / (1.0 + x.exp())],
    }
}

fn bernstein(degree: usize, x: f64) -> Vec<f64> {
    let [s, rest] = shares(x);
    let mut binomial = 1.0;
    (0..=degree)
        .map(|k| {
            let value = binomial * s.powi(k as i32) * rest.powi((degree - k) as i32);
            binomial *= (degree - k) as f64 / (k + 1) as f64;
            value
        })
        .collect()
}

struct Dense {
    degrees: [usize; 2],
    pieces: Vec<Vec<[f64; 4]>>,
    steps: Vec<f64>,
    points: Vec<Point3>,
}

impl Dense {
    /// `count` samples a piece and direction, between shares of e^±reach.
    fn new(surface: &Surface, count: usize, reach: f64) -> Self {
        let pieces = BezierPieces::new(surface);
        let mut steps = vec![-100.0];
        steps.extend((0..count).map(|k| reach * (2.0 * k as f64 / (count - 1) as f64 - 1.0)));
        steps.push(100.0);
        let mut new = Self {
            degrees: [surface.knots_u().degree(), surface.knots_v().degree()],
            pieces: (0..pieces.len())
                .map(|k| pieces.points(k).to_vec())
                .collect(),
            steps,
            points: Vec::new(),
        };
        for piece in 0..new.pieces.len() {
            for i in 0..new.steps.len() {
                for j in 0..new.steps.len() {
                    let point = new.at(piece, [new.steps[i], new.steps[j]]);
                    new.points.push(point);
                }
            }
        }
        new
    }

    fn at(&self, piece: usize, x: [f64; 2]) -> Point3 {
        let [a, b] = [0, 1].map(|d| bernstein(self.degrees[d], x[d]));
        let mut sum = [0.0; 4];
        for (i, a) in a.iter().enumerate() {
            for (j, b) in b.iter().enumerate() {
                for (sum, c) in sum
                    .iter_mut()
                    .zip(self.pieces[piece][i * (self.degrees[1] + 1) + j])
                {
                    *sum += a * b * c;
                }
            }
        }
        Point3::new(sum[0], sum[1], sum[2]) / sum[3]
    }

    /// The least distance found: from the nearest samples, by steps to the eight sides that halve
    /// when none is nearer.
    fn distance(&self, query: &Point3) -> f64 {
        let n = self.steps.len();
        let far = |k: usize| (self.points[k] - query).norm();
        let mut starts: Vec<usize> = (0..self.points.len()).collect();
        let lowest = |&k: &usize| {
            let (piece, i, j) = (k / (n * n), k / n % n, k % n);
            (i.saturating_sub(1)..(i + 2).min(n)).all(|i| {
                (j.saturating_sub(1)..(j + 2).min(n))
                    .all(|j| far((piece * n + i) * n + j) >= far(k))
            })
        };
        starts.retain(lowest);
        starts.sort_by(|a, b| far(*a).total_cmp(&far(*b)));
        starts.truncate(8);
        let polished = starts.into_iter().map(|k| {
            let (piece, mut x) = (k / (n * n), [self.steps[k / n % n], self.steps[k % n]]);
            let (mut best, mut step) = (far(k), self.steps[2] - self.steps[1]);
            for _ in 0..2_000 {
                let nearer = (0..9).find_map(|way| {
                    let y = [0, 1].map(|d| {
                        let turn = [way / 3, way % 3][d] as f64 - 1.0;
                        if turn != 0.0 {
                            x[d].clamp(-60.0, 60.0) + turn * step
                        } else {
                            x[d]
                        }
                    });
                    let value = (self.at(piece, y) - query).norm();
                    (value < best).then_some((y, value))
                });
                match nearer {
                    Some(nearer) => (x, best) = nearer,
                    None if step < 1e-10 => break,
                    None => step *= 0.5,
                }
            }
            best
        });
        polished.fold(f64::INFINITY, f64::min)
    }
}

fn knots(random: &mut Random, degree: usize, inner: &[f64]) -> KnotVector {
    let mut all = vec![0.0; degree + 1];
    if inner.is_empty() && random.below(2) == 0 {
        all.push(random.float(0.3, 0.7));
    }
    all.extend(inner);
    all.extend(vec![1.0; degree + 1]);
    KnotVector::new(degree, all).unwrap()
}

fn sheet(
    random: &mut Random,
    [u, v]: [KnotVector; 2],
    weights: Option<&[f64]>,
) -> Result<Surface, SurfaceError> {
    let (rows, columns) = (u.count(), v.count());
    let point = |k: usize| {
        let [i, j] = [k / columns, k % columns].map(|x| 0.01 * x as f64);
        Point3::new(i, j, 0.0) + Vector3::from_fn(|_, _| 0.003 * random.signed())
    };
    let points = (0..rows * columns).map(point).collect();
    let weights = weights.map(|w| (0..rows * columns).map(|k| w[k % w.len()]).collect());
    Surface::new(u, v, ControlNet::new(rows, columns, points)?, weights)
}

fn queries(random: &mut Random, surface: &Surface, count: usize) -> Vec<Point3> {
    let points = surface.net().points();
    (0..count)
        .map(|k| {
            let [a, b] = [0, 1].map(|_| points[random.below(points.len())].coords);
            Point3::from(a * 0.6 + b * 0.4) + random.vector() * [0.0, 1e-3, 1e-2, 1e-1][k % 4]
        })
        .collect()
}

// Seven such surfaces of ten had answers off by up to half the size when bounds were judged by the
// largest weight of a piece.
#[test]
fn closest_points_are_exact_up_to_the_largest_ratio_of_weights() {
    let mut random = Random(1701);
    for case in 0..24 {
        let degrees = [1 + case % 5, 1 + random.below(4)];
        let pair = degrees.map(|degree| knots(&mut random, degree, &[]));
        let ratio = [1e2, 1e3, MOST_WEIGHTS][case % 3];
        let weights: Vec<f64> = match case % 4 {
            0 => (0..31).map(|_| ratio.powf(random.unit())).collect(),
            1 => vec![1.0, ratio],
            2 => (0..13).map(|k| if k == 6 { ratio } else { 1.0 }).collect(),
            _ => vec![1.0 / ratio, 1.0, 1.0],
        };
        let surface = sheet(&mut random, pair, Some(&weights)).unwrap();
        let dense = Dense::new(&surface, 41, 1.2 * ratio.ln() + 4.0);
        let mut solver = ClosestSolver::new(&surface);
        for query in queries(&mut random, &surface, 8) {
            let apart = solver.closest(&surface, &query).distance - dense.distance(&query);
            assert!(
                apart <= 1e-9 * surface.size(),
                "case {case}, {degrees:?}, {ratio:e}: {apart} m at {query}"
            );
        }
    }
}

#[test]
fn weights_too_unlike_are_refused_with_their_ratio() {
    let mut random = Random(1702);
    for ratio in [2e4, 1e7, 1e12] {
        let pair = [(); 2].map(|()| KnotVector::clamped_uniform(2, 4).unwrap());
        let low = ratio_low(ratio);
        let refused = sheet(&mut random, pair, Some(&[low, low * ratio, low])).unwrap_err();
        assert!(
            matches!(refused, SurfaceError::WeightRatio { ratio: told } if (told / ratio - 1.0).abs() < 1e-12)
        );
        let text = refused.to_string();
        assert!(
            text.contains(&format!("{ratio:.3e}")) && text.contains("up to 1e4 times"),
            "{text}"
        );
    }
}

/// So that both ends stay within the weights allowed.
fn ratio_low(ratio: f64) -> f64 {
    if ratio > 1e8 { 1e-6 } else { 1.0 }
}

// A file with such knots is refused; a surface made of numbers is not, and must not hang.
#[test]
fn a_bridge_between_near_knots_is_given_up_and_counted_and_the_rest_of_the_surface_is_not() {
    let mut random = Random(1605);
    let mut given_up = 0;
    for case in 0..30 {
        let degree = 1 + case % 5;
        let at = random.float(0.3, 0.7);
        let gap = 10_f64.powi(-16 + (case % 6) as i32);
        let mut near = vec![at];
        while near.len() < degree + 1 + case % 2 {
            let last = near[near.len() - 1];
            near.push((last + gap).max(last.next_up()));
        }
        let pair = [
            knots(&mut random, degree, &near),
            KnotVector::clamped_uniform(2, 4).unwrap(),
        ];
        let pair = if case % 4 < 2 {
            pair
        } else {
            let [a, b] = pair;
            [b, a]
        };
        let surface = sheet(&mut random, pair, None).unwrap();
        let dense = Dense::new(&surface, 31, 8.0);
        let mut solver = ClosestSolver::new(&surface);
        let most = 1_000 * solver.pieces(&surface).len();
        let mut all = Vec::with_capacity(64);
        for query in queries(&mut random, &surface, 16) {
            let before = solver.pieces_given_up();
            let foot = solver.closest(&surface, &query);
            let certified = solver.pieces_given_up() == before;
            assert!(solver.parts_visited() <= most);
            let apart = foot.distance - dense.distance(&query);
            assert!(
                !certified || apart <= 1e-9 * surface.size(),
                "case {case}: {apart} m at {query}"
            );
            given_up += usize::from(!certified);
            let before = solver.pieces_given_up();
            let whole = solver.minima_within(&surface, &query, 0.02, &mut all);
            assert!(
                !whole || solver.pieces_given_up() == before,
                "what is given up is told"
            );
        }
    }
    assert!(given_up > 10, "{given_up}: the case that hung is not met");
}
