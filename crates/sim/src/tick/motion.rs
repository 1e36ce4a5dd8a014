//! Second half of a tick: bodies take the contact forces, and their next free motion is predicted.
//!
//! A body that steps once in k ticks begins a step with the forces of one tick and takes it over k
//! ticks later, on whatever thread it was done. In between its surface stands still and answers
//! with its compliance. A step that is [late](super::late) may be put off, by a tick each time.

use super::load::load_on;
use super::record::TickFault;
use super::scratch::Scratch;
use super::state::{Pipeline, SceneState};
use crate::body::{DeformableState, Field};
use crate::party::{BodyState, DeformingScratch};
use crate::scene::{BodyModel, DeformingBody, Scene};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::Surface;

/// What a tick did to a body.
enum Stepped {
    /// Its step goes on.
    Not,
    /// It moved; its next free motion is known or not.
    Done { predicted: bool },
}

/// Moves every body, and gives the last fault for which one had to be set back to rest.
pub(super) fn advance(
    scene: &Scene,
    state: &mut SceneState,
    scratch: &mut Scratch,
) -> Option<TickFault> {
    let mut fault =
        crate::party::rigid::advance(scene, &mut state.bodies, &mut scratch.bodies, |b, gives| {
            load_on(
                &scratch.rows.rows,
                &scratch.solver,
                &scratch.tools,
                b,
                gives,
            )
        });
    scene.follow_frame(&mut state.frame, &state.tools);
    let field = scene.field(&state.frame);
    for (b, body) in scene.bodies.iter().enumerate() {
        let BodyModel::Deforming(model) = &body.model else {
            continue;
        };
        let body_state = &mut state.bodies[b];
        let Some(deforming) = &mut scratch.bodies[b].deforming else {
            continue;
        };
        let Stepped::Done { predicted } = step(
            b,
            model,
            field,
            body_state,
            deforming,
            &mut scratch.pipeline,
        ) else {
            body_state.moved_m = 0.0;
            continue;
        };
        let Some(deformable) = &mut body_state.deformable else {
            continue;
        };
        // A sum is finite only if every part is.
        let sum: f64 = deformable.positions.iter().map(|p| p.x + p.y + p.z).sum();
        let mut unsound = (!sum.is_finite()).then_some(TickFault::NotFinite);
        if unsound.is_some() {
            model.deformable.set_to_rest(deformable);
        }
        let surface = &scratch.bodies[b].surface;
        let (mut moved_squared, reach) = moved(model, deformable, surface);
        let most_m = TickFault::MOST_SPEED_M_S * model.deformable.dt_s();
        if unsound.is_none()
            && (moved_squared > most_m * most_m || reach > TickFault::MOST_STRETCHED * body.size_m)
        {
            unsound = Some(TickFault::CameApart { body: b as u32 });
            model.deformable.set_to_rest(deformable);
            moved_squared = moved(model, deformable, surface).0;
        }
        body_state.moved_m = moved_squared.sqrt();
        if moved_squared > 0.0 {
            body_state.revision += 1;
        }
        scene.prepare_body(b, state, scratch, predicted && unsound.is_none());
        fault = unsound.or(fault);
    }
    fault
}

/// Of a body's control points: the square of how far the farthest has moved, m², and the diagonal of their box, m.
fn moved(model: &DeformingBody, state: &DeformableState, surface: &Surface) -> (f64, f64) {
    let mut most: f64 = 0.0;
    let (mut low, mut high) = (Point3::from([f64::MAX; 3]), Point3::from([f64::MIN; 3]));
    for (control, old) in surface.net().points().iter().enumerate() {
        let now = &state.positions[model.deformable.coordinate_of_control(control)];
        let step = (now - old).norm_squared();
        most = if step > most { step } else { most };
        (low, high) = (low.inf(now), high.sup(now));
    }
    (most, (high - low).norm())
}

/// A tick in which bodies do not move: what pressed them is forgotten.
pub(super) fn stand_still(scene: &Scene, state: &SceneState, scratch: &mut Scratch) {
    for (body, parts) in scene.bodies.iter().zip(&mut scratch.bodies) {
        if let (BodyModel::Deforming(model), Some(deforming)) = (&body.model, &mut parts.deforming)
        {
            model.deformable.drop_loads(&mut deforming.deformable);
        }
    }
    super::iterate::forget(scene, state, scratch);
}

fn step(
    b: usize,
    model: &DeformingBody,
    field: Field,
    body: &mut BodyState,
    deforming: &mut DeformingScratch,
    pipeline: &mut Option<Box<dyn Pipeline>>,
) -> Stepped {
    let Some(deformable) = &mut body.deformable else {
        return Stepped::Not;
    };
    let scratch = &mut deforming.deformable;
    if model.every > 1 {
        if std::mem::take(&mut body.put_off) {
            model.deformable.drop_loads(scratch);
            return Stepped::Not;
        }
        if body.phase == 0 {
            model.deformable.take_loads(scratch, &mut body.loads);
            if let Some(pipeline) = pipeline {
                pipeline.start(b, field, deformable, &scratch.predicted, &body.loads);
            }
        } else {
            model.deformable.drop_loads(scratch);
        }
        body.phase += 1;
        if body.phase < model.every {
            return Stepped::Not;
        }
        body.phase = 0;
        if pipeline
            .as_mut()
            .is_some_and(|pipeline| pipeline.finish(b, deformable, &mut scratch.predicted))
        {
            return Stepped::Done { predicted: true };
        }
        model.deformable.give_loads(scratch, &body.loads);
    }
    model.deformable.advance(deformable, scratch);
    Stepped::Done { predicted: false }
}
