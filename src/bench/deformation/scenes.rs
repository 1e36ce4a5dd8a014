//! The scenes of the suite, as text.

use super::Effort;

/// Pressing the box.
pub(super) struct BoxCase {
    pub name: String,
    /// `lattice`, `continuum`, `net`.
    pub model: &'static str,
    /// `implicit`, `explicit`, `xpbd`.
    pub method: &'static str,
    /// Nodes a side, or coordinates a side of a net.
    pub nodes: usize,
    /// Of a net: cells a side.
    pub cells: usize,
    /// E is 20 kPa times this.
    pub scale: f64,
    pub dt_s: f64,
    pub iterations: usize,
    pub substeps: usize,
}

impl BoxCase {
    fn new(name: &str, model: &'static str, nodes: usize) -> Self {
        let (method, scale, dt_s) = ("implicit", 1.0, 1e-3);
        Self { name: name.to_owned(), model, method, nodes, cells: nodes - 1, scale, dt_s, iterations: 1, substeps: 1 }
    }

    pub(super) fn all(effort: Effort) -> Vec<Self> {
        let mut cases = Vec::new();
        for (scale, label) in [(1.0, "x1"), (10.0, "x10"), (100.0, "x100"), (1000.0, "x1000")] {
            let lattice = |method, substeps| Self {
                method,
                scale,
                substeps,
                ..Self::new(&format!("indent/12/lattice/{method}/{label}"), "lattice", 12)
            };
            cases.extend([lattice("implicit", 1), lattice("explicit", 1), lattice("xpbd", 10)]);
            let name = format!("indent/12/continuum/{label}");
            cases.push(Self { scale, ..Self::new(&name, "continuum", 12) });
        }
        for (nodes, name) in [(6, "indent/6/continuum"), (8, "indent/8/continuum"), (16, "indent/16/continuum")] {
            cases.push(Self::new(name, "continuum", nodes));
        }
        for (nodes, name) in [(6, "indent/6/lattice"), (8, "indent/8/lattice"), (16, "indent/16/lattice")] {
            cases.push(Self::new(name, "lattice", nodes));
        }
        cases.push(Self { cells: 11, ..Self::new("indent/12/net", "net", 8) });
        cases.push(Self { cells: 11, ..Self::new("indent/12/net/10", "net", 10) });
        if effort == Effort::Full {
            cases.push(Self { cells: 29, ..Self::new("indent/30/net", "net", 8) });
        }
        for (dt_s, label) in [(0.5e-3, "0.5ms"), (2e-3, "2ms"), (5e-3, "5ms")] {
            cases.push(Self { dt_s, ..Self::new(&format!("indent/12/lattice/dt/{label}"), "lattice", 12) });
        }
        for iterations in [2, 3] {
            let name = format!("indent/12/continuum/iterations/{iterations}");
            cases.push(Self { iterations, ..Self::new(&name, "continuum", 12) });
        }
        cases
    }

    /// The scene: net on top, copies below.
    pub(super) fn text(&self) -> String {
        let Self { model, method, nodes, cells, scale, dt_s, iterations, substeps, .. } = self;
        let rate = (1.0 / dt_s).round();
        let (per_span, layers) = (cells.div_ceil(nodes - 2), cells);
        format!(
            r#"
[loop]
rate_hz = {rate}
[[body]]
id = "box"
surface = {{ inline = {surface} }}
model = "{model}"
material = {{ young_pa = {young:?}, poisson = 0.3, density_kg_m3 = 1000.0, damping_s = 2e-3 }}
lattice = {{ layers = {nodes}, refine = "none", thickness_m = 0.1, cells_per_span = {per_span}, cell_layers = {layers} }}
integrator = {{ method = "{method}", iterations = {iterations}, substeps = {substeps}, sleep_m_s = 0.0 }}
fixed = [{{ point = [0.0, 0.0, -0.0999], normal = [0.0, 0.0, 1.0] }}]
[[tool]]
id = "ball"
shape = {{ sphere = {{ radius_m = 0.03 }} }}
pose = {{ position = [0.0, 0.0, 0.035] }}
coupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0 }}
"#,
            surface = flat_surface(*nodes),
            young = 20e3 * scale,
        )
    }
}

/// A biquadratic square of 0.1 m whose control points are evenly spaced, so that cells below them are cubes.
fn flat_surface(nodes: usize) -> String {
    let knots: Vec<String> =
        (0..nodes + 3).map(|k| format!("{:?}", (k.clamp(2, nodes) - 2) as f64 / (nodes - 2) as f64)).collect();
    let at = |k: usize| 0.1 * k as f64 / (nodes - 1) as f64 - 0.05;
    let row = |i: usize| {
        let points: Vec<String> = (0..nodes).map(|j| format!("[{:?}, {:?}, 0.0]", at(i), at(j))).collect();
        format!("[{}]", points.join(", "))
    };
    let rows: Vec<String> = (0..nodes).map(row).collect();
    let knots = format!("[{}]", knots.join(", "));
    format!(
        "{{ format = \"palpate.surface.v1\", degree = [2, 2], periodic = [false, false], knots = [{knots}, {knots}], \
         points = [{}] }}",
        rows.join(", ")
    )
}

/// Pressing the teardrop from the side.
pub(super) struct TeardropCase {
    pub name: String,
    pub model: &'static str,
    pub refine: &'static str,
    pub layers: usize,
    pub cells_per_span: usize,
}

impl TeardropCase {
    pub(super) fn new(name: &str, model: &'static str, refine: &'static str, layers: usize) -> Self {
        Self { name: name.to_owned(), model, refine, layers, cells_per_span: 2 }
    }

    pub(super) fn all() -> Vec<Self> {
        vec![
            Self::new("indent/teardrop/lattice", "lattice", "\"auto\"", 4),
            Self::new("indent/teardrop/lattice/12x13", "lattice", "[12, 13]", 4),
            Self::new("indent/teardrop/lattice/22x23", "lattice", "[22, 23]", 4),
            Self::new("indent/teardrop/continuum", "continuum", "\"auto\"", 4),
            Self::new("indent/teardrop/continuum/12x13", "continuum", "[12, 13]", 4),
            Self::new("indent/teardrop/continuum/22x23", "continuum", "[22, 23]", 4),
            Self::new("indent/teardrop/net", "net", "\"auto\"", 2),
            Self::new("indent/teardrop/net/12x13", "net", "[12, 13]", 2),
            Self::new("indent/teardrop/net/16x17", "net", "[16, 17]", 2),
            Self::new("indent/teardrop/net/16x17x3", "net", "[16, 17]", 3),
        ]
    }

    pub(super) fn text(&self, rate_hz: u32) -> String {
        let Self { model, refine, layers, cells_per_span, .. } = self;
        format!(
            r#"
[loop]
rate_hz = {rate_hz}
[[body]]
id = "drop"
surface = {{ builtin = "teardrop", net = [8, 8] }}
model = "{model}"
material = {{ young_pa = 20e3, poisson = 0.3, density_kg_m3 = 1000.0, damping_s = 2e-3 }}
lattice = {{ layers = {layers}, refine = {refine}, cells_per_span = {cells_per_span} }}
integrator = {{ sleep_m_s = 0.0 }}
fixed = [{{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }}]
[[tool]]
id = "ball"
shape = {{ sphere = {{ radius_m = 0.01 }} }}
pose = {{ position = [0.06, 0.003, 0.045] }}
coupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0 }}
"#
        )
    }
}
