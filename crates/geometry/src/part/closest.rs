//! The closest point of a part, proved: the nearest of all edges, and of the feet on all faces that lie within their loops.
//!
//! A minimum of the distance to a trimmed face is either a minimum of the distance to its carrier, inside the loops, or on
//! an edge. So the certificate of the carriers carries over, and no bound has to know the loops.

use super::basins::{Feet, FootQuery, Known, SplineFace};
use super::carrier::Carrier;
use super::foot::{At, Best, PartFoot, Support, answer, nearest_wire};
use super::near::Near;
use super::part::Part;
use super::tree::Tree;
use crate::math::Point3;
use crate::surface::{ClosestPoint, ClosestSolver};

/// Closest-point queries on a part. Scratch: its answers depend on the arguments only.
#[derive(Clone, Debug)]
pub struct PartSolver {
    /// By face: for those on B-splines.
    pub(super) splines: Vec<Option<Box<ClosestSolver>>>,
    /// By face: for those on B-splines, what spares searches; none where nothing is known of neighbours either.
    pub(super) known: Vec<Option<Box<Known>>>,
    feet: Vec<ClosestPoint>,
    /// What is around each face and each vertex; of the part alone.
    pub(super) near: Near,
}

impl PartSolver {
    /// Scratch for a part.
    pub fn new(part: &Part) -> Self {
        let solver = |carrier: &Carrier| match carrier {
            Carrier::Spline(surface) => Some(Box::new(ClosestSolver::new(surface))),
            _ => None,
        };
        let mut splines: Vec<_> = (part.faces.iter())
            .map(|face| solver(&face.carrier))
            .collect();
        let known = |(k, solver): (usize, &mut Option<Box<ClosestSolver>>)| match (
            &part.faces[k].carrier,
            solver,
        ) {
            (Carrier::Spline(surface), Some(solver)) => {
                Some(Box::new(Known::new(part, k as u32, solver, surface)))
            }
            _ => None,
        };
        Self {
            near: Near::new(part),
            known: splines.iter_mut().enumerate().map(known).collect(),
            ..Self::with(splines)
        }
    }

    /// With the scratch of its B-splines, by face; it knows nothing of neighbours.
    pub(super) fn with(splines: Vec<Option<Box<ClosestSolver>>>) -> Self {
        Self {
            splines,
            known: Vec::new(),
            feet: Vec::with_capacity(super::basins::MOST_FEET),
            near: Near::default(),
        }
    }

    /// Pieces of B-splines that searches gave up so far.
    pub fn given_up(&self) -> u64 {
        let solvers = self.splines.iter().flatten();
        solvers.map(|solver| solver.pieces_given_up()).sum()
    }

    /// The closest point of a part; `part` is that of which the scratch was made. `None` where the query is not finite.
    pub fn closest(&mut self, part: &Part, q: &Point3) -> Option<PartFoot> {
        if !q.iter().all(|x| x.is_finite()) {
            return None;
        }
        let (best, certified) = self.search(part, q, None, None);
        best.map(|best| answer(part, q, &best, certified))
    }

    /// The closest point of some of a part's faces, which trees over edges and lone vertices and over faces hold.
    pub(super) fn closest_in(
        &mut self,
        part: &Part,
        trees: [&Tree; 2],
        q: &Point3,
    ) -> Option<PartFoot> {
        if !q.iter().all(|x| x.is_finite()) {
            return None;
        }
        let (best, certified) = nearest(part, q, Some(trees), self.scratch(), None, f64::INFINITY);
        best.map(|best| answer(part, q, &best, certified))
    }

    /// The nearest of a part, or of what is around one of its faces, and whether nothing can have been passed over. The seed is a
    /// place of the part to begin with, and whether its face has no nearer one.
    pub(super) fn search(
        &mut self,
        part: &Part,
        q: &Point3,
        around: Option<u32>,
        seed: Option<(Best, bool)>,
    ) -> (Option<Best>, bool) {
        let trees = around.map(|face| self.near.trees(face));
        let scratch = Scratch {
            splines: &mut self.splines,
            known: &mut self.known,
            feet: &mut self.feet,
            near: &self.near,
        };
        nearest(part, q, trees, scratch, seed, f64::INFINITY)
    }

    /// [`PartSolver::search`] of the whole part for what is nearer than the root of `most` (m²).
    pub(super) fn search_within(
        &mut self,
        part: &Part,
        q: &Point3,
        seed: Option<(Best, bool)>,
        most: f64,
    ) -> (Option<Best>, bool) {
        nearest(part, q, None, self.scratch(), seed, most)
    }

