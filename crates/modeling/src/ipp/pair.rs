//! Two equations in two variables: the solver.

use super::clip::crossing;
use super::cluster::{Cluster, chains};
use super::local::{Local, Preconditioned};
use super::single::padded;
use super::{Status, System, grid};

/// What to look for.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Boxes of the search to the last digit.
    pub budget: usize,
    /// Boxes of the coarse search that detects a curve of roots, once the budget is used up.
    pub coarse_budget: usize,
    /// Only roots with s ≤ t: for systems that are the same when s and t are swapped.
    pub half: bool,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            budget: 3_000,
            coarse_budget: 6_000,
            half: false,
        }
    }
}

/// A root that exists and is alone within `radius`, both proved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// (s, t) in [0, 1]².
    pub at: [f64; 2],
    /// In the maximum norm.
    pub radius: f64,
}

/// All roots on [0, 1]².
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// In ascending order of s, then t.
    pub roots: Vec<Root>,
    /// Where roots may be that could not be separated: points of [0, 1]², or curves of roots.
    pub clusters: Vec<Cluster>,
    /// What the answer rests on.
    pub status: Status,
    /// Boxes looked at.
    pub boxes: usize,
}

/// Narrower boxes are not cut further.
const NARROWEST: f64 = 1e-13;
/// Narrower boxes in which one equation is all rounding are not halved further. Wider ones are: the
/// other equation may still shorten what is left to where the two curves touch.
const ROUNDING_WIDTH: f64 = 1e-5;
/// Width at which the coarse search stops.
const COARSE: f64 = 1e-2;
/// A chain of at least so many coarse boxes is a curve.
const CHAIN: usize = 64;
/// Uniqueness is used from this contraction on: Newton's method then converges from the middle.
const CONTRACTION: f64 = 0.75;
/// A root so little outside the square is on its edge: the equations are not known more exactly.
const EDGE: f64 = 1e-12;

/// How many times its extent a chain is widened for its verification: where rounding is large, only
/// a wide box has a Jacobian that is computed from it.
const WIDENED: [f64; 4] = [2.0, 16.0, 128.0, 1024.0];

/// Part of [0, 1]².
#[derive(Clone, Copy, Debug)]
pub(super) struct Area {
    pub low: [f64; 2],
    pub width: [f64; 2],
}

/// Buffers that one solution after the other uses.
#[derive(Default)]
pub struct PairSolver {
    stack: Vec<(Area, [f64; 2])>,
    /// Coefficients of the boxes on the stack, f₀ then f₁ of each, the topmost last.
    coefficients: Vec<f64>,
    f: [Vec<f64>; 2],
    h: Preconditioned,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

/// What a search leaves.
#[derive(Default)]
struct PairSearch {
    roots: Vec<Root>,
    pending: Vec<Area>,
    boxes: usize,
    exhausted: bool,
}

impl PairSolver {
    /// All roots of a system.
    pub fn solve(&mut self, system: &System, limits: &Limits) -> Found {
        let fine = self.search(system, limits.half, NARROWEST, limits.budget);
        if !fine.exhausted {
            return self.settled(system, fine, limits);
        }
        let coarse = self.search(system, limits.half, COARSE, limits.coarse_budget);
        let boxes = fine.boxes + coarse.boxes;
        let curve = !coarse.exhausted
            && chains(&coarse.pending)
                .iter()
                .any(|chain| chain.middles.len() >= CHAIN);
        let mut found = self.settled(system, coarse, limits);
        found.boxes = boxes;
        found.status = found.status.max(if curve {
            Status::Continuum
        } else {
            Status::Budget
        });
        found
    }

    /// Depth first, so that the coefficients of waiting boxes are a stack too.
    fn search(&mut self, system: &System, half: bool, narrowest: f64, budget: usize) -> PairSearch {
        let mut search = PairSearch::default();
        self.stack.clear();
        self.coefficients.clear();
        self.push(
            Area {
                low: [0.0; 2],
                width: [1.0; 2],
            },
            system.noise,
            [&system.f[0], &system.f[1]],
        );
        while let Some((area, noise)) = self.stack.pop() {
            self.take(system.f[0].len());
            if half && area.low[0] > area.low[1] + area.width[1] {
                continue;
            }
            search.boxes += 1;
            if search.boxes > budget {
                search.exhausted = true;
                search.pending.push(area);
                break;
            }
            self.visit(system.degree, area, noise, narrowest, &mut search);
        }
        search
    }

    fn push(&mut self, area: Area, noise: [f64; 2], f: [&[f64]; 2]) {
        self.stack.push((area, noise));
        self.coefficients.extend_from_slice(f[0]);
        self.coefficients.extend_from_slice(f[1]);
    }

