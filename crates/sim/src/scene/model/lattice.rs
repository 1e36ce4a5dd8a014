//! Model `lattice`: a solid of springs between nodes; the control points are nodes.

use super::{Inputs, Model, cells, common};
use crate::body::Inside;
use crate::scene::BodyModel;
use crate::scene::spec::SpringsSpec;
use palpate_geometry::surface::Surface;

pub(super) struct Lattice;

impl Model for Lattice {
    fn build(&self, body: &Inputs<'_>) -> Option<(Surface, BodyModel)> {
        common::deforming(body, common::NODE_BUDGET, |surface| {
            let inside = inside(body, surface)?;
            common::solid(body, surface, inside, cells::of_builder(body, surface))
        })
    }
}

/// Springs; in a flat body the energy that they stand for in cubes, since springs of flat cells have
/// no stiffness against shear across them. Stiffening is a law of springs.
fn inside(body: &Inputs<'_>, surface: &Surface) -> Option<Inside> {
    match body.spec.material.springs {
        Some(law @ SpringsSpec::Seed) => {
            let at = body.at.key("material");
            let law = at.methods().spring_law(law.name(), &at)?;
            Some(Inside::SpringsBy(law))
        }
        Some(SpringsSpec::Moduli) | None => {
            let like_springs = body.material.stiffening.is_none();
            let flat = like_springs && cells::has_flat_layers(body, surface);
            Some(if flat {
                Inside::FlatSprings
            } else {
                Inside::Springs
            })
        }
    }
}
