//! A hand on the device: mass, stiffness and damping that follow where the hand wants to be.

use super::model::{DeviceError, check};
use super::random::Random;
use super::smooth::ramp;
use super::v3;
use palpate_proto::text::located;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Where the hand wants to be, how fast it moves there, and how firmly it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Position, m.
    pub position: [f64; 3],
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// x y z w.
    pub orientation: [f64; 4],
    /// Angular velocity, rad/s.
    pub angular_velocity: [f64; 3],
    /// Times the hand's own stiffness and damping.
    pub grip: f64,
}

impl Goal {
    /// At rest, unturned, at the hand's own grip.
    pub fn at(position: [f64; 3]) -> Self {
        Self::moving(position, [0.0; 3])
    }

    /// Passing a place, unturned, at the hand's own grip.
    pub fn moving(position: [f64; 3], velocity: [f64; 3]) -> Self {
        Self {
            position,
            velocity,
            orientation: v3::UNTURNED,
            angular_velocity: [0.0; 3],
            grip: 1.0,
        }
    }
}

/// A change of grip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grip {
    /// s from the start, growing.
    pub time_s: f64,
    /// Times the stiffness and damping; reached smoothly at that time.
    pub factor: f64,
}

/// A hand. Stiffness and damping grow with the force of the grip, the mass does not (Hasser &
/// Cutkosky 2002).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hand {
    /// What it is called.
    pub name: String,
    /// Mass that moves with the device, kg.
    pub mass_kg: f64,
    /// Stiffness, N/m.
    pub stiffness_n_m: f64,
    /// Damping, N·s/m.
    pub damping_n_s_m: f64,
    /// Moment of inertia that turns with the device, kg·m².
    #[serde(default)]
    pub inertia_kg_m2: f64,
    /// Torsional stiffness, N·m/rad.
    #[serde(default = "torsion")]
    pub torsion_nm: f64,
    /// Torsional damping, N·m·s/rad.
    #[serde(default = "torsion_damping")]
    pub torsion_damping_nm_s: f64,
    /// Bound of the tremor's amplitude in each axis, m.
    #[serde(default)]
    pub tremor_m: f64,
    /// Changes of the grip; 1 throughout if empty.
    #[serde(default)]
    pub grip: Vec<Grip>,
}

fn torsion() -> f64 {
    0.5
}

fn torsion_damping() -> f64 {
    0.01
}

impl Hand {
    /// Two fingers that hardly hold. Sources of these figures: `docs/devices.md`.
    pub fn light() -> Self {
        Self::of("light", 0.02, 100.0, 2.0)
    }

    /// A pinch without effort.
    pub fn relaxed() -> Self {
        Self::of("relaxed", 0.05, 400.0, 6.0)
    }

    /// A hand that means it.
    pub fn firm() -> Self {
        Self::of("firm", 0.1, 1_000.0, 15.0)
    }

    /// No hand: the device is on its own.
    pub fn absent() -> Self {
        Self {
            torsion_nm: 0.0,
            torsion_damping_nm_s: 0.0,
            ..Self::of("absent", 0.0, 0.0, 0.0)
        }
    }

    fn of(name: &str, mass_kg: f64, stiffness_n_m: f64, damping_n_s_m: f64) -> Self {
        Self {
            name: name.to_owned(),
            mass_kg,
            stiffness_n_m,
            damping_n_s_m,
            inertia_kg_m2: 1e-5,
            torsion_nm: torsion() * stiffness_n_m / 400.0,
            torsion_damping_nm_s: torsion_damping() * damping_n_s_m / 6.0,
            tremor_m: 0.0,
            grip: Vec::new(),
        }
    }

    /// A hand by the name of its preset: light, relaxed, firm.
    ///
    /// # Errors
    /// Not a preset.
    pub fn preset(name: &str) -> Result<Self, DeviceError> {
        match name {
            "light" => Ok(Self::light()),
            "relaxed" => Ok(Self::relaxed()),
            "firm" => Ok(Self::firm()),
            _ => Err(DeviceError::Unknown {
                name: name.to_owned(),
                kind: "hand",
                known: "light, relaxed, firm".to_owned(),
            }),
        }
    }

    /// A hand from TOML text. `origin` names it in errors.
    ///
    /// # Errors
    /// Not such TOML, or a figure no hand has.
    pub fn from_toml(text: &str, origin: &str) -> Result<Self, DeviceError> {
        let hand: Self = toml::from_str(text).map_err(|error| DeviceError::Toml {
            origin: origin.to_owned(),
            reason: located(text, error.span(), error.message()),
        })?;
        hand.checked().map_err(|error| error.at(origin))
    }

    /// The hand, if it can be one.
    ///
    /// # Errors
    /// The first figure no hand has.
    pub fn checked(self) -> Result<Self, DeviceError> {
        let what = format!("hand {}", self.name);
        for (field, value) in [
            ("mass_kg", self.mass_kg),
            ("stiffness_n_m", self.stiffness_n_m),
            ("damping_n_s_m", self.damping_n_s_m),
            ("inertia_kg_m2", self.inertia_kg_m2),
            ("torsion_nm", self.torsion_nm),
            ("torsion_damping_nm_s", self.torsion_damping_nm_s),
            ("tremor_m", self.tremor_m),
        ] {
            check(
                &what,
                field,
                value,
                value >= 0.0 && value.is_finite(),
                "a finite value, 0 or more",
            )?;
        }
        let mut last_s = f64::NEG_INFINITY;
        for grip in &self.grip {
            let good = (0.0..=100.0).contains(&grip.factor);
            check(
                &what,
                "grip.factor",
                grip.factor,
                good,
                "a factor from 0 to 100",
            )?;
            let later = grip.time_s.is_finite() && grip.time_s > last_s;
            check(
                &what,
                "grip.time_s",
                grip.time_s,
                later,
                "a time later than the one before",
            )?;
            last_s = grip.time_s;
        }
        Ok(self)
    }

