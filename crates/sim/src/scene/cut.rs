//! A body cut by a plane while it runs: its pieces take its place, as bodies like it.
//!
//! ```text
//! surface as it stands, plane ─▶ pieces ─▶ their boundaries at rest, as closed surfaces ─▶ SceneSpec with a body for each
//! ```
//! A piece has cells of its own, of the shape of its boundary, and takes over the motion of the matter that was there:
//! [`CarryOver`](crate::tick::CarryOver). Pieces of a membrane are open surfaces, and have no boundary but their rims.

use super::change::{Origin, SceneChange, inline, pinned, placement};
use super::cut_sheet::CutMembrane;
use super::door::{Door, SceneError};
use super::model::material_of;
use super::spec::{
    BodySpec, BuilderSpec, ContactMethod, ContactSpec, FixedSpec, IntegratorSpec, LatticeSpec,
    ModelSpec, RefineAuto, RefineSpec, SceneSpec,
};
use super::{Body, Scene, Tool, model};
use crate::body::Deformed;
use crate::side_by_side::side_by_side;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::cut::{
    Cut, CutError, CutPlane, Piece, PieceSkin, PieceSkinError, SkinSpec, cut_by_plane,
};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{Surface, SurfaceError};
use std::path::Path;
use std::sync::Arc;

/// Fewest control points of a piece around, and from pole to pole.
const FEWEST: usize = 8;
/// From pole to pole: so many with [`NEXT_EDGE`] for each sharp edge on the way.
const FIRST_EDGE: usize = 4;
const NEXT_EDGE: usize = 3;
/// A surface that misses its piece by more than this, relative to the piece's size, is made once more with a finer net.
const FAR: f64 = 1e-2;
/// Times the control points in each direction that a finer net has, and how many it has at most.
const FINER: f64 = 1.5;
const MOST: usize = 36;
/// A surface that misses its piece by more than this, relative to the piece's size, is refused.
const FARTHEST: f64 = 0.06;
/// Nodes of a piece along each axis of a cube at least, where the body has as many.
const FEWEST_NODES: usize = 4;
/// Characters of an id at most.
const LONGEST_ID: usize = 64;

/// Why a body of a scene was not cut.
#[derive(Debug, thiserror::Error)]
pub enum SceneCutError {
    /// A body that cannot be cut, or a scene that cannot be.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Control points that no surface can have.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// The plane misses the body, or how it cuts it is not clear.
    #[error("body {body:?}: {error}")]
    Cut {
        /// Its id.
        body: String,
        /// Why.
        error: CutError,
    },
    /// A piece without a surface of its own.
    #[error("piece {piece} of body {body:?}: {error}")]
    Piece {
        /// From 1.
        piece: usize,
        /// The body's id.
        body: String,
        /// Why.
        error: PieceSkinError,
    },
    /// A shape that no net of a few hundred points has.
    #[error(
        "the surface of piece {piece} of body {body:?} would be {off_m:.2e} m off, of a size of {size_m:.2e} m: move the plane, or \
         refine the body's net"
    )]
    Off {
        /// From 1.
        piece: usize,
        /// The body's id.
        body: String,
        /// m.
        off_m: f64,
        /// Root of the piece's area, m.
        size_m: f64,
    },
    /// All cells are flat.
    #[error(
        "the cells of body {body:?} have no volume as it stands: nothing says where its matter is at rest"
    )]
    NoVolume {
        /// Its id.
        body: String,
    },
}

/// A piece of a body in the next scene.
#[derive(Clone, Debug)]
pub struct BodyPiece {
    /// Its id there.
    pub id: String,
    /// As it was cut.
    pub piece: Piece,
    /// Its boundary at rest.
    pub skin: PieceSkin,
}

/// A body that was cut.
#[derive(Clone, Debug)]
pub struct SceneCut {
    /// The next scene.
    pub change: SceneChange,
    /// Those above the plane first.
    pub pieces: Vec<BodyPiece>,
    /// What was in the kerf, m³; of a membrane, as of its pieces, area times thickness.
    pub lost_m3: f64,
}

/// What is cut, and how its pieces come to their surfaces at rest.
enum Matter {
    Solid(Deformed),
    Membrane(CutMembrane),
}

/// A piece of one of the cuts.
struct Kept<'a> {
    cut: &'a Cut,
    piece: usize,
}

