//! Model `rigid`: a surface that never changes.

use super::{Inputs, Model};
use crate::scene::BodyModel;
use palpate_geometry::surface::Surface;

pub(super) struct Rigid;

impl Model for Rigid {
    fn build(&self, body: &Inputs<'_>) -> Option<(Surface, BodyModel)> {
        if body.spec.self_contact {
            return body.at.key("self_contact").refused(
                "a rigid body cannot come to touch itself; give it a deforming model or drop self_contact",
            );
        }
        for (key, value) in [
            ("velocity_m_s", body.spec.velocity_m_s),
            ("spin_rad_s", body.spec.spin_rad_s),
        ] {
            if value != [0.0; 3] && !body.spec.free {
                return body.at.key(key).refused(
                    "only deforming bodies and free ones start with a velocity; other rigid ones go where their `motion` says: set free = true or drop it",
                );
            }
        }
        Some((body.surface.clone(), BodyModel::Rigid))
    }

    fn deforms(&self) -> bool {
        false
    }
}
