//! All local minima of the distance to a point, or of the depth along a direction, that are better
//! than a ceiling.
//!
//! ```text
//! pieces whose boxes reach the ceiling ──▶ parts ──▶ nothing here │ one minimum at most │ halves
//!                                                                  └▶ descent within the part ──▶ judged ──▶ merged
//! ```
//! A part is done when its coefficients prove that no minimum is in it, or that there is at most
//! one ([`super::stationary`]). What a descent within the part finds is a minimum of the surface
//! only if it also holds across the part's edges, creases, seams and poles ([`super::judge`]).
//! Places that a path of equal values joins (a flat face on a plane, the line on which a cylinder
//! lies) count as one. Work is bounded: after some thousand parts, places that differ by up to
//! 5e-10 of the size count as equal, and after a few thousand more the search stops and says so.

use super::bernstein::MAX_ORDER;
use super::judge::{Judge, ends, pole_at, steep};
use super::newton::{Descent, NewtonPlace, OnPieces, descend_between};
use super::objective::{Along, Distance, Grid, Objective, Problem};
use super::search::{Search, SearchPart, TOLERANCE};
use super::stationary::{Claim, Setting, above, claim, quotient_range};
use super::{ClosestPoint, ClosestSolver};
use crate::math::{Point3, Vector3};
use crate::surface::bezier::{BezierPieces, Joint};
use crate::surface::tensor::Surface;

/// Most local minima held at once; the best stay.
pub(super) const MOST: usize = 64;
/// Parts after which the tolerance is widened tenfold, up to [`WIDEST`] of the size.
const PATIENCE: usize = 1_000;
const WIDEST: f64 = 5e-10;
/// Parts and descents after which the search stops.
const MOST_PARTS: usize = 8_000;
const MOST_STARTS: usize = 600;
/// Of these, what one piece may take, so that others are looked at as well.
const PIECE_PARTS: usize = 2_000;
const PIECE_STARTS: usize = 150;
/// Heights of a bicubic piece without weights.
const HEIGHTS: Grid = Grid::polynomial(4);
/// Halvings after which a part counts as a point: 2⁻³⁰ of a piece.
const SMALLEST: f64 = 1.0 / (1u64 << 30) as f64;

/// A place that is highest along a direction among its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summit {
    /// Parameter, inside the domain.
    pub u: f64,
    /// Parameter, inside the domain.
    pub v: f64,
    /// S(u, v), m.
    pub point: Point3,
    /// `direction · S`, m.
    pub height_m: f64,
}

/// Scratch of the search for all minima, sized once.
#[derive(Clone, Debug)]
pub(super) struct Minima {
    pub found: Vec<Held>,
    /// (pieces): some of the piece may be below the ceiling of the last search.
    pub reached: Vec<bool>,
    /// Minima that found no room, or that a stopped search may have missed.
    pub lost: bool,
    /// Coefficients of the two forms of a rational part.
    forms: [Vec<f64>; 2],
    starts: usize,
    piece: Spent,
    groups: u32,
    /// The four edges of the domain (u at its start and end, then v): a pole there has been judged.
    judged: [bool; 4],
}

/// Work for one piece.
#[derive(Clone, Copy, Debug, Default)]
struct Spent {
    parts: usize,
    starts: usize,
    /// It needed more than it may.
    over: bool,
}

/// A minimum, and the connected set of equal ones that it belongs to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    pub descent: Descent,
    pub group: u32,
}

impl Minima {
    pub fn new(pieces: &BezierPieces) -> Self {
        let size = (2 * pieces.u.degree + 1) * (2 * pieces.v.degree + 1);
        debug_assert!(size <= MAX_ORDER * MAX_ORDER, "degrees above the kernel's");
        Self {
            found: Vec::with_capacity(MOST),
            reached: vec![false; pieces.len()],
            lost: false,
            forms: std::array::from_fn(|_| vec![0.0; if pieces.is_rational() { size } else { 0 }]),
            starts: 0,
            piece: Spent::default(),
            groups: 0,
            judged: [false; 4],
        }
    }