impl SceneCut {
    /// Cuts a body as it stands: `points` are its control points and `coordinates` what [`SceneState::coordinates`] gives,
    /// m, of the same tick. With a kerf, what is between two planes so far apart is lost, and pieces touch each other;
    /// without, they lie on each other from the start, and do not.
    ///
    /// [`SceneState::coordinates`]: crate::tick::SceneState::coordinates
    ///
    /// # Errors
    /// A body that is neither a solid nor a membrane, a plane that misses it, pieces with holes through them.
    pub fn new(
        scene: &Scene,
        body: usize,
        (points, coordinates): (&[Point3], &[Point3]),
        plane: &CutPlane,
        kerf_m: f64,
    ) -> Result<Self, SceneCutError> {
        check_cut(scene, body)?;
        let id = || scene.body_id(body).to_owned();
        let no_volume = || SceneCutError::NoVolume { body: id() };
        let surface = scene.surface_with(body, points)?.ok_or_else(no_volume)?;
        let rest = scene.rest_surface(body).ok_or_else(no_volume)?;
        let matter = match CutMembrane::of(scene, body) {
            Some(membrane) => Matter::Membrane(membrane),
            None => {
                let deformable = scene.deformable(body).ok_or_else(no_volume)?;
                Matter::Solid(Deformed::new(deformable, coordinates).ok_or_else(no_volume)?)
            }
        };
        let cuts = cuts(&surface, plane, kerf_m, &matter)
            .map_err(|error| SceneCutError::Cut { body: id(), error })?;
        let kept = kept(&cuts);
        let mut skins = Vec::new();
        let made = side_by_side(kept.len(), |k| kept[k].skin(rest, &matter));
        for (k, skin) in made.into_iter().enumerate() {
            let skin = skin.map_err(|error| SceneCutError::Piece {
                piece: k + 1,
                body: id(),
                error,
            })?;
            let size_m = kept[k].size_m();
            if skin.off_m > FARTHEST * size_m {
                return Err(SceneCutError::Off {
                    piece: k + 1,
                    body: id(),
                    off_m: skin.off_m,
                    size_m,
                });
            }
            skins.push(skin);
        }
        let surfaces: Vec<&Surface> = skins.iter().map(|skin| &skin.surface).collect();
        let (change, ids) = SceneChange::cut(scene, body, &surfaces, share_kept(&cuts, &kept))?;
        let pieces = ids.into_iter().zip(&kept).zip(skins);
        Ok(Self {
            lost_m3: lost_m3(&cuts, &kept),
            pieces: pieces
                .map(|((id, kept), skin)| BodyPiece {
                    id,
                    piece: kept.piece().clone(),
                    skin,
                })
                .collect(),
            change,
        })
    }
}

/// A body may be cut: it is a solid that deforms, or a membrane.
///
/// # Errors
/// It is rigid or a thick sheet, or something holds it that is not known of its pieces.
fn check_cut(scene: &Scene, body: usize) -> Result<(), SceneError> {
    let spec = &scene.spec.bodies[body];
    let id = &spec.id;
    let at = format!("body[{body}]");
    if !scene.deforms(body) {
        let reason = format!(
            "{id:?} is rigid, and a cut goes through bodies that deform; cut it as a file (palpate surface cut), or give it a \
             model that deforms"
        );
        return Err(SceneError::one(at, reason));
    }
    let closed = scene
        .rest_surface(body)
        .is_some_and(|surface| surface.topology().is_closed());
    if spec.model() != ModelSpec::Membrane && !closed {
        let reason = format!(
            "{id:?} is an open surface with a thickness, and only solids and membranes are cut: use a closed surface, or \
             model = \"membrane\""
        );
        return Err(SceneError::one(at, reason));
    }
    let range = |fixed: &FixedSpec| matches!(fixed, FixedSpec::Range { .. });
    if let Some(k) = spec.fixed.iter().position(range) {
        let reason =
            "a range of parameters says nothing on the surfaces of pieces; fix the body by a plane";
        return Err(SceneError::one(format!("{at}.fixed[{k}]"), reason));
    }
    Ok(())
}

