//! Rational Bézier segments: evaluation, splitting, signs of polynomials.

use crate::math::{Point3, Vector3};

/// Degree of an edge's curve at most.
pub(super) const MOST_DEGREE: usize = 20;
/// Coefficients of the polynomials that are made of such a curve.
pub(super) const MOST_TERMS: usize = 3 * MOST_DEGREE;

/// A control point times its weight, and the weight.
pub(super) type Homogeneous = [f64; 4];

/// The point and the derivative of a segment at t, both homogeneous.
pub(super) fn evaluate(points: &[Homogeneous], t: f64) -> (Homogeneous, Homogeneous) {
    let d = points.len() - 1;
    let mut work = [[0.0; 4]; MOST_DEGREE + 1];
    work[..=d].copy_from_slice(points);
    let mut slope = [0.0; 4];
    for round in 0..d {
        if round + 1 == d {
            slope = std::array::from_fn(|k| d as f64 * (work[1][k] - work[0][k]));
        }
        for i in 0..d - round {
            work[i] = mix(&work[i], &work[i + 1], t);
        }
    }
    (work[0], slope)
}

fn mix(a: &Homogeneous, b: &Homogeneous, t: f64) -> Homogeneous {
    std::array::from_fn(|k| a[k] * (1.0 - t) + b[k] * t)
}

/// The point of a segment at t, m.
pub(super) fn point(points: &[Homogeneous], t: f64) -> Point3 {
    projected(&evaluate(points, t).0)
}

/// The derivative of a segment at t, m.
pub(super) fn slope(points: &[Homogeneous], t: f64) -> Vector3 {
    let (p, d) = evaluate(points, t);
    Vector3::from_fn(|k, _| (d[k] - p[k] / p[3] * d[3]) / p[3])
}

/// Where a homogeneous point is.
pub(super) fn projected(h: &Homogeneous) -> Point3 {
    Point3::new(h[0] / h[3], h[1] / h[3], h[2] / h[3])
}

/// Both parts of a segment, divided at t.
pub(super) fn split(points: &[Homogeneous], t: f64) -> (Vec<Homogeneous>, Vec<Homogeneous>) {
    let n = points.len();
    let mut low = Vec::with_capacity(n);
    let mut high = points.to_vec();
    for round in 0..n {
        low.push(high[0]);
        for i in 0..n - 1 - round {
            high[i] = mix(&high[i], &high[i + 1], t);
        }
    }
    (low, high)
}

/// The part of a segment between two parameters, a < b.
pub(super) fn between(points: &[Homogeneous], [a, b]: [f64; 2]) -> Vec<Homogeneous> {
    let upper = match a > 0.0 {
        true => split(points, a).1,
        false => points.to_vec(),
    };
    match b < 1.0 {
        true => split(&upper, (b - a) / (1.0 - a)).0,
        false => upper,
    }
}

/// The product of two polynomials in Bernstein form.
pub(super) fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let (m, n) = (a.len() - 1, b.len() - 1);
    let mut out = vec![0.0; m + n + 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            out[i + j] += binomial(m, i) * binomial(n, j) / binomial(m + n, i + j) * x * y;
        }
    }
    out
}

/// The derivative of a polynomial in Bernstein form.
pub(super) fn derivative(a: &[f64]) -> Vec<f64> {
    let d = (a.len() - 1) as f64;
    match a.len() {
        0 | 1 => vec![0.0],
        _ => a.windows(2).map(|w| d * (w[1] - w[0])).collect(),
    }
}

fn binomial(n: usize, k: usize) -> f64 {
    let k = k.min(n - k);
    (0..k).fold(1.0, |b, i| b * (n - i) as f64 / (i + 1) as f64)
}

/// A polynomial in Bernstein form at t.
pub(super) fn value(a: &[f64], t: f64) -> f64 {
    let mut work = [0.0; MOST_TERMS + 1];
    let n = a.len();
    work[..n].copy_from_slice(a);
    for round in 1..n {
        for i in 0..n - round {
            work[i] = work[i] * (1.0 - t) + work[i + 1] * t;
        }
    }
    work[0]
}

/// Halves of a polynomial in Bernstein form: the first replaces it, the second is returned in `high`.
pub(super) fn halve(low: &mut [f64], high: &mut [f64]) {
    let n = low.len();
    high.copy_from_slice(low);
    for round in 0..n {
        low[round] = high[0];
        for i in 0..n - 1 - round {
            high[i] = 0.5 * (high[i] + high[i + 1]);
        }
    }
}

/// How often the coefficients change sign, those within `noise` of 0 passed over.
pub(super) fn variations(a: &[f64], noise: f64) -> usize {
    let mut last = 0.0;
    let mut count = 0;
    for &x in a.iter().filter(|x| x.abs() > noise) {
        count += usize::from(last * x < 0.0);
        last = x.signum();
    }
    count
}

/// Where a polynomial in Bernstein form changes sign within (0, 1), ascending. Roots nearer to each other than 1e-6
/// may be passed over in pairs.
pub(super) fn sign_changes(a: &[f64]) -> Vec<f64> {
    let most = a.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let noise = 1e-13 * most;
    let mut found = Vec::new();
    let mut waiting = vec![(a.to_vec(), 0.0, 1.0, 0)];
    while let Some((part, t0, t1, depth)) = waiting.pop() {
        let changes = variations(&part, noise);
        if changes == 0 || (depth > 20 && changes.is_multiple_of(2)) {
            continue;
        }
        let (first, last) = (part[0], part[part.len() - 1]);
        if changes == 1 && first.abs() > noise && last.abs() > noise || depth > 20 {
            found.push(t0 + (t1 - t0) * root(&part));
            continue;
        }
        let middle = 0.5 * (t0 + t1);
        let (mut low, mut high) = (part.clone(), part);
        halve(&mut low, &mut high);
        let on = low[low.len() - 1].abs() <= noise;
        if on && variations(&low, noise) + variations(&high, noise) < changes {
            found.push(middle);
        }
        waiting.push((high, middle, t1, depth + 1));
        waiting.push((low, t0, middle, depth + 1));
    }
    found.sort_unstable_by(f64::total_cmp);
    found
}

/// The root of a polynomial in Bernstein form whose values at 0 and 1 differ in sign; the nearer end where they do not.
pub(super) fn root(a: &[f64]) -> f64 {
    let (mut fa, mut fb) = (a[0], a[a.len() - 1]);
    if fa * fb > 0.0 {
        return if fa.abs() < fb.abs() { 0.0 } else { 1.0 };
    }
    if fa == 0.0 {
        return 0.0;
    }
    let (mut t0, mut t1) = (0.0, 1.0);
    // The secant of Illinois, halving where it is slow.
    let mut side = 0;
    for k in 0..100 {
        let mut t = (t0 * fb - t1 * fa) / (fb - fa);
        if k % 4 == 3 || !(t > t0 && t < t1) {
            t = 0.5 * (t0 + t1);
        }
        if t <= t0 || t >= t1 {
            break;
        }
        let f = value(a, t);
        if f == 0.0 {
            return t;
        }
        if f * fb > 0.0 {
            (t1, fb) = (t, f);
            if side == 1 {
                fa *= 0.5;
            }
            side = 1;
        } else {
            (t0, fa) = (t, f);
            if side == -1 {
                fb *= 0.5;
            }
            side = -1;
        }
        if t1 - t0 <= 1e-16 {
            break;
        }
    }
    0.5 * (t0 + t1)
}
