//! A surface as a grid of cells: equal parts of its Bézier pieces, with boxes, cones of normals and
//! shared vertices.

use super::cone::Cone;
use super::restriction::{MOST_POINTS, restrict, restriction};
use crate::math::Point3;
use crate::surface::bezier::Joint;
use crate::surface::{BezierPieces, Surface};

/// Cells in one direction, at least: a closed curve of ten cells turns by 36° in each, so cones are
/// narrow enough to tell facing from crossing parts, and feet of neighbouring vertices are alike.
const LEAST_CELLS: usize = 10;

/// Least and greatest corner.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact) struct Block {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Block {
    pub const EMPTY: Self = Self {
        low: [f64::INFINITY; 3],
        high: [f64::NEG_INFINITY; 3],
    };

    #[inline(always)]
    pub fn meets(&self, other: &Self, margin: f64) -> bool {
        let mut apart = false;
        for c in 0..3 {
            apart |= self.low[c] - margin > other.high[c];
            apart |= other.low[c] - margin > self.high[c];
        }
        !apart
    }

    pub fn holds(&self, point: &Point3, margin: f64) -> bool {
        (0..3).all(|c| point[c] >= self.low[c] - margin && point[c] <= self.high[c] + margin)
    }

    pub fn middle(&self) -> Point3 {
        nalgebra::center(&self.low.into(), &self.high.into())
    }

    pub fn diagonal(&self) -> f64 {
        let d: f64 = (0..3)
            .map(|c| (self.high[c] - self.low[c]) * (self.high[c] - self.low[c]))
            .sum();
        d.sqrt()
    }
}

/// A cell's piece, and the matrices that restrict it to the cell.
struct Parts<'a> {
    piece: usize,
    u: &'a [f64],
    v: &'a [f64],
}

impl Parts<'_> {
    #[inline(always)]
    fn piece_of<'b>(&self, pieces: &'b BezierPieces) -> &'b [[f64; 4]] {
        pieces.points(self.piece)
    }
}

/// The cells of one surface. What depends on the knots is made once; boxes and the rest as asked
/// for.
#[derive(Clone, Debug)]
pub(in crate::contact) struct Cells {
    /// Cells in u and v.
    pub counts: [usize; 2],
    /// Vertex lines, (counts + 1) parameters.
    pub lines: [Vec<f64>; 2],
    /// Ends that meet.
    pub wraps: [bool; 2],
    /// Ends that are one point: `poles[d][e]`.
    pub poles: [[bool; 2]; 2],
    pub closed: bool,
    /// Parameters of creases and of ends that knots do not join, in each direction.
    walls: [Vec<f64>; 2],
    per: [usize; 2],
    spans: [usize; 2],
    degree: [usize; 2],
    /// (per × (degree + 1)²) for each direction: Bézier points of a part from those of a piece.
    parts: [Vec<f64>; 2],
    /// (vertices): the first of all vertices at the same place.
    pub alias: Vec<u32>,
    /// Bounding box of each cell (cells).
    boxes: Vec<Block>,
    cones: Vec<Cone>,
    known: Vec<bool>,
    /// (cells): near the other surface.
    pub touched: Vec<bool>,
    /// (cells): may face a part of the other surface.
    pub facing: Vec<bool>,
    /// Box around everything.
    pub whole: Block,
}

