//! The pieces that a plane makes of a body that deforms, in its place.

use super::Edited;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::cut::{Cut, CutPlane, Piece, PieceSkin, SkinSpec, cut_by_plane};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::Surface;
use palpate_sim::scene::{Scene, SceneChange};
use serde_json::{Value, json};
use std::time::Instant;

/// Fewest control points of a piece around, and from pole to pole.
const FEWEST: usize = 8;
/// From pole to pole: so many with [`NEXT_EDGE`] for each sharp edge on the way.
const FIRST_EDGE: usize = 4;
const NEXT_EDGE: usize = 3;

/// A piece of one of the cuts.
struct Kept<'a> {
    cut: &'a Cut,
    piece: usize,
}

/// Cuts a body as it stands: `surface` is its surface, `coordinates` those of its nodes, of the same tick. With a kerf, what
/// is between two planes is lost.
pub(super) fn cut(
    scene: &Scene,
    body: usize,
    surface: &Surface,
    coordinates: &[Point3],
    plane: &CutPlane,
    kerf_m: f64,
) -> Result<Edited, String> {
    // Before the work is done.
    SceneChange::check_cut(scene, body).map_err(|e| e.to_string())?;
    let id = scene.body_id(body);
    let cuts = timed("cut by a plane", || cuts(surface, plane, kerf_m))?;
    let kept = kept(&cuts);
    let skins = timed("surfaces of the pieces", || {
        skins(scene, body, coordinates, &kept)
    })?;
    let surfaces: Vec<Surface> = skins.iter().map(|skin| skin.surface.clone()).collect();
    let change = timed("the scene of the pieces", || {
        SceneChange::cut(scene, body, &surfaces, share_kept(&cuts, &kept))
    })
    .map_err(|e| e.to_string())?;
    let ids = (change.spec.bodies.iter().map(|body| body.id.as_str()))
        .filter(|id| scene.body_index(id).is_none());
    let pieces: Vec<Value> = (ids.zip(&kept).zip(&skins))
        .map(|((id, kept), skin)| told(id, kept, skin))
        .collect();
    let report = json!({
        "pieces": pieces,
        "lost": lost_m3(&cuts, &kept),
        "plane": { "point": xyz(&plane.origin()), "normal": <[f64; 3]>::from(plane.normal) },
    });
    Ok(Edited {
        what: format!("cut {id} into {} pieces", kept.len()),
        change: Some(change),
        report,
    })
}

/// One cut, or with a kerf one at each of its sides: what is above of the first, and what is below of the last, is left.
fn cuts(surface: &Surface, plane: &CutPlane, kerf_m: f64) -> Result<Vec<Cut>, String> {
    let sides = [0.5, -0.5].map(|side| CutPlane {
        offset_m: plane.offset_m + side * kerf_m,
        ..*plane
    });
    let planes = if kerf_m > 0.0 {
        &sides[..]
    } else {
        &sides[..1]
    };
    let cut = |plane| cut_by_plane(surface, plane).map_err(|e| e.to_string());
    planes.iter().map(cut).collect()
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

/// Each piece as one surface at rest.
fn skins(
    scene: &Scene,
    body: usize,
    coordinates: &[Point3],
    kept: &[Kept<'_>],
) -> Result<Vec<PieceSkin>, String> {
    let id = scene.body_id(body);
    let rest = scene.rest_surface(body);
    let (Some(rest), Some(standing)) = (rest, scene.standing(body, coordinates)) else {
        return Err(format!(
            "where the matter of {id:?} is at rest is not known"
        ));
    };
    let skin = |(k, Kept { cut, piece }): (usize, &Kept<'_>)| {
        let spec = SkinSpec {
            counts: counts(rest, cut, *piece),
            ..SkinSpec::default()
        };
        let skin = timed("surface of a piece", || {
            cut.skin(*piece, rest, &mut |now| standing.at_rest(now), &spec)
        });
        skin.map_err(|e| format!("piece {} of {id:?}: {e}", k + 1))
    };
    kept.iter().enumerate().map(skin).collect()
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
    knots
        .file_knots()
        .chunk_by(|a, b| a == b)
        .filter(inner)
        .count()
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
}

/// A piece for the client: of the cut as the body stood, but its net.
fn told(id: &str, kept: &Kept<'_>, skin: &PieceSkin) -> Value {
    let piece = kept.piece();
    let net = skin.surface.net();
    json!({
        "id": id,
        "above": piece.above,
        "volume": piece.volume_m3,
        "cap_area": piece.cap_area_m2,
        "centroid": xyz(&piece.centroid),
        "off": skin.off_m,
        "creases": skin.creases,
        "rims": skin.rims,
        "net": [net.rows(), net.columns()],
    })
}

fn xyz(point: &Point3) -> [f64; 3] {
    point.coords.into()
}

/// Does it, and says how long it took.
fn timed<T>(stage: &str, work: impl FnOnce() -> T) -> T {
    let begun = Instant::now();
    let made = work();
    tracing::debug!(stage, took_s = begun.elapsed().as_secs_f64(), "cutting");
    made
}
