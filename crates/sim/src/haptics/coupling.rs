//! Virtual coupling: a spring and a damper between the device and a proxy without mass (Colgate,
//! Stanley & Brown 1995), and the same for rotation (McNeely, Puterbaugh & Troy 1999).
//!
//! Implicit in time: with `K' = K + B / dt`, force balance of the proxy `K (d − p') + B (v_d − (p'
//! − p) / dt) + F_c = 0` gives `p' = p_free + F_c / K'`. A contact force therefore sees the
//! compliance `1 / K'`, which joins the body's own compliance in one contact solve: coupling and
//! body cannot make each other unstable. Rotation has the same equation in rotation vectors, with
//! the torque of the contacts about the tool's reference point.

use palpate_geometry::math::{Point3, Rotation, Vector3, rotation_by, turn_between};

/// K_c and B_c, for translation and for rotation. An infinite stiffness holds the proxy to the
/// device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    stiffness_n_m: f64,
    damping_n_s_m: f64,
    turning_stiffness_nm_rad: f64,
    turning_damping_nm_s_rad: f64,
    dt_s: f64,
}

impl Coupling {
    /// `stiffness_n_m > 0` (or infinite), `damping_n_s_m >= 0`, `dt_s > 0`; the scene checked. The
    /// proxy is turned as the device is.
    pub fn new(stiffness_n_m: f64, damping_n_s_m: f64, dt_s: f64) -> Self {
        let (turning_stiffness_nm_rad, turning_damping_nm_s_rad) = (f64::INFINITY, 0.0);
        Self {
            stiffness_n_m,
            damping_n_s_m,
            turning_stiffness_nm_rad,
            turning_damping_nm_s_rad,
            dt_s,
        }
    }

    /// The same, with a spring and a damper for rotation: above 0 (or infinite) N·m/rad, 0 or more
    /// N·m·s/rad.
    pub fn turning(self, stiffness_nm_rad: f64, damping_nm_s_rad: f64) -> Self {
        Self {
            turning_stiffness_nm_rad: stiffness_nm_rad,
            turning_damping_nm_s_rad: damping_nm_s_rad,
            ..self
        }
    }

    /// The same, no stiffer than this in translation, N/m.
    pub fn bounded(self, stiffness_max_n_m: f64) -> Self {
        Self {
            stiffness_n_m: self.stiffness_n_m.min(stiffness_max_n_m),
            ..self
        }
    }

    /// K_c, N/m.
    pub fn stiffness_n_m(&self) -> f64 {
        self.stiffness_n_m
    }

    /// The same for rotation, N·m/rad.
    pub fn turning_stiffness_nm_rad(&self) -> f64 {
        self.turning_stiffness_nm_rad
    }

    /// B_c, N·s/m.
    pub fn damping_n_s_m(&self) -> f64 {
        self.damping_n_s_m
    }

    /// 1 / (K + B / dt), m/N; 0 for a rigid coupling.
    pub fn compliance_m_n(&self) -> f64 {
        1.0 / (self.stiffness_n_m + self.damping_n_s_m / self.dt_s)
    }

    /// The same for rotation, rad/(N·m); 0 where the proxy is turned as the device is.
    pub fn turning_compliance_rad_nm(&self) -> f64 {
        1.0 / (self.turning_stiffness_nm_rad + self.turning_damping_nm_s_rad / self.dt_s)
    }

    /// True when the proxy is the device.
    pub fn is_rigid(&self) -> bool {
        self.stiffness_n_m.is_infinite()
    }

    /// True when the proxy may be turned otherwise than the device.
    pub fn turns(&self) -> bool {
        self.turning_stiffness_nm_rad.is_finite()
    }

    /// Where the proxy goes without contact: p_free.
    pub fn free_position(
        &self,
        device: &Point3,
        device_velocity: &Vector3,
        proxy: &Point3,
    ) -> Point3 {
        if self.is_rigid() {
            return *device;
        }
        let lag = proxy - device + device_velocity * self.dt_s;
        device + lag * (self.damping_n_s_m / self.dt_s * self.compliance_m_n())
    }

    /// How the proxy is turned without contact; velocity in rad/s, world axes.
    pub fn free_orientation(
        &self,
        device: &Rotation,
        angular_velocity: &Vector3,
        proxy: &Rotation,
    ) -> Rotation {
        if !self.turns() || self.turning_damping_nm_s_rad == 0.0 {
            return *device;
        }
        let lag = turn_between(device, proxy) + angular_velocity * self.dt_s;
        let share = self.turning_damping_nm_s_rad / self.dt_s * self.turning_compliance_rad_nm();
        rotation_by(&(lag * share)) * device
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
    fn free_orientation_balances_torsion_about_one_axis() {
        // About one axis rotations add, so the balance is exact.
        let (k, b, dt) = (2.0, 0.01, 1e-3);
        let coupling = Coupling::new(1e3, 0.0, dt).turning(k, b);
        let axis = Vector3::new(1.0, 2.0, -2.0) / 3.0;
        let (device, rate, proxy) = (0.4, 3.0, 0.35);
        let turn = |angle: f64| rotation_by(&(axis * angle));
        let free = coupling.free_orientation(&turn(device), &(axis * rate), &turn(proxy));
        let free = turn_between(&Rotation::identity(), &free).dot(&axis);
        let balance = (device - free) * k + (rate - (free - proxy) / dt) * b;
        assert!(balance.abs() < 1e-13, "unbalanced by {balance}");
    }

    #[test]
    fn a_rigid_coupling_has_no_compliance_and_no_lag() {
        let coupling = Coupling::new(f64::INFINITY, 0.0, 1e-3);
        assert_eq!(
            (
                coupling.compliance_m_n(),
                coupling.turning_compliance_rad_nm()
            ),
            (0.0, 0.0)
        );
        assert!(!coupling.turns());
        let device = Point3::new(1.0, 2.0, 3.0);
        assert_eq!(
            coupling.free_position(&device, &Vector3::x(), &Point3::origin()),
            device
        );
        let turned = rotation_by(&Vector3::x());
        assert_eq!(
            coupling.free_orientation(&turned, &Vector3::z(), &Rotation::identity()),
            turned
        );
    }

    #[test]
    fn a_bound_softens_and_never_stiffens() {
        let coupling = Coupling::new(1_000.0, 2.0, 1e-3);
        assert_eq!(coupling.bounded(300.0).stiffness_n_m(), 300.0);
        assert_eq!(coupling.bounded(f64::INFINITY), coupling);
    }
}
