//! What the bus and whoever remakes scenes say to each other, without knowing each other.

use super::ports::NetEnd;
use super::swap::Swap;
use palpate_geometry::cut::CutPlane;
use palpate_geometry::math::Point3;
use palpate_sim::scene::Scene;
use std::sync::Arc;

/// What a client may ask of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct EditRequest {
    /// Bodies, by index, in the order in which they were named.
    pub bodies: Vec<usize>,
    /// What to do with them.
    pub edit: Edit,
}

/// How a body stands; both lists are of the same tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// Control points, u-major, m.
    pub points: Vec<Point3>,
    /// Coordinates of a body that deforms, m, of which its nodes are made; none of others.
    pub coordinates: Vec<Point3>,
}

/// A change of the scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// One body in the place of several.
    Merge {
        /// Its name.
        id: Option<String>,
        /// Continuous derivatives at the seam.
        continuity: Option<u32>,
        /// `seed`, `constrained` or `exact`.
        method: Option<String>,
        /// `rows` or `lines`.
        hidden: Option<String>,
        /// Deviation allowed, m: knots are inserted until it is met.
        tolerance_m: Option<f64>,
    },
    /// Overlapping bodies moved apart; the first moves.
    Isolate {
        /// `1` … `7`, `local` or `global`.
        method: Option<String>,
        /// Gap left between them, m.
        gap_m: Option<f64>,
        /// Most turn about the other, degrees.
        max_turn_deg: Option<f64>,
    },
    /// A common wall between two overlapping bodies, which become parts.
    Truncate {
        /// How far the wall may be off, m.
        tolerance_m: Option<f64>,
    },
    /// The pieces that a plane makes of one body in its place.
    Cut {
        /// In the world.
        plane: CutPlane,
        /// Width of what is lost, half of it on either side of the plane, m; not negative.
        kerf_m: f64,
    },
}

/// What became of a request.
pub enum EditNews {
    /// The next scene is made; it is for the loop.
    Ready {
        /// For the loop.
        swap: Box<Swap>,
        /// For the bus.
        nets: Vec<NetEnd>,
        /// SHA-256 of the new scene as a file.
        scene_hash: [u8; 32],
        /// Words for the event.
        what: String,
        /// Figures for the client.
        report: serde_json::Value,
    },
    /// There is nothing to change.
    Nothing {
        /// Number of the request.
        id: u64,
        /// Figures for the client.
        report: serde_json::Value,
    },
    /// It cannot be.
    Refused {
        /// Number of the request.
        id: u64,
        /// Why.
        reason: String,
    },
}

/// Who remakes scenes, as the bus thread sees it. Nothing here waits.
pub trait Editor: Send {
    /// Asks for a change of a scene; `standing` is how the bodies named stand. The answer comes with
    /// [`Editor::news`] under the same number.
    fn ask(&mut self, id: u64, scene: &Arc<Scene>, standing: Vec<Standing>, request: EditRequest);
    /// The next piece of news, if there is one.
    fn news(&mut self) -> Option<EditNews>;
}
