//! What a tick's contact solve came to, for whoever measures; no stage uses it.

use super::scratch::Scratch;
use super::state::SceneState;
use crate::party::RigidMotion;
use crate::scene::Scene;
use crate::solve::rows::Holder;
use palpate_geometry::math::{Point3, Vector3};

impl Scratch {
    /// Force of all contacts of the last tick on a body, N.
    pub fn contact_force_on(&self, body: usize) -> Vector3 {
        let mut sum = Vector3::zeros();
        for (i, row) in self.rows.rows.iter().enumerate() {
            let force = self.solver.force_n(i);
            let factor = row.tool().map_or(1.0, |tool| self.tools[tool].borne);
            if row.body as usize == body {
                sum -= force * factor;
            }
            if row.holder == Holder::Body(body as u32) {
                sum += force;
            }
        }
        for (_, report) in &self.rest.reports {
            if report.body as usize == body {
                sum -= report.force_n;
            }
            if report.holder == Holder::Body(body as u32) {
                sum += report.force_n;
            }
        }
        sum
    }

    /// By contact row of the last tick on a deforming body, its place on that body: coordinates of the body and their
    /// weights. A row between two places of one body has two.
    pub fn contact_places(&self, scene: &Scene, body: usize) -> Vec<Vec<(u32, f64)>> {
        let Some(deformable) = scene.deformable(body) else {
            return Vec::new();
        };
        let sides = self.rows.rows.iter().flat_map(|row| row.sides_on(body));
        let places = sides.map(|(_, side)| {
            let (controls, weights) = self.rows.weights_in(side);
            let coordinate =
                |&control: &u32| deformable.coordinate_of_control(control as usize) as u32;
            let coordinates = controls.iter().map(coordinate);
            coordinates.zip(weights.iter().copied()).collect()
        });
        places.collect()
    }

    /// Contact rows of the last tick, without those of bodies that were left alone.
    pub fn row_count(&self) -> usize {
        self.rows.rows.len()
    }
}

impl SceneState {
    /// Greatest speed of any coordinate of a deforming body, m/s; of a rigid one that moves, of its
    /// control points. 0 of what is fixed.
    pub fn speed_m_s(&self, scene: &Scene, body: usize) -> f64 {
        scene.party(body).speed_m_s(&self.bodies[body])
    }

    /// How a free rigid body moves; `None` of others.
    pub fn rigid_motion(&self, scene: &Scene, body: usize) -> Option<RigidMotion> {
        scene.party(body).motion(&self.bodies[body])
    }

    /// True when a body lies at rest on others and is left alone.
    pub fn is_left_alone(&self, body: usize) -> bool {
        self.bodies[body].is_left_alone()
    }

    /// Placement of a rigid body that moves: a point of its surface at rest, where it is now, m.
    pub fn carried_point(&self, scene: &Scene, body: usize, rest: &Point3) -> Point3 {
        scene.party(body).carry(&self.bodies[body], rest)
    }
}
