//! Scenes: the file ([`SceneSpec`]) and the constant ([`Scene`]) that is built from it. What changes
//! from tick to tick is in [`crate::tick`].
//!
//! `Scene::build` compiles exactly the bodies, tools and pairs that the file asks for;
//! [`plan::Plan`] prints them. What a scene does not need has no buffer and no stage.

mod build;
mod change;
mod cut;
mod cut_sheet;
mod door;
pub mod file;
mod files;
mod findings;
mod free;
mod layout;
mod mass;
mod methods;
mod model;
mod mover;
mod pairs;
mod parts;
pub mod plan;
mod refine;
mod schema;
pub mod shape;
pub mod spec;
mod surface;
mod tool;

pub use build::inline_files;
pub use change::{Origin, SceneChange};
pub use cut::{BodyPiece, SceneCut, SceneCutError};
pub use door::{Place, Problem, SceneError};
pub use files::Files;
pub use findings::{Finding, FindingKind};
pub(crate) use free::Free;
pub(crate) use mass::Mass;
pub use methods::{CellBuilder, Methods};
pub(crate) use mover::{MovedBy, Mover, SPEED_MAX_M_S, TURNING_MAX_RAD_S, between, smooth};
pub(crate) use parts::{Body, BodyModel, DeformingBody, FrameOf, Pair, Tool};
pub use schema::schema;

use crate::body::Deformable;
use crate::haptics::{DeviceBounds, DeviceFigures, StiffnessLimits};
use crate::solve::rows::{Holder, most_rows};
use palpate_geometry::basis::KnotVector;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::cut::CutPlane;
use palpate_geometry::math::{Point3, Rotation};
use palpate_geometry::part::PartMesh;
use palpate_geometry::skin::Skin;
use palpate_geometry::surface::{Mesh, Surface};
use spec::{ActionSpec, Clock, SceneSpec};
use std::sync::Arc;

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
    /// Scenes that follow each other share those that stay.
    pub(crate) bodies: Vec<Arc<Body>>,
    pub(crate) tools: Vec<Tool>,
    /// Those of tools first, ordered by tool, then body; then those of bodies.
    pub(crate) pairs: Vec<Pair>,
    /// The tool that carries the bodies.
    pub(crate) frame: Option<FrameOf>,
    /// With which it was built.
    methods: Methods,
    /// Path and text of what was taken otherwise than its files say.
    notes: Vec<(String, String)>,
    warnings: Vec<Finding>,
}

impl Scene {
    /// Number of tools.
    pub fn tool_count(&self) -> usize {
        self.tools.len()
    }

    /// How stiff a tool may be coupled to a device with these figures: a bounded coupling no
    /// stiffer than is passive in any hand. Where nothing is, or the scene does not ask for it, the
    /// scene's own stiffness stays, and a warning is due.
    pub fn bounds_of(&self, tool: usize, figures: &DeviceFigures) -> DeviceBounds {
        let passive_n_m = self.passive_n_m(tool, figures);
        if self.tools[tool].device.bounded && passive_n_m > 0.0 {
            return DeviceBounds {
                stiffness_max_n_m: passive_n_m,
                ..DeviceBounds::default()
            };
        }
        DeviceBounds::default()
    }

    /// What such a device holds in any hand, N/m, if the tool's coupling is stiffer and stays so.
    pub fn stiffer_than(&self, tool: usize, figures: &DeviceFigures) -> Option<f64> {
        let passive_n_m = self.passive_n_m(tool, figures);
        let Tool {
            coupling, device, ..
        } = &self.tools[tool];
        (!device.bounded && coupling.stiffness_n_m() > passive_n_m).then_some(passive_n_m)
    }

    fn passive_n_m(&self, tool: usize, figures: &DeviceFigures) -> f64 {
        let figures = DeviceFigures {
            period_s: figures.period_s.max(self.dt_s),
            ..*figures
        };
        figures
            .stiffness_limits(self.tools[tool].coupling.damping_n_s_m())
            .passive_n_m()
    }

    /// Stiffness limits of a tool's coupling with the figures that the scene gives for its device;
    /// none if it gives no damping.
    pub fn stiffness_limits(&self, tool: usize) -> Option<StiffnessLimits> {
        self.stiffness_limits_of(&self.tools[tool])
    }

    pub(crate) fn stiffness_limits_of(&self, tool: &Tool) -> Option<StiffnessLimits> {
        tool.device.known.then(|| {
            tool.device
                .figures
                .stiffness_limits(tool.coupling.damping_n_s_m())
        })
    }

    /// Most contact rows of one tick, over all pairs.
    pub fn most_rows(&self) -> usize {
        let give = self.bodies.iter().filter(|body| !body.is_firm());
        most_rows(self.tool_count() + give.count())
    }

    /// Id of a tool.
    pub fn tool_id(&self, tool: usize) -> &str {
        &self.tools[tool].id
    }

    /// Index of a tool.
    pub fn tool_index(&self, id: &str) -> Option<usize> {
        self.tools.iter().position(|tool| tool.id == id)
    }

    /// Index of a body.
    pub fn body_index(&self, id: &str) -> Option<usize> {
        self.bodies.iter().position(|body| body.id == id)
    }

    /// Shape of a tool.
    pub fn tool_shape(&self, tool: usize) -> &ToolShape {
        &self.tools[tool].shape
    }