impl Cells {
    pub fn new(surface: &Surface, pieces: &BezierPieces) -> Self {
        let topology = surface.topology();
        let spans = [pieces.u.spans.len(), pieces.v.spans.len()];
        let degree = [pieces.u.degree, pieces.v.degree];
        let per = spans.map(|n| LEAST_CELLS.div_ceil(n));
        let counts = [spans[0] * per[0], spans[1] * per[1]];
        let line = |d: usize| -> Vec<f64> {
            let all = if d == 0 {
                &pieces.u.spans
            } else {
                &pieces.v.spans
            };
            let mut line: Vec<f64> = all
                .iter()
                .flat_map(|s| {
                    (0..per[d]).map(move |k| s.start + (s.end - s.start) * k as f64 / per[d] as f64)
                })
                .collect();
            line.extend(all.last().map(|s| s.end));
            line
        };
        let wall = |d: usize| -> Vec<f64> {
            let all = if d == 0 {
                &pieces.u.spans
            } else {
                &pieces.v.spans
            };
            let before = all
                .iter()
                .filter(|s| s.before != Joint::Smooth)
                .map(|s| s.start);
            before
                .chain(
                    all.last()
                        .filter(|s| s.after != Joint::Smooth)
                        .map(|s| s.end),
                )
                .collect()
        };
        let part = |d: usize| -> Vec<f64> {
            (0..per[d])
                .flat_map(|k| {
                    restriction(
                        degree[d],
                        k as f64 / per[d] as f64,
                        (k + 1) as f64 / per[d] as f64,
                    )
                })
                .collect()
        };
        let (rows, columns) = (counts[0] + 1, counts[1] + 1);
        let wraps = [topology.wraps(0), topology.wraps(1)];
        let alias = (0..rows * columns)
            .map(|k| {
                let (mut i, mut j) = (k / columns, k % columns);
                i = if wraps[0] && i == counts[0] { 0 } else { i };
                j = if wraps[1] && j == counts[1] { 0 } else { j };
                if (i == 0 && topology.poles[0][0]) || (i == counts[0] && topology.poles[0][1]) {
                    j = 0;
                }
                if (j == 0 && topology.poles[1][0]) || (j == counts[1] && topology.poles[1][1]) {
                    i = 0;
                }
                (i * columns + j) as u32
            })
            .collect();
        let cells = counts[0] * counts[1];
        Self {
            counts,
            lines: [line(0), line(1)],
            wraps,
            poles: topology.poles,
            closed: topology.is_closed(),
            walls: [wall(0), wall(1)],
            per,
            spans,
            degree,
            parts: [part(0), part(1)],
            alias,
            boxes: vec![Block::EMPTY; cells],
            cones: vec![Cone::ANY; cells],
            known: vec![false; cells],
            touched: vec![false; cells],
            facing: vec![false; cells],
            whole: Block::EMPTY,
        }
    }

    /// Forgets what belonged to an earlier net or place.
    pub fn begin(&mut self, pieces: &BezierPieces) {
        self.known.fill(false);
        self.touched.fill(false);
        self.facing.fill(false);
        let [x0, y0, z0, x1, y1, z1] = pieces.bound_arrays();
        let least = |x: &[f64]| {
            x.iter()
                .fold(f64::INFINITY, |m, &x| if x < m { x } else { m })
        };
        let most = |x: &[f64]| {
            x.iter()
                .fold(f64::NEG_INFINITY, |m, &x| if x > m { x } else { m })
        };
        self.whole = Block {
            low: [least(x0), least(y0), least(z0)],
            high: [most(x1), most(y1), most(z1)],
        };
    }

    pub fn cell_count(&self) -> usize {
        self.counts[0] * self.counts[1]
    }

    pub fn vertex_count(&self) -> usize {
        self.alias.len()
    }

    /// The cells of a piece: first in u and v, and how many each.
    pub fn of_piece(&self, piece: usize) -> ([usize; 2], [usize; 2]) {
        (
            [
                piece / self.spans[1] * self.per[0],
                piece % self.spans[1] * self.per[1],
            ],
            self.per,
        )
    }

    pub fn box_of(&self, cell: usize) -> &Block {
        &self.boxes[cell]
    }

    pub fn cone_of(&self, cell: usize) -> &Cone {
        &self.cones[cell]
    }

    /// The four vertices of a cell, by their first names.
    pub fn corners(&self, cell: usize) -> [u32; 4] {
        let (i, j, columns) = (
            cell / self.counts[1],
            cell % self.counts[1],
            self.counts[1] + 1,
        );
        let at = |i: usize, j: usize| self.alias[i * columns + j];
        [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]
    }

    /// Middle of a cell and its widths, in parameters.
    pub fn middle(&self, cell: usize) -> ([f64; 2], [f64; 2]) {
        let at = [cell / self.counts[1], cell % self.counts[1]];
        let pair = |d: usize| (self.lines[d][at[d]], self.lines[d][at[d] + 1]);
        let ((a, b), (c, d)) = (pair(0), pair(1));
        ([0.5 * (a + b), 0.5 * (c + d)], [b - a, d - c])
    }

