//! The length unit of a file.

use crate::surface::file::Unit;
use std::fmt;

/// A length unit as a file names it. Kept as a fraction: a millimetre is 1 / 1000 m, and dividing
/// by 1000 rounds once.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthUnit {
    name: String,
    numerator: f64,
    denominator: f64,
    stated: bool,
}

impl LengthUnit {
    /// `numerator / denominator` metres.
    pub(super) fn of_metres(name: &str, numerator: f64, denominator: f64) -> Self {
        Self {
            name: name.to_owned(),
            numerator,
            denominator,
            stated: true,
        }
    }

    /// Millimetres, the file being silent.
    pub(super) fn assumed_millimetres() -> Self {
        Self {
            stated: false,
            ..Self::of_metres("mm", 1.0, 1e3)
        }
    }

    /// A unit of that many of this.
    pub(super) fn times(&self, name: &str, factor: f64) -> Self {
        Self {
            name: name.to_owned(),
            numerator: self.numerator * factor,
            ..self.clone()
        }
    }

    /// The unit of a model that is `scale` times as large as the thing.
    pub(super) fn divided(&self, scale: f64) -> Self {
        Self {
            denominator: self.denominator * scale,
            ..self.clone()
        }
    }

    /// True unless a file's own factor makes it something else.
    pub(super) fn is_length(&self) -> bool {
        self.metres().is_normal() && self.metres() > 0.0
    }

    pub(super) fn to_metres(&self, value: f64) -> f64 {
        value * self.numerator / self.denominator
    }

    /// The number of this unit that reads back as a length (m), and of several the one with fewest digits; the nearest one
    /// where none does. What it reads back as gives the same number again.
    pub(super) fn of_length(&self, metres: f64) -> f64 {
        let mut value = self.nearest(metres);
        for _ in 0..8 {
            let again = self.nearest(self.to_metres(value));
            if again == value {
                break;
            }
            value = again;
        }
        value
    }

    fn nearest(&self, metres: f64) -> f64 {
        // Not −0 either.
        if metres == 0.0 {
            return 0.0;
        }
        if self.numerator == self.denominator {
            return metres;
        }
        let plain = (metres / self.numerator * self.denominator).to_bits();
        let off = |value: f64| (self.to_metres(value) - metres).abs();
        let near = (0..9).map(|k| f64::from_bits(plain.wrapping_add(k).wrapping_sub(4)));
        let least = near.clone().map(off).fold(f64::INFINITY, f64::min);
        let best = near.filter(|&value| off(value) == least);
        let best = best.min_by_key(|value| format!("{value:?}").len());
        best.unwrap_or(f64::from_bits(plain))
    }

    /// Its name in the file, or its symbol.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its length, m.
    pub fn metres(&self) -> f64 {
        self.numerator / self.denominator
    }

    /// False when the file names none and the format's custom was taken.
    pub fn is_stated(&self) -> bool {
        self.stated
    }
}

impl From<Unit> for LengthUnit {
    fn from(unit: Unit) -> Self {
        Self::of_metres(unit.name(), 1.0, unit.per_metre())
    }
}

impl fmt::Display for LengthUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let assumed = if self.stated {
            ""
        } else {
            " (assumed: the file names no unit)"
        };
        write!(f, "{}{assumed}", self.name)
    }
}
