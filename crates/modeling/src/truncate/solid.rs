//! What is left of the bodies, as parts.

use super::fields::Fields;
use super::kept::regions;
use super::rim::Rim;
use super::wall::Wall;
use super::{TruncateError, Truncated, WallPiece};
use palpate_geometry::math::{Point3, Random, Vector3};
use palpate_geometry::part::{
    Brep, BrepBound, BrepCurve, BrepEdge, BrepFace, BrepShell, Carrier, Part, PartSolver,
};
use palpate_geometry::surface::Surface;

/// Places in both bodies that are compared with the parts.
const COMPARED: usize = 96;
/// Places in the common box that are tried for that.
const TRIED: usize = 4000;

/// Both parts, measured and compared with the signed distances.
pub(super) fn truncated(
    fields: &mut Fields<'_>,
    rims: &[Rim],
    walls: &[Wall],
    tolerance_m: f64,
) -> Result<Truncated, TruncateError> {
    let bodies = fields.surfaces;
    let mut common = Shape::new(fields, bodies, rims, walls);
    common.regions = [0, 1].map(|body| regions(fields, body, rims));
    let breps = [0, 1].map(|body| common.left(body));
    let [a, b] = breps.each_ref().map(Part::new);
    let part =
        |part: Result<Part, _>, body| part.map_err(|source| TruncateError::Part { body, source });
    let parts = [part(a, 0)?, part(b, 1)?];
    let both = part(Part::new(&common.both()), 0)?;
    let off_m = walls
        .iter()
        .fold(tolerance_m, |most, wall| most.max(wall.off_m));
    compare(fields, &parts, off_m)?;
    let volume = |part: &Part| part.measure().volume_m3.unwrap_or(f64::NAN);
    Ok(Truncated {
        walls: walls.iter().map(piece).collect(),
        tolerance_m,
        before_m3: [
            fields.surfaces[0].volume(),
            fields.surfaces[1].volume(),
            volume(&both),
        ],
        volumes_m3: [volume(&parts[0]), volume(&parts[1])],
        breps,
        parts,
    })
}

fn piece(wall: &Wall) -> WallPiece {
    let net = wall.surface.net();
    WallPiece {
        rims: wall.rims.len(),
        net: [net.rows(), net.columns()],
        uneven_m: wall.uneven_m,
        off_m: wall.off_m,
    }
}

/// What all the parts are made of.
struct Shape<'a> {
    surfaces: [&'a Surface; 2],
    walls: &'a [Wall],
    /// By wall: its normal S_u × S_v points to where φ_A > φ_B.
    outwards: Vec<bool>,
    /// One for each rim, closed.
    edges: Vec<BrepEdge>,
    vertices: Vec<Point3>,
    /// By rim: the edge goes along n_A × n_B.
    along: Vec<bool>,
    /// By body: rims by regions of its surface that are left.
    regions: [Vec<Vec<usize>>; 2],
}

