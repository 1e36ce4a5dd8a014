//! Second half of a tick: bodies take the contact forces, and their next free motion is predicted.

use crate::scene::{BodyModel, Scene, SceneState, Scratch};

/// Moves every deforming body; false if one had to be set back to rest because its state was not finite.
pub(super) fn advance(scene: &Scene, state: &mut SceneState, scratch: &mut Scratch) -> bool {
    let mut sound = true;
    for (b, body) in scene.bodies.iter().enumerate() {
        let BodyModel::Lattice(model) = &body.model else { continue };
        let body_state = &mut state.bodies[b];
        let (Some(lattice), Some(deforming)) = (&mut body_state.lattice, &mut scratch.bodies[b].deforming) else {
            continue;
        };
        model.lattice.advance(lattice, &mut deforming.lattice);
        // A sum is finite only if every part is.
        let sum: f64 = lattice.positions.iter().map(|p| p.x + p.y + p.z).sum();
        if !sum.is_finite() {
            *lattice = model.lattice.rest_state();
            sound = false;
        }
        let surface = &scratch.bodies[b].surface;
        let mut moved_squared: f64 = 0.0;
        for (control, old) in surface.net().points().iter().enumerate() {
            let step = (lattice.positions[model.lattice.coordinate_of_control(control)] - old).norm_squared();
            moved_squared = if step > moved_squared { step } else { moved_squared };
        }
        body_state.moved_m = moved_squared.sqrt();
        if moved_squared > 0.0 {
            body_state.revision += 1;
        }
        scene.prepare_body(b, state, scratch);
    }
    sound
}
