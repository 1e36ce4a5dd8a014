//! How far query and net may move before a foot could stop being the global one.
//!
//! Let d be the distance at the foot, B a parameter box around it, and c a lower bound of the
//! distance everywhere outside B. While query and net together have moved by m < (c − d) / 2, every
//! point outside B is farther than the foot's own neighbourhood, so the answer is inside B, and a
//! descent that never goes up cannot leave B. If the squared distance is also convex on B, and
//! stays so for such movements, Newton inside B finds the only minimum there.
//!
//! The Hessian of |D|², D = S − q, is `2 (D_s·D_s + D·D_ss)` and so on. A movement of the query by
//! m changes it by at most `2 m |D_ss|`; one of the control points also changes the derivatives, by
//! at most 2p m (first) and 4p(p − 1) m (second, in a piece's own parameters). A symmetric 2 × 2
//! matrix with diagonal a, b and |off-diagonal| ≤ g stays positive while the entries change by less
//! than θa, θb and θ√(ab), θ = (1 − g / √(ab)) / 2.

use super::basin::Clip;
use super::bernstein::{curvature, least, restrict_u, restrict_v};
use super::newton::{Descent, NewtonPlace};
use super::objective::{Distance, Grid, Objective, Problem};
use super::search::{Search, SearchPart};
use crate::surface::bezier::{BezierPieces, Joint, PieceDirection};

/// Share of the gap between distance and nearest outside value that is claimed; less is proved
/// sooner.
const CLAIM: f64 = 0.7;
/// Parts looked at before giving up: then the next query searches again.
const PATIENCE: usize = 600;

/// A strip with nothing in it.
const NOTHING: ([f64; 2], [f64; 2]) = ([0.0; 2], [0.0; 2]);
/// All of a piece.
const WHOLE: Clip = Clip {
    s: [0.0, 1.0],
    t: [0.0, 1.0],
};

/// What [`certificate`] grants.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Grant {
    /// Movement of the query, m.
    pub budget_m: f64,
    /// How many metres of it one metre of net movement uses up, ≥ 1.
    pub net_cost: f64,
}

/// A box of unwrapped parameters around the foot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    pub u: [f64; 2],
    pub v: [f64; 2],
}

/// Largest changes of the Hessian that are allowed, over what one metre does.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slack {
    /// θa, θb, θ√(ab).
    room: [f64; 3],
    /// Change by a metre of query movement (uu, vv, uv).
    query: [f64; 3],
    /// |D|, |D_s|, |D_t|, |D_ss|, |D_tt|, |D_st| at most, and the parts' widths.
    d: [f64; 6],
    widths: [f64; 2],
    /// |w|, and |(w²)_ss|, |(w²)_tt|, |(w²)_st| at most.
    weight: f64,
    weight_bends: [f64; 3],
}

/// Budget of a foot. Above zero only if the foot is global, whether or not that was known.
pub(super) fn certificate(
    search: &mut Search,
    pieces: &mut BezierPieces,
    problem: &Problem<'_, Distance>,
    best: &Descent,
) -> Grant {
    #[cfg(target_arch = "x86_64")]
    if crate::math::simd::has_avx2() {
        // SAFETY: the processor has AVX2, asked just above.
        #[allow(unsafe_code)]
        return unsafe { certificate_wide(search, pieces, problem, best) };
    }
    certificate_in(search, pieces, problem, best)
}

/// AVX2 build of the baseline function: sums in the same order, hence identical bits.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn certificate_wide(
    search: &mut Search,
    pieces: &mut BezierPieces,
    problem: &Problem<'_, Distance>,
    best: &Descent,
) -> Grant {
    certificate_in(search, pieces, problem, best)
}

#[inline(always)]
fn certificate_in(
    search: &mut Search,
    pieces: &mut BezierPieces,
    problem: &Problem<'_, Distance>,
    best: &Descent,
) -> Grant {
    match Grid::of(problem.objective, pieces) {
        Grid::BICUBIC => certify(Grid::BICUBIC, search, pieces, problem, best),
        grid => certify(grid, search, pieces, problem, best),
    }
}

