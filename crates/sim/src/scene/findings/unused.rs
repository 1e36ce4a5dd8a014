//! Keys that have no effect on the model that has them.

use super::Found;
use crate::scene::Scene;
use crate::scene::spec::{BodySpec, BuilderSpec, MatrixSpec, ModelSpec};

/// A key, whether the body gives it, the models that use it, and what to do.
type Row = (
    &'static str,
    fn(&BodySpec) -> bool,
    &'static [ModelSpec],
    &'static str,
);

use ModelSpec::{Continuum, Lattice, Membrane, Net};
const DEFORMING: &[ModelSpec] = &[Membrane, Lattice, Continuum, Net];

/// Keys whose absence differs from their default.
const ROWS: [Row; 9] = [
    (
        "material.poisson",
        |body| body.material.poisson.is_some(),
        &[Continuum, Net],
        "a lattice of springs has 1/4 and a membrane 1/3 whatever it says; use model = \"continuum\", or drop it",
    ),
    (
        "material.stiffening",
        |body| body.material.stiffening.is_some(),
        &[Lattice, Membrane],
        "it is a law of springs; use model = \"lattice\", or drop it",
    ),
    (
        "material.springs",
        |body| body.material.springs.is_some(),
        &[Lattice],
        "it says how stiff springs are; use model = \"lattice\", or drop it",
    ),
    (
        "material.plastic",
        |body| body.material.plastic.is_some(),
        DEFORMING,
        "a rigid body keeps its shape; use a model that deforms, or drop it",
    ),
    (
        "region",
        |body| !body.regions.is_empty(),
        &[Lattice, Continuum, Net],
        "a rigid body has no parts; use a model that deforms, or drop it",
    ),
    (
        "fixed",
        |body| !body.fixed.is_empty(),
        DEFORMING,
        "a rigid body that is not free stays where it is; use a model that deforms, or drop it",
    ),
    (
        "lattice.cell_layers",
        |body| body.lattice.cell_layers.is_some(),
        &[Net],
        "only a net has cells apart from its nodes; use model = \"net\", or drop it",
    ),
    (
        "integrator.matrix",
        |body| body.integrator.matrix == MatrixSpec::Bounding,
        &[Lattice, Membrane],
        "a continuum takes the tangent of its cells, whose pressures are unknowns; drop it",
    ),
    (
        "lattice.builder",
        |body| body.lattice.builder != BuilderSpec::Layers,
        &[Lattice, Continuum],
        "this model places its nodes itself; use model = \"lattice\" or \"continuum\", or drop it",
    ),
];

pub(super) fn look(scene: &Scene, found: &mut Found) {
    for (b, body) in scene.spec.bodies.iter().enumerate() {
        for (key, given, users, what) in ROWS {
            if given(body) && !users.contains(&body.model()) {
                found.unusual(
                    format!("body[{b}].{key}"),
                    format!("{key} has no effect on body {}: {what}", body.id),
                );
            }
        }
        for (r, region) in body.regions.iter().enumerate() {
            if region.poisson.is_some() && body.model() == Lattice {
                found.unusual(
                    format!("body[{b}].region[{r}].poisson"),
                    format!("poisson has no effect on body {}: {}", body.id, ROWS[0].3),
                );
            }
        }
    }
}
