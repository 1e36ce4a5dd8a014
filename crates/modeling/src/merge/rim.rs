//! Where a patch ends before its edge: on the curves of its trim, or where it crosses its neighbour.
//!
//! ```text
//!   f = 1 ─────────────── the edge at the seam          from the outer edge across: f, along the seam: g;
//!      hidden   ╭──╮      curves, the outer edge to     in fractions of the patch
//!   ────────────╯  ╰───── their left as g rises
//!      visible
//!   f = 0 ─────────────── the outer edge
//! ```
//! `rows` end before `least`, the first f at which anything is hidden; `lines` end on the [`Graph`],
//! if the curves are one.

use super::Edge;

/// Of the patch: a shorter line across the seam is none.
const SHORTEST: f64 = 1e-3;
/// Of the patch: nearer to the border, a crossing ends on it.
const BORDER: f64 = 1e-6;
/// Of the patch: a crossing that ends nearer to a side, where the other patch is narrower, goes on to it.
const BESIDE: f64 = 0.02;

/// What is wrong with a curve, and where: in fractions (u, v) of the patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Misfit {
    pub at: [f64; 2],
    pub what: &'static str,
}

impl Misfit {
    fn new(at: [f64; 2], what: &'static str) -> Self {
        Self { at, what }
    }

    /// With a place that was [f, g].
    fn seen_from(self, edge: Edge) -> Self {
        Self::new(facing_back(edge, self.at), self.what)
    }
}

/// The curves on which a patch ends, as its edge at the seam sees them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Rim {
    /// Polylines of [f, g]; what lies on the border of the patch is left out.
    chains: Vec<Vec<[f64; 2]>>,
    /// Nothing is hidden at a smaller f.
    pub least: f64,
    /// The end of each line across the seam, or why lines have none.
    pub graph: Result<Graph, Misfit>,
}

/// f as a function of g: a polyline from g = 0 to g = 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Graph {
    /// [f, g], g rising.
    points: Vec<[f64; 2]>,
    /// Mean of f.
    pub mean: f64,
    /// Greatest f.
    pub most: f64,
}

impl Rim {
    /// Of loops in fractions of the patch, the kept part on their left; `edge` is that at the seam. None where nothing
    /// is hidden.
    ///
    /// # Errors
    /// Loops that hide all of the patch, or some of it next to the outer edge.
    pub(super) fn of_loops(loops: &[Vec<[f64; 2]>], edge: Edge) -> Result<Option<Self>, Misfit> {
        let mut chains = Vec::new();
        let mut area = 0.0;
        for places in loops {
            let mut seen: Vec<[f64; 2]> = places.iter().map(|uv| facing(edge, *uv)).collect();
            if mirrors(edge) {
                seen.reverse();
            }
            seen.push(seen[0]);
            area += seen
                .windows(2)
                .map(|w| w[0][0] * w[1][1] - w[1][0] * w[0][1])
                .sum::<f64>();
            inner(&seen, &mut chains);
        }
        let Some(low) = chains.iter().flatten().copied().reduce(lower) else {
            let all = Misfit::new([0.5, 0.5], "hides all of the patch");
            return if area > 0.0 { Ok(None) } else { Err(all) };
        };
        let rim = Self::of_chains(chains, low[0], edge);
        match rim.hides_outside(low) {
            None => Ok(Some(rim)),
            Some(at) => {
                Err(Misfit::new(at, "hides what lies next to the outer edge").seen_from(edge))
            }
        }
    }