    /// The cell that holds a parameter pair of the domain.
    pub fn cell_at(&self, u: f64, v: f64) -> usize {
        let one = |d: usize, x: f64| {
            (self.lines[d].partition_point(|&y| y <= x).max(1) - 1).min(self.counts[d] - 1)
        };
        one(0, u) * self.counts[1] + one(1, v)
    }

    /// Two cells are one or share a vertex.
    pub fn touch(&self, a: usize, b: usize) -> bool {
        let columns = self.counts[1];
        let apart = |d: usize, x: usize, y: usize| match (x.abs_diff(y), self.wraps[d]) {
            (apart, true) => apart.min(self.counts[d] - apart),
            (apart, false) => apart,
        };
        apart(0, a / columns, b / columns) <= 1 && apart(1, a % columns, b % columns) <= 1
    }

    /// Parameters of a vertex.
    pub fn parameters(&self, vertex: usize) -> (f64, f64) {
        let columns = self.counts[1] + 1;
        (
            self.lines[0][vertex / columns],
            self.lines[1][vertex % columns],
        )
    }

    /// The eight vertices around one, by their first names; itself where there is none.
    pub fn around(&self, vertex: usize) -> [u32; 8] {
        let columns = self.counts[1] + 1;
        let at = [(vertex / columns) as isize, (vertex % columns) as isize];
        let step = |d: usize, by: isize| -> isize {
            let (n, x) = (self.counts[d] as isize, at[d] + by);
            if self.wraps[d] {
                x.rem_euclid(n)
            } else {
                x.clamp(0, n)
            }
        };
        const WAYS: [(isize, isize); 8] = [
            (-1, -1),
            (-1, 0),
            (-1, 1),
            (0, -1),
            (0, 1),
            (1, -1),
            (1, 0),
            (1, 1),
        ];
        WAYS.map(|(a, b)| self.alias[step(0, a) as usize * columns + step(1, b) as usize])
    }

    /// The four cells that share a side with one; none beyond an end that does not wrap.
    pub fn beside(&self, cell: usize) -> [Option<usize>; 4] {
        let at = [cell / self.counts[1], cell % self.counts[1]];
        let step = |d: usize, up: bool| {
            let n = self.counts[d];
            let x = at[d] + if up { 1 } else { n - 1 };
            let ends = at[d] + usize::from(up) == if up { n } else { 0 };
            let to = if ends && !self.wraps[d] {
                None
            } else {
                Some(x % n)
            };
            to.map(|x| {
                if d == 0 {
                    x * self.counts[1] + at[1]
                } else {
                    at[0] * self.counts[1] + x
                }
            })
        };
        [step(0, false), step(0, true), step(1, false), step(1, true)]
    }

    /// A parameter pair moved by a step: around where ends meet, over a pole to its far side, held
    /// at edges.
    pub fn moved(&self, at: [f64; 2], step: [f64; 2]) -> [f64; 2] {
        let mut x = [at[0] + step[0], at[1] + step[1]];
        for d in 0..2 {
            let (start, end) = (self.lines[d][0], self.lines[d][self.counts[d]]);
            let over = if x[d] < start && self.poles[d][0] {
                2.0 * start - x[d]
            } else if x[d] > end && self.poles[d][1] {
                2.0 * end - x[d]
            } else {
                continue;
            };
            let (low, high) = (self.lines[1 - d][0], self.lines[1 - d][self.counts[1 - d]]);
            x[d] = over;
            x[1 - d] += 0.5 * (high - low);
        }
        for d in 0..2 {
            let (start, end) = (self.lines[d][0], self.lines[d][self.counts[d]]);
            if self.wraps[d] && (x[d] < start || x[d] > end) {
                x[d] -= (end - start) * ((x[d] - start) / (end - start)).floor();
            }
            x[d] = x[d].clamp(start, end);
        }
        x
    }

    /// An open edge, a seam, a pole or a crease may hold a climb here.
    pub fn wall(&self, u: f64, v: f64) -> bool {
        let one = |d: usize, x: f64| {
            let line = &self.lines[d];
            let near = 1e-9 * (line[self.counts[d]] - line[0]);
            self.walls[d].iter().any(|w| (x - w).abs() <= near)
        };
        one(0, u) || one(1, v)
    }

