//! When a body falls asleep.

use super::Deformable;
use crate::body::matter::Matter;
use crate::body::scratch::DeformableScratch;
use crate::body::state::DeformableState;
use crate::body::stepper::Stepper;
use crate::body::stillness::{BORNE, STILL_STEPS};
use palpate_geometry::math::Vector3;

impl Deformable {
    /// What moves no more for a while falls asleep; it wakes by a touch.
    /// `busy`: it flowed, or a tool touched it; `balanced`: as [`Deformable::is_borne`].
    pub(super) fn count_still(
        &self,
        state: &mut DeformableState,
        touched: bool,
        busy: bool,
        balanced: bool,
    ) {
        let limit = self.matter.settings.sleep_m_s * self.matter.settings.sleep_m_s;
        let squares = state.velocities.iter().map(|v| v.norm_squared());
        // What is not a number is not slow.
        let fastest = squares.fold(0.0, |most, v| if v > most || v.is_nan() { v } else { most });
        let still = !(touched || busy) && fastest <= limit && limit > 0.0;
        state.still = match still {
            true => (state.still + 1).min(STILL_STEPS),
            false => 0,
        };
        if busy || !touched {
            state.stillness.steps = 0;
        } else {
            let Matter { rest, settings, .. } = &self.matter;
            let (sleep_m_s, dt_s) = (settings.sleep_m_s, settings.dt_s);
            let here = || self.outline.moments(rest, &state.positions);
            (state.stillness).count(here, fastest.sqrt(), balanced, sleep_m_s, dt_s);
        }
        if state.still == STILL_STEPS {
            state.velocities.fill(Vector3::zeros());
        }
    }

    /// False where the contact forces of the step are known and are not, within [`BORNE`], those that
    /// hold the body up: contacts tremble, and their forces with them.
    pub(super) fn is_borne(&self, state: &DeformableState, scratch: &DeformableScratch) -> bool {
        if !(self.matter.is_free() && matches!(self.stepper, Stepper::Implicit(_))) {
            return true;
        }
        let (mut weight, mut weight_n) = (Vector3::zeros(), 0.0);
        let places = state.positions.iter().zip(&state.velocities);
        for ((place, velocity), mass) in places.zip(&self.matter.masses) {
            let part = scratch.field.at(place, velocity) * *mass;
            weight += part;
            weight_n += part.norm();
        }
        let borne: Vector3 = state.contact_n.iter().sum();
        (weight + borne).norm() <= BORNE * weight_n
    }

    /// True when steps are skipped until something touches the body.
    pub fn asleep(&self, state: &DeformableState) -> bool {
        state.still >= STILL_STEPS || state.left_alone
    }
}
