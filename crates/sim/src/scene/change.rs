//! A scene that becomes another while it runs: bodies move, merge into one, are cut into pieces, or become parts with a
//! common wall.
//!
//! ```text
//! SceneSpec ── moved, merged, cut, truncated ──▶ SceneSpec' ── build ──▶ Scene'      beside the loop
//! SceneState ── Scene::carry_over ────▶ SceneState'                  between two ticks, without allocating
//! ```
//! The new file says all that the new scene is, so a recording that begins with the state after the
//! change replays alone.

use super::door::{Door, SceneError};
use super::methods::Methods;
use super::spec::{
    BodySpec, ContactSpec, FixedSpec, ModelSpec, PoseSpec, RefineAuto, RefineSpec, SceneSpec,
    SurfaceSpec,
};
use super::surface::STEP;
use super::{Body, Scene};
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::{Point3, Pose, Rotation, Vector3};
use palpate_geometry::surface::{ControlNet, Surface, SurfaceError, file};
use std::path::Path;
use std::sync::Arc;

/// Where a body of the new scene comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// It goes on as it is, moved by so much.
    Kept {
        /// Its index in the old scene.
        from: usize,
        /// m, world axes.
        moved: Vector3,
    },
    /// It is a piece of a body, and goes on as that.
    Piece {
        /// The body's index in the old scene.
        from: usize,
    },
    /// It begins at rest.
    New,
}

impl Origin {
    /// It stays where it is.
    pub(super) fn kept(from: usize) -> Self {
        Self::Kept {
            from,
            moved: Vector3::zeros(),
        }
    }
}

/// Every body stays where it is.
fn all_kept(spec: &SceneSpec) -> Vec<Origin> {
    (0..spec.bodies.len()).map(Origin::kept).collect()
}

/// The next scene, and where its bodies come from.
#[derive(Clone, Debug)]
pub struct SceneChange {
    /// As a file.
    pub(super) spec: SceneSpec,
    /// By body.
    origins: Vec<Origin>,
    /// By body: those that need not be built.
    pub(super) ready: Vec<Option<Arc<Body>>>,
    /// Those of the scene before.
    methods: Methods,
}

impl SceneChange {
    /// A scene with the same tools.
    pub(super) fn new(scene: &Scene, spec: SceneSpec, origins: Vec<Origin>) -> Self {
        debug_assert_eq!(spec.bodies.len(), origins.len(), "an origin a body");
        debug_assert_eq!(spec.tools, scene.spec.tools, "tools stay");
        let stays = |origin: &Origin| match *origin {
            Origin::Kept { from, moved } if moved == Vector3::zeros() => {
                Some(&scene.bodies[from]).filter(|body| body.is_soft())
            }
            _ => None,
        };
        let ready = origins.iter().map(|origin| stays(origin).cloned());
        Self {
            ready: ready.collect(),
            methods: scene.methods,
            spec,
            origins,
        }
    }

    /// The next scene: [`Scene::build_to_run`] of its file, but what stays or is made already is not built again.
    ///
    /// # Errors
    /// As [`Scene::build_to_run`].
    pub fn build_to_run(&self) -> Result<Scene, SceneError> {
        Scene::build_from(&self.spec, &Path::new(""), self.methods, &self.ready)?.checked_to_run()
    }

    /// The next scene as a file.
    pub fn spec(&self) -> &SceneSpec {
        &self.spec
    }

    /// Where its bodies come from.
    pub fn origins(&self) -> &[Origin] {
        &self.origins
    }

    /// What the next scene says of a body; `None` without a body of that id.
    pub fn body(&self, id: &str) -> Option<&BodySpec> {
        self.spec.bodies.iter().find(|body| body.id == id)
    }

    /// The same scene with bodies moved: (index, by how much in m, world axes).
    ///
    /// # Errors
    /// The scene's own surfaces do not build any more.
    pub fn moved(scene: &Scene, moves: &[(usize, Vector3)]) -> Result<Self, SceneError> {
        let mut spec = pinned(scene)?;
        let mut origins = all_kept(&spec);
        for &(body, by) in moves {
            let position = &mut spec.bodies[body].pose.position;
            *position = (Vector3::from(*position) + by).into();
            origins[body] = Origin::Kept {
                from: body,
                moved: by,
            };
        }
        Ok(Self::new(scene, spec, origins))
    }

