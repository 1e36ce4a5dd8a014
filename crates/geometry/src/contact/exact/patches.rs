//! From Bézier pieces that reach into a tool to parameter rectangles: one for each set of pieces
//! that touch each other.

use crate::contact::{ContactSet, Rectangle};
use crate::surface::{ClosestSolver, Surface};

/// The grid of Bézier pieces, and which of them belong together.
#[derive(Clone, Debug)]
pub(crate) struct Patches {
    /// Span boundaries in u and v.
    breaks: [Vec<f64>; 2],
    /// The surface goes on from the last span to the first, with its period.
    wraps: [bool; 2],
    /// (spans): the span begins at a knot that parts the surface.
    parted: [Vec<bool>; 2],
    /// (pieces): reached, and not yet part of a rectangle.
    open: Vec<bool>,
    /// Pieces of the present set that are still to be looked around: unwrapped row and column, and
    /// those in the grid.
    front: Vec<([i32; 2], [i32; 2])>,
}

impl Patches {
    pub fn new(surface: &Surface, solver: &mut ClosestSolver) -> Self {
        let breaks = [surface.knots_u(), surface.knots_v()].map(|knots| {
            let mut out: Vec<f64> = knots.spans().map(|k| knots.knots()[k]).collect();
            out.push(knots.domain().1);
            out
        });
        let topology = surface.topology();
        let pieces = solver.pieces(surface).len();
        debug_assert_eq!(
            pieces,
            (breaks[0].len() - 1) * (breaks[1].len() - 1),
            "a piece for each pair of spans"
        );
        let parted = [surface.knots_u(), surface.knots_v()].map(|knots| {
            let gaps = knots.disjoined();
            knots
                .spans()
                .map(|k| gaps.contains(&knots.knots()[k]))
                .collect()
        });
        Self {
            breaks,
            parted,
            wraps: [topology.wraps(0), topology.wraps(1)],
            open: vec![false; pieces],
            front: Vec::with_capacity(pieces),
        }
    }

    /// Adds a rectangle for each connected set of reached pieces.
    pub fn report(&mut self, reached: &[bool], out: &mut ContactSet) {
        self.open.copy_from_slice(reached);
        let (rows, columns) = (
            self.breaks[0].len() as i32 - 1,
            self.breaks[1].len() as i32 - 1,
        );
        for k in 0..self.open.len() {
            if !self.open[k] {
                continue;
            }
            self.open[k] = false;
            let start = [k as i32 / columns, k as i32 % columns];
            let (mut low, mut high) = (start, start);
            self.front.clear();
            self.front.push((start, start));
            while let Some((at, piece)) = self.front.pop() {
                (low, high) = (
                    [low[0].min(at[0]), low[1].min(at[1])],
                    [high[0].max(at[0]), high[1].max(at[1])],
                );
                for a in -1..=1 {
                    let Some(row) = self.beside(0, piece[0], a, rows) else {
                        continue;
                    };
                    for b in -1..=1 {
                        let Some(column) = self.beside(1, piece[1], b, columns) else {
                            continue;
                        };
                        // Each piece enters once, so there is room.
                        let other = (row * columns + column) as usize;
                        if self.open[other] {
                            self.open[other] = false;
                            self.front.push(([at[0] + a, at[1] + b], [row, column]));
                        }
                    }
                }
            }
            out.push_rectangle(Rectangle {
                u: self.range(0, low[0], high[0]),
                v: self.range(1, low[1], high[1]),
            });
        }
    }

    /// The row or column a step on, inside the grid; `None` where the surface does not go on.
    fn beside(&self, k: usize, from: i32, step: i32, count: i32) -> Option<i32> {
        let x = from + step;
        if step != 0 && self.parted[k][from.max(x).rem_euclid(count) as usize] {
            None
        } else if x >= 0 && x < count {
            Some(x)
        } else if self.wraps[k] {
            Some(if x < 0 { count - 1 } else { 0 })
        } else {
            None
        }
    }

    /// Parameters of unwrapped spans `low ..= high`, starting inside the domain.
    fn range(&self, k: usize, low: i32, high: i32) -> [f64; 2] {
        let breaks = &self.breaks[k];
        let count = breaks.len() as i32 - 1;
        let (start, end) = (breaks[0], breaks[count as usize]);
        if high - low + 1 >= count {
            return [start, end];
        }
        let turns = low.div_euclid(count);
        let at = |x: i32| {
            breaks[x.rem_euclid(count) as usize] + (end - start) * x.div_euclid(count) as f64
        };
        let last = high - turns * count + 1;
        let upper = if last == count { end } else { at(last) };
        [at(low - turns * count), upper]
    }
}
