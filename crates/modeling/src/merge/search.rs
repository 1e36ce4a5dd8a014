//! The choice of parameters and knots: candidates are fitted on a few lines, and the one that
//! misses least is kept.
//!
//! ```text
//! shares of the domain (lengths, or speeds at the seam) ─┐
//! blends at the seam (the source's, or sharper) ─────────┴▶ fit on a few lines ──▶ the best ──▶ each knot tried to both sides
//! ```
//! Nothing here decides whether an answer is right, only which of several right ones is nearer.
//! Work is bounded.

use super::axis::{Axis, LINES};
use super::fit::{Band, Ends, LineFit};
use super::knots::{Interiors, Intervals, Knots, interiors};

/// Shares of the way to the next knot at which a seam's freed knots are tried, beside the source's.
const BLENDS: [f64; 4] = [0.35, 0.2, 0.1, 0.05];
/// A sharper blend, or other shares, must leave less than this share of the sum of squares.
const WORTH: f64 = 0.9;
/// Rounds in which every knot is tried to both sides; steps are halved from one to the next.
const ROUNDS: usize = 3;
/// First step of a knot, as a share of the way to its neighbour.
const FIRST_STEP: f64 = 0.4;
/// Share of the sum of squares that a search may overlook in a column.
const NEGLIGIBLE: f64 = 1e-13;
/// A sum of squares less another one has lost what is below this share of it.
const NOISE: f64 = 1e-14;
/// Misses below this share of the sum of squares are rounding: nothing is left to improve.
const ROUNDING: f64 = 1e-24;
/// Below this share of the sum of squares all rows are asked, not some of them.
const UNSEEN: f64 = 1e-9;
/// Gaps below this share of the length are none.
const TOUCHING: f64 = 1e-6;

/// What was chosen for a direction.
pub(super) struct Choice {
    pub at: Intervals,
    pub knots: Knots,
}

/// Parameters and knots for a direction; as many as the source has. `axis` is sampled thinly,
/// `full` in all rows.
pub(super) fn choose(axis: &Axis, full: &Axis, continuity: usize, least_span: f64) -> Choice {
    let interiors = shown(axis);
    let mut best: Option<(f64, Choice)> = None;
    let mut best_data = None;
    for at in intervals(axis) {
        let data = Data::new(axis, &at).compressed();
        let least = least_gap(&at, least_span);
        let mut better = false;
        for (level, blend) in candidates(axis, continuity) {
            let knots = Knots::joined(axis.degree, level, &interiors, &at, blend);
            if blend < Knots::seed_blend(level) && knots.least_span_at_seams() < least {
                continue;
            }
            let miss = data.miss(&knots);
            if best
                .as_ref()
                .is_none_or(|(fewest, _)| miss < fewest * WORTH - NOISE * data.square)
            {
                best = Some((
                    miss,
                    Choice {
                        at: at.clone(),
                        knots,
                    },
                ));
                better = true;
            }
        }
        if better {
            best_data = Some(data);
        }
    }
    let ((miss, mut choice), data) = best
        .zip(best_data)
        .expect("lengths always give a candidate");
    let before = choice.knots.clone();
    let moved = improve(
        &data,
        &mut choice.knots,
        miss,
        least_gap(&choice.at, least_span),
    );
    if moved < UNSEEN * data.square {
        // What a search cannot see, it may have made worse: patches that need no compromise are
        // merged without one.
        let data = Data::new(full, &choice.at);
        let unmoved = data.miss(&before);
        if unmoved <= ROUNDING * data.square() || data.miss(&choice.knots) >= unmoved {
            choice.knots = before;
        }
    }
    choice
}

/// Continuities and blends to try. More continuity than requested is allowed, and where patches
/// are smooth, or apart, its freed knots do better elsewhere; a crease keeps its own.
fn candidates(axis: &Axis, continuity: usize) -> Vec<(usize, f64)> {
    if axis.blocks.len() == 1 {
        return vec![(0, 1.0)];
    }
    let mut all = vec![(continuity, Knots::seed_blend(continuity))];
    for level in continuity.max(1)..axis.degree {
        let seed = Knots::seed_blend(level);
        if level > continuity {
            all.push((level, seed));
        }
        all.extend(BLENDS.into_iter().filter(|&b| b < seed).map(|b| (level, b)));
    }
    all
}

