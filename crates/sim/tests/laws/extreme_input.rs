//! Scenes whose numbers are replaced by the extremes: refused with a place, or all that comes out is finite.

use crate::common::pose;
use palpate_geometry::math::Random;
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::TickInput;
use palpate_sim::tick::step;
use std::path::Path;

const EXTREMES: [&str; 15] = [
    "1e308", "-1e308", "1e400", "5e-324", "1e155", "-1e155", "1e-200", "1e20", "nan", "inf",
    "-inf", "1e14", "1e-14", "0.0", "-1.0",
];

/// Small, and between them of every kind.
const SCENES: [&str; 3] = [
    r#"
[gravity]
acceleration = [0.5, 0.0, -9.81]
smoothing_s = 0.005
[[body]]
id = "slab"
surface = { builtin = "sheet", net = [5, 5], size = 0.1 }
pose = { position = [0.01, 0.02, 0.03], orientation = [0.0, 0.0, 0.0, 1.0] }
model = "continuum"
material = { young_pa = 20000.0, poisson = 0.3, density_kg_m3 = 1000.0, damping_s = 0.002, plastic = { yield_strain = 0.02, rate_per_s = 20.0, hardening = 0.1, limit = 0.6, spread_m = 0.005 } }
lattice = { layers = 2, refine = "none", thickness_m = 0.02 }
integrator = { sleep_m_s = 1.5e-7 }
fixed = [{ point = [0.0, 0.0, -0.015], normal = [0.0, 0.0, 1.0] }]
[[body.region]]
ball = { centre = [0.01, 0.01, 0.01], radius_m = 0.02 }
young_pa = 60000.0
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.01, 0.02, 0.045] }
coupling = { stiffness_n_m = 1000.0, damping_n_s_m = 1.5, turning_stiffness_nm_rad = 2.5, turning_damping_nm_s_rad = 0.5 }
device = { force_max_n = 10.0, ramp_s = 0.02, stale_s = 0.05, speed_max_m_s = 10.0, torque_max_nm = 1.5, passivity = true, passivity_damping_n_s_m = 30.0, damping_n_s_m = 2.0, coulomb_n = 0.1, encoder_m = 2e-5, rate_hz = 1000.0, delay_s = 0.001 }
friction = { mu = 0.3, mu_kinetic = 0.2, viscous_n_s_m = 0.1 }
grip = { force_max_n = 5.0 }
"#,
    r#"
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[body]]
id = "tray"
surface = { builtin = "sheet", size = 0.4 }
motion = { waypoint = [ { time_s = 0.01, position = [0.0, 0.0, 0.01], hold_s = 0.5 }, { time_s = 2.5, position = [0.0, 0.0, 0.2] } ], shake = [ { direction = [0.0, 2.0, 0.0], amplitude_m = 0.01, frequency_hz = 2.0, from_s = 0.5, to_s = 6.0 } ] }
[[body]]
id = "ring"
surface = { builtin = "torus", size = 0.03 }
pose = { position = [0.0, 0.0, 0.05] }
free = true
material = { density_kg_m3 = 1200.0 }
velocity_m_s = [0.1, 0.0, 0.0]
spin_rad_s = [3.0, 0.0, 10.0]
[[contact]]
pair = ["ring", "tray"]
friction = { mu = 0.4 }
restitution = 0.5
[[tool]]
id = "pen"
shape = { capsule = { radius_m = 0.004, half_length_m = 0.02 } }
pose = { position = [0.0, 0.0, 0.1] }
[[tool]]
id = "egg"
shape = { ellipsoid = { semi_axes_m = [0.01, 0.02, 0.01] } }
pose = { position = [0.3, 0.0, 0.1] }
[[tool]]
id = "blob"
shape = { implicit = { f = "x^2 + y^2 + 4*z^2 - 1e-4", reach_m = 0.02 } }
pose = { position = [0.0, 0.3, 0.1] }
"#,
    r#"
