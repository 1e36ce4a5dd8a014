//! Mass, damping and hand, integrated exactly for a force that is held over a step.

use palpate_proto::messages::ToolPose;

/// A device with a hand on it. Typical of a desktop device held in a relaxed pinch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceParameters {
    /// Apparent mass, kg.
    pub mass_kg: f64,
    /// Viscous damping of the device, N·s/m.
    pub damping_n_s_m: f64,
    /// Stiffness of the hand, N/m.
    pub hand_stiffness_n_m: f64,
    /// Damping of the hand, N·s/m.
    pub hand_damping_n_s_m: f64,
    /// Greatest force of the motors, N.
    pub force_max_n: f64,
    /// Amplitude of a tremor at 8 Hz with a phase from the seed, m.
    pub tremor_m: f64,
}

impl Default for DeviceParameters {
    fn default() -> Self {
        Self {
            mass_kg: 0.1,
            damping_n_s_m: 0.5,
            hand_stiffness_n_m: 400.0,
            hand_damping_n_s_m: 6.0,
            force_max_n: 8.0,
            tremor_m: 0.0,
        }
    }
}

/// State of a device.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedDevice {
    parameters: DeviceParameters,
    position: [f64; 3],
    velocity: [f64; 3],
    time_s: f64,
    phase: f64,
}

impl SimulatedDevice {
    /// At rest at a place. The seed decides the phase of the tremor and nothing else.
    pub fn new(parameters: DeviceParameters, position: [f64; 3], seed: u64) -> Self {
        let phase = (splitmix(seed) >> 11) as f64 / (1u64 << 53) as f64 * std::f64::consts::TAU;
        Self { parameters, position, velocity: [0.0; 3], time_s: 0.0, phase }
    }

    /// m.
    pub fn position(&self) -> [f64; 3] {
        self.position
    }

    /// m/s.
    pub fn velocity(&self) -> [f64; 3] {
        self.velocity
    }

    /// s since the start.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Advances by `dt_s` while the hand pulls towards `goal` (m) and the motors hold `force_n`.
    ///
    /// m ẍ + (b + b_h) ẋ + k_h (x − goal) = F by the midpoint rule: it neither makes nor loses energy of the spring, so
    /// what damping there is comes from the parameters.
    pub fn step(&mut self, goal: [f64; 3], force_n: [f64; 3], dt_s: f64) {
        let p = &self.parameters;
        let size = force_n.iter().map(|f| f * f).sum::<f64>().sqrt();
        let scale = if size > p.force_max_n { p.force_max_n / size } else { 1.0 };
        let (k, b) = (p.hand_stiffness_n_m, p.damping_n_s_m + p.hand_damping_n_s_m);
        let tremor = p.tremor_m * libm::sin(std::f64::consts::TAU * 8.0 * self.time_s + self.phase);
        for c in 0..3 {
            let pull = k * (goal[c] + tremor - self.position[c]) + force_n[c] * scale - b * self.velocity[c];
            let change = (pull - 0.5 * dt_s * k * self.velocity[c]) * dt_s
                / (p.mass_kg + 0.5 * dt_s * b + 0.25 * dt_s * dt_s * k);
            self.position[c] += dt_s * (self.velocity[c] + 0.5 * change);
            self.velocity[c] += change;
        }
        self.time_s += dt_s;
    }

    /// The pose it reports.
    pub fn pose(&self) -> ToolPose {
        ToolPose {
            t_client_ns: (self.time_s * 1e9).round() as u64,
            linear_velocity: self.velocity,
            ..crate::pose_at(self.position)
        }
    }
}

/// SplitMix64 (Steele, Lea & Flood 2014).
fn splitmix(seed: u64) -> u64 {
    let mut z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn released_from_a_stretch_it_swings_as_the_closed_form_says() {
        let parameters = DeviceParameters::default();
        let mut device = SimulatedDevice::new(parameters, [0.01, 0.0, 0.0], 1);
        let (m, k) = (parameters.mass_kg, parameters.hand_stiffness_n_m);
        let decay = (parameters.damping_n_s_m + parameters.hand_damping_n_s_m) / (2.0 * m);
        let omega = (k / m - decay * decay).sqrt();
        let dt = 1e-4;
        for step in 1..=2_000 {
            device.step([0.0; 3], [0.0; 3], dt);
            let t = f64::from(step) * dt;
            let exact = 0.01 * (-decay * t).exp() * ((omega * t).cos() + decay / omega * (omega * t).sin());
            // The midpoint rule errs by (ω dt)² / 12 of the phase: 3e-6 × ω t here.
            assert!(
                (device.position()[0] - exact).abs() < 0.01 * 1e-4,
                "at {t} s: {} for {exact}",
                device.position()[0]
            );
        }
    }

    #[test]
    fn a_held_force_moves_it_by_force_over_stiffness_and_saturates() {
        let parameters = DeviceParameters::default();
        let mut device = SimulatedDevice::new(parameters, [0.0; 3], 1);
        for _ in 0..20_000 {
            device.step([0.0; 3], [0.0, 100.0, 0.0], 1e-3);
        }
        let expected = parameters.force_max_n / parameters.hand_stiffness_n_m;
        assert!((device.position()[1] - expected).abs() < 1e-12);
    }

    #[test]
    fn the_seed_decides_the_tremor_to_the_bit() {
        let parameters = DeviceParameters { tremor_m: 1e-3, ..DeviceParameters::default() };
        let walk = |seed| {
            let mut device = SimulatedDevice::new(parameters, [0.0; 3], seed);
            (0..100).for_each(|_| device.step([0.0; 3], [0.0; 3], 1e-3));
            device.position().map(f64::to_bits)
        };
        assert_eq!(walk(7), walk(7));
        assert_ne!(walk(7), walk(8));
    }
}