    /// The scene with one body in the place of several: `parts` in the order in which they were
    /// merged, the first of which lends all that is not said here. `surface` is where it is, m, in
    /// the world.
    ///
    /// # Errors
    /// A name that another body has, or something of a part that its place in the surface decides.
    pub fn merged(
        scene: &Scene,
        parts: &[usize],
        id: &str,
        surface: &Surface,
    ) -> Result<Self, SceneError> {
        let spec = pinned(scene)?;
        let is_part = |body: usize| parts.contains(&body);
        let taken = (0..spec.bodies.len()).any(|b| !is_part(b) && spec.bodies[b].id == id);
        if taken || spec.tools.iter().any(|tool| tool.id == id) {
            return Err(SceneError::one(
                "id",
                format!("{id:?} is in use already; name the merged body otherwise"),
            ));
        }
        let Some(&first) = parts.first() else {
            return Err(SceneError::one("bodies", "nothing to merge"));
        };
        let mut body = BodySpec {
            id: id.to_owned(),
            surface: inline(surface)?,
            pose: PoseSpec::default(),
            fixed: Vec::new(),
            ..spec.bodies[first].clone()
        };
        body.lattice.refine = RefineSpec::Auto(RefineAuto::None);
        for &part in parts {
            body.fixed.extend(fixed_in_world(&spec.bodies[part], part)?);
        }
        if !body.regions.is_empty() {
            let reason = "a part with regions of another material cannot be merged: their places are those of its frame";
            return Err(SceneError::one(format!("body[{first}].region"), reason));
        }
        if body.motion.is_some() || body.carried_by.is_some() || body.free {
            let reason = "a body that moves by itself, is carried or is free cannot be merged: its surface is elsewhere than in the scene";
            return Err(SceneError::one(format!("body[{first}]"), reason));
        }
        let (mut bodies, mut origins) = (Vec::new(), Vec::new());
        for (from, old) in spec.bodies.iter().enumerate() {
            if from == first {
                bodies.push(body.clone());
                origins.push(Origin::New);
            } else if !is_part(from) {
                bodies.push(old.clone());
                origins.push(Origin::kept(from));
            }
        }
        let names: Vec<&str> = parts
            .iter()
            .map(|&part| spec.bodies[part].id.as_str())
            .collect();
        let contacts = renamed(&spec.contacts, &names, id);
        let next = SceneSpec {
            bodies,
            contacts,
            ..spec
        };
        Ok(Self::new(scene, next, origins))
    }

    /// A body may become a part: it is rigid, and stands where the scene says.
    ///
    /// # Errors
    /// It deforms, moves, is carried or is free.
    pub fn check_part(scene: &Scene, body: usize) -> Result<(), SceneError> {
        let spec = &scene.spec.bodies[body];
        let id = &spec.id;
        let reason = if scene.deforms(body) {
            format!(
                "{id:?} deforms, and a part is rigid: nothing would be left of its material; give it model = \"rigid\" first"
            )
        } else if spec.motion.is_some() || spec.carried_by.is_some() || spec.free {
            format!(
                "{id:?} moves by itself, is carried or is free, so that it is elsewhere than in the scene; truncate it as a \
                 file: palpate surface truncate"
            )
        } else {
            return Ok(());
        };
        Err(SceneError::one(format!("body[{body}]"), reason))
    }

    /// The scene with parts in the place of bodies: their indices, and STEP files of the parts where they stand in the
    /// world.
    ///
    /// # Errors
    /// Bodies that may not become parts.
    pub fn truncated(scene: &Scene, parts: [(usize, String); 2]) -> Result<Self, SceneError> {
        let mut spec = pinned(scene)?;
        let mut origins = all_kept(&spec);
        for (index, text) in parts {
            Self::check_part(scene, index)?;
            let body = &mut spec.bodies[index];
            body.surface = SurfaceSpec {
                inline: Some(serde_json::json!({ STEP: text })),
                ..SurfaceSpec::default()
            };
            body.pose = PoseSpec::default();
            body.model = Some(ModelSpec::Rigid);
            origins[index] = Origin::New;
        }
        Ok(Self::new(scene, spec, origins))
    }

    /// True when the bodies that stay have the same coordinates in both scenes.
    pub fn fits(&self, old: &Scene, new: &Scene) -> bool {
        let count = |scene: &Scene, body: usize| {
            scene
                .deformable(body)
                .map(|lattice| lattice.coordinate_count())
        };
        self.origins
            .iter()
            .enumerate()
            .all(|(body, origin)| match *origin {
                Origin::Kept { from, .. } => count(old, from) == count(new, body),
                Origin::Piece { .. } | Origin::New => true,
            })
    }
}