impl SceneChange {
    /// The scene with pieces in the place of a body, given by their surfaces at rest, m, in the world; and the ids of the pieces,
    /// which are the body's with numbers. `kept` is the share of the body's volume that they are to have together: their
    /// density makes up for what their surfaces miss of it. Where all is kept, pieces do not touch each other, since they lie on
    /// each other from the start.
    ///
    /// # Errors
    /// A body that may not be cut, ids that are too long.
    pub fn cut(
        scene: &Scene,
        body: usize,
        pieces: &[&Surface],
        kept: f64,
    ) -> Result<(Self, Vec<String>), SceneError> {
        check_cut(scene, body)?;
        let mut spec = pinned(scene)?;
        let whole = spec.bodies.remove(body);
        let ids = numbered(&whole.id, pieces.len(), &spec)?;
        let membrane = CutMembrane::of(scene, body);
        let volume = |surface: &Surface| match &membrane {
            Some(membrane) => membrane.volume_m3(surface),
            None => surface.volume().abs(),
        };
        let enclosed = scene.rest_surface(body).map_or(0.0, volume);
        let denser = kept * enclosed / pieces.iter().map(|surface| volume(surface)).sum::<f64>();
        let mut made = Vec::new();
        for (id, surface) in ids.iter().zip(pieces) {
            let mut piece = piece(&whole, id, surface, denser)?;
            if piece.lattice.builder != BuilderSpec::Layers {
                let share = (volume(surface) / enclosed).min(1.0);
                piece.lattice.nodes = nodes_of(whole.lattice.nodes, share);
            }
            made.push(piece);
        }
        spec.bodies.splice(body..body, made);
        let origins = (0..scene.body_count()).flat_map(|from| match from == body {
            true => vec![Origin::Piece { from }; pieces.len()],
            false => vec![Origin::kept(from)],
        });
        let origins = origins.collect();
        spec.contacts = of_each(&spec.contacts, &whole.id, &ids);
        if kept >= 1.0 {
            spec.contacts.extend(apart(&ids));
        }
        let mut change = Self::new(scene, spec, origins);
        change.make_pieces(scene, body, pieces.len())?;
        Ok((change, ids))
    }

    /// Builds pieces, the first of which is a body of the next scene, side by side.
    fn make_pieces(&mut self, scene: &Scene, first: usize, count: usize) -> Result<(), SceneError> {
        let made = side_by_side(count, |k| made_piece(scene, &self.spec, first + k));
        for (k, made) in made.into_iter().enumerate() {
            let (spec, body) = made?;
            self.spec.bodies[first + k] = spec;
            self.ready[first + k] = Some(Arc::new(body));
        }
        Ok(())
    }
}

/// A piece, with fewer layers or of springs where its shape leaves no other cells.
fn made_piece(
    scene: &Scene,
    next: &SceneSpec,
    body: usize,
) -> Result<(BodySpec, Body), SceneError> {
    let tools: Vec<Option<&Tool>> = scene.tools.iter().map(Some).collect();
    let whole = &next.bodies[body];
    let mut refused = None;
    for (model, layers) in instead(whole) {
        let mut spec = whole.clone();
        if model != whole.model() {
            spec.model = Some(model);
        }
        if model.model().deforms() {
            spec.lattice.layers = Some(layers);
        }
        let nowhere = Path::new("");
        let door = Door::new(&nowhere).with(scene.methods);
        let top = door.top();
        let at = top.key("body").entry(body);
        let made = model::build(next, &tools, &spec, &at, scene.dt_s);
        drop((at, top));
        match door.close(made) {
            Ok(made) => return Ok((spec, made)),
            // Springs, which are last, take all but what holds for any model.
            Err(error) => refused = Some(error),
        }
    }
    Err(refused.unwrap_or_else(|| SceneError::one(format!("body[{body}]"), "it has no model")))
}

/// What a piece may be, the best first: model and layers.
fn instead(piece: &BodySpec) -> Vec<(ModelSpec, usize)> {
    let (model, layers) = (piece.model(), piece.layers());
    if !matches!(model, ModelSpec::Continuum | ModelSpec::Net) {
        return vec![(model, layers)];
    }
    let fewest = match piece.lattice.builder {
        BuilderSpec::Layers => 1,
        _ => layers,
    };
    let fewer = (fewest..=layers).rev().map(|layers| (model, layers));
    // Springs take cells of any shape.
    fewer.chain([(ModelSpec::Lattice, layers)]).collect()
}

