//! Changes of basis: the control points of the same curve over other knots, or one degree higher.
//!
//! Every new control point is the blossom of some polynomial piece of the curve at the new point's
//! inner knots, so it is a weighted sum of `degree + 1` old ones; the weights depend on the knots
//! only. Rows come from the Oslo algorithm (Cohen, Lyche & Riesenfeld 1980), whose weights are
//! never negative when the new knots refine the old ones. A point one degree higher is the mean of
//! the blossoms that leave out one of its inner knots (Prautzsch 1984): again a convex sum, with
//! none of the cancellation of going by way of Bézier pieces and removing knots.

use super::{KnotError, KnotKind, KnotVector, MAX_DEGREE, Side};

const WIDTH: usize = MAX_DEGREE + 1;

/// A matrix from the control points over one knot vector to those over another.
#[derive(Clone, Debug, PartialEq)]
pub struct BasisChange {
    knots: KnotVector,
    old_count: usize,
    /// (new count) column of the first weight, below the old count; later ones follow, round the
    /// end if need be.
    first: Vec<usize>,
    /// (new count × width)
    weights: Vec<f64>,
    width: usize,
}

impl KnotVector {
    /// To the clamped vector of the part from `start` to `end`. A periodic part may pass the seam:
    /// `end` is then above `start` by a period at most, or below it and meant a period on.
    ///
    /// # Errors
    /// An end that is not finite or outside the domain, or an empty part.
    pub fn restriction(&self, start: f64, end: f64) -> Result<BasisChange, KnotError> {
        if !self.is_periodic() {
            return self.part(self.checked(start)?, self.checked(end)?);
        }
        let (inside, period) = (
            self.confine_from(self.checked(start)?, Side::Right),
            self.length(),
        );
        if !end.is_finite() {
            return Err(KnotError::Parameter(end));
        }
        let length = if end > start {
            end - start
        } else {
            end - start + period
        };
        // A whole turn may come out a rounding longer.
        if length > period * (1.0 + 1e-12) {
            return Err(KnotError::Outside {
                value: end,
                start,
                end: start + period,
            });
        }
        if inside == start && end > start && end <= self.domain().1 {
            return self.part(start, end);
        }
        self.part(inside, inside + length.min(period))
    }

    /// To the clamped vector over the whole domain.
    pub fn clamping(&self) -> BasisChange {
        let (start, end) = self.domain();
        self.part(start, end)
            .expect("the domain is a part of itself")
    }

    fn part(&self, start: f64, end: f64) -> Result<BasisChange, KnotError> {
        if start >= end {
            return Err(KnotError::EmptyDomain(start));
        }
        let p = self.degree();
        let old = Unrolled::new(self);
        let mut knots = vec![start; p + 1];
        knots.extend(
            old.knots
                .iter()
                .copied()
                .filter(|&knot| knot > start && knot < end),
        );
        knots.extend(std::iter::repeat_n(end, p + 1));
        let new = Self::new(p, knots)?;
        let rows = (0..new.count()).map(|j| old.row(new.knots()[j], &new.knots()[j + 1..=j + p]));
        Ok(BasisChange::from_rows(new.clone(), self.count(), rows))
    }

    /// To one degree higher: every knot once more.
    ///
    /// # Errors
    /// The degree would pass [`MAX_DEGREE`].
    pub fn elevation(&self) -> Result<BasisChange, KnotError> {
        let p = self.degree();
        if p == MAX_DEGREE {
            return Err(KnotError::Degree(p + 1));
        }
        let new = self.with_multiplicities(p + 1, |m| m + 1)?;
        let (old, unrolled) = (Unrolled::new(self), Unrolled::new(&new));
        let rows = (0..new.count()).map(|j| {
            // A periodic control point is numbered by its last image's knots, `degree` further on.
            let window = &unrolled.knots[unrolled.origin + j..=unrolled.origin + j + p + 1];
            let mut mean = (0, [0.0; WIDTH]);
            let mut args = [0.0; WIDTH];
            for left_out in 1..=p + 1 {
                let kept = window
                    .iter()
                    .enumerate()
                    .skip(1)
                    .filter(|(k, _)| *k != left_out);
                args.iter_mut()
                    .zip(kept)
                    .for_each(|(arg, (_, knot))| *arg = *knot);
                let (first, weights) = old.row(window[0], &args[..p]);
                mean.0 = first;
                mean.1
                    .iter_mut()
                    .zip(weights)
                    .for_each(|(sum, weight)| *sum += weight / (p + 1) as f64);
            }
            mean
        });
        Ok(BasisChange::from_rows(new.clone(), self.count(), rows))
    }

