//! The law of a spring, for four of them side by side.

use crate::body::material::Stiffening;
use palpate_geometry::math::lanes::{Four, Lanes};

/// No stiffening.
const PLAIN: Stiffening = Stiffening {
    strain: f64::INFINITY,
    ratio: 1.0,
    least_length: 0.0,
    least_length_ratio: 1.0,
};
/// Lengths below this count as this long: the force of a spring without length is then zero, not
/// undefined.
const LEAST_LENGTH: f64 = 1e-100;

/// Constants of the law in registers. Plain springs do no work for `STIFFENING`.
#[derive(Clone, Copy)]
pub(super) struct Pull<L, const STIFFENING: bool> {
    far: L,
    near: L,
    more_far: L,
    more_near: L,
    zero: L,
    least: L,
}

impl<L: Lanes, const STIFFENING: bool> Pull<L, STIFFENING> {
    #[inline(always)]
    pub(super) fn new(law: Option<&Stiffening>) -> Self {
        let law = match law {
            Some(law) => *law,
            None => PLAIN,
        };
        Self {
            far: L::splat(1.0 + law.strain.min(1e100)),
            near: L::splat(law.least_length),
            more_far: L::splat(law.ratio - 1.0),
            more_near: L::splat(law.least_length_ratio - 1.0),
            zero: L::splat(0.0),
            least: L::splat(LEAST_LENGTH),
        }
    }

    /// k (|d| − L) / |d|, N/m, of d = (x, y, z).
    #[inline(always)]
    pub(super) fn of(&self, [x, y, z]: [L; 3], stiffness: &Four, rest: &Four) -> L {
        let length = (x * x + y * y + z * z).sqrt().greatest(self.least);
        let rest = L::load(rest);
        let mut stretch = length - rest;
        if STIFFENING {
            let over = (length - rest * self.far).greatest(self.zero);
            let under = (length - rest * self.near).least(self.zero);
            stretch = stretch + over * self.more_far + under * self.more_near;
        }
        L::load(stiffness) * stretch / length
    }
}
