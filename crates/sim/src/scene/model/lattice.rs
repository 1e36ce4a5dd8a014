//! Model `lattice`: a solid of springs between nodes; the control points are nodes.

use super::{Inputs, Model, cells, common};
use crate::body::{Inside, SpringRule};
use crate::scene::BodyModel;
use crate::scene::spec::{MaterialSpec, SpringsSpec};
use palpate_geometry::surface::Surface;

pub(super) struct Lattice;

impl Model for Lattice {
    fn build(&self, body: &Inputs<'_>) -> Option<(Surface, BodyModel)> {
        common::deforming(body, common::NODE_BUDGET, |surface| {
            let inside = inside(body, surface);
            common::solid(body, surface, inside, cells::of_builder(body, surface))
        })
    }
}

/// Springs; in a flat body the energy that they stand for in cubes, since springs of flat cells have
/// no stiffness against shear across them. Stiffening is a law of springs.
fn inside(body: &Inputs<'_>, surface: &Surface) -> Inside {
    let rule = rule(&body.spec.material);
    let like_springs = rule == SpringRule::Moduli && body.material.stiffening.is_none();
    if like_springs && cells::has_flat_layers(body, surface) {
        return Inside::FlatSprings;
    }
    Inside::Springs(rule)
}

fn rule(material: &MaterialSpec) -> SpringRule {
    match material.springs {
        Some(SpringsSpec::Seed) => SpringRule::Seed,
        Some(SpringsSpec::Moduli) | None => SpringRule::Moduli,
    }
}