#[inline(always)]
fn certify(
    grid: Grid,
    search: &mut Search,
    pieces: &mut BezierPieces,
    problem: &Problem<'_, Distance>,
    best: &Descent,
) -> Grant {
    let nothing = Grant {
        budget_m: 0.0,
        net_cost: 1.0,
    };
    let (size_m, rational) = (problem.size_m, grid.rational);
    let distance = best.jet.f.max(0.0).sqrt();
    let mut share = 0.5;
    for _ in 0..5 {
        let around = surround(pieces, &best.place, share);
        if let Some((slacks, count)) = slacks(grid, search, pieces, problem, best.jet.f, around) {
            let slacks = &slacks[..count];
            let limit = query_limit(slacks, rational, pieces, distance).min(10.0 * size_m);
            let outside = Outside {
                around: Some(around),
                clips: None,
                distance,
            };
            let gap = gap_outside(grid, search, pieces, problem, &outside, 2.0 * limit);
            let budget_m = 0.999 * limit.min(0.5 * gap);
            if budget_m <= 1e-9 * size_m {
                return nothing;
            }
            let mut net_cost: f64 = 1.0;
            if !rational {
                for slack in slacks {
                    net_cost =
                        net_cost.max(budget_m / net_limit(slack, pieces, distance, budget_m));
                }
            }
            return Grant { budget_m, net_cost };
        }
        share *= 0.5;
    }
    nothing
}

/// A box of `share` of the foot's own spans to each side, not past a crease or the far end of a
/// neighbouring span.
pub(super) fn surround(pieces: &BezierPieces, at: &NewtonPlace, share: f64) -> Around {
    let one = |d: &PieceDirection, k: usize, x: f64| {
        let (n, span) = (d.spans.len(), &d.spans[k]);
        let reach = share * (span.end - span.start);
        let (mut low, mut high) = (span.start, span.end);
        if n > 1 && span.before == Joint::Smooth {
            let other = &d.spans[(k + n - 1) % n];
            low -= other.end - other.start;
        }
        if n > 1 && span.after == Joint::Smooth {
            let other = &d.spans[(k + 1) % n];
            high += other.end - other.start;
        }
        [(x - reach).max(low), (x + reach).min(high)]
    };
    Around {
        u: one(&pieces.u, at.i, at.u),
        v: one(&pieces.v, at.j, at.v),
    }
}

/// The part of span `k` that a box covers, in the span's own [0, 1]; periodic directions are
/// unwrapped.
fn covered(d: &PieceDirection, k: usize, range: [f64; 2]) -> Option<[f64; 2]> {
    let span = &d.spans[k];
    let width = span.end - span.start;
    let period = d.domain.1 - d.domain.0;
    let offsets: &[f64] = if d.periodic {
        &[0.0, -1.0, 1.0]
    } else {
        &[0.0]
    };
    offsets.iter().find_map(|turn| {
        let low = ((range[0] + turn * period - span.start) / width).max(0.0);
        let high = ((range[1] + turn * period - span.start) / width).min(1.0);
        (high - low > 1e-12).then_some([
            if low < 1e-12 { 0.0 } else { low },
            if high > 1.0 - 1e-12 { 1.0 } else { high },
        ])
    })
}

/// How far the query may move while the Hessian stays positive, m.
pub(super) fn query_limit(
    slacks: &[Slack],
    rational: bool,
    pieces: &BezierPieces,
    distance: f64,
) -> f64 {
    let of = |slack: &Slack| match rational {
        true => net_limit(slack, pieces, distance, 0.0),
        false => (0..3).fold(f64::INFINITY, |m, k| {
            m.min(slack.room[k] / slack.query[k].max(f64::MIN_POSITIVE))
        }),
    };
    slacks.iter().map(of).fold(f64::INFINITY, f64::min)
}