    /// The minima of the distance to the carrier of a B-spline face up to `within_m`, as far as they may be within its loops.
    /// True when none was left out.
    pub(super) fn minima_of(
        &mut self,
        part: &Part,
        k: u32,
        q: &Point3,
        within_m: f64,
        out: &mut Vec<ClosestPoint>,
    ) -> bool {
        let (Carrier::Spline(surface), Some(solver)) = (
            &part.faces[k as usize].carrier,
            &mut self.splines[k as usize],
        ) else {
            return true;
        };
        let on = Feet {
            face: SplineFace { part, k, surface },
            solver,
            own: self.near.has(k).then(|| self.near.own(k)),
            known: (self.known.get_mut(k as usize)).and_then(|known| known.as_deref_mut()),
        };
        let query = FootQuery {
            q,
            within_m,
            best: None,
        };
        on.find(&query, out)
    }

    fn scratch(&mut self) -> Scratch<'_> {
        Scratch {
            splines: &mut self.splines,
            known: &mut self.known,
            feet: &mut self.feet,
            near: &self.near,
        }
    }
}

/// What a search works with.
struct Scratch<'a> {
    splines: &'a mut [Option<Box<ClosestSolver>>],
    known: &'a mut [Option<Box<Known>>],
    feet: &'a mut Vec<ClosestPoint>,
    near: &'a Near,
}

/// The nearest of what trees over edges and lone vertices and over faces hold, or of all, as [`PartSolver::search`]: as far
/// as it is nearer than the root of `most` (m²).
fn nearest(
    part: &Part,
    q: &Point3,
    trees: Option<[&Tree; 2]>,
    Scratch {
        splines,
        known: basins,
        feet,
        near,
    }: Scratch<'_>,
    seed: Option<(Best, bool)>,
    most: f64,
) -> (Option<Best>, bool) {
    let [wires, skin] = trees.unwrap_or([&part.wires, &part.skin]);
    let mut best = seed.map(|(best, _)| best);
    nearest_wire(part, q, wires, &mut best);
    let mut ceiling = best.map_or_else(
        || {
            // A part of whole spheres and tori has no edge to begin with.
            let (low, high) = part.bounds();
            (q - low).sup(&(high - q)).norm_squared()
        },
        |best| best.squared,
    );
    ceiling = ceiling.min(most);
    let known = seed.and_then(|(best, known)| match best.support {
        Support::Face(k) if known => Some(k),
        _ => None,
    });
    let mut certified = true;
    let offer =
        |k: u32, point: Point3, uv: [f64; 2], ceiling: &mut f64, best: &mut Option<Best>| {
            let squared = (q - point).norm_squared();
            let nearer = squared < *ceiling && part.faces[k as usize].trim.contains(uv);
            if nearer {
                *ceiling = squared;
                *best = Some(Best {
                    point,
                    support: Support::Face(k),
                    at: At::Face(uv),
                    squared,
                });
            }
            nearer
        };
    skin.nearest(q, &mut ceiling, |k, ceiling| {
        if known == Some(k) {
            return;
        }
        let face = &part.faces[k as usize];
        match (&face.carrier, &mut splines[k as usize]) {
            (Carrier::Spline(surface), Some(solver)) => {
                let query = FootQuery {
                    q,
                    within_m: ceiling.sqrt(),
                    best: best.as_ref(),
                };
                let on = Feet {
                    face: SplineFace { part, k, surface },
                    solver,
                    own: near.has(k).then(|| near.own(k)),
                    known: basins
                        .get_mut(k as usize)
                        .and_then(|known| known.as_deref_mut()),
                };
                certified &= on.find(&query, feet);
                // Where the B-spline ends, an edge is as near.
                let inner = (feet.iter())
                    .filter(|foot| !face.carrier.is_on_rim(&face.rims, [foot.u, foot.v]));
                for foot in inner {
                    if offer(k, foot.point, [foot.u, foot.v], ceiling, &mut best) {
                        break;
                    }
                }
            }
            (carrier, _) => {
                if carrier.may_be_within(q, *ceiling)
                    && let Some(uv) = carrier.foot(q)
                {
                    offer(k, carrier.point(uv), uv, ceiling, &mut best);
                }
            }
        }
    });
    (best.filter(|best| best.squared <= most), certified)
}
