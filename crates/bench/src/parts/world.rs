//! A scene of a part and a ball at work, without a device.

use palpate_proto::messages::ToolPose;
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::{TickInput, ToolOutput};
use palpate_sim::tick::{SceneState, Scratch, step};
use palpate_wire as wire;
use std::path::Path;

pub(super) struct World {
    pub scene: Scene,
    state: SceneState,
    scratch: Scratch,
    seq: u64,
}

impl World {
    /// The text is one of ours.
    pub fn new(text: &str) -> Self {
        let loaded = file::parse(text, "parts.toml", Path::new("."));
        let built = loaded
            .map_err(|error| error.to_string())
            .and_then(|loaded| {
                Scene::build(&loaded.spec, Path::new(".")).map_err(|error| error.to_string())
            });
        let scene = built.unwrap_or_else(|error| panic!("{error}"));
        let state = scene.initial_state();
        let scratch = scene.scratch(&state);
        Self {
            scene,
            state,
            scratch,
            seq: 0,
        }
    }

    /// One tick with the ball at a place.
    pub fn at(&mut self, position: [f64; 3]) -> ToolOutput {
        self.seq += 1;
        let mut input = TickInput::default();
        input.poses[0] = Some(wire::device_pose(&ToolPose {
            seq: self.seq,
            ..palpate_client::pose_at(position)
        }));
        step(&self.scene, &mut self.state, &mut self.scratch, &input).tools[0]
    }
}
