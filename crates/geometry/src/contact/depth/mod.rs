//! All places where a surface is deepest inside a solid that can only be asked for the depth of a
//! point.
//!
//! Pieces whose boxes the solid cannot reach are left out; the others are sampled. We climb from
//! each sample that is deeper than its neighbours, and from the ridges between samples whose ways
//! out differ (there depth has kinks, and its maxima often lie on them). Regions that lie wholly
//! between samples can be missed when no slope of the depth leads there; a sample is a [`GRID`]th
//! of a Bézier piece from the next.

mod climb;
mod golden;
mod part;
mod skin;
mod tops;

use self::climb::Map;
use self::golden::greatest;
pub(super) use self::skin::SkinDepths;
use self::tops::{Ground, Tops};

use super::exact::Patches;
use super::{Contact, ContactSet};
use crate::math::{Point3, Vector3};
use crate::surface::bezier::{Shares, shares};
use crate::surface::{BezierPieces, ClosestSolver, Surface};

/// Samples of a piece in each direction.
const GRID: usize = 8;
/// Climbs of one query.
const MOST_CLIMBS: usize = 64;
/// Ridges between samples that are looked at.
const MOST_RIDGES: usize = 48;
/// Tops at kinks that are made exact.
const MOST_FINISHED: usize = 12;
/// Sides that meet at a corner, and may have tops beside it.
const MOST_SIDES: usize = 3;
/// Depths this near to each other, of the size, are equal: where they are exact, and where they are
/// not yet.
const SAME: f64 = 1e-9;
const SAME_ROUGHLY: f64 = 1e-5;
/// Tops nearer to each other than this, of the size, on two sides of a joint are one.
const ONE_PLACE: f64 = 1e-5;
/// How far over a joint is looked, of the patch there, and how many of them a climb crosses.
const JUST_BEYOND: f64 = 1e-3;
const MOST_CROSSED: usize = 4;
/// Steps of golden section on a ridge: each leaves 0.62 of the way between two samples.
const SECTIONS: usize = 16;
/// Ways out that differ by more than 60° have a ridge between them.
const RIDGE: f64 = 0.5;

/// How fast a piece goes over its local parameters, at most, m: no faster than the differences of its Bézier points, of a
/// rational one about its middle.
fn slopes(pieces: &BezierPieces, piece: usize) -> [f64; 2] {
    let [p, q] = [pieces.u.degree, pieces.v.degree];
    let (points, bounds) = (pieces.points(piece), pieces.bounds(piece));
    let (middle, radius_m) = (
        nalgebra::center(&bounds.min, &bounds.max),
        0.5 * (bounds.max - bounds.min).norm(),
    );
    let away = |k: usize| {
        let [x, y, z, w] = points[k];
        (Vector3::new(x, y, z) - middle.coords * w, w)
    };
    let step_m = |from: usize, to: usize| {
        let ((a, v), (b, w)) = (away(from), away(to));
        (b - a).norm() + radius_m * (w - v).abs()
    };
    let along_u = (q + 1..points.len()).map(|k| step_m(k - q - 1, k));
    let along_v = (1..points.len())
        .filter(|k| k % (q + 1) > 0)
        .map(|k| step_m(k - 1, k));
    let least = points
        .iter()
        .fold(f64::INFINITY, |least, x| least.min(x[3]));
    let slope = |steps: f64, degree: usize| degree as f64 * steps / least;
    [
        slope(along_u.fold(0.0, f64::max), p),
        slope(along_v.fold(0.0, f64::max), q),
    ]
}

/// A solid, in world coordinates.
pub(super) trait DepthField {
    /// False only if the solid, grown by the margin asked for, keeps out of a box (centre, half
    /// extents).
    fn may_reach(&self, centre: &Point3, half: &Vector3) -> bool;
    /// Depth to first order, m, and the unit way out; cheap. −∞ where it means nothing.
    fn rough(&self, p: &Point3) -> (f64, Vector3);
    /// Where rough depths are those of a solid of which all points are no farther from this one than so much, m; `None` where
    /// they are not distances.
    fn rough_by_m(&self) -> Option<f64> {
        None
    }
    /// Depth, m, negative outside; −∞ where it means nothing.
    fn depth_m(&self, p: &Point3) -> f64;
    /// The smooth side from which the depth of a point counts, where it is known, and those after it, nearest first.
    fn side(&self, p: &Point3, after: usize) -> Option<usize>;
    /// How far a point is below a side that goes on beyond its edges, m.
    fn depth_below(&self, side: usize, p: &Point3) -> f64;
    /// All its edges are known: none is looked for.
    fn edges_known(&self) -> bool;
}

/// All of a surface.
struct Whole<'a>(&'a Surface);

impl Ground for Whole<'_> {
    fn point(&self, [u, v]: [f64; 2]) -> Point3 {
        self.0.point(u, v)
    }
}