[[body]]
id = "skin"
surface = { builtin = "sheet", net = [6, 6], size = 0.1 }
model = "membrane"
material = { young_pa = 20000.0, density_kg_m3 = 1000.0, stiffening = { strain = 0.3, ratio = 5.0, least_length = 0.2, least_length_ratio = 10.0 } }
lattice = { refine = "none", thickness_m = 0.002 }
fixed = [{ u = [0.0, 0.1], v = [0.0, 1.0] }]
[[tool]]
id = "cone"
shape = { cone = { half_angle_deg = 20.0, height_m = 0.03, tip_radius_m = 0.001 } }
pose = { position = [0.0, 0.0, 0.02] }
[[tool]]
id = "floor"
shape = { plane = { normal = [0.0, 0.1, 1.0] } }
pose = { position = [0.0, 0.0, -0.05] }
"#,
];

/// Where a text has numbers: (start, end).
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let bytes = text.as_bytes();
    let is_part = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'e');
    let mut found = Vec::new();
    let mut at = 1;
    while at < bytes.len() {
        let begins = bytes[at].is_ascii_digit() || bytes[at] == b'-';
        if begins && matches!(bytes[at - 1], b' ' | b'[') {
            let length = bytes[at..].iter().take_while(|b| is_part(b)).count();
            found.push((at, at + length));
            at += length;
        }
        at += 1;
    }
    found
}

/// Steps a scene with its first tool on its way down; what is not finite, if anything.
fn not_finite(scene: &Scene) -> Option<String> {
    let plan = serde_json::to_string(&scene.plan()).unwrap();
    // JSON writes null for what is not finite.
    if plan.contains("_kg\":null") || plan.contains("_m\":[null") || plan.contains("_us\":null") {
        return Some(plan);
    }
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    let start = scene.spec.tools[0].pose.position;
    for tick in 0..25_u32 {
        let mut input = TickInput::default();
        let mut at = start;
        at[2] -= 8e-4 * f64::from(tick);
        input.poses[0] = Some(DevicePose {
            seq: u64::from(tick) + 1,
            ..pose(u64::from(tick) + 1, at)
        });
        let output = step(scene, &mut state, &mut scratch, &input);
        for (t, tool) in output.tools.as_slice().iter().enumerate() {
            let numbers = (tool.force_n.iter())
                .chain(&tool.torque_nm)
                .chain(tool.proxy_position.iter())
                .chain([&tool.energy_j, &tool.dissipated_j]);
            if numbers.into_iter().any(|x| !x.is_finite()) {
                return Some(format!("tick {tick}, tool {t}: {tool:?}"));
            }
        }
        for body in 0..scene.body_count() {
            let mut net = scene.rest_surface(body).unwrap().net().points().to_vec();
            state.copy_net(scene, body, &mut net);
            if net.iter().flat_map(|p| p.iter()).any(|x| !x.is_finite()) {
                return Some(format!("tick {tick}, net of body {body}"));
            }
        }
    }
    None
}

#[test]
fn scenes_with_extreme_numbers_are_refused_with_their_line_or_run_with_finite_results() {
    let (mut built, mut refused) = (0, 0);
    for (k, text) in SCENES.iter().enumerate() {
        let places = numbers(text);
        let mut random = Random(k as u64 + 5);
        for n in 0..2 * places.len() {
            let (start, end) = places[n % places.len()];
            let extreme = EXTREMES[random.below(EXTREMES.len())];
            let changed = format!("{}{extreme}{}", &text[..start], &text[end..]);
            let line = 1 + text[..start].matches('\n').count();
            let said = format!("scene {k}, line {line}: {} is {extreme}", &text[start..end]);
            let scene = file::parse(&changed, "s.toml", Path::new(".")).and_then(|s| s.build());
            match scene {
                Ok(scene) => {
                    built += 1;
                    assert_eq!(not_finite(&scene), None, "{said}");
                }
                Err(error) => {
                    refused += 1;
                    let words = error.to_string();
                    assert!(words.starts_with("s.toml:"), "{said}: {words}");
                }
            }
        }
    }
    println!("{built} built, {refused} refused");
    assert!(
        built > 30 && refused > 100,
        "{built} built, {refused} refused"
    );
}
