//! What goes on when one scene becomes another between two ticks.

use super::state::SceneState;
use crate::contact::PairState;
use crate::scene::{Origin, Scene};
use palpate_geometry::math::Vector3;

impl Scene {
    /// Fills the state of this scene with what the old one goes on with: time, tools, and the
    /// bodies it shares with it. Contacts begin anew. `state` is an initial state of this scene;
    /// nothing is allocated.
    pub fn carry_over(&self, from: &SceneState, origins: &[Origin], state: &mut SceneState) {
        debug_assert_eq!(origins.len(), self.bodies.len(), "an origin a body");
        (state.tick, state.run, state.quality) = (from.tick, from.run, from.quality);
        state.faulted = from.faulted;
        (state.frame, state.carried) = (from.frame, from.carried);
        // Whoever keeps a net of the old scene must see that this is another.
        let revision = from
            .bodies
            .iter()
            .map(|body| body.revision)
            .max()
            .unwrap_or(0)
            + 1;
        for (body, origin) in origins.iter().enumerate() {
            let new = &mut state.bodies[body];
            if let Origin::Kept { from: old, moved } = *origin {
                let old = &from.bodies[old];
                if let (Some(new), Some(old)) = (&mut new.deformable, &old.deformable) {
                    new.clone_from(old);
                    if new.is_left_alone() {
                        new.leave_alone(false);
                    }
                    if moved != Vector3::zeros() {
                        new.positions.iter_mut().for_each(|p| *p += moved);
                    }
                }
                new.loads.clone_from(&old.loads);
                (new.moved_m, new.phase, new.put_off) = (old.moved_m, old.phase, old.put_off);
                if let (Some(new), Some(old)) = (&mut new.rigid, &old.rigid) {
                    *new = old.moved(&moved);
                    if let Some(flight) = new.flight_mut().filter(|flight| flight.is_left_alone()) {
                        flight.leave_alone(false);
                    }
                }
            }
            new.revision = revision;
        }
        for (new, old) in state.tools.iter_mut().zip(&from.tools) {
            *new = *old;
            // It held on to places of a body that may be no more.
            new.grip = Default::default();
        }
        state.pairs.fill(PairState::default());
        state.warm.forget();
    }
}