    /// The topmost coefficients, into `self.f`.
    fn take(&mut self, count: usize) {
        let start = self.coefficients.len() - 2 * count;
        for k in 0..2 {
            self.f[k].clear();
            self.f[k]
                .extend_from_slice(&self.coefficients[start + k * count..start + (k + 1) * count]);
        }
        self.coefficients.truncate(start);
    }

    fn visit(
        &mut self,
        degree: [usize; 2],
        area: Area,
        noise: [f64; 2],
        narrowest: f64,
        search: &mut PairSearch,
    ) {
        let local = Local {
            degree,
            f: [&self.f[0], &self.f[1]],
            noise,
        };
        if local.excluded() {
            return;
        }
        let unresolvable = local.unresolvable();
        if unresolvable == [true; 2] {
            search.pending.push(area);
            return;
        }
        let conditioned = local.precondition(&mut self.h);
        if conditioned && self.h.excluded() {
            return;
        }
        if self.h.contraction < CONTRACTION
            && let Some(proved) = local.prove(&self.h)
        {
            let at = [0, 1].map(|k| area.low[k] + proved.at[k] * area.width[k]);
            search.roots.push(Root {
                at,
                radius: proved.radius * area.width[0].max(area.width[1]),
            });
            return;
        }
        if area.width[0].max(area.width[1]) < narrowest {
            search.pending.push(area);
            return;
        }
        let Some(clips) = self.clips(degree, noise, conditioned) else {
            return;
        };
        // With one equation all rounding, halving would follow the curve of the other to the last
        // digit.
        let narrow = area.width[0].max(area.width[1]) < ROUNDING_WIDTH;
        if unresolvable != [false; 2] && narrow && !shrinks(&clips) {
            search.pending.push(area);
            return;
        }
        self.descend(degree, area, noise, clips);
    }

    /// The part of the box that the hulls leave, in each variable.
    fn clips(
        &mut self,
        degree: [usize; 2],
        noise: [f64; 2],
        conditioned: bool,
    ) -> Option<[(f64, f64); 2]> {
        let mut clips = [(0.0_f64, 1.0_f64); 2];
        let (lower, upper) = (&mut self.lower, &mut self.upper);
        let mut clip_by = |c: &[f64], noise: f64| -> Option<()> {
            for (axis, clip) in clips.iter_mut().enumerate() {
                project(c, degree, axis, noise, lower, upper);
                let (start, end) = crossing(lower, upper)?;
                *clip = (clip.0.max(start), clip.1.min(end));
                // An empty section is empty by more than rounding only if the padding does not
                // close it.
                if clip.0 > clip.1 + 1e-12 {
                    return None;
                }
            }
            Some(())
        };
        for k in 0..2 {
            if conditioned {
                clip_by(&self.h.h[k], self.h.noise[k])?;
            }
            // Far from linear the plain equations may clip more; near it never.
            if self.h.contraction > 1.0 {
                clip_by(&self.f[k], noise[k])?;
            }
        }
        Some(clips.map(|(start, end)| padded((start.min(end), end.max(start)))))
    }

    /// Shrinks the box; halves it where a variable shrinks by less than a fifth.
    fn descend(
        &mut self,
        degree: [usize; 2],
        mut area: Area,
        mut noise: [f64; 2],
        clips: [(f64, f64); 2],
    ) {
        for (axis, &(start, end)) in clips.iter().enumerate() {
            if (start, end) != (0.0, 1.0) {
                self.restrict(degree, axis, (start, end), &mut area, &mut noise);
            }
        }
        if shrinks(&clips) {
            let f = std::mem::take(&mut self.f);
            self.push(area, noise, [&f[0], &f[1]]);
            self.f = f;
            return;
        }
        let axis = usize::from(area.width[1] > area.width[0]);
        // Off the middle: halves of halves are where roots of symmetric problems lie.
        let middle = 0.5 - 1.0 / 64.0;
        let whole = self.f.clone();
        for part in [(middle, 1.0), (0.0, middle)] {
            for k in 0..2 {
                self.f[k].copy_from_slice(&whole[k]);
            }
            let (mut area, mut noise) = (area, noise);
            self.restrict(degree, axis, part, &mut area, &mut noise);
            let f = std::mem::take(&mut self.f);
            self.push(area, noise, [&f[0], &f[1]]);
            self.f = f;
        }
    }

    fn restrict(
        &mut self,
        degree: [usize; 2],
        axis: usize,
        (start, end): (f64, f64),
        area: &mut Area,
        noise: &mut [f64; 2],
    ) {
        for k in 0..2 {
            noise[k] += cutting_noise(&self.f[k], degree[axis]);
            grid::restrict(&mut self.f[k], degree, axis, start, end);
        }
        area.low[axis] += start * area.width[axis];
        area.width[axis] *= end - start;
    }

