//! Ranges of values: each operation's answer holds everything that its operands can give, rounding
//! included.

use super::tape::{Binary, Unary, whole_power};

/// Everything between two numbers, either of which may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
}

const WHOLE: Interval = Interval {
    low: f64::NEG_INFINITY,
    high: f64::INFINITY,
};

impl Interval {
    /// One number; NaN stands for any value.
    pub fn point(x: f64) -> Self {
        if x.is_nan() {
            WHOLE
        } else {
            Self { low: x, high: x }
        }
    }

    /// Both ends moved outwards by a few roundings: `libm` is right to less than one of them, a
    /// power by squaring to some.
    fn widened(low: f64, high: f64) -> Self {
        if low.is_nan() || high.is_nan() {
            return WHOLE;
        }
        let slack = |x: f64| {
            if x.is_finite() {
                16.0 * f64::EPSILON * x.abs() + f64::MIN_POSITIVE
            } else {
                0.0
            }
        };
        Self {
            low: low - slack(low),
            high: high + slack(high),
        }
    }

    fn holds(&self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// Absolute value |x|.
    fn abs(self) -> Self {
        let (a, b) = (self.low.abs(), self.high.abs());
        Self {
            low: if self.holds(0.0) { 0.0 } else { a.min(b) },
            high: a.max(b),
        }
    }

    /// The ends through a function that grows.
    fn rising(self, f: impl Fn(f64) -> f64) -> Self {
        Self::widened(f(self.low), f(self.high))
    }

    /// A sine that starts `lead` ahead.
    fn wave(self, lead: f64) -> Self {
        use std::f64::consts::{FRAC_PI_2, TAU};
        // Beyond 1e6 the phase itself is uncertain by more than it is worth to find out.
        if !(self.high - self.low < TAU && self.low.abs() < 1e6 && self.high.abs() < 1e6) {
            return Self {
                low: -1.0,
                high: 1.0,
            };
        }
        let (a, b) = (self.low + lead, self.high + lead);
        // Whether a place that repeats with the period lies between, with room for rounding.
        let meets = |x: f64| {
            let k = ((a - 1e-9 - x) / TAU).ceil();
            x + k * TAU <= b + 1e-9
        };
        let (p, q) = (libm::sin(a), libm::sin(b));
        Self {
            low: if meets(-FRAC_PI_2) {
                -1.0
            } else {
                p.min(q) - 1e-9
            },
            high: if meets(FRAC_PI_2) {
                1.0
            } else {
                p.max(q) + 1e-9
            },
        }
    }

    pub(super) fn unary(self, op: Unary) -> Self {
        use std::f64::consts::{FRAC_PI_2, PI};
        match op {
            Unary::Negate => Self {
                low: -self.high,
                high: -self.low,
            },
            Unary::Abs => self.abs(),
            Unary::Sqrt if self.high < 0.0 => WHOLE,
            Unary::Sqrt => Self {
                low: self.low.max(0.0),
                ..self
            }
            .rising(f64::sqrt),
            Unary::Sin => self.wave(0.0),
            Unary::Cos => self.wave(FRAC_PI_2),
            Unary::Tan => {
                let turn = |x: f64| ((x + FRAC_PI_2) / PI).floor();
                let safe = self.low.abs() < 1e6 && self.high.abs() < 1e6;
                if safe && turn(self.low - 1e-9) == turn(self.high + 1e-9) {
                    self.rising(libm::tan)
                } else {
                    WHOLE
                }
            }
            Unary::Exp => self.rising(libm::exp),
            Unary::Ln if self.high <= 0.0 => WHOLE,
            Unary::Ln => {
                let low = if self.low > 0.0 {
                    libm::log(self.low)
                } else {
                    f64::NEG_INFINITY
                };
                Self::widened(low, libm::log(self.high))
            }
            Unary::Tanh => self.rising(libm::tanh),
        }
    }

    pub(super) fn binary(op: Binary, a: Self, b: Self) -> Self {
        match op {
            Binary::Add => Self::widened(a.low + b.low, a.high + b.high),
            Binary::Subtract => Self::widened(a.low - b.high, a.high - b.low),
            Binary::Multiply => {
                Self::corners(a, b, |x, y| if x == 0.0 || y == 0.0 { 0.0 } else { x * y })
            }
            Binary::Divide if b.holds(0.0) => WHOLE,
            Binary::Divide => Self::corners(a, b, |x, y| x / y),
            // a^b = exp(b ln a): monotone in each for a > 0.
            Binary::Power if a.low > 0.0 => Self::corners(a, b, libm::pow),
            Binary::Power => WHOLE,
            Binary::Min => Self {
                low: a.low.min(b.low),
                high: a.high.min(b.high),
            },
            Binary::Max => Self {
                low: a.low.max(b.low),
                high: a.high.max(b.high),
            },
            Binary::Hypot => {
                let (a, b) = (a.abs(), b.abs());
                Self::widened(libm::hypot(a.low, b.low), libm::hypot(a.high, b.high))
            }
            // Away from its cut, the angle turns one way along each side: extremes are at corners.
            Binary::Atan2 if b.low > 0.0 || a.low > 0.0 || a.high < 0.0 => {
                Self::corners(a, b, libm::atan2)
            }
            Binary::Atan2 => Self::widened(-std::f64::consts::PI, std::f64::consts::PI),
        }
    }

    fn corners(a: Self, b: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let values = [
            f(a.low, b.low),
            f(a.low, b.high),
            f(a.high, b.low),
            f(a.high, b.high),
        ];
        if values.iter().any(|x| x.is_nan()) {
            return WHOLE;
        }
        Self::widened(
            values.into_iter().fold(f64::INFINITY, f64::min),
            values.into_iter().fold(f64::NEG_INFINITY, f64::max),
        )
    }

    pub(super) fn whole_power(self, n: i32) -> Self {
        if n < 0 && self.holds(0.0) {
            return WHOLE;
        }
        let x = if n % 2 == 0 { self.abs() } else { self };
        let (p, q) = (whole_power(x.low, n), whole_power(x.high, n));
        let slack = |x: f64| 4.0 * f64::from(n.unsigned_abs()) * f64::EPSILON * x.abs();
        Self::widened(p.min(q) - slack(p.min(q)), p.max(q) + slack(p.max(q)))
    }
}
