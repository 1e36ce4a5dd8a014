//! Closed bodies much wider than thick, lenses, discs and blades, against the theory of plates; and
//! what a hard hit leaves behind.

use crate::common::{Laws as _, World};
use palpate_geometry::math::{Point3, Vector3};
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
/// Held where it is no thinner than 0.7 of its middle.
const RIM: &str = "integrator = { sleep_m_s = 0.0, iterations = 4 }\nfixed = [{ u = [0.0, 1.0], v = [0.25, 0.75] }]\n";

/// Half thickness of the upper side by radius.
fn upper(surface: &Surface) -> Vec<[f64; 2]> {
    (0..=400)
        .map(|k| {
            let p = surface.point(0.0, 0.5 * k as f64 / 400.0);
            [p.coords.xy().norm(), p.z]
        })
        .collect()
}

/// Sag of the middle over that of the plate.
fn sag(thin: &Thin) -> f64 {
    let mut world = World::new(&thin.text());
    let plate = world.scene.deformable(0).unwrap();
    let rest = plate.rest_state().positions;
    let held = (0..plate.coordinate_count()).filter(|&k| plate.unknown(k).is_none());
    let radius = held
        .map(|k| rest[k].coords.xy().norm())
        .fold(f64::INFINITY, f64::min);
    let profile = upper(world.scene.rest_surface(0).unwrap());
    let thickness = |r: f64| {
        let k = profile.partition_point(|p| p[0] <= r);
        let k = k.clamp(1, profile.len() - 1);
        let ([r0, z0], [r1, z1]) = (profile[k - 1], profile[k]);
        2.0 * (z0 + (z1 - z0) * ((r - r0) / (r1 - r0)).clamp(0.0, 1.0))
    };
    let exact = plate_sag(thickness, radius, thin.young, 0.25, 1000.0 * thin.gravity);
    let pole = plate.coordinate_of_control(0);
    let height = |world: &World| {
        let body = world.state.bodies[0].deformable.as_ref().unwrap();
        body.positions[pole].z
    };
    let before = height(&world);
    let ticks = world.rest(|world| _ = world.at_in_place([0.0, 0.0, 1.0]), 3_000);
    let sag = before - height(&world);
    println!(
        "{} {} {}: {} nodes, held from {radius:.4} m, sags by {sag:.4e} m, {:.3} of a plate, {ticks} ticks",
        thin.model,
        thin.layers,
        thin.refine,
        rest.len(),
        sag / exact
    );
    sag / exact
}

fn clamped(surface: &str, model: &'static str, refine: &str) -> Thin {
    Thin {
        surface: surface.to_owned(),
        model,
        layers: 2,
        refine: refine.to_owned(),
        young: 1e6,
        gravity: 0.1,
        fixed: RIM.to_owned(),
        more: FAR.to_owned(),
    }
}

// Four cells across miss 1 / 16 of the stiffness of a plate at their centres, and cells of length l
// lock by 2 % of ½ (l / t)². Shells about a curve were refused. A net bends by splines over several rings, and its clamp
// by as many: where a lens grows thin at its clamp it is too stiff, by 37 % with 13 rings and 16 % with 25.
#[test]
fn thin_closed_solids_held_at_their_rim_sag_as_plates() {
    let (radius, half) = (0.015, 5e-4);
    let round = [1.0; 3];
    let shapes = [
        ("disc", turned(16, &disc(9, 0, radius, half), round)),
        (
            "disc with a rim",
            turned(16, &disc(9, 1, radius, half), round),
        ),
        ("lens, 13 rings", turned(12, &lens(13, radius, half), round)),
        ("lens, 14 rings", turned(12, &lens(14, radius, half), round)),
        (
            "lens of 3 mm",
            turned(12, &lens(13, radius, 3.0 * half), round),
        ),
    ];
    for (shape, model, refine, most) in [
        (0, "continuum", "[16, 33]", 0.12),
        (0, "net", "\"none\"", 0.12),
        (1, "lattice", "[16, 33]", 0.12),
        (2, "continuum", "[16, 33]", 0.12),
        (2, "net", "[12, 25]", 0.2),
        (3, "lattice", "[16, 33]", 0.12),
        (4, "continuum", "[16, 33]", 0.12),
    ] {
        let (name, surface) = &shapes[shape];
        println!("{name}");
        let sag = sag(&clamped(surface, model, refine));
        assert!(
            (sag - 1.0).abs() < most,
            "{name}, {model}: {sag} of a plate"
        );
    }
}

/// The least volume of a cell over that at rest, at its centre; of a body whose nodes are its
/// coordinates.
fn least_volume(world: &World) -> f64 {
    let solid = world.scene.deformable(0).unwrap();
    let now = &world.state.bodies[0].deformable.as_ref().unwrap().positions;
    let rest = solid.rest_state().positions;
    let volume = |cell: &[u32; 8], places: &[Point3]| {
        let side = |bit: usize| -> Vector3 {
            let of = |k: usize| if k & bit != 0 { 0.25 } else { -0.25 };
            (0..8)
                .map(|k| places[cell[k] as usize].coords * of(k))
                .sum()
        };
        side(4).cross(&side(2)).dot(&side(1))
    };
    solid
        .cells()
        .iter()
        .map(|cell| volume(cell, now) / volume(cell, &rest))
        .fold(f64::INFINITY, f64::min)
}

/// Distance of the two poles over that at rest.
fn thickness(world: &World) -> f64 {
    let solid = world.scene.deformable(0).unwrap();
    let now = &world.state.bodies[0].deformable.as_ref().unwrap().positions;
    let rest = solid.rest_state().positions;
    let last = world.scene.rest_surface(0).unwrap().net().columns() - 1;
    let [a, b] = [0, last].map(|k| solid.coordinate_of_control(k));
    (now[a] - now[b]).norm() / (rest[a] - rest[b]).norm()
}

