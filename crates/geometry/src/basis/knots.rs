//! Knot vectors: degree, knots and how the ends behave, checked once at construction.
//!
//! Piegl & Tiller, *The NURBS Book*, ch. 2. A periodic vector is stored extended: `degree` knots
//! are continued on each side, and basis function `i` of the extended vector belongs to control
//! point `i mod count` (scipy's convention).

/// Largest degree we accept: windows live on the stack.
pub const MAX_DEGREE: usize = 15;

/// Largest absolute value of a knot.
const MAX_KNOT: f64 = 1e20;

/// Shortest span that is not empty.
const MIN_SPAN: f64 = 1e-20;

/// How the ends of a knot vector behave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KnotKind {
    /// Ends repeated `degree + 1` times: the curve starts and ends at its first and last control
    /// point.
    Clamped,
    /// Neither clamped nor periodic: the domain is `knots[degree] ..= knots[count]`.
    Open,
    /// Wraps: parameters are taken modulo the period.
    Periodic,
}

/// Which limit to take at a knot where the basis or its derivatives jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Side {
    /// From smaller parameters.
    Left,
    /// From larger parameters (at the end of the domain: from smaller ones).
    #[default]
    Right,
}

/// Why a knot vector was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum KnotError {
    /// Degree 0 or above [`MAX_DEGREE`].
    #[error("degree {0} is outside 1..={MAX_DEGREE}")]
    Degree(usize),
    /// Wrong number of knots.
    #[error("{given} knots, but degree {degree} with {count} control points needs {needed}")]
    Count {
        /// Given number.
        given: usize,
        /// Polynomial degree.
        degree: usize,
        /// Control points.
        count: usize,
        /// Needed number.
        needed: usize,
    },
    /// Fewer control points than degree + 1.
    #[error("{count} control points are too few for degree {degree}: at least {} are needed", degree + 1)]
    TooFew {
        /// Control points.
        count: usize,
        /// Polynomial degree.
        degree: usize,
    },
    /// A knot that is not finite.
    #[error("knot {index} is {value}, not a finite number")]
    NotFinite {
        /// Index in the list.
        index: usize,
        /// The value given.
        value: f64,
    },
    /// A knot smaller than the one before it.
    #[error("knot {index} ({value}) is smaller than the one before it ({previous})")]
    Decreasing {
        /// Index in the list.
        index: usize,
        /// The value given.
        value: f64,
        /// The one before.
        previous: f64,
    },
    /// A knot repeated more than degree + 1 times.
    #[error("knot {value} is repeated {multiplicity} times; degree {degree} allows {}", degree + 1)]
    Multiplicity {
        /// The value given.
        value: f64,
        /// How often.
        multiplicity: usize,
        /// Polynomial degree.
        degree: usize,
    },
    /// A knot so large that what is computed of it may overflow.
    #[error("knot {index} is {value:e}; knots stay within ±{MAX_KNOT:e}")]
    Large {
        /// Index in the list.
        index: usize,
        /// The value given.
        value: f64,
    },
    /// A span so short that curvatures, which its inverse powers enter, may overflow.
    #[error("knots {} and {index} are {span:e} apart: make them equal, or at least {MIN_SPAN:e} apart", index - 1)]
    TooClose {
        /// The second of the two.
        index: usize,
        /// Their distance.
        span: f64,
    },
    /// A parameter that is not a number.
    #[error("parameter {0} is not a finite number")]
    Parameter(f64),
    /// A parameter outside a domain that does not wrap.
    #[error("{value} is outside the domain {start} ..= {end}")]
    Outside {
        /// The value given.
        value: f64,
        /// First parameter.
        start: f64,
        /// Last parameter.
        end: f64,
    },
    /// Nothing there to remove.
    #[error("{0} is not a knot inside the domain")]
    NotAKnot(f64),
    /// First and last knot of the domain are equal.
    #[error("the domain is empty: it starts and ends at {0}")]
    EmptyDomain(f64),
}

/// A degree with its knots: finite, non-decreasing, no multiplicity above `degree + 1`, a domain of
/// positive length.
#[derive(Clone, Debug, PartialEq)]
pub struct KnotVector {
    degree: usize,
    kind: KnotKind,
    /// Control points (a period's worth when periodic).
    count: usize,
    /// (basis_count + degree + 1), extended when periodic.
    knots: Vec<f64>,
}

