//! How stiff a coupling a device can hold.
//!
//! A spring K and a damper B, sampled every T and held, are passive on a device with viscous
//! damping b when `b > K T / 2 + |B|` (Colgate & Schenkel 1997, "Passivity of a class of
//! sampled-data systems"); a delay of t_d between a pose and its force counts as half a period more
//! for each of its own (Gil, Sánchez, Hulin, Preusche & Hirzinger 2009, "Stability boundary for
//! haptic rendering"). An encoder of step Δ makes energy that only dry friction f_c takes: `K ≤ 2
//! f_c / Δ` (Abbott & Okamura 2005, "Effects of position quantization and sampling rate on
//! virtual-wall passivity").

use palpate_geometry::math::{StateError, StateSink, StateSource};

/// What decides how stiff a device may be coupled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceFigures {
    /// Viscous damping b, N·s/m.
    pub damping_n_s_m: f64,
    /// Dry friction f_c, N.
    pub coulomb_n: f64,
    /// Step of the encoders at the tool Δ, m.
    pub encoder_m: f64,
    /// Longest time between two poses, or two forces, T, s.
    pub period_s: f64,
    /// From a pose to its force, beyond the hold, t_d, s.
    pub delay_s: f64,
}

/// The two limits of a coupling's stiffness, N/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StiffnessLimits {
    /// Above it oscillations grow: 2 (b − |B|) / (T + 2 t_d).
    pub sampling_n_m: f64,
    /// Above it the encoder's steps keep a small tremble alive: 2 f_c / Δ; infinite without an
    /// encoder's step.
    pub quantization_n_m: f64,
}

impl DeviceFigures {
    /// Limits with a coupling damper of `damping_n_s_m`; none below 0.
    pub fn stiffness_limits(&self, damping_n_s_m: f64) -> StiffnessLimits {
        let left = (self.damping_n_s_m - damping_n_s_m.abs()).max(0.0);
        let quantization_n_m = if self.encoder_m > 0.0 {
            2.0 * self.coulomb_n / self.encoder_m
        } else {
            f64::INFINITY
        };
        StiffnessLimits {
            sampling_n_m: 2.0 * left / (self.period_s + 2.0 * self.delay_s),
            quantization_n_m,
        }
    }
}

impl StiffnessLimits {
    /// Passive in any hand.
    pub fn passive_n_m(&self) -> f64 {
        self.sampling_n_m.min(self.quantization_n_m)
    }
}

/// The limits of a device that has sent its description; part of the state, because it may come at any
/// tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceBounds {
    /// Greatest force, N.
    pub force_max_n: f64,
    /// Greatest torque, N·m.
    pub torque_max_nm: f64,
    /// Stiffest coupling, N/m.
    pub stiffness_max_n_m: f64,
}

impl Default for DeviceBounds {
    /// Whatever the scene says.
    fn default() -> Self {
        Self {
            force_max_n: f64::INFINITY,
            torque_max_nm: f64::INFINITY,
            stiffness_max_n_m: f64::INFINITY,
        }
    }
}

impl DeviceBounds {
    /// The three, if they can be bounds.
    pub fn checked(self) -> Option<Self> {
        // A NaN is in no range.
        let sound =
            self.force_max_n >= 0.0 && self.torque_max_nm >= 0.0 && self.stiffness_max_n_m > 0.0;
        sound.then_some(self)
    }

    /// All of it, in order.
    pub fn save(&self, sink: &mut impl StateSink) {
        sink.floats(&[self.force_max_n, self.torque_max_nm, self.stiffness_max_n_m]);
    }

    /// In the order of [`DeviceBounds::save`].
    ///
    /// # Errors
    /// The source is too short.
    pub fn restore(&mut self, source: &mut impl StateSource) -> Result<(), StateError> {
        let mut values = [0.0; 3];
        source.floats(&mut values)?;
        [self.force_max_n, self.torque_max_nm, self.stiffness_max_n_m] = values;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_those_of_the_papers() {
        let figures = DeviceFigures {
            damping_n_s_m: 2.0,
            coulomb_n: 0.05,
            encoder_m: 5e-5,
            period_s: 1e-3,
            delay_s: 0.0,
        };
        let limits = figures.stiffness_limits(0.5);
        assert!(
            (limits.sampling_n_m - 3_000.0).abs() < 1e-9
                && (limits.quantization_n_m - 2_000.0).abs() < 1e-9
        );
        assert_eq!(limits.passive_n_m(), limits.quantization_n_m);
        // A delay of half a period doubles the lag.
        let late = DeviceFigures {
            delay_s: 0.5e-3,
            ..figures
        };
        assert!((late.stiffness_limits(0.5).sampling_n_m - 1_500.0).abs() < 1e-9);
        // A damper beyond the device's own leaves nothing, whichever its sign.
        assert_eq!(figures.stiffness_limits(-3.0).sampling_n_m, 0.0);
        assert_eq!(
            DeviceFigures {
                encoder_m: 0.0,
                ..figures
            }
            .stiffness_limits(0.0)
            .passive_n_m(),
            4_000.0
        );
    }
}
