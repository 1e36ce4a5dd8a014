//! The body of most hard cases: a square slab of 0.1 m, 0.03 m thick, that lies on its fixed underside.

use super::Kind;
use super::row::Run;

/// Radius of the ball that presses the slab, m.
pub(super) const RADIUS_M: f64 = 0.02;
/// Thickness of the slab, m.
pub(super) const THICKNESS_M: f64 = 0.03;
/// Side of the slab, m.
pub(super) const SIDE_M: f64 = 0.1;

/// The slab, its tools, and what else its scene says.
pub(super) struct Slab {
    pub kind: Kind,
    /// Control points a side, and layers.
    pub side: usize,
    pub layers: usize,
    pub material: String,
    /// Regions of the body.
    pub regions: String,
    pub rate_hz: u32,
    pub tools: String,
    /// Tables before the body.
    pub scene: String,
}

impl Slab {
    pub fn new(kind: Kind) -> Self {
        Self {
            kind,
            side: 6,
            layers: 3,
            material: "young_pa = 20e3, damping_s = 2e-3".to_owned(),
            regions: String::new(),
            rate_hz: 1_000,
            tools: ball("ball", "inf", RADIUS_M),
            scene: String::new(),
        }
    }

    pub fn text(&self) -> String {
        let Self {
            kind: Kind { model, method },
            side,
            layers,
            material,
            regions,
            rate_hz,
            tools,
            scene,
        } = self;
        let body = body(model, method, *side, *layers, material);
        format!(
            "[loop]\nrate_hz = {rate_hz}\n{scene}\n[[body]]\nid = \"slab\"\n{body}{regions}\n{tools}"
        )
    }

    pub fn run(&self) -> Result<Run, String> {
        Run::new(&self.text())
    }

    /// Force of a ball that presses so deep within so many ticks and then stays for as many.
    pub fn force_n(&self, depth_m: f64, ticks: usize) -> Result<f64, String> {
        Ok(press(&mut self.run()?, RADIUS_M, depth_m, ticks))
    }
}

/// Keys of a slab's `[[body]]`.
pub(super) fn body(
    model: &str,
    method: &str,
    side: usize,
    layers: usize,
    material: &str,
) -> String {
    format!(
        r#"surface = {{ builtin = "sheet", net = [{side}, {side}], size = {SIDE_M:?} }}
model = "{model}"
material = {{ {material} }}
lattice = {{ layers = {layers}, refine = "none", thickness_m = {THICKNESS_M:?} }}
integrator = {{ method = "{method}" }}
fixed = [{{ point = [0.0, 0.0, {:?}], normal = [0.0, 0.0, 1.0] }}]
"#,
        1e-4 - THICKNESS_M
    )
}

/// A ball 50 mm above the slab.
pub(super) fn ball(id: &str, stiffness: &str, radius_m: f64) -> String {
    tool(
        id,
        &format!("{{ sphere = {{ radius_m = {radius_m:?} }} }}"),
        [0.0, 0.0, 0.05],
        stiffness,
    )
}

/// A tool that no device limits.
pub(super) fn tool(id: &str, shape: &str, place: [f64; 3], stiffness: &str) -> String {
    format!(
        r#"
[[tool]]
id = "{id}"
shape = {shape}
pose = {{ position = {place:?} }}
coupling = {{ stiffness_n_m = {stiffness}, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0, speed_max_m_s = 1e6 }}
"#
    )
}

/// Lowers the ball from touch to a depth over `ticks`, then holds it for as many; force at the end,
/// N.
pub(super) fn press(run: &mut Run, radius_m: f64, depth_m: f64, ticks: usize) -> f64 {
    let mut force = 0.0;
    for k in 0..2 * ticks {
        let share = (k as f64 / ticks as f64).min(1.0);
        force = run.at([0.0, 0.0, radius_m - depth_m * share]).z;
    }
    force
}

/// Boxes of a slab's cells in turn, each with another value of a key.
pub(super) fn checkerboard(key: &str, values: &[f64]) -> String {
    let (mut text, cells, h) = (String::new(), 5, SIDE_M / 5.0);
    for i in 0..cells {
        for j in 0..cells {
            for layer in 0..2 {
                let value = values[(i + j + layer) % values.len()];
                let low = [
                    -0.5 * SIDE_M + h * i as f64,
                    -0.5 * SIDE_M + h * j as f64,
                    -0.5 * THICKNESS_M * (layer + 1) as f64 - 1e-9,
                ];
                let high = [low[0] + h, low[1] + h, low[2] + 0.5 * THICKNESS_M + 2e-9];
                text += &format!(
                    "[[body.region]]\nbox = {{ low = {low:?}, high = {high:?} }}\n{key} = {value:?}\n"
                );
            }
        }
    }
    text
}
