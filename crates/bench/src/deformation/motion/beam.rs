//! Scenes of beams, bars and plates, as text.

/// Length of a beam and the sides of its section, m.
pub(super) const LENGTH_M: f64 = 0.1;

/// A strip along x from a sheet with thickness.
pub(super) struct Strip {
    pub model: &'static str,
    pub young_pa: f64,
    pub poisson: f64,
    /// Control points along and across.
    pub counts: [usize; 2],
    pub layers: usize,
    pub width_m: f64,
    pub thickness_m: f64,
    /// `fixed = […]`, or nothing.
    pub fixed: &'static str,
}

impl Strip {
    /// A beam that is clamped at x = 0, its cells about cubes.
    pub(super) fn clamped(model: &'static str, young_pa: f64) -> Self {
        let (counts, layers, thickness_m) = match model {
            "membrane" => ([21, 5], 1, 4e-3),
            "net" => ([13, 5], 3, 0.02),
            _ => ([16, 4], 4, 0.02),
        };
        Self {
            model,
            young_pa,
            poisson: 0.25,
            counts,
            layers,
            width_m: 0.02,
            thickness_m,
            fixed: "fixed = [{ u = [0.0, 0.1], v = [0.0, 1.0] }]",
        }
    }

    /// The scene; its tool is far away.
    pub(super) fn text(&self, integrator: &str) -> String {
        let Self {
            model,
            young_pa,
            poisson,
            counts,
            layers,
            width_m,
            thickness_m,
            fixed,
        } = self;
        let poisson = match *model {
            "lattice" | "membrane" => String::new(),
            _ => format!("poisson = {poisson:?}, "),
        };
        let layers = match *model {
            "membrane" => String::new(),
            _ => format!("layers = {layers}, "),
        };
        // A polygon's control points are as far apart at its ends as elsewhere.
        let degree = if *model == "net" { 3 } else { 1 };
        let surface = surface(degree, *counts, LENGTH_M, *width_m);
        format!(
            r#"
[loop]
rate_hz = 1000
[[body]]
id = "beam"
surface = {{ inline = {surface} }}
model = "{model}"
material = {{ young_pa = {young_pa:?}, {poisson}density_kg_m3 = 1000.0, damping_s = 0.0 }}
lattice = {{ {layers}refine = "none", thickness_m = {thickness_m:?} }}
{integrator}
{fixed}
{FAR_TOOL}"#
        )
    }
}

/// A tool that touches nothing.
pub(super) const FAR_TOOL: &str = r#"
[[tool]]
id = "pen"
shape = { point = {} }
pose = { position = [0.0, 0.0, 10.0] }
"#;

/// A flat rectangle in z = 0 from x = 0, its control points at the Greville abscissae.
pub(super) fn surface(degree: usize, counts: [usize; 2], length_m: f64, width_m: f64) -> String {
    let [u, v] = counts.map(|count| knots(degree, count));
    let [x, y] = [&u, &v].map(|knots| greville(degree, knots));
    let rows: Vec<String> = x
        .iter()
        .map(|x| {
            let points: Vec<String> = y
                .iter()
                .map(|y| format!("[{:?}, {:?}, 0.0]", x * length_m, (y - 0.5) * width_m))
                .collect();
            format!("[{}]", points.join(", "))
        })
        .collect();
    format!(
        "{{ format = \"palpate.surface.v1\", degree = [{degree}, {degree}], periodic = [false, false], \
         knots = [{u:?}, {v:?}], points = [{}] }}",
        rows.join(", ")
    )
}

/// Knots of a clamped spline of even spans.
fn knots(degree: usize, count: usize) -> Vec<f64> {
    let spans = count - degree;
    let mut knots = vec![0.0; degree];
    knots.extend((0..=spans).map(|k| k as f64 / spans as f64));
    knots.extend(vec![1.0; degree]);
    knots
}

fn greville(degree: usize, knots: &[f64]) -> Vec<f64> {
    (1..knots.len() - degree)
        .map(|i| knots[i..i + degree].iter().sum::<f64>() / degree as f64)
        .collect()
}
