//! Tools of a scene file: coupling, device, friction, grip.

use super::door::At;
use super::parts::{Device, Tool};
use super::spec::{CouplingSpec, DeviceSpec, FrictionSpec, GripSpec, ToolSpec};
use crate::haptics::{Coupling, DeviceFigures, LinkLimits};
use crate::solve::friction::Friction;
use palpate_geometry::math::Point3;

/// Checks and builds a tool; `at` is its table.
pub(super) fn build(spec: &ToolSpec, at: &At<'_>, dt_s: f64) -> Option<Tool> {
    let shape = spec.shape.build(&at.key("shape"));
    let pose = at
        .key("pose")
        .pose(&spec.pose.position, &spec.pose.orientation);
    let coupling = check_coupling(&spec.coupling, &at.key("coupling"));
    let device = build_device(&spec.device, spec.coupling.bounded, dt_s, &at.key("device"));
    let grip_n = grip(&spec.grip, &at.key("grip"));
    if spec.fixes_nodes && spec.shape.shape().half_space().is_none() {
        at.key("fixes_nodes").refuse(
            "only a plane tool can fix nodes; give it the shape plane, or drop fixes_nodes",
        );
    }
    if spec.action.is_some() && spec.shape.shape().half_space().is_none() {
        at.key("action")
            .refuse("only a plane cuts; give the tool the shape plane, or drop action");
    }
    let ((), (device, limits)) = (coupling?, device?);
    let coupling = &spec.coupling;
    let mut stiffness_n_m = coupling.stiffness_n_m;
    if coupling.bounded && spec.device.damping_n_s_m.is_some() {
        let most = device
            .figures
            .stiffness_limits(coupling.damping_n_s_m)
            .passive_n_m();
        if most == 0.0 {
            return at.key("coupling").key("bounded").refused(
                "a bounded coupling needs a device with more damping than its own, and with dry friction if it has \
                 an encoder: give damping_n_s_m, coulomb_n and encoder_m of [tool.device], or drop bounded",
            );
        }
        stiffness_n_m = stiffness_n_m.min(most);
    }
    let (shape, pose) = (shape?, pose?);
    let mut built = Coupling::new(stiffness_n_m, coupling.damping_n_s_m, dt_s);
    if shape.ball_radius_m().is_none() {
        built = built.turning(
            coupling.turning_stiffness_nm_rad,
            coupling.turning_damping_nm_s_rad,
        );
    }
    Some(Tool {
        id: spec.id.clone(),
        shape,
        start: (Point3::from(pose.translation.vector), pose.rotation),
        coupling: built,
        limits,
        device,
        grip_n: grip_n?,
    })
}

fn check_coupling(spec: &CouplingSpec, at: &At<'_>) -> Option<()> {
    let stiffness = |key: &str, value: f64, unit: &str, rigid: &str| match value {
        f64::INFINITY => Some(()),
        _ => (at.above_zero(key, value, &format!("{unit} (inf: {rigid})"))).map(|_| ()),
    };
    let checks = [
        stiffness(
            "stiffness_n_m",
            spec.stiffness_n_m,
            "N/m",
            "a rigid coupling",
        ),
        stiffness(
            "turning_stiffness_nm_rad",
            spec.turning_stiffness_nm_rad,
            "N·m/rad",
            "the tool turns as the device does",
        ),
        at.not_below_zero("damping_n_s_m", spec.damping_n_s_m, "N·s/m")
            .map(|_| ()),
        at.not_below_zero(
            "turning_damping_nm_s_rad",
            spec.turning_damping_nm_s_rad,
            "N·m·s/rad",
        )
        .map(|_| ()),
    ];
    checks.into_iter().collect()
}

fn grip(spec: &GripSpec, at: &At<'_>) -> Option<f64> {
    at.not_below_zero("force_max_n", spec.force_max_n, "N (0: it never holds)")
}

fn build_device(
    spec: &DeviceSpec,
    bounded: bool,
    dt_s: f64,
    at: &At<'_>,
) -> Option<(Device, LinkLimits)> {
    let before = at.problem_count();
    at.above_zero("force_max_n", spec.force_max_n, "N");
    at.not_below_zero("ramp_s", spec.ramp_s, "s");
    at.above_zero("stale_s", spec.stale_s, "s");
    at.above_zero("speed_max_m_s", spec.speed_max_m_s, "m/s");
    if spec.torque_max_nm != f64::INFINITY {
        let unit = "N·m (0: the device only pushes; inf: it bears any)";
        at.not_below_zero("torque_max_nm", spec.torque_max_nm, unit);
    }
    at.above_zero(
        "passivity_damping_n_s_m",
        spec.passivity_damping_n_s_m,
        "N·s/m",
    );
    if let Some(damping) = spec.damping_n_s_m {
        at.not_below_zero("damping_n_s_m", damping, "N·s/m");
    }
    at.not_below_zero("coulomb_n", spec.coulomb_n, "N");
    at.not_below_zero("encoder_m", spec.encoder_m, "m");
    at.not_below_zero("delay_s", spec.delay_s, "s");
    if let Some(rate) = spec.rate_hz {
        at.above_zero("rate_hz", rate, "Hz");
    }
    if at.problem_count() > before {
        return None;
    }
    let limits = LinkLimits {
        force_max_n: spec.force_max_n,
        ramp_n: if spec.ramp_s > 0.0 {
            spec.force_max_n * dt_s / spec.ramp_s
        } else {
            spec.force_max_n
        },
        stale_ticks: (spec.stale_s / dt_s).ceil() as u32,
        stride_max_m: spec.speed_max_m_s * dt_s,
    };
    let figures = DeviceFigures {
        damping_n_s_m: spec.damping_n_s_m.unwrap_or(0.0),
        coulomb_n: spec.coulomb_n,
        encoder_m: spec.encoder_m,
        period_s: spec.rate_hz.map_or(dt_s, |rate| dt_s.max(1.0 / rate)),
        delay_s: spec.delay_s,
    };
    let passivity_damping_n_s_m = spec.passivity.then_some(spec.passivity_damping_n_s_m);
    let known = spec.damping_n_s_m.is_some();
    Some((
        Device {
            torque_max_nm: spec.torque_max_nm,
            passivity_damping_n_s_m,
            bounded,
            figures,
            known,
        },
        limits,
    ))
}

/// Without friction a pair has none, rather than a coefficient of zero: it is then solved as such.
/// The outer `None` is a problem.
pub(super) fn friction(spec: Option<&FrictionSpec>, at: &At<'_>) -> Option<Option<Friction>> {
    let Some(&FrictionSpec {
        mu,
        mu_kinetic,
        viscous_n_s_m,
    }) = spec
    else {
        return Some(None);
    };
    let kinetic = mu_kinetic.unwrap_or(mu);
    let static_mu = at.not_below_zero("mu", mu, "");
    let viscous = at.not_below_zero("viscous_n_s_m", viscous_n_s_m, "N·s/m");
    if static_mu.is_some() && !(0.0..=mu).contains(&kinetic) {
        return at.key("mu_kinetic").refused(format!(
            "mu_kinetic is {kinetic}; it must be 0 to mu, which is {mu}"
        ));
    }
    let (mu, viscous_n_s_m) = (static_mu?, viscous?);
    Some((mu > 0.0 || viscous_n_s_m > 0.0).then_some(Friction {
        mu,
        mu_kinetic: kinetic,
        viscous_n_s_m,
    }))
}