    /// To other knots of the same degree, kind and domain that hold all of these.
    pub fn refinement(&self, new: &Self) -> BasisChange {
        debug_assert_eq!(
            (self.degree(), self.domain()),
            (new.degree(), new.domain()),
            "not a refinement"
        );
        let p = self.degree();
        let (old, unrolled) = (Unrolled::new(self), Unrolled::new(new));
        let rows = (0..new.count()).map(|j| {
            let window = &unrolled.knots[unrolled.origin + j..=unrolled.origin + j + p];
            old.row(window[0], &window[1..])
        });
        BasisChange::from_rows(new.clone(), self.count(), rows)
    }

    /// One degree lower, every knot once less but at least once: the largest space in which to look
    /// for this curve.
    ///
    /// # Errors
    /// The degree is 1 already.
    pub(crate) fn reduced(&self) -> Result<Self, KnotError> {
        self.with_multiplicities(self.degree() - 1, |m| m.saturating_sub(1).max(1))
    }

    /// Another degree, multiplicities changed; kind and domain stay.
    fn with_multiplicities(
        &self,
        degree: usize,
        change: impl Fn(usize) -> usize,
    ) -> Result<Self, KnotError> {
        let (start, end) = self.domain();
        if self.is_periodic() {
            // One period, knots at its end counted at its start.
            let inner: Vec<f64> = self
                .file_knots()
                .iter()
                .copied()
                .filter(|&k| k > start && k < end)
                .collect();
            let at_ends = self.count() - inner.len();
            let mut knots = vec![start; change(at_ends)];
            knots.extend(repeated(&inner, &change));
            knots.push(end);
            return Self::periodic(degree, knots);
        }
        let knots: Vec<f64> = repeated(self.knots(), &change).collect();
        let (last_start, first_end) = (
            knots.partition_point(|&k| k <= start),
            knots.partition_point(|&k| k < end),
        );
        // Enough on either side for the new degree; what lies further out never matters inside the
        // domain.
        let from = last_start.saturating_sub(degree + 1);
        let to = (first_end + degree + 1).min(knots.len());
        let mut kept = knots[from..to].to_vec();
        // Fewer knots than the degree asks for can only be missing outside the domain.
        for _ in 0..(degree + 1).saturating_sub(last_start) {
            kept.insert(0, knots[0]);
        }
        for _ in 0..(degree + 1).saturating_sub(knots.len() - first_end) {
            kept.push(knots[knots.len() - 1]);
        }
        Self::new(degree, kept)
    }
}

/// Each distinct value as often as `change` makes of its multiplicity.
fn repeated(knots: &[f64], change: impl Fn(usize) -> usize) -> impl Iterator<Item = f64> {
    knots
        .chunk_by(|a, b| a == b)
        .flat_map(move |equal| std::iter::repeat_n(equal[0], change(equal.len())))
}

impl BasisChange {
    fn from_rows(
        knots: KnotVector,
        old_count: usize,
        rows: impl Iterator<Item = (usize, [f64; WIDTH])>,
    ) -> Self {
        let mut change = Self {
            width: 0,
            old_count,
            first: Vec::new(),
            weights: Vec::new(),
            knots,
        };
        let rows: Vec<_> = rows.collect();
        // Wide enough for the old degree; the rest of each row is zero.
        change.width = rows
            .iter()
            .map(|(_, row)| row.iter().rposition(|w| *w != 0.0).map_or(1, |k| k + 1))
            .max()
            .unwrap_or(1);
        for (first, row) in rows {
            change.first.push(first);
            change.weights.extend_from_slice(&row[..change.width]);
        }
        change
    }

    /// The new knots.
    pub fn knots(&self) -> &KnotVector {
        &self.knots
    }

    /// Old control points.
    pub fn old_count(&self) -> usize {
        self.old_count
    }

    /// The old control points and weights that make new point `row`: (index, weight), weights above
    /// or below zero only.
    pub fn entries(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + Clone + '_ {
        let weights = &self.weights[row * self.width..(row + 1) * self.width];
        let entries = weights
            .iter()
            .enumerate()
            .filter(|(_, weight)| **weight != 0.0);
        entries.map(move |(k, &weight)| ((self.first[row] + k) % self.old_count, weight))
    }
}