/// Convexity over the box, part by part, of the squared distance less `level` times the squared weight; `None` where it is
/// not proved. At most nine pieces meet a box.
#[inline(always)]
pub(super) fn slacks(
    grid: Grid,
    search: &mut Search,
    pieces: &mut BezierPieces,
    problem: &Problem<'_, Distance>,
    level: f64,
    around: Around,
) -> Option<([Slack; 9], usize)> {
    let zero = Slack {
        room: [0.0; 3],
        query: [0.0; 3],
        d: [0.0; 6],
        widths: [0.0; 2],
        weight: 1.0,
        weight_bends: [0.0; 3],
    };
    let (mut out, mut count) = ([zero; 9], 0);
    let Grid { nu, nv, rational } = grid;
    let (len, objective) = (grid.len(), problem.objective);
    for i in 0..pieces.u.spans.len() {
        let Some(s) = covered(&pieces.u, i, around.u) else {
            continue;
        };
        for j in 0..pieces.v.spans.len() {
            let Some(t) = covered(&pieces.v, j, around.v) else {
                continue;
            };
            let piece = i * pieces.v.spans.len() + j;
            pieces.refresh_piece(problem.surface, i, j);
            let noise = objective.form(pieces, piece, problem.tables, &mut search.a, &mut search.w);
            let mut slack = Slack {
                widths: [s[1] - s[0], t[1] - t[0]],
                ..zero
            };
            if rational {
                let w = &mut search.w[..len];
                restrict_u(w, nu, nv, s[0], s[1]);
                restrict_v(w, nu, nv, t[0], t[1]);
                let bend = curvature(w, nu, nv);
                slack.weight_bends = [bend.spread.0, bend.spread.1, bend.uv];
            }
            let a = &mut search.a[..len];
            restrict_u(a, nu, nv, s[0], s[1]);
            restrict_v(a, nu, nv, t[0], t[1]);
            if rational {
                for x in 0..len {
                    a[x] -= level * search.w[x];
                }
            }
            let bend = curvature(a, nu, nv);
            let noise = if rational {
                noise.on(&search.w[..len])
            } else {
                noise.absolute
            };
            if !bend.convex(64.0 * noise) || count == out.len() {
                return None;
            }
            let root = (bend.uu * bend.vv).sqrt();
            let theta = 0.49 * (1.0 - bend.uv / root);
            slack.room = [theta * bend.uu, theta * bend.vv, theta * root];
            measure(pieces, piece, objective, &mut slack);
            slack.query = [2.0 * slack.d[3], 2.0 * slack.d[4], 2.0 * slack.d[5]];
            out[count] = slack;
            count += 1;
        }
    }
    Some((out, count))
}

/// Bounds of D = N − q w and its derivatives in the part's own parameters, from the control points
/// of the piece.
fn measure(pieces: &BezierPieces, piece: usize, objective: &Distance, slack: &mut Slack) {
    let (p, q) = (pieces.u.degree, pieces.v.degree);
    let points = pieces.points(piece);
    let width = q + 1;
    // Differences of (w x, w y, w z, w) are linear in the query: subtract it at the end.
    let length = |x: [f64; 4]| {
        let d = [
            x[0] - objective.q.x * x[3],
            x[1] - objective.q.y * x[3],
            x[2] - objective.q.z * x[3],
        ];
        d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
    };
    let mix = |x: &[f64; 4], a: f64, y: &[f64; 4], b: f64, z: &[f64; 4]| -> [f64; 4] {
        std::array::from_fn(|c| x[c] + a * y[c] + b * z[c])
    };
    let zero = [0.0; 4];
    let mut most = [0.0_f64; 6];
    let mut raise = |k: usize, value: f64| most[k] = if value > most[k] { value } else { most[k] };
    for k in 0..=p {
        for l in 0..=q {
            let x = &points[k * width + l];
            raise(0, length(*x));
            slack.weight = slack.weight.max(x[3]);
            if k < p {
                let next = &points[(k + 1) * width + l];
                raise(1, length(mix(next, -1.0, x, 0.0, &zero)));
                if k + 1 < p {
                    raise(
                        3,
                        length(mix(&points[(k + 2) * width + l], -2.0, next, 1.0, x)),
                    );
                }
            }
            if l < q {
                let next = &points[k * width + l + 1];
                raise(2, length(mix(next, -1.0, x, 0.0, &zero)));
                if l + 1 < q {
                    raise(
                        4,
                        length(mix(&points[k * width + l + 2], -2.0, next, 1.0, x)),
                    );
                }
                if k < p {
                    let across = mix(
                        &points[(k + 1) * width + l + 1],
                        -1.0,
                        &points[(k + 1) * width + l],
                        0.0,
                        &zero,
                    );
                    raise(5, length(mix(&across, -1.0, next, 1.0, x)));
                }
            }
        }
    }
    let (p, q, [s, t]) = (p as f64, q as f64, slack.widths);
    let factors = [
        1.0,
        p * s,
        q * t,
        p * (p - 1.0) * s * s,
        q * (q - 1.0) * t * t,
        p * q * s * t,
    ];
    for k in 0..6 {
        slack.d[k] = factors[k] * most[k].sqrt();
    }
}

