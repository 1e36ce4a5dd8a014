//! The scenes of the suite, as text.

/// Stiffnesses of the box, as multiples of 20 kPa.
pub(super) const SCALES: [(f64, &str); 4] = [
    (1.0, "x1"),
    (10.0, "x10"),
    (100.0, "x100"),
    (1000.0, "x1000"),
];

/// The lowest part of the teardrop, up to this height, is fixed, m.
pub(super) const TEARDROP_FIXED_M: f64 = 0.015;

/// Refinement where the ball presses the teardrop.
const WHERE_IT_PRESSES: &str = "{ focus = [[0.024, 0.003, 0.045]] }";

/// Pressing the box.
pub(super) struct BoxCase {
    /// By which it is asked for.
    pub name: String,
    /// Under which it is listed: the same task for all methods.
    pub group: String,
    /// Too long for a quick run, unless asked for.
    pub long: bool,
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
        Self {
            name: name.to_owned(),
            group: name.to_owned(),
            long: false,
            model,
            method: "implicit",
            nodes,
            cells: nodes - 1,
            scale: 1.0,
            dt_s: 1e-3,
            iterations: 1,
            substeps: 1,
        }
    }

    /// One model and method beside the others that press the same box.
    fn beside(name: String, group: &str, model: &'static str) -> Self {
        Self {
            group: group.to_owned(),
            ..Self::new(&name, model, 12)
        }
    }

    pub(super) fn all() -> Vec<Self> {
        let mut cases = Vec::new();
        for (scale, label) in SCALES {
            let group = format!("indent/12/{label}");
            let lattice = |method, substeps| {
                let case = Self::beside(
                    format!("indent/12/lattice/{method}/{label}"),
                    &group,
                    "lattice",
                );
                Self {
                    method,
                    scale,
                    substeps,
                    ..case
                }
            };
            cases.push(lattice("implicit", 1));
            // Explicit steps of a stiff body are many: substeps grow with the square root of E, or
            // with E where it is damped.
            cases.push(Self {
                long: scale > 1.0,
                ..lattice("explicit", 1)
            });
            cases.push(Self {
                long: scale > 1.0 && scale < 1000.0,
                ..lattice("xpbd", 10)
            });
            cases.push(Self {
                scale,
                ..Self::beside(format!("indent/12/continuum/{label}"), &group, "continuum")
            });
        }
        for nodes in [6, 8, 16] {
            for model in ["lattice", "continuum"] {
                let case = Self::new(&format!("indent/{nodes}/{model}"), model, nodes);
                cases.push(Self {
                    long: nodes == 16,
                    ..case
                });
            }
        }
        cases.push(Self {
            cells: 11,
            ..Self::new("indent/12/net", "net", 8)
        });
        cases.push(Self {
            cells: 11,
            ..Self::new("indent/12/net/10", "net", 10)
        });
        cases.push(Self {
            cells: 29,
            long: true,
            ..Self::new("indent/30/net", "net", 8)
        });
        for (dt_s, label) in [
            (0.5e-3, "0.5ms"),
            (2e-3, "2ms"),
            (5e-3, "5ms"),
            (20e-3, "20ms"),
        ] {
            for model in ["lattice", "continuum"] {
                let case = Self::new(&format!("indent/12/{model}/dt/{label}"), model, 12);
                cases.push(Self {
                    dt_s,
                    long: label == "0.5ms" || model == "continuum",
                    ..case
                });
            }
        }
        for iterations in [2, 3] {
            let name = format!("indent/12/continuum/iterations/{iterations}");
            cases.push(Self {
                iterations,
                long: true,
                ..Self::new(&name, "continuum", 12)
            });
        }
        cases
    }

    /// The scene: net on top, copies below.
    pub(super) fn text(&self) -> String {
        let Self {
            model,
            method,
            nodes,
            cells,
            scale,
            dt_s,
            iterations,
            substeps,
            ..
        } = self;
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

/// A biquadratic square of 0.1 m whose control points are evenly spaced, so that cells below them
/// are cubes.
fn flat_surface(nodes: usize) -> String {
    let knots: Vec<String> = (0..nodes + 3)
        .map(|k| format!("{:?}", (k.clamp(2, nodes) - 2) as f64 / (nodes - 2) as f64))
        .collect();
    let at = |k: usize| 0.1 * k as f64 / (nodes - 1) as f64 - 0.05;
    let row = |i: usize| {
        let points: Vec<String> = (0..nodes)
            .map(|j| format!("[{:?}, {:?}, 0.0]", at(i), at(j)))
            .collect();
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
    pub method: String,
    pub model: &'static str,
    /// What `lattice = { … }` holds.
    lattice: String,
    /// Springs as in the thesis, K = E A / L.
    seed_springs: bool,
}

impl TeardropCase {
    pub(super) fn new(name: &str, model: &'static str, refine: &str, layers: usize) -> Self {
        let lattice = format!("layers = {layers}, refine = {refine}");
        Self {
            name: name.to_owned(),
            method: model.to_owned(),
            model,
            lattice,
            seed_springs: false,
        }
    }

    /// A cube of nodes, the outermost on the surface.
    fn riding(name: &str, refine: &str) -> Self {
        Self {
            method: "lattice riding".to_owned(),
            ..Self::cube(name, 12, refine)
        }
    }

    /// A cube of so many nodes along each axis, the outermost on the surface.
    pub(super) fn cube(name: &str, side: usize, refine: &str) -> Self {
        Self {
            lattice: format!(
                "builder = \"transfinite\", nodes = [{side}, {side}, {side}], refine = {refine}"
            ),
            ..Self::new(name, "lattice", refine, 4)
        }
    }

    pub(super) fn all() -> Vec<Self> {
        let seed = |name: &str, refine: &str| Self {
            method: "lattice, seed's springs".to_owned(),
            seed_springs: true,
            ..Self::new(name, "lattice", refine, 4)
        };
        let mut cases = Vec::new();
        for (model, layers) in [
            ("lattice", 3),
            ("lattice", 4),
            ("continuum", 3),
            ("continuum", 4),
            ("net", 2),
        ] {
            let name = format!("indent/teardrop/{model}/auto/{layers}");
            cases.push(Self::new(&name, model, "\"auto\"", layers));
            // The others with a focus are below.
            if layers == 3 {
                let name = format!("indent/teardrop/{model}/3");
                cases.push(Self::new(&name, model, WHERE_IT_PRESSES, layers));
            }
        }
        cases.extend([
            Self::new("indent/teardrop/lattice", "lattice", WHERE_IT_PRESSES, 4),
            Self::new("indent/teardrop/lattice/12x13", "lattice", "[12, 13]", 4),
            Self::new("indent/teardrop/lattice/22x23", "lattice", "[22, 23]", 4),
            Self::new(
                "indent/teardrop/continuum",
                "continuum",
                WHERE_IT_PRESSES,
                4,
            ),
            Self::new(
                "indent/teardrop/continuum/12x13",
                "continuum",
                "[12, 13]",
                4,
            ),
            Self::new(
                "indent/teardrop/continuum/22x23",
                "continuum",
                "[22, 23]",
                4,
            ),
            Self::new("indent/teardrop/net", "net", WHERE_IT_PRESSES, 2),
            Self::new("indent/teardrop/net/12x13", "net", "[12, 13]", 2),
            Self::new("indent/teardrop/net/16x17", "net", "[16, 17]", 2),
            Self::new("indent/teardrop/net/16x17x3", "net", "[16, 17]", 3),
            Self::riding("indent/teardrop/riding/8x8", "\"none\""),
            Self::riding("indent/teardrop/riding/13x13", "[13, 13]"),
            seed("indent/teardrop/seed/12x13", "[12, 13]"),
            seed("indent/teardrop/seed/22x23", "[22, 23]"),
        ]);
        cases
    }

    pub(super) fn text(&self, rate_hz: u32) -> String {
        let Self { model, lattice, .. } = self;
        let springs = if self.seed_springs {
            ", springs = \"seed\""
        } else {
            ""
        };
        format!(
            r#"
[loop]
rate_hz = {rate_hz}
[[body]]
id = "drop"
surface = {{ builtin = "teardrop", net = [8, 8] }}
model = "{model}"
material = {{ young_pa = 20e3, poisson = 0.3, density_kg_m3 = 1000.0, damping_s = 2e-3{springs} }}
lattice = {{ {lattice}, cells_per_span = 2 }}
integrator = {{ sleep_m_s = 0.0 }}
fixed = [{{ point = [0.0, 0.0, {TEARDROP_FIXED_M:?}], normal = [0.0, 0.0, 1.0] }}]
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

/// A block of plasticine below the plane z = 0, under a ball with a strong grip.
pub(super) fn plasticine_text(young_pa: f64) -> String {
    format!(
        r#"
[loop]
rate_hz = 1000
[[body]]
id = "block"
surface = {{ inline = {surface} }}
model = "lattice"
material = {{ preset = "plasticine", young_pa = {young_pa:?} }}
lattice = {{ layers = 8, refine = "none", thickness_m = 0.06 }}
integrator = {{ sleep_m_s = 0.0 }}
fixed = [{{ point = [0.0, 0.0, -0.0599], normal = [0.0, 0.0, 1.0] }}]
[[tool]]
id = "ball"
shape = {{ sphere = {{ radius_m = 0.01 }} }}
pose = {{ position = [0.0, 0.0, 0.02] }}
coupling = {{ stiffness_n_m = 1e6, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e4, ramp_s = 0.0 }}
grip = {{ force_max_n = 1e4 }}
"#,
        surface = flat_surface(12),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_sim::scene::file;
    use std::path::Path;

    #[test]
    fn every_scene_of_the_suite_is_one_and_the_cases_people_ask_for_are_there() {
        let mut scenes: Vec<(String, String)> = BoxCase::all()
            .iter()
            .map(|c| (c.name.clone(), c.text()))
            .collect();
        scenes.extend(
            TeardropCase::all()
                .iter()
                .map(|c| (c.name.clone(), c.text(1_000))),
        );
        scenes.push(("plasticine".to_owned(), plasticine_text(13e6)));
        for (name, text) in &scenes {
            let parsed = file::parse(text, "bench.toml", Path::new("."));
            assert!(
                parsed.is_ok(),
                "{name}: {:?}",
                parsed.err().map(|e| e.to_string())
            );
        }
        for part in [
            "indent/12/lattice/implicit/x1000",
            "indent/12/continuum",
            "indent/12/net",
            "indent/30/net",
            "indent/teardrop/lattice",
            "indent/teardrop/continuum",
            "indent/teardrop/net",
        ] {
            assert!(
                scenes.iter().any(|(name, _)| name.contains(part)),
                "no case is called {part}"
            );
        }
        let mut names: Vec<&String> = scenes.iter().map(|(name, _)| name).collect();
        names.sort();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
    }
}
