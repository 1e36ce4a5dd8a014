//! Common devices. Sources of every figure, and which are assumed: `docs/devices.md`.

use super::model::DeviceModel;

/// The device of old and of the demo: no faults but a mass, a little damping and a limit.
fn ideal() -> DeviceModel {
    DeviceModel {
        name: "ideal".to_owned(),
        force_dof: 3,
        torque_dof: 3,
        workspace_m: [1.0; 3],
        mass_kg: 0.1,
        damping_n_s_m: 0.5,
        coulomb_n: 0.0,
        encoder_m: 0.0,
        encoder_rad: 0.0,
        velocity_cutoff_hz: f64::INFINITY,
        rate_hz: 1_000.0,
        force_max_n: 8.0,
        force_continuous_n: f64::INFINITY,
        torque_max_nm: 1.0,
        inertia_kg_m2: 2e-5,
        rotation_damping_nm_s: 1e-4,
        bandwidth_hz: f64::INFINITY,
    }
}

/// What every real device has here: a filtered velocity, an amplifier, and no torque.
fn real(name: &str) -> DeviceModel {
    DeviceModel {
        name: name.to_owned(),
        torque_dof: 0,
        torque_max_nm: 0.0,
        velocity_cutoff_hz: 100.0,
        bandwidth_hz: 500.0,
        ..ideal()
    }
}

/// Every preset, `ideal` first.
pub fn devices() -> Vec<DeviceModel> {
    vec![
        ideal(),
        DeviceModel {
            workspace_m: [0.160, 0.120, 0.070],
            mass_kg: 0.045,
            damping_n_s_m: 0.05,
            coulomb_n: 0.26,
            encoder_m: 0.055e-3,
            encoder_rad: 1e-3,
            force_max_n: 3.3,
            force_continuous_n: 0.88,
            ..real("touch")
        },
        DeviceModel {
            workspace_m: [0.160, 0.120, 0.120],
            mass_kg: 0.045,
            damping_n_s_m: 0.05,
            coulomb_n: 0.06,
            encoder_m: 0.023e-3,
            encoder_rad: 1e-3,
            force_max_n: 7.9,
            force_continuous_n: 1.75,
            ..real("touch-x")
        },
        DeviceModel {
            workspace_m: [0.381, 0.267, 0.191],
            mass_kg: 0.075,
            damping_n_s_m: 0.05,
            coulomb_n: 0.04,
            encoder_m: 0.03e-3,
            force_max_n: 8.5,
            force_continuous_n: 1.4,
            ..real("premium-1.5")
        },
        DeviceModel {
            workspace_m: [0.1016; 3],
            mass_kg: 0.25,
            damping_n_s_m: 1.0,
            coulomb_n: 0.5,
            encoder_m: 0.0635e-3,
            force_max_n: 8.9,
            ..real("falcon")
        },
        DeviceModel {
            workspace_m: [0.160, 0.160, 0.110],
            mass_kg: 0.22,
            damping_n_s_m: 0.5,
            coulomb_n: 0.3,
            encoder_m: 0.01e-3,
            rate_hz: 4_000.0,
            force_max_n: 12.0,
            force_continuous_n: 12.0,
            ..real("omega.3")
        },
        DeviceModel {
            workspace_m: [0.160, 0.160, 0.110],
            mass_kg: 0.35,
            damping_n_s_m: 0.5,
            coulomb_n: 0.4,
            encoder_m: 0.01e-3,
            encoder_rad: 1.57e-3,
            rate_hz: 4_000.0,
            force_max_n: 12.0,
            force_continuous_n: 12.0,
            ..real("omega.7")
        },
        DeviceModel {
            torque_dof: 3,
            workspace_m: [0.120; 3],
            mass_kg: 0.4,
            damping_n_s_m: 0.5,
            coulomb_n: 0.4,
            encoder_m: 0.0015e-3,
            encoder_rad: 0.227e-3,
            rate_hz: 4_000.0,
            force_max_n: 20.0,
            force_continuous_n: 20.0,
            torque_max_nm: 0.4,
            inertia_kg_m2: 2e-4,
            rotation_damping_nm_s: 1e-3,
            ..real("sigma.7")
        },
        DeviceModel {
            workspace_m: [0.300; 3],
            mass_kg: 0.4,
            damping_n_s_m: 0.5,
            coulomb_n: 0.4,
            encoder_m: 0.03e-3,
            rate_hz: 4_000.0,
            force_max_n: 20.0,
            force_continuous_n: 20.0,
            ..real("delta.3")
        },
        DeviceModel {
            torque_dof: 3,
            workspace_m: [0.450; 3],
            mass_kg: 1.0,
            damping_n_s_m: 2.0,
            coulomb_n: 1.0,
            encoder_m: 0.006e-3,
            encoder_rad: 1e-4,
            force_max_n: 35.0,
            force_continuous_n: 10.0,
            torque_max_nm: 3.1,
            inertia_kg_m2: 5e-3,
            rotation_damping_nm_s: 0.02,
            ..real("virtuose-6d")
        },
    ]
}
