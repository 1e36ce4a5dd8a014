//! The teardrop and a ball beside it, as text.

use super::Setting;

/// Radius of the ball, m, and where it comes along −x, m.
pub(super) const RADIUS_M: f64 = 0.01;
pub(super) const SIDE_M: [f64; 2] = [0.003, 0.045];

/// A teardrop of 20 kPa that is held at its thick end, and a ball.
///
/// The tool is a capsule that is shorter than a micrometre: a ball whose contact is found as that of any shape. It
/// does not go in by what the net does not show, as the exact step has nothing of that.
#[derive(Clone, Copy)]
pub(super) struct Drop {
    pub model: &'static str,
    pub poisson: f64,
    /// d of the body, s.
    pub damping_s: f64,
    pub setting: Setting,
    /// Keys of the tool's coupling and of its device.
    pub coupling: &'static str,
    pub device: &'static str,
}

impl Drop {
    /// A ball that is where its device is, without limits.
    pub(super) fn led(model: &'static str, poisson: f64, damping_s: f64, setting: Setting) -> Self {
        Self {
            model,
            poisson,
            damping_s,
            setting,
            coupling: "stiffness_n_m = inf, damping_n_s_m = 0.0",
            device: "force_max_n = 1e9, ramp_s = 0.0",
        }
    }

    pub(super) fn text(&self) -> String {
        let Self {
            model,
            poisson,
            damping_s,
            setting,
            coupling,
            device,
        } = self;
        let poisson = match *model {
            "lattice" => String::new(),
            _ => format!("poisson = {poisson:?}, "),
        };
        let lattice = match *model {
            "net" => "layers = 3, refine = [12, 13]",
            _ => "layers = 3, refine = \"none\"",
        };
        format!(
            r#"
[loop]
rate_hz = 1000
[[body]]
id = "drop"
surface = {{ builtin = "teardrop", net = [8, 8] }}
model = "{model}"
material = {{ young_pa = 20e3, {poisson}density_kg_m3 = 1000.0, damping_s = {damping_s:?} }}
lattice = {{ {lattice} }}
{}
fixed = [{{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }}]
[[tool]]
id = "ball"
shape = {{ capsule = {{ radius_m = {RADIUS_M:?}, half_length_m = 1e-7 }} }}
pose = {{ position = [0.06, 0.003, 0.045] }}
coupling = {{ {coupling} }}
device = {{ {device} }}
[[contact]]
pair = ["ball", "drop"]
near_field = false
"#,
            setting.text()
        )
    }
}