impl<'a> Shape<'a> {
    fn new(
        fields: &mut Fields<'_>,
        surfaces: [&'a Surface; 2],
        rims: &[Rim],
        walls: &'a [Wall],
    ) -> Self {
        let mut found: Vec<_> = walls.iter().flat_map(|wall| &wall.rims).collect();
        found.sort_by_key(|(rim, ..)| *rim);
        debug_assert_eq!(found.len(), rims.len(), "each rim ends one wall");
        let edges = found.iter().enumerate().map(|(k, (_, rim, _))| BrepEdge {
            id: k as u64 + 1,
            curve: BrepCurve::Spline(rim.curve.clone()),
            ends: [k as u32; 2],
            along: true,
        });
        let outwards = walls.iter().map(|wall| {
            let (point, normal) = (wall.surface.point(0.5, 0.5), wall.surface.normal(0.5, 0.5));
            normal.dot(&fields.at(&point).slope()) > 0.0
        });
        Self {
            surfaces,
            walls,
            outwards: outwards.collect(),
            edges: edges.collect(),
            vertices: found
                .iter()
                .map(|(_, rim, _)| rim.curve.point(0.0))
                .collect(),
            along: found.iter().map(|(.., along)| *along).collect(),
            regions: Default::default(),
        }
    }

    /// A closed loop along a rim, or the other way.
    fn bound(&self, rim: usize, along: bool) -> BrepBound {
        BrepBound::Loop(vec![(rim as u32, along == self.along[rim])])
    }

    /// The face on a body's surface. Who walks along n_A × n_B has what is outside the other body on the left on B, and on
    /// the right on A.
    fn face(&self, body: usize, id: u64, rims: &[usize], outside: bool) -> BrepFace {
        let surface = self.surfaces[body];
        let bounds = rims
            .iter()
            .map(|&rim| self.bound(rim, (body == 1) == outside));
        BrepFace {
            id,
            // A face says itself on which side of the parametrisation it looks.
            carrier: Carrier::Spline(Box::new(surface.clone().with_flip_normal(false))),
            same_sense: !surface.flip_normal(),
            bounds: bounds.collect(),
        }
    }

    /// A′ or B′.
    fn left(&self, body: usize) -> Brep {
        let regions = self.regions[body].iter().enumerate();
        let mut faces: Vec<BrepFace> = regions
            .map(|(k, rims)| self.face(body, k as u64 + 1, rims, true))
            .collect();
        for (wall, outwards) in self.walls.iter().zip(&self.outwards) {
            let bounds = wall
                .rims
                .iter()
                .map(|(rim, ..)| self.bound(*rim, body == 0));
            faces.push(BrepFace {
                id: faces.len() as u64 + 1,
                carrier: Carrier::Spline(Box::new(wall.surface.clone())),
                same_sense: *outwards == (body == 0),
                bounds: bounds.collect(),
            });
        }
        self.brep(faces)
    }

    /// What both bodies have.
    fn both(&self) -> Brep {
        let rims: Vec<usize> = (0..self.edges.len()).collect();
        self.brep(
            [0, 1]
                .map(|body| self.face(body, body as u64 + 1, &rims, false))
                .into(),
        )
    }

    fn brep(&self, faces: Vec<BrepFace>) -> Brep {
        Brep {
            vertices: self.vertices.clone(),
            edges: self.edges.clone(),
            shells: shells(&faces, self.edges.len()),
            faces,
            uncertainty_m: 0.0,
        }
    }
}

/// Faces that share edges: a solid each.
fn shells(faces: &[BrepFace], edges: usize) -> Vec<BrepShell> {
    let mut body: Vec<usize> = (0..faces.len()).collect();
    let mut first = vec![None; edges];
    for (k, face) in faces.iter().enumerate() {
        for bound in &face.bounds {
            let BrepBound::Loop(uses) = bound else {
                continue;
            };
            for (edge, _) in uses {
                let other = *first[*edge as usize].get_or_insert(k);
                let [old, new] = [body[k].max(body[other]), body[k].min(body[other])];
                body.iter_mut()
                    .filter(|b| **b == old)
                    .for_each(|b| *b = new);
            }
        }
    }
    let mut names = body.clone();
    names.sort_unstable();
    names.dedup();
    let shell = |(solid, name): (usize, &usize)| BrepShell {
        faces: (0..faces.len() as u32)
            .filter(|&f| body[f as usize] == *name)
            .collect(),
        closed: true,
        solid: Some(solid as u32),
    };
    names.iter().enumerate().map(shell).collect()
}

/// Places in both bodies, farther from the wall than it may be off, are in the part of the body in which they are deeper.
fn compare(fields: &mut Fields<'_>, parts: &[Part; 2], off_m: f64) -> Result<(), TruncateError> {
    let mut solvers = parts.each_ref().map(PartSolver::new);
    let corners = fields.surfaces.map(|surface| {
        let points = surface.net().points();
        let far = (points[0], points[0]);
        points
            .iter()
            .fold(far, |(low, high), p| (low.inf(p), high.sup(p)))
    });
    let (low, high) = (
        corners[0].0.sup(&corners[1].0),
        corners[0].1.inf(&corners[1].1),
    );
    let mut random = Random(1);
    let (mut wrong, mut compared) = (0, 0);
    for _ in 0..TRIED {
        let share = Vector3::from_fn(|_, _| random.unit());
        let q = low + (high - low).component_mul(&share);
        let depths = fields.at(&q);
        // The difference of two distances grows by two at most.
        let near_m = (2.0 * off_m).max(1e-6 * fields.size_m);
        if !depths.in_both() || depths.lead().abs() <= 2.0 * near_m || depths.mean() > -near_m {
            continue;
        }
        compared += 1;
        let deeper = usize::from(depths.lead() > 0.0);
        let inside = |k: usize, solvers: &mut [PartSolver; 2]| {
            let foot = solvers[k].closest(&parts[k], &q);
            foot.and_then(|foot| foot.signed_distance)
                .is_some_and(|d| d < 0.0)
        };
        let right = inside(deeper, &mut solvers) && !inside(1 - deeper, &mut solvers);
        wrong += usize::from(!right);
        if compared == COMPARED {
            break;
        }
    }
    match wrong {
        0 => Ok(()),
        _ => Err(TruncateError::Undivided { wrong, compared }),
    }
}
