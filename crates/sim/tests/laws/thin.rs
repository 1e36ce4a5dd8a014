//! Closed bodies much wider than thick: lenses, discs and blades, against the theory of plates.

use crate::common::World;
use palpate_geometry::surface::Surface;

/// A closed body turned about z from a profile (radius, z) of a clamped cubic, then stretched: text
/// of a surface.
fn turned(around: usize, profile: &[[f64; 2]], stretch: [f64; 3]) -> String {
    let u: Vec<f64> = (0..=around).map(|k| k as f64 / around as f64).collect();
    let spans = profile.len() - 3;
    let mut v = vec![0.0; 3];
    v.extend((0..=spans).map(|k| k as f64 / spans as f64));
    v.extend(vec![1.0; 3]);
    let step = std::f64::consts::TAU / around as f64;
    // A uniform cubic shrinks a circle of control points by (2 + cos h) / 3.
    let grow = 3.0 / (2.0 + step.cos());
    let points: Vec<String> = (0..around)
        .map(|i| {
            let (s, c) = (step * i as f64).sin_cos();
            let row: Vec<String> = profile
                .iter()
                .map(|[r, z]| {
                    let place = [
                        r * grow * c * stretch[0],
                        r * grow * s * stretch[1],
                        z * stretch[2],
                    ];
                    format!("{place:?}")
                })
                .collect();
            format!("[{}]", row.join(", "))
        })
        .collect();
    format!(
        "{{ inline = {{ format = \"palpate.surface.v1\", degree = [3, 3], periodic = [true, false], \
         knots = [{u:?}, {v:?}], points = [{}] }} }}",
        points.join(", ")
    )
}

/// Half an ellipse from pole to pole.
fn lens(count: usize, radius_m: f64, half_m: f64) -> Vec<[f64; 2]> {
    (0..count)
        .map(|k| {
            let (s, c) = (std::f64::consts::PI * k as f64 / (count - 1) as f64).sin_cos();
            let s = if k == 0 || k + 1 == count { 0.0 } else { s };
            [radius_m * s, half_m * c]
        })
        .collect()
}

/// A disc of even thickness: `count` rings on each side, pole included, and `rim` between them.
fn disc(count: usize, rim: usize, radius_m: f64, half_m: f64) -> Vec<[f64; 2]> {
    let r = |k: usize| radius_m * k as f64 / (count - 1) as f64;
    let mut profile: Vec<[f64; 2]> = (0..count).map(|k| [r(k), half_m]).collect();
    profile.extend((0..rim).map(|_| [radius_m * 1.02, 0.0]));
    profile.extend((0..count).rev().map(|k| [r(k), -half_m]));
    profile
}

/// Sag of the middle of a plate turned about z, clamped at a radius, under its own weight: Kirchhoff's
/// equations with the thickness t(r) by differences, and Mindlin's shear.
fn plate_sag(
    thickness: impl Fn(f64) -> f64,
    radius_m: f64,
    young: f64,
    nu: f64,
    weight: f64,
) -> f64 {
    const N: usize = 2_000;
    let h = radius_m / N as f64;
    let d = |r: f64| young * thickness(r).powi(3) / (12.0 * (1.0 - nu * nu));
    // (r D φ')' + (ν D' − D / r) φ = r Q, φ = −w' up to its sign; Q = ∫ q r dr / r.
    let mut load = vec![0.0; N + 1];
    for k in 1..=N {
        let r = (k as f64 - 0.5) * h;
        load[k] = load[k - 1] + weight * thickness(r) * r * h;
    }
    let (mut c, mut f) = (vec![0.0; N + 1], vec![0.0; N + 1]);
    for k in 1..N {
        let r = k as f64 * h;
        let (below, above) = (
            (r - 0.5 * h) * d(r - 0.5 * h),
            (r + 0.5 * h) * d(r + 0.5 * h),
        );
        let slope = (d(r + 0.5 * h) - d(r - 0.5 * h)) / h;
        let diagonal = -(below + above) / (h * h) + nu * slope - d(r) / r;
        let (lower, upper) = (below / (h * h), above / (h * h));
        let pivot = diagonal - lower * c[k - 1];
        c[k] = upper / pivot;
        f[k] = (load[k] - lower * f[k - 1]) / pivot;
    }
    let mut phi = vec![0.0; N + 1];
    for k in (1..N).rev() {
        phi[k] = f[k] - c[k] * phi[k + 1];
    }
    let bending: f64 = -phi.iter().sum::<f64>() * h;
    let modulus = young / (2.0 * (1.0 + nu));
    let shear: f64 = (1..=N)
        .map(|k| load[k] / (k as f64 * h) / (5.0 / 6.0 * modulus * thickness(k as f64 * h)) * h)
        .sum();
    bending + shear
}

struct Thin {
    surface: String,
    model: &'static str,
    layers: usize,
    refine: String,
    young: f64,
    gravity: f64,
    fixed: String,
    more: String,
}

impl Thin {
    fn text(&self) -> String {
        let Self {
            surface,
            model,
            layers,
            refine,
            young,
            gravity,
            fixed,
            more,
        } = self;
        format!(
            r#"
[gravity]
acceleration = [0.0, 0.0, -{gravity:?}]
[[body]]
id = "thin"
surface = {surface}
model = "{model}"
material = {{ young_pa = {young:?}, poisson = 0.25, density_kg_m3 = 1000.0, damping_s = 2e-3 }}
lattice = {{ refine = {refine}, layers = {layers} }}
{fixed}
{more}
"#
        )
    }
}

const FAR: &str =
    "[[tool]]\nid = \"pen\"\nshape = { point = {} }\npose = { position = [0.0, 0.0, 1.0] }\n";
