//! Model `rigid`: a surface that never changes.

use super::{Inputs, Model};
use crate::scene::BodyModel;
use crate::scene::door::At;
use crate::scene::spec::BodySpec;
use palpate_geometry::surface::Surface;

pub(super) struct Rigid;

/// Refuses what a rigid body cannot do.
pub(super) fn check(spec: &BodySpec, at: &At<'_>) -> Option<()> {
    if spec.self_contact {
        return at.key("self_contact").refused(
            "a rigid body cannot come to touch itself; give it a deforming model or drop self_contact",
        );
    }
    for (key, value) in [
        ("velocity_m_s", spec.velocity_m_s),
        ("spin_rad_s", spec.spin_rad_s),
    ] {
        if value != [0.0; 3] && !spec.free {
            return at.key(key).refused(
                "only deforming bodies and free ones start with a velocity; other rigid ones go where their `motion` says: set free = true or drop it",
            );
        }
    }
    Some(())
}

impl Model for Rigid {
    fn build(&self, body: &Inputs<'_>) -> Option<(Surface, BodyModel)> {
        check(body.spec, body.at)?;
        Some((body.surface.clone(), BodyModel::Rigid))
    }

    fn deforms(&self) -> bool {
        false
    }
}