    /// Fills `found` with all minima below `ceiling`, best first, one of each connected set.
    #[inline(always)]
    fn search_in<O: Objective>(
        &mut self,
        search: &mut Search,
        pieces: &mut BezierPieces,
        problem: &Problem<'_, O>,
        ceiling: f64,
    ) {
        self.found.clear();
        self.reached.fill(false);
        (self.lost, self.starts, self.groups, self.judged) = (false, 0, 0, [false; 4]);
        search.visited = 0;
        search.candidates(pieces, problem.surface, problem.objective, ceiling);
        let mut hunt = Hunt {
            problem,
            ceiling,
            delta_m: TOLERANCE * problem.size_m,
        };
        let grid = Grid::of(problem.objective, pieces);
        let mut k = 0;
        while let Some((_, piece)) = search.candidate(k) {
            match grid {
                HEIGHTS => self.piece(&mut hunt, search, pieces, piece, HEIGHTS),
                Grid::BICUBIC => self.piece(&mut hunt, search, pieces, piece, Grid::BICUBIC),
                grid => self.piece(&mut hunt, search, pieces, piece, grid),
            }
            k += 1;
        }
        self.found.sort_unstable_by(|a, b| {
            let (x, y) = (&a.descent, &b.descent);
            let order = x
                .jet
                .f
                .total_cmp(&y.jet.f)
                .then(x.place.u.total_cmp(&y.place.u));
            order.then(x.place.v.total_cmp(&y.place.v))
        });
        let mut kept = 0;
        for k in 0..self.found.len() {
            let held = self.found[k];
            if self.found[..kept]
                .iter()
                .all(|other| other.group != held.group)
            {
                self.found[kept] = held;
                kept += 1;
            }
        }
        self.found.truncate(kept);
    }

    #[inline(always)]
    fn piece<O: Objective>(
        &mut self,
        hunt: &mut Hunt<'_, O>,
        search: &mut Search,
        pieces: &mut BezierPieces,
        piece: usize,
        grid: Grid,
    ) {
        let Grid { nu, nv, rational } = grid;
        let (len, problem) = (grid.len(), hunt.problem);
        let noise =
            (problem.objective).form(pieces, piece, problem.tables, &mut search.a, &mut search.w);
        search.parts.clear();
        search.parts.push(SearchPart::whole(pieces, piece));
        let mut first = true;
        self.piece = Spent::default();
        while let Some(part) = search.parts.last().copied() {
            search.visited += 1;
            self.piece.parts += 1;
            if search.visited.is_multiple_of(PATIENCE) {
                hunt.delta_m = (hunt.delta_m * 10.0).min(WIDEST * problem.size_m);
            }
            let slot = (search.parts.len() - 1) * search.stride();
            let a = &search.a[slot..slot + len];
            let borders = borders(pieces, &part);
            let mut setting = Setting {
                borders,
                widths: [part.s[1] - part.s[0], part.t[1] - part.t[0]],
                ceiling: hunt.ceiling,
                noise: noise.absolute,
                equal: 0.0,
            };
            let claim = if rational {
                let w = &search.w[slot..slot + len];
                let (low, high) = quotient_range(a, w);
                if low >= hunt.ceiling {
                    Claim::Nothing
                } else if high - low <= hunt.equal(low) {
                    Claim::Start(0.5, 0.5)
                } else {
                    for (form, f) in self.forms.iter_mut().zip([low, high.min(hunt.ceiling)]) {
                        for x in 0..len {
                            form[x] = a[x] - f * w[x];
                        }
                    }
                    setting.noise = 2.0 * noise.on(w);
                    claim([&self.forms[0], &self.forms[1]], (a, w), nu, nv, &setting)
                }
            } else if above(a, hunt.ceiling) {
                Claim::Nothing
            } else {
                setting.equal = hunt.equal(a[0]);
                claim([a], (a, a), nu, nv, &setting)
            };
            self.reached[piece] |= first && claim != Claim::Nothing;
            if first && claim == Claim::Nothing {
                // No minimum, but it may still reach below the ceiling.
                self.reached[piece] = if rational {
                    quotient_range(a, &search.w[..len]).0 < hunt.ceiling
                } else {
                    !above(a, hunt.ceiling)
                };
            }
            first = false;
            let (wide_u, wide_v) = (
                part.s[1] - part.s[0] > SMALLEST,
                part.t[1] - part.t[0] > SMALLEST,
            );
            let start = match claim {
                Claim::Nothing => None,
                Claim::Start(s, t) => Some((s, t)),
                _ if search.visited >= MOST_PARTS || self.piece.parts >= PIECE_PARTS => {
                    self.piece.over = true;
                    None
                }
                Claim::Halve(in_u) if wide_u || wide_v => {
                    search.halve(grid, if in_u { wide_u } else { !wide_v });
                    continue;
                }
                Claim::Halve(_) => Some((0.5, 0.5)),
            };
            search.parts.pop();
            if let Some((s, t)) = start {
                self.start(hunt, pieces, &part, s, t);
            }
        }
        if self.piece.over {
            self.lost = true;
            search.given_up += 1;
        }
    }