/// Interior knots as fractions of what shows of each block. Those in hidden parts are put into the
/// widest gaps instead, so that their number stays.
fn shown(axis: &Axis) -> Interiors {
    let all = interiors(axis);
    let shown = all.into_iter().zip(&axis.blocks).map(|(inner, block)| {
        let (start, end) = block.shown();
        let wanted = inner.len();
        let mut kept: Vec<f64> = inner
            .into_iter()
            .filter(|&t| t > start && t < end)
            .map(|t| (t - start) / (end - start))
            .collect();
        while kept.len() < wanted {
            let ends: Vec<f64> = std::iter::once(0.0)
                .chain(kept.iter().copied())
                .chain([1.0])
                .collect();
            let widest = (1..ends.len()).fold(1, |w, k| {
                if ends[k] - ends[k - 1] > ends[w] - ends[w - 1] {
                    k
                } else {
                    w
                }
            });
            kept.insert(widest - 1, 0.5 * (ends[widest - 1] + ends[widest]));
        }
        kept
    });
    shown.collect()
}

/// Shares of the merged parameter: by the speeds with which the patches arrive at the seams, which
/// are exact where patches are smooth across them and so come first; and by lengths.
pub(super) fn intervals(axis: &Axis) -> Vec<Intervals> {
    let n = axis.blocks.len();
    let lengths: Vec<f64> = (0..n)
        .map(|b| axis.length_m(b).max(f64::MIN_POSITIVE))
        .collect();
    let whole: f64 = lengths.iter().sum();
    let gaps: Vec<f64> = (1..n)
        .map(|b| axis.gap_m(b - 1))
        .map(|g| if g > TOUCHING * whole { g } else { 0.0 })
        .collect();
    let mut all = vec![laid(&lengths, &gaps)];
    let mut shares = vec![lengths[0]];
    let mut bridged = Vec::new();
    for b in 1..n {
        let part = |block: usize| axis.blocks[block].shown().1 - axis.blocks[block].shown().0;
        // Metres for a unit of the merged parameter, on arriving at the seam; the next patch leaves
        // it as fast.
        let arriving = axis.speed_m(b - 1, 1) * part(b - 1) / shares[b - 1];
        let leaving = axis.speed_m(b, 0) * part(b);
        if !(arriving > 1e-3 && leaving > 1e-3 * lengths[b] && arriving < 1e3) {
            return all;
        }
        shares.push(leaving / arriving);
        bridged.push(gaps[b - 1] / arriving);
    }
    if n > 1 {
        all.insert(0, laid(&shares, &bridged));
    }
    all
}

/// Lengths with gaps between them, scaled to [0, 1].
fn laid(lengths: &[f64], gaps: &[f64]) -> Intervals {
    let whole: f64 = lengths.iter().chain(gaps).sum();
    let mut start = 0.0;
    let mut at = Vec::with_capacity(lengths.len());
    for (b, length) in lengths.iter().enumerate() {
        let end = if b + 1 == lengths.len() {
            1.0
        } else {
            start + length / whole
        };
        at.push([start, end]);
        start = end + gaps.get(b).map_or(0.0, |gap| gap / whole);
    }
    at
}

