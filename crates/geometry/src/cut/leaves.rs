//! Rectangles small enough that the curve within each is nothing or one graph.

use super::CutError;
use super::field::{Field, restricted, value};
use super::grid::{DEPTH, Grid, Side, WHOLE};
use std::collections::BTreeMap;

/// Rectangles at most.
const MOST: usize = 200_000;
/// How much steeper than at its flattest place the field may be across a graph, and the graph itself.
const EVEN: f64 = 3.0;
/// How much less than in the other direction the field may change in one that is not halved.
const STEEP: f64 = 0.05;

/// What is known of a rectangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// No curve.
    Whole,
    /// At most one curve, a graph over a direction; and at most one end of it on each side.
    Graph(usize),
    /// To be halved in these directions, or as small as they become.
    Last([bool; 2]),
}

#[derive(Clone, Debug)]
pub(super) struct Leaf {
    pub piece: [usize; 2],
    /// Its first corner.
    pub at: [u64; 2],
    pub size: [u64; 2],
    pub kind: Kind,
    /// The field's coefficients over it.
    pub points: Vec<f64>,
}

/// A side of a rectangle, walked with the rectangle on the left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Walk {
    pub side: Side,
    pub forward: bool,
}

impl Walk {
    pub fn start(&self) -> [u64; 2] {
        self.side.place(if self.forward {
            self.side.from
        } else {
            self.side.to
        })
    }

    pub fn end(&self) -> [u64; 2] {
        self.side.place(if self.forward {
            self.side.to
        } else {
            self.side.from
        })
    }
}

/// All rectangles, and where their corners divide the lines between them.
pub(super) struct Leaves {
    pub all: Vec<Leaf>,
    breaks: BTreeMap<(usize, u64), Vec<u64>>,
    /// By corner: the field is above 0.
    signs: BTreeMap<[u64; 2], bool>,
}

impl Leaves {
    pub fn new(field: &Field, grid: &Grid) -> Result<Self, CutError> {
        let [rows, columns] = grid.counts();
        let mut waiting: Vec<Leaf> = Vec::new();
        for i in 0..rows {
            for j in 0..columns {
                let piece = [i, j];
                let points = field.piece(piece).to_vec();
                let at = piece.map(|k| k as u64 * WHOLE);
                waiting.push(Leaf::new(field.degree(), piece, at, [WHOLE; 2], points));
            }
        }
        waiting.reverse();
        let mut leaves = Self {
            all: Vec::new(),
            breaks: BTreeMap::new(),
            signs: BTreeMap::new(),
        };
        leaves.settle(field, waiting)?;
        // Rounding can make corners say more than the polynomials do: halved until both agree.
        for _ in 0..=DEPTH {
            leaves.divide_lines(field, grid);
            let unclear = |leaf: &Leaf| {
                let changes = leaves.changes(grid, leaf);
                let may = match leaf.kind {
                    Kind::Whole => 0,
                    Kind::Graph(_) => 2,
                    Kind::Last(_) => usize::MAX,
                };
                changes > may
            };
            let flags: Vec<bool> = leaves.all.iter().map(unclear).collect();
            let all = std::mem::take(&mut leaves.all).into_iter().zip(flags);
            let (halve, keep): (Vec<_>, Vec<_>) = all.partition(|(_, unclear)| *unclear);
            let halve: Vec<Leaf> = halve.into_iter().map(|(leaf, _)| leaf).collect();
            leaves.all = keep.into_iter().map(|(leaf, _)| leaf).collect();
            if halve.is_empty() {
                return Ok(leaves);
            }
            let parts = halve.iter().flat_map(|leaf| leaf.parts(field.degree()));
            leaves.settle(field, parts.collect())?;
        }
        leaves.divide_lines(field, grid);
        Ok(leaves)
    }

    /// Halves rectangles until what is within each is known.
    fn settle(&mut self, field: &Field, mut waiting: Vec<Leaf>) -> Result<(), CutError> {
        while let Some(leaf) = waiting.pop() {
            match leaf.kind {
                Kind::Last(_) if leaf.size != [1; 2] => {
                    waiting.extend(leaf.parts(field.degree()));
                }
                _ => self.all.push(leaf),
            }
            if self.all.len() + waiting.len() > MOST {
                return Err(CutError::TooFine { most: MOST });
            }
        }
        Ok(())
    }