/// Scratch against one surface, sized once. Nothing in it outlives a query.
#[derive(Clone, Debug)]
pub(super) struct DepthSearch {
    pub tops: Tops,
    pub patches: Patches,
    /// (pieces): the solid may reach into it.
    pub reached: Vec<bool>,
    /// Rows and columns of pieces.
    pieces: [usize; 2],
    /// (rows × GRID × columns × GRID): rough depth, m, and way out.
    samples: Vec<(f64, Vector3)>,
    /// Parameters of the samples in u and v.
    axes: [Vec<f64>; 2],
    /// Shares of a piece's rows and columns in each of its samples.
    shares: [[Shares; GRID]; 2],
    ridges: Shortlist<[[f64; 2]; 2], MOST_RIDGES>,
}

/// The deepest of what was offered, deepest first.
#[derive(Clone, Debug)]
pub(super) struct Shortlist<T, const MOST: usize>(Vec<(f64, T)>);

impl<T, const MOST: usize> Shortlist<T, MOST> {
    fn new() -> Self {
        Self(Vec::with_capacity(MOST))
    }

    fn clear(&mut self) {
        self.0.clear();
    }

    /// False when something found no room.
    pub fn offer(&mut self, depth_m: f64, what: T) -> bool {
        let at = self.0.partition_point(|held| held.0 >= depth_m);
        let full = self.0.len() == MOST;
        if at == MOST {
            return false;
        }
        if full {
            self.0.pop();
        }
        self.0.insert(at, (depth_m, what));
        !full
    }
}

impl DepthSearch {
    /// Makes room for the pieces of a surface.
    pub fn new(surface: &Surface, solver: &mut ClosestSolver) -> Self {
        let axes = [surface.knots_u(), surface.knots_v()].map(|knots| -> Vec<f64> {
            let t = knots.knots();
            knots
                .spans()
                .flat_map(|k| {
                    (0..GRID)
                        .map(move |m| t[k] + (t[k + 1] - t[k]) * (m as f64 + 0.5) / GRID as f64)
                })
                .collect()
        });
        let shares = [surface.knots_u(), surface.knots_v()].map(|knots| {
            let local = |m: usize| (m as f64 + 0.5) / GRID as f64;
            std::array::from_fn(|m| shares(knots.degree(), local(m)))
        });
        let pieces = axes.each_ref().map(|a| a.len() / GRID);
        Self {
            tops: Tops::new(
                Map::new(surface),
                surface.joints().map(Box::new),
                surface.size(),
                surface.size() / (GRID * pieces[0].min(pieces[1]).max(1)) as f64,
            ),
            patches: Patches::new(surface, solver),
            reached: vec![false; pieces[0] * pieces[1]],
            pieces,
            samples: vec![(0.0, Vector3::zeros()); axes[0].len() * axes[1].len()],
            axes,
            shares,
            ridges: Shortlist::new(),
        }
    }

    /// Fills `tops` with the local maxima of depth that are no farther outside than the margin; one
    /// of each set that a way of equal depth joins. On a side that is known, of which only those that are not at its edges;
    /// `beside`: contacts of these edges.
    pub fn search(
        &mut self,
        surface: &Surface,
        solver: &mut ClosestSolver,
        field: &impl DepthField,
        margin_m: f64,
        beside: &[Contact],
        out: &mut ContactSet,
    ) {
        self.tops.found.clear();
        self.prune(surface, solver, field);
        if !self.reached.contains(&true) {
            return;
        }
        self.sample(surface, solver, field, margin_m);
        let ground = Whole(surface);
        let depth = |x: [f64; 2]| field.depth_m(&ground.point(x));
        self.pick(margin_m, !field.edges_known(), depth, out);
        self.tops.climb_all(true, field, margin_m, beside, &ground);
        // Through the middle of the solid: there, no side is nearest, and none of its edges is in touch.
        let through = self.samples.iter().any(|(depth_m, _)| *depth_m > 0.0);
        let found =
            !self.tops.found.is_empty() || beside.iter().any(|contact| contact.depth_m >= 0.0);
        let by_sides = found || !through;
        if !by_sides {
            self.pick(margin_m, true, depth, out);
            self.tops.climb_all(false, field, margin_m, beside, &ground);
        }
        self.tops.finish(by_sides, field, &ground);
    }

    fn prune(&mut self, surface: &Surface, solver: &mut ClosestSolver, field: &impl DepthField) {
        let pieces = solver.pieces(surface);
        for k in 0..self.reached.len() {
            let bounds = pieces.bounds(k);
            let half = (bounds.max - bounds.min) * 0.5;
            self.reached[k] =
                !pieces.is_duplicate(k) && field.may_reach(&(bounds.min + half), &half);
        }
    }

