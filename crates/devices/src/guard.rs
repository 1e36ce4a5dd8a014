//! Limits that hold whatever the simulation says.

use crate::frame::v3;

/// Greatest force and torque for a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cap {
    /// N.
    pub force_n: f64,
    /// N·m.
    pub torque_nm: f64,
}

impl Cap {
    /// Shortens what is longer, keeping its direction; what is not finite becomes zero. What is
    /// within the cap keeps every bit.
    pub fn limit(&self, force: [f64; 3], torque: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        (
            shortened(force, self.force_n),
            shortened(torque, self.torque_nm),
        )
    }
}

fn shortened(vector: [f64; 3], most: f64) -> [f64; 3] {
    let size = v3::norm(vector);
    if !size.is_finite() || most <= 0.0 {
        return [0.0; 3];
    }
    if size > most {
        v3::scale(vector, most / size)
    } else {
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cap_keeps_directions_and_bits_and_makes_nonsense_zero() {
        let cap = Cap {
            force_n: 3.0,
            torque_nm: 0.0,
        };
        let kept = [0.1 + 0.2, -0.0, 1e-12];
        assert_eq!(
            cap.limit(kept, [0.1; 3]).0.map(f64::to_bits),
            kept.map(f64::to_bits)
        );
        assert_eq!(cap.limit(kept, [0.1; 3]).1, [0.0; 3]);
        let (limited, _) = cap.limit([0.0, 30.0, 40.0], [0.0; 3]);
        assert!(v3::norm(v3::sub(limited, [0.0, 1.8, 2.4])) < 1e-12);
        for nonsense in [f64::NAN, f64::INFINITY] {
            assert_eq!(cap.limit([nonsense, 0.0, 1.0], [0.0; 3]).0, [0.0; 3]);
        }
    }
}