    /// Factor of stiffness and damping at a time: smooth between the profile's points, constant
    /// outside.
    pub fn grip_at(&self, time_s: f64) -> f64 {
        let k = self.grip.partition_point(|grip| grip.time_s <= time_s);
        match (k.checked_sub(1).map(|k| &self.grip[k]), self.grip.get(k)) {
            (None, None) => 1.0,
            (None, Some(only)) | (Some(only), None) => only.factor,
            (Some(a), Some(b)) => {
                a.factor + (b.factor - a.factor) * ramp((time_s - a.time_s) / (b.time_s - a.time_s))
            }
        }
    }
}

/// Sinusoids of the tremor in each axis.
const WAVES: usize = 4;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Wave {
    amplitude_m: f64,
    omega: f64,
    phase: f64,
}

/// Physiological tremor: in each axis a few sinusoids of 4 to 12 Hz, together never beyond the
/// bound.
///
/// Its band is 8 to 12 Hz in a healthy hand and 4 to 6 Hz in a resting one with Parkinson's disease
/// (Elble & Koller 1990); a hand's is not one pure tone, so several are drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tremor {
    waves: [[Wave; WAVES]; 3],
}

impl Tremor {
    pub(super) fn new(bound_m: f64, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut waves = [[Wave::default(); WAVES]; 3];
        for wave in waves.as_flattened_mut() {
            wave.amplitude_m = bound_m / WAVES as f64;
            wave.omega = TAU * (4.0 + 8.0 * random.uniform());
            wave.phase = TAU * random.uniform();
        }
        Self { waves }
    }

    /// Added to a goal.
    pub(super) fn shake(&self, goal: &mut Goal, time_s: f64) {
        for axis in 0..3 {
            for wave in self.waves[axis]
                .iter()
                .filter(|wave| wave.amplitude_m > 0.0)
            {
                let angle = wave.omega * time_s + wave.phase;
                goal.position[axis] += wave.amplitude_m * libm::sin(angle);
                goal.velocity[axis] += wave.amplitude_m * wave.omega * libm::cos(angle);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tremor_stays_in_its_bound_and_band_and_its_velocity_is_its_derivative() {
        let tremor = Tremor::new(1e-3, 7);
        let at = |t: f64| {
            let mut goal = Goal::at([0.0; 3]);
            tremor.shake(&mut goal, t);
            goal
        };
        let (mut most, mut crossings) = (0.0f64, 0);
        for k in 0..100_000 {
            let t = f64::from(k) * 1e-4;
            let goal = at(t);
            most = most.max(goal.position[1].abs());
            crossings += i32::from(goal.position[1] * at(t + 1e-4).position[1] < 0.0);
            let slope = (at(t + 1e-6).position[1] - at(t - 1e-6).position[1]) / 2e-6;
            assert!((slope - goal.velocity[1]).abs() < 1e-7, "{t}");
        }
        assert!(most <= 1e-3 && most > 5e-4, "{most}");
        // Two crossings a cycle for ten seconds.
        assert!((80..=240).contains(&crossings), "{crossings}");
        assert_eq!(Tremor::new(1e-3, 7), tremor);
        assert_ne!(Tremor::new(1e-3, 8), tremor);
    }

    #[test]
    fn the_grip_passes_its_points_smoothly_and_keeps_its_ends() {
        let grip = vec![
            Grip {
                time_s: 1.0,
                factor: 0.5,
            },
            Grip {
                time_s: 2.0,
                factor: 2.5,
            },
        ];
        let hand = Hand {
            grip,
            ..Hand::relaxed()
        }
        .checked()
        .unwrap();
        let expected = [(0.0, 0.5), (1.0, 0.5), (1.5, 1.5), (2.0, 2.5), (9.0, 2.5)];
        assert!(
            expected
                .iter()
                .all(|&(t, factor)| (hand.grip_at(t) - factor).abs() < 1e-15)
        );
        assert_eq!(Hand::relaxed().grip_at(3.0), 1.0);
        // Smooth: the slope is at most 15/8 of the mean, and none at the ends.
        for k in 0..3_000 {
            let t = f64::from(k) * 1e-3;
            assert!((hand.grip_at(t + 1e-3) - hand.grip_at(t)).abs() <= 2.0 * 1.875e-3 * 1.000_001);
        }
        assert!((hand.grip_at(1.001) - 0.5).abs() < 1e-7);
    }

    #[test]
    fn hands_are_read_and_refused_by_field() {
        let text = "name = \"mine\"\nmass_kg = 0.03\nstiffness_n_m = 200\ndamping_n_s_m = 4\ntremor_m = 0.0002\n\
                    grip = [{ time_s = 0, factor = 1 }, { time_s = 2, factor = 0.3 }]\n";
        let hand = Hand::from_toml(text, "mine.toml").unwrap();
        assert_eq!((hand.grip.len(), hand.torsion_nm), (2, 0.5));
        let bad = Hand::from_toml(&text.replace("time_s = 2", "time_s = 0"), "mine.toml")
            .unwrap_err()
            .to_string();
        assert!(
            bad.starts_with("mine.toml: hand mine: grip.time_s is 0") && bad.contains("later"),
            "{bad}"
        );
        let firmly = Hand::preset("firmly").unwrap_err().to_string();
        assert!(firmly.contains("light, relaxed, firm"), "{firmly}");
    }
}
