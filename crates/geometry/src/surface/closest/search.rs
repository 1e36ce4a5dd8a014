//! Branch and bound over the Bézier pieces: proves that nothing on the surface is better than the
//! best foot so far, or finds what is.
//!
//! With β the best value, a piece is done when the polynomial G = A − β W (see
//! [`super::objective`]) is proved ≥ −tolerance: by its least coefficient; by its edge, where G is
//! monotone across the piece; by Newton and a tangent plane, where its Hessian is positive on the
//! whole piece; else by its halves. A value below starts a descent, which lowers β.

use super::bernstein::{
    MAX_ORDER, Verdict, convex_verdict, curvature, edge_verdict, first_differences, halve_u,
    halve_v, least,
};
use super::newton::{Descent, NewtonPlace, OnPieces, descend_over};
use super::objective::{Grid, Objective, Problem};
use crate::surface::bezier::BezierPieces;
use crate::surface::tensor::Surface;

/// Halvings in one direction after which a part counts as its corners: 2⁻⁴⁰ of a piece.
const SMALLEST: f64 = 1.0 / (1u64 << 40) as f64;
/// Deepest stack: one entry a halving, 40 in each direction.
const DEPTH: usize = 84;
/// Parts after which the tolerance is widened tenfold, up to 5e-10 of the size: only where whole
/// curves are nearly equally close (medial axes of nearly round bodies) do searches get there.
const PATIENCE: usize = 2_000;
/// Parts and descents after which a piece is given up. Between knots that differ in their last digits
/// all of a piece is nearer than parameters can reach: it would be halved for ever, and spends its
/// descents within a hundred parts.
const MOST_PARTS: usize = 1_000;
const MOST_STARTS: usize = 50;
/// Parts of a rational piece: where weights are unlike, most of it lies in a sliver of its parameters,
/// which takes a halving for each power of two.
const MOST_RATIONAL_PARTS: usize = 20_000;

/// Better by less than this, relative to the surface's size, is equal.
pub(super) const TOLERANCE: f64 = 1e-12;
const WIDEST: f64 = 5e-10;

/// A part of a piece, in the piece's own [0, 1]².
#[derive(Clone, Copy, Debug)]
pub(super) struct SearchPart {
    pub i: usize,
    pub j: usize,
    pub s: [f64; 2],
    pub t: [f64; 2],
}

impl SearchPart {
    pub fn whole(pieces: &BezierPieces, piece: usize) -> Self {
        let columns = pieces.v.spans.len();
        Self {
            i: piece / columns,
            j: piece % columns,
            s: [0.0, 1.0],
            t: [0.0, 1.0],
        }
    }

    /// The place at local (s, t) of this part.
    pub fn place(&self, pieces: &BezierPieces, s: f64, t: f64) -> NewtonPlace {
        let (a, b) = (&pieces.u.spans[self.i], &pieces.v.spans[self.j]);
        let (x, y) = (
            self.s[0] + s * (self.s[1] - self.s[0]),
            self.t[0] + t * (self.t[1] - self.t[0]),
        );
        NewtonPlace {
            i: self.i,
            j: self.j,
            u: (a.start + x * (a.end - a.start)).clamp(a.start, a.end),
            v: (b.start + y * (b.end - b.start)).clamp(b.start, b.end),
        }
    }

    /// Local parameters of the point of this part nearest to a foot, to start Newton from.
    fn nearest(&self, pieces: &BezierPieces, foot: NewtonPlace) -> (f64, f64) {
        let local =
            |d: &crate::surface::bezier::PieceDirection, k: usize, range: [f64; 2], x: f64| {
                let span = &d.spans[k];
                let width = span.end - span.start;
                let mut y = ((x - span.start) / width - range[0]) / (range[1] - range[0]);
                if d.periodic {
                    let period = (d.domain.1 - d.domain.0) / (width * (range[1] - range[0]));
                    y -= period * ((y - 0.5) / period).round();
                }
                y.clamp(0.0, 1.0)
            };
        (
            local(&pieces.u, self.i, self.s, foot.u),
            local(&pieces.v, self.j, self.t, foot.v),
        )
    }

    /// Halves: (lower, upper).
    pub fn halves(&self, in_u: bool) -> (Self, Self) {
        let (mut low, mut high) = (*self, *self);
        if in_u {
            let middle = 0.5 * (self.s[0] + self.s[1]);
            (low.s[1], high.s[0]) = (middle, middle);
        } else {
            let middle = 0.5 * (self.t[0] + self.t[1]);
            (low.t[1], high.t[0]) = (middle, middle);
        }
        (low, high)
    }
}

/// What the coefficients of a part show.
enum Finding {
    Clear,
    Below(f64, f64),
    /// Undecided; halve in u or in v.
    Open(bool),
}

