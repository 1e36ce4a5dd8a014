//! What a scene is made of: the constants of its bodies, tools and pairs.

use super::free::Free;
use super::mover::Mover;
use crate::body::Deformable;
use crate::haptics::{Coupling, DeviceBounds, DeviceFigures, LinkLimits};
use crate::solve::friction::Friction;
use crate::solve::indentation::Resolution;
use crate::solve::rows::Holder;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::contact::dispatch::{BodyShape, Method, Party};
use palpate_geometry::contact::mesh::MeshTool;
use palpate_geometry::contact::{ContactSamples, ToolShape};
use palpate_geometry::math::{Point3, Rotation};
use palpate_geometry::skin::Skin;
use palpate_geometry::surface::Surface;
use std::sync::Arc;

/// Below so many knot spans a direction of a surface is coarse.
const COARSE_SPANS: usize = 8;

/// Which tool carries the bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrameOf {
    pub tool: usize,
    /// Time constant of its velocities, s.
    pub smoothing_s: f64,
}

/// A body's constants.
#[derive(Debug)]
pub(crate) struct Body {
    pub id: String,
    /// Refined, in the world, at rest.
    pub skin: Skin,
    /// Of a closed part that surfaces or other parts may touch: what it is to them.
    pub solid: Option<Arc<MeshTool>>,
    /// Net before refinement: rows, columns; none of a part.
    pub original_net: [usize; 2],
    /// Diagonal of the net's box, m: what tolerances refer to.
    pub size_m: f64,
    /// Open sheets can be touched from both sides.
    pub two_sided: bool,
    pub model: BodyModel,
    /// What moves it, when it is rigid and not fixed.
    pub mover: Option<Mover>,
}

impl Body {
    /// As pairs are made of it.
    pub fn shape(&self) -> BodyShape<'_> {
        BodyShape {
            skin: &self.skin,
            solid: self.solid.as_ref(),
        }
    }

    /// The constants of a rigid body that contact and gravity move.
    pub fn free(&self) -> Option<&Free> {
        self.mover.as_ref()?.free()
    }

    /// The constants of a body that deforms.
    pub fn deforming(&self) -> Option<&DeformingBody> {
        match &self.model {
            BodyModel::Deforming(model) => Some(model),
            BodyModel::Rigid => None,
        }
    }

    /// Its surface deforms.
    pub fn is_soft(&self) -> bool {
        self.deforming().is_some()
    }

    /// It gives way to nothing: it is rigid, and no force moves it.
    pub fn is_firm(&self) -> bool {
        !self.is_soft() && !self.mover.as_ref().is_some_and(Mover::gives_way)
    }
}

/// What moves a body.
#[derive(Debug)]
pub(crate) enum BodyModel {
    Rigid,
    Deforming(Box<DeformingBody>),
}

/// A deforming body and the samples at which tools press it.
#[derive(Debug)]
pub(crate) struct DeformingBody {
    pub deformable: Deformable,
    pub samples: ContactSamples,
    /// (control points): how finely a solid resolves what presses it; empty for a membrane.
    pub resolution: Vec<Resolution>,
    pub sweeps: usize,
    /// The body steps once in so many ticks.
    pub every: u32,
    /// Model and method, and why this method.
    pub choice: Choice,
}

/// A tool's constants.
#[derive(Debug)]
pub(crate) struct Tool {
    pub id: String,
    pub shape: ToolShape,
    pub start: (Point3, Rotation),
    pub coupling: Coupling,
    pub limits: LinkLimits,
    pub device: Device,
    /// Greatest pull on what it grabs, N; 0: it grabs nothing.
    pub grip_n: f64,
}

/// What a tool's device can bear and how it is looked after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Device {
    /// N·m.
    pub torque_max_nm: f64,
    /// Strongest damper of the passivity controller, N·s/m; none: it only watches.
    pub passivity_damping_n_s_m: Option<f64>,
    /// The coupling may not be stiffer than the device can hold.
    pub bounded: bool,
    /// Its physics, as far as the scene says.
    pub figures: DeviceFigures,
    /// The scene gives its damping.
    pub known: bool,
}

impl Tool {
    /// The coupling, no stiffer than the device holds.
    pub fn coupling_for(&self, bounds: &DeviceBounds) -> Coupling {
        self.coupling.bounded(bounds.stiffness_max_n_m)
    }
}

/// Two parties that may touch: a tool or a body that holds, and a body. A body that holds itself
/// touches itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pair {
    pub holder: Holder,
    pub body: usize,
    pub method: Method,
    pub friction: Option<Friction>,
    /// With how much of the speed at which they meet two rigid bodies part.
    pub restitution: f64,
    /// The tool goes in by what the body's net does not show.
    pub near_field: bool,
}

impl Pair {
    /// The tool, when one holds.
    pub fn tool(&self) -> Option<usize> {
        match self.holder {
            Holder::Tool(tool) => Some(tool as usize),
            Holder::Body(_) => None,
        }
    }

    /// What stands against its body.
    pub fn party<'a>(&self, tools: &'a [Tool], bodies: &'a [Arc<Body>]) -> Party<'a> {
        match self.holder {
            Holder::Tool(tool) => Party::Tool(&tools[tool as usize].shape),
            Holder::Body(other) if other as usize == self.body => Party::Itself,
            Holder::Body(other) => Party::Body(bodies[other as usize].shape()),
        }
    }
}

/// What moves a body, and why that way.
#[derive(Clone, Debug)]
pub(crate) struct Choice {
    /// `lattice`, `membrane` …
    pub model: &'static str,
    /// One sentence for the plan.
    pub why: String,
}

/// Contact samples a knot span, in u and v. Two were chosen between one (the force ripples by several
/// percent as a ball slides over a control point) and three (twice the rows for a change of force below
/// one percent). Where spans are few they are large, and two leave so much room that a ball of jelly
/// stands 2 mm too deep on a plane and bounces 7 % too high: three.
pub(super) fn samples_per_span(surface: &Surface) -> [usize; 2] {
    let coarse = |knots: &KnotVector| knots.spans().count() < COARSE_SPANS;
    [surface.knots_u(), surface.knots_v()].map(|knots| if coarse(knots) { 3 } else { 2 })
}
