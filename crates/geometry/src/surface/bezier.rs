//! The surface as Bézier pieces, with bounds.
//!
//! Every span of positive length in u and v gives one piece. Its homogeneous Bézier points are `Q =
//! E_u · P · E_vᵀ`, where the extraction matrices E depend on the knots only (blossoming; Piegl &
//! Tiller, *The NURBS Book*, §5.3 gives the same points by knot insertion), so a moved net costs
//! two small matrix products a piece and no allocation. A piece lies in the convex hull of its
//! points, hence in their axis-aligned box.

use super::joints::{Joints, Spot};
use super::tensor::{Frame, Surface, wrap};
use crate::basis::{KnotVector, MAX_DEGREE};
use crate::math::lanes::{Baseline, Four, Lanes};
use crate::math::{Point3, Vector3};

/// Movement of the net, relative to its size, up to which boxes are widened: at a hand's 2 mm/s a
/// body of 0.1 m then computes all of them every hundred ticks, and the wider ones let few more
/// pieces through.
const MOST_SLACK: f64 = 2e-3;

/// How two neighbouring spans meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Joint {
    /// At least one continuous derivative.
    Smooth,
    /// Continuous only: a knot of multiplicity `degree`.
    Crease,
    /// The end of the domain, or a knot of multiplicity `degree + 1`.
    Apart,
}

/// One span of positive length in one direction.
#[derive(Clone, Debug)]
pub(crate) struct Span {
    /// First parameter.
    pub start: f64,
    /// Last parameter.
    pub end: f64,
    /// Smallest parameter that can be reached from here over smooth joints; below the domain when
    /// that passes a period's end, −∞ when nothing stops it.
    pub reach_low: f64,
    /// Largest such parameter.
    pub reach_high: f64,
    /// Joint at `start`.
    pub before: Joint,
    /// Joint at `end`.
    pub after: Joint,
    /// First control point, modulo the count.
    first: usize,
    /// Extraction matrix, (degree + 1)², row k gives Bézier point k.
    extraction: Vec<f64>,
}

/// The spans of one direction.
#[derive(Clone, Debug)]
pub(crate) struct PieceDirection {
    pub degree: usize,
    pub count: usize,
    pub periodic: bool,
    pub domain: (f64, f64),
    pub spans: Vec<Span>,
}

impl PieceDirection {
    fn new(knots: &KnotVector) -> Self {
        let p = knots.degree();
        let t = knots.knots();
        let domain = knots.domain();
        let period = domain.1 - domain.0;
        let joint = |value: f64| match knots.multiplicity(value) {
            m if m < p => Joint::Smooth,
            m if m == p => Joint::Crease,
            _ => Joint::Apart,
        };
        // The continued knots of a periodic vector may cut the multiplicity short at one end: take
        // the larger.
        let seam = if knots.is_periodic() {
            match (joint(domain.0), joint(domain.1)) {
                (Joint::Apart, _) | (_, Joint::Apart) => Joint::Apart,
                (Joint::Crease, _) | (_, Joint::Crease) => Joint::Crease,
                _ => Joint::Smooth,
            }
        } else {
            Joint::Apart
        };
        let at = |value: f64| {
            if value == domain.0 || value == domain.1 {
                seam
            } else {
                joint(value)
            }
        };
        let mut spans: Vec<Span> = knots
            .spans()
            .map(|i| Span {
                start: t[i],
                end: t[i + 1],
                reach_low: t[i],
                reach_high: t[i + 1],
                before: at(t[i]),
                after: at(t[i + 1]),
                first: i - p,
                extraction: extraction(t, p, i, [t[i], t[i + 1]]),
            })
            .collect();
        let n = spans.len();
        for k in 0..n {
            let mut low = k as isize;
            while spans[low.rem_euclid(n as isize) as usize].before == Joint::Smooth
                && low > k as isize - n as isize
            {
                low -= 1;
            }
            let mut high = k;
            while spans[high % n].after == Joint::Smooth && high < k + n {
                high += 1;
            }
            let stopped_low = spans[low.rem_euclid(n as isize) as usize].before != Joint::Smooth;
            let stopped_high = spans[high % n].after != Joint::Smooth;
            let turns = low.div_euclid(n as isize) as f64;
            spans[k].reach_low = if stopped_low {
                spans[low.rem_euclid(n as isize) as usize].start + turns * period
            } else {
                f64::NEG_INFINITY
            };
            spans[k].reach_high = if stopped_high {
                spans[high % n].end + (high / n) as f64 * period
            } else {
                f64::INFINITY
            };
        }
        Self {
            degree: p,
            count: knots.count(),
            periodic: knots.is_periodic(),
            domain,
            spans,
        }
    }

