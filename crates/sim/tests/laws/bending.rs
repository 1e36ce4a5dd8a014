//! Beams and plates that are clamped by ranges of parameters, against theory.

use crate::common::World;
use palpate_sim::body::DeformableState;

fn body(world: &World) -> &DeformableState {
    world.state.bodies[0].deformable.as_ref().unwrap()
}

/// Knots of a clamped cubic of even spans.
fn knots(count: usize) -> Vec<f64> {
    let spans = count - 3;
    let mut knots = vec![0.0; 3];
    knots.extend((0..=spans).map(|k| k as f64 / spans as f64));
    knots.extend([1.0; 3]);
    knots
}

fn greville(knots: &[f64]) -> Vec<f64> {
    (1..knots.len() - 3)
        .map(|i| (knots[i] + knots[i + 1] + knots[i + 2]) / 3.0)
        .collect()
}

/// A flat strip along x in z = 0, its control points at the Greville abscissae: text of a surface.
fn strip(counts: [usize; 2], length_m: f64, width_m: f64) -> String {
    let [u, v] = counts.map(knots);
    let (x, y) = (greville(&u), greville(&v));
    let points: Vec<String> = x
        .iter()
        .map(|x| {
            let row: Vec<String> = y
                .iter()
                .map(|y| format!("[{:?}, {:?}, 0.0]", x * length_m, (y - 0.5) * width_m))
                .collect();
            format!("[{}]", row.join(", "))
        })
        .collect();
    format!(
        "{{ inline = {{ format = \"palpate.surface.v1\", degree = [3, 3], periodic = [false, false], \
         knots = [{u:?}, {v:?}], points = [{}] }} }}",
        points.join(", ")
    )
}

/// Sag of the tip under its own weight over Timoshenko's, at small angles.
fn sag_over_timoshenko(model: &str, layers: usize, along: usize, lattice: &str) -> f64 {
    let (young, density, gravity) = (50e3, 1_000.0, 0.01);
    let (length, width, thickness) = (0.1, 0.02, 0.02_f64);
    let surface = strip([along, 5], length, width);
    let text = format!(
        r#"
[loop]
rate_hz = 250
[gravity]
acceleration = [0.0, 0.0, -{gravity:?}]
[[body]]
id = "beam"
surface = {surface}
model = "{model}"
material = {{ young_pa = {young:?}, poisson = 0.0, density_kg_m3 = {density:?}, damping_s = 0.0 }}
lattice = {{ refine = "none", thickness_m = {thickness:?}, layers = {layers} {lattice} }}
integrator = {{ sleep_m_s = 0.0, iterations = 10 }}
fixed = [{{ u = [0.0, 0.1], v = [0.0, 1.0] }}]
[[tool]]
id = "pen"
shape = {{ point = {{}} }}
pose = {{ position = [0.0, 0.0, 1.0] }}
"#
    );
    let mut world = World::new(&text);
    let beam = world.scene.deformable(0).unwrap();
    let rest = beam.rest_state().positions;
    let held = (0..beam.coordinate_count())
        .filter(|&k| beam.unknown(k).is_none())
        .map(|k| rest[k].x)
        .fold(0.0, f64::max);
    let tip = |world: &World| -> f64 {
        let ends = rest.iter().zip(&body(world).positions);
        let sags: Vec<f64> = ends
            .filter(|(rest, _)| rest.x > length - 1e-9)
            .map(|(rest, now)| rest.z - now.z)
            .collect();
        sags.iter().sum::<f64>() / sags.len() as f64
    };
    let mut before = 0.0;
    for _ in 0..40 {
        for _ in 0..50 {
            world.at([0.0, 0.0, 1.0]);
        }
        let now = tip(&world);
        if (now - before).abs() < 1e-4 * now.abs() {
            break;
        }
        before = now;
    }
    let sag = tip(&world);
    let free = length - held;
    let load = density * gravity * width * thickness;
    let nu: f64 = if model == "lattice" { 0.25 } else { 0.0 };
    let inertia = width * thickness.powi(3) / 12.0;
    let shear = young / (2.0 * (1.0 + nu));
    let exact = load * free.powi(4) / (8.0 * young * inertia)
        + load * free * free / (2.0 * 5.0 / 6.0 * shear * width * thickness);
    println!(
        "{model} {layers} layers {along} along {lattice}: held to {held:.4} m, sags by {sag:.4e} m, \
         {:.3} of Timoshenko's, {} ticks",
        sag / exact,
        world.seq
    );
    sag / exact
}

