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
        Some((body.surface.clone(), BodyModel::Rigid))
    }

    fn deforms(&self) -> bool {
        false
    }
}