/// One cut, or with a kerf one at each of its sides: what is above of the first, and what is below of the last, is left.
fn cuts(
    surface: &Surface,
    plane: &CutPlane,
    kerf_m: f64,
    matter: &Matter,
) -> Result<Vec<Cut>, CutError> {
    let sides = [0.5, -0.5].map(|side| CutPlane {
        offset_m: plane.offset_m + side * kerf_m,
        ..*plane
    });
    let planes = if kerf_m > 0.0 {
        &sides[..]
    } else {
        &sides[..1]
    };
    (planes.iter())
        .map(|plane| match matter {
            Matter::Solid(_) => cut_by_plane(surface, plane),
            Matter::Membrane(membrane) => membrane.cut(surface, plane),
        })
        .collect()
}

/// The pieces that are left: those above first.
fn kept(cuts: &[Cut]) -> Vec<Kept<'_>> {
    let ends = [(cuts.first(), true), (cuts.last(), false)];
    let mut kept = Vec::new();
    for (cut, above) in ends {
        let Some(cut) = cut else { continue };
        let of_side = (0..cut.pieces.len()).filter(|&piece| cut.pieces[piece].above == above);
        kept.extend(of_side.map(|piece| Kept { cut, piece }));
    }
    kept
}

/// How many control points a piece gets around, and from pole to pole: as close together as those of the body, and enough
/// for the edges of its caps.
fn counts(rest: &Surface, cut: &Cut, piece: usize) -> [usize; 2] {
    let net = [rest.net().rows(), rest.net().columns()];
    // A torus, which has no poles, goes round both ways.
    let along = usize::from(rest.topology().poles[0] != [true; 2]);
    let whole_m2: f64 = cut.pieces.iter().map(|piece| piece.skin_area_m2).sum();
    let piece = &cut.pieces[piece];
    let share = ((piece.skin_area_m2 + piece.cap_area_m2) / whole_m2).sqrt();
    let edges = piece.rim_count() + creases([rest.knots_u(), rest.knots_v()][along]);
    let fewest = [FEWEST, FEWEST.max(FIRST_EDGE + NEXT_EDGE * edges)];
    [0, 1].map(|d| {
        let count = net[[1 - along, along][d]];
        let enough = (share * count as f64).ceil() as usize;
        enough.min(count).max(fewest[d])
    })
}

/// How many inner knots are creases of a surface, as those of former cuts are.
fn creases(knots: &KnotVector) -> usize {
    let (start, end) = knots.domain();
    let inner = |run: &&[f64]| run[0] > start && run[0] < end && run.len() >= knots.degree();
    let runs = knots.file_knots().chunk_by(|a, b| a == b);
    runs.filter(inner).count()
}