    /// Span and period offset of an unwrapped parameter that lies between the reaches of the span
    /// it came from. At the upper reach the answer is the span that ends there.
    #[inline]
    pub fn locate(&self, x: f64, hint: usize, reach_high: f64) -> (usize, f64) {
        let here = &self.spans[hint];
        if x >= here.start && (x < here.end || (x == here.end && x >= reach_high)) {
            return (hint, 0.0);
        }
        let mut offset = 0.0;
        let mut y = x;
        if self.periodic && (y < self.domain.0 || y >= self.domain.1) {
            let period = self.domain.1 - self.domain.0;
            offset = period * ((y - self.domain.0) / period).floor();
            y = (y - offset).clamp(self.domain.0, self.domain.1);
        }
        let mut span = self.spans.partition_point(|s| s.start <= y).max(1) - 1;
        if x >= reach_high && y <= self.spans[span].start {
            if span == 0 {
                offset -= self.domain.1 - self.domain.0;
                span = self.spans.len() - 1;
            } else {
                span -= 1;
            }
        }
        (span, offset)
    }

    /// The span that holds a parameter of the domain; at a knot the one that starts there.
    pub fn span_of(&self, x: f64) -> usize {
        self.spans.partition_point(|s| s.start <= x).max(1) - 1
    }
}

/// Extraction matrix of span `i` over an interval: row k blossoms each basis function at
/// `degree − k` times its start and k times its end.
pub(crate) fn extraction(t: &[f64], p: usize, i: usize, [start, end]: [f64; 2]) -> Vec<f64> {
    let n = p + 1;
    let mut out = vec![0.0; n * n];
    for k in 0..n {
        // The share of each control point of the window in the result.
        let mut share = [0.0; MAX_DEGREE + 1];
        share[p] = 1.0;
        for r in (1..=p).rev() {
            let x = if r <= p - k { start } else { end };
            // Step r of de Boor: d_j ← (1 − a_j) d_{j−1} + a_j d_j for j = r ..= p; transposed,
            // from the last step back.
            let mut next = [0.0; MAX_DEGREE + 1];
            for j in r..=p {
                let column = i - p + j;
                let a = (x - t[column]) / (t[column + n - r] - t[column]);
                next[j - 1] += (1.0 - a) * share[j];
                next[j] += a * share[j];
            }
            share = next;
        }
        out[k * n..(k + 1) * n].copy_from_slice(&share[..n]);
    }
    out
}

/// Axis-aligned box, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least coordinates.
    pub min: Point3,
    /// Greatest coordinates.
    pub max: Point3,
}

/// The Bézier pieces of a surface: u-major over spans, homogeneous points u-major within a piece.
#[derive(Clone, Debug)]
pub struct BezierPieces {
    pub(crate) u: PieceDirection,
    pub(crate) v: PieceDirection,
    rational: bool,
    /// (pieces × (degree_u + 1)(degree_v + 1)), each (w x, w y, w z, w).
    points: Vec<[f64; 4]>,
    /// Six arrays, one value a piece: least x, y, z, greatest x, y, z.
    bounds: [Vec<f64>; 6],
    /// Which movement of the net a piece was computed for.
    stamps: Vec<u64>,
    now: u64,
    bounds_stamp: u64,
    /// The net that `bounds` hold, and how far any of its coordinates has moved since, m, with room
    /// for rounding.
    bounded: Vec<Point3>,
    slack_m: f64,
    slack_stamp: u64,
    /// Movement after which boxes are computed anew rather than widened, m.
    most_slack_m: f64,
    /// ((degree_u + 1) × columns) of the net, rows already in Bézier form.
    rows: Vec<[f64; 4]>,
    /// Of a branching surface.
    joints: Option<Box<Joints>>,
}

