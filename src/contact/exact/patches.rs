//! From Bézier pieces that reach into a tool to parameter rectangles: one for each set of pieces that touch each other.

use crate::contact::{ContactSet, Rectangle};
use crate::surface::{ClosestSolver, Surface};

/// The grid of Bézier pieces, and which of them belong together.
#[derive(Clone, Debug)]
pub(crate) struct Patches {
    /// Span boundaries in u and v.
    breaks: [Vec<f64>; 2],
    /// The surface goes on from the last span to the first, with its period.
    wraps: [bool; 2],
    /// (pieces): reached, and not yet part of a rectangle.
    open: Vec<bool>,
    /// Pieces of the present set that are still to be looked around, with their unwrapped row and column.
    front: Vec<(i32, i32)>,
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
        debug_assert_eq!(pieces, (breaks[0].len() - 1) * (breaks[1].len() - 1), "a piece for each pair of spans");
        Self {
            breaks,
            wraps: [topology.wraps(0), topology.wraps(1)],
            open: vec![false; pieces],
            front: Vec::with_capacity(pieces),
        }
    }

    /// Adds a rectangle for each connected set of reached pieces.
    pub fn report(&mut self, reached: &[bool], out: &mut ContactSet) {
        self.open.copy_from_slice(reached);
        let (rows, columns) = (self.breaks[0].len() as i32 - 1, self.breaks[1].len() as i32 - 1);
        for k in 0..self.open.len() {
            if !self.open[k] {
                continue;
            }
            self.open[k] = false;
            let start = (k as i32 / columns, k as i32 % columns);
            let (mut low, mut high) = ([start.0, start.1], [start.0, start.1]);
            self.front.clear();
            self.front.push(start);
            while let Some((i, j)) = self.front.pop() {
                (low, high) = ([low[0].min(i), low[1].min(j)], [high[0].max(i), high[1].max(j)]);
                for (a, b) in (-1..=1).flat_map(|a| (-1..=1).map(move |b| (i + a, j + b))) {
                    let outside = [a < 0 || a >= rows, b < 0 || b >= columns];
                    if (outside[0] && !self.wraps[0]) || (outside[1] && !self.wraps[1]) {
                        continue;
                    }
                    let piece = (a.rem_euclid(rows) * columns + b.rem_euclid(columns)) as usize;
                    // Each piece enters once, so there is room.
                    if self.open[piece] {
                        self.open[piece] = false;
                        self.front.push((a, b));
                    }
                }
            }
            out.push_rectangle(Rectangle { u: self.range(0, low[0], high[0]), v: self.range(1, low[1], high[1]) });
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
        let at = |x: i32| breaks[x.rem_euclid(count) as usize] + (end - start) * x.div_euclid(count) as f64;
        let last = high - turns * count + 1;
        let upper = if last == count { end } else { at(last) };
        [at(low - turns * count), upper]
    }
}
