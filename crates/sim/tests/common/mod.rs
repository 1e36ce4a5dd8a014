//! What integration tests share.
#![allow(dead_code)]

use palpate_geometry::math::{Point3, Vector3};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::file;
use std::path::Path;

pub use palpate_sim::World;

/// What laws ask of a scene beside its ticks.
pub trait Laws: Sized {
    /// The scene of a text.
    fn new(text: &str) -> Self;
    fn centre(&self, body: usize, net: &mut [Point3]) -> Point3;
    fn rest(&mut self, tick: impl FnMut(&mut Self), ticks: usize) -> usize;
}

impl Laws for World {
    fn new(text: &str) -> Self {
        let loaded = file::parse(text, "test.toml", Path::new("."));
        let world = loaded.and_then(|loaded| Self::of(&loaded.with(palpate_thesis::METHODS)));
        world.unwrap_or_else(|e| panic!("{e}"))
    }

    /// Mean of a body's control points, m; `net` has room for them.
    fn centre(&self, body: usize, net: &mut [Point3]) -> Point3 {
        self.state.copy_net(&self.scene, body, net);
        Point3::from(net.iter().map(|p| p.coords).sum::<Vector3>() / net.len() as f64)
    }

    /// Brings what deforms to rest: dynamic relaxation with kinetic damping (Cundall 1976, Barnes
    /// 1999). Ticks go on as `tick` says, and whenever the kinetic energy of a body falls from one to
    /// the next, its velocities are taken away; equilibria are those of the ticks themselves. Ends
    /// when nothing has been faster than 1e-9 m/s for fifty ticks, or after so many ticks; returns how
    /// many it took.
    fn rest(&mut self, mut tick: impl FnMut(&mut Self), ticks: usize) -> usize {
        let mut before = vec![0.0; self.state.bodies.len()];
        let mut still = 0;
        for k in 0..ticks {
            tick(self);
            let mut fastest = 0.0_f64;
            for (b, last) in before.iter_mut().enumerate() {
                let (Some(body), Some(state)) = (
                    self.scene.deformable(b),
                    &mut self.state.bodies[b].deformable,
                ) else {
                    continue;
                };
                let speeds = state.velocities.iter().map(|v| v.norm_squared());
                let (mut energy, mut most) = (0.0, 0.0_f64);
                for (squared, mass) in speeds.zip(body.masses()) {
                    energy += 0.5 * mass * squared;
                    most = most.max(squared);
                }
                fastest = fastest.max(most.sqrt());
                if energy < *last {
                    state.velocities.fill(Vector3::zeros());
                    self.scene.prepare(&self.state, &mut self.scratch);
                    energy = 0.0;
                }
                *last = energy;
            }
            still = if fastest < 1e-9 { still + 1 } else { 0 };
            if still == 50 {
                return k + 1;
            }
        }
        ticks
    }
}

pub fn pose(seq: u64, position: [f64; 3]) -> DevicePose {
    DevicePose {
        seq,
        ..DevicePose::at_rest(position)
    }
}

/// The teardrop of the specification's table, pressed by a rigidly held ball of 10 mm: text of the
/// scene.
pub fn teardrop(young_pa: f64, refine: &str) -> String {
    format!(
        r#"
[[body]]
id = "drop"
surface = {{ builtin = "teardrop" }}
model = "lattice"
material = {{ young_pa = {young_pa:?} }}
lattice = {{ layers = 4, refine = {refine} }}
fixed = [{{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }}]
[[tool]]
id = "ball"
shape = {{ sphere = {{ radius_m = 0.01 }} }}
pose = {{ position = [0.06, 0.003, 0.045] }}
coupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0, speed_max_m_s = 1e6 }}
"#
    )
}

/// Force after a ball of 20 mm was lowered onto z = 0 by a depth within so many ticks, and held for
/// as many.
pub fn press(world: &mut World, depth_m: f64, ticks: usize) -> f64 {
    let mut force = 0.0;
    for k in 0..2 * ticks {
        let share = (k as f64 / ticks as f64).min(1.0);
        force = world.at([0.0, 0.0, 0.02 - depth_m * share]).tools[0]
            .force_n
            .z;
    }
    force
}

/// Place of a tool of [`many_tools`] at the start, m: an 8 × 8 grid 30 mm above the slab.
pub fn place_of_many(tool: usize) -> [f64; 3] {
    let along = |k: usize| 0.1 * k as f64 - 0.35;
    [along(tool / 8), along(tool % 8), 0.03]
}

/// A soft slab of 0.8 m × 0.8 m × 20 mm on its underside, and balls of 20 mm above it, 0.1 m apart:
/// those with these numbers. `more` is said of each.
pub fn many_tools(tools: impl IntoIterator<Item = usize>, more: &str) -> String {
    let mut text = "[record]\nkeyframe_s = 0.05\n[[body]]\nid = \"slab\"\n\
                    surface = { builtin = \"sheet\", net = [19, 19], size = 0.8 }\nmodel = \"lattice\"\n\
                    lattice = { layers = 2, refine = \"none\", thickness_m = 0.02 }\n\
                    fixed = [{ point = [0.0, 0.0, -0.0199], normal = [0.0, 0.0, 1.0] }]\n"
        .to_owned();
    for tool in tools {
        text += &format!(
            "[[tool]]\nid = \"ball{tool}\"\nshape = {{ sphere = {{ radius_m = 0.02 }} }}\n\
             pose = {{ position = {:?} }}\ncoupling = {{ stiffness_n_m = 800.0, damping_n_s_m = 0.0 }}\n\
             device = {{ force_max_n = 1e9, ramp_s = 0.0 }}\n{more}\n",
            place_of_many(tool)
        );
    }
    text
}

/// The text of a STEP file of parts, by name.
pub fn step_file(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../geometry/tests/data/parts");
    let path = format!("{folder}/{name}.step");
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"))
}
