//! Exact insertion of one knot: how control points follow from the old ones.
//!
//! Boehm's algorithm; Piegl & Tiller, *The NURBS Book*, §5.2. A periodic knot is inserted together with its images: no
//! two images touch the same control points, since a period has more of them than `degree`.

use super::{KnotError, KnotVector, Side};

/// One inserted knot: `degree` new points take the place of `degree − 1` old ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Insertion {
    /// The knots with the new one.
    pub knots: KnotVector,
    /// New point `first + k` (modulo the new count) is `old[first + k − 1] + alphas[k] (old[first + k] − old[first + k − 1])`,
    /// old indices modulo the old count; points before keep their place, points after move up by one.
    pub first: usize,
    /// (degree), each in [0, 1].
    pub alphas: Vec<f64>,
}

impl KnotVector {
    /// Inserts one knot.
    ///
    /// # Errors
    /// Not finite; outside a domain that does not wrap; or already there `degree + 1` times.
    pub fn insertion(&self, knot: f64) -> Result<Insertion, KnotError> {
        let p = self.degree();
        let (start, end) = self.domain();
        if !knot.is_finite() {
            return Err(KnotError::NotFinite { index: 0, value: knot });
        }
        if !self.is_periodic() && !(knot >= start && knot <= end) {
            return Err(KnotError::Outside { value: knot, start, end });
        }
        let knot = self.confine_from(knot, Side::Right);
        let mut values = self.file_knots().to_vec();
        values.insert(values.partition_point(|&k| k <= knot), knot);
        let knots = if self.is_periodic() { Self::periodic(p, values)? } else { Self::new(p, values)? };
        let span = self.span(knot, Side::Right);
        let t = self.knots();
        let first = span + 1 - p;
        let alphas = (first..=span).map(|i| (knot - t[i]) / (t[i + p] - t[i])).collect();
        Ok(Insertion { knots, first, alphas })
    }
}

impl Insertion {
    /// New points from old ones, `blend(a, b, alpha)` being `a + alpha (b − a)`.
    pub fn apply<T: Copy>(&self, old: &[T], blend: impl Fn(T, T, f64) -> T) -> Vec<T> {
        let count = old.len();
        let degree = self.alphas.len();
        debug_assert_eq!(count + 1, self.knots.count(), "one more point than before");
        let mut new = Vec::with_capacity(count + 1);
        if self.knots.is_periodic() {
            // Walk once round, from the first new point on; then turn to where the period starts.
            for (k, &alpha) in self.alphas.iter().enumerate() {
                new.push(blend(old[(self.first + k - 1) % count], old[(self.first + k) % count], alpha));
            }
            let last = self.first + degree - 1;
            new.extend((0..=count - degree).map(|k| old[(last + k) % count]));
            new.rotate_right(self.first % (count + 1));
        } else {
            new.extend_from_slice(&old[..self.first]);
            for (k, &alpha) in self.alphas.iter().enumerate() {
                new.push(blend(old[self.first + k - 1], old[self.first + k], alpha));
            }
            new.extend_from_slice(&old[self.first + degree - 1..]);
        }
        new
    }
}
