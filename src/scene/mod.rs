//! Scenes: the file (`SceneSpec`), the constant (`Scene`), what a replay restores (`SceneState`), and `Scratch`.
//!
//! `Scene::build` compiles exactly the bodies, tools and pairs that the file asks for; [`plan::Plan`] prints them. What a
//! scene does not need has no buffer and no stage.

mod build;
pub mod file;
pub mod plan;
mod refine;
pub mod spec;
mod state;

pub use build::{SceneError, default_samples_per_span, inline_files};
pub use state::{BodyScratch, BodyState, PairState, RunState, SceneState, Scratch, ToolState, WarmRow};

use crate::body::Lattice;
use crate::contact::{SampleGrid, ToolShape};
use crate::haptics::{Coupling, LinkLimits};
use crate::math::{Point3, Rotation};
use crate::surface::Surface;
use spec::{Clock, SceneSpec};

/// The constant of a simulation: built once, shared, never changed.
#[derive(Debug)]
pub struct Scene {
    /// Name.
    pub name: String,
    /// Length of a tick, s.
    pub dt_s: f64,
    /// What makes a tick due.
    pub clock: Clock,
    /// The file it was built from.
    pub spec: SceneSpec,
    pub(crate) bodies: Vec<Body>,
    pub(crate) tools: Vec<Tool>,
    /// Ordered by tool, then body.
    pub(crate) pairs: Vec<Pair>,
}

/// A body's constants.
#[derive(Debug)]
pub(crate) struct Body {
    pub id: String,
    /// Refined, in the world, at rest.
    pub surface: Surface,
    /// Net before refinement: rows, columns.
    pub original_net: [usize; 2],
    /// Diagonal of the net's box, m: what tolerances refer to.
    pub size_m: f64,
    /// Open sheets can be touched from both sides.
    pub two_sided: bool,
    pub model: BodyModel,
}

/// What moves a body.
#[derive(Debug)]
pub(crate) enum BodyModel {
    Rigid,
    Lattice(Box<LatticeBody>),
}

/// A lattice and the samples at which tools press it.
#[derive(Debug)]
pub(crate) struct LatticeBody {
    pub lattice: Lattice,
    pub samples: SampleGrid,
    pub sweeps: usize,
}

/// A tool's constants.
#[derive(Debug)]
pub(crate) struct Tool {
    pub id: String,
    pub shape: ToolShape,
    pub start: (Point3, Rotation),
    pub coupling: Coupling,
    pub limits: LinkLimits,
}

/// A tool that may touch a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pair {
    pub tool: usize,
    pub body: usize,
}

impl Scene {
    /// Number of tools.
    pub fn tool_count(&self) -> usize {
        self.tools.len()
    }

    /// Id of a tool.
    pub fn tool_id(&self, tool: usize) -> &str {
        &self.tools[tool].id
    }

    /// Index of a tool.
    pub fn tool_index(&self, id: &str) -> Option<usize> {
        self.tools.iter().position(|tool| tool.id == id)
    }

    /// Shape of a tool.
    pub fn tool_shape(&self, tool: usize) -> &ToolShape {
        &self.tools[tool].shape
    }

    /// Number of bodies.
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// Id of a body.
    pub fn body_id(&self, body: usize) -> &str {
        &self.bodies[body].id
    }

    /// The surface of a body at rest, refined as simulated and published (world frame).
    pub fn rest_surface(&self, body: usize) -> &Surface {
        &self.bodies[body].surface
    }

    /// True when the body's net can change.
    pub fn deforms(&self, body: usize) -> bool {
        matches!(self.bodies[body].model, BodyModel::Lattice(_))
    }

    /// The lattice of a body, if it has one.
    pub fn lattice(&self, body: usize) -> Option<&Lattice> {
        match &self.bodies[body].model {
            BodyModel::Lattice(body) => Some(&body.lattice),
            BodyModel::Rigid => None,
        }
    }
}

/// Bits of `ToolOutput::flags`; the wire uses the same.
pub mod flags {
    /// The newest pose is older than the stale limit; the force ramps to zero.
    pub const STALE: u32 = 1;
    /// The force was limited to what the device can bear.
    pub const SATURATED: u32 = 1 << 1;
    /// Bodies stand still.
    pub const PAUSED: u32 = 1 << 2;
    /// This tick's pose was refused.
    pub const REFUSED: u32 = 1 << 3;
    /// The force limit is not at its full value.
    pub const RAMPING: u32 = 1 << 4;
    /// The tick met a fault; the force is safe, not right.
    pub const FAULT: u32 = 1 << 5;
}
