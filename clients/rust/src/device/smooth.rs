//! Numbers with their rate of change, so that a motion's velocity is its exact derivative.

use std::ops::{Add, Mul, Sub};

/// 0 at 0, 1 at 1, with zero first and second derivative at both ends; held outside (Flash & Hogan
/// 1985).
pub(super) fn ramp(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}

/// A value and its derivative by time (forward-mode differentiation).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Flow {
    pub(super) value: f64,
    pub(super) rate: f64,
}

impl Flow {
    /// Time itself.
    pub(super) fn time(t: f64) -> Self {
        Self {
            value: t,
            rate: 1.0,
        }
    }

    pub(super) fn constant(value: f64) -> Self {
        Self { value, rate: 0.0 }
    }

    /// [`ramp`] of (self − start) / length.
    pub(super) fn ramp(self, start: f64, length: f64) -> Self {
        let t = ((self.value - start) / length).clamp(0.0, 1.0);
        let slope = 30.0 * t * t * (1.0 - t) * (1.0 - t);
        Self {
            value: ramp(t),
            rate: slope * self.rate / length,
        }
    }

    /// Time within the cycle; jumps where the cycle begins anew.
    pub(super) fn cycle(self, length: f64) -> Self {
        Self {
            value: self.value.rem_euclid(length),
            rate: self.rate,
        }
    }

    /// Time since `start`, 0 before.
    pub(super) fn since(self, start: f64) -> Self {
        if self.value > start {
            Self {
                value: self.value - start,
                rate: self.rate,
            }
        } else {
            Self::default()
        }
    }

    pub(super) fn sin(self) -> Self {
        Self {
            value: libm::sin(self.value),
            rate: self.rate * libm::cos(self.value),
        }
    }

    pub(super) fn cos(self) -> Self {
        Self {
            value: libm::cos(self.value),
            rate: -self.rate * libm::sin(self.value),
        }
    }
}

impl Add for Flow {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            rate: self.rate + other.rate,
        }
    }
}

impl Sub for Flow {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            rate: self.rate - other.rate,
        }
    }
}

impl Mul for Flow {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            rate: self.rate * other.value + self.value * other.rate,
        }
    }
}

impl Mul<f64> for Flow {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            rate: self.rate * factor,
        }
    }
}
