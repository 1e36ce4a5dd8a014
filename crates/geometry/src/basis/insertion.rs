//! Exact insertion of one knot: how control points follow from the old ones.
//!
//! Boehm's algorithm; Piegl & Tiller, *The NURBS Book*, §5.2. A periodic knot is inserted together
//! with its images: no two images touch the same control points, since a period has more of them
//! than `degree`.

use super::{KnotError, KnotVector, Side};

/// One inserted knot: `degree` new points take the place of `degree − 1` old ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Insertion {
    /// The knots with the new one.
    pub knots: KnotVector,
    /// New point `first + k` (modulo the new count) is `old[first + k − 1] + alphas[k] (old[first +
    /// k] − old[first + k − 1])`, old indices modulo the old count; points before keep their place,
    /// points after move up by one.
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
        let knot = self.confine_from(self.checked(knot)?, Side::Right);
        let mut values = self.file_knots().to_vec();
        values.insert(values.partition_point(|&k| k <= knot), knot);
        let knots = if self.is_periodic() {
            Self::periodic(p, values)?
        } else {
            Self::new(p, values)?
        };
        let span = self.span(knot, Side::Right);
        let t = self.knots();
        let first = span + 1 - p;
        let alphas = (first..=span)
            .map(|i| (knot - t[i]) / (t[i + p] - t[i]))
            .collect();
        Ok(Insertion {
            knots,
            first,
            alphas,
        })
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
                new.push(blend(
                    old[(self.first + k - 1) % count],
                    old[(self.first + k) % count],
                    alpha,
                ));
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

#[cfg(test)]
mod tests {
    use super::super::testing::{KINDS, Random, parameters, random_knots, twin_row};
    use super::*;

    fn value(knots: &KnotVector, points: &[f64], u: f64, from_left: bool) -> f64 {
        twin_row(knots, u, from_left, 0)
            .iter()
            .zip(points)
            .map(|(n, p)| n * p)
            .sum()
    }

    #[test]
    fn insertion_leaves_the_curve_where_it_is() {
        let mut random = Random(21);
        for degree in 1..=7 {
            for kind in KINDS {
                for _ in 0..8 {
                    let knots = random_knots(&mut random, degree, kind, degree + 1);
                    let points: Vec<f64> = (0..knots.count())
                        .map(|_| random.float(-1.0, 1.0))
                        .collect();
                    let (start, end) = knots.domain();
                    let at = parameters(&mut random, &knots, 3);
                    for &knot in &at {
                        let Ok(insertion) = knots.insertion(knot) else {
                            let there = knots.multiplicity(knots.confine_from(knot, Side::Right));
                            assert_eq!(there, degree + 1, "{knots:?} refused {knot}");
                            continue;
                        };
                        let new = insertion.apply(&points, |a, b, alpha| a + alpha * (b - a));
                        assert_eq!(insertion.knots.domain(), (start, end));
                        for &u in &at {
                            for from_left in [false, true] {
                                if insertion.knots.is_periodic() && (u == start || u == end) {
                                    continue;
                                }
                                let (a, b) = (
                                    value(&knots, &points, u, from_left),
                                    value(&insertion.knots, &new, u, from_left),
                                );
                                assert!(
                                    (a - b).abs() < 1e-13,
                                    "{knots:?}, {knot} inserted: at {u} {b} is not {a}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn a_knot_can_be_inserted_until_it_disjoins_and_no_further() {
        for mut knots in [
            KnotVector::clamped_uniform(3, 6).unwrap(),
            KnotVector::periodic_uniform(3, 6).unwrap(),
        ] {
            let mut points: Vec<f64> = (0..6).map(|k| f64::from(k * k % 5)).collect();
            let (before, there) = (
                value(&knots, &points, 0.41, false),
                knots.multiplicity(1.0 / 3.0),
            );
            for _ in there..4 {
                let insertion = knots.insertion(1.0 / 3.0).unwrap();
                points = insertion.apply(&points, |a, b, alpha| a + alpha * (b - a));
                knots = insertion.knots;
            }
            assert!((value(&knots, &points, 0.41, false) - before).abs() < 1e-14);
            assert_eq!(knots.disjoined(), vec![1.0 / 3.0]);
            assert!(matches!(
                knots.insertion(1.0 / 3.0),
                Err(KnotError::Multiplicity {
                    multiplicity: 5,
                    ..
                })
            ));
        }
    }

    #[test]
    fn knots_outside_the_domain_are_refused_or_wrapped() {
        let clamped = KnotVector::clamped_uniform(3, 6).unwrap();
        assert_eq!(
            clamped.insertion(1.5).unwrap_err().to_string(),
            "1.5 is outside the domain 0 ..= 1"
        );
        assert!(clamped.insertion(f64::NAN).is_err());
        let periodic = KnotVector::periodic_uniform(3, 8).unwrap();
        assert_eq!(
            periodic.insertion(1.3125).unwrap(),
            periodic.insertion(0.3125).unwrap()
        );
    }
}