    /// Of curves in which the patch crosses its neighbour: what lies before them shows.
    pub(super) fn of_curves(curves: &[Vec<[f64; 2]>], edge: Edge) -> Self {
        let snapped = |x: f64| match x {
            _ if x < BORDER => 0.0,
            _ if x > 1.0 - BORDER => 1.0,
            _ => x,
        };
        let mut chains: Vec<Vec<[f64; 2]>> = (curves.iter())
            .map(|curve| {
                curve
                    .iter()
                    .map(|uv| facing(edge, uv.map(snapped)))
                    .collect()
            })
            .collect();
        for chain in &mut chains {
            if chain.first().map(|p| p[1]) > chain.last().map(|p| p[1]) {
                chain.reverse();
            }
            if let Some(&[f, _]) = chain.first().filter(|p| p[1] > 0.0 && p[1] < BESIDE) {
                chain.insert(0, [f, 0.0]);
            }
            if let Some(&[f, _]) = chain.last().filter(|p| p[1] < 1.0 && p[1] > 1.0 - BESIDE) {
                chain.push([f, 1.0]);
            }
        }
        let least = chains.iter().flatten().copied().reduce(lower);
        Self::of_chains(chains, least.map_or(1.0, |p| p[0]), edge)
    }

    fn of_chains(chains: Vec<Vec<[f64; 2]>>, least: f64, edge: Edge) -> Self {
        Self {
            least,
            graph: Graph::new(&chains).map_err(|misfit| misfit.seen_from(edge)),
            chains,
        }
    }

    /// With g the other way.
    pub(super) fn reversed(&self) -> Self {
        let back = |chain: &Vec<[f64; 2]>| chain.iter().rev().map(|[f, g]| [*f, 1.0 - g]).collect();
        Self {
            chains: self.chains.iter().map(back).collect(),
            least: self.least,
            graph: self
                .graph
                .as_ref()
                .map(Graph::reversed)
                .map_err(|misfit| *misfit),
        }
    }

    /// A place at which the first curve that is met from the outer edge runs the wrong way; asked for beside the
    /// lowest place of all.
    fn hides_outside(&self, low: [f64; 2]) -> Option<[f64; 2]> {
        let beside = self.sides().filter(|[a, b]| *a == low || *b == low);
        let across = beside.filter(|[a, b]| a[1] != b[1]);
        let middle = across.map(|[a, b]| 0.5 * (a[1] + b[1])).next()?;
        let met = self
            .sides()
            .filter_map(|side| Some((side, meets(side, middle)?)));
        let (side, f) = met.min_by(|a, b| a.1.total_cmp(&b.1))?;
        (side[1][1] < side[0][1]).then_some([f, middle])
    }

    fn sides(&self) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
        self.chains
            .iter()
            .flat_map(|chain| chain.windows(2).map(|w| [w[0], w[1]]))
    }

    /// Whether a place shows; the curves do. The outer edge does where rows or lines are left at all.
    pub(super) fn shows(&self, [f, g]: [f64; 2]) -> bool {
        // No curve has a place above g = 1, all that reach it have one just below.
        let g = g.min(1.0 - 1e-9);
        let passed = self.sides().filter_map(|side| meets(side, g));
        passed.filter(|&at| at < f - 1e-12).count() % 2 == 0
    }
}

/// Where a side has a g.
fn meets([a, b]: [[f64; 2]; 2], g: f64) -> Option<f64> {
    ((a[1] <= g) != (b[1] <= g)).then(|| a[0] + (b[0] - a[0]) * ((g - a[1]) / (b[1] - a[1])))
}

fn lower(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    if b[0] < a[0] { b } else { a }
}

/// The parts of a closed polyline that do not run along the border.
fn inner(seen: &[[f64; 2]], chains: &mut Vec<Vec<[f64; 2]>>) {
    let n = seen.len() - 1;
    let borders = |k: usize| on_border(seen[k % n], seen[k % n + 1]);
    let Some(first) = (0..n).find(|&k| borders(k)) else {
        chains.push(seen.to_vec());
        return;
    };
    let mut chain: Vec<[f64; 2]> = Vec::new();
    for k in first..=first + n {
        if !borders(k) {
            chain.push(seen[k % n]);
        } else if !chain.is_empty() {
            chain.push(seen[k % n]);
            chains.push(std::mem::take(&mut chain));
        }
    }
}

