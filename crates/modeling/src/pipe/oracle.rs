//! A slow twin for body to body: dense sampling and Newton's method. For tests and the benchmark.
//!
//! Knows points and tangents of the curve only: no pieces, no polynomials. It may miss pairs that
//! are closer to each other than its samples; what it finds is real.

use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Curve;

/// A pair that samples show: s < t.
pub type SampledPair = [f64; 2];

/// The stationary pairs of an open curve that `samples`² cells show.
pub fn sampled_pairs(curve: &Curve, samples: usize) -> Vec<SampledPair> {
    let (start, end) = curve.knots().domain();
    let at = |k: usize| start + (end - start) * k as f64 / samples as f64;
    let places: Vec<(Point3, Vector3)> = (0..=samples)
        .map(|k| curve.point_and_tangent(at(k)))
        .collect();
    // Both residuals divided by t − s, so that the diagonal is not a root.
    let residuals = |i: usize, j: usize| {
        let ((p, u), (q, v)) = (places[i], places[j]);
        let chord = if i == j { u } else { (q - p) / (at(j) - at(i)) };
        [chord.dot(&u), chord.dot(&v)]
    };
    let size = |[f, g]: [f64; 2]| f * f + g * g;
    let mut rows = [row(&residuals, 0, samples), row(&residuals, 1, samples)];
    let mut pairs: Vec<SampledPair> = Vec::new();
    for i in 0..samples {
        for j in i..samples {
            let corners = [rows[0][j], rows[0][j + 1], rows[1][j], rows[1][j + 1]];
            let changes = |k: usize| {
                let positive = corners.iter().filter(|c| c[k] > 0.0).count();
                positive != 0 && positive != 4
            };
            // Also cells with a small residual, whose signs may change twice.
            let slope = corners.iter().map(|&c| size(c)).fold(0.0, f64::max)
                - corners.iter().map(|&c| size(c)).fold(f64::MAX, f64::min);
            let small = corners.iter().any(|&c| size(c) < slope);
            if (changes(0) && changes(1)) || small {
                let seed = [
                    at(i) + 0.5 * (end - start) / samples as f64,
                    at(j) + 0.5 * (end - start) / samples as f64,
                ];
                keep(&mut pairs, newton(curve, seed), 1e-7 * (end - start));
            }
        }
        if i + 2 <= samples {
            rows.swap(0, 1);
            rows[1] = row(&residuals, i + 2, samples);
        }
    }
    pairs.sort_by(|a, b| a[0].total_cmp(&b[0]));
    pairs
}

fn row(residuals: &dyn Fn(usize, usize) -> [f64; 2], i: usize, samples: usize) -> Vec<[f64; 2]> {
    (0..=samples).map(|j| residuals(i, j)).collect()
}

fn keep(pairs: &mut Vec<SampledPair>, found: Option<SampledPair>, same: f64) {
    let Some(found) = found else { return };
    let near = |pair: &SampledPair| (0..2).all(|k| (pair[k] - found[k]).abs() < same);
    if !pairs.iter().any(near) {
        pairs.push(found);
    }
}

/// Cosines of the angles between chord and tangents: 0 at a stationary pair. Where the curve meets
/// itself the chord has no direction, and the cosines are 0 too.
pub fn cosines(curve: &Curve, [s, t]: [f64; 2]) -> [f64; 2] {
    let ((p, u), (q, v)) = (curve.point_and_tangent(s), curve.point_and_tangent(t));
    let chord = q - p;
    let rounding = 64.0
        * f64::EPSILON
        * curve
            .points()
            .iter()
            .map(|p| p.coords.amax())
            .fold(0.0, f64::max);
    if chord.norm() <= rounding {
        return [0.0; 2];
    }
    [u, v].map(|tangent| chord.dot(&tangent) / (chord.norm() * tangent.norm()))
}

