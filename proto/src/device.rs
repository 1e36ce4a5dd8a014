//! Which descriptions of devices are believed.

use crate::messages::{DEVICE_NAME_BYTES, DeviceInfo};
use crate::text::is_unprintable;

/// Why a description was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DeviceError {
    /// Too long, or not to be shown.
    #[error(
        "the name of a device has {0} bytes; it must have at most {DEVICE_NAME_BYTES} and no control characters"
    )]
    Name(usize),
    /// A number outside what a device can have.
    #[error("{field} of a device is {value}; it must be between {least} and {most}")]
    Range {
        /// Field.
        field: &'static str,
        /// As given.
        value: f64,
        /// Least.
        least: f64,
        /// Greatest.
        most: f64,
    },
}

impl DeviceInfo {
    /// A device of which nothing is known but its name, cut to what a message holds.
    pub fn named(name: &str) -> Self {
        let mut end = name.len().min(DEVICE_NAME_BYTES);
        while !name.is_char_boundary(end) {
            end -= 1;
        }
        Self {
            name: name[..end].to_owned(),
            dof_force: 0,
            dof_torque: 0,
            workspace: [0.0; 3],
            force_max: 0.0,
            force_continuous: 0.0,
            torque_max: 0.0,
            mass: 0.0,
            damping: 0.0,
            coulomb_friction: 0.0,
            encoder_resolution: 0.0,
            rate_hz: 0.0,
            delay_s: 0.0,
            deadband: 0.0,
        }
    }

    /// It pushes or turns the hand. One that says it does neither, as a mouse does, is only looked at.
    pub fn has_motors(&self) -> bool {
        self.dof_force > 0 || self.dof_torque > 0
    }

    /// The description, if a device can be like that.
    ///
    /// # Errors
    /// The first field that no device has: not finite, negative, or far outside what is built.
    pub fn validated(self) -> Result<Self, DeviceError> {
        if self.name.len() > DEVICE_NAME_BYTES || self.name.chars().any(is_unprintable) {
            return Err(DeviceError::Name(self.name.len()));
        }
        let [x, y, z] = self.workspace;
        let fields = [
            ("dof_force", f64::from(self.dof_force), 3.0),
            ("dof_torque", f64::from(self.dof_torque), 3.0),
            ("workspace[0]", x, 100.0),
            ("workspace[1]", y, 100.0),
            ("workspace[2]", z, 100.0),
            ("force_max", self.force_max, 1e4),
            ("force_continuous", self.force_continuous, self.force_max),
            ("torque_max", self.torque_max, 1e4),
            ("mass", self.mass, 1e3),
            ("damping", self.damping, 1e4),
            ("coulomb_friction", self.coulomb_friction, 1e3),
            ("encoder_resolution", self.encoder_resolution, 0.1),
            ("rate_hz", self.rate_hz, 1e6),
            ("delay_s", self.delay_s, 10.0),
            ("deadband", self.deadband, 0.99),
        ];
        for (field, value, most) in fields {
            // A NaN is in no range.
            if !(0.0..=most).contains(&value) {
                return Err(DeviceError::Range {
                    field,
                    value,
                    least: 0.0,
                    most,
                });
            }
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_is_too_long_is_cut_between_characters() {
        let long = DeviceInfo::named(&format!("a{}", "é".repeat(40)));
        assert_eq!(long.name, format!("a{}", "é".repeat(31)));
        assert!(long.validated().is_ok());
        assert_eq!(DeviceInfo::named("arm").name, "arm");
    }

    fn info() -> DeviceInfo {
        DeviceInfo {
            name: "a desk arm".into(),
            dof_force: 3,
            dof_torque: 0,
            workspace: [0.16, 0.12, 0.07],
            force_max: 3.3,
            force_continuous: 0.88,
            torque_max: 0.0,
            mass: 0.045,
            damping: 0.2,
            coulomb_friction: 0.26,
            encoder_resolution: 5.5e-5,
            rate_hz: 1_000.0,
            delay_s: 0.0,
            deadband: 0.1,
        }
    }

    fn refused(change: impl FnOnce(&mut DeviceInfo)) -> Option<&'static str> {
        let mut bad = info();
        change(&mut bad);
        match bad.validated() {
            Err(DeviceError::Range { field, .. }) => Some(field),
            Err(DeviceError::Name(_)) => Some("name"),
            Ok(_) => None,
        }
    }

    #[test]
    fn what_no_device_can_be_is_refused_by_its_field() {
        assert_eq!(info().validated(), Ok(info()));
        assert_eq!(refused(|d| d.name = "x".repeat(65)), Some("name"));
        assert_eq!(refused(|d| d.name = "a\nb".into()), Some("name"));
        assert_eq!(refused(|d| d.dof_force = 4), Some("dof_force"));
        assert_eq!(refused(|d| d.workspace[2] = f64::NAN), Some("workspace[2]"));
        assert_eq!(refused(|d| d.force_max = f64::INFINITY), Some("force_max"));
        assert_eq!(
            refused(|d| d.force_continuous = 3.4),
            Some("force_continuous"),
            "more for long than at all"
        );
        assert_eq!(refused(|d| d.mass = -1e-9), Some("mass"));
        assert_eq!(refused(|d| d.rate_hz = 2e6), Some("rate_hz"));
        assert_eq!(refused(|d| d.delay_s = f64::NEG_INFINITY), Some("delay_s"));
        assert_eq!(refused(|d| d.deadband = 1.0), Some("deadband"));
        assert_eq!(refused(|d| d.deadband = 0.0), None);
    }
}
