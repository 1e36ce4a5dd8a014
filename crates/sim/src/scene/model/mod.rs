//! Models of bodies: one file each, which knows what the model asks of a `[[body]]` and how a body
//! is built from it.
//!
//! To add a model: its file, with a type that implements [`Model`], its name in `names`, and its two
//! lines here. A new law of forces between nodes is a part of [`crate::body::MaterialLaw`].

mod cells;
mod common;
mod continuum;
mod fixed;
mod lattice;
mod membrane;
mod names;
mod net;
mod part;
mod rigid;
mod values;

pub use names::ModelSpec;
pub(super) use values::material_of;

use super::door::At;
use super::parts::{Body, BodyModel, Tool};
use super::spec::{BodySpec, SceneSpec};
use super::surface::Named;
use super::{free, mover};
use crate::body::{Deformable, DeformableError, Material, StepSettings};
use palpate_geometry::math::Pose;
use palpate_geometry::skin::{PlacedPart, Skin};
use palpate_geometry::surface::{Loaded, Surface};
use std::sync::Arc;
use values::{Held, Values};

/// What the rest of the program asks of a model.
pub(super) trait Model: Sync {
    /// The surface as simulated, and what moves it. Problems go to `body.at`.
    fn build(&self, body: &Inputs<'_>) -> Option<(Surface, BodyModel)>;

    /// False where a surface never changes.
    fn deforms(&self) -> bool {
        true
    }
}

/// What a body is built from, its values checked.
pub(super) struct Inputs<'a> {
    /// The whole scene: nets are refined where its tools are.
    pub scene: &'a SceneSpec,
    /// Its tools, as far as nothing is wrong with them.
    pub tools: &'a [Option<&'a Tool>],
    /// The `[[body]]`.
    pub spec: &'a BodySpec,
    /// Where it stands.
    pub at: &'a At<'a>,
    /// Length of a tick, s.
    pub dt_s: f64,
    /// Body frame to world.
    pub placement: Pose,
    /// As given, oriented outwards, in the world.
    pub surface: Surface,
    /// Of all cells that no region holds.
    pub material: Material,
    /// What never moves.
    pub held: Vec<Held>,
}

/// Makes a body with the step that it is given; what it needs for that is built once.
type Make<'a> = Box<dyn Fn(StepSettings) -> Result<Deformable, DeformableError> + 'a>;

impl ModelSpec {
    pub(super) fn model(self) -> &'static dyn Model {
        match self {
            Self::Rigid => &rigid::Rigid,
            Self::Membrane => &membrane::Membrane,
            Self::Lattice => &lattice::Lattice,
            Self::Continuum => &continuum::Continuum,
            Self::Net => &net::Net,
        }
    }
}

/// Checks and builds a body; `at` is its table.
pub(super) fn build(
    scene: &SceneSpec,
    tools: &[Option<&Tool>],
    spec: &BodySpec,
    at: &At<'_>,
    dt_s: f64,
) -> Option<Body> {
    let placement = at
        .key("pose")
        .pose(&spec.pose.position, &spec.pose.orientation);
    let loaded = spec.surface.loaded(&at.key("surface"));
    let values = values::check(spec, at);
    let placement = placement?;
    let moved = match spec.free {
        true => Some(None),
        false => mover::build(scene, spec, &placement, at),
    };
    let Values { material, held } = values?;
    let Loaded { surface, merged } = match loaded? {
        Named::Surface(loaded) => loaded,
        Named::Part(part, notes) => {
            let of_file = at.key("surface");
            (notes.iter()).for_each(|note| of_file.note(format!("body {}: {note}", spec.id)));
            part::check(spec, at, &part)?;
            let skin = Skin::Part(PlacedPart::new(Arc::from(part), placement));
            let mover = match spec.free {
                true => free::build(scene, spec, &skin, material.density_kg_m3, at).map(Some),
                false => moved,
            };
            return Some(Body {
                id: spec.id.clone(),
                original_net: [0; 2],
                size_m: skin.size_m(),
                two_sided: !skin.is_closed(),
                skin,
                solid: None,
                model: BodyModel::Rigid,
                mover: mover?,
            });
        }
    };
    for merged in merged {
        (at.key("surface")).note(format!("body {}: {merged}", spec.id));
    }
    let original = surface.oriented_outward().placed(&placement);
    // What is one place moves together, so it starts equal bit for bit.
    let original = (at.key("pose").key("position").take(original)?).with_exact_seams();
    let mover = match spec.free {
        true => {
            let skin = Skin::Surface(original.clone());
            free::build(scene, spec, &skin, material.density_kg_m3, at).map(Some)
        }
        false => moved,
    };
    let original_net = [original.net().rows(), original.net().columns()];
    let two_sided = !original.topology().is_closed();
    let size_m = original.size();
    let (surface, model) = spec.model().model().build(&Inputs {
        scene,
        tools,
        spec,
        at,
        dt_s,
        placement,
        surface: original,
        material,
        held,
    })?;
    if spec.self_contact && two_sided {
        return at.key("self_contact").refused(
            "a surface that is open has no inside: a fold that passes through it looks like one that does not; close the surface or drop self_contact",
        );
    }
    Some(Body {
        id: spec.id.clone(),
        skin: Skin::Surface(surface),
        solid: None,
        original_net,
        size_m,
        two_sided,
        model,
        mover: mover?,
    })
}