/// Scratch of the search, sized once.
#[derive(Clone, Debug)]
pub(super) struct Search {
    stride: usize,
    /// (DEPTH × stride): A of each open part.
    pub a: Vec<f64>,
    /// Coefficients of W of a rational surface.
    pub w: Vec<f64>,
    /// (stride): A − β W.
    pub g: Vec<f64>,
    pub parts: Vec<SearchPart>,
    /// (pieces): lower bound and piece, sorted.
    order: Vec<(f64, usize)>,
    /// Parts looked at by the last search.
    pub visited: usize,
    /// Pieces given up by all searches.
    pub given_up: u64,
}

impl Search {
    pub fn new(pieces: &BezierPieces) -> Self {
        let stride = (2 * pieces.u.degree + 1) * (2 * pieces.v.degree + 1);
        let weights = if pieces.is_rational() {
            DEPTH * stride
        } else {
            0
        };
        Self {
            stride,
            a: vec![0.0; DEPTH * stride],
            w: vec![0.0; weights],
            g: vec![0.0; stride],
            parts: Vec::with_capacity(DEPTH),
            order: Vec::with_capacity(pieces.len()),
            visited: 0,
            given_up: 0,
        }
    }

    /// Pieces whose boxes reach below `floor`, nearest first; their points are fresh after that.
    #[inline(always)]
    pub fn candidates<O: Objective>(
        &mut self,
        pieces: &mut BezierPieces,
        surface: &Surface,
        objective: &O,
        floor: f64,
    ) {
        self.order.clear();
        pieces.follow(surface);
        let slack = pieces.slack_m();
        let [x0, y0, z0, x1, y1, z1] = pieces.bound_arrays();
        for k in 0..x0.len() {
            let low = [x0[k] - slack, y0[k] - slack, z0[k] - slack];
            let high = [x1[k] + slack, y1[k] + slack, z1[k] + slack];
            let bound = objective.box_bound(low, high);
            if bound < floor && !pieces.is_duplicate(k) {
                self.order.push((bound, k));
            }
        }
        if slack > 0.0 {
            // The same list as fresh boxes would have given.
            let mut kept = 0;
            for k in 0..self.order.len() {
                let piece = self.order[k].1;
                let (low, high) = pieces.fresh_box(surface, piece);
                let bound = objective.box_bound(low, high);
                if bound < floor {
                    self.order[kept] = (bound, piece);
                    kept += 1;
                }
            }
            self.order.truncate(kept);
        }
        self.order
            .sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }

    /// Candidate `k` of the last [`Search::candidates`].
    pub fn candidate(&self, k: usize) -> Option<(f64, usize)> {
        self.order.get(k).copied()
    }

    /// Makes `best` the global minimum.
    pub fn certify<O: Objective>(
        &mut self,
        pieces: &mut BezierPieces,
        problem: &Problem<'_, O>,
        best: &mut Descent,
    ) {
        #[cfg(target_arch = "x86_64")]
        if crate::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { certify_wide(self, pieces, problem, best) };
        }
        self.certify_in(pieces, problem, best);
    }

    #[inline(always)]
    fn certify_in<O: Objective>(
        &mut self,
        pieces: &mut BezierPieces,
        problem: &Problem<'_, O>,
        best: &mut Descent,
    ) {
        self.visited = 0;
        let objective = problem.objective;
        let mut delta_m = TOLERANCE * problem.size_m;
        let floor = objective.floor(best.jet.f, delta_m);
        self.candidates(pieces, problem.surface, objective, floor);
        let grid = Grid::of(objective, pieces);
        let mut k = 0;
        while let Some((bound, piece)) = self.candidate(k) {
            if bound >= objective.floor(best.jet.f, delta_m) {
                break;
            }
            let delta = &mut delta_m;
            match grid {
                Grid::BICUBIC => self.clear(Grid::BICUBIC, pieces, problem, delta, piece, best),
                grid => self.clear(grid, pieces, problem, delta, piece, best),
            }
            k += 1;
        }
    }

    #[inline(always)]
    fn clear<O: Objective>(
        &mut self,
        grid: Grid,
        pieces: &mut BezierPieces,
        problem: &Problem<'_, O>,
        delta_m: &mut f64,
        piece: usize,
        best: &mut Descent,
    ) {
        let (objective, surface) = (problem.objective, problem.surface);
        let (len, stride, rational) = (grid.len(), self.stride, grid.rational);
        let noise = objective.form(pieces, piece, problem.tables, &mut self.a, &mut self.w);
        self.parts.clear();
        self.parts.push(SearchPart::whole(pieces, piece));
        let most_parts = if rational {
            MOST_RATIONAL_PARTS
        } else {
            MOST_PARTS
        };
        let (mut parts, mut starts) = (0, 0);
        while let Some(part) = self.parts.last().copied() {
            if parts == most_parts || starts == MOST_STARTS {
                // The piece, not the query: others may hold what is nearer by far.
                self.given_up += 1;
                return;
            }
            parts += 1;
            self.visited += 1;
            if self.visited.is_multiple_of(PATIENCE) {
                *delta_m = (*delta_m * 10.0).min(WIDEST * problem.size_m);
            }
            let slot = (self.parts.len() - 1) * stride;
            let value = objective.floor(best.jet.f, *delta_m);
            let (g, floor, noise) = if rational {
                let w = &self.w[slot..slot + len];
                for x in 0..len {
                    self.g[x] = self.a[slot + x] - (value - noise.of_w) * w[x];
                }
                (&self.g[..len], -noise.absolute, noise.on(w))
            } else {
                let noise = noise.absolute;
                (&self.a[slot..slot + len], value - noise, noise)
            };
            let finding = look(g, grid, floor, noise, || part.nearest(pieces, best.place));
            let mut halve_in_u = match finding {
                Finding::Clear => {
                    self.parts.pop();
                    continue;
                }
                Finding::Below(s, t) => {
                    starts += 1;
                    let start = part.place(pieces, s, t);
                    let found = descend_over(&mut OnPieces { pieces, surface }, objective, start);
                    if found.jet.f < best.jet.f {
                        *best = found;
                        continue;
                    }
                    // Only rounding can contradict; look closer.
                    part.s[1] - part.s[0] >= part.t[1] - part.t[0]
                }
                Finding::Open(in_u) => in_u,
            };
            let (wide_u, wide_v) = (
                part.s[1] - part.s[0] > SMALLEST,
                part.t[1] - part.t[0] > SMALLEST,
            );
            if !wide_u && !wide_v {
                self.parts.pop();
                continue;
            }
            if halve_in_u && !wide_u {
                halve_in_u = false;
            } else if !halve_in_u && !wide_v {
                halve_in_u = true;
            }
            self.halve(grid, halve_in_u);
        }
    }

    /// Replaces the last part by its halves.
    #[inline(always)]
    pub fn halve(&mut self, grid: Grid, in_u: bool) {
        let Grid { nu, nv, rational } = grid;
        let Some(part) = self.parts.pop() else { return };
        let (len, slot) = (grid.len(), self.parts.len() * self.stride);
        let (low, high) = part.halves(in_u);
        self.parts.push(high);
        self.parts.push(low);
        let mut arrays = [Some(&mut self.a), rational.then_some(&mut self.w)];
        for array in arrays.iter_mut().flatten() {
            let (upper, lower) = array[slot..].split_at_mut(self.stride);
            if in_u {
                halve_u(&mut upper[..len], &mut lower[..len], nu, nv);
            } else {
                halve_v(&mut upper[..len], &mut lower[..len], nu, nv);
            }
        }
    }

    /// How many entries the stack has.
    pub fn depth(&self) -> usize {
        DEPTH
    }

    /// Coefficients between two entries of the stack.
    pub fn stride(&self) -> usize {
        self.stride
    }
}

