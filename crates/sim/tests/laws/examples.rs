//! The examples run and hold what they assert.

#[path = "../../examples/custom_shape.rs"]
mod custom_shape;
#[path = "../../examples/step_scene.rs"]
mod step_scene;

#[test]
fn step_scene_runs() {
    step_scene::main().unwrap();
}

#[test]
fn custom_shape_runs() {
    custom_shape::main().unwrap();
}
