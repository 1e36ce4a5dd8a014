//! Model `continuum`: a stable neo-Hookean solid in the cells between the nodes.

use super::{Inputs, Model, cells, common};
use crate::body::Inside;
use crate::scene::BodyModel;
use palpate_geometry::surface::Surface;

pub(super) struct Continuum;

impl Model for Continuum {
    fn build(&self, body: &Inputs<'_>) -> Option<(Surface, BodyModel)> {
        common::deforming(body, common::NODE_BUDGET, |surface| {
            let moved = cells::of_builder(body, surface);
            let inside = match cells::has_flat_layers(body, surface) {
                true => Inside::FlatContinuum,
                false => Inside::Continuum,
            };
            common::solid(body, surface, inside, moved)
        })
    }
}