/// Newton's method with differences of the tangents; the fixed points are those of the exact
/// residuals.
fn newton(curve: &Curve, from: SampledPair) -> Option<SampledPair> {
    let (start, end) = curve.knots().domain();
    let length = end - start;
    let h = 1e-6 * length;
    let bend = |t: f64| {
        let (low, high) = ((t - h).max(start), (t + h).min(end));
        (curve.point_and_tangent(high).1 - curve.point_and_tangent(low).1) / (high - low)
    };
    let mut at = from;
    for _ in 0..40 {
        let [s, t] = at;
        let ((p, u), (q, v)) = (curve.point_and_tangent(s), curve.point_and_tangent(t));
        let chord = q - p;
        let (f, g) = (chord.dot(&u), chord.dot(&v));
        let (fs, ft) = (chord.dot(&bend(s)) - u.dot(&u), u.dot(&v));
        let (gs, gt) = (-u.dot(&v), chord.dot(&bend(t)) + v.dot(&v));
        let det = fs * gt - ft * gs;
        let step = [(f * gt - g * ft) / det, (g * fs - f * gs) / det];
        // Also ends the search for NaN.
        if !(step[0].abs() < 0.05 * length && step[1].abs() < 0.05 * length) {
            return None;
        }
        at = [s - step[0], t - step[1]];
        if at[0] < start || at[1] > end || at[1] - at[0] < 1e-4 * length {
            return None;
        }
        if step[0].abs().max(step[1].abs()) < 1e-14 * length {
            break;
        }
    }
    cosines(curve, at)
        .iter()
        .all(|c| c.abs() < 1e-9)
        .then_some(at)
}

/// Spines at random: Bézier curves in a cube, curled ones, and curled splines of several pieces;
/// degree 2 to 5, weights 0.3 to 3. The same for the same seed.
pub fn random_spine(seed: u64) -> Curve {
    let mut random = SplitMix(seed);
    let degree = 2 + (random.float(0.0, 4.0) as usize).min(3);
    let kind = seed % 3;
    let count = if kind == 2 {
        degree + 2 + (random.float(0.0, 6.0) as usize).min(5)
    } else {
        degree + 1
    };
    let (turn, rise) = (random.float(0.5, 2.2), random.float(0.0, 0.3));
    let points = (0..count)
        .map(|k| {
            let jitter = Vector3::new(
                random.float(-0.5, 0.5),
                random.float(-0.5, 0.5),
                random.float(-0.5, 0.5),
            );
            if kind == 0 {
                return Point3::from(jitter);
            }
            let angle = turn * k as f64;
            let curl = Vector3::new(libm::cos(angle), libm::sin(angle), rise * k as f64);
            Point3::from(curl * random.float(0.6, 1.4) + jitter * 0.3)
        })
        .collect();
    let weights = (0..count).map(|_| random.float(0.3, 3.0)).collect();
    let knots = KnotVector::clamped_uniform(degree, count).expect("a degree of 2 to 5");
    Curve::new(knots, points, Some(weights)).expect("finite points, weights above 0")
}

/// SplitMix64 (Steele, Lea, Flood 2014).
struct SplitMix(u64);

impl SplitMix {
    /// In [low, high).
    fn float(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        low + (high - low) * ((z >> 11) as f64 / (1u64 << 53) as f64)
    }
}

/// How an answer compares with the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Comparison {
    /// Pairs of the answer.
    pub pairs: usize,
    /// Sampled pairs that the answer lacks.
    pub missed: usize,
    /// Pairs of the answer that are not stationary.
    pub wrong: usize,
    /// Pairs of the answer that sampling did not see.
    pub unseen: usize,
    /// Largest difference of parameters between the two, as a share of the domain.
    pub error: f64,
}

/// Compares pairs with [`sampled_pairs`].
pub fn compare(curve: &Curve, pairs: &[[f64; 2]], samples: usize) -> Comparison {
    let (start, end) = curve.knots().domain();
    let sampled = sampled_pairs(curve, samples);
    let difference =
        |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs()) / (end - start);
    let mut comparison = Comparison {
        pairs: pairs.len(),
        ..Comparison::default()
    };
    for wanted in &sampled {
        let nearest = pairs
            .iter()
            .map(|pair| difference(pair, wanted))
            .fold(f64::INFINITY, f64::min);
        if nearest < 1e-7 {
            comparison.error = comparison.error.max(nearest);
        } else {
            comparison.missed += 1;
        }
    }
    for pair in pairs {
        comparison.wrong += usize::from(cosines(curve, *pair).iter().any(|c| c.abs() > 1e-9));
        comparison.unseen +=
            usize::from(!sampled.iter().any(|wanted| difference(pair, wanted) < 1e-7));
    }
    comparison
}
