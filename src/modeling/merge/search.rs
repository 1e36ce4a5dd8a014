//! The choice of parameters and knots: candidates are fitted on a few lines, and the one that misses least is kept.
//!
//! ```text
//! shares of the domain (lengths, or speeds at the seam) ─┐
//! blends at the seam (the source's, or sharper) ─────────┴▶ fit on a few lines ──▶ the best ──▶ each knot tried to both sides
//! ```
//! Nothing here decides whether an answer is right, only which of several right ones is nearer. Work is bounded.

use super::axis::{Axis, LINES};
use super::fit::{Ends, LineFit};
use super::knots::{Interiors, Intervals, Knots, interiors};

/// Shares of the way to the next knot at which a seam's freed knots are tried, beside the source's.
const BLENDS: [f64; 4] = [0.35, 0.2, 0.1, 0.05];
/// A sharper blend, or other shares, must leave less than this share of the sum of squares.
const WORTH: f64 = 0.9;
/// Rounds in which every knot is tried to both sides; steps are halved from one to the next.
const ROUNDS: usize = 4;
/// First step of a knot, as a share of the way to its neighbour.
const FIRST_STEP: f64 = 0.4;
/// Gaps below this share of the length are none.
const TOUCHING: f64 = 1e-6;

/// What was chosen for a direction.
pub(super) struct Choice {
    pub at: Intervals,
    pub knots: Knots,
}

/// Parameters and knots for a direction; as many as the source has.
pub(super) fn choose(axis: &Axis, continuity: usize, least_span: f64) -> Choice {
    let interiors = shown(axis);
    let seed = Knots::seed_blend(continuity);
    let mut best: Option<(f64, Choice)> = None;
    for at in intervals(axis) {
        let data = Data::new(axis, &at);
        let least = least_gap(&at, least_span);
        let sharper = BLENDS.into_iter().filter(|&b| axis.blocks.len() > 1 && continuity > 0 && b < seed);
        for blend in std::iter::once(seed).chain(sharper) {
            let knots = Knots::joined(axis.degree, continuity, &interiors, &at, blend);
            if blend < seed && knots.least_span_at_seams() < least {
                break;
            }
            let miss = data.miss(&knots);
            if best.as_ref().is_none_or(|(fewest, _)| miss < fewest * WORTH) {
                best = Some((miss, Choice { at: at.clone(), knots }));
            }
        }
    }
    let (miss, mut choice) = best.expect("lengths always give a candidate");
    let least = least_gap(&choice.at, least_span);
    improve(&Data::new(axis, &choice.at), &mut choice.knots, miss, least);
    choice
}

/// Interior knots as fractions of what shows of each block. Those in hidden parts are put into the widest gaps instead, so
/// that their number stays.
fn shown(axis: &Axis) -> Interiors {
    let all = interiors(axis);
    let shown = all.into_iter().zip(&axis.blocks).map(|(inner, block)| {
        let (start, end) = block.shown();
        let wanted = inner.len();
        let mut kept: Vec<f64> =
            inner.into_iter().filter(|&t| t > start && t < end).map(|t| (t - start) / (end - start)).collect();
        while kept.len() < wanted {
            let ends: Vec<f64> = std::iter::once(0.0).chain(kept.iter().copied()).chain([1.0]).collect();
            let widest = (1..ends.len()).fold(1, |w, k| if ends[k] - ends[k - 1] > ends[w] - ends[w - 1] { k } else { w });
            kept.insert(widest - 1, 0.5 * (ends[widest - 1] + ends[widest]));
        }
        kept
    });
    shown.collect()
}