/// How far every control point may move, when the query has also moved by up to `query_m`.
fn net_limit(slack: &Slack, pieces: &BezierPieces, distance: f64, query_m: f64) -> f64 {
    let (p, q) = (pieces.u.degree as f64, pieces.v.degree as f64);
    let [d, ds, dt, dss, dtt, dst] = slack.d;
    let d = d + query_m * slack.weight;
    let [s, t] = slack.widths;
    // What one metre does to D_s, D_t, D_ss, D_tt, D_st.
    let w = slack.weight;
    let (ms, mt) = (2.0 * p * s * w, 2.0 * q * t * w);
    let (mss, mtt, mst) = (
        4.0 * p * (p - 1.0) * s * s * w,
        4.0 * q * (q - 1.0) * t * t * w,
        4.0 * p * q * s * t * w,
    );
    let b = slack.weight_bends;
    let linear = [
        2.0 * (2.0 * ds * ms + d * mss + w * dss) + 2.0 * distance * b[0],
        2.0 * (2.0 * dt * mt + d * mtt + w * dtt) + 2.0 * distance * b[1],
        2.0 * (ds * mt + dt * ms + d * mst + w * dst) + 2.0 * distance * b[2],
    ];
    let square = [
        2.0 * (ms * ms + w * mss) + b[0],
        2.0 * (mt * mt + w * mtt) + b[1],
        2.0 * (ms * mt + w * mst) + b[2],
    ];
    (0..3).fold(f64::INFINITY, |limit, k| {
        // linear m + square m² = room, without cancellation.
        let root = (linear[k] * linear[k] + 4.0 * square[k] * slack.room[k]).sqrt();
        limit.min(2.0 * slack.room[k] / (linear[k] + root).max(f64::MIN_POSITIVE))
    })
}

/// What of a surface is compared with a distance.
pub(super) struct Outside<'a> {
    /// All but a box of parameters.
    pub around: Option<Around>,
    /// What is within the clips of the pieces, if there are any.
    pub clips: Option<&'a [Clip]>,
    /// m.
    pub distance: f64,
}

