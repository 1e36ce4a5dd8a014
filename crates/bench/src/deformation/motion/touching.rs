//! Paths of the exact step with contact, whose obstacle is analytic.

use super::World;
use crate::exact_step::ExactStep;
use crate::exact_step::contact::{Skin, Touch};
use crate::exact_step::obstacle::Obstacle;
use palpate_geometry::math::{Point3, Vector3};
use palpate_sim::body::DeformableState;

/// A body, and how it is touched.
pub(super) struct Touching<'a> {
    pub world: &'a World,
    /// d, s.
    pub damping_s: f64,
    /// g, m/s².
    pub gravity: Vector3,
    /// Places of the skin along both parameters.
    pub counts: [usize; 2],
}

/// What a path took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Taken {
    /// Newton steps of all ticks.
    pub steps: usize,
    /// Largest force left on a coordinate over the largest force.
    pub residual: f64,
    /// Places of the skin.
    pub places: usize,
}

impl Touching<'_> {
    /// So many steps, each with its obstacle, in the body's own frame; after each, `look` sees the
    /// state and the force on the body, N. Contact is asked for at places of the skin `within`.
    pub fn path(
        &self,
        ticks: usize,
        within: impl Fn(&Point3) -> bool,
        obstacle: impl Fn(usize) -> Obstacle,
        mut look: impl FnMut(&DeformableState, Vector3),
    ) -> Result<Taken, String> {
        let (body, _) = self.world.body()?;
        let mut exact = ExactStep::new(body);
        (exact.damping_s, exact.gravity) = (self.damping_s, self.gravity);
        let skin = Skin::new(
            &exact,
            self.world.scene.rest_surface(0).expect("a surface"),
            self.counts,
            within,
        )?;
        let (mut state, mut touch) = (body.rest_state(), Touch::default());
        let none = vec![Vector3::zeros(); body.coordinate_count()];
        let mut taken = Taken {
            places: skin.len(),
            ..Taken::default()
        };
        for tick in 0..ticks {
            let solved = exact
                .step_touching(&mut state, &none, &skin, &obstacle(tick), &mut touch)
                .map_err(|why| format!("tick {tick}: {why}"))?;
            taken.steps += solved.steps;
            taken.residual = taken.residual.max(solved.residual);
            look(&state, touch.force_n);
        }
        Ok(taken)
    }
}

impl Taken {
    /// In words.
    pub fn said(&self, ticks: usize) -> String {
        format!(
            "exact step with contact at {} places, {:.1} Newton steps a tick to {:.0e}",
            self.places,
            self.steps as f64 / ticks as f64,
            self.residual
        )
    }
}
