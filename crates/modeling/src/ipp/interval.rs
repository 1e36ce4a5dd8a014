//! Intervals with outward rounding: the exact result of an operation on any members lies inside the
//! result.
//!
//! Each bound is rounded to nearest and then moved one number outwards, which covers the half unit
//! in the last place of IEEE 754 arithmetic. Bounds that overflow become infinite and stay valid.

use std::ops::{Add, Mul, Neg, Sub};

/// All numbers from `lo` to `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower bound.
    pub lo: f64,
    /// Upper bound, at or above `lo`.
    pub hi: f64,
}

impl Interval {
    /// Zero, exactly.
    pub const ZERO: Self = Self { lo: 0.0, hi: 0.0 };

    /// One number.
    pub fn point(x: f64) -> Self {
        Self { lo: x, hi: x }
    }

    /// Everything within `distance` of a number.
    pub fn around(x: f64, distance: f64) -> Self {
        Self {
            lo: (x - distance).next_down(),
            hi: (x + distance).next_up(),
        }
    }

    /// A number near the middle.
    pub fn mid(self) -> f64 {
        0.5 * self.lo + 0.5 * self.hi
    }

    /// No member is further from [`Interval::mid`] than this.
    pub fn radius(self) -> f64 {
        let mid = self.mid();
        (mid - self.lo).max(self.hi - mid).next_up()
    }

    /// The largest absolute value of a member.
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// True when 0 is a member.
    pub fn has_zero(self) -> bool {
        self.lo <= 0.0 && self.hi >= 0.0
    }

    /// Times a factor of at least 0 that is known to a relative error of `slack`.
    pub fn scaled(self, factor: f64, slack: f64) -> Self {
        let (lo, hi) = (self.lo * factor, self.hi * factor);
        Self {
            lo: (lo - lo.abs() * slack).next_down(),
            hi: (hi + hi.abs() * slack).next_up(),
        }
    }

    /// `(1 − t) self + t other`; t may be a little outside [0, 1].
    pub fn lerp(self, other: Self, t: f64) -> Self {
        let s = 1.0 - t;
        let (a, b) = if s < 0.0 {
            (self.hi, self.lo)
        } else {
            (self.lo, self.hi)
        };
        let (c, d) = if t < 0.0 {
            (other.hi, other.lo)
        } else {
            (other.lo, other.hi)
        };
        // 1 − t, the two products and the sum are rounded by half a unit each, of terms no larger
        // than their sizes.
        let slack = |x: f64, y: f64| 2.0 * f64::EPSILON * ((s * x).abs() + (t * y).abs());
        Self {
            lo: (s * a + t * c - slack(a, c)).next_down(),
            hi: (s * b + t * d + slack(b, d)).next_up(),
        }
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            lo: (self.lo + other.lo).next_down(),
            hi: (self.hi + other.hi).next_up(),
        }
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + (-other)
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            lo: -self.hi,
            hi: -self.lo,
        }
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.lo * other.lo, self.lo * other.hi);
        let (c, d) = (self.hi * other.lo, self.hi * other.hi);
        Self {
            lo: a.min(b).min(c.min(d)).next_down(),
            hi: a.max(b).max(c.max(d)).next_up(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    /// a · b as an unevaluated sum, exact (Dekker 1971).
    fn exact_product(a: f64, b: f64) -> (f64, f64) {
        let split = |x: f64| {
            let big = 134_217_729.0 * x;
            let high = big - (big - x);
            (high, x - high)
        };
        let (p, (ah, al), (bh, bl)) = (a * b, split(a), split(b));
        (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
    }

    /// `(value, rest)` is inside: the rest is smaller than half a unit in the last place of the
    /// value.
    fn holds(interval: Interval, (value, rest): (f64, f64)) -> bool {
        let above = interval.lo < value || (interval.lo == value && rest >= 0.0);
        let below = interval.hi > value || (interval.hi == value && rest <= 0.0);
        above && below
    }

    #[test]
    fn exact_results_are_inside_and_the_bounds_are_close() {
        let mut random = Random(1);
        for _ in 0..20_000 {
            let (a, b) = (random.float(-9.0, 9.0), random.float(-1e-3, 1e-3));
            let (x, y) = (Interval::point(a), Interval::point(b));
            let product = exact_product(a, b);
            assert!(holds(x * y, product), "{a} × {b}");
            assert!((x * y).radius() <= 3.0 * f64::EPSILON * product.0.abs());
            let sum = a + b;
            let rest = if a.abs() > b.abs() {
                b - (sum - a)
            } else {
                a - (sum - b)
            };
            assert!(holds(x + y, (sum, rest)), "{a} + {b}");
        }
    }

    #[test]
    fn all_members_of_wide_operands_stay_inside() {
        let mut random = Random(2);
        for _ in 0..5_000 {
            let x = Interval::around(random.float(-1.0, 1.0), random.float(0.0, 0.5));
            let y = Interval::around(random.float(-1.0, 1.0), random.float(0.0, 0.5));
            let (a, b) = (random.float(x.lo, x.hi), random.float(y.lo, y.hi));
            let t = random.float(-0.1, 1.1);
            for (whole, member) in [
                (x * y, a * b),
                (x + y, a + b),
                (x - y, a - b),
                (-x, -a),
                (x.lerp(y, t), (1.0 - t) * a + t * b),
            ] {
                assert!(
                    whole.lo <= member && member <= whole.hi,
                    "{member} outside {whole:?}"
                );
            }
        }
    }
}