/// The knots of a curve, periods laid out one after the other as far as any window reaches.
struct Unrolled {
    degree: usize,
    count: usize,
    knots: Vec<f64>,
    /// Where the knots of control point 0's window start.
    origin: usize,
    /// Indices of the first and the last span that may be asked.
    spans: (usize, usize),
}

impl Unrolled {
    fn new(vector: &KnotVector) -> Self {
        let (degree, count) = (vector.degree(), vector.count());
        if vector.kind() != KnotKind::Periodic {
            return Self {
                degree,
                count,
                knots: vector.knots().to_vec(),
                origin: 0,
                spans: (degree, count - 1),
            };
        }
        let (start, end) = vector.domain();
        let period = end - start;
        let boundary = |turns: i32| match turns {
            0 => start,
            1 => end,
            _ => start + f64::from(turns) * period,
        };
        // Knots equal modulo the period stay equal: multiplicities are found by equality.
        let image = |knot: f64, turns: i32| match knot {
            k if k == start => boundary(turns),
            k if k == end => boundary(turns + 1),
            k => (k + f64::from(turns) * period).clamp(boundary(turns), boundary(turns + 1)),
        };
        let one = &vector.file_knots()[..count];
        // A part may start near the end of the domain and pass the seam; a window reaches `degree +
        // 1` knots out.
        let turns = -2..=2;
        let knots = turns
            .flat_map(|turn| one.iter().map(move |&knot| image(knot, turn)))
            .collect();
        Self {
            degree,
            count,
            knots,
            origin: 2 * count - degree,
            spans: (count, 4 * count),
        }
    }