impl KnotVector {
    /// Clamped or open: the full vector, `count + degree + 1` knots.
    ///
    /// # Errors
    /// The first rule of [`KnotError`] that the knots break.
    ///
    /// # Examples
    /// ```
    /// use palpate_geometry::basis::KnotVector;
    /// // Knots must not decrease.
    /// assert!(KnotVector::new(1, vec![0.0, 0.0, 2.0, 1.0, 1.0]).is_err());
    /// assert_eq!(KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0])?.count(), 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(degree: usize, knots: Vec<f64>) -> Result<Self, KnotError> {
        if degree == 0 || degree > MAX_DEGREE {
            return Err(KnotError::Degree(degree));
        }
        let order = degree + 1;
        let count = knots.len().saturating_sub(order);
        if count < order {
            return Err(KnotError::TooFew { count, degree });
        }
        check_values(degree, &knots)?;
        let (start, end) = (knots[degree], knots[count]);
        if start >= end {
            return Err(KnotError::EmptyDomain(start));
        }
        let clamped = knots[0] == start && knots[count + degree] == end;
        let kind = if clamped {
            KnotKind::Clamped
        } else {
            KnotKind::Open
        };
        Ok(Self {
            degree,
            kind,
            count,
            knots,
        })
    }

    /// Periodic: one period, `count + 1` knots.
    ///
    /// # Errors
    /// The first rule of [`KnotError`] that the knots break.
    pub fn periodic(degree: usize, period_knots: Vec<f64>) -> Result<Self, KnotError> {
        if degree == 0 || degree > MAX_DEGREE {
            return Err(KnotError::Degree(degree));
        }
        let count = period_knots.len().saturating_sub(1);
        if count < degree + 1 {
            return Err(KnotError::TooFew { count, degree });
        }
        check_values(degree, &period_knots)?;
        let period = period_knots[count] - period_knots[0];
        if period <= 0.0 {
            return Err(KnotError::EmptyDomain(period_knots[0]));
        }
        // Rounding may not part or swap knots that are equal modulo the period: multiplicities are
        // counted by equality.
        let (start, end) = (period_knots[0], period_knots[count]);
        let before = |knot: f64| {
            if knot == end {
                start
            } else {
                (knot - period).min(start)
            }
        };
        let after = |knot: f64| {
            if knot == start {
                end
            } else {
                (knot + period).max(end)
            }
        };
        let mut knots = Vec::with_capacity(count + 1 + 2 * degree);
        knots.extend((0..degree).map(|k| before(period_knots[count - degree + k])));
        knots.extend_from_slice(&period_knots);
        knots.extend((1..=degree).map(|k| after(period_knots[k])));
        check_values(degree, &knots)?;
        Ok(Self {
            degree,
            kind: KnotKind::Periodic,
            count,
            knots,
        })
    }

    /// Clamped with equally spaced interior knots on [0, 1].
    ///
    /// # Errors
    /// Degree out of range, or fewer than `degree + 1` control points.
    ///
    /// # Examples
    /// ```
    /// use palpate_geometry::basis::KnotVector;
    /// let knots = KnotVector::clamped_uniform(3, 5)?;
    /// assert_eq!(knots.knots(), [0.0, 0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 1.0]);
    /// assert_eq!((knots.degree(), knots.count(), knots.domain()), (3, 5, (0.0, 1.0)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn clamped_uniform(degree: usize, count: usize) -> Result<Self, KnotError> {
        if degree == 0 || degree > MAX_DEGREE {
            return Err(KnotError::Degree(degree));
        }
        if count < degree + 1 {
            return Err(KnotError::TooFew { count, degree });
        }
        let spans = count - degree;
        let mut knots = vec![0.0; degree];
        knots.extend((0..=spans).map(|k| k as f64 / spans as f64));
        knots.extend(std::iter::repeat_n(1.0, degree));
        Self::new(degree, knots)
    }

    /// Periodic with equally spaced knots on [0, 1].
    ///
    /// # Errors
    /// Degree out of range, or fewer than `degree + 1` control points.
    pub fn periodic_uniform(degree: usize, count: usize) -> Result<Self, KnotError> {
        Self::periodic(
            degree,
            (0..=count)
                .map(|k| k as f64 / count.max(1) as f64)
                .collect(),
        )
    }

    /// Polynomial degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// How the ends behave.
    pub fn kind(&self) -> KnotKind {
        self.kind
    }

    /// True when parameters wrap.
    pub fn is_periodic(&self) -> bool {
        self.kind == KnotKind::Periodic
    }

    /// Number of control points.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Number of basis functions of the stored vector: `count`, plus `degree` when periodic.
    pub fn basis_count(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// The stored knots (extended on both sides when periodic).
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The knots as `palpate.surface.v1` writes them: all, or one period of `count + 1`.
    pub fn file_knots(&self) -> &[f64] {
        if self.is_periodic() {
            &self.knots[self.degree..=self.degree + self.count]
        } else {
            &self.knots
        }
    }

    /// First and last parameter.
    pub fn domain(&self) -> (f64, f64) {
        (self.knots[self.degree], self.knots[self.basis_count()])
    }

    /// Length of the domain.
    pub fn length(&self) -> f64 {
        let (start, end) = self.domain();
        end - start
    }

    /// Brings a parameter into the domain: wrapped when periodic, clamped otherwise.
    pub fn confine(&self, u: f64) -> f64 {
        let (start, end) = self.domain();
        if u >= start && u <= end {
            u
        } else if self.is_periodic() {
            let period = end - start;
            let wrapped = u - period * ((u - start) / period).floor();
            wrapped.clamp(start, end)
        } else {
            u.clamp(start, end)
        }
    }

    /// The parameter inside the domain: wrapped when periodic, refused when outside otherwise.
    ///
    /// # Errors
    /// Not finite, or outside a domain that does not wrap.
    pub fn checked(&self, u: f64) -> Result<f64, KnotError> {
        if !u.is_finite() {
            return Err(KnotError::Parameter(u));
        }
        let (start, end) = self.domain();
        if !self.is_periodic() && (u < start || u > end) {
            return Err(KnotError::Outside {
                value: u,
                start,
                end,
            });
        }
        Ok(self.confine(u))
    }

    /// [`KnotVector::confine`], and where a period closes the end is taken for the start (from the
    /// right) or the start for the end (from the left).
    pub fn confine_from(&self, u: f64, side: Side) -> f64 {
        let u = self.confine(u);
        if !self.is_periodic() {
            return u;
        }
        let (start, end) = self.domain();
        match side {
            Side::Right if u >= end => start,
            Side::Left if u <= start => end,
            _ => u,
        }
    }

    /// The span `i` with `knots[i] <= u < knots[i + 1]` (from the right), or `knots[i] < u <=
    /// knots[i + 1]` (from the left), kept inside the domain. `u` must be in the domain.
    pub fn span(&self, u: f64, side: Side) -> usize {
        let first = self.degree;
        let last = self.basis_count() - 1;
        let inner = &self.knots[first..=last + 1];
        let mut i = match side {
            Side::Right => inner.partition_point(|&k| k <= u),
            Side::Left => inner.partition_point(|&k| k < u),
        };
        i = (first + i).saturating_sub(1).clamp(first, last);
        // The end of the domain belongs to the last span of positive length, its start to the
        // first.
        while i > first && self.knots[i] >= self.knots[i + 1] && u >= self.knots[i] {
            i -= 1;
        }
        while i < last && self.knots[i] >= self.knots[i + 1] {
            i += 1;
        }
        i
    }

    /// The spans of positive length, as indices into [`KnotVector::knots`], in order.
    pub fn spans(&self) -> impl Iterator<Item = usize> + '_ {
        (self.degree..self.basis_count()).filter(|&i| self.knots[i] < self.knots[i + 1])
    }

    /// How often a value occurs among the stored knots.
    pub fn multiplicity(&self, value: f64) -> usize {
        self.knots.iter().filter(|&&k| k == value).count()
    }

    /// Returns this knot vector with one occurrence of an interior knot removed.
    ///
    /// # Errors
    /// No such knot strictly inside the domain, or too few control points left.
    pub fn without(&self, knot: f64) -> Result<Self, KnotError> {
        let (start, end) = self.domain();
        let mut knots = self.file_knots().to_vec();
        let inside = knot > start && knot < end;
        let at = knots
            .iter()
            .position(|&k| k == knot)
            .filter(|_| inside)
            .ok_or(KnotError::NotAKnot(knot))?;
        knots.remove(at);
        if self.is_periodic() {
            Self::periodic(self.degree, knots)
        } else {
            Self::new(self.degree, knots)
        }
    }

    /// The knots inside the domain with multiplicity `degree + 1`, where the curve is in two
    /// pieces; when periodic, also the start of the period.
    pub fn disjoined(&self) -> Vec<f64> {
        let (start, end) = self.domain();
        let mut found: Vec<f64> = self
            .knots
            .windows(self.degree + 1)
            .filter(|run| run[0] == run[self.degree])
            .map(|run| run[0])
            .filter(|&knot| (knot > start && knot < end) || (self.is_periodic() && knot == start))
            .collect();
        found.dedup();
        found
    }

    /// The control points after each of which the curve begins anew, in order: where
    /// [`KnotVector::disjoined`] parts it.
    pub fn parted_after(&self) -> Vec<usize> {
        let inside = self
            .disjoined()
            .into_iter()
            .filter(|&knot| knot > self.domain().0);
        inside
            .map(|knot| self.knots.partition_point(|&k| k < knot) - 1)
            .collect()
    }

    /// Greville abscissae, one per control point: means of `degree` knots, where the control point
    /// has most effect.
    pub fn greville(&self) -> Vec<f64> {
        (0..self.count)
            .map(|i| {
                let sum: f64 = self.knots[i + 1..=i + self.degree].iter().sum();
                self.confine(sum / self.degree as f64)
            })
            .collect()
    }
}