/// Least distance of a moved knot from its neighbours.
fn least_gap(at: &Intervals, least_span: f64) -> f64 {
    least_span
        * at.iter()
            .map(|[start, end]| end - start)
            .fold(1.0, f64::min)
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
        let mut data = Self {
            parameters: Vec::new(),
            samples: Vec::new(),
            width: 3 * LINES * strands,
        };
        for (block, &at) in axis.blocks.iter().zip(at) {
            data.parameters.extend(parameters(&block.fractions, at));
            for row in 0..block.fractions.len() {
                for strand in &block.strands {
                    data.samples
                        .extend_from_slice(&strand.samples[row * 3 * LINES..(row + 1) * 3 * LINES]);
                }
            }
        }
        data
    }

    fn square(&self) -> f64 {
        self.samples.iter().map(|x| x * x).sum()
    }

    /// Sum of squares that knots miss, m²: to the last digits, and slowly.
    fn miss(&self, knots: &Knots) -> f64 {
        let Ok(knots) = knots.vector() else {
            return f64::INFINITY;
        };
        let fit = LineFit::new(&knots, &self.parameters, Ends::Held);
        let points = fit.fit(&self.samples, self.width);
        fit.misses(&self.samples, &points, self.width)
            .iter()
            .map(|x| x * x)
            .sum()
    }

    /// The same for searches: what every fit misses alike is taken away, and there are fewer
    /// columns.
    ///
    /// A straight line through the ends is in every basis, so its place does not matter. Of the
    /// rest S, fits miss S Q as they miss S when Q is orthogonal, and most columns of a good choice
    /// are nothing: S = U R by Gram and Schmidt, the largest column first, and U L with L Lᵀ = R Rᵀ
    /// has as many columns as U.
    fn compressed(&self) -> Compressed {
        let (rows, width) = (self.parameters.len(), self.width);
        let last = (rows - 1) * width;
        let mut columns: Vec<Vec<f64>> = (0..width)
            .map(|c| {
                let (start, end) = (self.samples[c], self.samples[last + c]);
                let straight = |u: f64| start * (1.0 - u) + end * u;
                (0..rows)
                    .map(|r| self.samples[r * width + c] - straight(self.parameters[r]))
                    .collect()
            })
            .collect();
        let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
        let total: f64 = columns.iter().map(|c| square(c)).sum();
        let (mut units, mut shares): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
        while units.len() < width {
            let squares: Vec<f64> = columns.iter().map(|c| square(c)).collect();
            let largest = (0..width).fold(0, |l, c| if squares[c] > squares[l] { c } else { l });
            if squares[largest] <= NEGLIGIBLE * total {
                break;
            }
            let length = squares[largest].sqrt();
            let unit: Vec<f64> = columns[largest].iter().map(|x| x / length).collect();
            let mut share = Vec::with_capacity(width);
            for column in &mut columns {
                let part: f64 = column.iter().zip(&unit).map(|(a, b)| a * b).sum();
                column
                    .iter_mut()
                    .zip(&unit)
                    .for_each(|(x, u)| *x -= part * u);
                share.push(part);
            }
            units.push(unit);
            shares.push(share);
        }
        let n = units.len();
        let mut gram = Band::new(n, n.max(1));
        for c in 0..width {
            gram.add_row(0, &(0..n).map(|k| shares[k][c]).collect::<Vec<f64>>());
        }
        let factor = gram.factored();
        let samples = (0..rows).flat_map(|r| (0..n).map(move |c| (r, c)));
        let samples: Vec<f64> = samples
            .map(|(r, c)| (c..n).map(|k| units[k][r] * factor.at(k, c)).sum::<f64>())
            .collect();
        let square = square(&samples);
        Compressed {
            parameters: self.parameters.clone(),
            samples,
            width: n,
            square,
        }
    }
}

/// Samples of the lines, compressed: zero at both ends.
struct Compressed {
    parameters: Vec<f64>,
    samples: Vec<f64>,
    width: usize,
    /// Sum of the squares of the samples.
    square: f64,
}

impl Compressed {
    /// Sum of squares that knots miss, m²; infinite for an invalid knot vector.
    fn miss(&self, knots: &Knots) -> f64 {
        if self.width == 0 {
            return 0.0;
        }
        let Ok(knots) = knots.vector() else {
            return f64::INFINITY;
        };
        let fitted = LineFit::new(&knots, &self.parameters, Ends::Held)
            .fitted_square(&self.samples, self.width);
        (self.square - fitted).max(0.0)
    }
}

/// Where the rows of a block lie on the merged parameter.
pub(super) fn parameters(fractions: &[f64], [start, end]: [f64; 2]) -> Vec<f64> {
    let (first, last) = (fractions[0], fractions[fractions.len() - 1]);
    // From both ends, so that both come out exactly.
    let share = |f: f64| (f - first) / (last - first);
    fractions
        .iter()
        .map(|&f| start * (1.0 - share(f)) + end * share(f))
        .collect()
}

/// Each knot in turn to both sides, kept where the fit misses less; gives what it misses in the
/// end.
fn improve(data: &Compressed, knots: &mut Knots, mut miss: f64, least: f64) -> f64 {
    let movable: Vec<usize> = knots.movable().collect();
    let mut step = FIRST_STEP;
    for _ in 0..ROUNDS {
        for &k in &movable {
            for side in [-1.0, 1.0] {
                let old = knots.values[k];
                let neighbour = if side < 0.0 {
                    knots.values[k - 1]
                } else {
                    knots.values[k + 1]
                };
                let moved = old + (neighbour - old) * step;
                if (neighbour - moved).abs() < least || moved == old {
                    continue;
                }
                knots.values[k] = moved;
                let now = data.miss(knots);
                if now < miss - NOISE * data.square {
                    miss = now;
                    break;
                }
                knots.values[k] = old;
            }
        }
        step *= 0.5;
    }
    miss
}