impl BezierPieces {
    /// Precomputes what depends on the knots, and the pieces of the present net.
    pub fn new(surface: &Surface) -> Self {
        let (u, v) = (
            PieceDirection::new(surface.knots_u()),
            PieceDirection::new(surface.knots_v()),
        );
        let pieces = u.spans.len() * v.spans.len();
        let size = (u.degree + 1) * (v.degree + 1);
        let mut new = Self {
            rational: surface.weights().is_some(),
            points: vec![[0.0; 4]; pieces * size],
            bounds: std::array::from_fn(|_| vec![0.0; pieces]),
            stamps: vec![0; pieces],
            now: 1,
            bounds_stamp: 0,
            bounded: surface.net().points().to_vec(),
            slack_m: 0.0,
            slack_stamp: 0,
            most_slack_m: MOST_SLACK * surface.size(),
            rows: vec![[0.0; 4]; (u.degree + 1) * v.count],
            joints: surface.joints().map(Box::new),
            u,
            v,
        };
        new.refresh(surface);
        new
    }

    /// Number of pieces.
    pub fn len(&self) -> usize {
        self.stamps.len()
    }

    /// Never: a surface has at least one piece.
    pub fn is_empty(&self) -> bool {
        self.stamps.is_empty()
    }

    /// True when the weights are not all one.
    pub fn is_rational(&self) -> bool {
        self.rational
    }

    /// Parameter rectangle of a piece: `([u_start, u_end], [v_start, v_end])`.
    pub fn rectangle(&self, piece: usize) -> ([f64; 2], [f64; 2]) {
        let (i, j) = (piece / self.v.spans.len(), piece % self.v.spans.len());
        (
            [self.u.spans[i].start, self.u.spans[i].end],
            [self.v.spans[j].start, self.v.spans[j].end],
        )
    }

    /// Homogeneous points of a piece, u-major, each (w x, w y, w z, w).
    pub fn points(&self, piece: usize) -> &[[f64; 4]] {
        let size = (self.u.degree + 1) * (self.v.degree + 1);
        &self.points[piece * size..(piece + 1) * size]
    }

    /// How the patches of a branching surface are joined.
    pub(crate) fn joints(&self) -> Option<&Joints> {
        self.joints.as_deref()
    }

    /// The piece is drawn elsewhere: no query answers with it, and its box is empty.
    #[inline(always)]
    pub fn is_duplicate(&self, piece: usize) -> bool {
        self.joints
            .as_ref()
            .is_some_and(|joints| joints.hidden()[piece])
    }

    /// The place to go on from where edge `side` of a patch (see [`super::joints::Edge`]) holds a
    /// place: over a joint.
    pub(crate) fn over_joint(&self, at: Spot, side: usize) -> Option<Spot> {
        let joints = self.joints()?;
        joints.edges_at(at)[side]
            .then(|| joints.beyond(at, side).next())
            .flatten()
            .map(|(spot, _)| spot)
    }

    /// Box that holds a piece, as of the last [`BezierPieces::refresh`].
    pub fn bounds(&self, piece: usize) -> Bounds {
        let b = &self.bounds;
        Bounds {
            min: Point3::new(b[0][piece], b[1][piece], b[2][piece]),
            max: Point3::new(b[3][piece], b[4][piece], b[5][piece]),
        }
    }

    pub(crate) fn bound_arrays(&self) -> &[Vec<f64>; 6] {
        &self.bounds
    }

    /// Recomputes points and boxes of every piece from the net. No allocation.
    pub fn refresh(&mut self, surface: &Surface) {
        self.now += 1;
        self.refresh_stale(surface);
    }

    /// Says that the net moved; pieces are recomputed when next asked for.
    pub(crate) fn net_changed(&mut self) {
        self.now += 1;
    }