fn check_values(degree: usize, knots: &[f64]) -> Result<(), KnotError> {
    let mut multiplicity = 0;
    for (index, &value) in knots.iter().enumerate() {
        if !value.is_finite() {
            return Err(KnotError::NotFinite { index, value });
        }
        if index > 0 && value < knots[index - 1] {
            return Err(KnotError::Decreasing {
                index,
                value,
                previous: knots[index - 1],
            });
        }
        if value.abs() > MAX_KNOT {
            return Err(KnotError::Large { index, value });
        }
        let span = if index > 0 {
            value - knots[index - 1]
        } else {
            0.0
        };
        if span > 0.0 && span < MIN_SPAN {
            return Err(KnotError::TooClose { index, span });
        }
        multiplicity = if index > 0 && value == knots[index - 1] {
            multiplicity + 1
        } else {
            1
        };
        if multiplicity > degree + 1 {
            return Err(KnotError::Multiplicity {
                value,
                multiplicity,
                degree,
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::testing::{KINDS, Random, parameters, random_knots, twin_span};
    use super::*;

    #[test]
    fn spans_hold_their_parameter_and_agree_with_a_scan() {
        let mut random = Random(11);
        for degree in 1..=7 {
            for kind in KINDS {
                for _ in 0..20 {
                    let knots = random_knots(&mut random, degree, kind, degree + 1);
                    let t = knots.knots();
                    for u in parameters(&mut random, &knots, 5) {
                        for side in [Side::Left, Side::Right] {
                            let i = knots.span(u, side);
                            assert!(
                                t[i] < t[i + 1] && t[i] <= u && u <= t[i + 1],
                                "{knots:?}: {u} in span {i}"
                            );
                            assert_eq!(
                                i,
                                twin_span(&knots, u, side == Side::Left),
                                "{knots:?}: {u} from {side:?}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn parameters_wrap_or_are_clamped_into_the_domain() {
        let periodic = KnotVector::periodic(2, vec![1.0, 1.5, 2.0, 3.0]).unwrap();
        for (u, wanted) in [
            (1.0, 1.0),
            (3.0, 3.0),
            (3.25, 1.25),
            (0.5, 2.5),
            (-3.5, 2.5),
            (7.75, 1.75),
        ] {
            assert_eq!(periodic.confine(u), wanted, "{u}");
        }
        assert_eq!(periodic.confine_from(3.0, Side::Right), 1.0);
        assert_eq!(periodic.confine_from(1.0, Side::Left), 3.0);
        let clamped = KnotVector::clamped_uniform(3, 6).unwrap();
        assert_eq!(
            (
                clamped.confine(-1.0),
                clamped.confine(0.25),
                clamped.confine(7.0)
            ),
            (0.0, 0.25, 1.0)
        );
    }

    #[test]
    fn greville_abscissae_reproduce_the_parameter() {
        let mut random = Random(12);
        for degree in 1..=7 {
            for kind in [KnotKind::Clamped, KnotKind::Open] {
                let knots = random_knots(&mut random, degree, kind, degree);
                let greville: Vec<f64> = (0..knots.count())
                    .map(|i| knots.knots()[i + 1..=i + degree].iter().sum::<f64>() / degree as f64)
                    .collect();
                if kind == KnotKind::Clamped {
                    // Means of the same clamped knots need no confining.
                    for (a, b) in greville.iter().zip(knots.greville()) {
                        assert!((a - b).abs() < 1e-15);
                    }
                }
                for u in parameters(&mut random, &knots, 5) {
                    let window = knots.window(u);
                    let sum: f64 = window
                        .values()
                        .iter()
                        .zip(&greville[window.first..])
                        .map(|(n, g)| n * g)
                        .sum();
                    assert!((sum - u).abs() < 1e-13, "{knots:?}: {sum} is not {u}");
                }
            }
        }
    }

    // 0.7 − 0.6 is not 0.1 in f64: the image of a knot must not part from the knot.
    #[test]
    fn periodic_images_keep_multiplicities_when_the_period_rounds() {
        let knots = KnotVector::periodic(3, vec![0.1, 0.2, 0.3, 0.5, 0.7, 0.7]).unwrap();
        assert_eq!(
            (knots.multiplicity(0.1), knots.multiplicity(0.7)),
            (2, 2),
            "{:?}",
            knots.knots()
        );
        let full = KnotVector::periodic(2, vec![0.1, 0.3, 0.4, 0.7, 0.7, 0.7]).unwrap();
        assert_eq!(full.multiplicity(0.1), 3);
        assert_eq!(full.disjoined(), vec![0.1]);
        let error = KnotVector::periodic(2, vec![0.1, 0.1, 0.4, 0.7, 0.7, 0.7]).unwrap_err();
        assert!(
            matches!(
                error,
                KnotError::Multiplicity {
                    multiplicity: 4,
                    ..
                }
            ),
            "{error}"
        );
    }

    #[test]
    fn bad_knots_are_refused_with_what_and_where() {
        let message = |degree, knots: &[f64]| {
            KnotVector::new(degree, knots.to_vec())
                .unwrap_err()
                .to_string()
        };
        assert_eq!(message(0, &[0.0, 1.0]), "degree 0 is outside 1..=15");
        assert_eq!(message(16, &[0.0; 40]), "degree 16 is outside 1..=15");
        assert_eq!(
            message(2, &[0.0, 0.0, 1.0, 1.0]),
            "1 control points are too few for degree 2: at least 3 are needed"
        );
        assert_eq!(
            message(1, &[0.0, 0.0, f64::NAN, 1.0, 1.0]),
            "knot 2 is NaN, not a finite number"
        );
        assert_eq!(
            message(1, &[0.0, 0.0, 0.5, 0.4, 1.0, 1.0]),
            "knot 3 (0.4) is smaller than the one before it (0.5)"
        );
        assert_eq!(
            message(1, &[0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0]),
            "knot 0.5 is repeated 3 times; degree 1 allows 2"
        );
        assert_eq!(
            message(2, &[0.0, 0.5, 1.0, 1.0, 1.0, 2.0]),
            "the domain is empty: it starts and ends at 1"
        );
        assert!(KnotVector::periodic(3, vec![0.0, 1.0, 2.0, 3.0]).is_err());
        assert!(KnotVector::periodic(1, vec![2.0, 2.0, 2.0]).is_err());
        assert!(KnotVector::new(1, vec![0.0, 0.0, f64::INFINITY, f64::INFINITY]).is_err());
        assert_eq!(
            message(1, &[0.0, 0.0, 1e-200, 1.0, 1.0]),
            "knots 1 and 2 are 1e-200 apart: make them equal, or at least 1e-20 apart"
        );
        assert_eq!(
            message(1, &[-1e200, -1e200, 1.0, 1.0]),
            "knot 0 is -1e200; knots stay within ±1e20"
        );
    }

    // Equal but for a rounding, as files have them: a span of one unit in the last place is a span.
    #[test]
    fn knots_one_rounding_apart_are_evaluated() {
        let knots = KnotVector::new(
            2,
            vec![0.0, 0.0, 0.0, 0.6, 0.600_000_000_000_000_1, 1.0, 1.0, 1.0],
        )
        .unwrap();
        for u in [0.6, 0.600_000_000_000_000_1, 0.3, 0.8] {
            let sum: f64 = knots.window(u).values().iter().sum();
            assert!((sum - 1.0).abs() < 1e-14, "{u}");
        }
    }

    #[test]
    fn parameters_are_checked_where_they_come_from_outside() {
        let clamped = KnotVector::clamped_uniform(3, 6).unwrap();
        assert_eq!(clamped.checked(1.0), Ok(1.0));
        assert_eq!(
            clamped.checked(1.5).unwrap_err().to_string(),
            "1.5 is outside the domain 0 ..= 1"
        );
        assert!(matches!(
            clamped.checked(f64::NAN),
            Err(KnotError::Parameter(_))
        ));
        assert_eq!(
            KnotVector::periodic_uniform(3, 6).unwrap().checked(1.5),
            Ok(0.5)
        );
    }
}