    fn divide_lines(&mut self, field: &Field, grid: &Grid) {
        self.breaks.clear();
        for leaf in &self.all {
            for walk in leaf.sides() {
                let side = grid.named(walk.side);
                let list = self.breaks.entry((side.direction, side.line)).or_default();
                list.extend([side.from, side.to]);
                for along in [side.from, side.to] {
                    let place = canonical(grid, side.place(along));
                    let sign = || field.at(grid, place) > 0.0;
                    self.signs.entry(place).or_insert_with(sign);
                }
            }
        }
        for list in self.breaks.values_mut() {
            list.sort_unstable();
            list.dedup();
        }
    }

    /// The field is above 0 at a corner.
    pub fn is_above(&self, grid: &Grid, place: [u64; 2]) -> bool {
        self.signs[&canonical(grid, place)]
    }

    /// The sides of a rectangle, divided where others end, by their names.
    pub fn around(&self, grid: &Grid, leaf: &Leaf) -> Vec<Walk> {
        let mut out = Vec::with_capacity(4);
        for walk in leaf.sides() {
            let side = grid.named(walk.side);
            let breaks = &self.breaks[&(side.direction, side.line)];
            let from = breaks.partition_point(|&x| x < side.from);
            let to = breaks.partition_point(|&x| x <= side.to);
            let parts = breaks[from..to].windows(2).map(|pair| Walk {
                side: Side {
                    from: pair[0],
                    to: pair[1],
                    ..side
                },
                forward: walk.forward,
            });
            match walk.forward {
                true => out.extend(parts),
                false => out.extend(parts.rev()),
            }
        }
        out
    }

    fn changes(&self, grid: &Grid, leaf: &Leaf) -> usize {
        let around = self.around(grid, leaf);
        let is_change =
            |walk: &&Walk| self.is_above(grid, walk.start()) != self.is_above(grid, walk.end());
        around.iter().filter(is_change).count()
    }
}

pub(super) fn canonical(grid: &Grid, place: [u64; 2]) -> [u64; 2] {
    [0, 1].map(|d| grid.canonical(d, place[d]))
}

impl Leaf {
    fn new(
        degree: [usize; 2],
        piece: [usize; 2],
        at: [u64; 2],
        size: [u64; 2],
        points: Vec<f64>,
    ) -> Self {
        let kind = kind(&points, degree);
        Self {
            piece,
            at,
            size,
            kind,
            points,
        }
    }

    /// Its sides, from the first corner, counter-clockwise.
    fn sides(&self) -> [Walk; 4] {
        let [u, v] = self.at;
        let walk = |direction: usize, line: u64, from: u64, forward: bool| Walk {
            side: Side {
                direction,
                line,
                from,
                to: from + self.size[direction],
            },
            forward,
        };
        [
            walk(0, v, u, true),
            walk(1, u + self.size[0], v, true),
            walk(0, v + self.size[1], u, false),
            walk(1, u, v, false),
        ]
    }

    /// Its halves or quarters.
    fn parts(&self, degree: [usize; 2]) -> Vec<Self> {
        let wanted = match self.kind {
            Kind::Last(wanted) => wanted,
            _ => [true; 2],
        };
        let may = self.size.map(|size| size > 1);
        let asked = [0, 1].map(|d| wanted[d] && may[d]);
        let halve = if asked == [false; 2] { may } else { asked };
        let mut parts = vec![(self.at, self.size, self.points.clone())];
        for d in (0..2).filter(|&d| halve[d]) {
            let whole = std::mem::take(&mut parts);
            for (at, mut size, points) in whole {
                size[d] /= 2;
                let [low, high] = halves(&points, degree, d);
                let mut next = at;
                next[d] += size[d];
                parts.extend([(at, size, low), (next, size, high)]);
            }
        }
        let part = |(at, size, points)| Self::new(degree, self.piece, at, size, points);
        parts.into_iter().map(part).collect()
    }

