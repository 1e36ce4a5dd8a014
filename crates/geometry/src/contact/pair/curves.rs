//! The curves in which two surfaces cross.
//!
//! ```text
//! seeds    where the lines of each surface's cells pierce the other; and, for loops inside one pair of cells, where a
//!          line from a stationary pair of places passes the other surface
//! join     Newton's steps back to the curve: two tangent planes and a plane across the way
//! march    along n_A × n_B, steps as long as their chords allow
//! ```
//! A loop inside a pair of cells surrounds a stationary pair (Sederberg, Christiansen & Katz 1989).
//! Curves along which the surfaces touch without crossing have no direction: they are given as far
//! as they cross. Surfaces that lie on each other give no curve. Work is bounded, so of nearly
//! coincident surfaces some curves may be missing or end early.

mod join;
mod march;
mod parts;
mod seeds;
#[cfg(test)]
mod tests;

use self::join::{CurvePlace, JoinedCurve};
use self::march::{End, march};
use self::seeds::{Seed, seeds};
use super::touch::Divided;
use super::{PairSide, PairSolver, usable};
use crate::math::Point3;

/// Most curves; more than this are noise of surfaces that nearly lie on each other.
const MOST_CURVES: usize = 256;
/// Places nearer than this, relative to the size, are one.
const SAME: f64 = 1e-8;

/// A place on both surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Parameter of the body's surface.
    pub u: f64,
    /// Parameter of the body's surface.
    pub v: f64,
    /// Parameter of the tool's surface, its u.
    pub s: f64,
    /// Parameter of the tool's surface, its v.
    pub t: f64,
    /// The place on the body's surface, m; the tool's is within 1e-12 of the size.
    pub point: Point3,
}

/// One branch of the intersection of two surfaces, along n_body × n_tool.
#[derive(Clone, Debug, PartialEq)]
pub struct IntersectionCurve {
    /// In order. Parameters jump where the curve passes a seam or a pole.
    pub points: Vec<CurvePoint>,
    /// The last point is followed by the first. If not, the curve ends at open edges or where the
    /// surfaces are tangent.
    pub closed: bool,
}

impl PairSolver {
    /// Every curve in which the surfaces cross; chords stay within `tolerance_m` of it. Allocates:
    /// not for the loop.
    ///
    /// A tolerance below 1e-9 of the size, or none, counts as that. Nets that are not finite cross
    /// nowhere.
    pub fn curves(
        &mut self,
        body: PairSide<'_>,
        tool: PairSide<'_>,
        tolerance_m: f64,
    ) -> Vec<IntersectionCurve> {
        if ![body.surface, tool.surface].into_iter().all(usable) {
            return vec![];
        }
        self.body.begin(body.solver.pieces(body.surface));
        self.tool.begin(tool.solver.pieces(tool.surface));
        let size_m = self.body.whole.diagonal() + self.tool.whole.diagonal();
        if !(size_m.is_finite() && size_m > 0.0) {
            return vec![];
        }
        let mut a = Divided {
            surface: body.surface,
            pieces: body.solver.pieces_now(),
            cells: &mut self.body,
        };
        let mut b = Divided {
            surface: tool.surface,
            pieces: tool.solver.pieces_now(),
            cells: &mut self.tool,
        };
        self.touch.find(&mut a, &mut b, 1e-11 * size_m);
        let mut joined = JoinedCurve::new(
            [body.surface, tool.surface],
            [body.solver, tool.solver],
            [&self.body, &self.tool],
            size_m,
        );
        let tolerance_m = tolerance_m.max(1e-9 * size_m);
        let mut found = vec![];
        for seed in seeds(&mut joined) {
            if found.len() == MOST_CURVES || joined.spent() {
                break;
            }
            let Some(start) = joined.place(seed.at) else {
                continue;
            };
            if found
                .iter()
                .any(|curve| passes(&mut joined, curve, &start, tolerance_m))
            {
                continue;
            }
            let traced = trace(&mut joined, &seed, start, tolerance_m);
            found.extend(traced.filter(|curve| crosses(&mut joined, curve)));
        }
        found.into_iter().map(Traced::published).collect()
    }
}

/// A curve while others are looked for.
struct Traced {
    places: Vec<CurvePlace>,
    closed: bool,
}

impl Traced {
    fn published(self) -> IntersectionCurve {
        let point = |p: &CurvePlace| CurvePoint {
            u: p.at[0],
            v: p.at[1],
            s: p.at[2],
            t: p.at[3],
            point: p.point,
        };
        IntersectionCurve {
            points: self.places.iter().map(point).collect(),
            closed: self.closed,
        }
    }
}

/// The curve through a seed, both ways unless it closes.
fn trace(
    joined: &mut JoinedCurve<'_>,
    seed: &Seed,
    start: CurvePlace,
    tolerance_m: f64,
) -> Option<Traced> {
    let (mut places, end) = march(joined, &start, 1.0, tolerance_m);
    if end == End::Closed {
        return (places.len() > 2).then_some(Traced {
            places,
            closed: true,
        });
    }
    // At an open edge one of the two ways leads out at once.
    if !(seed.edge && places.len() > 1) {
        let (back, _) = march(joined, &start, -1.0, tolerance_m);
        places = back
            .into_iter()
            .rev()
            .chain(places.into_iter().skip(1))
            .collect();
    }
    (places.len() > 1).then_some(Traced {
        places,
        closed: false,
    })
}

/// The curve passes through a place.
fn passes(
    joined: &mut JoinedCurve<'_>,
    curve: &Traced,
    place: &CurvePlace,
    tolerance_m: f64,
) -> bool {
    let n = curve.places.len();
    let segments = if curve.closed { n } else { n - 1 };
    let (mut least, mut nearest) = (f64::INFINITY, 0);
    for k in 0..segments {
        let (a, b) = (curve.places[k].point, curve.places[(k + 1) % n].point);
        let (chord, way) = (b - a, place.point - a);
        let share = (way.dot(&chord) / chord.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let square = (way - chord * share).norm_squared();
        if square < least {
            (least, nearest) = (square, k);
        }
    }
    let same = SAME * joined.size_m;
    let reach = 2.0 * tolerance_m + same;
    if least > reach * reach {
        return false;
    }
    // Near is not on: another branch may be as near. From both ends of the chord to the plane
    // through the place.
    let ends = [curve.places[nearest], curve.places[(nearest + 1) % n]];
    let mut lost = true;
    for end in ends {
        if (end.point - place.point).norm() <= same {
            return true;
        }
        if let Ok(there) = joined.correct(end.at, &place.point, &place.way) {
            lost = false;
            if (there.point - place.point).norm() <= same {
                return true;
            }
        }
    }
    // On a crease the way is that of one side only.
    lost
}

/// The first surface is on different sides of the second on both sides of the curve: else it is
/// noise of surfaces that lie on each other. One place in five is enough, near a crease or a pole
/// it may mislead.
fn crosses(joined: &mut JoinedCurve<'_>, curve: &Traced) -> bool {
    let n = curve.places.len();
    let level_m = 1e-13 * joined.size_m;
    (1..6).any(|k| {
        let place = &curve.places[k * n / 6];
        [1e-2, 1e-4, 1e-6].into_iter().any(|share| {
            let beside = [1.0, -1.0].map(|sense| joined.beside(place, sense * share * joined.size_m));
            matches!(beside, [Some(a), Some(b)] if (a > level_m && b < -level_m) || (a < -level_m && b > level_m))
        })
    })
}