    /// An open edge holds this parameter pair.
    pub fn on_open_edge(&self, u: f64, v: f64) -> bool {
        let one = |d: usize, x: f64| {
            let (n, line) = (self.counts[d], &self.lines[d]);
            !self.wraps[d]
                && ((x <= line[0] && !self.poles[d][0]) || (x >= line[n] && !self.poles[d][1]))
        };
        !self.closed && (one(0, u) || one(1, v))
    }

    /// Which piece a cell is a part of, and how.
    #[inline(always)]
    fn parts_of(&self, cell: usize) -> Parts<'_> {
        let (i, j) = (cell / self.counts[1], cell % self.counts[1]);
        let (n, m) = (self.degree[0] + 1, self.degree[1] + 1);
        Parts {
            piece: i / self.per[0] * self.spans[1] + j / self.per[1],
            u: &self.parts[0][i % self.per[0] * n * n..],
            v: &self.parts[1][j % self.per[1] * m * m..],
        }
    }

    /// Adds the homogeneous Bézier points of a cell, `(p + 1) × (q + 1)`, u-major.
    pub fn points_of(&self, pieces: &BezierPieces, cell: usize, out: &mut Vec<[f64; 4]>) {
        let (n, m) = (self.degree[0] + 1, self.degree[1] + 1);
        let parts = self.parts_of(cell);
        restrict(
            parts.piece_of(pieces),
            parts.u,
            parts.v,
            n,
            m,
            self.per == [1, 1],
            |_, x| out.push(*x),
        );
    }

    /// Degrees in u and v.
    pub fn degrees(&self) -> [usize; 2] {
        self.degree
    }

    /// Parameters of creases and of ends that knots do not join.
    pub fn walls(&self, d: usize) -> &[f64] {
        &self.walls[d]
    }

    /// Makes sure that the box and cone of a cell are those of the present net.
    pub fn look(&mut self, surface: &Surface, pieces: &BezierPieces, cell: usize) {
        if self.known[cell] {
            return;
        }
        self.known[cell] = true;
        let (p, q) = (self.degree[0], self.degree[1]);
        let (n, m) = (p + 1, q + 1);
        let mut points = [[0.0; 3]; MOST_POINTS];
        let parts = self.parts_of(cell);
        restrict(
            parts.piece_of(pieces),
            parts.u,
            parts.v,
            n,
            m,
            self.per == [1, 1],
            |k, y| {
                let scale = if pieces.is_rational() {
                    1.0 / y[3]
                } else {
                    1.0
                };
                points[k] = [y[0] * scale, y[1] * scale, y[2] * scale];
            },
        );
        let mut block = Block::EMPTY;
        for x in &points[..n * m] {
            for c in 0..3 {
                block.low[c] = if x[c] < block.low[c] {
                    x[c]
                } else {
                    block.low[c]
                };
                block.high[c] = if x[c] > block.high[c] {
                    x[c]
                } else {
                    block.high[c]
                };
            }
        }
        self.boxes[cell] = block;
        self.cones[cell] = Cone::of_normals(
            &points[..n * m],
            p,
            q,
            surface.flip_normal(),
            pieces.is_rational(),
        );
    }
}

/// The shortest range that holds all that are taken; around the end where ends meet.
pub(super) fn arc(taken: &[bool], wraps: bool) -> [usize; 2] {
    let n = taken.len();
    let first = taken.iter().position(|&t| t).unwrap_or(0);
    let last = taken.iter().rposition(|&t| t).unwrap_or(0);
    if !wraps {
        return [first, last + 1];
    }
    // The longest gap, and what is left of the ring.
    let (mut gap_start, mut gap, mut k) = (0, 0, first);
    while k < first + n {
        let start = k;
        while k < first + n && !taken[k % n] {
            k += 1;
        }
        if k - start > gap {
            (gap_start, gap) = (start, k - start);
        }
        k += 1;
    }
    if gap == 0 {
        return [0, n];
    }
    let low = (gap_start + gap) % n;
    [low, low + n - gap]
}
