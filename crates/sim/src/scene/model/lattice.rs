//! Model `lattice`: a solid of springs between nodes; the control points are nodes.

use super::{Inputs, Model, cells, common};
use crate::body::{Inside, SpringRule};
use crate::scene::BodyModel;
use crate::scene::spec::{MaterialSpec, SpringsSpec};
use palpate_geometry::surface::Surface;

pub(super) struct Lattice;

impl Model for Lattice {
    fn build(&self, body: &Inputs<'_>) -> Option<(Surface, BodyModel)> {
        let inside = Inside::Springs(rule(&body.spec.material));
        common::deforming(body, common::NODE_BUDGET, |surface| {
            common::solid(body, surface, inside, cells::of_builder(body, surface))
        })
    }
}

fn rule(material: &MaterialSpec) -> SpringRule {
    match material.springs {
        Some(SpringsSpec::Seed) => SpringRule::Seed,
        Some(SpringsSpec::Moduli) | None => SpringRule::Moduli,
    }
}