    /// Of a solid that is known by distances, samples count from which a piece leads into it before the next.
    fn sample(
        &mut self,
        surface: &Surface,
        solver: &mut ClosestSolver,
        field: &impl DepthField,
        margin_m: f64,
    ) {
        let pieces = solver.pieces(surface);
        let columns = self.axes[1].len();
        let none = (f64::NEG_INFINITY, Vector3::zeros());
        let Self {
            samples, shares, ..
        } = self;
        for piece in 0..self.reached.len() {
            let (i, j) = (piece / self.pieces[1], piece % self.pieces[1]);
            let slot = |k: usize| (i * GRID + k / GRID) * columns + j * GRID + k % GRID;
            if !self.reached[piece] {
                (0..GRID * GRID).for_each(|k| samples[slot(k)] = none);
                continue;
            }
            let most_m = field.rough_by_m().map(|by_m| {
                let [along_u, along_v] = slopes(pieces, piece);
                by_m + margin_m + (along_u + along_v) * 0.5 / GRID as f64
            });
            let is_out = |depth_m: f64| most_m.is_some_and(|most_m| -depth_m > most_m);
            // The last depth that was asked for, and where: it changes by no more than the way.
            let mut last = (Point3::origin(), f64::INFINITY);
            let [us, vs] = &*shares;
            pieces.points_at(piece, [us, vs], |k, point| {
                samples[slot(k)] = none;
                if is_out(last.1 + (point - last.0).norm()) {
                    return;
                }
                let sample = field.rough(&point);
                last = (point, sample.0);
                if !is_out(sample.0) {
                    samples[slot(k)] = sample;
                }
            });
        }
    }

    /// Chooses where to climb from.
    fn pick(
        &mut self,
        margin_m: f64,
        ridges: bool,
        depth: impl Fn([f64; 2]) -> f64,
        out: &mut ContactSet,
    ) {
        self.tops.starts.clear();
        self.ridges.clear();
        let n = self.axes.each_ref().map(|a| a.len() as i64);
        let wraps = self.tops.map.wraps;
        let neighbour = |x: i64, y: i64| {
            let outside = [x < 0 || x >= n[0], y < 0 || y >= n[1]];
            let none = (outside[0] && !wraps[0]) || (outside[1] && !wraps[1]);
            (!none).then(|| (x.rem_euclid(n[0]) * n[1] + y.rem_euclid(n[1])) as usize)
        };
        let at = |k: usize| {
            [
                self.axes[0][k / n[1] as usize],
                self.axes[1][k % n[1] as usize],
            ]
        };
        let joints = self.tops.joints.as_deref();
        let mut complete = true;
        for k in 0..self.samples.len() {
            let (here, way) = self.samples[k];
            if here == f64::NEG_INFINITY {
                continue;
            }
            let (a, b) = (k as i64 / n[1], k as i64 % n[1]);
            // Samples of two patches are not neighbours.
            let neighbour = |x: i64, y: i64| {
                neighbour(x, y).filter(|&other| {
                    joints.is_none_or(|t| t.patch_at(at(k)) == t.patch_at(at(other)))
                })
            };
            // Of equal samples, the first.
            let highest = (-1..=1)
                .flat_map(|x| (-1..=1).map(move |y| (a + x, b + y)))
                .all(|(x, y)| {
                    neighbour(x, y).is_none_or(|other| {
                        let there = self.samples[other].0;
                        if other < k {
                            here > there
                        } else {
                            here >= there
                        }
                    })
                });
            if highest {
                complete &= self.tops.starts.offer(here, at(k));
            }
            let beside = [neighbour(a, b + 1), neighbour(a + 1, b)];
            for other in beside.into_iter().flatten().filter(|_| ridges) {
                let (there, other_way) = self.samples[other];
                let deep = here.max(there);
                if deep > -margin_m
                    && here.min(there) > f64::NEG_INFINITY
                    && way.dot(&other_way) < RIDGE
                {
                    // More ridges than room are usual; the deepest tell most.
                    self.ridges.offer(deep, [at(k), at(other)]);
                }
            }
        }
        for k in 0..self.ridges.0.len() {
            let [from, to] = self.ridges.0[k].1;
            let (x, deep) = self.section(from, to, &depth);
            complete &= self.tops.starts.offer(deep, x);
        }
        if !complete {
            out.note_dropped();
        }
    }

    /// The deepest place on the way between two samples, by golden section.
    fn section(
        &self,
        from: [f64; 2],
        to: [f64; 2],
        depth: &impl Fn([f64; 2]) -> f64,
    ) -> ([f64; 2], f64) {
        let way = self.tops.map.way(from, to);
        let at = |t: f64| {
            let place = [from[0] + t * way[0], from[1] + t * way[1]];
            self.tops.map.turn(place)
        };
        let (t, deep) = greatest(0.0, 1.0, SECTIONS, |t| depth(at(t)));
        (at(t), deep)
    }
}