    /// Descends within a part and keeps what it finds, if that is a minimum of the surface.
    #[inline(never)]
    fn start<O: Objective>(
        &mut self,
        hunt: &Hunt<'_, O>,
        pieces: &mut BezierPieces,
        part: &SearchPart,
        s: f64,
        t: f64,
    ) {
        if self.starts >= MOST_STARTS || self.piece.starts >= PIECE_STARTS {
            self.piece.over = true;
            return;
        }
        self.starts += 1;
        self.piece.starts += 1;
        let Problem {
            surface,
            objective,
            size_m,
            ..
        } = *hunt.problem;
        let (low, high) = (part.place(pieces, 0.0, 0.0), part.place(pieces, 1.0, 1.0));
        let mut eval = OnPieces { pieces, surface };
        let start = part.place(eval.pieces, s, t);
        // Every piece around a pole leads to it; it is the same place.
        if ends(eval.pieces, &start)
            .into_iter()
            .flatten()
            .any(|edge| self.judged[edge])
        {
            return;
        }
        let found = descend_between(
            &mut eval,
            objective,
            start,
            [low.u, low.v],
            [high.u, high.v],
        );
        if let Some(edge) = pole_at(eval.pieces, &found, size_m)
            && std::mem::replace(&mut self.judged[edge], true)
        {
            return;
        }
        let slides = slides_out(eval.pieces, part, &found, low, high, size_m);
        let mut judge = Judge {
            eval,
            objective,
            size_m,
        };
        let Some(found) = (!slides)
            .then(|| judge.minimum(&found, hunt.equal(found.jet.f)))
            .flatten()
        else {
            return;
        };
        if found.jet.f >= hunt.ceiling {
            return;
        }
        self.hold(&mut judge, found, hunt);
    }

    fn hold<O: Objective>(&mut self, judge: &mut Judge<'_, O>, found: Descent, hunt: &Hunt<'_, O>) {
        let equal = hunt.equal(found.jet.f) + found.jet.noise;
        let group = self.groups;
        self.groups += 1;
        let mut joined = false;
        for k in 0..self.found.len() {
            let other = self.found[k];
            if other.group == group || (other.descent.jet.f - found.jet.f).abs() > equal {
                continue;
            }
            if judge.joined(
                &found.place,
                &other.descent.place,
                found.jet.f.max(other.descent.jet.f) + 4.0 * equal,
            ) {
                joined = true;
                self.found
                    .iter_mut()
                    .filter(|h| h.group == other.group)
                    .for_each(|h| h.group = group);
            }
        }
        let held = Held {
            descent: found,
            group,
        };
        if self.found.len() < MOST {
            self.found.push(held);
        } else if !joined {
            self.lost = true;
            let worst = (0..MOST).fold(0, |w, k| {
                if self.found[k].descent.jet.f > self.found[w].descent.jet.f {
                    k
                } else {
                    w
                }
            });
            if found.jet.f < self.found[worst].descent.jet.f {
                self.found[worst] = held;
            }
        }
    }
}

/// What one search is after.
struct Hunt<'a, O: Objective> {
    problem: &'a Problem<'a, O>,
    ceiling: f64,
    delta_m: f64,
}

impl<O: Objective> Hunt<'_, O> {
    /// Values within this of `f` are equal.
    #[inline(always)]
    fn equal(&self, f: f64) -> f64 {
        f - self.problem.objective.floor(f, self.delta_m)
    }
}

