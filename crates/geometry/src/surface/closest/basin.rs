//! Where around a query a part of a surface has one local minimum of the distance at most.
//!
//! ```text
//! box of parameters ──▶ squared distance convex on it, all else of the part farther than a ceiling
//!                       ──▶ while the query stays near: at most one minimum below the ceiling, by descent within the box
//! ```
//! Distances change by no more than the query moves, Hessians by what [`super::warm`] says. On a rational piece the squared
//! distance less the level of a minimum, times W, is what must be convex; it is linear in the level, so that it is on the box
//! for all levels if it is for the least and the greatest.

use super::newton::{NewtonPlace, OnPieces, descend_between, descend_over};
use super::objective::{Distance, Grid, Problem};
use super::warm::{Around, Outside, gap_outside, query_limit, slacks, surround};
use super::{ClosestPoint, ClosestSolver};
use crate::math::Point3;
use crate::surface::tensor::Surface;

/// The share of a piece, in its own [0, 1]², that a trimmed part of the surface is within.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clip {
    pub s: [f64; 2],
    pub t: [f64; 2],
}

/// Around which query, and how far, a part of a surface has one minimum at most.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Basin {
    centre: Point3,
    /// The box, and a place in it; none where all of the part is far.
    bed: Option<(Around, NewtonPlace)>,
    /// How far the query may be from the centre, m.
    convex_m: f64,
    /// No place of the part outside the box is nearer to the centre, m.
    clear_m: f64,
}

/// The lowest place of a basin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lowest {
    pub at: ClosestPoint,
    /// The distance falls out of the box there: no minimum of the surface.
    pub leaves: bool,
    /// No side of the box and no end of the domain holds it.
    pub free: bool,
}

impl Basin {
    /// No place of the part outside the box is nearer to a query than this, m; negative where nothing is known.
    pub fn clear_m(&self, query: &Point3) -> f64 {
        let moved_m = (query - self.centre).norm();
        if moved_m <= self.convex_m {
            self.clear_m - moved_m
        } else {
            -1.0
        }
    }

    /// All of the part is as far.
    pub fn is_empty(&self) -> bool {
        self.bed.is_none()
    }
}

impl ClosestSolver {
    /// The basin around a query, at a place if one is given, else where the samples lead to: with all else farther than
    /// `within_m` by up to `reach_m`. `clips` say where on each piece there is something of the part.
    pub(crate) fn basin(
        &mut self,
        surface: &Surface,
        query: &Point3,
        within_m: f64,
        reach_m: f64,
        at: Option<[f64; 2]>,
        clips: &[Clip],
    ) -> Option<Basin> {
        self.follow(surface);
        #[cfg(target_arch = "x86_64")]
        if crate::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { self.basin_wide(surface, query, within_m, reach_m, at, clips) };
        }
        self.basin_in(surface, query, within_m, reach_m, at, clips)
    }

    /// AVX2 build of the baseline function: sums in the same order, hence identical bits.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn basin_wide(
        &mut self,
        surface: &Surface,
        query: &Point3,
        within_m: f64,
        reach_m: f64,
        at: Option<[f64; 2]>,
        clips: &[Clip],
    ) -> Option<Basin> {
        self.basin_in(surface, query, within_m, reach_m, at, clips)
    }

    #[inline(always)]
    fn basin_in(
        &mut self,
        surface: &Surface,
        query: &Point3,
        within_m: f64,
        reach_m: f64,
        at: Option<[f64; 2]>,
        clips: &[Clip],
    ) -> Option<Basin> {
        let objective = Distance { q: *query };
        let grid = Grid::of(&objective, &self.pieces);
        let place = at.map(|[u, v]| self.place(u, v));
        let Self {
            search,
            pieces,
            tables,
            size_m,
            ..
        } = self;
        let problem = Problem {
            surface,
            tables,
            objective: &objective,
            size_m: *size_m,
        };
        let gap_m = |search: &mut _, pieces: &mut _, around: Option<Around>, reach_m: f64| {
            let outside = Outside {
                around,
                clips: Some(clips),
                distance: within_m,
            };
            gap_outside(grid, search, pieces, &problem, &outside, 2.0 * reach_m)
        };
        let least_m = 1e-6 * problem.size_m;
        let Some(place) = place else {
            let gap_m = gap_m(search, pieces, None, reach_m);
            return (gap_m > least_m).then_some(Basin {
                centre: *query,
                bed: None,
                convex_m: f64::INFINITY,
                clear_m: within_m + gap_m,
            });
        };
        let mut share = 1.0;
        for _ in 0..4 {
            let around = surround(pieces, &place, share);
            share *= 0.5;
            let levels = [0.0, (within_m + reach_m) * (within_m + reach_m)];
            let mut limit_m = f64::INFINITY;
            for level in &levels[..if grid.rational { 2 } else { 1 }] {
                let found = slacks(grid, search, pieces, &problem, *level, around);
                limit_m = found.map_or(0.0, |(slacks, count)| {
                    let limit = query_limit(&slacks[..count], grid.rational, pieces, within_m);
                    limit_m.min(limit)
                });
            }
            if limit_m <= least_m {
                continue;
            }
            let gap_m = gap_m(search, pieces, Some(around), reach_m.min(limit_m));
            if gap_m <= least_m {
                return None;
            }
            return Some(Basin {
                centre: *query,
                bed: Some((around, place)),
                convex_m: 0.999 * limit_m,
                clear_m: within_m + gap_m,
            });
        }
        None
    }

    /// The minimum that the nearest sample leads to, where no end of the domain holds it.
    pub(crate) fn guess(&mut self, surface: &Surface, query: &Point3) -> Option<ClosestPoint> {
        self.follow(surface);
        let objective = Distance { q: *query };
        let start = self.samples.best(&self.pieces, &objective);
        let mut eval = OnPieces {
            pieces: &mut self.pieces,
            surface,
        };
        let found = descend_over(&mut eval, &objective, start);
        (found.free == [true; 2] && self.settled(&found))
            .then(|| self.answer(surface, query, &found))
    }

    /// The place of a basin's box that is nearest to the query; `None` if descent does not arrive there, or the basin has no box.
    pub(crate) fn lowest_of(
        &mut self,
        surface: &Surface,
        query: &Point3,
        basin: &Basin,
    ) -> Option<Lowest> {
        let (around, place) = basin.bed?;
        let objective = Distance { q: *query };
        let mut eval = OnPieces {
            pieces: &mut self.pieces,
            surface,
        };
        let (low, high) = ([around.u[0], around.v[0]], [around.u[1], around.v[1]]);
        let found = descend_between(&mut eval, &objective, place, low, high);
        if !self.settled(&found) {
            return None;
        }
        let (x, jet) = ([found.place.u, found.place.v], &found.jet);
        let sides = [&self.pieces.u, &self.pieces.v];
        let leaves = (0..2).any(|k| {
            // Sides of the box that are ends of the domain hold minima.
            let (ends, periodic) = (sides[k].domain, sides[k].periodic);
            let inner = |side: f64| periodic || (side > ends.0 && side < ends.1);
            let steep = jet.g[k].abs() > 1e-7 * self.size_m * jet.metric[k].sqrt();
            !found.free[k]
                && steep
                && ((jet.g[k] > 0.0 && inner(low[k])) || (jet.g[k] < 0.0 && inner(high[k])))
                && (periodic || x[k] == low[k] || x[k] == high[k])
        });
        Some(Lowest {
            at: self.answer(surface, query, &found),
            leaves,
            free: found.free == [true; 2],
        })
    }
}
