//! What a haptic device is made of: the figures of its data sheet and of its identification.

use palpate_proto::messages::DeviceInfo;
use palpate_proto::text::located;
use serde::{Deserialize, Serialize};

/// A device as a point mass at its tip, alike in every direction.
///
/// A TOML file has the same fields; those with a default may be left out, see `docs/devices.md`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviceModel {
    /// What it is called.
    pub name: String,
    /// Directions in which it pushes (3).
    #[serde(default = "three")]
    pub force_dof: u8,
    /// Axes about which it twists (0 or 3).
    #[serde(default)]
    pub torque_dof: u8,
    /// Extent of the nominal workspace in each axis, m.
    pub workspace_m: [f64; 3],
    /// Apparent mass at the tip, kg.
    pub mass_kg: f64,
    /// Viscous damping at the tip, N·s/m.
    #[serde(default)]
    pub damping_n_s_m: f64,
    /// Coulomb friction at the tip, N.
    #[serde(default)]
    pub coulomb_n: f64,
    /// Position resolution at the tip, m; 0: the true position is reported.
    #[serde(default)]
    pub encoder_m: f64,
    /// Angle resolution, rad; 0: the true orientation is reported.
    #[serde(default)]
    pub encoder_rad: f64,
    /// Cut-off of the first-order low-pass on the differences that give the velocity, Hz; infinite:
    /// none.
    #[serde(default = "infinite")]
    pub velocity_cutoff_hz: f64,
    /// Rate of its servo loop, Hz.
    pub rate_hz: f64,
    /// Peak force, N.
    pub force_max_n: f64,
    /// Force it can hold without overheating, N. Reported against, not enforced.
    #[serde(default = "infinite")]
    pub force_continuous_n: f64,
    /// Peak torque, N·m.
    #[serde(default)]
    pub torque_max_nm: f64,
    /// Moment of inertia of the handle, kg·m².
    #[serde(default = "light_handle")]
    pub inertia_kg_m2: f64,
    /// Damping of the handle's rotation, N·m·s/rad.
    #[serde(default)]
    pub rotation_damping_nm_s: f64,
    /// First-order lag of amplifier and motor, Hz; infinite: none.
    #[serde(default = "infinite")]
    pub bandwidth_hz: f64,
}

fn three() -> u8 {
    3
}

fn infinite() -> f64 {
    f64::INFINITY
}

fn light_handle() -> f64 {
    2e-5
}

/// Why a device, a hand or a network was refused: which value, what it is, what it should be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DeviceError {
    /// A figure no device has.
    #[error("{what}: {field} is {value}; {expected} is needed")]
    Figure {
        /// Name of the device, the hand or the network.
        what: String,
        /// Name of the field.
        field: &'static str,
        /// As given.
        value: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// Not a preset.
    #[error(
        "{name:?} is not a known {kind}; use one of {known}, or a TOML file of that kind (docs/devices.md)"
    )]
    Unknown {
        /// As given.
        name: String,
        /// `device` or `hand`.
        kind: &'static str,
        /// The presets.
        known: String,
    },
    /// Not such TOML.
    #[error("{origin}: {reason}")]
    Toml {
        /// The file.
        origin: String,
        /// What the parser found, with line and column.
        reason: String,
    },
}

impl DeviceError {
    /// The same, with the file it came from before the name.
    pub(super) fn at(self, origin: &str) -> Self {
        match self {
            Self::Figure {
                what,
                field,
                value,
                expected,
            } => Self::Figure {
                what: format!("{origin}: {what}"),
                field,
                value,
                expected,
            },
            other => other,
        }
    }
}

/// Passes a figure, or refuses it by name.
pub(super) fn check(
    what: &str,
    field: &'static str,
    value: f64,
    good: bool,
    expected: &'static str,
) -> Result<(), DeviceError> {
    if good {
        Ok(())
    } else {
        Err(DeviceError::Figure {
            what: what.to_owned(),
            field,
            value,
            expected,
        })
    }
}

impl DeviceModel {
    /// A device by the name of its preset.
    ///
    /// # Errors
    /// Not a preset.
    pub fn preset(name: &str) -> Result<Self, DeviceError> {
        let known = super::presets::devices();
        known
            .iter()
            .find(|model| model.name == name)
            .cloned()
            .ok_or_else(|| DeviceError::Unknown {
                name: name.to_owned(),
                kind: "device",
                known: known
                    .iter()
                    .map(|model| model.name.as_str())
                    .collect::<Vec<_>>()
                    .join(", "),
            })
    }