/// From a body's frame to the world.
pub(super) fn placement(pose: &PoseSpec) -> Pose {
    let [x, y, z, w] = pose.orientation;
    let rotation = Rotation::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
    Pose::from_parts(Vector3::from(pose.position).into(), rotation)
}

/// The file of a scene with every automatic refinement written out: it looks at all tools and
/// bodies, and those that stay must come out as they are.
pub(super) fn pinned(scene: &Scene) -> Result<SceneSpec, SceneError> {
    let mut spec = scene.spec.clone();
    for (b, body) in spec.bodies.iter_mut().enumerate() {
        let automatic = matches!(
            body.lattice.refine,
            RefineSpec::Auto(RefineAuto::Auto) | RefineSpec::Focus { .. }
        );
        if scene.deforms(b) && automatic {
            let nowhere = Path::new("");
            let door = Door::new(&nowhere);
            let at = door.top().key("body").entry(b).key("surface");
            let coarse = body.surface.surface(&at);
            drop(at);
            let coarse = door.close(coarse)?;
            let Some(fine) = scene.rest_surface(b) else {
                continue;
            };
            let [u, v] = [
                (coarse.knots_u(), fine.knots_u()),
                (coarse.knots_v(), fine.knots_v()),
            ]
            .map(inserted);
            body.lattice.refine = RefineSpec::Knots { u, v };
        }
    }
    Ok(spec)
}

/// Knots of the second vector that the first does not have, ascending.
fn inserted((coarse, fine): (&KnotVector, &KnotVector)) -> Vec<f64> {
    let mut old = coarse.file_knots().iter().peekable();
    let new = fine
        .file_knots()
        .iter()
        .filter(|&knot| old.next_if_eq(&knot).is_none());
    new.copied().collect()
}

/// A surface as it stands in a scene file.
pub(super) fn inline(surface: &Surface) -> Result<SurfaceSpec, SceneError> {
    let text = file::write(surface, file::Unit::Metre);
    let mut document: serde_json::Value =
        serde_json::from_str(&text).map_err(|e| SceneError::one("surface", e))?;
    // TOML, as which recordings keep the scene, has no null; absent says the same.
    if let Some(fields) = document.as_object_mut() {
        fields.retain(|_, value| !value.is_null());
    }
    Ok(SurfaceSpec {
        inline: Some(document),
        ..SurfaceSpec::default()
    })
}

/// Planes that hold a body, in the world; ranges of parameters say nothing on another surface.
fn fixed_in_world(body: &BodySpec, index: usize) -> Result<Vec<FixedSpec>, SceneError> {
    let placement = placement(&body.pose);
    let planes = body.fixed.iter().enumerate().map(|(k, fixed)| match fixed {
        FixedSpec::Plane { point, normal } => Ok(FixedSpec::Plane {
            point: (placement * Point3::from(*point)).into(),
            normal: (placement * Vector3::from(*normal)).into(),
        }),
        FixedSpec::Range { .. } => {
            let reason =
                "a range of parameters says nothing on the merged surface; fix the part by a plane";
            Err(SceneError::one(format!("body[{index}].fixed[{k}]"), reason))
        }
    });
    planes.collect()
}

/// Exceptions for contacts, with the merged body in the place of its parts. Among the parts none is
/// left; the first of several that now speak of the same pair counts.
fn renamed(contacts: &[ContactSpec], parts: &[&str], id: &str) -> Vec<ContactSpec> {
    let mut out: Vec<ContactSpec> = Vec::new();
    for contact in contacts {
        let pair = contact.pair.clone().map(|name| {
            if parts.contains(&name.as_str()) {
                id.to_owned()
            } else {
                name
            }
        });
        let inner = pair[0] == id && pair[1] == id && contact.pair[0] != contact.pair[1];
        if !inner && out.iter().all(|held| held.pair != pair) {
            out.push(ContactSpec {
                pair,
                ..contact.clone()
            });
        }
    }
    out
}

impl Scene {
    /// The surface of a body as it stands, m, in the world; `points` are its control points. `None` of a part.
    ///
    /// # Errors
    /// Not as many points as the body has, or one that no surface can have.
    pub fn surface_with(
        &self,
        body: usize,
        points: &[Point3],
    ) -> Result<Option<Surface>, SurfaceError> {
        let Some(mut surface) = self.rest_surface(body).cloned() else {
            return Ok(None);
        };
        let (rows, columns) = (surface.net().rows(), surface.net().columns());
        *surface.net_mut() = ControlNet::new(rows, columns, points.to_vec())?;
        Ok(Some(surface))
    }
}