    /// Recomputes everything that is older than the last movement.
    pub(crate) fn refresh_stale(&mut self, surface: &Surface) {
        if self.bounds_stamp == self.now {
            return;
        }
        debug_assert_eq!(
            surface.net().columns(),
            self.v.count,
            "pieces belong to another surface"
        );
        self.bounded.copy_from_slice(surface.net().points());
        (self.slack_m, self.slack_stamp, self.bounds_stamp) = (0.0, self.now, self.now);
        self.stamps.fill(self.now);
        #[cfg(target_arch = "x86_64")]
        if crate::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { refresh_wide(self, surface) };
        }
        self.refresh_all::<Baseline>(surface);
    }

    /// Boxes that hold the net as it is: those of an earlier net, and by how much to widen them.
    /// They only sort out what is far; what remains is to be judged by [`BezierPieces::fresh_box`],
    /// so no answer depends on how old they are.
    ///
    /// A piece's points are weighted means of the net's, so none moves farther than some point of
    /// the net.
    pub(crate) fn follow(&mut self, surface: &Surface) {
        if self.slack_stamp == self.now {
            return;
        }
        self.slack_stamp = self.now;
        let (mut moved, mut largest) = (0.0, 0.0);
        for (old, new) in self.bounded.iter().zip(surface.net().points()) {
            for c in 0..3 {
                let (d, size) = ((new[c] - old[c]).abs(), new[c].abs());
                moved = if d > moved { d } else { moved };
                largest = if size > largest { size } else { largest };
            }
        }
        self.slack_m = moved + 64.0 * f64::EPSILON * (largest + moved);
        if self.slack_m > self.most_slack_m {
            self.refresh_stale(surface);
        }
    }

    /// How much wider than [`BezierPieces::bounds`] the boxes must be taken, m.
    pub(crate) fn slack_m(&self) -> f64 {
        self.slack_m
    }

    /// Tells one set of boxes from the next.
    pub(crate) fn bounds_stamp(&self) -> u64 {
        self.bounds_stamp
    }

    /// The box of a piece of the present net: least corner, greatest corner.
    #[inline(always)]
    pub(crate) fn fresh_box(&mut self, surface: &Surface, piece: usize) -> ([f64; 3], [f64; 3]) {
        let columns = self.v.spans.len();
        self.refresh_piece(surface, piece / columns, piece % columns);
        if self.slack_m == 0.0 {
            let b = &self.bounds;
            return (
                [b[0][piece], b[1][piece], b[2][piece]],
                [b[3][piece], b[4][piece], b[5][piece]],
            );
        }
        let (min, max) = self.box_of::<Baseline>(piece);
        ([min[0], min[1], min[2]], [max[0], max[1], max[2]])
    }

    #[inline(always)]
    fn refresh_all<L: Lanes>(&mut self, surface: &Surface) {
        for i in 0..self.u.spans.len() {
            for column in 0..self.v.count {
                self.blend_rows::<L>(surface, i, column);
            }
            for j in 0..self.v.spans.len() {
                self.blend_columns::<L>(i, j);
                let piece = i * self.v.spans.len() + j;
                let (min, max) = self.box_of::<L>(piece);
                for c in 0..3 {
                    (self.bounds[c][piece], self.bounds[c + 3][piece]) = (min[c], max[c]);
                }
            }
        }
        if let Some(joints) = &self.joints {
            for piece in joints
                .hidden()
                .iter()
                .enumerate()
                .filter(|(_, hidden)| **hidden)
                .map(|(piece, _)| piece)
            {
                for c in 0..3 {
                    (self.bounds[c][piece], self.bounds[c + 3][piece]) =
                        (f64::INFINITY, f64::NEG_INFINITY);
                }
            }
        }
    }

    /// Recomputes the points of one piece if they are old; the same sums in the same order as a
    /// full refresh.
    #[inline(always)]
    pub(crate) fn refresh_piece(&mut self, surface: &Surface, i: usize, j: usize) {
        if self.stamps[i * self.v.spans.len() + j] != self.now {
            self.refresh_one(surface, i, j);
        }
    }

    #[inline(never)]
    fn refresh_one(&mut self, surface: &Surface, i: usize, j: usize) {
        self.stamps[i * self.v.spans.len() + j] = self.now;
        #[cfg(target_arch = "x86_64")]
        if crate::math::simd::has_avx2() {
            // SAFETY: the processor has AVX2, asked just above.
            #[allow(unsafe_code)]
            return unsafe { refresh_one_wide(self, surface, i, j) };
        }
        self.refresh_one_in::<Baseline>(surface, i, j);
    }

    #[inline(always)]
    fn refresh_one_in<L: Lanes>(&mut self, surface: &Surface, i: usize, j: usize) {
        for b in 0..=self.v.degree {
            self.blend_rows::<L>(surface, i, wrap(self.v.spans[j].first + b, self.v.count));
        }
        self.blend_columns::<L>(i, j);
    }

    #[inline(always)]
    fn blend_rows<L: Lanes>(&mut self, surface: &Surface, i: usize, column: usize) {
        match self.u.degree {
            3 => self.blend_rows_of::<L>(3, surface, i, column),
            p => self.blend_rows_of::<L>(p, surface, i, column),
        }
    }

    #[inline(always)]
    fn blend_rows_of<L: Lanes>(&mut self, p: usize, surface: &Surface, i: usize, column: usize) {
        let span = &self.u.spans[i];
        let (points, columns) = (surface.net().points(), self.v.count);
        let mut window = [L::splat(0.0); MAX_DEGREE + 1];
        for a in 0..=p {
            let k = wrap(span.first + a, self.u.count) * columns + column;
            let w = surface.weights().map_or(1.0, |w| w[k]);
            let x = &points[k];
            window[a] = L::load(&if self.rational {
                [x.x * w, x.y * w, x.z * w, w]
            } else {
                [x.x, x.y, x.z, 1.0]
            });
        }
        for k in 0..=p {
            let share = &span.extraction[k * (p + 1)..(k + 1) * (p + 1)];
            let mut sum = L::splat(0.0);
            for a in 0..=p {
                sum = sum + L::splat(share[a]) * window[a];
            }
            sum.store(&mut self.rows[k * columns + column]);
        }
    }

    #[inline(always)]
    fn blend_columns<L: Lanes>(&mut self, i: usize, j: usize) {
        match (self.u.degree, self.v.degree) {
            (3, 3) => self.blend_columns_of::<L>(3, 3, i, j),
            (p, q) => self.blend_columns_of::<L>(p, q, i, j),
        }
    }

    #[inline(always)]
    fn blend_columns_of<L: Lanes>(&mut self, p: usize, q: usize, i: usize, j: usize) {
        let span = &self.v.spans[j];
        let size = (p + 1) * (q + 1);
        let piece = i * self.v.spans.len() + j;
        let out = &mut self.points[piece * size..(piece + 1) * size];
        let extraction = &span.extraction[..(q + 1) * (q + 1)];
        for k in 0..=p {
            let row = &self.rows[k * self.v.count..(k + 1) * self.v.count];
            let mut window = [L::splat(0.0); MAX_DEGREE + 1];
            for b in 0..=q {
                window[b] = L::load(&row[wrap(span.first + b, self.v.count)]);
            }
            for l in 0..=q {
                let mut sum = L::splat(0.0);
                for b in 0..=q {
                    sum = sum + L::splat(extraction[l * (q + 1) + b]) * window[b];
                }
                let out = &mut out[k * (q + 1) + l];
                sum.store(out);
                if !self.rational {
                    out[3] = 1.0;
                }
            }
        }
    }

    /// Least and greatest coordinates of a piece's points; the fourth of each means nothing.
    #[inline(always)]
    fn box_of<L: Lanes>(&self, piece: usize) -> (Four, Four) {
        let size = (self.u.degree + 1) * (self.v.degree + 1);
        let (mut min, mut max) = (L::splat(f64::INFINITY), L::splat(f64::NEG_INFINITY));
        for x in &self.points[piece * size..(piece + 1) * size] {
            let mut value = L::load(x);
            if self.rational {
                value = value * L::splat(1.0 / x[3]);
            }
            min = value.least(min);
            max = value.greatest(max);
        }
        let (mut low, mut high) = ([0.0; 4], [0.0; 4]);
        min.store(&mut low);
        max.store(&mut high);
        (low, high)
    }

    /// The points of a piece at each pair of local parameters, u-major, of which the shares of its rows and columns are given
    /// (see [`shares`]); the same bits as in [`BezierPieces::frame`].
    #[inline(always)]
    pub(crate) fn points_at(
        &self,
        piece: usize,
        [us, vs]: [&[Shares]; 2],
        mut take: impl FnMut(usize, Point3),
    ) {
        let (p, q) = (self.u.degree, self.v.degree);
        let points = self.points(piece);
        let mix = |sum: &mut [f64; 4], share: f64, x: &[f64; 4]| {
            for m in 0..4 {
                sum[m] += share * x[m];
            }
        };
        for (b, v) in vs.iter().enumerate() {
            let mut rows = [[0.0; 4]; MAX_DEGREE + 1];
            for k in 0..=p {
                for l in 0..=q {
                    mix(&mut rows[k], v[l], &points[k * (q + 1) + l]);
                }
            }
            for (a, u) in us.iter().enumerate() {
                let mut x = [0.0; 4];
                for k in 0..=p {
                    mix(&mut x, u[k], &rows[k]);
                }
                let point = Point3::new(x[0], x[1], x[2]);
                take(
                    a * vs.len() + b,
                    match self.rational {
                        true => point / x[3],
                        false => point,
                    },
                );
            }
        }
    }

    /// Point and derivatives at a parameter pair of the domain, as of the last movement that the piece was computed for.
    pub(crate) fn frame_at(&self, [u, v]: [f64; 2]) -> Frame {
        let (i, j) = (self.u.span_of(u), self.v.span_of(v));
        let local = |span: &Span, x: f64| (x - span.start) / (span.end - span.start);
        let (s, t) = (local(&self.u.spans[i], u), local(&self.v.spans[j], v));
        self.frame(i, j, s, t)
    }

    /// Point and derivatives of piece (i, j) at local parameters (s, t) in [0, 1], by the surface's
    /// own parameters.
    #[inline(always)]
    pub(crate) fn frame(&self, i: usize, j: usize, s: f64, t: f64) -> Frame {
        let scale = (
            1.0 / (self.u.spans[i].end - self.u.spans[i].start),
            1.0 / (self.v.spans[j].end - self.v.spans[j].start),
        );
        let points = self.points(i * self.v.spans.len() + j);
        match (self.u.degree, self.v.degree, self.rational) {
            (3, 3, false) => polynomial_frame(contract::<4>(points, 3, 3, s, t), scale),
            (p, q, false) => {
                polynomial_frame(contract::<{ MAX_DEGREE + 1 }>(points, p, q, s, t), scale)
            }
            (p, q, true) => {
                rational_frame(contract::<{ MAX_DEGREE + 1 }>(points, p, q, s, t), scale)
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn refresh_wide(pieces: &mut BezierPieces, surface: &Surface) {
    pieces.refresh_all::<crate::math::lanes::Wide>(surface);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn refresh_one_wide(pieces: &mut BezierPieces, surface: &Surface, i: usize, j: usize) {
    pieces.refresh_one_in::<crate::math::lanes::Wide>(surface, i, j);
}

/// Bernstein functions at one parameter; those beyond the degree are 0.
pub(crate) type Shares = [f64; MAX_DEGREE + 1];

/// Shares of the points of a row or column of a piece in the point at a local parameter.
pub(crate) fn shares(degree: usize, t: f64) -> Shares {
    bernstein::<{ MAX_DEGREE + 1 }>(degree, t)[0]
}

/// Bernstein functions of degree `p` with two derivatives, in arrays of `N > p`.
#[inline(always)]
pub(crate) fn bernstein<const N: usize>(p: usize, t: f64) -> [[f64; N]; 3] {
    let mut out = [[0.0; N]; 3];
    let r = 1.0 - t;
    // b grows from degree 0; its last two stages give the derivatives.
    let mut b = [0.0; N];
    b[0] = 1.0;
    for k in 1..=p {
        if k == p {
            out[1][0] = -(p as f64) * b[0];
            for i in 1..p {
                out[1][i] = p as f64 * (b[i - 1] - b[i]);
            }
            out[1][p] = p as f64 * b[p - 1];
        }
        if k + 1 == p {
            let scale = (p * (p - 1)) as f64;
            for i in 0..=p {
                let low = if i >= 2 { b[i - 2] } else { 0.0 };
                let mid = if i >= 1 && i < p { b[i - 1] } else { 0.0 };
                let high = if i + 2 <= p { b[i] } else { 0.0 };
                out[2][i] = scale * (low - 2.0 * mid + high);
            }
        }
        let mut saved = 0.0;
        for i in 0..k {
            let x = b[i];
            b[i] = saved + r * x;
            saved = t * x;
        }
        b[k] = saved;
    }
    out[0] = b;
    out
}

/// Sums over a piece's points: value, ∂s, ∂t, ∂ss, ∂st, ∂tt.
#[inline(always)]
fn contract<const N: usize>(
    points: &[[f64; 4]],
    p: usize,
    q: usize,
    s: f64,
    t: f64,
) -> [[f64; 4]; 6] {
    let (bu, bv) = (bernstein::<N>(p, s), bernstein::<N>(q, t));
    let points = &points[..(p + 1) * (q + 1)];
    let mut out = [[0.0; 4]; 6];
    for k in 0..=p {
        let (mut a, mut b, mut c) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        for l in 0..=q {
            let x = &points[k * (q + 1) + l];
            for m in 0..4 {
                a[m] += bv[0][l] * x[m];
                b[m] += bv[1][l] * x[m];
                c[m] += bv[2][l] * x[m];
            }
        }
        for m in 0..4 {
            out[0][m] += bu[0][k] * a[m];
            out[1][m] += bu[1][k] * a[m];
            out[2][m] += bu[0][k] * b[m];
            out[3][m] += bu[2][k] * a[m];
            out[4][m] += bu[1][k] * b[m];
            out[5][m] += bu[0][k] * c[m];
        }
    }
    out
}

#[inline(always)]
fn polynomial_frame([x, xu, xv, xuu, xuv, xvv]: [[f64; 4]; 6], (su, sv): (f64, f64)) -> Frame {
    let vector = |x: [f64; 4], scale: f64| Vector3::new(x[0] * scale, x[1] * scale, x[2] * scale);
    Frame {
        point: Point3::new(x[0], x[1], x[2]),
        du: vector(xu, su),
        dv: vector(xv, sv),
        duu: vector(xuu, su * su),
        duv: vector(xuv, su * sv),
        dvv: vector(xvv, sv * sv),
    }
}

/// Quotient rule on A / w; *The NURBS Book*, eq. 4.20.
fn rational_frame([x, xu, xv, xuu, xuv, xvv]: [[f64; 4]; 6], (su, sv): (f64, f64)) -> Frame {
    let vector = |x: [f64; 4], scale: f64| {
        (
            Vector3::new(x[0] * scale, x[1] * scale, x[2] * scale),
            x[3] * scale,
        )
    };
    let (a, w) = vector(x, 1.0);
    let (a_u, w_u) = vector(xu, su);
    let (a_v, w_v) = vector(xv, sv);
    let (a_uu, w_uu) = vector(xuu, su * su);
    let (a_uv, w_uv) = vector(xuv, su * sv);
    let (a_vv, w_vv) = vector(xvv, sv * sv);
    let point = a / w;
    let du = (a_u - point * w_u) / w;
    let dv = (a_v - point * w_v) / w;
    Frame {
        point: Point3::from(point),
        du,
        dv,
        duu: (a_uu - du * (2.0 * w_u) - point * w_uu) / w,
        duv: (a_uv - du * w_v - dv * w_u - point * w_uv) / w,
        dvv: (a_vv - dv * (2.0 * w_v) - point * w_vv) / w,
    }
}