    /// Old control points that make the new one whose window starts at `before` and whose inner
    /// knots are `args`.
    fn row(&self, before: f64, args: &[f64]) -> (usize, [f64; WIDTH]) {
        let (p, t) = (self.degree, &self.knots);
        let mut span = t
            .partition_point(|&knot| knot <= before)
            .saturating_sub(1)
            .clamp(self.spans.0, self.spans.1);
        while span < self.spans.1 && t[span] >= t[span + 1] {
            span += 1;
        }
        while t[span] >= t[span + 1] {
            span -= 1;
        }
        let mut share = [0.0; WIDTH];
        // Where the knots around a point did not change it stays as it is, to the last bit.
        let unchanged = (span - p..=span).find(|&i| t[i + 1..=i + p] == *args);
        if let Some(i) = unchanged {
            share[i + p - span] = 1.0;
        } else {
            share[p] = 1.0;
            for r in (1..=p).rev() {
                let x = args[p - r];
                // Step r of de Boor: d_j ← (1 − a_j) d_{j−1} + a_j d_j for j = r ..= p; transposed,
                // from the last step back.
                let mut next = [0.0; WIDTH];
                for j in r..=p {
                    let column = span - p + j;
                    let a = (x - t[column]) / (t[column + p + 1 - r] - t[column]);
                    next[j - 1] += (1.0 - a) * share[j];
                    next[j] += a * share[j];
                }
                share = next;
            }
        }
        // Control point i of the unrolled knots is `origin` before its number.
        (
            (span - p + self.count * 4 - self.origin) % self.count,
            share,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{KINDS, Random, parameters, random_knots, twin_row};
    use super::*;

    fn value(knots: &KnotVector, points: &[f64], u: f64) -> f64 {
        let end = u == knots.domain().1;
        twin_row(knots, u, end, 0)
            .iter()
            .zip(points)
            .map(|(n, p)| n * p)
            .sum()
    }

    fn changed(change: &BasisChange, points: &[f64]) -> Vec<f64> {
        assert_eq!(change.old_count(), points.len());
        (0..change.knots().count())
            .map(|j| change.entries(j).map(|(i, w)| w * points[i]).sum())
            .collect()
    }

    /// Each kind and degree, with random points and parameters inside spans.
    fn cases(seed: u64, mut check: impl FnMut(&mut Random, &KnotVector, &[f64], &[f64])) {
        let mut random = Random(seed);
        for degree in 1..=7 {
            for kind in KINDS {
                for _ in 0..6 {
                    let knots = random_knots(&mut random, degree, kind, degree + 1);
                    let points: Vec<f64> = (0..knots.count())
                        .map(|_| random.float(-1.0, 1.0))
                        .collect();
                    let t = knots.knots();
                    let inside: Vec<f64> = knots
                        .spans()
                        .flat_map(|i| [0.01, 0.4, 0.97].map(|f| t[i] + f * (t[i + 1] - t[i])))
                        .collect();
                    check(&mut random, &knots, &points, &inside);
                }
            }
        }
    }

    #[test]
    fn elevation_leaves_the_curve_where_it_is() {
        cases(51, |_, knots, points, inside| {
            let change = knots.elevation().unwrap();
            assert_eq!(change.knots().degree(), knots.degree() + 1);
            assert_eq!(
                (change.knots().domain(), change.knots().is_periodic()),
                (knots.domain(), knots.is_periodic())
            );
            let new = changed(&change, points);
            for &u in inside {
                let (a, b) = (value(knots, points, u), value(change.knots(), &new, u));
                assert!(
                    (a - b).abs() < 1e-13,
                    "{knots:?} elevated: at {u} {b} is not {a}"
                );
            }
            if knots.kind() != KnotKind::Open {
                let convex =
                    (0..new.len()).all(|j| change.entries(j).all(|(_, weight)| weight > 0.0));
                assert!(convex, "{knots:?}: a weight below zero");
            }
        });
    }

    #[test]
    fn a_part_is_the_same_curve_and_starts_and_ends_on_it() {
        cases(52, |random, knots, points, inside| {
            let (start, end) = knots.domain();
            let [a, b] = [random.float(start, end), random.float(start, end)];
            let (a, b) = if knots.is_periodic() || a < b {
                (a, b)
            } else {
                (b, a)
            };
            let change = knots.restriction(a, b).unwrap();
            let new = changed(&change, points);
            let (from, to) = change.knots().domain();
            for &u in inside {
                for image in [u, u + knots.length()] {
                    if image > from && image < to && (image == u || knots.is_periodic()) {
                        let (x, y) = (value(knots, points, u), value(change.knots(), &new, image));
                        assert!(
                            (x - y).abs() < 1e-12,
                            "{knots:?} from {a} to {b}: at {image} {y} is not {x}"
                        );
                    }
                }
            }
            let last = knots.confine(to);
            assert!(
                (new[0] - value(knots, points, from)).abs() < 1e-12
                    || knots.multiplicity(from) > knots.degree()
            );
            assert!(
                (new[new.len() - 1] - value(knots, points, last)).abs() < 1e-12
                    || knots.multiplicity(last) > knots.degree()
            );
        });
    }

    #[test]
    fn clamping_keeps_the_whole_curve() {
        cases(53, |_, knots, points, inside| {
            let change = knots.clamping();
            assert_eq!(change.knots().kind(), KnotKind::Clamped);
            let new = changed(&change, points);
            for &u in inside {
                let (a, b) = (value(knots, points, u), value(change.knots(), &new, u));
                assert!(
                    (a - b).abs() < 1e-12,
                    "{knots:?} clamped: at {u} {b} is not {a}"
                );
            }
            if knots.kind() == KnotKind::Clamped {
                assert_eq!(new, points, "nothing to change");
            }
        });
    }

    #[test]
    fn refinement_agrees_with_inserting_knots_one_by_one() {
        cases(54, |random, knots, points, _| {
            let mut old = (knots.clone(), points.to_vec());
            for u in parameters(random, knots, 4) {
                if let Ok(insertion) = old.0.insertion(u) {
                    old = (
                        insertion.knots.clone(),
                        insertion.apply(&old.1, |a, b, alpha| a + alpha * (b - a)),
                    );
                }
            }
            let at_once = changed(&knots.refinement(&old.0), points);
            // Open vectors are extrapolated before and after their domain.
            let tolerance = if knots.kind() == KnotKind::Open {
                1e-9
            } else {
                1e-13
            };
            for (a, b) in at_once.iter().zip(&old.1) {
                assert!(
                    (a - b).abs() < tolerance,
                    "{knots:?} to {:?}: {a} is not {b}",
                    old.0
                );
            }
        });
    }

    #[test]
    fn parts_outside_and_degrees_too_high_are_refused() {
        let knots = KnotVector::clamped_uniform(3, 6).unwrap();
        assert!(matches!(
            knots.restriction(0.2, 1.5),
            Err(KnotError::Outside { value: 1.5, .. })
        ));
        assert_eq!(
            knots.restriction(0.6, 0.6).unwrap_err(),
            KnotError::EmptyDomain(0.6)
        );
        assert!(knots.restriction(f64::NAN, 0.6).is_err());
        let highest = KnotVector::clamped_uniform(MAX_DEGREE, 20).unwrap();
        assert_eq!(
            highest.elevation().unwrap_err(),
            KnotError::Degree(MAX_DEGREE + 1)
        );
    }
}