    /// Name of a tool's shape, as scenes write it.
    pub fn shape_name(&self, tool: usize) -> &'static str {
        self.spec.tools[tool].shape.name()
    }

    /// True when a tool cuts bodies instead of touching them.
    pub fn cuts(&self, tool: usize) -> bool {
        self.spec.tools[tool].action == Some(ActionSpec::Cut)
    }

    /// The plane of a tool that is one, with its frame at a place; `None` of other shapes.
    pub fn tool_plane(&self, tool: usize, at: &Point3, turned: &Rotation) -> Option<CutPlane> {
        match &self.tools[tool].shape {
            ToolShape::Plane { normal } => CutPlane::through(at, &(turned * normal)),
            _ => None,
        }
    }

    /// Where a tool starts.
    pub fn tool_start(&self, tool: usize) -> (Point3, Rotation) {
        self.tools[tool].start
    }

    /// A tool's shape as viewers draw it: triangles in the tool's frame, m, counter-clockwise seen
    /// from outside, closed where the shape is a solid. What has no bounds is cut off at about
    /// `view_m`, the size of the scene, which also gives a size to what has none.
    pub fn tool_outline(&self, tool: usize, view_m: f64) -> Mesh {
        let shape = self.spec.tools[tool].shape.shape();
        shape.outline(&self.tools[tool].shape, view_m)
    }

    /// Id of the tool or body that holds a pair.
    pub(crate) fn holder_id(&self, pair: &Pair) -> &str {
        match pair.holder {
            Holder::Tool(tool) => &self.tools[tool as usize].id,
            Holder::Body(body) => &self.bodies[body as usize].id,
        }
    }

    /// Number of bodies.
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// Id of a body.
    pub fn body_id(&self, body: usize) -> &str {
        &self.bodies[body].id
    }

    /// The surface of a body at rest, refined as simulated and published (world frame); `None` of a part.
    pub fn rest_surface(&self, body: usize) -> Option<&Surface> {
        self.bodies[body].skin.surface()
    }

    /// Degrees of a body's net in u and v, and its rows and columns. That of a part are the eight corners of a box around
    /// it, 2 × 4 of degree 0.
    pub fn net_size(&self, body: usize) -> ([usize; 2], [usize; 2]) {
        match &self.bodies[body].skin {
            Skin::Surface(surface) => (
                [surface.knots_u(), surface.knots_v()].map(KnotVector::degree),
                [surface.net().rows(), surface.net().columns()],
            ),
            Skin::Part(_) => ([0; 2], [2, 4]),
        }
    }

    /// Triangles of a part at rest (world frame), m, no farther from it than a 1/2000 of its size where `most` allow it;
    /// `None` of a surface.
    pub fn part_outline(&self, body: usize, most: usize) -> Option<Mesh> {
        let placed = self.bodies[body].skin.part()?;
        let part = placed.part();
        let made = (0..6).find_map(|k| {
            let tolerance_m = part.size_m() * 5e-4 * f64::from(4u32.pow(k));
            part.triangles(tolerance_m, most).ok()
        });
        let PartMesh { mesh, .. } = made?;
        Some(Mesh {
            points: mesh.points.iter().map(|p| placed.pose() * p).collect(),
            ..mesh
        })
    }

    /// What is touched of a body, at rest (world frame).
    pub fn skin(&self, body: usize) -> &Skin {
        &self.bodies[body].skin
    }

    /// True when the body's net can change.
    pub fn deforms(&self, body: usize) -> bool {
        matches!(self.bodies[body].model, BodyModel::Deforming(_))
    }

    /// True of a skin of springs.
    pub(crate) fn is_membrane(&self, body: usize) -> bool {
        self.spec.bodies[body].model() == spec::ModelSpec::Membrane
    }

    /// True when the body's net can change: it deforms, or it is rigid and moves.
    pub fn moves(&self, body: usize) -> bool {
        self.deforms(body) || self.bodies[body].mover.is_some()
    }

    /// True when a command can send the body to a place.
    pub fn can_be_sent(&self, body: usize) -> bool {
        self.bodies[body].mover.is_some() && !self.is_free(body)
    }

    /// True when the body is rigid, and contact and gravity move it.
    pub fn is_free(&self, body: usize) -> bool {
        self.bodies[body].free().is_some()
    }

    /// True when a body steps once in several ticks.
    pub fn steps_apart(&self, body: usize) -> bool {
        matches!(&self.bodies[body].model, BodyModel::Deforming(model) if model.every > 1)
    }

    /// True when a body may ask for a matrix that follows it.
    pub fn makes_matrices(&self, body: usize) -> bool {
        let deformable = self.deformable(body);
        !self.steps_apart(body) && deformable.is_some_and(Deformable::makes_matrices)
    }

    /// A body steps once in so many ticks; 1 for what does not deform.
    pub fn steps_every(&self, body: usize) -> u32 {
        match &self.bodies[body].model {
            BodyModel::Deforming(model) => model.every,
            BodyModel::Rigid => 1,
        }
    }

    /// Name of a body's model, as scenes write it.
    pub fn model_name(&self, body: usize) -> &'static str {
        match &self.bodies[body].model {
            BodyModel::Rigid => "rigid",
            BodyModel::Deforming(model) => model.choice.model,
        }
    }

    /// The constants of a body that deforms.
    pub fn deformable(&self, body: usize) -> Option<&Deformable> {
        match &self.bodies[body].model {
            BodyModel::Deforming(body) => Some(&body.deformable),
            BodyModel::Rigid => None,
        }
    }
}