/// Which edges of a part are edges of its smooth patch.
#[inline(always)]
fn borders(pieces: &BezierPieces, part: &SearchPart) -> [[bool; 2]; 2] {
    let (a, b) = (&pieces.u.spans[part.i], &pieces.v.spans[part.j]);
    [
        [
            part.s[0] == 0.0 && a.before != Joint::Smooth,
            part.s[1] == 1.0 && a.after != Joint::Smooth,
        ],
        [
            part.t[0] == 0.0 && b.before != Joint::Smooth,
            part.t[1] == 1.0 && b.after != Joint::Smooth,
        ],
    ]
}

/// Held at an edge behind which the smooth surface goes on downwards: a neighbour's affair.
fn slides_out(
    pieces: &BezierPieces,
    part: &SearchPart,
    found: &Descent,
    low: NewtonPlace,
    high: NewtonPlace,
    size_m: f64,
) -> bool {
    let borders = borders(pieces, part);
    let (x, jet) = ([found.place.u, found.place.v], &found.jet);
    (0..2).any(|k| {
        let (low, high) = if k == 0 {
            (low.u, high.u)
        } else {
            (low.v, high.v)
        };
        // Steep enough that the neighbour sees it too; a slope near rounding is judged.
        steep(found, k, size_m)
            && ((x[k] <= low && !borders[k][0] && jet.g[k] > 0.0)
                || (x[k] >= high && !borders[k][1] && jet.g[k] < 0.0))
    })
}

/// AVX2 build of the baseline function: sums in the same order, hence identical bits.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn search_wide<O: Objective>(
    minima: &mut Minima,
    search: &mut Search,
    pieces: &mut BezierPieces,
    problem: &Problem<'_, O>,
    ceiling: f64,
) {
    minima.search_in(search, pieces, problem, ceiling);
}

impl ClosestSolver {
    /// Every local minimum of the distance to `query` that is nearer than `radius_m`, nearest
    /// first: `out` is cleared and filled up to its capacity. Of a connected set of equal minima,
    /// one is given. True when none was left out.
    pub fn minima_within(
        &mut self,
        surface: &Surface,
        query: &Point3,
        radius_m: f64,
        out: &mut Vec<ClosestPoint>,
    ) -> bool {
        out.clear();
        if !(radius_m.is_finite() && query.iter().all(|x| x.is_finite())) {
            return true;
        }
        self.all_minima(
            surface,
            &Distance { q: *query },
            radius_m.max(0.0) * radius_m.max(0.0),
        );
        for held in self.minima.found.iter().take(out.capacity()) {
            out.push(self.answer(surface, query, &held.descent));
        }
        !self.minima.lost && self.minima.found.len() <= out.capacity()
    }

    /// Every local maximum of `direction · S` above `height_m`, highest first; otherwise like
    /// [`ClosestSolver::minima_within`]. The direction must be of unit length.
    pub fn summits_along(
        &mut self,
        surface: &Surface,
        direction: &Vector3,
        height_m: f64,
        out: &mut Vec<Summit>,
    ) -> bool {
        out.clear();
        if !(height_m.is_finite() && (direction.norm_squared() - 1.0).abs() < 1e-6) {
            return true;
        }
        self.all_minima(surface, &Along { d: *direction }, -height_m);
        for held in self.minima.found.iter().take(out.capacity()) {
            let (u, v) = self.parameters(&held.descent.place);
            let point = held.descent.frame.point;
            out.push(Summit {
                u,
                v,
                point,
                height_m: direction.dot(&point.coords),
            });
        }
        !self.minima.lost && self.minima.found.len() <= out.capacity()
    }

    /// Which pieces (see [`ClosestSolver::pieces`]) may reach inside the ball or past the height of
    /// the last search for all minima; no others do.
    pub fn pieces_reached(&self) -> &[bool] {
        &self.minima.reached
    }

    fn all_minima<O: Objective>(&mut self, surface: &Surface, objective: &O, ceiling: f64) {
        let Self {
            minima,
            search,
            pieces,
            tables,
            size_m,
            ..
        } = self;
        let problem = Problem {
            surface,
            tables,
            objective,
            size_m: *size_m,
        };
        #[cfg(target_arch = "x86_64")]
        if crate::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { search_wide(minima, search, pieces, &problem, ceiling) };
        }
        minima.search_in(search, pieces, &problem, ceiling);
    }
}