const RIM: &str = "integrator = { sleep_m_s = 0.0, iterations = 10 }\nfixed = [{ u = [0.0, 1.0], v = [0.4, 0.6] }]\n";

fn try_world(text: &str) -> Result<World, String> {
    std::panic::catch_unwind(|| World::new(text))
        .map_err(|e| e.downcast_ref::<String>().cloned().unwrap_or_default())
}

/// Half thickness of the upper side by radius.
fn upper(surface: &Surface) -> Vec<[f64; 2]> {
    (0..=400)
        .map(|k| {
            let p = surface.point(0.0, 0.5 * k as f64 / 400.0);
            [p.coords.xy().norm(), p.z]
        })
        .collect()
}

fn sag(thin: &Thin) -> String {
    let mut world = match try_world(&thin.text()) {
        Ok(world) => world,
        Err(e) => return format!("refused: {}", &e[..e.len().min(400)]),
    };
    let plate = world.scene.deformable(0).unwrap();
    let rest = plate.rest_state().positions;
    let held = (0..plate.coordinate_count()).filter(|&k| plate.unknown(k).is_none());
    let radius = held
        .map(|k| rest[k].coords.xy().norm())
        .fold(f64::INFINITY, f64::min);
    let profile = upper(world.scene.rest_surface(0));
    let thickness = |r: f64| {
        let k = profile
            .partition_point(|p| p[0] <= r)
            .clamp(1, profile.len() - 1);
        let ([r0, z0], [r1, z1]) = (profile[k - 1], profile[k]);
        2.0 * (z0 + (z1 - z0) * ((r - r0) / (r1 - r0)).clamp(0.0, 1.0))
    };
    let exact = plate_sag(thickness, radius, thin.young, 0.25, 1000.0 * thin.gravity);
    let top = |world: &World| world.surface_z();
    let before = top(&world);
    let ticks = world.rest(|world| _ = world.at_in_place([0.0, 0.0, 1.0]), 3_000);
    let sag = before - top(&world);
    let plate = world.scene.deformable(0).unwrap();
    format!(
        "{} nodes, {:?}, held from {radius:.4} m: {sag:.4e} m, {:.3} of a plate ({exact:.3e}), {ticks} ticks",
        rest.len(),
        (
            plate.cell_count(),
            world.scene.rest_surface(0).distinct_counts()
        ),
        sag / exact
    )
}

trait Top {
    fn surface_z(&self) -> f64;
}
impl Top for World {
    fn surface_z(&self) -> f64 {
        let body = self.state.bodies[0].deformable.as_ref().unwrap();
        let map = self.scene.deformable(0).unwrap();
        body.positions[map.coordinate_of_control(0)].z
    }
}

#[test]
fn probe_thin() {
    let (a, h) = (0.015, 5e-4);
    let shapes: Vec<(&str, String)> = vec![
        ("disc even", turned(16, &disc(9, 0, a, h), [1.0; 3])),
        ("disc odd", turned(16, &disc(9, 1, a, h), [1.0; 3])),
        ("lens 13", turned(12, &lens(13, a, h), [1.0; 3])),
        ("lens 14", turned(12, &lens(14, a, h), [1.0; 3])),
        ("lens 13 x 3mm", turned(12, &lens(13, a, 3.0 * h), [1.0; 3])),
        ("blade 13 y", turned(12, &lens(13, a, a), [1.0, h / a, 1.0])),
        ("blade 13 y/5", turned(12, &lens(13, a, a), [1.0, 0.2, 1.0])),
    ];
    for (name, surface) in &shapes {
        for (model, layers, refine) in [
            ("continuum", 2, "\"none\""),
            ("continuum", 2, "[16, 33]"),
            ("lattice", 2, "\"none\""),
            ("lattice", 2, "[16, 33]"),
            ("net", 2, "\"none\""),
        ] {
            let thin = Thin {
                surface: surface.clone(),
                model,
                layers,
                refine: refine.to_owned(),
                young: 1e6,
                gravity: 0.1,
                fixed: RIM.to_owned(),
                more: FAR.to_owned(),
            };
            println!("{name} {model} {layers} {refine}: {}", sag(&thin));
        }
    }
}

#[test]
fn probe_own_weight() {
    for (model, side, layers) in [
        ("lattice", 8, 5),
        ("lattice", 8, 3),
        ("lattice", 12, 5),
        ("continuum", 8, 5),
    ] {
        let text = format!(
            r#"
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[body]]
id = "slab"
surface = {{ builtin = "sheet", net = [{side}, {side}], size = 0.1 }}
model = "{model}"
material = {{ preset = "jelly" }}
lattice = {{ layers = {layers}, refine = "none", thickness_m = 0.03 }}
fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}]
{FAR}"#
        );
        let mut world = World::new(&text);
        world.rest(|world| _ = world.at_in_place([0.0, 0.0, 1.0]), 3_000);
        let mut surface = world.scene.rest_surface(0).clone();
        let body = world.state.bodies[0].deformable.as_ref().unwrap();
        let map = world.scene.deformable(0).unwrap();
        let count = surface.net().points().len();
        let z: Vec<f64> = (0..count)
            .map(|k| body.positions[map.coordinate_of_control(k)].z)
            .collect();
        let _ = &mut surface;
        let middle = z.iter().map(|z| -z).fold(f64::INFINITY, f64::min);
        let (young, density) = (6e3, 1_050.0);
        let nu: f64 = if model == "lattice" { 0.25 } else { 0.45 };
        let confined = young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
        let column = density * 9.81 * 0.03 * 0.03 / 2.0;
        println!(
            "{model} {side} {layers}: sags {:.3} mm (least of controls) of {:.3} .. {:.3}",
            middle * 1e3,
            column / confined * 1e3,
            column / young * 1e3
        );
    }
}
