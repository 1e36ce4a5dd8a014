//! Membranes that move: clamped sheets, pressed and let go.

use super::common::World;

fn sheet(young_pa: f64, damping_s: f64, iterations: &str, stiffness: &str, friction: f64) -> World {
    World::new(&format!(
        r#"
[[body]]
id = "sheet"
surface = {{ builtin = "sheet", net = [8, 8], size = 0.1 }}
model = "membrane"
material = {{ young_pa = {young_pa:?}, density_kg_m3 = 1050.0, damping_s = {damping_s:?} }}
lattice = {{ thickness_m = 0.002, refine = [14, 14] }}
integrator = {{ iterations = {iterations} }}
fixed = [
  {{ point = [-0.045, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }},
  {{ point = [0.045, 0.0, 0.0], normal = [-1.0, 0.0, 0.0] }},
]
[[tool]]
id = "ball"
shape = {{ sphere = {{ radius_m = 0.008 }} }}
pose = {{ position = [0.0, 0.0, 0.02] }}
friction = {{ mu = {friction:?} }}
coupling = {{ stiffness_n_m = {stiffness}, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0 }}
"#
    ))
}

#[test]
fn probe() {
    for (young, damping) in [(1e6, 5e-3), (2e4, 0.0), (2e4, 2e-3), (1e6, 0.0)] {
        for speed in [0.01, 0.05, 0.2, 1.0] {
            let mut paths = Vec::new();
            for iterations in ["1", "2", "3", "20"] {
                let mut world = sheet(young, damping, iterations, "inf", 0.0);
                let mut path = Vec::new();
                let mut z: f64 = 0.0085;
                let mut hold = 0;
                let mut cautious = 0;
                let mut jitter: f64 = 0.0;
                while hold < 400 {
                    z = (z - speed * 1e-3).max(-0.003);
                    if z == -0.003 {
                        hold += 1
                    }
                    let out = world.at([0.003, 0.004, z]);
                    let f = out.tools[0].force_n.z;
                    cautious += u32::from(
                        world.state.bodies[0]
                            .deformable
                            .as_ref()
                            .unwrap()
                            .caution
                            .level
                            > 0,
                    );
                    if hold > 300 {
                        jitter = jitter.max((f - path.last().copied().unwrap_or(0.0_f64)).abs());
                    }
                    path.push(f);
                }
                let peak = path.iter().copied().fold(0.0, f64::max);
                paths.push(path.clone());
                println!(
                    "E {young:.0e} d {damping} v {speed} it {iterations}: peak {peak:.4} end {:.4} jitter {jitter:.2e} cautious {cautious}",
                    path.last().unwrap()
                );
            }
            let exact = paths.pop().unwrap();
            let peak = exact.iter().copied().fold(0.0, f64::max);
            let ramp = exact.len() - 300;
            for path in &paths {
                let rms = (path
                    .iter()
                    .zip(&exact)
                    .take(ramp)
                    .map(|(a, b)| (a - b).powi(2))
                    .sum::<f64>()
                    / ramp as f64)
                    .sqrt()
                    / peak;
                print!("   rms {:.3}", rms);
            }
            println!();
        }
    }
}
