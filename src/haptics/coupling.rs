//! Virtual coupling: a spring and a damper between the device and a proxy without mass (Colgate, Stanley & Brown 1995).
//!
//! Implicit in time: with `K' = K + B / dt`, force balance of the proxy `K (d − p') + B (v_d − (p' − p) / dt) + F_c = 0`
//! gives `p' = p_free + F_c / K'`. A contact force therefore sees the compliance `1 / K'`, which joins the body's own
//! compliance in one contact solve: coupling and body cannot make each other unstable.

use crate::math::{Point3, Vector3};

/// K_c and B_c. An infinite stiffness holds the proxy to the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    stiffness_n_m: f64,
    damping_n_s_m: f64,
    dt_s: f64,
}

impl Coupling {
    /// `stiffness_n_m > 0` (or infinite), `damping_n_s_m >= 0`, `dt_s > 0`; the scene checked.
    pub fn new(stiffness_n_m: f64, damping_n_s_m: f64, dt_s: f64) -> Self {
        Self { stiffness_n_m, damping_n_s_m, dt_s }
    }

    /// 1 / (K + B / dt), m/N; 0 for a rigid coupling.
    pub fn compliance_m_n(&self) -> f64 {
        1.0 / (self.stiffness_n_m + self.damping_n_s_m / self.dt_s)
    }

    /// True when the proxy is the device.
    pub fn is_rigid(&self) -> bool {
        self.stiffness_n_m.is_infinite()
    }

    /// Where the proxy goes without contact: p_free.
    pub fn free_position(&self, device: &Point3, device_velocity: &Vector3, proxy: &Point3) -> Point3 {
        if self.is_rigid() {
            return *device;
        }
        let lag = proxy - device + device_velocity * self.dt_s;
        device + lag * (self.damping_n_s_m / self.dt_s * self.compliance_m_n())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_position_balances_spring_and_damper() {
        let (k, b, dt) = (800.0, 3.0, 1e-3);
        let coupling = Coupling::new(k, b, dt);
        let (device, velocity) = (Point3::new(0.1, 0.2, -0.3), Vector3::new(0.4, -0.1, 0.2));
        let proxy = Point3::new(0.11, 0.18, -0.29);
        let free = coupling.free_position(&device, &velocity, &proxy);
        let balance = (device - free) * k + (velocity - (free - proxy) / dt) * b;
        // Terms are of the order of 100 N.
        assert!(balance.norm() < 1e-11, "unbalanced by {balance}");
    }

    #[test]
    fn a_rigid_coupling_has_no_compliance_and_no_lag() {
        let coupling = Coupling::new(f64::INFINITY, 0.0, 1e-3);
        assert_eq!(coupling.compliance_m_n(), 0.0);
        let device = Point3::new(1.0, 2.0, 3.0);
        assert_eq!(coupling.free_position(&device, &Vector3::x(), &Point3::origin()), device);
    }
}