#[test]
fn probe_beam() {
    for model in ["continuum", "lattice"] {
        for layers in [2, 3, 5, 8] {
            for along in [13, 23] {
                sag_over_timoshenko(model, layers, along, "");
            }
        }
    }
    sag_over_timoshenko("net", 3, 13, "");
    sag_over_timoshenko(
        "lattice",
        3,
        13,
        ", builder = \"transfinite\", nodes = [24, 8, 5]",
    );
}

/// A flat disc in z = 0 with a pole in its middle, periodic around: text of a surface.
fn disc(around: usize, out: usize, radius_m: f64) -> String {
    let u: Vec<f64> = (0..=around).map(|k| k as f64 / around as f64).collect();
    let v = knots(out);
    // A uniform cubic shrinks a circle of control points by (2 + cos h) / 3.
    let step = std::f64::consts::TAU / around as f64;
    let grow = 3.0 / (2.0 + step.cos());
    let points: Vec<String> = (0..around)
        .map(|i| {
            let (s, c) = (step * i as f64).sin_cos();
            let row: Vec<String> = greville(&v)
                .iter()
                .map(|r| r * radius_m * grow)
                .map(|r| format!("[{:?}, {:?}, 0.0]", r * c, r * s))
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

#[test]
fn probe_disc() {
    for (around, out, held) in [
        (12, 13, 0.9),
        (16, 17, 0.9),
        (17, 17, 0.9),
        (16, 30, 0.9),
        (16, 17, 0.97),
    ] {
        let (young, thickness, density, gravity, radius) = (1e6, 6e-3_f64, 1e3, 1e-3, 0.1);
        let text = format!(
            r#"
[loop]
rate_hz = 250
[gravity]
acceleration = [0.0, 0.0, -{gravity:?}]
[[body]]
id = "disc"
surface = {}
model = "membrane"
material = {{ young_pa = {young:?}, density_kg_m3 = {density:?}, damping_s = 0.0 }}
lattice = {{ refine = "none", thickness_m = {thickness:?} }}
integrator = {{ sleep_m_s = 0.0, iterations = 10 }}
fixed = [{{ u = [0.0, 1.0], v = [{held:?}, 1.0] }}]
[[tool]]
id = "pen"
shape = {{ point = {{}} }}
pose = {{ position = [0.0, 0.0, 1.0] }}
"#,
            disc(around, out, radius)
        );
        let mut world = World::new(&text);
        let plate = world.scene.deformable(0).unwrap();
        let rest = plate.rest_state().positions;
        let free = (0..plate.coordinate_count())
            .filter(|&k| plate.unknown(k).is_none())
            .map(|k| rest[k].coords.norm())
            .fold(f64::INFINITY, f64::min);
        let mut before = 0.0;
        let mut sag = 0.0;
        for _ in 0..60 {
            for _ in 0..100 {
                world.at([0.0, 0.0, 1.0]);
            }
            sag = body(&world)
                .positions
                .iter()
                .map(|p| -p.z)
                .fold(0.0, f64::max);
            if (sag - before).abs() < 1e-4 * sag {
                break;
            }
            before = sag;
        }
        let d = young * thickness.powi(3) / (12.0 * (1.0 - 1.0 / 9.0));
        let exact = density * gravity * thickness * free.powi(4) / (64.0 * d);
        println!(
            "{around} x {out}: held from {free:.4}, sags {sag:.3e}, {:.3} of a plate, {} ticks",
            sag / exact,
            world.seq
        );
    }
}