#[test]
fn a_lens_of_a_millimetre_that_is_pressed_pinched_and_dropped_does_not_turn_inside_out() {
    let surface = turned(12, &lens(13, 0.015, 5e-4), [1.0; 3]);
    let ball = |id: &str, z: f64| {
        format!(
            "[[tool]]\nid = \"{id}\"\nshape = {{ sphere = {{ radius_m = 0.005 }} }}\n\
             pose = {{ position = [0.0, 0.0, {z:?}] }}\ncoupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}\n\
             device = {{ force_max_n = 1e9, ramp_s = 0.0 }}\n"
        )
    };
    let floor = "[[tool]]\nid = \"floor\"\nshape = { plane = { normal = [0.0, 0.0, 1.0] } }\n\
                 pose = { position = [0.0, 0.0, -0.02] }\ncoupling = { stiffness_n_m = inf, damping_n_s_m = 0.0 }\n\
                 device = { force_max_n = 1e9, ramp_s = 0.0 }\n";
    let held = "fixed = [{ u = [0.0, 1.0], v = [0.4, 0.6] }]";
    for model in ["continuum", "lattice", "net"] {
        let thin = |gravity: f64, fixed: &str, more: String| {
            World::new(
                &Thin {
                    surface: surface.clone(),
                    model,
                    layers: 2,
                    refine: "\"none\"".to_owned(),
                    young: 1e5,
                    gravity,
                    fixed: fixed.to_owned(),
                    more,
                }
                .text(),
            )
        };
        let mut least = [f64::INFINITY; 3];
        let mut most = [0.0_f64; 3];
        let mut watch = |case: usize, world: &World| {
            if model != "net" {
                least[case] = least[case].min(least_volume(world));
            }
            let thickness = thickness(world);
            least[case] = least[case].min(thickness);
            most[case] = most[case].max(thickness);
        };
        // Twice its thickness deep in 0.2 s.
        let mut world = thin(0.0, held, ball("ball", 0.02));
        for k in 0..250 {
            let depth = 0.002 * (k as f64 / 200.0).min(1.0);
            world.at_in_place([0.0, 0.0, 0.0055 - depth]);
            watch(0, &world);
        }
        // Two balls that leave half of it between them.
        let mut world = thin(0.0, held, ball("upper", 0.02) + &ball("lower", -0.02));
        for k in 0..250 {
            let depth = 0.25e-3 * (k as f64 / 200.0).min(1.0);
            let z = 0.0055 - depth;
            world.all_in_place(&[([0.0, 0.0, z], 0), ([0.0, 0.0, -z], 0)]);
            watch(1, &world);
        }
        // 2 cm onto a floor.
        let mut world = thin(9.81, "", floor.to_owned());
        for _ in 0..200 {
            world.at_in_place([0.0, 0.0, -0.02]);
            watch(2, &world);
        }
        println!("{model}: least {least:?}, most {most:?}");
        assert!(least.iter().all(|&x| x > 0.1), "{model}: {least:?}");
        assert!(most.iter().all(|&x| x < 2.0), "{model}: {most:?}");
    }
}

// A blade has its poles on its rim.
#[test]
fn a_flat_body_that_cannot_be_built_says_how_to_draw_it() {
    let surface = turned(12, &lens(13, 0.015, 0.015), [1.0, 1.0 / 30.0, 1.0]);
    let text = clamped(&surface, "continuum", "\"none\"").text();
    let loaded = palpate_sim::scene::file::parse(&text, "test.toml", std::path::Path::new("."));
    let error = palpate_sim::scene::Scene::build(&loaded.unwrap().spec, std::path::Path::new("."));
    let error = error.err().unwrap().to_string();
    assert!(error.contains("body[0].lattice"), "{error}");
    assert!(
        error.contains("poles of its net in the middle of its two sides"),
        "{error}"
    );
}

#[test]
fn a_slab_hit_by_a_thousand_newtons_for_a_tick_gains_no_energy() {
    for model in ["continuum", "net"] {
        let text = format!(
            r#"
[[body]]
id = "slab"
surface = {{ builtin = "sheet", net = [6, 6], size = 0.1 }}
model = "{model}"
material = {{ young_pa = 20e3, damping_s = 2e-3 }}
lattice = {{ layers = 3, refine = "none", thickness_m = 0.03 }}
fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}]
[[tool]]
id = "ball"
shape = {{ sphere = {{ radius_m = 0.02 }} }}
pose = {{ position = [0.0, 0.0, 0.05] }}
coupling = {{ stiffness_n_m = 1e8, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e3, ramp_s = 0.0, speed_max_m_s = 1e6 }}
"#
        );
        let mut world = World::new(&text);
        let energy = |world: &World| {
            let solid = world.scene.deformable(0).unwrap();
            let state = world.state.bodies[0].deformable.as_ref().unwrap();
            let moving = solid.masses().iter().zip(&state.velocities);
            solid.energy_j(state) + moving.map(|(m, v)| 0.5 * m * v.norm_squared()).sum::<f64>()
        };
        for _ in 0..100 {
            world.at_in_place([0.0, 0.0, 0.021]);
        }
        world.at_in_place([0.0, 0.0, -0.1]);
        let put_in = energy(&world);
        let mut most = 0.0_f64;
        for _ in 0..300 {
            world.at_in_place([0.0, 0.0, 0.1]);
            most = most.max(energy(&world));
        }
        println!(
            "{model}: {put_in} J put in, {:+.2} % at most later",
            100.0 * (most / put_in - 1.0)
        );
        assert!(most < 1.005 * put_in, "{model}: {most} of {put_in} J");
    }
}
