//! What a device reports: counts, and velocities from their differences.

use super::model::DeviceModel;
use super::v3;
use std::f64::consts::TAU;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Encoder {
    quantum_m: f64,
    quantum_rad: f64,
    cutoff_hz: f64,
    pub(super) position: [f64; 3],
    pub(super) velocity: [f64; 3],
    pub(super) orientation: [f64; 4],
    pub(super) angular_velocity: [f64; 3],
}

fn counted(value: f64, quantum: f64) -> f64 {
    if quantum > 0.0 {
        (value / quantum).round() * quantum
    } else {
        value
    }
}

fn counted_turn(q: [f64; 4], quantum: f64) -> [f64; 4] {
    if quantum > 0.0 {
        v3::from_vector(v3::to_vector(q).map(|angle| counted(angle, quantum)))
    } else {
        q
    }
}

impl Encoder {
    pub(super) fn new(model: &DeviceModel, position: [f64; 3]) -> Self {
        Self {
            quantum_m: model.encoder_m,
            quantum_rad: model.encoder_rad,
            cutoff_hz: model.velocity_cutoff_hz,
            position: position.map(|x| counted(x, model.encoder_m)),
            velocity: [0.0; 3],
            orientation: v3::UNTURNED,
            angular_velocity: [0.0; 3],
        }
    }

    /// A sample, one period after the last. Without counts the true velocities are reported.
    pub(super) fn sample(
        &mut self,
        (position, velocity): ([f64; 3], [f64; 3]),
        (orientation, angular_velocity): ([f64; 4], [f64; 3]),
        period_s: f64,
    ) {
        // First-order low-pass, exact for a constant input over the period.
        let new = if self.cutoff_hz.is_finite() {
            -libm::expm1(-TAU * self.cutoff_hz * period_s)
        } else {
            1.0
        };
        let toward = |old: [f64; 3], raw: [f64; 3]| v3::add(old, v3::scale(v3::sub(raw, old), new));
        let counts = position.map(|x| counted(x, self.quantum_m));
        self.velocity = match self.quantum_m > 0.0 {
            true => toward(
                self.velocity,
                v3::scale(v3::sub(counts, self.position), 1.0 / period_s),
            ),
            false => velocity,
        };
        self.position = counts;
        let turned = counted_turn(orientation, self.quantum_rad);
        self.angular_velocity = match self.quantum_rad > 0.0 {
            true => {
                let change = v3::to_vector(v3::turn(turned, v3::inverse(self.orientation)));
                toward(self.angular_velocity, v3::scale(change, 1.0 / period_s))
            }
            false => angular_velocity,
        };
        self.orientation = turned;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_their_differences_are_what_is_told() {
        let model = DeviceModel {
            encoder_m: 1e-3,
            encoder_rad: 0.01,
            ..DeviceModel::preset("ideal").unwrap()
        };
        let mut encoder = Encoder::new(&model, [0.0004, 0.0, -0.0006]);
        assert_eq!(encoder.position, [0.0, 0.0, -0.001]);
        let spin = (v3::from_vector([0.0, 0.0, 0.0149]), [9.0; 3]);
        encoder.sample(([0.0017, 0.0005, 0.0], [9.0; 3]), spin, 0.5);
        assert_eq!(encoder.position, [0.002, 0.001, 0.0]);
        assert_eq!(encoder.velocity, [0.004, 0.002, 0.002]);
        assert!((v3::to_vector(encoder.orientation)[2] - 0.01).abs() < 1e-16);
        assert!((encoder.angular_velocity[2] - 0.02).abs() < 1e-15);
    }

    #[test]
    fn the_low_pass_forgets_at_its_cut_off() {
        let model = DeviceModel {
            encoder_m: 1e-6,
            velocity_cutoff_hz: 20.0,
            ..DeviceModel::preset("ideal").unwrap()
        };
        let mut encoder = Encoder::new(&model, [0.0; 3]);
        let still = (v3::UNTURNED, [0.0; 3]);
        // One jump of 1 mm in a period of 1 ms, then rest: 1 m/s, of which 1 − e^{−2π 20 ms/1000}
        // is seen, then decays.
        for k in 0..50 {
            encoder.sample(([1e-3, 0.0, 0.0], [0.0; 3]), still, 1e-3);
            let decay = (-TAU * 20.0 * 1e-3f64).exp();
            let exact = (1.0 - decay) * decay.powi(k);
            assert!((encoder.velocity[0] - exact).abs() < 1e-12, "{k}");
        }
    }

    #[test]
    fn without_counts_the_truth_is_told() {
        let mut encoder = Encoder::new(&DeviceModel::preset("ideal").unwrap(), [0.0; 3]);
        let spin = (v3::from_vector([0.1, 0.2, 0.3]), [4.0, 5.0, 6.0]);
        encoder.sample(([1.0, 2.0, 3.0], [7.0, 8.0, 9.0]), spin, 1e-3);
        assert_eq!(
            (encoder.position, encoder.velocity),
            ([1.0, 2.0, 3.0], [7.0, 8.0, 9.0])
        );
        assert_eq!((encoder.orientation, encoder.angular_velocity), spin);
    }
}
