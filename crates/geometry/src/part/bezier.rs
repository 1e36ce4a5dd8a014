//! Rational Bézier segments: evaluation, splitting, signs of polynomials.

use crate::basis::MAX_DEGREE;
use crate::math::{Point3, Vector3};

/// Coefficients of the polynomials that are made of a curve, at most.
const MOST_TERMS: usize = 3 * MAX_DEGREE;

/// A control point times its weight, and the weight.
pub(crate) type Homogeneous = [f64; 4];

/// The point and the derivative of a segment at t, both homogeneous.
pub(super) fn evaluate(points: &[Homogeneous], t: f64) -> (Homogeneous, Homogeneous) {
    let d = points.len() - 1;
    let mut work = [[0.0; 4]; MAX_DEGREE + 1];
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
pub(crate) fn projected(h: &Homogeneous) -> Point3 {
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

/// Control points of the same segment with its degree raised to `degree`.
pub(crate) fn elevated(points: &[Homogeneous], degree: usize) -> Vec<Homogeneous> {
    let mut points = points.to_vec();
    while points.len() <= degree {
        let n = points.len();
        let mut next = Vec::with_capacity(n + 1);
        for k in 0..=n {
            let t = k as f64 / n as f64;
            next.push(match k {
                0 => points[0],
                _ if k == n => points[n - 1],
                _ => mix(&points[k], &points[k - 1], t),
            });
        }
        points = next;
    }
    points
}

/// A polynomial on [0, 1] by its Bernstein coefficients.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polynomial {
    terms: [f64; MOST_TERMS],
    count: usize,
}

impl FromIterator<f64> for Polynomial {
    fn from_iter<I: IntoIterator<Item = f64>>(coefficients: I) -> Self {
        let mut all = Self {
            terms: [0.0; MOST_TERMS],
            count: 0,
        };
        for x in coefficients {
            all.terms[all.count] = x;
            all.count += 1;
        }
        all
    }
}

impl Polynomial {
    /// One coordinate of a homogeneous curve.
    pub fn of(points: &[Homogeneous], k: usize) -> Self {
        points.iter().map(|h| h[k]).collect()
    }

    fn terms(&self) -> &[f64] {
        &self.terms[..self.count]
    }

    /// At 0 and at 1.
    pub fn ends(&self) -> [f64; 2] {
        [self.terms[0], self.terms[self.count - 1]]
    }

    /// The greatest coefficient.
    pub fn most(&self) -> f64 {
        self.terms().iter().fold(0.0, |m, x| x.abs().max(m))
    }

    /// The product of both.
    pub fn times(&self, other: &Self) -> Self {
        let (m, n) = (self.count - 1, other.count - 1);
        let mut out: Self = (0..=m + n).map(|_| 0.0).collect();
        let mut outer = 1.0;
        for (i, x) in self.terms().iter().enumerate() {
            let mut inner = outer;
            for (j, y) in other.terms().iter().enumerate() {
                out.terms[i + j] += inner * x * y;
                inner *= (n - j) as f64 / (j + 1) as f64;
            }
            outer *= (m - i) as f64 / (i + 1) as f64;
        }
        let mut all = 1.0;
        for k in 0..=m + n {
            out.terms[k] /= all;
            all *= (m + n - k) as f64 / (k + 1) as f64;
        }
        out
    }

    /// Adds so many times another of the same degree.
    pub fn add(&mut self, factor: f64, other: &Self) {
        for (x, y) in self.terms.iter_mut().zip(other.terms()) {
            *x += factor * y;
        }
    }

    /// The derivative.
    pub fn derivative(&self) -> Self {
        let d = (self.count - 1) as f64;
        match self.count {
            1 => [0.0].into_iter().collect(),
            _ => self.terms().windows(2).map(|w| d * (w[1] - w[0])).collect(),
        }
    }

    /// At t.
    pub fn value(&self, t: f64) -> f64 {
        let mut work = self.terms;
        for round in 1..self.count {
            for i in 0..self.count - round {
                work[i] = work[i] * (1.0 - t) + work[i + 1] * t;
            }
        }
        work[0]
    }

    /// On both halves of [0, 1].
    pub fn halves(&self) -> [Self; 2] {
        let (mut low, mut high) = (*self, *self);
        for round in 0..self.count {
            low.terms[round] = high.terms[0];
            for i in 0..self.count - 1 - round {
                high.terms[i] = 0.5 * (high.terms[i] + high.terms[i + 1]);
            }
        }
        [low, high]
    }

    /// How often the coefficients change sign, those within `noise` of 0 passed over: no fewer than its roots.
    pub fn variations(&self, noise: f64) -> usize {
        let mut last = 0.0;
        let mut count = 0;
        for &x in self.terms().iter().filter(|x| x.abs() > noise) {
            count += usize::from(last * x < 0.0);
            last = x.signum();
        }
        count
    }

    /// Where it changes sign within (0, 1), ascending. Two changes nearer to each other than 1e-6 may be passed over.
    pub fn sign_changes(&self) -> Vec<f64> {
        let noise = 1e-13 * self.most();
        let mut found = Vec::new();
        let mut waiting = vec![(*self, 0.0, 1.0, 0)];
        while let Some((part, t0, t1, depth)) = waiting.pop() {
            let changes = part.variations(noise);
            if changes == 0 || (depth > 20 && changes.is_multiple_of(2)) {
                continue;
            }
            let clear = part.ends().iter().all(|x| x.abs() > noise);
            if changes == 1 && clear || depth > 20 {
                found.push(t0 + (t1 - t0) * part.root());
                continue;
            }
            let middle = 0.5 * (t0 + t1);
            let [low, high] = part.halves();
            let on = high.terms[0].abs() <= noise;
            if on && low.variations(noise) + high.variations(noise) < changes {
                found.push(middle);
            }
            waiting.push((high, middle, t1, depth + 1));
            waiting.push((low, t0, middle, depth + 1));
        }
        found.sort_unstable_by(f64::total_cmp);
        found
    }

    /// The root, where the values at 0 and 1 differ in sign; the nearer end where they do not.
    pub fn root(&self) -> f64 {
        let [mut fa, mut fb] = self.ends();
        if fa * fb > 0.0 {
            return if fa.abs() < fb.abs() { 0.0 } else { 1.0 };
        }
        if fa == 0.0 {
            return 0.0;
        }
        if self.count == 2 {
            return fa / (fa - fb);
        }
        // The secant of Illinois, halving where it is slow.
        let (mut t0, mut t1, mut side) = (0.0, 1.0, 0);
        for k in 0..100 {
            let mut t = (t0 * fb - t1 * fa) / (fb - fa);
            if k % 4 == 3 || !(t > t0 && t < t1) {
                t = 0.5 * (t0 + t1);
            }
            if t <= t0 || t >= t1 {
                break;
            }
            let f = self.value(t);
            if f == 0.0 {
                return t;
            }
            if f * fb > 0.0 {
                (t1, fb) = (t, f);
                fa *= if side == 1 { 0.5 } else { 1.0 };
                side = 1;
            } else {
                (t0, fa) = (t, f);
                fb *= if side == -1 { 0.5 } else { 1.0 };
                side = -1;
            }
        }
        0.5 * (t0 + t1)
    }
}