/// Shares of the merged parameter: by lengths, and by the speeds with which the patches arrive at the seams.
pub(super) fn intervals(axis: &Axis) -> Vec<Intervals> {
    let n = axis.blocks.len();
    let lengths: Vec<f64> = (0..n).map(|b| axis.length_m(b).max(f64::MIN_POSITIVE)).collect();
    let whole: f64 = lengths.iter().sum();
    let gaps: Vec<f64> = (1..n).map(|b| axis.gap_m(b - 1)).map(|g| if g > TOUCHING * whole { g } else { 0.0 }).collect();
    let mut all = vec![laid(&lengths, &gaps)];
    let mut shares = vec![lengths[0]];
    let mut bridged = Vec::new();
    for b in 1..n {
        let part = |block: usize| axis.blocks[block].shown().1 - axis.blocks[block].shown().0;
        // Metres for a unit of the merged parameter, on arriving at the seam; the next patch leaves it as fast.
        let arriving = axis.speed_m(b - 1, 1) * part(b - 1) / shares[b - 1];
        let leaving = axis.speed_m(b, 0) * part(b);
        if !(arriving > 1e-3 && leaving > 1e-3 * lengths[b] && arriving < 1e3) {
            return all;
        }
        shares.push(leaving / arriving);
        bridged.push(gaps[b - 1] / arriving);
    }
    if n > 1 {
        all.push(laid(&shares, &bridged));
    }
    all
}

/// Lengths with gaps between them, scaled to [0, 1].
fn laid(lengths: &[f64], gaps: &[f64]) -> Intervals {
    let whole: f64 = lengths.iter().chain(gaps).sum();
    let mut start = 0.0;
    let mut at = Vec::with_capacity(lengths.len());
    for (b, length) in lengths.iter().enumerate() {
        let end = if b + 1 == lengths.len() { 1.0 } else { start + length / whole };
        at.push([start, end]);
        start = end + gaps.get(b).map_or(0.0, |gap| gap / whole);
    }
    at
}

/// Least distance of a moved knot from its neighbours.
fn least_gap(at: &Intervals, least_span: f64) -> f64 {
    least_span * at.iter().map(|[start, end]| end - start).fold(1.0, f64::min)
}

/// Samples of the lines over the merged parameter.
pub(super) struct Data {
    pub parameters: Vec<f64>,
    pub samples: Vec<f64>,
    pub width: usize,
}

impl Data {
    pub(super) fn new(axis: &Axis, at: &Intervals) -> Self {
        let strands = axis.blocks[0].strands.len();
        let mut data = Self { parameters: Vec::new(), samples: Vec::new(), width: 3 * LINES * strands };
        for (block, &at) in axis.blocks.iter().zip(at) {
            data.parameters.extend(parameters(&block.fractions, at));
            for row in 0..block.fractions.len() {
                for strand in &block.strands {
                    data.samples.extend_from_slice(&strand.samples[row * 3 * LINES..(row + 1) * 3 * LINES]);
                }
            }
        }
        data
    }

    /// Sum of squares, m²; infinite for knots that are no knots.
    fn miss(&self, knots: &Knots) -> f64 {
        let Ok(knots) = knots.vector() else { return f64::INFINITY };
        let fit = LineFit::new(&knots, &self.parameters, Ends::Held);
        let points = fit.rough(&self.samples, self.width);
        fit.misses(&self.samples, &points, self.width).iter().map(|x| x * x).sum()
    }
}

/// Where the rows of a block lie on the merged parameter.
pub(super) fn parameters(fractions: &[f64], [start, end]: [f64; 2]) -> Vec<f64> {
    let (first, last) = (fractions[0], fractions[fractions.len() - 1]);
    // From both ends, so that both come out exactly.
    let share = |f: f64| (f - first) / (last - first);
    fractions.iter().map(|&f| start * (1.0 - share(f)) + end * share(f)).collect()
}

/// Each knot in turn to both sides, kept where the fit misses less.
fn improve(data: &Data, knots: &mut Knots, mut miss: f64, least: f64) {
    let movable: Vec<usize> = knots.movable().collect();
    let mut step = FIRST_STEP;
    for _ in 0..ROUNDS {
        for &k in &movable {
            for side in [-1.0, 1.0] {
                let old = knots.values[k];
                let neighbour = if side < 0.0 { knots.values[k - 1] } else { knots.values[k + 1] };
                let moved = old + (neighbour - old) * step;
                if (neighbour - moved).abs() < least || moved == old {
                    continue;
                }
                knots.values[k] = moved;
                let now = data.miss(knots);
                if now < miss {
                    miss = now;
                    break;
                }
                knots.values[k] = old;
            }
        }
        step *= 0.5;
    }
}