/// AVX2 build of the baseline function: sums in the same order, hence identical bits.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn certify_wide<O: Objective>(
    search: &mut Search,
    pieces: &mut BezierPieces,
    problem: &Problem<'_, O>,
    best: &mut Descent,
) {
    search.certify_in(pieces, problem, best);
}

/// Tries every proof on one part.
#[inline(always)]
fn look(
    g: &[f64],
    grid: Grid,
    floor: f64,
    noise: f64,
    start: impl FnOnce() -> (f64, f64),
) -> Finding {
    let Grid { nu, nv, .. } = grid;
    if least(g) >= floor {
        return Finding::Clear;
    }
    for (s, t) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        if g[s * (nu - 1) * nv + t * (nv - 1)] < floor {
            return Finding::Below(s as f64, t as f64);
        }
    }
    let [(u_least, u_most), (v_least, v_most)] = first_differences(g, nu, nv);
    let side = |least: f64, most: f64| {
        if least >= 0.0 {
            Some(0.0)
        } else if most <= 0.0 {
            Some(1.0)
        } else {
            None
        }
    };
    match (side(u_least, u_most), side(v_least, v_most)) {
        // The least value is at a corner, and corners were looked at.
        (Some(_), Some(_)) => return Finding::Clear,
        (Some(s), None) => {
            let row = if s > 0.0 { (nu - 1) * nv } else { 0 };
            match edge_verdict(&g[row..row + nv], floor) {
                Verdict::Clear => return Finding::Clear,
                Verdict::Below(t, _) => return Finding::Below(s, t),
                Verdict::Open => {}
            }
        }
        (None, Some(t)) => {
            let column = if t > 0.0 { nv - 1 } else { 0 };
            let mut edge = [0.0; MAX_ORDER];
            for i in 0..nu {
                edge[i] = g[i * nv + column];
            }
            match edge_verdict(&edge[..nu], floor) {
                Verdict::Clear => return Finding::Clear,
                Verdict::Below(s, _) => return Finding::Below(s, t),
                Verdict::Open => {}
            }
        }
        (None, None) => {}
    }
    let bend = curvature(g, nu, nv);
    if bend.convex(64.0 * noise) {
        let (s, t) = start();
        match convex_verdict(g, nu, nv, floor, s, t) {
            Verdict::Clear => return Finding::Clear,
            Verdict::Below(s, t) => return Finding::Below(s, t),
            Verdict::Open => {}
        }
    }
    Finding::Open(bend.spread.0 >= bend.spread.1)
}