    /// A device from TOML text. `origin` names it in errors.
    ///
    /// # Errors
    /// Not such TOML, or a figure no device has.
    pub fn from_toml(text: &str, origin: &str) -> Result<Self, DeviceError> {
        let model: Self = toml::from_str(text).map_err(|error| DeviceError::Toml {
            origin: origin.to_owned(),
            reason: located(text, error.span(), error.message()),
        })?;
        model.checked().map_err(|error| error.at(origin))
    }

    /// The description that this device sends to a daemon, with a delay of `delay_s` each way.
    pub fn info(&self, delay_s: f64) -> DeviceInfo {
        DeviceInfo {
            name: self.name.clone(),
            dof_force: self.force_dof,
            dof_torque: self.torque_dof,
            workspace: self.workspace_m,
            force_max: self.force_max_n,
            force_continuous: self.force_continuous_n.min(self.force_max_n),
            torque_max: self.torque_max_nm,
            mass: self.mass_kg,
            damping: self.damping_n_s_m,
            coulomb_friction: self.coulomb_n,
            encoder_resolution: self.encoder_m,
            rate_hz: self.rate_hz,
            delay_s,
            deadband: 0.0,
        }
    }

    /// The model, if a device can have its figures.
    ///
    /// # Errors
    /// The first figure no device has.
    pub fn checked(self) -> Result<Self, DeviceError> {
        let check = |field, value: f64, good: bool, expected| {
            check(&self.name, field, value, good, expected)
        };
        for (field, value) in [
            ("mass_kg", self.mass_kg),
            ("inertia_kg_m2", self.inertia_kg_m2),
        ] {
            check(
                field,
                value,
                value > 0.0 && value.is_finite(),
                "a finite value above 0",
            )?;
        }
        for (field, value) in [
            ("damping_n_s_m", self.damping_n_s_m),
            ("coulomb_n", self.coulomb_n),
            ("encoder_m", self.encoder_m),
            ("encoder_rad", self.encoder_rad),
            ("force_max_n", self.force_max_n),
            ("torque_max_nm", self.torque_max_nm),
            ("rotation_damping_nm_s", self.rotation_damping_nm_s),
        ] {
            check(
                field,
                value,
                value >= 0.0 && value.is_finite(),
                "a finite value, 0 or more",
            )?;
        }
        for (field, value) in [
            ("velocity_cutoff_hz", self.velocity_cutoff_hz),
            ("bandwidth_hz", self.bandwidth_hz),
            ("force_continuous_n", self.force_continuous_n),
        ] {
            check(
                field,
                value,
                value > 0.0,
                "a value above 0, or inf for none",
            )?;
        }
        check(
            "rate_hz",
            self.rate_hz,
            (1.0..=1e5).contains(&self.rate_hz),
            "a rate from 1 to 100000 Hz",
        )?;
        for value in self.workspace_m {
            check(
                "workspace_m",
                value,
                value > 0.0,
                "an extent above 0 in each axis",
            )?;
        }
        check(
            "force_dof",
            f64::from(self.force_dof),
            self.force_dof == 3,
            "3",
        )?;
        check(
            "torque_dof",
            f64::from(self.torque_dof),
            matches!(self.torque_dof, 0 | 3),
            "0 or 3",
        )?;
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_a_possible_device_and_survives_its_own_toml() {
        let all = super::super::presets::devices();
        assert!(all.len() >= 7);
        for model in all {
            let text = toml::to_string(&model).unwrap();
            assert_eq!(DeviceModel::from_toml(&text, "preset").as_ref(), Ok(&model));
            assert_eq!(DeviceModel::preset(&model.name), Ok(model));
        }
    }

    #[test]
    fn mistakes_are_told_with_their_place_and_what_would_do() {
        let least = "name = \"x\"\nworkspace_m = [0.1, 0.1, 0.1]\nmass_kg = 0.1\nrate_hz = 1000\nforce_max_n = 5\n";
        let model = DeviceModel::from_toml(least, "x.toml").unwrap();
        assert_eq!((model.force_dof, model.bandwidth_hz), (3, f64::INFINITY));
        let wrong = DeviceModel::from_toml(&least.replace("0.1\nrate", "-1.0\nrate"), "x.toml")
            .unwrap_err();
        assert_eq!(
            wrong.to_string(),
            "x.toml: x: mass_kg is -1; a finite value above 0 is needed"
        );
        let unknown = DeviceModel::from_toml(&format!("{least}mas = 1\n"), "x.toml")
            .unwrap_err()
            .to_string();
        assert!(
            unknown.contains("x.toml") && unknown.contains("mas"),
            "{unknown}"
        );
        let name = DeviceModel::preset("omni").unwrap_err().to_string();
        assert!(name.contains("touch-x") && name.contains("TOML"), "{name}");
    }
}