    /// A place within it, from 0 to 1 in both directions, as parameters.
    pub fn parameters(&self, grid: &Grid, local: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|d| {
            let from = (self.at[d] - self.piece[d] as u64 * WHOLE) as f64;
            let t = (from + local[d] * self.size[d] as f64) / WHOLE as f64;
            grid.parameter_within(d, self.piece[d], t)
        })
    }

    /// Its width times its height, in parameters.
    pub fn extent(&self, grid: &Grid) -> f64 {
        let [low, high] = [[0.0; 2], [1.0; 2]].map(|local| self.parameters(grid, local));
        (high[0] - low[0]) * (high[1] - low[1])
    }

    pub fn is_above_at_its_middle(&self, degree: [usize; 2]) -> bool {
        value(&restricted(&self.points, degree, 0, 0.5), 0.5) > 0.0
    }

    /// Where parameters lie within it, from 0 to 1.
    pub fn local(&self, grid: &Grid, uv: [f64; 2]) -> [f64; 2] {
        let low = self.parameters(grid, [0.0; 2]);
        let high = self.parameters(grid, [1.0; 2]);
        let middle = [0, 1].map(|d| 0.5 * (low[d] + high[d]));
        let uv = grid.lifted(uv, middle);
        [0, 1].map(|d| ((uv[d] - low[d]) / (high[d] - low[d])).clamp(0.0, 1.0))
    }
}

/// Both halves in a direction, by de Casteljau.
fn halves(points: &[f64], degree: [usize; 2], d: usize) -> [Vec<f64>; 2] {
    let [p, q] = degree;
    let (stride, lines, n) = match d {
        0 => (q + 1, q + 1, p),
        _ => (1, p + 1, q),
    };
    let mut low = points.to_vec();
    let mut high = points.to_vec();
    for line in 0..lines {
        let first = if d == 0 { line } else { line * (q + 1) };
        let index = |k: usize| first + k * stride;
        for level in 0..=n {
            low[index(level)] = high[index(0)];
            for k in 0..n - level {
                high[index(k)] = 0.5 * (high[index(k)] + high[index(k + 1)]);
            }
        }
    }
    [low, high]
}

/// At most one change of sign: at most one root (Descartes).
fn changes_once(row: impl Iterator<Item = f64>) -> bool {
    let mut last = 0.0;
    let mut changes = 0;
    for c in row.filter(|c| *c != 0.0) {
        if last * c < 0.0 {
            changes += 1;
        }
        last = c;
    }
    changes <= 1
}

fn kind(points: &[f64], degree: [usize; 2]) -> Kind {
    let above = points[0] > 0.0;
    if points.iter().all(|c| (*c > 0.0) == above && *c != 0.0) {
        return Kind::Whole;
    }
    let [p, q] = degree;
    let at = |i: usize, j: usize| points[i * (q + 1) + j];
    let mut slopes = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    let mut enter = |d: usize, slope: f64| {
        slopes[d] = [slopes[d][0].min(slope), slopes[d][1].max(slope)];
    };
    for i in 0..=p {
        for j in 0..=q {
            if i < p {
                enter(0, p as f64 * (at(i + 1, j) - at(i, j)));
            }
            if j < q {
                enter(1, q as f64 * (at(i, j + 1) - at(i, j)));
            }
        }
    }
    let most = slopes.map(|[low, high]| low.abs().max(high.abs()));
    // Halving pays only along a direction in which the field changes.
    let halve = [0, 1].map(|d| most[d] > STEEP * most[1 - d]);
    let sides = changes_once((0..=p).map(|i| at(i, 0)))
        && changes_once((0..=p).map(|i| at(i, q)))
        && changes_once((0..=q).map(|j| at(0, j)))
        && changes_once((0..=q).map(|j| at(p, j)));
    if !sides {
        return Kind::Last(halve);
    }
    let fits = |d: usize| {
        // A graph over d rises or falls in the other direction, least where it is flattest.
        let [low, high] = slopes[1 - d];
        let least = low.max(-high);
        (least > 0.0 && most[1 - d] <= EVEN * least && most[d] <= EVEN * least)
            .then(|| (d, most[d] / least))
    };
    match (fits(0), fits(1)) {
        (Some(u), Some(v)) => Kind::Graph(if u.1 <= v.1 { 0 } else { 1 }),
        (Some((d, _)), None) | (None, Some((d, _))) => Kind::Graph(d),
        (None, None) => Kind::Last(halve),
    }
}