/// Lower bound on (distance outside the box) − distance, at most `most`.
#[inline(always)]
pub(super) fn gap_outside(
    grid: Grid,
    search: &mut Search,
    pieces: &mut BezierPieces,
    problem: &Problem<'_, Distance>,
    outside: &Outside<'_>,
    most: f64,
) -> f64 {
    let Grid { nu, nv, rational } = grid;
    let (len, stride) = (grid.len(), search.stride());
    let (objective, distance) = (problem.objective, outside.distance);
    // `upper`: least value seen outside, as a gap.
    let mut upper = most / CLAIM;
    let mut visited = 0;
    let squared = |gap: f64| (distance + gap) * (distance + gap);
    search.candidates(pieces, problem.surface, objective, squared(CLAIM * upper));
    let mut k = 0;
    while let Some((bound, piece)) = search.candidate(k) {
        k += 1;
        if bound >= squared(CLAIM * upper) {
            break;
        }
        let clip = outside.clips.map_or(WHOLE, |clips| clips[piece]);
        if clip.s[1] <= clip.s[0] || clip.t[1] <= clip.t[0] {
            continue;
        }
        let noise = objective.form(pieces, piece, problem.tables, &mut search.a, &mut search.w);
        let whole = SearchPart::whole(pieces, piece);
        search.parts.clear();
        let box_in = |around: Around| {
            let s = covered(&pieces.u, whole.i, around.u)?;
            let t = covered(&pieces.v, whole.j, around.v)?;
            let s = [s[0].max(clip.s[0]), s[1].min(clip.s[1])];
            let t = [t[0].max(clip.t[0]), t[1].min(clip.t[1])];
            (s[1] > s[0] && t[1] > t[0]).then_some((s, t))
        };
        // The piece without the box: strips on both sides in u, and what is left on both sides in v.
        let strips = match outside.around.and_then(box_in) {
            Some((s, t)) => [
                ([clip.s[0], s[0]], clip.t),
                ([s[1], clip.s[1]], clip.t),
                (s, [clip.t[0], t[0]]),
                (s, [t[1], clip.t[1]]),
            ],
            None => [(clip.s, clip.t), NOTHING, NOTHING, NOTHING],
        };
        if strips[0] == (WHOLE.s, WHOLE.t) {
            search.parts.push(whole);
        } else {
            search.g[..len].copy_from_slice(&search.a[..len]);
            let mut used = 0;
            for (s, t) in strips {
                if s[1] <= s[0] || t[1] <= t[0] {
                    continue;
                }
                let slot = used * stride;
                search.a[slot..slot + len].copy_from_slice(&search.g[..len]);
                restrict_u(&mut search.a[slot..slot + len], nu, nv, s[0], s[1]);
                restrict_v(&mut search.a[slot..slot + len], nu, nv, t[0], t[1]);
                search.parts.push(SearchPart { s, t, ..whole });
                used += 1;
            }
            if rational {
                // W of the whole piece waits beyond the strips' slots until each has its own.
                let kept = 4 * stride;
                search.w.copy_within(0..len, kept);
                for slot in 0..used {
                    let SearchPart { s, t, .. } = search.parts[slot];
                    search.w.copy_within(kept..kept + len, slot * stride);
                    let w = &mut search.w[slot * stride..slot * stride + len];
                    restrict_u(w, nu, nv, s[0], s[1]);
                    restrict_v(w, nu, nv, t[0], t[1]);
                }
            }
        }
        while let Some(part) = search.parts.last().copied() {
            visited += 1;
            if visited > PATIENCE || search.parts.len() + 1 >= search.depth() {
                return 0.0;
            }
            let slot = (search.parts.len() - 1) * stride;
            for corner in [0, nv - 1, (nu - 1) * nv, len - 1] {
                let mut value = search.a[slot + corner];
                if rational {
                    value /= search.w[slot + corner];
                }
                upper = upper.min(value.max(0.0).sqrt() - distance);
            }
            if upper <= 4e-9 * problem.size_m {
                return 0.0;
            }
            let floor = squared(CLAIM * upper);
            let clear = if rational {
                for x in 0..len {
                    search.g[x] = search.a[slot + x] - (floor + noise.of_w) * search.w[slot + x];
                }
                least(&search.g[..len]) >= noise.absolute
            } else {
                least(&search.a[slot..slot + len]) >= floor + noise.absolute
            };
            if clear {
                search.parts.pop();
                continue;
            }
            let bend = curvature(&search.a[slot..slot + len], nu, nv);
            let in_u = bend.spread.0 >= bend.spread.1;
            let (wide_u, wide_v) = (part.s[1] - part.s[0] > 1e-6, part.t[1] - part.t[0] > 1e-6);
            if !wide_u && !wide_v {
                return 0.0;
            }
            let in_u = if in_u { wide_u } else { !wide_v };
            search.halve(grid, in_u);
        }
    }
    CLAIM * upper
}
