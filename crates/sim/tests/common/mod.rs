//! What integration tests share.
#![allow(dead_code)]

use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::{Scene, SceneState, Scratch, file};
use palpate_sim::tick::record::{TickInput, TickOutput};
use palpate_sim::tick::step;
use std::path::Path;

/// A scene with its state.
pub struct World {
    pub scene: Scene,
    pub state: SceneState,
    pub scratch: Scratch,
    pub seq: u64,
}

impl World {
    pub fn new(text: &str) -> Self {
        let loaded =
            file::parse(text, "test.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
        let scene = Scene::build(&loaded.spec, Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
        let state = scene.initial_state();
        let scratch = scene.scratch(&state);
        Self {
            scene,
            state,
            scratch,
            seq: 0,
        }
    }

    /// One tick with the first tool at a place.
    pub fn at(&mut self, position: [f64; 3]) -> TickOutput {
        self.seq += 1;
        let mut input = TickInput::default();
        input.poses[0] = Some(pose(self.seq, position));
        step(&self.scene, &mut self.state, &mut self.scratch, &input)
    }

    /// One tick with the first tool in a pose.
    pub fn posed(&mut self, pose: DevicePose) -> TickOutput {
        self.seq += 1;
        let mut input = TickInput::default();
        input.poses[0] = Some(DevicePose {
            seq: self.seq,
            ..pose
        });
        step(&self.scene, &mut self.state, &mut self.scratch, &input)
    }

    /// One tick with every tool at a place, and its buttons.
    pub fn all(&mut self, tools: &[([f64; 3], u32)]) -> TickOutput {
        self.seq += 1;
        let mut input = TickInput::default();
        for (slot, &(position, buttons)) in input.poses.iter_mut().zip(tools) {
            *slot = Some(DevicePose {
                buttons,
                ..pose(self.seq, position)
            });
        }
        step(&self.scene, &mut self.state, &mut self.scratch, &input)
    }

    /// One tick without news.
    pub fn silent(&mut self) -> TickOutput {
        step(
            &self.scene,
            &mut self.state,
            &mut self.scratch,
            &TickInput::default(),
        )
    }
}

pub fn pose(seq: u64, position: [f64; 3]) -> DevicePose {
    DevicePose {
        seq,
        t_client_ns: 0,
        position: Point3::from(position),
        orientation: Rotation::identity(),
        linear_velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
        buttons: 0,
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
device = {{ force_max_n = 1e9, ramp_s = 0.0 }}
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