fn on_border(a: [f64; 2], b: [f64; 2]) -> bool {
    [0, 1]
        .iter()
        .any(|&d| a[d] == b[d] && (a[d] == 0.0 || a[d] == 1.0))
}

/// The place [f, g] of (u, v), where the edge is that at the seam.
pub(super) fn facing(edge: Edge, [u, v]: [f64; 2]) -> [f64; 2] {
    match edge {
        Edge::U1 => [u, v],
        Edge::U0 => [1.0 - u, v],
        Edge::V1 => [v, u],
        Edge::V0 => [1.0 - v, u],
    }
}

/// (u, v) of a place [f, g].
pub(super) fn facing_back(edge: Edge, [f, g]: [f64; 2]) -> [f64; 2] {
    match edge {
        Edge::U1 => [f, g],
        Edge::U0 => [1.0 - f, g],
        Edge::V1 => [g, f],
        Edge::V0 => [g, 1.0 - f],
    }
}

/// What is on the left in (u, v) is on the right in [f, g].
fn mirrors(edge: Edge) -> bool {
    matches!(edge, Edge::U0 | Edge::V1)
}

impl Graph {
    /// Of chains, put together along the edge at the seam.
    fn new(chains: &[Vec<[f64; 2]>]) -> Result<Self, Misfit> {
        let mut chains: Vec<&Vec<[f64; 2]>> = chains.iter().filter(|c| c.len() > 1).collect();
        chains.sort_by(|a, b| a[0][1].total_cmp(&b[0][1]));
        let mut points: Vec<[f64; 2]> = Vec::new();
        for chain in chains {
            let (start, last) = (chain[0], points.last().copied());
            let from = last.unwrap_or([1.0, 0.0]);
            if start[1] < from[1] {
                return Err(Misfit::new(start, "lies behind another one"));
            }
            if start[1] > from[1] {
                // What lies between is not hidden: lines end on the edge.
                if let Some(end) = [from, start].into_iter().find(|p| p[0] < 1.0) {
                    return Err(Misfit::new(end, "ends inside of the patch"));
                }
                points.extend(last.is_none().then_some(from));
            }
            points.extend_from_slice(chain);
        }
        match points.last() {
            Some(&[f, g]) if g < 1.0 => {
                if f < 1.0 {
                    return Err(Misfit::new([f, g], "ends inside of the patch"));
                }
                points.push([1.0, 1.0]);
            }
            None => points.extend([[1.0, 0.0], [1.0, 1.0]]),
            Some(_) => {}
        }
        for w in points.windows(2) {
            if w[1][1] < w[0][1] {
                return Err(Misfit::new(w[1], "turns back"));
            }
            if w[1][1] == w[0][1] && w[1][0] != w[0][0] {
                return Err(Misfit::new(w[1], "runs straight across the seam"));
            }
        }
        if let Some(&low) = points.iter().find(|p| p[0] < SHORTEST) {
            return Err(Misfit::new(low, "reaches the outer edge"));
        }
        let parts = points.windows(2);
        let mean = parts.map(|w| 0.5 * (w[0][0] + w[1][0]) * (w[1][1] - w[0][1]));
        Ok(Self {
            mean: mean.sum(),
            most: points.iter().fold(0.0, |most, p| p[0].max(most)),
            points,
        })
    }

    /// With g the other way.
    pub(super) fn reversed(&self) -> Self {
        let points = self.points.iter().rev().map(|[f, g]| [*f, 1.0 - g]);
        Self {
            points: points.collect(),
            ..self.clone()
        }
    }

    /// f at a g.
    pub(super) fn at(&self, g: f64) -> f64 {
        let after = self.points.partition_point(|p| p[1] < g);
        let k = after.clamp(1, self.points.len() - 1);
        let ([f0, g0], [f1, g1]) = (self.points[k - 1], self.points[k]);
        let share = if g1 > g0 {
            ((g - g0) / (g1 - g0)).clamp(0.0, 1.0)
        } else {
            1.0
        };
        f0 * (1.0 - share) + f1 * share
    }
}
