//! Elastic constants.

/// How far above the least stable weight of rest the matrix is, so that strained cells can be
/// followed too: at ν = 0.3 a cell is held back once I_C is 15 % above that of rest.
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
    /// Weight of the bounding Laplacian, Pa.
    ///
    /// The step from the inertial prediction is stable while L >= 3/4 K. At rest K is at most 2 μ + 3 λ
    /// times the Laplacian of the same quadrature (pure dilatation, which a free body can do), and
    /// 3/2 (λ + 2 μ) is 1.5 times what backward Euler needs for waves of compression.
    pub(in crate::body) fn bounding_pa(&self) -> f64 {
        let (shear, lame) = self.lame_pa();
        1.5 * MARGIN * (lame + 2.0 * shear).max(1.5 * lame + shear)
    }
}