/// What was in the kerf, m³.
fn lost_m3(cuts: &[Cut], kept: &[Kept<'_>]) -> f64 {
    let [first, _] = cuts else { return 0.0 };
    let left: f64 = (kept.iter().map(|kept| kept.piece().volume_m3)).sum();
    whole_m3(first) - left
}

fn whole_m3(cut: &Cut) -> f64 {
    cut.pieces.iter().map(|piece| piece.volume_m3).sum()
}

/// The share of the body that is left: 1 without a kerf.
fn share_kept(cuts: &[Cut], kept: &[Kept<'_>]) -> f64 {
    match cuts {
        [first, _] => 1.0 - lost_m3(cuts, kept) / whole_m3(first),
        _ => 1.0,
    }
}

impl Kept<'_> {
    fn piece(&self) -> &Piece {
        &self.cut.pieces[self.piece]
    }

    /// Root of its area, m.
    fn size_m(&self) -> f64 {
        let piece = self.piece();
        (piece.skin_area_m2 + piece.cap_area_m2).sqrt()
    }

    /// Its boundary at rest as one surface.
    fn skin(&self, rest: &Surface, matter: &Matter) -> Result<PieceSkin, PieceSkinError> {
        let Self { cut, piece } = *self;
        let deformed = match matter {
            Matter::Solid(deformed) => deformed,
            Matter::Membrane(membrane) => return membrane.skin(cut, piece, rest),
        };
        let made = |counts: [usize; 2]| {
            let spec = SkinSpec {
                counts,
                ..SkinSpec::default()
            };
            cut.skin(piece, rest, &mut |now| deformed.at_rest(now), &spec)
        };
        let counts = counts(rest, cut, piece);
        let skin = made(counts)?;
        if skin.off_m <= FAR * self.size_m() {
            return Ok(skin);
        }
        let more = |count: usize| ((FINER * count as f64) as usize).min(MOST).max(count);
        Ok(match made(counts.map(more)) {
            Ok(finer) if finer.off_m < skin.off_m => finer,
            _ => skin,
        })
    }
}

/// Ids of the pieces of a body: its own, with the first numbers that are free.
fn numbered(id: &str, count: usize, spec: &SceneSpec) -> Result<Vec<String>, SceneError> {
    let taken = |name: &String| {
        let bodies = spec.bodies.iter().any(|body| &body.id == name);
        bodies || spec.tools.iter().any(|tool| &tool.id == name)
    };
    let ids: Vec<String> = (1..)
        .map(|k| format!("{id}-{k}"))
        .filter(|name| !taken(name))
        .take(count)
        .collect();
    match ids.iter().find(|name| name.len() > LONGEST_ID) {
        Some(long) => {
            let reason = format!(
                "the id of a piece, {long:?}, is longer than {LONGEST_ID} characters; give {id:?} a shorter one"
            );
            Err(SceneError::one("id", reason))
        }
        None => Ok(ids),
    }
}

/// A piece of a body, which has its model and material.
fn piece(
    whole: &BodySpec,
    id: &str,
    surface: &Surface,
    denser: f64,
) -> Result<BodySpec, SceneError> {
    let placement = placement(&whole.pose);
    let local = surface.placed(&placement.inverse());
    let local = local.map_err(|e| SceneError::one("surface", e))?;
    let mut body = BodySpec {
        id: id.to_owned(),
        surface: inline(&local)?,
        velocity_m_s: [0.0; 3],
        spin_rad_s: [0.0; 3],
        ..whole.clone()
    };
    let material = material_of(&whole.material);
    body.material.density_kg_m3 = material.map(|material| material.density_kg_m3 * denser);
    for region in &mut body.regions {
        region.density_kg_m3 = region.density_kg_m3.map(|density| density * denser);
    }
    // Planes that hold nothing of it are of other pieces, and what is held everywhere cannot deform.
    let points = local.net().points();
    let holds = |fixed: &FixedSpec, p: &Point3| match fixed {
        FixedSpec::Plane { point, normal } => {
            Vector3::from(*normal).dot(&(p - Point3::from(*point))) <= 0.0
        }
        FixedSpec::Range { .. } => false,
    };
    (body.fixed).retain(|fixed| points.iter().any(|p| holds(fixed, p)));
    let is_held = |p: &Point3| body.fixed.iter().any(|fixed| holds(fixed, p));
    if points.iter().all(is_held) {
        return Ok(BodySpec {
            model: Some(ModelSpec::Rigid),
            fixed: Vec::new(),
            regions: Vec::new(),
            lattice: LatticeSpec::default(),
            integrator: IntegratorSpec::default(),
            self_contact: false,
            ..body
        });
    }
    // An open sheet cannot say where it passes through itself.
    body.self_contact &= surface.topology().is_closed();
    body.lattice.refine = RefineSpec::Auto(RefineAuto::None);
    Ok(body)
}

/// Nodes along each axis for a share of a body's volume, in cells as large as the body's.
fn nodes_of(whole: [usize; 3], share: f64) -> [usize; 3] {
    let cells = |nodes: usize| (nodes - 1) as f64 * libm::cbrt(share);
    whole.map(|nodes| nodes.min(FEWEST_NODES.max(cells(nodes).ceil() as usize + 1)))
}

/// Exceptions for contacts, with each piece in the place of a body.
fn of_each(contacts: &[ContactSpec], id: &str, pieces: &[String]) -> Vec<ContactSpec> {
    let mut out = Vec::new();
    for contact in contacts {
        let names = |name: &String| match name == id {
            true => pieces.to_vec(),
            false => vec![name.clone()],
        };
        let [holders, bodies] = [0, 1].map(|k| names(&contact.pair[k]));
        for holder in &holders {
            let other = |body: &&String| contact.pair[0] != contact.pair[1] || *body == holder;
            out.extend(bodies.iter().filter(other).map(|body| ContactSpec {
                pair: [holder.clone(), body.clone()],
                ..contact.clone()
            }));
        }
    }
    out
}

/// No contact between any two.
fn apart(ids: &[String]) -> Vec<ContactSpec> {
    let pairs = (ids.iter().enumerate()).flat_map(|(k, a)| ids[..k].iter().map(move |b| [a, b]));
    let none = pairs.map(|pair| ContactSpec {
        pair: pair.map(Clone::clone),
        method: ContactMethod::None,
        resolution: None,
        friction: None,
        restitution: None,
        near_field: None,
    });
    none.collect()
}