    /// Verifies what is pending, this time with room around it, and puts everything in order.
    fn settled(&mut self, system: &System, search: PairSearch, limits: &Limits) -> Found {
        let mut found = Found {
            roots: search.roots,
            boxes: search.boxes,
            ..Found::default()
        };
        for chain in chains(&search.pending) {
            match self.verify(system, &chain) {
                Some(root) => found.roots.push(root),
                None => {
                    found.clusters.push(chain);
                    found.status = found.status.max(Status::Cluster);
                }
            }
        }
        if search.exhausted {
            found.status = Status::Budget;
        }
        found.roots.retain_mut(|root| {
            let room = EDGE + root.radius;
            if root.at.iter().any(|x| !(-room..=1.0 + room).contains(x)) {
                return false;
            }
            root.at = root.at.map(|x| x.clamp(0.0, 1.0));
            if limits.half && root.at[0] > root.at[1] {
                root.at.swap(0, 1);
            }
            true
        });
        found.roots.sort_by(|a, b| {
            a.at[0]
                .total_cmp(&b.at[0])
                .then(a.at[1].total_cmp(&b.at[1]))
        });
        let mut kept: Vec<Root> = Vec::new();
        for root in std::mem::take(&mut found.roots) {
            // Balls that overlap around proved roots hold the same root.
            let same = |other: &Root| {
                (0..2)
                    .all(|k| (other.at[k] - root.at[k]).abs() <= other.radius + root.radius + EDGE)
            };
            if !kept.iter().any(same) {
                kept.push(root);
            }
        }
        found.clusters.retain(|cluster| {
            !kept
                .iter()
                .any(|root| cluster.extent() < 1e-9 && near(cluster, root))
        });
        if found.clusters.is_empty() && found.status == Status::Cluster {
            found.status = Status::Complete;
        }
        found.roots = kept;
        found
    }

    /// Krawczyk's test on widened boxes around a chain, which may reach over the edge of the
    /// square.
    fn verify(&mut self, system: &System, chain: &Cluster) -> Option<Root> {
        if chain.extent() > 2.0 * COARSE {
            return None;
        }
        WIDENED
            .iter()
            .find_map(|&factor| self.verify_around(system, chain, factor))
    }

    fn verify_around(&mut self, system: &System, chain: &Cluster, factor: f64) -> Option<Root> {
        for k in 0..2 {
            self.f[k].clear();
            self.f[k].extend_from_slice(&system.f[k]);
        }
        let mut area = Area {
            low: [0.0; 2],
            width: [1.0; 2],
        };
        let mut noise = system.noise;
        for axis in 0..2 {
            let room = factor * (chain.high[axis] - chain.low[axis]) + 1e-9;
            let part = (
                (chain.low[axis] - room).max(-0.02),
                (chain.high[axis] + room).min(1.02),
            );
            self.restrict(system.degree, axis, part, &mut area, &mut noise);
        }
        let local = Local {
            degree: system.degree,
            f: [&self.f[0], &self.f[1]],
            noise,
        };
        if !local.precondition(&mut self.h) || self.h.contraction >= CONTRACTION {
            return None;
        }
        let proved = local.prove(&self.h)?;
        let at = [0, 1].map(|k| area.low[k] + proved.at[k] * area.width[k]);
        Some(Root {
            at,
            radius: proved.radius * area.width[0].max(area.width[1]),
        })
    }
}

/// True where both variables shrink by at least a fifth.
fn shrinks(clips: &[(f64, f64); 2]) -> bool {
    clips.iter().all(|(start, end)| end - start <= 0.8)
}

/// A root at a cluster's side.
fn near(cluster: &Cluster, root: &Root) -> bool {
    (0..2).all(|k| root.at[k] >= cluster.low[k] - 1e-9 && root.at[k] <= cluster.high[k] + 1e-9)
}

/// What the rounding of two cuts of a degree adds: 4 roundings a blend at most, of values no larger
/// than the largest.
fn cutting_noise(c: &[f64], degree: usize) -> f64 {
    let most = c.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    8.0 * degree as f64 * f64::EPSILON * most
}

/// Lowest and highest coefficient for each index of one variable.
fn project(
    c: &[f64],
    [p, q]: [usize; 2],
    axis: usize,
    noise: f64,
    lower: &mut Vec<f64>,
    upper: &mut Vec<f64>,
) {
    let count = if axis == 0 { p + 1 } else { q + 1 };
    lower.clear();
    upper.clear();
    lower.resize(count, f64::INFINITY);
    upper.resize(count, f64::NEG_INFINITY);
    for (i, row) in c.chunks(q + 1).enumerate() {
        for (j, &x) in row.iter().enumerate() {
            let k = if axis == 0 { i } else { j };
            lower[k] = lower[k].min(x - noise);
            upper[k] = upper[k].max(x + noise);
        }
    }
}

#[cfg(test)]
#[path = "pair_tests.rs"]
mod tests;
