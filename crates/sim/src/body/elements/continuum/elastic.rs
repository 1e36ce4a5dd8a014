//! Elastic constants.

/// How far above the tangent of rest, so that it bounds that of strained cells too.
const MARGIN: f64 = 1.25;

/// Young's modulus and Poisson's ratio at small strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastic {
    /// E, Pa.
    pub young_pa: f64,
    /// ν, in [0, 0.5).
    pub poisson: f64,
}

impl Elastic {
    /// Lamé's μ = E / (2 (1 + ν)) and λ = E ν / ((1 + ν) (1 − 2 ν)), Pa.
    pub fn lame_pa(&self) -> (f64, f64) {
        debug_assert!(self.poisson < 0.5, "λ has no bound");
        let Self { young_pa, poisson } = *self;
        let shear = young_pa / (2.0 * (1.0 + poisson));
        (
            shear,
            young_pa * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
        )
    }

    /// Weight of a Laplacian above the tangent, Pa.
    ///
    /// At rest the tangent is at most 2 μ + 3 λ times the Laplacian of the same quadrature: pure dilatation, which a
    /// free body can do.
    pub(in crate::body) fn steepest_pa(&self) -> f64 {
        let (shear, lame) = self.lame_pa();
        MARGIN * (2.0 * lame + 4.0 * shear).max(3.0 * lame + 2.0 * shear)
    }
}
