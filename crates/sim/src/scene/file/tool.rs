//! What a tool says of itself, checked.

use super::Check;
use crate::scene::spec::{DeviceSpec, FrictionSpec, ShapeSpec, ToolSpec};
use std::path::Path;

impl Check<'_> {
    pub(super) fn tool(&mut self, t: usize, tool: &ToolSpec, directory: &Path) {
        match &tool.shape {
            ShapeSpec::Point {} => {}
            ShapeSpec::Sphere { radius_m } => {
                self.above_zero("tool", t, "radius_m", *radius_m, "m")
            }
            ShapeSpec::Plane { normal } => self.direction("tool", t, "normal", normal),
            ShapeSpec::Surface(surface) => self.surface("tool", t, surface, directory),
            ShapeSpec::Mesh(mesh) => {
                if mesh.file.is_some() == mesh.inline.is_some() {
                    self.refuse("tool", t, "mesh", "mesh needs exactly one of file, inline");
                }
                if let Some(path) = mesh
                    .file
                    .as_ref()
                    .map(|file| directory.join(file))
                    .filter(|path| !path.is_file())
                {
                    let message = format!(
                        "there is no file {}; paths start at the scene file",
                        path.display()
                    );
                    self.refuse("tool", t, "file", message);
                }
            }
            // Compiled when the scene is built, and refused there with the column.
            ShapeSpec::Cylinder { .. }
            | ShapeSpec::Cone { .. }
            | ShapeSpec::Ellipsoid { .. }
            | ShapeSpec::Torus { .. }
            | ShapeSpec::Box { .. }
            | ShapeSpec::Implicit { .. } => {}
        }
        self.pose("tool", t, &tool.pose);
        let stiffness = tool.coupling.stiffness_n_m;
        if stiffness.is_nan() || stiffness <= 0.0 {
            let message = format!(
                "stiffness_n_m is {stiffness}; it must be above 0 N/m (inf: a rigid coupling)"
            );
            self.refuse("tool", t, "stiffness_n_m", message);
        }
        self.not_below_zero(
            "tool",
            t,
            "damping_n_s_m",
            tool.coupling.damping_n_s_m,
            "N·s/m",
        );
        self.above_zero("tool", t, "force_max_n", tool.device.force_max_n, "N");
        if let Some(friction) = &tool.friction {
            self.friction("tool", t, friction);
        }
        let grip = tool.grip.force_max_n;
        if !(grip.is_finite() && grip >= 0.0) {
            let message = format!(
                "the grip's force_max_n is {grip}; it must be 0 N (it never holds) or more"
            );
            self.refuse("tool", t, "grip", message);
        }
        let turning = tool.coupling.turning_stiffness_nm_rad;
        if turning.is_nan() || turning <= 0.0 {
            let message = format!(
                "turning_stiffness_nm_rad is {turning}; it must be above 0 N·m/rad (inf: the tool is turned as the device is)"
            );
            self.refuse("tool", t, "turning_stiffness_nm_rad", message);
        }
        let damping = tool.coupling.turning_damping_nm_s_rad;
        self.not_below_zero("tool", t, "turning_damping_nm_s_rad", damping, "N·m·s/rad");
        self.device(t, &tool.device);
    }

    fn device(&mut self, t: usize, device: &DeviceSpec) {
        self.not_below_zero("tool", t, "ramp_s", device.ramp_s, "s");
        self.above_zero("tool", t, "stale_s", device.stale_s, "s");
        self.above_zero("tool", t, "speed_max_m_s", device.speed_max_m_s, "m/s");
        let torque = device.torque_max_nm;
        if torque.is_nan() || torque < 0.0 {
            let message = format!(
                "torque_max_nm is {torque}; it must be 0 N·m (the device only pushes) or more"
            );
            self.refuse("tool", t, "torque_max_nm", message);
        }
        self.above_zero(
            "tool",
            t,
            "passivity_damping_n_s_m",
            device.passivity_damping_n_s_m,
            "N·s/m",
        );
        if let Some(damping) = device.damping_n_s_m {
            self.not_below_zero("tool", t, "damping_n_s_m", damping, "N·s/m");
        }
        self.not_below_zero("tool", t, "coulomb_n", device.coulomb_n, "N");
        self.not_below_zero("tool", t, "encoder_m", device.encoder_m, "m");
        self.not_below_zero("tool", t, "delay_s", device.delay_s, "s");
        if let Some(rate) = device.rate_hz {
            self.above_zero("tool", t, "rate_hz", rate, "Hz");
        }
    }

    pub(super) fn friction(&mut self, table: &str, index: usize, friction: &FrictionSpec) {
        self.not_below_zero(table, index, "mu", friction.mu, "");
        if let Some(kinetic) = friction.mu_kinetic
            && !(0.0..=friction.mu).contains(&kinetic)
        {
            let message = format!(
                "mu_kinetic is {kinetic}; it must be 0 to mu, which is {}",
                friction.mu
            );
            self.refuse(table, index, "mu_kinetic", message);
        }
        self.not_below_zero(
            table,
            index,
            "viscous_n_s_m",
            friction.viscous_n_s_m,
            "N·s/m",
        );
    }
}
